// SPDX-License-Identifier: BSD-3-Clause
// Jobs for pilots, and what flies them without a vehicle.
#pragma once

#include <string>
#include <vector>

#include "bridge/companion/planner_task.hpp"

namespace jink::tools::lab::baselines {

inline planner::base::Track ball(double radius, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  planner::base::Track track;
  track.radius = radius;
  track.position = position;
  track.velocity = velocity;
  return track;
}

/// From `position` at `velocity` to `target`, in a volume of ±20 m and 0 to 10 m height. The job's request has no
/// tracks yet: they are set when it is planned.
inline bridge::companion::PlanJob job(const Vec3& position, const Vec3& target,
                                      std::vector<planner::base::Track> tracks, const Vec3& velocity = Vec3::Zero()) {
  bridge::companion::PlanJob result;
  result.request.position = position;
  result.request.velocity = velocity;
  result.request.target = target;
  result.request.volume = {{-20, -20, 0}, {20, 20, 10}};
  result.request.margin = 0.35;
  result.request.acceleration_trust = 0.7;
  result.tracks = std::move(tracks);
  for (std::uint64_t i = 0; i < result.tracks.size(); ++i) result.tracks[i].id = i + 1;
  return result;
}

/// The plan that a pilot makes of a job.
template <typename Pilot>
planner::verify::Plan plan(Pilot& pilot, bridge::companion::PlanJob asked) {
  asked.request.tracks = asked.tracks;
  asked.request.paths = asked.paths;
  return pilot.plan(asked);
}

}  // namespace jink::tools::lab::baselines
