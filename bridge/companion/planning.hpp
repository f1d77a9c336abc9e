// SPDX-License-Identifier: BSD-3-Clause
// When the companion starts a plan, what it asks for, and what comes of it.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridge/companion/intake.hpp"
#include "bridge/companion/motion.hpp"
#include "bridge/companion/planner_task.hpp"
#include "bridge/companion/report.hpp"
#include "bridge/companion/retreat.hpp"
#include "bridge/companion/sight.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"
#include "planner/horizon/contingency.hpp"

namespace jink::bridge::companion {

/// Keeps the planner busy. After what it throws it is left alone. What this refers to outlives it. Not thread-safe.
class Planning {
 public:
  Planning(const config::Mission& mission, const config::Settings& settings, PlannerTask& planner, const Sight& sight,
           FlightReporter& reporter)
      : mission_(mission),
        settings_(settings),
        planner_(planner),
        sight_(sight),
        reporter_(reporter),
        contingency_(settings.horizon),
        retreat_(settings.horizon) {}

  /// The plan that has been finished, if any, as far as it is to be flown. `end`: where the flight is to end.
  std::optional<PlanResult> take(double now, const MotionControl& motion, const Vec3& end);
  /// Where the newest plan would have gone on into what was not seen; none: it goes nowhere where it may not.
  [[nodiscard]] const std::optional<Vec3>& unseen() const { return unseen_; }
  /// The planner is free and a plan is due: at once where a track message came or the goal is another, else at a rate.
  [[nodiscard]] bool due(double now, Goal::Kind goal) const;
  /// Starts a plan. Precondition: due().
  void start(double now, Intake& intake, const MotionControl& motion, const Goal& goal);
  void tracks_came() { new_tracks_ = true; }
  /// The autopilot's estimate jumped by that.
  void shift(const Vec3& by) { retreat_.shift(by); }
  /// The reference to stop along, by what is known now, without the planner.
  [[nodiscard]] planner::base::TimedPath stop(double now, Intake& intake, const MotionControl& motion,
                                              const MotionControl::StopStart& start);
  /// Nothing that is known comes near where the vehicle stands or into its way up, should it take off now.
  [[nodiscard]] bool climbs_free(double now, Intake& intake) const;

  /// The newest plan was asked to lead to a refuge instead of the goal.
  [[nodiscard]] bool retreats() const { return retreat_.refuge().has_value(); }
  /// When the newest plan with a path was begun. One made under a hazard counts: the planner is alive.
  [[nodiscard]] std::optional<double> newest_plan() const { return newest_plan_; }
  [[nodiscard]] std::uint64_t plans() const { return plans_; }
  /// No plan for so long that the planner is no help.
  [[nodiscard]] bool late(double now) const {
    return !newest_plan_ || now - *newest_plan_ > settings_.companion.stale_plan;
  }
  /// By the newest plan the flight's end stays free, and the vehicle there; where it is to land, the way down, too.
  [[nodiscard]] bool stays_at_end() const { return stays_at_end_; }
  /// What the planner threw, in words, once.
  std::optional<std::string> take_failure() { return std::exchange(failure_, std::nullopt); }

 private:
  [[nodiscard]] PlanJob job(double now, Intake& intake, const MotionControl& motion, const Goal& goal);
  [[nodiscard]] static std::vector<planner::base::TimedPath> stops(double now, const MotionControl& motion,
                                                                   const MotionControl::StopStart& start);
  void look_around(double now, Intake& intake, PlanJob& job) const;
  void look_at_map(const vehicle::VehicleState& state, PlanJob& job) const;
  /// To where few can reach, where what is flown is likely to be hit.
  void retreat(double now, Intake& intake, const MotionControl& motion, PlanJob& job);
  /// Where the vehicle sees by clouds alone what stands, no faster than it can stop within that; slow as long as it
  /// does not look to where it is to fly, `ahead`, m.
  void keep_in_sight(const vehicle::VehicleState& state, const Vec3& ahead,
                     planner::horizon::PathRequest& request) const;
  /// The speed up to which plans can be followed with this drag, 1/s; never below the cruise speed.
  [[nodiscard]] double attainable_speed(double drag) const;
  void demand(const vehicle::VehicleState& state, double margin, planner::horizon::PathRequest& request) const;
  /// Not up and down into what was not seen: no higher and no lower than the vehicle's column is free, than it is and
  /// can stop, and than the target.
  void keep_in_column(planner::horizon::PathRequest& request) const;
  /// A plan to a waypoint that leads to where the mission may not fly, as that was not seen, is left before for a stop.
  void stay_in_seen(double now, const MotionControl& motion, PlanResult& result);
  [[nodiscard]] planner::base::Box volume(double margin, double sigma) const;
  [[nodiscard]] bool is_seen(const planner::base::TimedPath& path) const;
  [[nodiscard]] bool lands_free(const PlanResult& result) const;
  void failed(double now, const std::exception& failure);

  const config::Mission& mission_;
  const config::Settings& settings_;
  PlannerTask& planner_;
  const Sight& sight_;
  FlightReporter& reporter_;
  planner::horizon::Contingency contingency_;
  Retreat retreat_;
  std::optional<double> last_begun_;
  Goal::Kind last_goal_ = Goal::Kind::kWaypoint;
  bool new_tracks_ = false;  // since then
  std::optional<Vec3> unseen_;
  double rate_kept_ = 0.0;  // from when on another plan would be no more than the largest rate
  std::optional<double> newest_plan_;
  Vec3 planned_for_ = Vec3::Zero();  // by the newest plan: the goal's target,
  Vec3 planned_to_ = Vec3::Zero();   // and where its path ends, which may be on the way there
  std::uint64_t plans_ = 0;
  bool stays_at_end_ = false;
  bool failed_ = false;
  std::optional<std::string> failure_;
};

}  // namespace jink::bridge::companion
