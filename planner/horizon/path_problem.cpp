// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/path_problem.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>

#include "planner/base/multiversion.hpp"
#include "planner/horizon/cost_lanes.hpp"
#include "planner/horizon/flight_lanes.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kLongestTail = 600.0;    // s, of straight flight after the horizon
constexpr double kLongestLanding = 2.0;   // s, in which what has settled within the horizon comes to rest
constexpr double kEven = 0.05;            // m/s, of unobstructed flight, from which on offsets change as it gets on
constexpr int kLatestLanding = 3;         // steps after it has come near
constexpr double kClearShare = 0.25;      // of the volume, at most, that volume_clearance takes on each side
constexpr double kLeastClearance = 1e-6;  // m, of volume_clearance that counts

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

const base::HorizonSettings& checked(const base::HorizonSettings& settings) {
  if (settings.waypoints < 1) throw std::invalid_argument("horizon.waypoints: not at least 1");
  if (!(settings.step > 0.0 && settings.time > 0.0)) throw std::invalid_argument("horizon.step and time: not above 0");
  return settings;
}

base::Box ball(const Vec3& center, double radius) {
  return {(center.array() - radius).matrix(), (center.array() + radius).matrix()};
}

/// Where the clearance of the volume's bounds is kept: all places where none is asked for. The target is one of them.
base::Box inner_volume(const PathRequest& request) {
  if (request.volume_clearance < kLeastClearance) return {};
  const auto& [low, high] = request.volume;
  const Vec3 inset = (kClearShare * (high - low)).cwiseMin(request.volume_clearance);
  return {(low + inset).cwiseMin(request.target), (high - inset).cwiseMax(request.target)};
}

}  // namespace

PathRequest PathRequest::with(const base::HorizonSettings& settings) {
  PathRequest request;
  request.margin = settings.margin;
  request.track_acceleration = settings.track_acceleration;
  request.sudden_change = settings.sudden_change;
  request.acceleration_trust = settings.acceleration_trust;
  return request;
}

PathProblem::PathProblem(const base::HorizonSettings& settings)
    : settings_(checked(settings)), lower_(index(3 * settings.waypoints), -1.0), upper_(lower_.size(), 1.0) {
  scene_.waypoints = settings.waypoints;
  scene_.steps_per_leg = settings.steps_per_leg();
  scene_.steps = scene_.steps_per_leg * settings.waypoints;
  if (scene_.steps > base::HorizonSettings::kMostSteps)
    throw std::invalid_argument("horizon: " + std::to_string(scene_.steps) + " steps of time / step; at most " +
                                std::to_string(base::HorizonSettings::kMostSteps));
  scene_.step = settings.step;
  scene_.per_catch_up = 1.0 / settings.catch_up;
  scene_.shortest_leg = settings.shortest_leg;
  scene_.near_target = settings.near_target;
  scene_.visit_range = settings.visit_range;
  scene_.visit_speed = settings.visit_speed;
  scene_.deviation_weight = settings.deviation_weight;
  scene_.reach.resize(index(settings.waypoints));
  scene_.unobstructed.resize(index(scene_.steps + 1));
  scene_.speed.resize(index(scene_.steps + 1));
  scene_.mean_speed.resize(index(settings.waypoints));
  scene_.uneven.resize(index(scene_.steps));
  unobstructed_.resize(index(scene_.steps + 1));
  where_.resize(index(scene_.steps));
}

void PathProblem::prepare(const PathRequest& request, const std::optional<Vec3>& via) {
  request_ = request;
  const double acceleration = most_acceleration();
  scene_.position = request.position;
  scene_.velocity = request.velocity;
  scene_.target = request.target;
  scene_.visit_steps =
      request.visit ? std::max(1.0, std::round(settings_.visit_time / settings_.step)) : base::kInfinity;
  scene_.via = via;
  const double price = std::max(1.0, request.time_price / request.vehicle.cruise_speed);
  scene_.time_weight = (via ? settings_.hurry : 1.0) * price * settings_.time_weight;
  scene_.volume = request.volume;
  scene_.inner_volume = inner_volume(request);
  scene_.per_clearance = 1.0 / std::max(kLeastClearance, request.volume_clearance);
  scene_.frame = geometry::PathFrame(request.position, request.target);
  scene_.follower = {settings_.step, 1.0 / request.vehicle.max_speed, 1.0 / request.vehicle.max_climb,
                     1.0 / (acceleration * settings_.step)};
  scene_.inverse_braking = 1.0 / (2.0 * acceleration);
  unobstructed_flight();
  predict_obstacles();
}

// Along the straight line: up to cruise speed, and braking for the target.
void PathProblem::unobstructed_flight() {
  const base::VehicleLimits& vehicle = request_.vehicle;
  const geometry::PathFrame& frame = scene_.frame;
  const double climb_share = std::abs(frame.axis.z());
  const double cruise =
      climb_share > 0.0 ? std::min(vehicle.cruise_speed, vehicle.max_climb / climb_share) : vehicle.cruise_speed;
  const double change = most_acceleration() * settings_.step;
  double distance = 0.0;
  double speed = std::clamp(request_.velocity.dot(frame.axis), 0.0, vehicle.max_speed);
  double time = 0.0;
  scene_.unobstructed[0] = frame.origin;
  for (int step = 1; step <= scene_.steps; ++step) {
    const double left = frame.length - distance;
    const double wish = std::min({cruise, std::sqrt(2.0 * braking() * left), left / settings_.catch_up});
    const double next = std::clamp(wish, speed - change, speed + change);
    distance = std::min(frame.length, distance + 0.5 * (speed + next) * settings_.step);
    speed = std::max(0.0, next);
    if (frame.length - distance > settings_.near_target) time = step * settings_.step;
    unobstructed_[index(step)] = distance;
    scene_.unobstructed[index(step)] = frame.origin + distance * frame.axis;
    scene_.speed[index(step)] = speed;
  }
  change_offsets();
  scene_.cruise = cruise;
  scene_.unobstructed_time = time + (frame.length - distance) / cruise;
  for (int k = 0; k < settings_.waypoints; ++k) {
    const int step = (k + 1) * scene_.steps_per_leg;
    const double t = step * settings_.step;
    const double along = unobstructed_[index(step)];
    scene_.reach[index(k)] = {std::max(settings_.arrival, std::min(frame.length, vehicle.max_speed * t) - along),
                              along + std::min(settings_.back_range, vehicle.max_speed * t),
                              std::min(settings_.lateral_range, vehicle.max_speed * t)};
  }
}

// An offset along the axis changes as unobstructed flight gets on: evenly it would have a vehicle that sets out, and is
// to be slower than that, fly back at first. At rest it changes evenly; so does what leads back, from the start on: a
// vehicle that put it off would put it off again in each plan.
void PathProblem::change_offsets() {
  const double leg = scene_.steps_per_leg * settings_.step;
  for (int n = 0; n < scene_.steps; ++n) {
    const int i = n % scene_.steps_per_leg;
    const double begun = unobstructed_[index(n - i)];
    const double whole = unobstructed_[index(n - i + scene_.steps_per_leg)] - begun + kEven * leg;
    scene_.mean_speed[index(n / scene_.steps_per_leg)] = whole / leg;
    const double since = i * settings_.step;
    const double changed = (unobstructed_[index(n)] - begun + kEven * since) / whole * leg;
    const double rate = (scene_.speed[index(n + 1)] + kEven) / whole * leg;
    scene_.uneven[index(n)] = rate - 1.0 + (changed - since) * scene_.per_catch_up;
  }
}

Clearance PathProblem::clearance() const {
  return {request_.vehicle.radius + request_.margin,
          settings_.sigma_factor,
          request_.track_acceleration,
          request_.sudden_change,
          settings_.clearance_limit,
          request_.acceleration_trust,
          request_.vehicle.radius + request_.margin_beside_standing(),
          base::HorizonSettings::kReaction,
          settings_.emergency_acceleration(request_.vehicle.max_acceleration),
          horizon()};
}

// Where any motion can be. Each step moves the velocity along a straight line towards one that keeps the limits, by at
// most the change that a step allows. So neither speed nor climb exceeds its limit or, where that is above, its value
// at the start; and after time t the position is within acceleration · t² / 2 of straight flight from the start.
void PathProblem::predict_obstacles() {
  const base::VehicleLimits& vehicle = request_.vehicle;
  const double speed = std::max(vehicle.max_speed, request_.velocity.norm());
  const double climb = std::max(vehicle.max_climb, std::abs(request_.velocity.z()));
  const double acceleration = most_acceleration();
  base::Box before = ball(request_.position, 0.0);
  for (int step = 0; step < scene_.steps; ++step) {
    const double t = (step + 1) * settings_.step;
    const base::Box fastest = ball(request_.position, speed * t);
    const base::Box turning = ball(request_.position + t * request_.velocity, 0.5 * acceleration * t * t);
    base::Box now{fastest.min.cwiseMax(turning.min), fastest.max.cwiseMin(turning.max)};
    now.min.z() = std::max(now.min.z(), request_.position.z() - climb * t);
    now.max.z() = std::min(now.max.z(), request_.position.z() + climb * t);
    where_[index(step)] = {before.min.cwiseMin(now.min), before.max.cwiseMax(now.max)};
    before = now;
  }
  obstacles_.build(request_.tracks, request_.paths, request_.standing, clearance(), settings_.step, speed, where_);
}

// The lanes that are left over repeat the last solution.
template <std::size_t kLanes>
[[gnu::always_inline]] inline void PathProblem::evaluate_lanes(const double* x,
                                                               std::span<optimizer::Cost> costs) const {
  std::array<const double*, kLanes> variables;   // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
  std::array<optimizer::Cost*, kLanes> results;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::size_t solution = std::min(i, costs.size() - 1);
    variables[i] = x + solution * lower_.size();
    results[i] = i < costs.size() ? &costs[i] : nullptr;
  }
  FlightLanes<kLanes> flight(scene_, variables);
  CostLanes<kLanes> meter(scene_, obstacles_, flight.position);
  int n = 0;
  for (int leg = 0; leg < scene_.waypoints; ++leg) {
    flight.begin_leg(leg);
    for (int i = 0; i < scene_.steps_per_leg; ++i, ++n) {
      flight.fly(n, i);
      meter.add(n, flight.position);
    }
    meter.turn(flight.position);
  }
  meter.finish(results);
}

JINK_MULTIVERSION void PathProblem::evaluate_twelve(const double* x, std::span<optimizer::Cost> costs) const {
  evaluate_lanes<12>(x, costs);
}

JINK_MULTIVERSION void PathProblem::evaluate_eight(const double* x, std::span<optimizer::Cost> costs) const {
  evaluate_lanes<8>(x, costs);
}

JINK_MULTIVERSION void PathProblem::evaluate_four(const double* x, std::span<optimizer::Cost> costs) const {
  evaluate_lanes<4>(x, costs);
}

// Three registers at a time keep the processor busy while each step waits for the one before.
void PathProblem::evaluate(std::span<const double> x, std::span<optimizer::Cost> costs) const {
  assert(x.size() == costs.size() * lower_.size());
  constexpr std::size_t kMost = 12;
  for (std::size_t i = 0; i < costs.size(); i += kMost) {
    const std::span<optimizer::Cost> block = costs.subspan(i, std::min(kMost, costs.size() - i));
    const double* first = x.data() + i * lower_.size();
    if (block.size() > 8) {
      evaluate_twelve(first, block);
    } else if (block.size() > 4) {
      evaluate_eight(first, block);
    } else {
      evaluate_four(first, block);
    }
  }
}

base::TimedPath PathProblem::motion(std::span<const double> x) const {
  base::TimedPath path;
  path.reserve(index(scene_.steps + 2));
  path.push_back({0.0, request_.position, request_.velocity, Vec3::Zero()});
  FlightLanes<1> flight(scene_, {x.data()});
  int n = 0;
  for (int leg = 0; leg < scene_.waypoints; ++leg) {
    flight.begin_leg(leg);
    for (int i = 0; i < scene_.steps_per_leg; ++i, ++n) {
      flight.fly(n, i);
      const Vec3 velocity = flight.velocity.lane(0);
      path.back().acceleration = (velocity - path.back().velocity) / settings_.step;
      path.push_back({(n + 1) * settings_.step, flight.position.lane(0), velocity, Vec3::Zero()});
    }
  }
  fly_to_target(path);
  return path;
}

// A path that has settled near the target within the horizon ends when it came there, on the target: it lands from
// where it was shortly before, of all such landings by the one that asks for the least, if that is never farther than
// settings_.arrival from the path. Else, or where there is none, straight on from where the path ends.
void PathProblem::fly_to_target(base::TimedPath& path) const {
  const base::VehicleLimits& vehicle = request_.vehicle;
  const double change = 1.0 / scene_.follower.inverse_change;  // of the velocity, in a step
  const Approach approach(
      request_.target, {settings_.step, vehicle.cruise_speed, vehicle.max_climb, change, braking() * settings_.step});
  if (const std::size_t settled = settled_from(path); settled < path.size()) {
    path.resize(settled + 1);
    if (land_at_end(approach, path)) return;
  }
  const int longest = static_cast<int>(std::min(kLongestTail / settings_.step, 1e6));
  for (int steps = 0; steps < longest; ++steps) {
    const base::TimedPoint now = path.back();
    if (now.position == request_.target && now.velocity.isZero(0.0)) break;
    if (const std::optional<Landing> landing = approach.landing(now); landing && steps + landing->braking < longest) {
      approach.fly(*landing, path);
      break;
    }
    const Vec3 wish = approach.wished_velocity(now);
    Vec3 p = now.position;
    Vec3 v = now.velocity;
    scene_.follower.advance(p.x(), p.y(), p.z(), v.x(), v.y(), v.z(), wish.x(), wish.y(), wish.z());
    path.back().acceleration = (v - now.velocity) / settings_.step;
    path.push_back({now.t + settings_.step, p, v, Vec3::Zero()});
  }
  path.back().acceleration.setZero();
}

// The first point from which on all are at the target, slow enough to stop; past the end where the last one is not.
std::size_t PathProblem::settled_from(const base::TimedPath& path) const {
  const double stoppable = 1.0 / scene_.follower.inverse_change;  // speed that one step takes away
  const auto settled = [&](const base::TimedPoint& point) {
    return (point.position - request_.target).norm() <= settings_.arrival && point.velocity.norm() <= stoppable;
  };
  std::size_t first = path.size();
  while (first > 1 && settled(path[first - 1])) --first;
  return first;
}

// Lands where the path ends, or as few steps later as there is a landing.
bool PathProblem::land_at_end(const Approach& approach, base::TimedPath& path) const {
  const int end = static_cast<int>(path.size()) - 1;
  const int longest = static_cast<int>(kLongestLanding / settings_.step);
  for (int late = 0; late <= kLatestLanding; ++late) {
    std::optional<Landing> best;
    for (int steps = std::max(2, late); steps <= std::min(end + late, longest); ++steps) {
      const std::size_t first = index(end + late - steps);
      const std::optional<Landing> landing = approach.landing_in(path[first], steps);
      if (!landing || (best && best->change <= landing->change)) continue;
      bool near = true;
      for (std::size_t i = first + 1; i < path.size() && near; ++i) {
        const Vec3 landed = approach.after(*landing, path[first], static_cast<int>(i - first)).position;
        near = (landed - path[i].position).norm() <= settings_.arrival;
      }
      if (near) best = landing;
    }
    if (!best) continue;
    path.resize(index(end + late - best->braking));
    approach.fly(*best, path);
    return true;
  }
  return false;
}

optimizer::Cost PathProblem::cost_of(const base::TimedPath& path) const {
  std::vector<Vec3> positions(index(scene_.steps + 1));
  for (int n = 0; n <= scene_.steps; ++n) positions[index(n)] = base::sample(path, n * settings_.step).position;
  std::vector<base::Box> where(index(scene_.steps));
  double most = 0.0;  // moved in a step, m
  for (std::size_t n = 0; n < where.size(); ++n) {
    where[n] = {positions[n].cwiseMin(positions[n + 1]), positions[n].cwiseMax(positions[n + 1])};
    most = std::max(most, (positions[n + 1] - positions[n]).norm());
  }
  NearbyObstacles obstacles;
  obstacles.build(request_.tracks, request_.paths, request_.standing, clearance(), settings_.step,
                  most / settings_.step, where);
  PointLanes<1> position;
  position.set(positions[0]);
  CostLanes<1> meter(scene_, obstacles, position);
  for (int n = 0; n < scene_.steps; ++n) {
    position.set(positions[index(n + 1)]);
    meter.add(n, position);
    if ((n + 1) % scene_.steps_per_leg == 0) meter.turn(position);
  }
  optimizer::Cost cost;
  meter.finish({&cost});
  return cost;
}

void PathProblem::encode_path(const base::TimedPath& path, std::span<double> x) const {
  for (int k = 0; k < settings_.waypoints; ++k) {
    const std::size_t i = index(k);
    const int step = (k + 1) * scene_.steps_per_leg;
    const Vec3 q = scene_.frame.from_enu(base::sample(path, step * settings_.step).position);
    const double along = q.x() - unobstructed_[index(step)];
    x[3 * i] = std::clamp(along / (along > 0.0 ? scene_.reach[i].ahead : scene_.reach[i].behind), -1.0, 1.0);
    x[3 * i + 1] = std::clamp(q.y() / scene_.reach[i].aside, -1.0, 1.0);
    x[3 * i + 2] = std::clamp(q.z() / scene_.reach[i].aside, -1.0, 1.0);
  }
}

}  // namespace jink::planner::horizon
