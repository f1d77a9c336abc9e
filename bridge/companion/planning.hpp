// SPDX-License-Identifier: BSD-3-Clause
// When the companion starts a plan, what it asks for, and what comes of it.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "bridge/companion/intake.hpp"
#include "bridge/companion/motion.hpp"
#include "bridge/companion/planner_task.hpp"
#include "bridge/companion/report.hpp"
#include "bridge/companion/route.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"

namespace jink::bridge::companion {

/// Keeps the planner busy. After what it throws it is left alone. What this refers to outlives it. Not thread-safe.
class Planning {
 public:
  Planning(const config::Mission& mission, const config::Settings& settings, PlannerTask& planner,
           FlightReporter& reporter)
      : mission_(mission), settings_(settings), planner_(planner), reporter_(reporter) {}

  /// The plan that has been finished, if any.
  std::optional<PlanResult> take(double now);
  /// Starts a plan where the planner is free and one is due: at once where a track message came, else at a rate. With
  /// `visit` it is enough that the plan has been at the target.
  void start(double now, Intake& intake, const MotionControl& motion, Route& route, bool visit);
  void tracks_came() { new_tracks_ = true; }

  /// When the newest plan with a path was begun. One made under a hazard counts: the planner is alive.
  [[nodiscard]] std::optional<double> newest_plan() const { return newest_plan_; }
  [[nodiscard]] std::uint64_t plans() const { return plans_; }
  /// By the newest plan the last waypoint stays free, and the vehicle there; where it is to land, the way down, too.
  [[nodiscard]] bool stays_at_target() const { return stays_at_target_; }
  /// What the planner threw, in words, once.
  std::optional<std::string> take_failure() { return std::exchange(failure_, std::nullopt); }

 private:
  [[nodiscard]] PlanJob job(double now, Intake& intake, const MotionControl& motion, Route& route, bool visit);
  [[nodiscard]] planner::base::Box volume(const Vec3& start, const Vec3& target, double margin, double sigma) const;
  [[nodiscard]] bool lands_free(const PlanResult& result) const;
  void failed(double now, const std::exception& failure);

  const config::Mission& mission_;
  const config::Settings& settings_;
  PlannerTask& planner_;
  FlightReporter& reporter_;
  std::optional<double> last_begun_;
  bool new_tracks_ = false;  // since then
  double rate_kept_ = 0.0;   // from when on another plan would be no more than the largest rate
  std::optional<double> newest_plan_;
  std::uint64_t plans_ = 0;
  bool stays_at_target_ = false;
  bool failed_ = false;
  std::optional<std::string> failure_;
};

}  // namespace jink::bridge::companion
