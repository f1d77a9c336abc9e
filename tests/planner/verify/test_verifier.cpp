// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verify/verifier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/geometry/obstacle_motion.hpp"

namespace jink::planner::verify {
namespace {

const Vec3 kZero = Vec3::Zero();

base::TimedPath line(const Vec3& from, const Vec3& to, double duration, double start = 0.0) {
  return {{start, from, kZero, kZero}, {start + duration, to, kZero, kZero}};
}

base::Track moving(const Vec3& position, const Vec3& velocity, double radius, std::uint64_t id = 1) {
  base::Track track;
  track.id = id;
  track.position = position;
  track.velocity = velocity;
  track.radius = radius;
  return track;
}

Verification check(const base::TimedPath& path, const std::vector<base::Track>& tracks, double vehicle_radius = 0.5) {
  VerifierInput input;
  input.path = path;
  input.tracks = tracks;
  input.vehicle_radius = vehicle_radius;
  return verify(input);
}

// East at 2 m/s past a sphere 3 m to the side of x = 4: nearest at t = 2, 3 − 0.5 − 1 = 1.5.
TEST(Verifier, FindsTheClearanceToAStaticSphere) {
  const Verification v = check(line({0, 0, 0}, {10, 0, 0}, 5.0), {moving({4, 3, 0}, {0, 0, 0}, 1.0, 42)});
  EXPECT_NEAR(v.min_clearance, 1.5, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 2.0, 1e-6);
  EXPECT_EQ(v.nearest_id, 42U);
  EXPECT_TRUE(v.free());
}

// What stands counts as tracks do, and only what does is taken for it.
TEST(Verifier, FindsTheClearanceToWhatStands) {
  const base::TimedPath path = line({0, 0, 0}, {10, 0, 0}, 5.0);
  const std::vector<base::Track> tracks{moving({4, 5, 0}, {0, 0, 0}, 1.0, 41)};
  std::vector<base::Track> standing{moving({6, 3, 0}, {0, 0, 0}, 1.0, 42)};
  VerifierInput input;
  input.path = path;
  input.tracks = tracks;
  input.standing = standing;
  input.vehicle_radius = 0.5;
  const Verification v = verify(input);
  EXPECT_NEAR(v.min_clearance, 1.5, 1e-9);
  EXPECT_EQ(v.nearest_id, 42U);
  EXPECT_TRUE(v.free());
  standing[0].position = {6, 0, 0};
  EXPECT_FALSE(verify(input).free());
  standing[0] = moving({6, 3, 0}, {0, 0.1, 0}, 1.0, 42);
  EXPECT_FALSE(verify(input).valid);
}

// Head-on at 2 + 3 m/s from 20 m: contact where the gap is 1.5 m: t = 18.5/5 = 3.7.
TEST(Verifier, FindsFirstContactAndItsSpeedHeadOn) {
  const Verification v = check(line({0, 0, 0}, {20, 0, 0}, 10.0), {moving({20, 0, 0}, {-3, 0, 0}, 1.0)});
  ASSERT_TRUE(v.first_contact.has_value());
  EXPECT_NEAR(*v.first_contact, 3.7, 1e-9);
  EXPECT_NEAR(v.contact_speed, 5.0, 1e-9);
  EXPECT_NEAR(v.min_clearance, -1.5, 1e-9);  // centres meet at t = 4
  EXPECT_NEAR(v.t_min_clearance, 4.0, 1e-6);
  EXPECT_FALSE(v.free());
}

// At rest, an obstacle falls from z = 10 at a = −2: 10 − t² = 1.5 at t = sqrt(8.5), where its speed is 2·sqrt(8.5).
TEST(Verifier, FindsFirstContactWithAnAcceleratingObstacle) {
  base::Track track = moving({0, 0, 10}, {0, 0, 0}, 1.0);
  track.acceleration = {0, 0, -2};
  const Verification v = check(line({0, 0, 0}, {0, 0, 0}, 5.0), {track});
  ASSERT_TRUE(v.first_contact.has_value());
  EXPECT_NEAR(*v.first_contact, std::sqrt(8.5), 1e-9);
  EXPECT_NEAR(v.contact_speed, 2.0 * std::sqrt(8.5), 1e-8);
}

// Thrown up and back: z = 10 − 6t + t²: lowest 1 at t = 3, clearance 1 − 0.9; both ends are far away.
TEST(Verifier, FindsTheTurningPointOfAnObstacle) {
  base::Track track = moving({0, 0, 10}, {0, 0, -6}, 0.5);
  track.acceleration = {0, 0, 2};
  const Verification v = check(line({0, 0, 0}, {0, 0, 0}, 6.0), {track}, 0.4);
  EXPECT_NEAR(v.min_clearance, 0.1, 1e-9);
  EXPECT_NEAR(v.t_min_clearance, 3.0, 1e-5);
}

// Relative position (t² − 4, 0.2, 0) for t from −3 to 3: |x| is 0 at t = ±2, so the distance has two minima of 0.2.
TEST(Verifier, FindsBothOfTwoMinimaInOneSegment) {
  base::Track track = moving({5, 0.2, 0}, {-6, 0, 0}, 0.1);
  track.acceleration = {2, 0, 0};
  const Verification both = check(line({0, 0, 0}, {0, 0, 0}, 6.0), {track}, 0.2);
  EXPECT_NEAR(both.min_clearance, -0.1, 1e-9);
  ASSERT_TRUE(both.first_contact.has_value());
  // Contact: (t² − 4)² + 0.04 = 0.09 first at t² = 4 + sqrt(0.05), t = −2.0551, that is 0.9449 after the start.
  EXPECT_NEAR(*both.first_contact, 3.0 - std::sqrt(4.0 + std::sqrt(0.05)), 1e-9);
}

TEST(Verifier, SeesAVeryFastObstacleBetweenTwoPoints) {
  const Verification v = check(line({0, 0, 0}, {0.1, 0, 0}, 0.1), {moving({-5e3, 0, 0}, {1e5, 0, 0}, 0.1)});
  ASSERT_TRUE(v.first_contact.has_value());
  EXPECT_NEAR(*v.first_contact, 0.05, 1e-4);
}

// Three binary fractions, so that the distance is exact: 2 − 0.5 − 1.5.
TEST(Verifier, TouchingIsNoContact) {
  const Verification v = check(line({0, 0, 0}, {4, 0, 0}, 2.0), {moving({2, 2, 0}, {0, 0, 0}, 1.5)});
  EXPECT_EQ(v.min_clearance, 0.0);
  EXPECT_TRUE(v.free());
  EXPECT_FALSE(check(line({0, 0, 0}, {4, 0, 0}, 2.0), {moving({2, 2, 0}, {0, 0, 0}, 1.5 + 1e-12)}).free());
}

TEST(Verifier, ReportsContactFromTheStart) {
  const Verification v = check(line({0, 0, 0}, {9, 0, 0}, 3.0, 5.0), {moving({0.5, 0, 0}, {0, 0, 0}, 1.0)});
  ASSERT_TRUE(v.first_contact.has_value());
  EXPECT_EQ(*v.first_contact, 5.0);
  EXPECT_DOUBLE_EQ(v.contact_speed, 3.0);
}

TEST(Verifier, ReportsTheEarliestContactOfSeveral) {
  const std::vector<base::Track> tracks{moving({12, 0, 0}, {0, 0, 0}, 1.0, 1), moving({6, 0, 0}, {0, 0, 0}, 1.0, 2)};
  const Verification v = check(line({0, 0, 0}, {20, 0, 0}, 20.0), tracks);
  ASSERT_TRUE(v.first_contact.has_value());
  EXPECT_NEAR(*v.first_contact, 4.5, 1e-9);
}

TEST(Verifier, CountsObstaclesUpToTheTimeAsked) {
  const base::TimedPath path = line({0, 0, 0}, {20, 0, 0}, 20.0);
  const std::vector<base::Track> tracks{moving({10, 0, 0}, {0, 0, 0}, 0.5)};  // contact at t = 9
  VerifierInput input{path, tracks, 0.0, 0.5, {}, base::kInfinity, 8.9};
  const Verification before = verify(input);
  EXPECT_TRUE(before.free());
  EXPECT_NEAR(before.min_clearance, 0.1, 1e-9);
  input.until = 9.1;
  EXPECT_FALSE(verify(input).free());
}

TEST(Verifier, ReportsAPathThatLeavesTheVolume) {
  VerifierInput input;
  const base::TimedPath path{{0, {0, 0, 0}, kZero, kZero}, {1, {2, 0, 0}, kZero, kZero}, {2, {0, 0, 0}, kZero, kZero}};
  input.path = path;
  input.volume = {{-1, -1, -1}, {2, 1, 1}};
  EXPECT_TRUE(verify(input).free());
  input.volume.max.x() = 1.9;
  EXPECT_FALSE(verify(input).inside_volume);
  EXPECT_FALSE(verify(input).free());
}

// Out of the volume at x = 3, which the path passes at t = 3: within a segment, and at a point.
TEST(Verifier, JudgesTheVolumeUpToTheTimeAskedAndNotBeyond) {
  for (const base::TimedPath& path : {line({0, 0, 0}, {5, 0, 0}, 5.0), base::TimedPath{{0, {0, 0, 0}, kZero, kZero},
                                                                                       {3, {3, 0, 0}, kZero, kZero},
                                                                                       {4, {4, 0, 0}, kZero, kZero},
                                                                                       {5, {5, 0, 0}, kZero, kZero}}}) {
    VerifierInput input;
    input.path = path;
    input.volume = {{-1, -1, -1}, {3, 1, 1}};
    input.until = 2.0;
    EXPECT_TRUE(verify(input).free());
    input.until = 3.0;
    EXPECT_TRUE(verify(input).free());
    input.until = 3.1;
    EXPECT_FALSE(verify(input).inside_volume);
    input.until = 5.0;
    EXPECT_FALSE(verify(input).inside_volume);
    input.until = base::kInfinity;
    EXPECT_FALSE(verify(input).inside_volume);
  }
  // One point: that is all there is to judge.
  const base::TimedPath outside{{1.0, {4, 0, 0}, kZero, kZero}};
  VerifierInput input;
  input.path = outside;
  input.volume = {{-1, -1, -1}, {3, 1, 1}};
  EXPECT_FALSE(verify(input).free());
  input.until = 0.5;
  EXPECT_TRUE(verify(input).free());
}

TEST(Verifier, DoesNotPassAPathThatIsNotFinite) {
  EXPECT_FALSE(check({{0, {0, 0, 0}, kZero, kZero}, {1, {std::nan(""), 0, 0}, kZero, kZero}}, {}).free());
}

TEST(Verifier, ChecksAPathOfOnePoint) {
  const base::TimedPath path{{2.0, {0, 0, 0}, kZero, kZero}};
  const Verification v = check(path, {moving({5, 0, 0}, {-1, 0, 0}, 1.0)});  // 3 m away at t = 2
  EXPECT_NEAR(v.min_clearance, 1.5, 1e-12);
  EXPECT_FALSE(check(path, {moving({3, 0, 0}, {-1, 0, 0}, 1.0)}).free());
}

// Track valid at path time −1: at path time t it has moved t + 1 s.
TEST(Verifier, HonoursTheTimeOfTheTracks) {
  const base::TimedPath path = line({0, 0, 0}, {0, 0, 0}, 2.0);
  const std::vector<base::Track> tracks{moving({10, 0, 0}, {-2, 0, 0}, 1.0)};
  EXPECT_NEAR(verify({path, tracks, -1.0, 0.5, {}, base::kInfinity, base::kInfinity}).min_clearance, 10 - 6 - 1.5,
              1e-9);
}

// Accelerating at 2 for 1 s from 20 m: 1 m in the first second, then 2 m/s: after 5 s it has come 1 + 8 = 9 m.
TEST(Verifier, StopsAcceleratingWhereTrustEnds) {
  base::Track track = moving({20, 0, 0}, {0, 0, 0}, 1.0);
  track.acceleration = {-2, 0, 0};
  const std::vector<base::Track> tracks{track};
  const base::TimedPath path = line({0, 0, 0}, {0, 0, 0}, 5.0);
  EXPECT_NEAR(verify({path, tracks, 0.0, 0.5, {}, 1.0, base::kInfinity}).min_clearance, 20 - 9 - 1.5, 1e-9);
  EXPECT_NEAR(verify({path, tracks, 0.0, 0.5, {}, 0.0, base::kInfinity}).min_clearance, 18.5, 1e-9);
}

// The instant at which trust ends is tracks_time + trust, which rounding may put just before it.
TEST(Verifier, StopsAcceleratingWhereTrustEndsWhateverTheRounding) {
  base::Track track = moving({20, 0, 0}, {0, 0, 0}, 1.0);
  track.acceleration = {-2, 0, 0};
  const std::vector<base::Track> tracks{track};
  for (int i = 0; i < 100; ++i) {
    const double tracks_time = 0.1 * i;
    const base::TimedPath path = line({0, 0, 0}, {0, 0, 0}, 5.0, tracks_time);
    const double end = 5.0;
    const double expected = 20.0 - (0.49 + 1.4 * (end - 0.7)) - 1.5;
    EXPECT_NEAR(verify({path, tracks, tracks_time, 0.5, {}, 0.7, base::kInfinity}).min_clearance, expected, 1e-9)
        << tracks_time;
  }
}

struct RandomCase {
  base::TimedPath path;
  std::vector<base::Track> tracks;
  double trust = base::kInfinity;
};

RandomCase random_case(std::uint64_t seed) {
  base::RandomStream random(seed);
  const auto vec = [&](double range) {
    const double x = random.uniform(-range, range);
    const double y = random.uniform(-range, range);
    return Vec3(x, y, random.uniform(-range, range));
  };
  RandomCase c;
  double t = random.uniform(0.0, 1.0);
  for (int i = 0; i < 5; ++i) {
    c.path.push_back({t, vec(5.0), kZero, kZero});
    t += random.uniform(0.2, 1.5);
  }
  for (std::uint64_t id = 0; id < 3; ++id) {
    base::Track track = moving(vec(5.0), vec(4.0), random.uniform(0.5, 2.5), id);
    track.acceleration = vec(3.0);
    c.tracks.push_back(track);
  }
  c.trust = random.below(3) == 0 ? base::kInfinity : random.uniform(0.0, 4.0);
  return c;
}

/// Long paths, stops and turns among near and far tracks of all speeds.
RandomCase random_flight(std::uint64_t seed) {
  base::RandomStream random(seed);
  const auto vec = [&](double range) {
    const double x = random.uniform(-range, range);
    const double y = random.uniform(-range, range);
    return Vec3(x, y, random.uniform(-range, range));
  };
  RandomCase c;
  Vec3 position = vec(5.0);
  double t = random.uniform(0.0, 0.5);
  const std::size_t points = 2 + random.below(60);
  for (std::size_t i = 0; i < points; ++i) {
    c.path.push_back({t, position, kZero, kZero});
    t += random.uniform(0.05, 0.3);
    if (random.below(4) > 0) position += Vec3(0.4, 0, 0) + vec(0.4);
  }
  const double spread = random.below(2) == 0 ? 6.0 : 60.0;
  for (std::uint64_t id = 0; id < 25; ++id) {
    base::Track track = moving(vec(spread), vec(random.below(3) == 0 ? 20.0 : 2.0), random.uniform(0.1, 1.5), id);
    if (random.below(2) == 0) track.acceleration = vec(6.0);
    track.age = random.uniform(0.0, 0.5);
    c.tracks.push_back(track);
  }
  c.trust = random.below(3) == 0 ? base::kInfinity : random.uniform(0.0, 4.0);
  return c;
}

/// The exact check of one segment against one track at a time, for which there is nothing to skip.
Verification piece_by_piece(const VerifierInput& input) {
  Verification worst;
  for (const base::Track& track : input.tracks) {
    for (std::size_t i = 1; i < input.path.size(); ++i) {
      if (input.path[i - 1].t >= input.until) continue;
      VerifierInput one = input;
      one.path = input.path.subspan(i - 1, 2);
      one.tracks = {&track, 1};
      const Verification v = verify(one);
      if (v.min_clearance < worst.min_clearance) {
        worst.min_clearance = v.min_clearance;
        worst.nearest_id = v.nearest_id;
        worst.t_min_clearance = v.t_min_clearance;
      }
      if (v.first_contact && (!worst.first_contact || *v.first_contact < *worst.first_contact)) {
        worst.first_contact = v.first_contact;
        worst.contact_speed = v.contact_speed;
      }
    }
  }
  return worst;
}

TEST(Verifier, SkipsNothingThatMatters) {
  int contacts = 0;
  for (std::uint64_t seed = 1000; seed < 5000; ++seed) {
    const RandomCase c = random_flight(seed);
    const double until = seed % 3 == 0 ? c.path[c.path.size() / 2].t + 0.01 : base::kInfinity;
    const VerifierInput input{c.path, c.tracks, 0.0, 0.3, {}, c.trust, until};
    const Verification v = verify(input);
    const Verification expected = piece_by_piece(input);
    ASSERT_NEAR(v.min_clearance, expected.min_clearance, 1e-9) << seed;
    ASSERT_EQ(v.first_contact, expected.first_contact) << seed;
    ASSERT_EQ(v.contact_speed, expected.contact_speed) << seed;
    ASSERT_EQ(v.nearest_id, expected.nearest_id) << seed;
    ASSERT_EQ(v.t_min_clearance, expected.t_min_clearance) << seed;
    contacts += v.first_contact ? 1 : 0;
  }
  EXPECT_GT(contacts, 400);
  EXPECT_LT(contacts, 3600);
}

TEST(Verifier, MatchesDenseSampling) {
  constexpr double kStep = 1e-3;
  constexpr double kFastest = 60.0;  // bound of the relative speed of these cases, m/s
  int contacts = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    const RandomCase c = random_case(seed);
    const Verification v = verify({c.path, c.tracks, 0.0, 0.3, {}, c.trust, base::kInfinity});
    double lowest = base::kInfinity;
    double contact = base::kInfinity;
    for (double t = c.path.front().t; t <= c.path.back().t; t += kStep) {
      for (const base::Track& track : c.tracks) {
        const Vec3 gap = base::sample(c.path, t).position - geometry::predict_position(track, t, c.trust);
        const double clearance = gap.norm() - track.radius - 0.3;
        lowest = std::min(lowest, clearance);
        if (clearance < 0.0) contact = std::min(contact, t);
      }
    }
    ASSERT_LE(v.min_clearance, lowest + 1e-9) << seed;
    ASSERT_GE(v.min_clearance, lowest - kFastest * kStep) << seed;
    const double exact = base::sample(c.path, v.t_min_clearance).t;
    const base::Track& nearest = c.tracks[v.nearest_id];
    const Vec3 gap = base::sample(c.path, exact).position - geometry::predict_position(nearest, exact, c.trust);
    ASSERT_NEAR(gap.norm() - nearest.radius - 0.3, v.min_clearance, 1e-9) << seed;
    if (contact < base::kInfinity) {
      ++contacts;
      ASSERT_TRUE(v.first_contact.has_value()) << seed;
      ASSERT_LE(*v.first_contact, contact + 1e-9) << seed;
    }
    if (v.first_contact && *v.first_contact > c.path.front().t) {
      double at = base::kInfinity;  // the clearance is zero at the first contact
      for (const base::Track& track : c.tracks) {
        const Vec3 p = base::sample(c.path, *v.first_contact).position -
                       geometry::predict_position(track, *v.first_contact, c.trust);
        at = std::min(at, std::abs(p.norm() - track.radius - 0.3));
      }
      ASSERT_LT(at, 1e-9) << seed;
    }
  }
  EXPECT_GT(contacts, 20);  // the cases include both kinds
  EXPECT_LT(contacts, 140);
}

}  // namespace

// What cannot be judged is not free: no path, a number that is not finite, times that do not increase.
TEST(Verifier, WhatCannotBeJudgedIsNotFree) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3 origin(0, 0, 0);
  const Vec3 east(1, 0, 0);
  const base::TimedPath good{{0.0, origin, Vec3::Zero(), Vec3::Zero()}, {1.0, east, Vec3::Zero(), Vec3::Zero()}};
  base::Track far;
  far.position = {100, 0, 0};
  far.radius = 1.0;
  const std::vector<base::Track> tracks{far};
  ASSERT_TRUE(verify({good, tracks, 0.0, 0.3, {}}).free());

  EXPECT_FALSE(verify({base::TimedPath{}, tracks, 0.0, 0.3, {}}).free());
  EXPECT_FALSE(
      verify({base::TimedPath{{0.0, origin, Vec3::Zero(), Vec3::Zero()}, {0.0, east, Vec3::Zero(), Vec3::Zero()}},
              tracks,
              0.0,
              0.3,
              {}})
          .free());
  EXPECT_FALSE(verify({base::TimedPath{{nan, origin, Vec3::Zero(), Vec3::Zero()}}, tracks, 0.0, 0.3, {}}).free());
  EXPECT_FALSE(
      verify({base::TimedPath{{0.0, Vec3(nan, 0, 0), Vec3::Zero(), Vec3::Zero()}}, tracks, 0.0, 0.3, {}}).free());
  EXPECT_FALSE(verify({good, tracks, 0.0, nan, {}}).free());
  std::vector<base::Track> bad = tracks;
  bad[0].velocity.y() = nan;
  EXPECT_FALSE(verify({good, bad, 0.0, 0.3, {}}).free());
}

// Numbers that are ones, but so large that nothing follows from them: squares that overflow, differences that round.
TEST(Verifier, WhatIsTooLargeToJudgeIsNotFree) {
  const base::TimedPath path{{0.0, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()},
                             {10.0, {10, 0, 0}, Vec3::Zero(), Vec3::Zero()}};
  base::Track far;
  far.position = {100, 50, 0};
  far.radius = 1.0;
  const auto with = [&](auto change) {
    base::Track track = far;
    change(track);
    return std::vector<base::Track>{track};
  };
  const auto judged = [&](const std::vector<base::Track>& tracks) {
    const Verification v = verify({path, tracks, 0.0, 0.3, {}});
    EXPECT_EQ(v.valid, v.free());
    return v.valid;
  };
  ASSERT_TRUE(judged({far}));
  EXPECT_FALSE(judged(with([](base::Track& t) { t.acceleration = {0, 0, 1e15}; })));
  EXPECT_FALSE(judged(with([](base::Track& t) { t.acceleration = {0, 0, -1e160}; })));
  EXPECT_FALSE(judged(with([](base::Track& t) { t.velocity = {1e155, 0, 0}; })));
  EXPECT_FALSE(judged(with([](base::Track& t) { t.position = {1e200, 0, 0}; })));
  EXPECT_FALSE(judged(with([](base::Track& t) { t.radius = 1e160; })));
  EXPECT_FALSE(judged(with([](base::Track& t) { t.radius = -0.1; })));
  // Small enough to begin with, not for ten seconds.
  EXPECT_FALSE(judged(with([](base::Track& t) { t.acceleration = {0, 0, 9e4}; })));
  // Told so long ago, or so long before the path, that its place now is not known to a metre.
  for (const double tracks_time : {std::nan(""), base::kInfinity, -base::kInfinity, -1e12, -1e9}) {
    const std::vector<base::Track> tracks = with([](base::Track& t) { t.velocity = {1, 0, 0}; });
    EXPECT_FALSE(verify({path, tracks, tracks_time, 0.3, {}}).free()) << tracks_time;
  }
  EXPECT_FALSE(verify({path, std::vector<base::Track>{far}, 0.0, -0.1, {}}).free());
  EXPECT_FALSE(verify({path, std::vector<base::Track>{far}, 0.0, 1e160, {}}).free());
  EXPECT_FALSE(verify({path, std::vector<base::Track>{far}, 0.0, 0.3, {}, base::kInfinity, std::nan("")}).free());
  for (const base::TimedPoint& last : {base::TimedPoint{1e300, {1, 0, 0}, Vec3::Zero(), Vec3::Zero()},
                                       base::TimedPoint{10.0, {1e200, 0, 0}, Vec3::Zero(), Vec3::Zero()},
                                       base::TimedPoint{1e-9, {1, 0, 0}, Vec3::Zero(), Vec3::Zero()}}) {
    const base::TimedPath absurd{path.front(), last};
    EXPECT_FALSE(verify({absurd, std::vector<base::Track>{far}, 0.0, 0.3, {}}).free());
  }
  geometry::KnownPath known;
  known.points = {{1e9, {50, 9, 0}, Vec3::Zero(), Vec3::Zero()}, {1e9 + 9.0, {60, 9, 0}, Vec3::Zero(), Vec3::Zero()}};
  known.offset = 1e9;
  EXPECT_TRUE(verify({path, {}, 0.0, 0.3, {}, base::kInfinity, base::kInfinity, {&known, 1}}).free());
  known.offset = 0.0;  // its instants are told to 1e-7 s
  EXPECT_FALSE(verify({path, {}, 0.0, 0.3, {}, base::kInfinity, base::kInfinity, {&known, 1}}).free());
}

// 600 s at 300 m/s through a world of many kilometres, a track that falls for a minute, an obstacle as large as a hill.
TEST(Verifier, JudgesWhatIsReasonable) {
  base::TimedPath path;
  for (int i = 0; i <= 600; ++i) path.push_back({1.0 * i, {300.0 * i, 0, 1000}, Vec3::Zero(), Vec3::Zero()});
  base::Track hill;
  hill.position = {9e4, 0, -5000};
  hill.radius = 5900.0;
  base::Track falls;
  falls.position = {0, 4e5, 1e4};
  falls.velocity = {0, -300, 0};
  falls.acceleration = {0, 0, -10};
  const Verification v = verify({path, std::vector<base::Track>{hill, falls}, 0.0, 10.0, {}});
  EXPECT_TRUE(v.free());
  EXPECT_NEAR(v.min_clearance, 90.0, kAccuracy);
}

// An acceleration is believed for `trust` seconds from the measurement: one that is 0.6 s old has 0.1 s of 0.7 s left.
TEST(Verifier, TrustCountsFromTheMeasurement) {
  base::Track track;
  track.position = {10, 0, 0};
  track.acceleration = {-20, 0, 0};
  track.radius = 0.5;
  track.age = 0.6;
  const base::TimedPath path{{0.0, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()},
                             {1.0, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
  const Verification found = verify({path, std::vector<base::Track>{track}, 0.0, 0.3, {}, 0.7});
  // After 0.1 s: -0.1 m, -2 m/s; at 1 s: 10 - 0.1 - 1.8 = 8.1 m.
  EXPECT_NEAR(found.min_clearance, 8.1 - 0.8, 1e-9);
}

}  // namespace jink::planner::verify
