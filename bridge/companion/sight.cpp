// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/sight.hpp"

#include <algorithm>
#include <utility>

#include "config/solids.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kSample = 0.04;  // s, of a path: a cell at 5 m/s

// The last of those at or before t; the first where all are later.
template <typename History>
auto before(const History& history, double t) {
  const auto after = std::upper_bound(history.begin(), history.end(), t,
                                      [](double time, const auto& entry) { return time < entry.t; });
  return after == history.begin() ? after : std::prev(after);
}

template <typename History>
void drop_old(History& history) {
  while (history.back().t - history.front().t > PoseHistory::kKept) history.pop_front();
}

template <typename History>
bool covers(const History& history, double t) {
  return !history.empty() && t >= history.front().t - PoseHistory::kBeyond &&
         t <= history.back().t + PoseHistory::kBeyond;
}

Eigen::Isometry3d mount_of(const config::CloudPolicy& cloud) {
  const Vec3& turned = cloud.orientation;
  return Eigen::Translation3d(cloud.position) * Eigen::AngleAxisd(turned.x(), Vec3::UnitZ()) *
         Eigen::AngleAxisd(turned.y(), Vec3::UnitY()) * Eigen::AngleAxisd(turned.z(), Vec3::UnitX());
}

}  // namespace

void PoseHistory::add(const vehicle::VehicleState& state) {
  if (!state.motion.heard()) return;
  if (places_.empty() || state.motion.stamp > places_.back().t) {
    places_.push_back({state.motion.stamp, state.motion.value.position, state.motion.value.velocity});
    drop_old(places_);
  }
  // Level, where nothing but a yaw is told.
  const bool told = state.attitude_stamp > base::kNever;
  const double stamp = told ? state.attitude_stamp : state.motion.stamp;
  if (!turns_.empty() && stamp <= turns_.back().t) return;
  turns_.push_back({stamp, told ? state.attitude : Eigen::Quaterniond(Eigen::AngleAxisd(state.yaw, Vec3::UnitZ()))});
  drop_old(turns_);
}

void PoseHistory::shift(const Vec3& by) {
  for (Place& place : places_) place.position += by;
}

void PoseHistory::forget() {
  places_.clear();
  turns_.clear();
}

std::optional<Eigen::Isometry3d> PoseHistory::at(double t) const {
  if (!covers(places_, t) || !covers(turns_, t)) return std::nullopt;
  const auto place = before(places_, t);
  Vec3 position = place->position + (t - place->t) * place->velocity;
  if (const auto next = std::next(place); next != places_.end() && t > place->t)
    position = place->position + (t - place->t) / (next->t - place->t) * (next->position - place->position);
  const auto turn = before(turns_, t);
  Eigen::Quaterniond attitude = turn->attitude;
  if (const auto next = std::next(turn); next != turns_.end() && t > turn->t)
    attitude = turn->attitude.slerp((t - turn->t) / (next->t - turn->t), next->attitude);
  return Eigen::Translation3d(position) * attitude;
}

Sight::Sight(const config::Mission& mission, const config::Settings& settings, map::CloudSource* source,
             const base::Clock* clock)
    : mission_(mission), settings_(settings), source_(source) {
  if (!mission.cloud || source == nullptr) return;
  mount_ = mount_of(*mission.cloud);
  const map::OccupancySettings occupancy{mission.cloud->range, mission.cloud->forget_s};
  mapper_ = std::make_unique<map::Mapper>(occupancy, mission.vehicle.radius, mission.map, clock);
}

void Sight::take(double now, Intake& intake, const Intake::FrameChange& change) {
  if (!mapper_) return;
  if (change.rebooted) poses_.forget();
  if (change.shift) poses_.shift(*change.shift);
  anew_ = anew_ || change.rebooted;
  poses_.add(intake.state());
  for (map::Cloud cloud; source_->poll(cloud);) place(now, std::move(cloud), intake);
  if (!newest_) newest_ = now;
}

void Sight::place(double now, map::Cloud cloud, Intake& intake) {
  map::CloudJob job;
  job.time = cloud.received - cloud.stamp_age;
  const std::optional<Eigen::Isometry3d> body = poses_.at(job.time);
  if (!body) {
    ++unplaced_;
    return;
  }
  newest_ = std::max(newest_.value_or(cloud.received), cloud.received);
  job.points = std::move(cloud.points);
  job.vehicle = job.sensor = body->translation();
  if (cloud.mounted) {
    job.to_local = *body * mount_;
    job.sensor = job.to_local.translation();
  }
  job.floor = std::min(mission_.ground, mission_.min_height) + config::kRelief;
  job.tracked = intake.table().predict(now, settings_.horizon.acceleration_trust);
  for (planner::base::Track& track : job.tracked) track.position -= (now - job.time) * track.velocity;
  job.shift = intake.estimate_shift();
  job.up = mission_.map_up;
  job.anew = std::exchange(anew_, false);
  mapper_->put(std::move(job));
}

double Sight::leaves_seen(const planner::base::TimedPath& path) const {
  if (!mapper_ || mission_.cloud->unknown == config::Unknown::kFree) return planner::base::kInfinity;
  std::vector<Vec3> places;
  const double begin = path.front().t;
  const auto time_of = [&](std::size_t place) { return begin + kSample * static_cast<double>(place); };
  while (time_of(places.size()) < path.back().t + kSample)
    places.push_back(planner::base::sample(path, time_of(places.size())).position);
  const std::size_t unseen = mapper_->first_unseen(places);
  return unseen < places.size() ? time_of(unseen) : planner::base::kInfinity;
}

bool Sight::is_stale(double now) const {
  return mapper_ && (!newest_ || now - *newest_ > mission_.cloud->timeout_s);
}

map::CloudSourceStatus Sight::source_status() const {
  return mapper_ ? source_->status() : map::CloudSourceStatus();
}

}  // namespace jink::bridge::companion
