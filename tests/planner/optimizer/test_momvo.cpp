// SPDX-License-Identifier: BSD-3-Clause
#include "planner/optimizer/momvo.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "planner/horizon/path_problem.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/paper/waypoint_problem.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/fronts.hpp"

namespace jink::planner::optimizer {
namespace {

using testing_support::Recorded;
using testing_support::volume_of;
using testing_support::Zdt;

void run(Momvo& momvo, const Problem& problem, int iterations, std::uint64_t seed) {
  momvo.reset(problem, base::RandomStream(seed));
  for (int i = 0; i < iterations; ++i) momvo.iterate(static_cast<double>(i + 1) / iterations);
}

// The true front has 0.8767; 50 universes of 5 variables reach 0.857 at the least over 200 seeds.
TEST(Momvo, ConvergesOnZdt1) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Zdt problem(1, 5);
    Momvo momvo(50, 5, 2, {});
    run(momvo, problem, 100, seed);
    EXPECT_GT(volume_of(momvo.archive().costs()), 0.84) << seed;
    EXPECT_LT(volume_of(momvo.archive().costs()), 0.8767);
  }
}

// The circulating code loses more than half of the hypervolume when the box is shifted by 10.
TEST(Momvo, FindsTheSameWhereverTheOriginIs) {
  const Zdt here(1, 5);
  const Zdt there(1, 5, 16.0);
  Momvo a(50, 5, 2, {});
  Momvo b(50, 5, 2, {});
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    run(a, here, 60, seed);
    run(b, there, 60, seed);
    EXPECT_NEAR(volume_of(a.archive().costs()), volume_of(b.archive().costs()), 0.05);
  }
}

TEST(Momvo, SameStreamGivesSameBits) {
  const Zdt problem(1, 4);
  Momvo a(12, 4, 2, {});
  Momvo b(12, 4, 2, {});
  run(a, problem, 5, 99);  // another run before must not matter
  run(a, problem, 30, 7);
  run(b, problem, 30, 7);
  ASSERT_EQ(a.archive().size(), b.archive().size());
  for (std::size_t i = 0; i < a.archive().size(); ++i) {
    EXPECT_EQ(a.archive().cost(i).f, b.archive().cost(i).f);
    EXPECT_TRUE(std::ranges::equal(a.archive().x(i), b.archive().x(i)));
  }
}

TEST(Momvo, PlacedSolutionIsEvaluatedInTheFirstIteration) {
  const Zdt problem(1, 5);
  Momvo momvo(10, 5, 2, {});
  momvo.reset(problem, base::RandomStream(1));
  momvo.place(13, std::vector<double>{0.25, 0, 0, 0, 0});  // slot 3; on the true front: f2 = 1 − 0.5
  momvo.iterate(0.1);
  bool held = false;
  for (const Cost& c : momvo.archive().costs()) held = held || (c.f[0] == 0.25 && c.f[1] == 0.5);
  EXPECT_TRUE(held);
}

TEST(Momvo, ClampsAPlacedSolutionIntoTheBox) {
  const Zdt problem(1, 3);
  Momvo momvo(1, 3, 2, {});
  momvo.reset(problem, base::RandomStream(1));
  momvo.place(0, std::vector<double>{-5, 7, 0});
  momvo.iterate(1.0);
  ASSERT_EQ(momvo.archive().size(), 1U);
  EXPECT_TRUE(std::ranges::equal(momvo.archive().x(0), std::vector<double>{0, 1, 0}));
}

TEST(Momvo, RepresentativeIsAMemberOfTheArchive) {
  const Zdt problem(1, 4);
  Momvo momvo(20, 4, 2, {});
  run(momvo, problem, 10, 3);
  for (int i = 0; i < 20; ++i) {
    const auto x = momvo.representative();
    bool found = false;
    for (std::size_t k = 0; k < momvo.archive().size(); ++k) {
      found = found || (std::ranges::equal(x, momvo.archive().x(k)) &&
                        momvo.representative_cost().f == momvo.archive().cost(k).f);
    }
    EXPECT_TRUE(found);
  }
}

TEST(Momvo, ReplacementEntersTheNextIteration) {
  const Zdt problem(1, 5);
  Momvo momvo(10, 5, 2, {});
  run(momvo, problem, 3, 4);
  momvo.replace_worst(0, std::vector<double>{0.49, 0, 0, 0, 0});
  momvo.replace_worst(1, std::vector<double>{0.64, 0, 0, 0, 0});
  momvo.iterate(1.0);
  int held = 0;
  for (const Cost& c : momvo.archive().costs()) held += c.f[0] == 0.49 || c.f[0] == 0.64 ? 1 : 0;
  EXPECT_EQ(held, 2);
}

// One universe. The first iteration counts it as a wide move that succeeded: wide (1 + 1)/(1 + 2), narrow 1/2. The
// second knows no move: 0.8 of the counts are left, wide (0.8 + 1)/(0.8 + 2), narrow 1/2.
TEST(Momvo, CreditsNoMoveWithAReplacement) {
  const Zdt problem(1, 5);
  Momvo momvo(1, 5, 2, {});
  momvo.reset(problem, base::RandomStream(1));
  momvo.iterate(0.1);
  EXPECT_DOUBLE_EQ(momvo.narrow_share(), 0.5 / (2.0 / 3.0 + 0.5));
  momvo.replace_worst(0, std::vector<double>{0.49, 0, 0, 0, 0});  // on the true front
  momvo.iterate(0.2);
  ASSERT_EQ(momvo.archive().costs().back().f[0], 0.49);
  EXPECT_DOUBLE_EQ(momvo.narrow_share(), 0.5 / (1.8 / 2.8 + 0.5));
}

/// f1 = x1² + x2², f2 = (x1 − 4)² + x2², in [-2, 6] × [-4, 4].
class TwoHills final : public Problem {
 public:
  [[nodiscard]] int dimension() const override { return 2; }
  [[nodiscard]] int objectives() const override { return 2; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const double a = x[2 * i];
      const double b = x[2 * i + 1];
      costs[i] = {{a * a + b * b, (a - 4.0) * (a - 4.0) + b * b, 0.0}, 0.0};
    }
  }

 private:
  std::array<double, 2> lower_{-2, -4};
  std::array<double, 2> upper_{6, 4};
};

// [Paper] Algorithm 1, iteration 1 of 4, with the operators as printed. Eq. (19): WEP = 0.2 + 1·0.8/4 = 0.4. Eq. (20):
// TDR = 1 − 1^(1/6)/4 = 0.75. Of the universes (5, 2), (0, 1), (-1, 2.5), (4, 1) with costs (29, 5), (1, 17),
// (7.25, 31.25), (17, 1) the second and the fourth are not dominated: the archive, two occupied cells. They come first
// in the order, 1, 3, 0, 2; so they are given random numbers.
TEST(Momvo, OneIterationIsThePapers) {
  const TwoHills hills;
  const Recorded problem(hills);
  base::OptimizerSettings s;
  s.operators = base::Operators::kPrinted;
  s.iterations = 4;
  const std::vector<double> universes{5, 2, 0, 1, -1, 2.5, 4, 1};
  constexpr std::uint64_t kSeed = 22;
  Momvo momvo(4, 2, 2, s);
  momvo.reset(problem, base::RandomStream(kSeed));
  for (std::size_t i = 0; i < 4; ++i) momvo.place(i, std::span(universes).subspan(2 * i, 2));
  momvo.iterate(0.25);
  ASSERT_EQ(momvo.archive().size(), 2U);
  EXPECT_EQ(momvo.archive().cost(0).f, (std::array{1.0, 17.0, 0.0}));
  EXPECT_EQ(momvo.archive().cost(1).f, (std::array{17.0, 1.0, 0.0}));
  momvo.iterate(0.5);  // which evaluates where the first has led

  std::vector<double> expected = universes;
  base::RandomStream random(kSeed);
  for (int i = 0; i < 8; ++i) random.next();  // of the random population
  for (const std::size_t i : {1U, 3U, 0U, 2U}) {
    const std::size_t leader = random.uniform() < 0.5 ? 1 : 3;
    for (std::size_t j = 0; j < 2; ++j) {
      random.next();  // which universe a white hole would take from
      const double signed_r = 2.0 * random.uniform() - 1.0;
      const double rand1 = random.uniform_pair()[1];
      if (rand1 >= 0.4) continue;  // W stays
      const double lower = j == 0 ? -2.0 : -4.0;
      const double upper = j == 0 ? 6.0 : 4.0;
      const double step = upper - lower * std::abs(signed_r) + lower;
      const double moved = universes[2 * leader + j] + 0.75 + (signed_r < 0.0 ? -step : step);  // Eq. (18)
      expected[2 * i + j] = std::min(std::max(moved, lower), upper);
    }
  }
  ASSERT_EQ(problem.batches.size(), 2U);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_DOUBLE_EQ(problem.batches[1][i], expected[i]) << i;
  const std::vector<double> literal{5, 2, 0, 3.396798494, -1, 4, -0.7324951775, -0.9738714285};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(problem.batches[1][i], literal[i], 1e-9) << i;
}

TEST(Momvo, WorksWithOneUniverse) {
  const Zdt problem(1, 2);
  Momvo momvo(1, 2, 2, {});
  run(momvo, problem, 50, 5);
  EXPECT_GE(momvo.archive().size(), 1U);
}

/// A cost that is not a number in half of the box, and better than any elsewhere but for that.
class HalfNan final : public Problem {
 public:
  [[nodiscard]] int dimension() const override { return 2; }
  [[nodiscard]] int objectives() const override { return 2; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const double bad = x[2 * i] < 0.5 ? std::numeric_limits<double>::quiet_NaN() : 0.0;
      costs[i] = {{x[2 * i] + bad, x[2 * i + 1], 0.0}, 0.0};
    }
  }

 private:
  std::array<double, 2> lower_{0, 0};
  std::array<double, 2> upper_{1, 1};
};

TEST(Momvo, KeepsNanOutOfTheArchive) {
  const HalfNan problem;
  Momvo momvo(20, 2, 2, {});
  run(momvo, problem, 20, 6);
  for (const Cost& c : momvo.archive().costs()) EXPECT_TRUE(c.f[0] >= 0.5 && c.violation == 0.0);
}

void expect_no_allocation(const Problem& problem) {
  Momvo momvo(24, problem.dimension(), problem.objectives(), {});
  const test::AllocationGuard guard;
  run(momvo, problem, 20, 1);
  momvo.replace_worst(0, momvo.representative());
  momvo.iterate(1.0);
  EXPECT_EQ(guard.count(), 0U);
  EXPECT_GT(momvo.archive().size(), 0U);
}

base::Track sphere(const Vec3& position, const Vec3& velocity) {
  base::Track track;
  track.position = position;
  track.velocity = velocity;
  track.radius = 0.5;
  track.position_sigma = 0.1;
  return track;
}

TEST(Momvo, AllocatesNothingOnWaypointProblem) {
  paper::WaypointProblem problem({}, {});
  paper::WaypointProblem::Step step;
  step.target = {10, 0, 2};
  step.direction = step.target;
  step.base = {1, 0, 2};
  step.lateral1 = Vec3::UnitY();
  step.lateral2 = Vec3::UnitZ();
  step.lower = {-2, -2};
  step.upper = {2, 2};
  const std::vector<base::Track> tracks{sphere({1, 0.2, 2}, {0, -1, 0}), sphere({1, 1.3, 2}, {0, 0, 0})};
  problem.prepare(step, tracks);
  ASSERT_EQ(problem.virtual_spheres().size(), 1U);
  expect_no_allocation(problem);
}

TEST(Momvo, AllocatesNothingOnPathProblem) {
  horizon::PathProblem problem{base::HorizonSettings{}};
  const std::vector<base::Track> tracks(40, sphere({6, 0.2, 2}, {-1, 0, 0}));
  horizon::PathRequest request;
  request.position = {0, 0, 2};
  request.target = {20, 0, 2};
  request.tracks = tracks;
  request.margin = 0.35;
  problem.prepare(request);
  ASSERT_EQ(problem.obstacles(), 40U);
  expect_no_allocation(problem);
}

}  // namespace
}  // namespace jink::planner::optimizer
