// SPDX-License-Identifier: BSD-3-Clause
// Problem (16) of [Paper]: where the next waypoint goes, with the penalties of Eq. (17). Two variables, two objectives.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "planner/base/settings.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/geometry.hpp"
#include "planner/optimizer/problem.hpp"

namespace jink::planner::paper {

/// How fast a segment is flown: at cruise speed, slower where the climb limit asks for it. Seconds.
double segment_duration(const Vec3& from, const Vec3& to, const base::VehicleLimits& vehicle);

/// One step of the paper's planning: from waypoint w_i at time t_i to w_{i+1}, whose coordinate along the axis is given
/// and whose two lateral coordinates are the decision variables.
///
/// f1, Eq. (2): length of the next segment plus the straight rest to the target, m. f2, Eq. (3): |steering angle| −
/// φ_max, rad, the angle between the segment before and this one. Constraints: the segment misses every obstacle, Eq.
/// (14) or the swept test, and the virtual sphere of every narrow pass, Eq. (15). differs: g and h are penalised each
/// for itself, since the sum in Eq. (17) lets one that holds pay for one that does not; radii are grown by the
/// vehicle's and by PaperSettings::margin.
///
/// The p nearby obstacles of Eq. (17), "in the i th waypoint's neighborhood", of which the paper says no more, are
/// those that the step could touch while it takes place, whatever the variables are; and so with the virtual spheres.
class WaypointProblem final : public optimizer::Problem {
 public:
  /// One step's places and bounds. ENU, m.
  struct Step {
    Vec3 from = Vec3::Zero();       ///< w_i
    Vec3 direction = Vec3::Zero();  ///< of the segment before, any length; at the start: towards the target
    Vec3 target = Vec3::Zero();     ///< where the mission ends
    Vec3 base = Vec3::Zero();       ///< the next station's point on the straight line
    Vec3 lateral1 = Vec3::Zero();   ///< unit vector of the first variable, an offset from `base`, m
    Vec3 lateral2 = Vec3::Zero();   ///< unit vector of the second variable, likewise
    std::array<double, 2> lower{};  ///< lower bounds of the offsets
    std::array<double, 2> upper{};  ///< upper bounds of the offsets
    base::Box volume;               ///< a waypoint that the bounds let out of it is moved to its nearest point
  };

  /// For a vehicle of these limits; prepare() comes before all else.
  WaypointProblem(const base::PaperSettings& settings, const base::VehicleLimits& vehicle)
      : settings_(settings), vehicle_(vehicle) {}

  /// Prepares one step. `tracks` are valid at the step's start time t_i. Keeps the obstacles that the step could touch.
  void prepare(const Step& step, std::span<const base::Track> tracks);

  [[nodiscard]] int dimension() const override { return 2; }
  [[nodiscard]] int objectives() const override { return 2; }
  [[nodiscard]] std::span<const double> lower() const override { return step_.lower; }
  [[nodiscard]] std::span<const double> upper() const override { return step_.upper; }
  void evaluate(std::span<const double> x, std::span<optimizer::Cost> costs) const override;

  /// The waypoint of offsets (u, v), ENU.
  [[nodiscard]] Vec3 waypoint(double u, double v) const {
    const Vec3 p = step_.base + u * step_.lateral1 + v * step_.lateral2;
    return p.cwiseMax(step_.volume.min).cwiseMin(step_.volume.max);
  }
  /// Sum of squared constraint values max(0, g)² + max(0, h)² of the segment to `to`; 0: feasible.
  [[nodiscard]] double violation(const Vec3& to) const;
  /// Virtual spheres of narrow passes now active, near or not; for tests and figures.
  [[nodiscard]] std::span<const base::Track> virtual_spheres() const { return virtual_spheres_; }

 private:
  /// A sphere that the step could touch: an obstacle, grown by the vehicle and the margin, or a virtual sphere.
  struct Sphere {
    Vec3 offset = Vec3::Zero();  ///< from its centre to `from`, now
    Vec3 velocity = Vec3::Zero();
    Vec3 half_acceleration = Vec3::Zero();
    double radius = 0.0;
    double bulge = 0.0;  ///< per duration²: how far its path leaves its chord at most
  };
  /// Where the step can lead.
  struct Reach {
    base::Box hull;        ///< of the segments to all waypoints
    double longest = 0.0;  ///< that one of them takes, s
  };
  struct Lanes;
  struct Kernel;

  void add_if_near(const base::Track& track, double radius, const Reach& reach);
  void find_narrow_passes(std::span<const base::Track> tracks, const Reach& reach);
  [[nodiscard]] Reach reach() const;

  base::PaperSettings settings_;
  base::VehicleLimits vehicle_;
  Step step_;
  std::vector<Sphere> spheres_;
  std::vector<base::Track> virtual_spheres_;  // Eq. (15)
};

}  // namespace jink::planner::paper
