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
  /// told. `request` becomes that of the plan: its tracks are this object's, until the next call, or
  /// those given.
  verify::Plan plan(PathRequest& request, double now, const MapPlace& map, const base::TimedPath& previous,
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

  HorizonPlanner& planner_;
  Guide guide_;
  Surroundings around_;
  std::optional<double> blocked_since_;
};

}  // namespace jink::planner::horizon
