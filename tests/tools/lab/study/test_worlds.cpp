// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numbers>

#include "planner/base/random.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/verify/verifier.hpp"
#include "tests/tools/lab/study/small_study.hpp"

namespace jink::tools::lab::study {
namespace {

planner::base::TimedPath straight_flight(const World& world) {
  planner::base::TimedPath path(2);
  path[0].position = world.start;
  path[1].position = world.target;
  path[1].t = (world.target - world.start).norm() / world.vehicle.cruise_speed;
  return path;
}

bool hit(const World& world, std::span<const planner::base::Track> tracks) {
  const planner::base::TimedPath path = straight_flight(world);
  return !planner::verify::verify({path, tracks, 0.0, world.vehicle.radius, world.volume}).free();
}

TEST(BlockedWorlds, HaveThePapersSizeAndHalfOfTheirObstaclesHitTheStraightFlight) {
  const StudyWorlds scenes(1);
  for (const bool pictured : {false, true}) {
    const auto blocked = pictured ? pictured_worlds(true) : numbered_worlds(true);
    const auto papers = pictured ? pictured_worlds(false) : numbered_worlds(false);
    for (std::size_t i = 0; i < blocked.size(); ++i) {
      const World paper = scenes.world(papers[i], 0);
      for (int run = 0; run < 20; ++run) {
        const World world = scenes.world(blocked[i], run);
        EXPECT_EQ(world.start, paper.start);
        EXPECT_EQ(world.target, paper.target);
        ASSERT_EQ(world.tracks.size(), paper.tracks.size());
        std::size_t hits = 0;
        for (const planner::base::Track& track : world.tracks) hits += hit(world, {&track, 1}) ? 1 : 0;
        EXPECT_GE(2 * hits, world.tracks.size()) << blocked[i] << " run " << run;
        EXPECT_LT(hits, world.tracks.size()) << "every second one passes beside";
      }
    }
  }
}

TEST(BlockedWorlds, LeaveStartAndArrivalFree) {
  const StudyWorlds scenes(3);
  for (int run = 0; run < 20; ++run) {
    const World world = scenes.world(hardest_world(true), run);
    const double end = straight_flight(world).back().t;
    for (const planner::base::Track& track : world.tracks) {
      EXPECT_GT((track.position - world.start).norm(), track.radius + world.vehicle.radius + 1.0);
      EXPECT_GT((planner::geometry::predict_position(track, end) - world.target).norm(),
                track.radius + world.vehicle.radius + 0.5);
    }
  }
}

TEST(BlockedWorlds, AreOthersInEachRunAndForEachSeedButForThePicturedOnes) {
  const auto first = [](const StudyWorlds& scenes, const std::string& name, int run) {
    return scenes.world(name, run).tracks.front().position;
  };
  const StudyWorlds one(1), again(1), other(2);
  EXPECT_EQ(first(one, "blocked2-1", 0), first(again, "blocked2-1", 0));
  EXPECT_NE(first(one, "blocked2-1", 0), first(one, "blocked2-1", 1));
  EXPECT_NE(first(one, "blocked2-1", 0), first(other, "blocked2-1", 0));
  EXPECT_EQ(first(one, "blocked12-1", 0), first(one, "blocked12-1", 1));
}

TEST(PapersWorlds, HaveAFreeStraightFlight) {
  const StudyWorlds scenes(1);
  for (const std::string& name : numbered_worlds(false)) {
    const World world = scenes.world(name, 0);
    EXPECT_FALSE(hit(world, world.tracks)) << name;
  }
}

/// Two objectives of u and v.
class InThePlane final : public planner::optimizer::Problem {
 public:
  using Objectives = planner::optimizer::Point2 (*)(double u, double v);
  InThePlane(Objectives two, std::array<double, 2> lower, std::array<double, 2> upper)
      : objectives_(two), lower_(lower), upper_(upper) {}
  [[nodiscard]] int dimension() const override { return 2; }
  [[nodiscard]] int objectives() const override { return 2; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }
  void evaluate(std::span<const double> x, std::span<planner::optimizer::Cost> costs) const override {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const auto [f1, f2] = objectives_(x[2 * i], x[2 * i + 1]);
      costs[i].f = {f1, f2, 0.0};
    }
  }

 private:
  Objectives objectives_;
  std::array<double, 2> lower_, upper_;
};

TEST(ReferenceFront, OfAProblemWithAKnownFrontIsThat) {
  // The front is sqrt(f1) + sqrt(f2) = 1.
  const auto objectives = [](double u, double v) -> planner::optimizer::Point2 {
    return {u * u + v * v, (u - 1.0) * (u - 1.0) + v * v};
  };
  const ReferenceFront front = search_reference(InThePlane(objectives, {-1.3, -1.7}, {2.1, 1.9}));
  ASSERT_GT(front.points.size(), 100U);
  for (const planner::optimizer::Point2& p : front.points) EXPECT_NEAR(std::sqrt(p[0]) + std::sqrt(p[1]), 1.0, 1e-2);
  EXPECT_NEAR(front.bounds.ideal[0], 0.0, 1e-6);
  EXPECT_NEAR(front.bounds.nadir[1], 1.0, 1e-2);
  // The area above the front in the unit square is 5/6; the strips to 1.1 add 0.21.
  EXPECT_NEAR(front.hypervolume, 5.0 / 6.0 + 0.21, 1e-3);
}

TEST(ReferenceFront, OfAProblemWithOneBestPointIsThatPoint) {
  const auto objectives = [](double u, double v) -> planner::optimizer::Point2 {
    return {u * u + v * v, u * u + v * v};
  };
  const ReferenceFront front = search_reference(InThePlane(objectives, {-1.0, -1.0}, {2.0, 2.0}));
  ASSERT_EQ(front.points.size(), 1U);
  EXPECT_NEAR(front.points[0][0], 0.0, 1e-4);
}

/// The worlds of some of these seeds have blocked waypoints without a way, and ones whose best way is a single one.
TEST(FrontSteps, OfABlockedWorldHaveRoomAndFrontsWhateverTheSeed) {
  const config::Settings settings = config::load_settings(config::config_folder() / "planner.yaml");
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const StudyWorlds scenes(seed);
    const auto steps = front_steps(scenes.world(hardest_world(true), 0), settings.paper, true);
    ASSERT_EQ(steps.size(), kFrontSteps);
    for (const FrontStep& step : steps) {
      const auto& bounds = step.reference.bounds;
      EXPECT_GT(bounds.nadir[0] - bounds.ideal[0], 0.01) << seed << ", waypoint " << step.station;
      // No penalty: |steering angle| − φ_max is no more than this.
      EXPECT_LT(bounds.ideal[1], std::numbers::pi * (1.0 - settings.paper.steering_limit_deg / 180.0))
          << seed << ", " << step.station;
    }
  }
}

TEST(FrontSteps, AreRefusedWhereThereAreNoFronts) {
  config::Settings settings = config::load_settings(config::config_folder() / "planner.yaml");
  settings.paper.lateral_range = 1e-3;
  const StudyWorlds scenes(1);
  for (const bool blocked : {false, true})
    EXPECT_THROW(static_cast<void>(front_steps(scenes.world(hardest_world(blocked), 0), settings.paper, blocked)),
                 std::invalid_argument);
}

TEST(FrontSteps, HaveFrontsThatNoRandomPointBeats) {
  const StudyWorlds scenes(1);
  const config::Settings settings = config::load_settings(config::config_folder() / "planner.yaml");
  for (const bool blocked : {false, true}) {
    std::size_t hits = 0;
    const auto steps = front_steps(scenes.world(hardest_world(blocked), 0), settings.paper, blocked);
    ASSERT_EQ(steps.size(), kFrontSteps);
    for (const FrontStep& step : steps) {
      hits += step.hit ? 1 : 0;
      const auto& bounds = step.reference.bounds;
      EXPECT_GT(bounds.nadir[0] - bounds.ideal[0], 0.01) << "a front, not a point";
      EXPECT_GT(bounds.nadir[1] - bounds.ideal[1], 0.1);
      planner::base::RandomStream random(7, static_cast<std::uint64_t>(step.station));
      std::vector<planner::optimizer::Point2> with = step.reference.points;  // fewer than the hypervolume counts
      for (int i = 0; i < 20000; ++i) {
        const std::array<double, 2> x{random.uniform(step.problem.lower()[0], step.problem.upper()[0]),
                                      random.uniform(step.problem.lower()[1], step.problem.upper()[1])};
        planner::optimizer::Cost cost;
        step.problem.evaluate(x, {&cost, 1});
        with.push_back({cost.f[0], cost.f[1]});
      }
      EXPECT_LT(indicators(with, step.reference).hv, step.reference.hypervolume + 1e-4) << step.station;
    }
    EXPECT_EQ(hits, blocked ? kFrontSteps : 0U);
  }
}

}  // namespace
}  // namespace jink::tools::lab::study
