// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/guided_planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/boxes.hpp"

namespace jink::planner::horizon {
namespace {

/// Something creeps through the first door.
std::vector<base::Track> two_doors() {
  std::vector<base::Track> tracks = support::wall_with_two_doors(10, 7);
  tracks.push_back(support::box({10, -0.1, 4}, {0.8, 1.1, 12}));
  tracks.back().id = 9;
  tracks.back().velocity = {0, 0.11, 0};
  return tracks;
}

PathRequest before(const std::vector<base::Track>& tracks) {
  PathRequest request;
  request.position = {6, 0, 2};
  request.target = {20, 0, 2};
  request.volume = {{-10, -20, 0}, {30, 20, 4}};
  request.margin = base::HorizonSettings{}.margin;
  request.tracks = tracks;
  return request;
}

/// What is planned for, and how it was planned.
struct Made {
  PathRequest request;
  verify::Plan plan;
  std::vector<base::Track> tracks;  // that the plan's request had
};

/// One plan after the other of a vehicle that stays where it is. Each is what HorizonPlanner makes of the request and
/// the plan before that the guided planner says it was made from.
std::vector<Made> plans(const std::vector<base::Track>& tracks, int threads, int count) {
  const base::HorizonSettings settings;
  base::WorkerPool pool(threads);
  HorizonPlanner planner(settings);
  GuidedPlanner guided(planner, Guide::Knowledge::kWhole);
  const base::Budget budget{settings.generations, base::Budget::Time::max()};
  std::vector<Made> made;
  for (int n = 0; n < count; ++n) {
    const auto number = static_cast<std::uint64_t>(n);
    Made one{before(tracks), {}, {}};
    base::TimedPath previous = made.empty() ? base::TimedPath{} : made.back().plan.path;
    one.plan = guided.plan(one.request, 0.1 * n, {}, previous, 1, number, budget, pool);
    const verify::Plan again = planner.plan(one.request, previous, 1, number, budget, pool);
    const auto same = [](const base::TimedPoint& a, const base::TimedPoint& b) { return a.position == b.position; };
    EXPECT_TRUE(std::equal(again.path.begin(), again.path.end(), one.plan.path.begin(), one.plan.path.end(), same))
        << n;
    one.tracks.assign(one.request.tracks.begin(), one.request.tracks.end());
    made.push_back(std::move(one));
  }
  return made;
}

// Not at once: what is in the way for half a second may be gone in the next.
TEST(GuidedPlanner, TakesAnotherWayWhereSomethingThatMovesIsInTheFirst) {
  const std::vector<base::Track> tracks = two_doors();
  const std::vector<Made> made = plans(tracks, 1, 12);
  for (int n = 0; n < 5; ++n) EXPECT_LT(made[static_cast<std::size_t>(n)].request.target.y(), 1.0) << n;
  const Made& last = made.back();
  EXPECT_GT(last.request.target.y(), 4.0);
  EXPECT_TRUE(last.plan.verification.free());
  EXPECT_EQ(last.plan.path.back().position, last.request.target);
  EXPECT_EQ(last.tracks.back().id, 9U) << "what moves is no part of what stands";
  const std::vector<Made> again = plans(tracks, 3, 12);
  for (std::size_t n = 0; n < made.size(); ++n) {
    ASSERT_EQ(again[n].plan.path.size(), made[n].plan.path.size()) << n;
    EXPECT_EQ(again[n].plan.path.back().position, made[n].plan.path.back().position) << n;
    EXPECT_EQ(again[n].plan.evaluations, made[n].plan.evaluations) << n;
  }
}

// A narrow door far ahead looks closed as well: the margin gives way before it.
TEST(GuidedPlanner, HoldsOnToItsWayWhereNothingIsInIt) {
  std::vector<base::Track> tracks = two_doors();
  tracks.pop_back();
  for (const Made& one : plans(tracks, 1, 12)) {
    EXPECT_LT(one.request.target.y(), 1.0);
    EXPECT_NE(one.plan.status, verify::PlanStatus::kBlocked);
  }
}

}  // namespace
}  // namespace jink::planner::horizon
