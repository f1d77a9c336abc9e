// SPDX-License-Identifier: BSD-3-Clause
// What all baselines of jink in the arena share: how they stand in for the companion's planner, what they keep clear
// of, and how their paths are judged.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bridge/companion/planner_task.hpp"

namespace jink::tools::lab::baselines {

/// A way of planning. One serves one flight; not thread-safe, but several may work at once in threads of their own.
class Baseline {
 public:
  virtual ~Baseline() = default;
  /// A path from the job's state on, at times from its start on (path time 0), and how far it was found free. The
  /// request's tracks and paths are the job's. Numbers in the request are finite. A pure function of the jobs so far.
  virtual planner::verify::Plan plan(const bridge::companion::PlanJob& job) = 0;
};

/// A baseline in virtual time: plans at once and hands the plan out `latency` seconds later, as VirtualPlanner does. A
/// request that holds a number that is not finite gets a plan without a path, kInvalid.
class BaselineTask final : public bridge::companion::PlannerTask {
 public:
  BaselineTask(std::unique_ptr<Baseline> baseline, double latency)
      : baseline_(std::move(baseline)), latency_(latency) {}
  void start(bridge::companion::PlanJob job) override;
  [[nodiscard]] bool busy() const override { return result_.has_value(); }
  [[nodiscard]] double latency() const override { return latency_; }
  [[nodiscard]] std::optional<bridge::companion::PlanResult> poll(double now) override;

 private:
  std::unique_ptr<Baseline> baseline_;
  double latency_;
  std::optional<bridge::companion::PlanResult> result_;
};

/// The request's tracks, as spheres that the vehicle's centre must not enter: grown by the vehicle's radius, the margin
/// and `sigma_factor` standard deviations of the position as it is now (at most `clearance_limit`), which is what jink
/// asks for too. Vehicles that told their paths follow, each as a track at its present velocity. Of a body the sphere
/// is as large as it reaches and as much larger as all are: body_gap() tells how much that is.
[[nodiscard]] std::vector<planner::base::Track> inflated_obstacles(const planner::horizon::PathRequest& request,
                                                                   const planner::base::HorizonSettings& settings);

/// m, from the surface of an inflated body to where the vehicle's centre may be. Precondition: a body.
[[nodiscard]] double body_gap(const planner::base::Track& inflated);

/// From a point to the surface of a track's body `t` seconds later, when the track's centre is there, m; negative in a
/// box, a cylinder or a capsule, 0 in a hull.
[[nodiscard]] double body_distance(const planner::base::Track& track, const Vec3& center, double t, const Vec3& point);

/// An inflated body as one sees it who looks from `point`: a sphere of body_gap() about the nearest point of its
/// surface, which moves as that point does. From within, a sphere that is left by the nearest way out.
[[nodiscard]] planner::base::Track nearest_part(const planner::base::Track& inflated, const Vec3& point);

/// Checks `path` against the request's tracks and known paths up to path time `until`, with the vehicle's sphere
/// larger by `margin`. A path that ends before waits at its end.
[[nodiscard]] planner::verify::Verification check(const planner::base::TimedPath& path,
                                                  const planner::horizon::PathRequest& request, double margin,
                                                  double until);

/// The plan that flies `path`, judged as jink's own: kBlocked where it is not free for the time that is looked ahead,
/// kReaches where it is free to the target, else kProgresses.
[[nodiscard]] planner::verify::Plan verified_plan(planner::base::TimedPath path,
                                                  const planner::horizon::PathRequest& request, double horizon);

/// Whether `a` does less harm than `b`: free before not free, then free for longer, then the softer contact.
[[nodiscard]] bool is_safer(const planner::verify::Verification& a, const planner::verify::Verification& b);

}  // namespace jink::tools::lab::baselines
