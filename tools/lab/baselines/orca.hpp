// SPDX-License-Identifier: BSD-3-Clause
// The reactive baseline: ORCA in three dimensions, with the whole responsibility for avoidance.
#pragma once

#include "tools/lab/baselines/baseline.hpp"
#include "tools/lab/baselines/linear_program.hpp"

namespace jink::tools::lab::baselines {

struct OrcaSettings {
  double time_horizon = 3.0;  ///< s, tau: a velocity is to be free for so long
  double contact_time = 0.3;  ///< s, in which an overlap of the kept distances is to end
};

/// The velocities that do not lead the vehicle, at relative position `offset` from itself to an obstacle's centre and
/// with velocity `velocity`, nearer than `radius` to an obstacle of velocity `other` within `time` seconds: the
/// half-space that ORCA puts in place of the velocity obstacle's outside, tangent at the point of its boundary that is
/// nearest to the present relative velocity. Van den Berg, Guy, Lin and Manocha, Reciprocal n-Body Collision
/// Avoidance, 2011, section 4 in three dimensions.
/// differs: the vehicle moves by all of u, not half of it, since obstacles do not take part. Where they overlap
/// already, `contact_time` takes the place of the time, so that they part within it. Units m, m/s, s.
[[nodiscard]] HalfSpace orca_half_space(const Vec3& offset, double radius, const Vec3& velocity, const Vec3& other,
                                        double time, double contact_time);

/// Takes the velocity nearest to unobstructed flight's that the half-spaces of all obstacles that can matter within the
/// time horizon leave, with hard ones for the climb limit and for the volume: towards a wall never faster than can be
/// braked. Where there is none it takes the one that violates those of the obstacles the least (section 5.3 of the
/// paper). Where that would nearly be a stop, it wishes for a velocity a tenth to the right of unobstructed flight's:
/// that breaks the symmetry in which ORCA only slows down. Obstacles keep the velocity of their tracks; of a body the
/// points count that are nearest now and, at the present velocities, later. The path flies
/// that velocity for the time horizon and stops, or, where nothing is in the way, flies to the target; accelerations
/// are bounded, and where a half-space is violated now more of the acceleration is used, as jink does in an emergency.
class OrcaPilot final : public Baseline {
 public:
  explicit OrcaPilot(const planner::base::HorizonSettings& settings, const OrcaSettings& orca = {})
      : settings_(settings), orca_(orca) {}
  planner::verify::Plan plan(const bridge::companion::PlanJob& job) override;

 private:
  planner::base::HorizonSettings settings_;
  OrcaSettings orca_;
};

}  // namespace jink::tools::lab::baselines
