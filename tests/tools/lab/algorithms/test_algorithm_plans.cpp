// SPDX-License-Identifier: BSD-3-Clause
// The project's own problems under each algorithm: [Paper] problem (16) step by step, and the horizon's three
// objectives.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "planner/horizon/open_loop.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/paper/paper_planner.hpp"
#include "tools/lab/algorithms/registry.hpp"

namespace jink::tools::lab::algorithms {
namespace {

using planner::base::Budget;
using planner::base::Track;
using planner::verify::Plan;
using planner::verify::PlanStatus;

Track sphere(std::uint64_t id, const Vec3& position, const Vec3& velocity, double radius = 0.5) {
  Track track;
  track.id = id;
  track.position = position;
  track.velocity = velocity;
  track.radius = radius;
  return track;
}

void expect_same_path(const planner::base::TimedPath& a, const planner::base::TimedPath& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].position, b[i].position);
}

/// Whether two paths are the same to the bit.
bool same_path(const planner::base::TimedPath& a, const planner::base::TimedPath& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                            [](const auto& p, const auto& q) { return p.position == q.position; });
}

class EachAlgorithmPlans : public ::testing::TestWithParam<std::string> {
 protected:
  static const Algorithm& algorithm() { return *find_algorithm(GetParam()); }
};

TEST_P(EachAlgorithmPlans, StepByStep) {
  // [Paper] Table 2, scenario 1, and an obstacle on the straight line.
  const std::vector<Track> tracks{sphere(1, {5, 5, 2}, {4, -2, 1}),  sphere(2, {3, 3, 2}, {2, -2, -2}),
                                  sphere(3, {5, 3, 1}, {4, 2, 2}),   sphere(4, {2, 1, 1}, {2, 2, 2}),
                                  sphere(5, {6, 2, 2}, {-2, 2, -2}), sphere(6, {4.5, 4, 0}, {0, 0, 0})};
  planner::paper::PaperRequest request;
  request.target = {9, 8, 0};
  request.tracks = tracks;
  planner::base::WorkerPool one(1);
  planner::base::WorkerPool two(2);
  const auto optimizer = algorithm().make(request.optimizer, 2, 2);
  const Plan plan = planner::paper::plan_paper(request, *optimizer, one);
  EXPECT_EQ(plan.status, PlanStatus::kReaches) << planner::verify::to_string(plan.status);
  EXPECT_EQ(plan.evaluations, 18 * 100 * 50);
  const double length = planner::base::path_length(plan.path);
  EXPECT_LT(planner::optimizer::straight_line_rate(length, request.target.norm()), 1.2);
  EXPECT_GT(planner::optimizer::straight_line_rate(length, request.target.norm()), 1.0);
  expect_same_path(planner::paper::plan_paper(request, *optimizer, two).path, plan.path);
}

// Start and target on the floor of a flight volume with no height: the second variable has no extent.
TEST_P(EachAlgorithmPlans, InAFlatVolume) {
  const std::vector<Track> tracks{sphere(1, {4, 0, 0}, {0, 0, 0})};
  planner::paper::PaperRequest request;
  request.target = {8, 0, 0};
  request.volume = {{-1, -3, 0}, {9, 3, 0}};
  request.tracks = tracks;
  request.optimizer.iterations = 40;
  planner::base::WorkerPool pool(1);
  const auto optimizer = algorithm().make(request.optimizer, 2, 2);
  const Plan plan = planner::paper::plan_paper(request, *optimizer, pool);
  EXPECT_EQ(plan.status, PlanStatus::kReaches) << planner::verify::to_string(plan.status);
  EXPECT_EQ(plan.evaluations, 18 * 40 * 50);
}

TEST_P(EachAlgorithmPlans, TheHorizonAtOnce) {
  const std::vector<Track> tracks{sphere(1, {8, 0, 2}, {0, 0, 0}, 0.8), sphere(2, {14, -4, 2}, {0, 1, 0}, 0.6)};
  planner::horizon::OpenLoopRequest request;
  request.path.position = {0, 0, 2};
  request.path.target = {20, 0, 2};
  request.path.volume = {{-5, -10, 0.3}, {25, 10, 8}};
  request.path.tracks = tracks;
  request.path.margin = planner::base::HorizonSettings{}.margin;
  request.time_limit = 60.0;
  planner::base::WorkerPool one(1);
  planner::base::WorkerPool two(2);
  const planner::base::HorizonSettings settings;
  const auto plan = [&](planner::base::WorkerPool& pool, const planner::optimizer::MakeOptimizer& make) {
    return planner::horizon::plan_open_loop(settings, {}, request, 1, {20, Budget::Time::max()}, pool, make);
  };
  const Plan found = plan(one, algorithm().make);
  EXPECT_EQ(found.status, PlanStatus::kReaches) << planner::verify::to_string(found.status);
  EXPECT_EQ(found.evaluations % (20 * settings.population), 0);
  EXPECT_GT(found.evaluations, 0);
  expect_same_path(plan(two, algorithm().make).path, found.path);
  if (algorithm().slaves != settings.slaves) {
    EXPECT_FALSE(same_path(plan(one, {}).path, found.path));  // PMOMVO's is another
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachAlgorithmPlans, ::testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const Algorithm& algorithm : algorithms()) names.emplace_back(algorithm.name);
                           return names;
                         }()),
                         [](const auto& each) {
                           std::string name = each.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace jink::tools::lab::algorithms
