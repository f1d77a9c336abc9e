// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle/mission.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace jink::sim::vehicle {

void Mission::replace(std::vector<MissionItem> items, std::optional<std::size_t> current) {
  items_ = std::move(items);
  repeats_left_.clear();
  for (const MissionItem& item : items_) repeats_left_.push_back(item.repeats);
  const std::size_t last = items_.empty() ? 0 : items_.size() - 1;
  current_ = std::min(current.value_or(current_), last);
  reached_.reset();
  climb_to_.reset();
  speed_ = planner::base::kInfinity;
  begun_ = active_;
  finished_ = false;
  fresh_ = true;
}

bool Mission::set_current(std::size_t item) {
  if (item >= items_.size()) return false;
  if (item != current_) reached_.reset();
  current_ = item;
  finished_ = false;
  fresh_ = true;
  return true;
}

void Mission::begin(const MissionView& view) {
  if (disarmed_ && begun_ && current_ + 1 == items_.size()) replace(std::move(items_), 0);
  begun_ = active_ = true;
  finished_ = disarmed_ = false;
  reached_.reset();
  order_ = {.kind = MissionOrder::Kind::kFly, .position = view.position};
  // To the height of the first place from where it is, on the ground as in the air.
  climb_to_.reset();
  for (std::size_t i = current_; i < items_.size() && !climb_to_; ++i) {
    const MissionItem::Kind kind = items_[i].kind;
    const bool has_place = kind == MissionItem::Kind::kTakeoff || kind == MissionItem::Kind::kWaypoint ||
                           kind == MissionItem::Kind::kLoiter || kind == MissionItem::Kind::kLand;
    if (!has_place) continue;
    const double height = place(items_[i], view).z();
    if (height - view.position.z() > view.altitude_radius) climb_to_ = height;
    break;
  }
  order_.takeoff = view.landed;
  start_ = view.position;
  fresh_ = true;
}

void Mission::pause() {
  active_ = false;
  climb_to_.reset();
  fresh_ = true;
}

Vec3 Mission::place(const MissionItem& item, const MissionView& view) const {
  Vec3 result = item.position - view.origin;
  if (item.above_home) result.z() = view.home.z() + item.position.z();
  return result;
}

void Mission::start_item(const MissionView& view) {
  fresh_ = over_place_ = false;
  there_since_.reset();
  start_ = view.position;
}

MissionOrder Mission::update(const MissionView& view) {
  if (finished_ || current_ >= items_.size()) return {};
  if (climb_to_) {
    order_.position = {start_.x(), start_.y(), *climb_to_};
    if (view.landed || *climb_to_ - view.position.z() > view.altitude_radius) return order_;
    climb_to_.reset();
  }
  if (fresh_) start_item(view);
  if (!reached_ || *reached_ != current_) {
    const std::size_t item = current_;
    const bool done = perform(view);
    order_.speed = speed_;
    if (!done) return order_;
    if (items_[item].kind != MissionItem::Kind::kJump) reached_ = item;
    if (items_[item].autocontinue) advance();
  }
  return finished_ && order_.kind != MissionOrder::Kind::kReturn ? MissionOrder{} : order_;
}

void Mission::advance() {
  if (current_ + 1 >= items_.size()) {
    finished_ = true;
    return;
  }
  ++current_;
  fresh_ = true;
}

bool Mission::perform(const MissionView& view) {
  const MissionItem& item = items_[current_];
  switch (item.kind) {
    case MissionItem::Kind::kTakeoff: {
      const double height = place(item, view).z();
      fly_to(view, {start_.x(), start_.y(), height}, item.yaw);
      order_.takeoff = true;
      // PX4: not reached on the ground, however wide the radius is.
      const double above = height - view.home.z();
      const double radius = above > 0.0 && above < view.altitude_radius ? above / 2.0 : view.altitude_radius;
      return !view.landed && view.position.z() > height - radius;
    }
    case MissionItem::Kind::kWaypoint:
    case MissionItem::Kind::kLoiter: {
      const Vec3 target = place(item, view);
      fly_to(view, target, item.yaw);
      if (item.kind == MissionItem::Kind::kLoiter || view.landed) return false;
      const double radius = item.radius > 0.0 ? item.radius : view.acceptance_radius;
      if (!there_since_ && !at_place(view, target, radius)) return false;
      const double turned = std::remainder(item.yaw - view.yaw, 2.0 * std::numbers::pi);
      if (!there_since_ && std::isfinite(item.yaw) && std::abs(turned) > view.yaw_error) return false;
      return stayed(view, item.hold);
    }
    case MissionItem::Kind::kLand:
      return land(view, place(item, view));
    case MissionItem::Kind::kReturn:
      order_.kind = MissionOrder::Kind::kReturn;
      return true;
    case MissionItem::Kind::kDelay:
      return stayed(view, item.hold);
    case MissionItem::Kind::kSpeed:
      speed_ = item.speed > 0.0 ? item.speed : planner::base::kInfinity;
      return true;
    case MissionItem::Kind::kJump:
      return jump(item);
    case MissionItem::Kind::kNothing:
      return true;
  }
  return true;
}

bool Mission::at_place(const MissionView& view, const Vec3& place, double radius) const {
  const Vec3 off = view.position - place;
  return off.head<2>().norm() <= radius && std::abs(off.z()) <= view.altitude_radius;
}

bool Mission::stayed(const MissionView& view, double duration) {
  if (!there_since_) there_since_ = view.time;
  return view.time - *there_since_ >= duration;
}

/// Without a yaw it looks ahead while there is a way ahead.
void Mission::fly_to(const MissionView& view, const Vec3& place, double yaw) {
  order_.kind = MissionOrder::Kind::kFly;
  order_.takeoff = false;
  order_.position = place;
  const Vec3 way = place - view.position;
  if (std::isfinite(yaw)) {
    order_.yaw = yaw;
  } else if (way.head<2>().norm() > view.acceptance_radius) {
    order_.yaw = std::atan2(way.y(), way.x());
  }
}

/// Over the place first, at the height of the item or, if that is more, its own.
bool Mission::land(const MissionView& view, const Vec3& place) {
  if (view.landed) return true;
  const Vec3 over(place.x(), place.y(), std::max(place.z(), start_.z()));
  if (!over_place_) {
    fly_to(view, over, std::numeric_limits<double>::quiet_NaN());
    over_place_ = at_place(view, over, view.acceptance_radius);
  }
  if (over_place_) {
    order_.kind = MissionOrder::Kind::kLand;
    order_.position = over;
  }
  return false;
}

bool Mission::jump(const MissionItem& item) {
  int& left = repeats_left_[current_];
  if (left == 0 || item.jump_to >= items_.size()) return true;
  if (left > 0) --left;
  current_ = item.jump_to;
  fresh_ = true;
  reached_.reset();
  return false;
}

}  // namespace jink::sim::vehicle
