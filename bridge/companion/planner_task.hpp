// SPDX-License-Identifier: BSD-3-Clause
// A planner that works while the setpoints go on. Two implementations: a thread, and virtual time.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/base/notifier.hpp"
#include "bridge/map/mapper.hpp"
#include "bridge/prediction/learned_motion.hpp"
#include "bridge/setpoints/tracking_offset.hpp"
#include "planner/geometry/static_map.hpp"
#include "planner/horizon/guided_planner.hpp"
#include "planner/horizon/horizon_planner.hpp"

namespace jink::bridge::companion {

/// What a plan is for.
struct Goal {
  enum class Kind { kWaypoint, kClimb, kStop };
  Kind kind = Kind::kWaypoint;
  Vec3 target = Vec3::Zero();  ///< where it leads to, local ENU, m
  bool visit = false;          ///< PathRequest::visit
  bool stuck = false;          ///< PathRequest::stuck
  bool holds = false;          ///< PathRequest::holds
};

/// What a plan sees of the static map. With it the same obstacles are found again.
struct MapView {
  std::shared_ptr<const planner::geometry::StaticMap> map;  ///< shared by plans, also with threads; none: there is none
  std::shared_ptr<const map::Seen> seen;                    ///< whose map it is; none: it is known beforehand
  planner::base::Box where;                                 ///< local ENU, m
  double up = 0.0;                                          ///< z of the local frame less the map's
  double floor = -planner::base::kInfinity;  ///< z; what reaches no higher is the ground, not an obstacle
  double sigma = 0.0;                        ///< of the vehicle's own place in it

  /// Appends what is in view, in the map's order, at rest.
  void append_to(std::vector<planner::base::Track>& tracks) const;
};

/// One plan to make. Its path time 0 is `start` in the companion's clock; tracks and state are valid then.
struct PlanJob {
  planner::horizon::PathRequest request;  ///< its obstacles are set by the task to what follows from the below
  std::vector<planner::base::Track> tracks;
  std::vector<prediction::Forecast> forecasts;      ///< of some of the tracks
  std::vector<planner::geometry::KnownPath> paths;  ///< of the team's other vehicles
  MapView map;
  std::vector<std::uint64_t> standing;  ///< ids of the tracks that count among what stands (PathRequest::standing)
  planner::base::TimedPath previous;    ///< times from `start` on
  Goal::Kind goal = Goal::Kind::kWaypoint;
  bool visit = false;          ///< of the goal
  Vec3 target = Vec3::Zero();  ///< likewise; the guide may lead to another first, which is the request's
  std::uint64_t number = 0;
  double begun = 0.0;
  double start = 0.0;
  std::optional<double> newest_track;  ///< reception of the newest track message that went in
  setpoints::OffsetForecast offset;    ///< of the vehicle from its reference, that the request was made with
  Vec3 estimate_shift = Vec3::Zero();  ///< VehicleState.estimate_shift that the request was made with
};

struct PlanResult {
  planner::verify::Plan plan;  ///< path times from `job.start` on
  PlanJob job;
  double ms = 0.0;      ///< spent planning: wall time, or the configured latency in virtual time
  bool missed = false;  ///< it came after its own start
};

/// What the job's plan is to avoid up to that planner's horizon.
[[nodiscard]] inline prediction::Obstacles obstacles_of(const PlanJob& job,
                                                        const planner::base::HorizonSettings& settings) {
  prediction::Obstacles obstacles = prediction::obstacles_of(job.tracks, job.forecasts, job.paths, settings.time,
                                                             settings.step, settings.acceleration_trust);
  constexpr double kReach = 15.0;  // m, farther off a stop is seen in time
  prediction::add_stops(obstacles.tracks, job.request.position, kReach, obstacles.paths);
  job.map.append_to(obstacles.standing);
  planner::horizon::set_apart(job.standing, obstacles.tracks, obstacles.standing);
  return obstacles;
}
/// The request refers to them, until forget_obstacles().
inline void set_obstacles(PlanJob& job, const prediction::Obstacles& obstacles) {
  job.request.tracks = obstacles.tracks;
  job.request.paths = obstacles.paths;
  job.request.standing = obstacles.standing;
}
inline void forget_obstacles(PlanJob& job) {
  job.request.tracks = {};
  job.request.paths = {};
  job.request.standing = {};
}

/// One job at a time.
class PlannerTask {
 public:
  virtual ~PlannerTask() = default;
  /// Precondition: not busy.
  virtual void start(PlanJob job) = 0;
  [[nodiscard]] virtual bool busy() const = 0;
  /// How long after its beginning a plan can be expected; its path starts then.
  [[nodiscard]] virtual double latency() const = 0;
  /// The finished plan, once; nothing while the planner works. Throws what the planner threw.
  [[nodiscard]] virtual std::optional<PlanResult> poll(double now) = 0;
};

struct PlannerTaskSettings {
  planner::base::HorizonSettings horizon;
  planner::base::OptimizerSettings optimizer;
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one for each core
};

/// Makes the plans of one flight, guided to its waypoints. Not thread-safe.
class JobPlanner {
 public:
  explicit JobPlanner(const PlannerTaskSettings& settings);
  /// The job's request becomes the one that was planned for, without its obstacles.
  planner::verify::Plan plan(PlanJob& job, const planner::base::Budget& budget);
  /// Those given at construction.
  [[nodiscard]] const PlannerTaskSettings& settings() const { return settings_; }

 private:
  PlannerTaskSettings settings_;
  planner::horizon::HorizonPlanner planner_;
  planner::horizon::GuidedPlanner guided_;
  std::shared_ptr<const planner::geometry::StaticMap> guided_by_;  // the guide knows its map by where it is
  planner::base::WorkerPool pool_;
};

/// Plans in a thread of its own with a pool of `threads`, until the generations are done or the deadline passes.
class ThreadedPlanner final : public PlannerTask {
 public:
  /// `done`, where there is one, is notified when a plan is ready; it outlives the planner.
  ThreadedPlanner(const PlannerTaskSettings& settings, const base::Clock& clock, base::Notifier* done = nullptr);
  ~ThreadedPlanner() override;
  void start(PlanJob job) override;
  [[nodiscard]] bool busy() const override;
  [[nodiscard]] double latency() const override { return 1e-3 * planner_.settings().horizon.deadline_ms + kHandling; }
  [[nodiscard]] std::optional<PlanResult> poll(double now) override;

 private:
  static constexpr double kHandling = 0.03;  // s: the last cycle after the deadline, and a turn of the loop
  void work(const std::stop_token& stop);

  const base::Clock& clock_;
  base::Notifier* done_;
  JobPlanner planner_;
  mutable std::mutex mutex_;  // guards job_, result_, failure_ and busy_
  std::condition_variable_any wake_;
  std::optional<PlanJob> job_;
  std::optional<PlanResult> result_;
  std::exception_ptr failure_;
  bool busy_ = false;
  std::jthread thread_;
};

/// Plans at once and hands the plan out `latency` later. The budget is the generations: the wall clock has no say.
class VirtualPlanner final : public PlannerTask {
 public:
  VirtualPlanner(const PlannerTaskSettings& settings, double latency);
  void start(PlanJob job) override;
  [[nodiscard]] bool busy() const override { return result_.has_value(); }
  [[nodiscard]] double latency() const override { return latency_; }
  [[nodiscard]] std::optional<PlanResult> poll(double now) override;

 private:
  const double latency_;
  JobPlanner planner_;
  std::optional<PlanResult> result_;
};

}  // namespace jink::bridge::companion
