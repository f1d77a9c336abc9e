// SPDX-License-Identifier: BSD-3-Clause
// Cases worked by hand, and many against dense sampling with the fuzzers' judge of solids.
#include "planner/verify/solid_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/solid.hpp"
#include "planner/geometry/known_path.hpp"
#include "planner/verify/verifier.hpp"
#include "tests/fuzz/any_shape.hpp"
#include "tests/fuzz/judged_solid.hpp"

namespace jink::planner::verify {
namespace {

using base::Solid;
constexpr double kHalfTurn = std::numbers::pi;

base::TimedPath from_to(const Vec3& from, const Vec3& to, double duration) {
  return {{0.0, from, Vec3::Zero(), Vec3::Zero()}, {duration, to, Vec3::Zero(), Vec3::Zero()}};
}

base::Track standing(std::shared_ptr<const Solid> solid, const Vec3& position, double yaw_rate = 0.0) {
  base::Track track;
  track.id = 7;
  track.position = position;
  track.radius = solid->reach();
  track.body = {std::move(solid), 0.0, yaw_rate};
  return track;
}

Verification past(const base::TimedPath& path, const base::Track& track, double vehicle_radius) {
  VerifierInput input;
  input.path = path;
  input.tracks = {&track, 1};
  input.vehicle_radius = vehicle_radius;
  return verify(input);
}

// East at 2 m/s at a cube of 2 m around x = 10: contact where x = 10 - 1 - 0.5, so at 4.25 s. In its middle, at 5 s,
// the way out is 1 m.
TEST(SolidContact, HeadOnAtABox) {
  const Verification v =
      past(from_to({0, 0, 0}, {20, 0, 0}, 10.0), standing(Solid::box({2, 2, 2}, {}), {10, 0, 0}), 0.5);
  ASSERT_TRUE(v.valid);
  ASSERT_TRUE(v.first_contact.has_value());
  EXPECT_NEAR(*v.first_contact, 4.25, 1e-9);
  EXPECT_NEAR(v.contact_speed, 2.0, 1e-12);
  EXPECT_NEAR(v.min_clearance, -1.5, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 5.0, 1e-6);
  EXPECT_EQ(v.nearest_id, 7U);
  EXPECT_FALSE(v.free());
}

// The box comes from 7.5 m away, at 3 m/s and slowed by 2 m/s², the vehicle at 2 m/s: 7.5 - 5 t + t² = 1.5 at t = 2.
TEST(SolidContact, MeetsABoxThatBrakes) {
  base::Track track = standing(Solid::box({2, 2, 2}, {}), {7.5, 0, 0});
  track.velocity = {-3, 0, 0};
  track.acceleration = {2, 0, 0};
  const Verification v = past(from_to({0, 0, 0}, {4, 0, 0}, 2.0), track, 0.5);
  ASSERT_TRUE(v.valid);
  EXPECT_NEAR(v.min_clearance, 0.0, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 2.0, 1e-6);
}

// Across the upright edge at (1, 1), 0.7 m away from it.
TEST(SolidContact, PassesAnEdge) {
  const Vec3 out = Vec3(1, 1, 0).normalized();
  const Vec3 along = Vec3(1, -1, 0).normalized();
  const Vec3 nearest = Vec3(1, 1, 0.3) + 0.7 * out;
  const base::Track box = standing(Solid::box({2, 2, 2}, {}), Vec3::Zero());
  const base::TimedPath path = from_to(nearest - 5 * along, nearest + 5 * along, 10.0);
  const Verification v = past(path, box, 0.5);
  EXPECT_NEAR(v.min_clearance, 0.2, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 5.0, 1e-4);
  EXPECT_TRUE(v.free());
  // 0.1 m larger than the gap is: sqrt(0.8² - 0.7²) before the nearest place.
  const Verification hit = past(path, box, 0.8);
  ASSERT_TRUE(hit.first_contact.has_value());
  EXPECT_NEAR(*hit.first_contact, 5.0 - std::sqrt(0.15), 1e-8);
  EXPECT_NEAR(hit.min_clearance, -0.1, 1e-9);
}

// Past the corner (1, 1, 1), 0.6 m away from it at right angles to its diagonal.
TEST(SolidContact, PassesACorner) {
  const Vec3 nearest = Vec3(1, 1, 1) + 0.6 * Vec3(1, 1, 1).normalized();
  const Vec3 along = Vec3(1, 1, -2).normalized();
  const Verification v = past(from_to(nearest - 3 * along, nearest + 3 * along, 6.0),
                              standing(Solid::box({2, 2, 2}, {}), Vec3::Zero()), 0.5);
  EXPECT_NEAR(v.min_clearance, 0.1, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 3.0, 1e-4);
}

// Along a face as near all the time.
TEST(SolidContact, FliesAlongAFace) {
  const Verification v =
      past(from_to({-0.9, 0, 1.25}, {0.9, 0.5, 1.25}, 2.0), standing(Solid::box({2, 2, 2}, {}), Vec3::Zero()), 0.25);
  EXPECT_NEAR(v.min_clearance, 0.0, 1e-12);
  EXPECT_TRUE(v.valid);
}

// Over a wire along x at a height of 5 m, and past the round end of it.
TEST(SolidContact, CrossesAWire) {
  const base::Track wire = standing(Solid::capsule(0.05, {-10, 0, 5}, {10, 0, 5}), Vec3::Zero());
  const Verification over = past(from_to({3, -4, 5.3}, {3, 4, 5.3}, 8.0), wire, 0.2);
  EXPECT_NEAR(over.min_clearance, 0.05, 1e-9);
  EXPECT_NEAR(over.t_min_clearance, 4.0, 1e-4);
  const Verification at_end = past(from_to({10.3, -4, 5.4}, {10.3, 4, 5.4}, 8.0), wire, 0.2);
  EXPECT_NEAR(at_end.min_clearance, 0.5 - 0.05 - 0.2, 1e-9);
  const Verification hit = past(from_to({3, -4, 5}, {3, 4, 5}, 8.0), wire, 0.2);
  ASSERT_TRUE(hit.first_contact.has_value());
  EXPECT_NEAR(*hit.first_contact, 4.0 - 0.25, 1e-9);
  EXPECT_NEAR(hit.min_clearance, -0.25, 1e-9);
}

// 0.3 m beside and 0.4 m above a cylinder's rim: 0.5 m away from it.
TEST(SolidContact, PassesACylindersRim) {
  const Verification v =
      past(from_to({1.3, -3, 1.4}, {1.3, 3, 1.4}, 6.0), standing(Solid::cylinder(1.0, 2.0, {}), Vec3::Zero()), 0.4);
  EXPECT_NEAR(v.min_clearance, 0.1, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 3.0, 1e-4);
}

// The face x + y + z = 1 of a tetrahedron, flown along 0.5 m away over its middle; and through: 0 is all that a hull
// tells of how deep.
TEST(SolidContact, PassesAHull) {
  const base::Track hull = standing(Solid::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), Vec3::Zero());
  const Vec3 middle = Vec3::Constant(1.0 / 3.0) + 0.5 * Vec3(1, 1, 1).normalized();
  const Vec3 along = Vec3(1, -1, 0).normalized();
  const Verification v = past(from_to(middle - 2 * along, middle + 2 * along, 4.0), hull, 0.3);
  EXPECT_NEAR(v.min_clearance, 0.2, 1e-9);
  const Verification hit = past(from_to({0.25, 0.25, -2}, {0.25, 0.25, 2}, 4.0), hull, 0.3);
  ASSERT_TRUE(hit.first_contact.has_value());
  EXPECT_NEAR(*hit.first_contact, 1.7, 1e-9);
  EXPECT_NEAR(hit.min_clearance, -0.3, 1e-12);
}

// A point, a line and a triangle are hulls too.
TEST(SolidContact, PassesAFlatHull) {
  const base::TimedPath path = from_to({-3, 0, 1}, {3, 0, 1}, 6.0);
  EXPECT_NEAR(past(path, standing(Solid::hull({{0, 0, 0}}), {0, 0, 0}), 0.3).min_clearance, 0.7, 1e-9);
  EXPECT_NEAR(past(path, standing(Solid::hull({{0, 4, 0}, {0, -1, 0}, {0, 1, 0}}), {0, 0, 0}), 0.3).min_clearance, 0.7,
              1e-9);
  EXPECT_NEAR(past(path, standing(Solid::hull({{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}}), {0, 0, 0}), 0.3).min_clearance,
              0.7, 1e-9);
}

// A plate of 4 m turns at 0.5 rad/s; its tip, on a circle of 2 m, sweeps past a vehicle that hovers 2.3 m away in the
// north: 2² + 2.3² - 2 * 2 * 2.3 cos(angle between them) = 0.5² at the contact. Seen from the plate the vehicle moves
// at 0.5 * 2.3 m/s.
TEST(SolidContact, SpinningPlateSweepsPastAHoveringVehicle) {
  const double rate = 0.5;
  const base::Track plate = standing(Solid::box({4, 0, 2}, {}), {5, 5, 5}, rate);
  const Vec3 place(5, 7.3, 5.5);
  const Verification v = past(from_to(place, place, 8.0), plate, 0.5);
  ASSERT_TRUE(v.valid);
  ASSERT_TRUE(v.first_contact.has_value());
  const double apart = std::acos((4.0 + 2.3 * 2.3 - 0.25) / (4.0 * 2.3));
  EXPECT_NEAR(*v.first_contact, (0.5 * kHalfTurn - apart) / rate, 1e-8);
  EXPECT_NEAR(v.contact_speed, rate * 2.3, 1e-9);
  EXPECT_NEAR(v.min_clearance, -0.2, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 0.5 * kHalfTurn / rate, 1e-4);
  // Before it comes all is free, and a smaller vehicle stays so.
  EXPECT_TRUE(past(from_to(place, place, 2.5), plate, 0.5).free());
  EXPECT_NEAR(past(from_to(place, place, 8.0), plate, 0.2).min_clearance, 0.1, 1e-9);
}

// The same on a known path, told a second ago.
TEST(SolidContact, TurnsFromTheTracksTimeOn) {
  geometry::KnownPath known;
  known.points = {{0.0, {5, 5, 5}, Vec3::Zero(), Vec3::Zero()}};
  known.body = {Solid::box({4, 0, 2}, {}), 0.25 * kHalfTurn, 0.5};
  known.radius = known.body.solid->reach();
  VerifierInput input;
  const base::TimedPath path = from_to({5, 7.3, 5}, {5, 7.3, 5}, 8.0);
  input.path = path;
  input.known = {&known, 1};
  input.tracks_time = -1.0;
  input.vehicle_radius = 0.2;
  const Verification v = verify(input);
  EXPECT_NEAR(v.min_clearance, 0.1, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 0.25 * kHalfTurn / 0.5 - 1.0, 1e-4);
}

// What keeps its distance while it turns: a column that is round, a roof above which one hovers, a cone beside whose
// top one hovers, a column that is all but upright. All of these are judged.
TEST(SolidContact, JudgesWhatTurnsAndKeepsItsDistance) {
  const auto hovering = [](std::shared_ptr<const Solid> solid, const Vec3& place) {
    const Verification v = past(from_to(place, place, 10.0), standing(std::move(solid), Vec3::Zero(), 5.0), 0.3);
    EXPECT_TRUE(v.valid);
    return v.min_clearance;
  };
  EXPECT_NEAR(hovering(Solid::cylinder(1.0, 6.0, {}), {2, 0, 0}), 0.7, 1e-9);
  EXPECT_NEAR(hovering(Solid::capsule(1.0, {0, 0, -2}, {0, 0, 2}), {2, 0, 1}), 0.7, 1e-9);
  EXPECT_NEAR(hovering(Solid::box({4, 4, 1}, {}), {0.3, 0.2, 1.5}), 0.7, 1e-9);
  EXPECT_NEAR(hovering(Solid::hull({{1, 0, -5}, {-1, 0, -5}, {0, 1, -5}, {0, 0, 0}}), {0.8, 0, 0.6}), 0.7, 1e-9);
  EXPECT_NEAR(hovering(Solid::capsule(0.2, {1, 0, -5}, {0, 0, 0}), {0.8, 0, 0.6}), 0.5, 1e-9);
  const Eigen::Matrix3d leaning = Eigen::AngleAxisd(1e-6, Vec3::UnitX()).toRotationMatrix();
  EXPECT_NEAR(hovering(Solid::cylinder(1.0, 6.0, {Vec3::Zero(), leaning}), {2, 0, 1}), 0.7, 1e-5);
  EXPECT_NEAR(hovering(Solid::cylinder(1.0, 6.0, {{0, 1e-6, 0}, leaning}), {0.6, 0, 1}), -0.7, 1e-5);
}

TEST(SolidContact, BeginsWithin) {
  const Verification v =
      past(from_to({0.5, 0, 0}, {5, 0, 0}, 4.5), standing(Solid::box({2, 4, 4}, {}), {0, 0, 0}), 0.3);
  ASSERT_TRUE(v.first_contact.has_value());
  EXPECT_EQ(*v.first_contact, 0.0);
  EXPECT_NEAR(v.min_clearance, -0.8, 1e-12);
  EXPECT_EQ(v.t_min_clearance, 0.0);
}

/// They read the bytes as they go: one at a time is good.
fuzz::Numbers numbers_of(std::uint64_t seed) {
  const auto byte = [&](unsigned shift) { return static_cast<std::uint8_t>(seed >> shift & 0xffU); };
  static std::array<std::uint8_t, 2> bytes;
  bytes = {byte(8), byte(0)};
  return {bytes.data(), bytes.size()};
}

TEST(SolidContact, DistanceIsThatOfTheJudge) {
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    fuzz::Numbers n = numbers_of(seed);
    const fuzz::Shape shape = fuzz::any_shape(n);
    const base::Body body{shape.solid(), n.in(-4.0, 4.0), 0.0};
    const Vec3 point = n.vec(n.scale(0.1, 30.0));
    const fuzz::Place seen = fuzz::Turn(static_cast<fuzz::Real>(body.yaw)).back(fuzz::Place(point));
    const double judged = static_cast<double>(fuzz::JudgedSolid(shape).nearest(seen).distance);
    EXPECT_NEAR(solid_distance(body, point), judged, 1e-11) << seed;
  }
}

/// At 2001 instants of a path: the smallest distance, and the first instant below one.
struct Sampled {
  double least = base::kInfinity;
  std::optional<double> first;
};

Sampled sampled(const base::TimedPath& path, const base::Track& track, const fuzz::Shape& shape, double radius) {
  constexpr int kSteps = 2000;
  const fuzz::JudgedSolid judge(shape);
  Sampled result;
  for (int k = 0; k <= kSteps; ++k) {
    const double t = path.back().t * k / kSteps;
    const Vec3 apart = base::sample(path, t).position - track.position - t * track.velocity;
    const fuzz::Turn turn(static_cast<fuzz::Real>(track.body.yaw + t * track.body.yaw_rate));
    const double clearance = static_cast<double>(judge.nearest(turn.back(fuzz::Place(apart))).distance) - radius;
    result.least = std::min(result.least, clearance);
    if (clearance < 0.0 && !result.first) result.first = t;
  }
  return result;
}

// Never farther than any sample, nor nearer than what moves between two samples allows.
TEST(SolidContact, HoldsAgainstDenseSampling) {
  int contacts = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    fuzz::Numbers n = numbers_of(seed);
    const fuzz::Shape shape = fuzz::any_shape(n);
    base::Track track = standing(shape.solid(), n.vec(2.0), n.one_in(2) ? 0.0 : n.in(-3.0, 3.0));
    track.body.yaw = n.in(-4.0, 4.0);
    track.velocity = n.vec(2.0);
    const base::TimedPath path = from_to(n.vec(6.0), n.vec(6.0), n.in(1.0, 5.0));
    const Verification v = past(path, track, 0.3);
    const Sampled samples = sampled(path, track, shape, 0.3);
    ASSERT_TRUE(v.valid) << seed;
    const Vec3 velocity = (path[1].position - path[0].position) / path[1].t;
    const double speed = (velocity - track.velocity).norm() + std::abs(track.body.yaw_rate) * track.radius;
    EXPECT_LE(v.min_clearance, samples.least + 1e-9) << seed;
    EXPECT_GE(v.min_clearance, samples.least - speed * path[1].t / 4000.0 - 1e-9) << seed;
    if (!samples.first) continue;
    ++contacts;
    ASSERT_TRUE(v.first_contact.has_value()) << seed;
    EXPECT_LE(*v.first_contact, *samples.first + 1e-9) << seed;
    EXPECT_GE(*v.first_contact, *samples.first - path[1].t / 1000.0) << seed;
  }
  EXPECT_GT(contacts, 200);  // of cases of every kind
}

}  // namespace
}  // namespace jink::planner::verify
