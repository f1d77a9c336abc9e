// SPDX-License-Identifier: BSD-3-Clause
// Plans along the way through what stands; where something that moves is in it, along other ways, too.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner/base/budget.hpp"
#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"
#include "planner/base/worker_pool.hpp"
#include "planner/horizon/guide.hpp"
#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/safe_intervals.hpp"
#include "planner/verify/plan.hpp"

namespace jink::planner::horizon {

/// Leads and plans one flight. Not thread-safe. The same bits for the same calls, as HorizonPlanner::plan().
class GuidedPlanner {
 public:
  /// Borrows the planner.
  GuidedPlanner(HorizonPlanner& planner, Guide::Knowledge knowledge)
      : planner_(planner), guide_(planner.settings(), knowledge) {}

  /// HorizonPlanner::plan(), for the request as Guide::lead() makes it at `now`, s. Where plans lose
  /// more than 2 s on their way within the next 4 m for half a second, and something moves there, there is one more for
  /// each other way that has been found since; it is taken where it arrives a second earlier, as far as that can be
  /// told. Where none is, a way in space and time is looked for (SafeIntervalSearch), from here and from where the
  /// plan comes to. Where that from here arrives a second earlier, or ends where it can stay and the other does not,
  /// plans lead to where it waits first, until such a way waits no more. `request` becomes that of the plan: its tracks
  /// are this object's, until the next call, or those given; so does `previous`, which is empty after another way was
  /// taken.
  verify::Plan plan(PathRequest& request, double now, const MapPlace& map, base::TimedPath& previous,
                    std::uint64_t seed, std::uint64_t number, const base::Budget& budget, base::WorkerPool& pool);

  /// The ids of the last plan's tracks that counted among what stands.
  [[nodiscard]] std::span<const std::uint64_t> standing() const { return around_.ids; }

 private:
  /// What a request refers to where some tracks are taken for what stands.
  struct Surroundings {
    std::vector<base::Track> tracks, standing;
    std::vector<std::uint64_t> ids;  // of those that were taken from the tracks
  };
  [[nodiscard]] Surroundings surround(PathRequest& request) const;

  [[nodiscard]] WayInTime way_in_time(const PathRequest& request, const base::TimedPoint& from);
  [[nodiscard]] bool is_behind(const verify::Plan& plan, const WayInTime& way, const PathRequest& request);
  [[nodiscard]] std::vector<Vec3> up_to_wait(const WayInTime& way) const;

  HorizonPlanner& planner_;
  Guide guide_;
  SafeIntervalSearch in_time_;
  Surroundings around_;
  std::optional<double> blocked_since_;
  std::vector<Vec3> aside_;  // the way to where is waited, until a way in time waits no more
};

}  // namespace jink::planner::horizon
