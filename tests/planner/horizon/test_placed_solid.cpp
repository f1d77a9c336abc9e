// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/placed_solid.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <memory>
#include <numbers>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/verify/solid_contact.hpp"

namespace jink::planner::horizon {
namespace {

using base::Solid;

Vec3 any_vector(base::RandomStream& random, double range) {
  const double x = random.uniform(-range, range);
  const double y = random.uniform(-range, range);
  return {x, y, random.uniform(-range, range)};
}

std::shared_ptr<const Solid> any_prism(base::RandomStream& random) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0, 3), Vec3::UnitX())) *
                                  Eigen::AngleAxisd(random.uniform(0, 3), Vec3::UnitZ());
  return Solid::prism(any_vector(random, 2).cwiseAbs(), random.uniform(0, 0.5), random.uniform(0, 0.5),
                      {any_vector(random, 1), turn.toRotationMatrix()});
}

std::shared_ptr<const Solid> any_hull(base::RandomStream& random) {
  std::vector<Vec3> vertices(4 + random.below(6));
  for (Vec3& vertex : vertices) vertex = any_vector(random, 2);
  return Solid::hull(std::move(vertices));
}

// The verifier's distance is told by other code.
TEST(PlacedSolid, DistanceOfAPrismIsTheVerifiers) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    base::RandomStream random(71, seed, 0);
    const base::Body body{any_prism(random), random.uniform(-4, 4), random.uniform(-2, 2)};
    const Vec3 center = any_vector(random, 5);
    const Vec3 place = center + any_vector(random, 4);
    const PlacedSolid placed(body, center, 1.5);
    const double distance = verify::solid_distance(body.later(1.5), place - center);
    EXPECT_NEAR(placed.distance(place), distance, 1e-12) << seed;
    // It grows outwards by as much as the place moves.
    EXPECT_NEAR(placed.distance(place + 1e-4 * placed.outward(place)), distance + 1e-4, 2e-6) << seed;
  }
}

// A hull's slabs hold it: near a corner that they do not cut it counts as larger, never as smaller.
TEST(PlacedSolid, DistanceOfAHullIsNeverMore) {
  double most = 0.0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    base::RandomStream random(72, seed, 0);
    const base::Body body{any_hull(random), random.uniform(-4, 4), 0.0};
    const Vec3 place = any_vector(random, 4);
    const double distance = PlacedSolid(body, Vec3::Zero(), 0.0).distance(place);
    const double exact = verify::solid_distance(body, place);
    EXPECT_LE(distance, exact + 1e-9) << seed;
    most = std::max(most, exact - std::max(distance, 0.0));
  }
  EXPECT_LT(most, 1.5);  // of solids of some 3 m
}

TEST(PlacedSolid, DistancesInLockstepAreThoseOfEachAlone) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    base::RandomStream random(73, seed, 0);
    const base::Body body{seed % 2 == 0 ? any_prism(random) : any_hull(random), random.uniform(-4, 4), 0.0};
    const PlacedSolid placed(body, any_vector(random, 3), 0.0);
    PointLanes<8> places, own;
    for (std::size_t i = 0; i < 8; ++i) {
      places.x[i] = random.uniform(-4, 4);
      places.y[i] = random.uniform(-4, 4);
      places.z[i] = random.uniform(-4, 4);
    }
    Lanes<8> distances;
    placed.to_own(places, own);
    placed.distances(own, distances);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(distances[i], placed.distance(places.lane(i)), 1e-12) << seed;
  }
}

TEST(PlacedSolid, ExtentIsHowFarItReaches) {
  const base::Body plank{Solid::box({4, 0.2, 1}, {}), 0.0, 0.5 * std::numbers::pi};
  const PlacedSolid turned(plank, {5, 5, 0}, 1.0);
  EXPECT_NEAR(turned.extent(Vec3::UnitX()), 0.1, 1e-12);
  EXPECT_NEAR(turned.extent(-Vec3::UnitY()), 2.0, 1e-12);
  EXPECT_NEAR(turned.extent(Vec3::UnitZ()), 0.5, 1e-12);
}

}  // namespace
}  // namespace jink::planner::horizon
