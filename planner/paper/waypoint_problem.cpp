// SPDX-License-Identifier: BSD-3-Clause
#include "planner/paper/waypoint_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/base/multiversion.hpp"
#include "planner/base/portable_math.hpp"
#include "planner/geometry/obstacle_motion.hpp"

namespace jink::planner::paper {
namespace {

constexpr double kShortest = 1e-9;  // m, below which a segment has no direction
constexpr std::size_t kLanes = 8;   // solutions that are evaluated together
using Lane = std::array<double, kLanes>;

double flight_time(double length, double climb, const base::VehicleLimits& vehicle) {
  return std::max(length / vehicle.cruise_speed, climb / vehicle.max_climb);
}

}  // namespace

double segment_duration(const Vec3& from, const Vec3& to, const base::VehicleLimits& vehicle) {
  return flight_time((to - from).norm(), std::abs(to.z() - from.z()), vehicle);
}

/// Where the next waypoint of each lane lies from `from`, and how long the way takes.
struct WaypointProblem::Lanes {
  Lane dx, dy, dz, length, duration;
};

// Of the segments to any waypoint of the search box.
WaypointProblem::Reach WaypointProblem::reach() const {
  base::Box hull{step_.from, step_.from};
  for (const double u : {step_.lower[0], step_.upper[0]}) {
    for (const double v : {step_.lower[1], step_.upper[1]}) {
      const Vec3 corner = waypoint(u, v);
      hull.min = hull.min.cwiseMin(corner);
      hull.max = hull.max.cwiseMax(corner);
    }
  }
  const Vec3 farthest = (hull.max - step_.from).cwiseMax(step_.from - hull.min);
  return {hull, flight_time(farthest.norm(), farthest.z(), vehicle_)};
}

void WaypointProblem::prepare(const Step& step, std::span<const base::Track> tracks) {
  step_ = step;
  spheres_.clear();
  virtual_spheres_.clear();
  const Reach within = reach();
  for (const base::Track& track : tracks) {
    add_if_near(track, track.radius + vehicle_.radius + settings_.margin, within);
  }
  find_narrow_passes(tracks, within);
}

void WaypointProblem::add_if_near(const base::Track& track, double radius, const Reach& reach) {
  const double longest = reach.longest;
  const double grown = radius + track.acceleration.norm() * longest * longest / 8.0;
  const Vec3 moved = longest * track.velocity;
  const Vec3 turned = 0.5 * longest * longest * track.acceleration;
  const Vec3 low = track.position + moved.cwiseMin(0.0) + turned.cwiseMin(0.0);
  const Vec3 high = track.position + moved.cwiseMax(0.0) + turned.cwiseMax(0.0);
  const bool near = ((low - reach.hull.max).array() <= grown).all() && ((reach.hull.min - high).array() <= grown).all();
  if (!near) return;
  spheres_.push_back(
      {step_.from - track.position, track.velocity, 0.5 * track.acceleration, radius, track.acceleration.norm() / 8.0});
}

void WaypointProblem::find_narrow_passes(std::span<const base::Track> tracks, const Reach& reach) {
  for (std::size_t a = 0; a < tracks.size(); ++a) {
    for (std::size_t b = a + 1; b < tracks.size(); ++b) {
      if (std::abs(tracks[a].position.z() - tracks[b].position.z()) > settings_.narrow_altitude) continue;
      const double gap = (tracks[a].position - tracks[b].position).norm() - tracks[a].radius - tracks[b].radius;
      if (gap >= settings_.narrow_gap) continue;
      base::Track sphere;
      sphere.position = 0.5 * (tracks[a].position + tracks[b].position);
      sphere.velocity = 0.5 * (tracks[a].velocity + tracks[b].velocity);
      sphere.acceleration = 0.5 * (tracks[a].acceleration + tracks[b].acceleration);
      sphere.radius = 0.5 * vehicle_.length;  // r_v of Eq. (15)
      virtual_spheres_.push_back(sphere);
      add_if_near(sphere, sphere.radius, reach);
    }
  }
}

/// The work on a block of lanes, compiled for several instruction sets.
struct WaypointProblem::Kernel {
  // Distance during the segment: the quadratic in relative motion of geometry.hpp, t in [0, 1].
  JINK_INLINED static void add_swept(const Sphere& sphere, const Lanes& to, Lane& violation) {
    const double ox = sphere.offset.x();
    const double oy = sphere.offset.y();
    const double oz = sphere.offset.z();
    Lane squared;
    Lane limit;
    double nearest = 1.0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double t = to.duration[i];
      const double cx = to.dx[i] - t * (sphere.velocity.x() + t * sphere.half_acceleration.x());
      const double cy = to.dy[i] - t * (sphere.velocity.y() + t * sphere.half_acceleration.y());
      const double cz = to.dz[i] - t * (sphere.velocity.z() + t * sphere.half_acceleration.z());
      const double change = cx * cx + cy * cy + cz * cz;
      const double closing = -(cx * ox + cy * oy + cz * oz);
      const double clipped = closing < 0.0 ? 0.0 : (closing > change ? change : closing);
      const double s = clipped / (change > 0.0 ? change : 1.0);
      const double qx = ox + s * cx;
      const double qy = oy + s * cy;
      const double qz = oz + s * cz;
      squared[i] = qx * qx + qy * qy + qz * qz;
      limit[i] = sphere.radius + t * t * sphere.bulge;
    }
    for (std::size_t i = 0; i < kLanes; ++i) nearest = std::min(nearest, squared[i] - limit[i] * limit[i]);
    if (nearest >= 0.0) return;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double g = limit[i] - std::sqrt(squared[i]);
      violation[i] += g > 0.0 ? g * g : 0.0;
    }
  }

  // The discriminant of Eq. (14), as line_discriminant() of geometry.hpp.
  JINK_INLINED static void add_line(const Sphere& sphere, const Lanes& to, Lane& violation) {
    const double C = sphere.offset.squaredNorm() - sphere.radius * sphere.radius;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double A = to.dx[i] * to.dx[i] + to.dy[i] * to.dy[i] + to.dz[i] * to.dz[i];
      const double B =
          2.0 * (to.dx[i] * sphere.offset.x() + to.dy[i] * sphere.offset.y() + to.dz[i] * sphere.offset.z());
      const double g = B * B - 4.0 * A * C;
      violation[i] += g > 0.0 ? g * g : 0.0;
    }
  }

  JINK_INLINED static void measure(const WaypointProblem& problem, Lanes& to) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      to.length[i] = std::sqrt(to.dx[i] * to.dx[i] + to.dy[i] * to.dy[i] + to.dz[i] * to.dz[i]);
      to.duration[i] = flight_time(to.length[i], std::abs(to.dz[i]), problem.vehicle_);
    }
  }

  JINK_INLINED static void violations(const WaypointProblem& problem, const Lanes& to, Lane& violation) {
    violation.fill(0.0);
    const bool line = problem.settings_.constraint == base::Constraint::kPaper;
    for (const Sphere& sphere : problem.spheres_) {
      if (line) {
        add_line(sphere, to, violation);
      } else {
        add_swept(sphere, to, violation);
      }
    }
  }

  // Objectives of kLanes solutions x[2 i], x[2 i + 1].
  JINK_MULTIVERSION static void evaluate(const WaypointProblem& problem, const double* x, Lane& f1, Lane& f2) {
    const Step& step = problem.step_;
    Lanes to;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below and by measure
    Lane violation;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double u = x[2 * i];
      const double v = x[2 * i + 1];
      const auto along = [&](int k) {
        const double p = step.base[k] + u * step.lateral1[k] + v * step.lateral2[k];
        const double raised = p < step.volume.min[k] ? step.volume.min[k] : p;
        return (raised > step.volume.max[k] ? step.volume.max[k] : raised) - step.from[k];
      };
      to.dx[i] = along(0);
      to.dy[i] = along(1);
      to.dz[i] = along(2);
    }
    measure(problem, to);
    violations(problem, to, violation);
    const Vec3 rest = step.target - step.from;
    const Vec3& d = step.direction;
    const double steering_limit = problem.settings_.steering_limit_deg * std::numbers::pi / 180.0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double penalty = problem.settings_.penalty * violation[i];  // Eq. (17)
      const double rx = rest.x() - to.dx[i];
      const double ry = rest.y() - to.dy[i];
      const double rz = rest.z() - to.dz[i];
      f1[i] = to.length[i] + std::sqrt(rx * rx + ry * ry + rz * rz) + penalty;  // Eq. (2)
      const double sx = d.y() * to.dz[i] - d.z() * to.dy[i];
      const double sy = d.z() * to.dx[i] - d.x() * to.dz[i];
      const double sz = d.x() * to.dy[i] - d.y() * to.dx[i];
      const double across = std::sqrt(sx * sx + sy * sy + sz * sz);
      const double forward = d.x() * to.dx[i] + d.y() * to.dy[i] + d.z() * to.dz[i];
      const double angle = to.length[i] < kShortest ? 0.0 : base::arc_tangent2(across, forward);
      f2[i] = angle - steering_limit + penalty;  // Eq. (3)
    }
  }
};

double WaypointProblem::violation(const Vec3& to) const {
  Lanes lanes;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below and by measure
  const Vec3 d = to - step_.from;
  lanes.dx.fill(d.x());
  lanes.dy.fill(d.y());
  lanes.dz.fill(d.z());
  Lane violation;
  Kernel::measure(*this, lanes);
  Kernel::violations(*this, lanes, violation);
  return violation[0];
}

void WaypointProblem::evaluate(std::span<const double> x, std::span<optimizer::Cost> costs) const {
  Lane f1;
  Lane f2;
  std::array<double, 2 * kLanes> last{};
  for (std::size_t begin = 0; begin < costs.size(); begin += kLanes) {
    const std::size_t count = std::min(kLanes, costs.size() - begin);
    const double* block = x.data() + 2 * begin;
    if (count < kLanes) {
      for (std::size_t i = 0; i < kLanes; ++i) {
        last[2 * i] = block[2 * std::min(i, count - 1)];
        last[2 * i + 1] = block[2 * std::min(i, count - 1) + 1];
      }
      block = last.data();
    }
    Kernel::evaluate(*this, block, f1, f2);
    for (std::size_t i = 0; i < count; ++i) costs[begin + i] = {{f1[i], f2[i], 0.0}, 0.0};
  }
}

}  // namespace jink::planner::paper
