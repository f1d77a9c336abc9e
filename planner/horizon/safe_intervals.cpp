// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/safe_intervals.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "planner/horizon/each_obstacle.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kEase = 0.7;           // of the cruise speed
constexpr int kStartInstants = 3;       // in which the vehicle may be where it is
constexpr double kShortestWait = 1e-6;  // s: what is less is rounding
constexpr double kRounding = 1e-9;      // m, far above it
constexpr double kThere = 0.9;          // cells from the target, within which a place is it

}  // namespace

// Instants after one at which it is `farther` than it may be, m, in which it is so still.
std::size_t SafeIntervalSearch::Mover::instants_until_near(double farther) const {
  const double sure = farther - kRounding;
  return sure < kInstants * farthest ? static_cast<std::size_t>(std::max(0.0, sure / farthest)) : kInstants;
}

// What rests is placed once.
void SafeIntervalSearch::place_obstacles(const PathRequest& request, double begin) {
  movers_.clear();
  for_each_obstacle(request.without_standing(), request.margin, [&](const auto& obstacle) {
    Mover mover;
    mover.body = obstacle.body.later(begin);
    mover.wanted = obstacle.wanted;
    mover.kept = obstacle.kept;
    for (int i = 0; i < kInstants && begin + i * kInstant <= obstacle.until; ++i) {
      const Vec3 there = obstacle.position(begin + i * kInstant);
      if (!mover.where.empty()) mover.farthest = std::max(mover.farthest, (there - mover.where.back()).norm());
      mover.where.push_back(there);
    }
    mover.rests = obstacle.body.yaw_rate == 0.0 && obstacle.until == base::kInfinity && mover.farthest == 0.0;
    if (mover.where.empty()) return;
    mover.box = {mover.where.front(), mover.where.front()};
    for (const Vec3& at : mover.where) mover.box = {mover.box.min.cwiseMin(at), mover.box.max.cwiseMax(at)};
    mover.box = geometry::grown(mover.box, mover.wanted);
    if (mover.rests) mover.where.resize(1);
    movers_.push_back(std::move(mover));
  });
  standing_.set(request.standing, {}, 0.0);
}

SafeIntervalSearch::Instants SafeIntervalSearch::free_at(const Vec3& position, const PathRequest& request) {
  if (!request.volume.contains(position)) return 0;
  const double beside = request.vehicle.radius + request.margin_beside_standing();
  if (standing_.distance(position, beside) < beside) return 0;
  Instants taken = 0;
  for (Mover& mover : movers_) {
    if (!mover.box.contains(position)) continue;
    for (std::size_t i = 0; i < mover.where.size(); ++i) {
      const double squared = (position - mover.where[i]).squaredNorm();
      if (squared >= mover.wanted * mover.wanted) {
        i += mover.instants_until_near(std::sqrt(squared) - mover.wanted);
        continue;
      }
      if (mover.body.solid != nullptr) {
        for (std::size_t n = mover.solids.size(); n < mover.where.size(); ++n)
          mover.solids.emplace_back(mover.body, mover.where[n], static_cast<double>(n) * kInstant);
        if (mover.solids[i].distance(position) >= mover.kept) continue;
      }
      if (mover.rests) return 0;
      taken |= Instants{1} << i;
    }
  }
  return ~taken;
}

std::size_t SafeIntervalSearch::place_at(const Eigen::Vector3i& cell, const PathRequest& request) {
  const auto [found, is_new] = index_.try_emplace(grid_key(cell), places_.size());
  if (!is_new) return found->second;
  Place place{cell, origin_ + cell_ * cell.cast<double>(), states_.size(), 0};
  Instants free = cell.cwiseAbs().maxCoeff() < kFarthestCell ? free_at(place.position, request) : 0;
  if (places_.empty()) free |= (Instants{1} << kStartInstants) - 1;
  for (int first = 0; free != 0;) {
    const int taken = std::countr_zero(free);
    first += taken;
    free >>= static_cast<unsigned>(taken);
    const int length = std::countr_one(free);
    State state;
    state.place = places_.size();
    state.begin = first == 0 ? -base::kInfinity : first * kInstant;
    state.end = first + length == kInstants ? base::kInfinity : (first + length - 1) * kInstant;
    states_.push_back(state);
    first += length;
    free = length == kInstants ? 0 : free >> static_cast<unsigned>(length);
  }
  place.last_state = states_.size();
  places_.push_back(place);
  return found->second;
}

double SafeIntervalSearch::time_over(const Vec3& way) const {
  return std::max(way.norm() / speed_, std::abs(way.z()) / climb_);
}

// The vehicle is in the one place until halfway, and in the other from then on.
void SafeIntervalSearch::leave(std::size_t index, const PathRequest& request) {
  const Place from = places_[states_[index].place];
  for (int n = 0; n < kGridSteps; ++n) {
    const Place& to = places_[place_at(from.cell + grid_step(n), request)];
    const double takes = time_over(to.position - from.position);
    const State& here = states_[index];
    for (std::size_t i = to.first_state; i < to.last_state; ++i) {
      State& there = states_[i];
      if (there.done) continue;
      const double arrival = std::max(here.arrival + takes, there.begin + 0.5 * takes);
      if (arrival - 0.5 * takes > here.end || arrival > there.end || arrival >= there.arrival) continue;
      if (arrival > kLookAhead) continue;
      there.arrival = arrival;
      there.departure = arrival - takes;
      there.parent = static_cast<int>(index);
      open_.push(arrival + time_over(request.target - to.position), static_cast<int>(i));
    }
  }
}

base::TimedPath SafeIntervalSearch::way_to(std::size_t state) const {
  base::TimedPath way;
  for (int i = static_cast<int>(state); i >= 0; i = states_[static_cast<std::size_t>(i)].parent) {
    const State& there = states_[static_cast<std::size_t>(i)];
    way.push_back({there.arrival, places_[there.place].position, Vec3::Zero(), Vec3::Zero()});
    if (there.parent < 0) break;
    const State& before = states_[static_cast<std::size_t>(there.parent)];
    if (there.departure > before.arrival + kShortestWait)
      way.push_back({there.departure, places_[before.place].position, Vec3::Zero(), Vec3::Zero()});
  }
  std::reverse(way.begin(), way.end());
  return way;
}

WayInTime SafeIntervalSearch::find(const PathRequest& request, const base::TimedPoint& from, double cell) {
  cell_ = cell;
  origin_ = from.position;
  speed_ = kEase * request.vehicle.cruise_speed;
  climb_ = std::min(speed_, request.vehicle.max_climb);
  place_obstacles(request, from.t);
  places_.clear();
  states_.clear();
  index_.clear();
  open_.clear();
  const std::size_t most = std::min(kMostPlaces, kMostTests / std::max<std::size_t>(1, movers_.size()));
  const auto left = [&](std::size_t i) { return time_over(request.target - places_[states_[i].place].position); };
  const auto stays = [&](std::size_t i) { return states_[i].end == base::kInfinity; };
  place_at(Eigen::Vector3i::Zero(), request);
  states_[0].arrival = 0.0;
  open_.push(left(0), 0);
  std::size_t best = 0;
  bool arrives = false;
  while (!arrives && !open_.empty() && places_.size() < most) {
    const auto next = static_cast<std::size_t>(open_.pop());
    if (states_[next].done) continue;
    states_[next].done = true;
    arrives = left(next) * speed_ <= kThere * cell_;
    if (arrives || (stays(next) && (!stays(best) || left(next) < left(best)))) best = next;
    leave(next, request);
  }
  WayInTime way{way_to(best), arrives ? from.t + states_[best].arrival : base::kInfinity, stays(best)};
  for (base::TimedPoint& point : way.path) point.t += from.t;
  return way;
}

}  // namespace jink::planner::horizon
