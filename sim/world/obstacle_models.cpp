// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/obstacle_models.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <variant>

#include "planner/base/portable_math.hpp"

namespace jink::sim::world {
namespace {

/// Below this the deviation from a straight line is rounding.
constexpr double kStraight = 1e-9;

ObstacleState state(const config::LinearMotion& m, double t) {
  return {m.position + (m.velocity + 0.5 * t * m.acceleration) * t, m.velocity + t * m.acceleration, m.acceleration};
}

ObstacleState state(const config::TrefoilMotion& m, double t) {
  const double tau = t / m.slower + m.offset;
  const double rate = 1.0 / m.slower;  // dτ/dt
  const double s1 = std::sin(tau);
  const double c1 = std::cos(tau);
  const double s2 = std::sin(2 * tau);
  const double c2 = std::cos(2 * tau);
  const double s3 = std::sin(3 * tau);
  const double c3 = std::cos(3 * tau);
  const auto scaled = [&m](double x, double y, double z) { return Vec3(m.scale.cwiseProduct(Vec3(x, y, z))); };
  return {m.center + scaled(s1 + 2 * s2, c1 - 2 * c2, -s3), rate * scaled(c1 + 4 * c2, -s1 + 4 * s2, -3 * c3),
          rate * rate * scaled(-s1 - 8 * s2, -c1 + 8 * c2, 9 * s3)};
}

ObstacleState state(const config::SineMotion& m, double t) {
  ObstacleState result;
  for (int axis = 0; axis < 3; ++axis) {
    const double omega = 2 * std::numbers::pi * m.frequency_hz[axis];
    const double amplitude = m.amplitude[axis];
    const double angle = omega * t + m.phase[axis];
    result.position[axis] = m.center[axis] + amplitude * std::sin(angle);
    result.velocity[axis] = amplitude * omega * std::cos(angle);
    result.acceleration[axis] = -amplitude * omega * omega * std::sin(angle);
  }
  return result;
}

/// Position and velocity on one axis after the time `t` between two reflecting faces, by folding the straight line.
void bounce(double start, double speed, double lo, double hi, double t, double& position, double& velocity) {
  const double width = hi - lo;
  if (!(width > 0.0)) {
    position = lo;
    velocity = 0.0;
    return;
  }
  // Downward motion is the mirror image of upward motion; upward, the fold below is [0, w) up, [w, 2w) down, which
  // gives the velocity just after a contact.
  const bool down = speed < 0.0;
  const double from = down ? hi - start : start - lo;
  // The remainder of the rounded product is exact and fma gives the product's error: nothing is lost at large t.
  const double travelled = std::abs(speed) * t;
  const double rounding = std::fma(std::abs(speed), t, -travelled);
  double along = std::fmod(std::fmod(travelled, 2 * width) + rounding + from, 2 * width);
  if (along < 0.0) along += 2 * width;
  const bool reflected = along >= width;
  if (reflected) along = 2 * width - along;
  position = std::clamp(down ? hi - along : lo + along, lo, hi);
  velocity = reflected ? -speed : speed;
}

ObstacleState state(const config::BounceMotion& m, double t) {
  ObstacleState result;
  for (int axis = 0; axis < 3; ++axis) {
    bounce(m.position[axis], m.velocity[axis], m.min[axis], m.max[axis], t, result.position[axis],
           result.velocity[axis]);
  }
  return result;
}

ObstacleState state(const config::WaypointsMotion& m, double t) {
  // The first time after t: with right-continuous velocity, t itself belongs to the segment that begins there.
  const auto next = static_cast<std::size_t>(std::upper_bound(m.times.begin(), m.times.end(), t) - m.times.begin());
  if (next == 0) return {m.points.front()};
  if (next == m.times.size()) return {m.points.back()};
  const double duration = m.times[next] - m.times[next - 1];
  const Vec3 velocity = (m.points[next] - m.points[next - 1]) / duration;
  // From the nearer end, so that the position is continuous at both.
  const double elapsed = t - m.times[next - 1];
  const Vec3 position = elapsed <= 0.5 * duration ? Vec3(m.points[next - 1] + elapsed * velocity)
                                                  : Vec3(m.points[next] - (m.times[next] - t) * velocity);
  return {position, velocity};
}

// Alone it stands: who it chases is not known here.
ObstacleState state(const config::ChaseMotion& m, double /*t*/) {
  return {m.position};
}

double speed(const config::LinearMotion& m, double t0, double t1) {
  // The norm of a velocity that is linear in time is convex: it is largest at an end.
  return std::max((m.velocity + t0 * m.acceleration).norm(), (m.velocity + t1 * m.acceleration).norm());
}

double speed(const config::TrefoilMotion& m, double /*t0*/, double /*t1*/) {
  // With s = max(|sx|, |sy|): vx² + vy² <= s² (17 + 8 cos 3τ) <= 25 s², and |vz| <= 3 |sz|; all largest at τ = 0.
  return planner::base::hypotenuse(5 * std::max(std::abs(m.scale.x()), std::abs(m.scale.y())), 3 * m.scale.z()) /
         std::abs(m.slower);
}

double speed(const config::SineMotion& m, double /*t0*/, double /*t1*/) {
  return 2 * std::numbers::pi * m.amplitude.cwiseProduct(m.frequency_hz).norm();
}

double speed(const config::BounceMotion& m, double /*t0*/, double /*t1*/) {
  return ((m.max - m.min).array() > 0.0).select(m.velocity, Vec3::Zero()).norm();
}

double speed(const config::WaypointsMotion& m, double t0, double t1) {
  double fastest = 0.0;
  for (std::size_t i = 1; i < m.times.size(); ++i) {
    if (m.times[i] < t0 || m.times[i - 1] > t1) continue;
    fastest = std::max(fastest, (m.points[i] - m.points[i - 1]).norm() / (m.times[i] - m.times[i - 1]));
  }
  return fastest;
}

double speed(const config::ChaseMotion& /*m*/, double /*t0*/, double /*t1*/) {
  return 0.0;
}

/// A curve whose second derivative is at most `acceleration` is within a h²/8 of its chord over a time h.
double smooth_deviation(double acceleration, double h) {
  return acceleration * h * h / 8;
}

/// With no more known than a speed bound: (1-u)|p - p0| + u|p - p1| <= 2 u (1-u) v h <= v h / 2.
double rough_deviation(double speed_limit, double h) {
  return 0.5 * speed_limit * h;
}

double deviation(const config::LinearMotion& m, double t0, double t1) {
  return smooth_deviation(m.acceleration.norm(), t1 - t0);
}

double deviation(const config::TrefoilMotion& m, double t0, double t1) {
  // As for the speed: ax² + ay² <= s² (65 - 16 cos 3τ) <= 81 s², and |az| <= 9 |sz|.
  const double planar = std::max(std::abs(m.scale.x()), std::abs(m.scale.y()));
  const double acceleration = 9 * planner::base::hypotenuse(planar, m.scale.z()) / (m.slower * m.slower);
  return std::min(smooth_deviation(acceleration, t1 - t0), rough_deviation(speed(m, t0, t1), t1 - t0));
}

double deviation(const config::SineMotion& m, double t0, double t1) {
  const Vec3 omega = 2 * std::numbers::pi * m.frequency_hz;
  const double acceleration = m.amplitude.cwiseProduct(omega).cwiseProduct(omega).norm();
  return std::min(smooth_deviation(acceleration, t1 - t0), rough_deviation(speed(m, t0, t1), t1 - t0));
}

double deviation(const config::BounceMotion& m, double t0, double t1) {
  // Without a reflection, and only then, the way is velocity times time. What it is short by bounds the deviation for a
  // single reflection near an end, so up to kStraight it may stand for it.
  const ObstacleState from = state(m, t0);
  const Vec3 missing = state(m, t1).position - from.position - (t1 - t0) * from.velocity;
  return missing.norm() <= kStraight ? kStraight : rough_deviation(speed(m, t0, t1), t1 - t0);
}

double deviation(const config::WaypointsMotion& m, double t0, double t1) {
  const auto corner = std::upper_bound(m.times.begin(), m.times.end(), t0);
  const bool straight = corner == m.times.end() || *corner >= t1;
  return straight ? 0.0 : rough_deviation(speed(m, t0, t1), t1 - t0);
}

double deviation(const config::ChaseMotion& /*m*/, double /*t0*/, double /*t1*/) {
  return 0.0;
}

}  // namespace

ObstacleState state_at(const config::Motion& motion, double t) {
  if (t < 0.0) return {state_at(motion, 0.0).position};
  return std::visit([t](const auto& m) { return state(m, t); }, motion);
}

double speed_bound(const config::Motion& motion, double t0, double t1) {
  if (t1 < 0.0) return 0.0;
  return std::visit([&](const auto& m) { return speed(m, std::max(t0, 0.0), t1); }, motion);
}

double chord_deviation(const config::Motion& motion, double t0, double t1) {
  if (t1 <= 0.0) return 0.0;
  // It starts within the interval, from rest.
  if (t0 < 0.0) return rough_deviation(speed_bound(motion, 0.0, t1), t1 - t0);
  return std::visit([&](const auto& m) { return deviation(m, t0, t1); }, motion);
}

}  // namespace jink::sim::world
