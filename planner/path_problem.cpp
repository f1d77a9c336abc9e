// SPDX-License-Identifier: BSD-3-Clause
#include "planner/path_problem.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>

#include "planner/obstacle_motion.hpp"

namespace jink::planner {
namespace {

constexpr double kCatchUp = 0.4;        // s, in which a distance from the wished position is made good
constexpr double kArrival = 0.05;       // m, where a path is at the target
constexpr double kNear = 0.3;           // m, where time stops counting
constexpr double kShortLeg = 0.1;       // m, legs below have no direction
constexpr double kLongestTail = 600.0;  // s, of straight flight after the horizon
constexpr std::size_t kChunk = 32;      // obstacles tested at a time

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

Vec3 limited(const Vec3& v, double limit) {
  const double norm = v.norm();
  return norm > limit ? Vec3(v * (limit / norm)) : v;
}

const HorizonSettings& checked(const HorizonSettings& settings) {
  if (settings.waypoints < 1) throw std::invalid_argument("horizon.waypoints: not at least 1");
  if (!(settings.step > 0.0 && settings.time > 0.0)) throw std::invalid_argument("horizon.step and time: not above 0");
  return settings;
}

/// How far a point lies outside a volume.
double distance_outside(const Box& volume, const Vec3& p) {
  return (p - p.cwiseMax(volume.min).cwiseMin(volume.max)).norm();
}

}  // namespace

PathProblem::PathProblem(const HorizonSettings& settings)
    : settings_(checked(settings)),
      steps_per_leg_(std::max(1, static_cast<int>(std::lround(settings.time / settings.waypoints / settings.step)))),
      steps_(steps_per_leg_ * settings.waypoints),
      lower_(index(3 * settings.waypoints), -1.0),
      upper_(lower_.size(), 1.0),
      speed_(index(steps_ + 1)),
      undisturbed_(index(steps_ + 1)),
      ahead_(index(settings.waypoints)),
      behind_(ahead_.size()),
      aside_(ahead_.size()) {
  if (steps_ > kMaxSteps)
    throw std::invalid_argument("horizon: " + std::to_string(steps_) + " steps of time / step; at most " +
                                std::to_string(kMaxSteps));
}

void PathProblem::prepare(const PathRequest& request) {
  request_ = request;
  frame_ = PathFrame(request.position, request.target);
  undisturbed_flight();
  predict_obstacles();
}

// Along the straight line: up to cruise speed, and braking for the target.
void PathProblem::undisturbed_flight() {
  const VehicleLimits& vehicle = request_.vehicle;
  const double climb_share = std::abs(frame_.axis.z());
  cruise_ = climb_share > 0.0 ? std::min(vehicle.cruise_speed, vehicle.max_climb / climb_share) : vehicle.cruise_speed;
  const double change = settings_.acceleration_share * vehicle.max_acceleration * settings_.step;
  double distance = 0.0;
  double speed = std::clamp(request_.velocity.dot(frame_.axis), 0.0, vehicle.max_speed);
  undisturbed_time_ = 0.0;
  for (int step = 1; step <= steps_; ++step) {
    const double left = frame_.length - distance;
    const double wish = std::min({cruise_, std::sqrt(2.0 * settings_.braking * left), left / kCatchUp});
    const double next = std::clamp(wish, speed - change, speed + change);
    distance = std::min(frame_.length, distance + 0.5 * (speed + next) * settings_.step);
    speed = std::max(0.0, next);
    if (frame_.length - distance > kNear) undisturbed_time_ = step * settings_.step;
    undisturbed_[index(step)] = distance;
    speed_[index(step)] = speed;
  }
  undisturbed_time_ += (frame_.length - distance) / cruise_;
  for (int k = 0; k < settings_.waypoints; ++k) {
    const int step = (k + 1) * steps_per_leg_;
    const double t = step * settings_.step;
    const double along = undisturbed_[index(step)];
    ahead_[index(k)] = std::max(kArrival, std::min(frame_.length, vehicle.max_speed * t) - along);
    behind_[index(k)] = along + std::min(settings_.back_range, vehicle.max_speed * t);
    aside_[index(k)] = std::min(settings_.lateral_range, vehicle.max_speed * t);
  }
}

void PathProblem::predict_obstacles() {
  const auto reach = [&](double t) {
    return request_.vehicle.max_speed * t + request_.velocity.norm() * settings_.step;
  };
  // Clearance asked for on top of the hard margin after t seconds.
  const auto uncertainty = [&](const Track& track, double t) {
    const double ahead = t + track.age;
    const double sigma = std::hypot(track.position_sigma, track.velocity_sigma * ahead);
    return std::min(settings_.clearance_limit,
                    settings_.sigma_factor * sigma + 0.5 * request_.track_acceleration * ahead * ahead);
  };
  const auto hard = [&](const Track& track) { return track.radius + request_.vehicle.radius + request_.margin; };
  std::vector<const Track*> kept;
  for (const Track& track : request_.tracks) {
    for (int n = 0; n <= steps_; ++n) {
      const double t = n * settings_.step;
      const double distance = (predict_position(track, t, request_.acceleration_trust) - request_.position).norm();
      const double moved = track.velocity.norm() * settings_.step;  // between this instant and the next
      if (distance > reach(t) + hard(track) + uncertainty(track, t) + moved) continue;
      kept.push_back(&track);
      break;
    }
  }
  kept_ = kept.size();
  const std::size_t cells = kept_ * index(steps_ + 1);
  for (std::vector<double>* row : {&x_, &y_, &z_, &hard_, &soft_}) row->resize(cells);
  for (int n = 0; n <= steps_; ++n) {
    const double t = n * settings_.step;
    for (std::size_t j = 0; j < kept_; ++j) {
      const std::size_t cell = index(n) * kept_ + j;
      const Vec3 p = predict_position(*kept[j], t, request_.acceleration_trust);
      x_[cell] = p.x();
      y_[cell] = p.y();
      z_[cell] = p.z();
      hard_[cell] = hard(*kept[j]);
      soft_[cell] = hard_[cell] + uncertainty(*kept[j], t);
    }
  }
}

// ENU offset from undisturbed flight at waypoint k (0: the present), moved into the volume where it leads out of it.
Vec3 PathProblem::offset(std::span<const double> x, int k) const {
  if (k == 0) return Vec3::Zero();
  const std::size_t i = index(k - 1);
  const double along = x[3 * i] * (x[3 * i] > 0.0 ? ahead_[i] : behind_[i]);
  const Vec3 base = undisturbed(k * steps_per_leg_);
  const Vec3 wish =
      base + along * frame_.axis + x[3 * i + 1] * aside_[i] * frame_.left + x[3 * i + 2] * aside_[i] * frame_.up;
  return wish.cwiseMax(request_.volume.min).cwiseMin(request_.volume.max) - base;
}

void PathProblem::advance(Flight& flight, const Vec3& wish) const {
  const VehicleLimits& vehicle = request_.vehicle;
  Vec3 bounded = limited(wish, vehicle.max_speed);
  if (std::abs(bounded.z()) > vehicle.max_climb) bounded *= vehicle.max_climb / std::abs(bounded.z());
  const Vec3 change =
      limited(bounded - flight.velocity, settings_.acceleration_share * vehicle.max_acceleration * settings_.step);
  flight.position += (flight.velocity + 0.5 * change) * settings_.step;
  flight.velocity += change;
}

template <typename Visit>
void PathProblem::fly(std::span<const double> x, const Visit& visit) const {
  Flight flight{request_.position, request_.velocity};
  Vec3 begin = offset(x, 0);
  for (int leg = 0; leg < settings_.waypoints; ++leg) {
    const Vec3 end = offset(x, leg + 1);
    const Vec3 drift = (end - begin) / (steps_per_leg_ * settings_.step);
    for (int i = 0; i < steps_per_leg_; ++i) {
      const int step = leg * steps_per_leg_ + i;
      const Vec3 wished = undisturbed(step) + begin + i * settings_.step * drift;
      advance(flight, speed_[index(step + 1)] * frame_.axis + drift + (wished - flight.position) / kCatchUp);
      visit(step + 1, flight);
    }
    begin = end;
  }
}

void PathProblem::evaluate(std::span<const double> x, std::span<Cost> costs) const {
  std::array<Vec3, kMaxSteps + 1> positions;
  const auto d = index(dimension());
  for (std::size_t i = 0; i < costs.size(); ++i) {
    positions[0] = request_.position;
    fly(x.subspan(i * d, d), [&](int step, const Flight& flight) { positions[index(step)] = flight.position; });
    costs[i] = cost_of_positions({positions.data(), index(steps_ + 1)});
  }
}

// The way from the end of the horizon to the target: first to a stop, as far as braking takes, then straight on (or
// back, where the target was overrun). Without the first part a path that comes fast would be the shorter one.
double PathProblem::straight_rest(const Vec3& before, const Vec3& end) const {
  const Vec3 last = end - before;
  const double speed = last.norm() / settings_.step;
  const double stopping = speed * speed / (2.0 * settings_.acceleration_share * request_.vehicle.max_acceleration);
  const Vec3 stop = speed > 0.0 ? Vec3(end + last * (stopping / last.norm())) : end;
  return stopping + (request_.target - stop).norm();
}

Cost PathProblem::cost_of_positions(std::span<const Vec3> positions) const {
  Cost cost;
  double length = 0.0;
  double arrival = 0.0;
  double deviation = 0.0;
  for (int step = 0; step < steps_; ++step) {
    const Vec3& from = positions[index(step)];
    const Vec3& to = positions[index(step + 1)];
    length += (to - from).norm();
    if ((to - request_.target).squaredNorm() > kNear * kNear) arrival = (step + 1) * settings_.step;
    deviation += (to - undisturbed(step + 1)).norm();
    cost.violation += distance_outside(request_.volume, to) * settings_.step;
    add_obstacles(step, from, to, cost);
  }
  const double rest = straight_rest(positions[index(steps_ - 1)], positions.back());
  if (arrival == horizon()) arrival += rest / cruise_;
  const double lost = std::max(0.0, arrival - undisturbed_time_);
  cost.f[0] = length + rest + settings_.time_weight * cruise_ * lost + settings_.deviation_weight * deviation / steps_;

  Vec3 direction = request_.velocity;
  const Vec3* corner = &positions[0];
  for (int k = 1; k <= settings_.waypoints + 1; ++k) {
    const Vec3& next = k <= settings_.waypoints ? positions[index(k * steps_per_leg_)] : request_.target;
    const Vec3 leg = next - *corner;
    if (leg.norm() < kShortLeg) continue;
    cost.f[1] += angle_between(direction, leg);
    direction = leg;
    corner = &next;
  }
  return cost;
}

void PathProblem::add_obstacles(int step, const Vec3& from, const Vec3& to, Cost& cost) const {
  const double weight = settings_.step / (0.5 + step * settings_.step);  // what is near in time counts more
  const std::size_t now = index(step) * kept_;
  const std::size_t next = now + kept_;
  std::array<double, kChunk> squared{};
  for (std::size_t begin = 0; begin < kept_; begin += kChunk) {
    const std::size_t count = std::min(kChunk, kept_ - begin);
    // The swept test of geometry.hpp, laid out so that the compiler does several obstacles at once.
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t a = now + begin + i;
      const std::size_t b = next + begin + i;
      const double px = from.x() - x_[a];
      const double py = from.y() - y_[a];
      const double pz = from.z() - z_[a];
      const double dx = to.x() - x_[b] - px;
      const double dy = to.y() - y_[b] - py;
      const double dz = to.z() - z_[b] - pz;
      const double lengths = dx * dx + dy * dy + dz * dz + 1e-300;
      const double s = std::min(1.0, std::max(0.0, -(dx * px + dy * py + dz * pz) / lengths));
      const double qx = px + s * dx;
      const double qy = py + s * dy;
      const double qz = pz + s * dz;
      squared[i] = qx * qx + qy * qy + qz * qz;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double soft = soft_[next + begin + i];
      if (squared[i] >= soft * soft) continue;
      const double hard = hard_[next + begin + i];
      const double distance = std::sqrt(squared[i]);
      if (soft > hard) {
        const double depth = std::min(1.0, (soft - distance) / (soft - hard));
        cost.f[2] += weight * depth * depth;
      }
      if (distance < hard) cost.violation += weight * (hard - distance);
    }
  }
}

TimedPath PathProblem::motion(std::span<const double> x) const {
  TimedPath path;
  path.reserve(index(steps_ + 2));
  path.push_back({0.0, request_.position, request_.velocity, Vec3::Zero()});
  Flight last{request_.position, request_.velocity};
  fly(x, [&](int step, const Flight& flight) {
    path.back().acceleration = (flight.velocity - last.velocity) / settings_.step;
    path.push_back({step * settings_.step, flight.position, flight.velocity, Vec3::Zero()});
    last = flight;
  });
  fly_to_target(path, last);
  return path;
}

// Straight on to the target and to rest there; a path that has settled at the target already ends where it arrived.
void PathProblem::fly_to_target(TimedPath& path, Flight flight) const {
  const auto away = [&](const TimedPoint& point) { return (point.position - request_.target).norm() > kArrival; };
  for (double tail = 0.0; away(path.back()) && tail < kLongestTail; tail += settings_.step) {
    const Vec3 way = request_.target - flight.position;
    const double distance = way.norm();
    const double speed =
        std::min({request_.vehicle.cruise_speed, std::sqrt(2.0 * settings_.braking * distance), distance / kCatchUp});
    const Vec3 before = flight.velocity;
    advance(flight, way * (speed / distance));
    path.back().acceleration = (flight.velocity - before) / settings_.step;
    path.push_back({path.back().t + settings_.step, flight.position, flight.velocity, Vec3::Zero()});
  }
  if (away(path.back())) return;
  while (path.size() > 2 && !away(path[path.size() - 2])) path.pop_back();
  path.back().position = request_.target;
  path.back().velocity.setZero();
  path.back().acceleration.setZero();
}

Cost PathProblem::cost_of(const TimedPath& path) const {
  std::array<Vec3, kMaxSteps + 1> positions;
  for (int n = 0; n <= steps_; ++n) positions[index(n)] = sample(path, n * settings_.step).position;
  return cost_of_positions({positions.data(), index(steps_ + 1)});
}

void PathProblem::imitate(const TimedPath& path, std::span<double> x) const {
  for (int k = 0; k < settings_.waypoints; ++k) {
    const std::size_t i = index(k);
    const int step = (k + 1) * steps_per_leg_;
    const Vec3 q = frame_.from_enu(sample(path, step * settings_.step).position);
    const double along = q.x() - undisturbed_[index(step)];
    x[3 * i] = std::clamp(along / (along > 0.0 ? ahead_[i] : behind_[i]), -1.0, 1.0);
    x[3 * i + 1] = std::clamp(q.y() / aside_[i], -1.0, 1.0);
    x[3 * i + 2] = std::clamp(q.z() / aside_[i], -1.0, 1.0);
  }
}

void PathProblem::manoeuvre(double share, double left, double up, std::span<double> x) const {
  for (int k = 0; k < settings_.waypoints; ++k) {
    const std::size_t i = index(k);
    const double kept = 3 * k < 2 * settings_.waypoints ? 1.0 : 0.0;
    x[3 * i] = kept * share;
    x[3 * i + 1] = kept * std::clamp(left / aside_[i], -1.0, 1.0);
    x[3 * i + 2] = kept * std::clamp(up / aside_[i], -1.0, 1.0);
  }
}

}  // namespace jink::planner
