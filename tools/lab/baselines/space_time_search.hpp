// SPDX-License-Identifier: BSD-3-Clause
// RRT* (OMPL's) in space and time among moving spheres and bodies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"

namespace jink::tools::lab::baselines {

/// A place and when to be there, s from the search's beginning.
struct SpaceTime {
  double t = 0.0;
  Vec3 position = Vec3::Zero();
};

/// What to search: from `start` at time 0 to within `tolerance` of `goal`, at no more than `speed` and `climb`, without
/// coming nearer to a sphere than its radius, or to a body than body_gap(). Spheres are valid at time 0.
struct SpaceTimeProblem {
  Vec3 start = Vec3::Zero();
  Vec3 goal = Vec3::Zero();
  double tolerance = 0.3;
  planner::base::Box region;  ///< bounded; places outside it are not looked at
  std::span<const planner::base::Track> spheres;
  double acceleration_trust = planner::base::kInfinity;  ///< as in predict_position
  double speed = 3.0;
  double climb = 2.0;
  double slack = 3.0;  ///< s, by which a place may be reached later than straight flight would
};

struct SpaceTimeSettings {
  int iterations = 800;  ///< of RRT*, each one sample
  double range = 3.0;    ///< m, longest edge
  double hurry = 0.5;    ///< weight of time, as length at `speed`, against length
};

/// Whether the straight even motion between two places is possible: forward in time, within speed and climb, clear of
/// all spheres and bodies. Continuous in time: in pieces of half a second, in which they move evenly.
[[nodiscard]] bool is_free(const SpaceTimeProblem& problem, const SpaceTime& from, const SpaceTime& to);

/// RRT* (Karaman and Frazzoli, Sampling-based algorithms for optimal motion planning, 2011) as OMPL 1.5 has it, over
/// (x, y, z, t): an edge needs is_free(), its cost is length plus `hurry` of the time. `hints` (a path of an earlier
/// search) are the first samples. Returns the places of the best way found, start first, at the goal or, where none led
/// there, at the place nearest to it; the start alone where there was nothing. The way is shortened afterwards: corners
/// are cut and waits left out where that stays free.
///
/// Depends on its arguments and (seed, stream) alone: all random numbers come from a stream of its own, none from
/// OMPL's global generator, and nearest places are found by looking at all. Thread-safe.
[[nodiscard]] std::vector<SpaceTime> search_space_time(const SpaceTimeProblem& problem,
                                                       const SpaceTimeSettings& settings,
                                                       std::span<const SpaceTime> hints, std::uint64_t seed,
                                                       std::uint64_t stream);

/// The shortening alone. Every pair of neighbours that search_space_time() would return is free if those of `way` are.
void shorten(const SpaceTimeProblem& problem, std::vector<SpaceTime>& way);

}  // namespace jink::tools::lab::baselines
