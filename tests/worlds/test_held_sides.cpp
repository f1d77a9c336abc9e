// SPDX-License-Identifier: BSD-3-Clause
// Whether a vehicle keeps to the side on which it has begun to pass what comes, though every measurement is off.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "planner/base/trajectory.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "sim/families/families.hpp"
#include "sim/flight/closed_loop.hpp"

namespace jink::sim {
namespace {

/// Counts the plans that pass a mover on another side than the plan before, by more than a right angle.
class Sides final : public bridge::companion::FlightObserver {
 public:
  void on_plan(double /*t*/, const bridge::companion::PlanResult& result) override {
    const Passing now = first_passed(result);
    if (now.mover != 0) ++passing;
    if (now.mover != 0 && now.mover == last_.mover && now.side.dot(last_.side) < 0.0) ++changes;
    last_ = now;
  }
  int passing = 0, changes = 0;

 private:
  struct Passing {
    std::uint64_t mover = 0;  ///< 0: none is met
    Vec3 side = Vec3::Zero();
  };

  /// The first that the plan has beside it within reach, and where it is then.
  static Passing first_passed(const bridge::companion::PlanResult& result) {
    constexpr double kStep = 0.1;   // s
    constexpr double kReach = 3.0;  // m
    Passing first;
    double earliest = planner::base::kInfinity;
    const planner::base::TimedPath& path = result.plan.path;
    if (path.size() < 2) return first;
    for (const planner::base::Track& track : result.job.tracks) {
      const auto apart = [&](double t) -> Vec3 {
        const double ahead = path.front().t + t;
        return planner::base::sample(path, ahead).position - planner::geometry::predict_position(track, t, 0.0);
      };
      const double end = std::min(earliest, path.back().t - path.front().t);
      for (double t = kStep; t + kStep < end; t += kStep) {
        const Vec3 there = apart(t);
        const double distance = there.norm();
        if (distance > kReach || distance > apart(t - kStep).norm() || distance > apart(t + kStep).norm()) continue;
        earliest = t;
        first = {track.id, there};
        break;
      }
    }
    return first;
  }

  Passing last_;
};

/// Plans as jink does, and makes every plan once more without knowing the one before.
class Twice final : public bridge::companion::PlannerTask {
 public:
  Twice(const bridge::companion::PlannerTaskSettings& settings, double latency, Sides& sides)
      : planner_(settings, latency), forgetful_(settings, latency), sides_(sides) {}
  void start(bridge::companion::PlanJob job) override {
    bridge::companion::PlanJob anew = job;
    anew.previous.clear();
    forgetful_.start(std::move(anew));
    sides_.on_plan(0.0, *forgetful_.poll(planner::base::kInfinity));
    planner_.start(std::move(job));
  }
  [[nodiscard]] bool busy() const override { return planner_.busy(); }
  [[nodiscard]] double latency() const override { return planner_.latency(); }
  [[nodiscard]] std::optional<bridge::companion::PlanResult> poll(double now) override { return planner_.poll(now); }

 private:
  bridge::companion::VirtualPlanner planner_, forgetful_;
  Sides& sides_;
};

// The measurements are the same for both: those of flights on which jink's plans were flown.
TEST(HeldSides, OfEqualWaysTheOneBegunIsHeldOnTo) {
  Sides held, forgotten;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    for (const std::string_view family : {"head_on", "daidalus_head_on", "crossing"}) {
      config::Scenario scenario = families::make_world(family, seed);
      families::set_tier(scenario, families::Tier::kRealistic);
      flight::ClosedLoopOptions options;
      options.seed = seed;
      options.flight_observers = {&held};
      options.planner = [&](const bridge::companion::PlannerTaskSettings& settings, double latency) {
        return std::make_unique<Twice>(settings, latency, forgotten);
      };
      flight::fly_closed_loop(scenario, {}, options);
    }
  }
  EXPECT_GT(held.passing, 1000);
  EXPECT_LE(200 * held.changes, held.passing);
  EXPECT_LT(held.changes, forgotten.changes);
}

}  // namespace
}  // namespace jink::sim
