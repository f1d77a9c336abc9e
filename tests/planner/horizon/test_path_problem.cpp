// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/path_problem.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/base/solid.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/standing.hpp"

namespace jink::planner::horizon {
namespace {

PathRequest request(const Vec3& target = {40, 0, 2}) {
  PathRequest r;
  r.position = {0, 0, 2};
  r.target = target;
  return r;
}

base::Track sphere(const Vec3& position, const Vec3& velocity, double radius = 0.5) {
  base::Track track;
  track.position = position;
  track.velocity = velocity;
  track.radius = radius;
  return track;
}

Vec3 random_vector(base::RandomStream& random, double range) {
  const double x = random.uniform(-range, range);
  const double y = random.uniform(-range, range);
  return {x, y, random.uniform(-range, range)};
}

std::vector<double> random_variables(base::RandomStream& random, const PathProblem& problem, double range = 1.0) {
  std::vector<double> x(static_cast<std::size_t>(problem.dimension()));
  for (double& value : x) value = random.uniform(-range, range);
  return x;
}

std::vector<double> zeros(const PathProblem& problem) {
  return std::vector<double>(static_cast<std::size_t>(problem.dimension()), 0.0);
}

optimizer::Cost evaluate(const PathProblem& problem, std::span<const double> x) {
  optimizer::Cost cost;
  problem.evaluate(x, {&cost, 1});
  return cost;
}

TEST(PathRequest, KeepsTheMarginOfTheSettings) {
  base::HorizonSettings settings;
  settings.margin = 0.7;
  settings.track_acceleration = 0.9;
  settings.sudden_change = 1.3;
  settings.acceleration_trust = 1.1;
  const auto request = PathRequest::with(settings);
  EXPECT_EQ(request.margin, 0.7);
  EXPECT_EQ(request.track_acceleration, 0.9);
  EXPECT_EQ(request.sudden_change, 1.3);
  EXPECT_EQ(request.acceleration_trust, 1.1);
}

TEST(PathProblem, HasThreeVariablesForEachWaypoint) {
  const PathProblem problem{base::HorizonSettings{}};
  EXPECT_EQ(problem.dimension(), 18);
  EXPECT_EQ(problem.objectives(), 3);
  EXPECT_EQ(problem.steps(), 60);
  EXPECT_DOUBLE_EQ(problem.horizon(), 6.0);
  for (const double v : problem.lower()) EXPECT_EQ(v, -1.0);
  for (const double v : problem.upper()) EXPECT_EQ(v, 1.0);
}

/// How far a motion strays from steady straight flight to its target.
struct Straightness {
  double aside = 0.0;      ///< largest distance from the line, m
  double backward = 0.0;   ///< most that it ever falls back, m
  double overshoot = 0.0;  ///< beyond the target, m
  double fastest = 0.0;
  double off_cruise = 0.0;  ///< largest difference from cruise speed after 2 s and 4 m before the target, m/s
};

Straightness straightness(const base::TimedPath& path, const geometry::PathFrame& frame, double cruise) {
  Straightness s;
  double furthest = 0.0;
  for (const base::TimedPoint& point : path) {
    const Vec3 q = frame.from_enu(point.position);
    s.aside = std::max(s.aside, std::hypot(q.y(), q.z()));
    s.backward = std::max(s.backward, furthest - q.x());
    s.overshoot = std::max(s.overshoot, q.x() - frame.length);
    s.fastest = std::max(s.fastest, point.velocity.norm());
    furthest = std::max(furthest, q.x());
    if (point.t > 2.0 && frame.length - q.x() > 4.0) {
      s.off_cruise = std::max(s.off_cruise, std::abs(point.velocity.norm() - cruise));
    }
  }
  return s;
}

/// The motion of zero variables from rest, and from it the cruise speed: slower where it climbs steeply.
Straightness unobstructed(const Vec3& target, double& cruise, base::TimedPath& path) {
  PathProblem problem{base::HorizonSettings{}};
  const PathRequest r = request(target);
  problem.prepare(r);
  path = problem.motion(zeros(problem));
  const geometry::PathFrame frame(r.position, target);
  cruise = std::min(3.0, 2.0 / std::max(1e-9, std::abs(frame.axis.z())));
  return straightness(path, frame, cruise);
}

const std::vector<Vec3> kTargets{{20, 0, 2}, {-12, 9, 2}, {0, 0, 12}, {12, 0, 11}};

// The follower has a lag: it is up to 12 % fast for a moment, and up to 10 cm beyond a target that lies within the
// horizon.
TEST(PathProblem, ZeroVariablesAreUnobstructedStraightFlight) {
  for (const Vec3& target : kTargets) {
    double cruise = 0.0;
    base::TimedPath path;
    const Straightness s = unobstructed(target, cruise, path);
    EXPECT_LT(s.aside, 1e-9);
    EXPECT_LT(s.off_cruise, 0.05);
    EXPECT_LT(s.fastest, 1.13 * cruise);
    EXPECT_LT(s.overshoot, 0.1);
    EXPECT_EQ(path.back().position, target);
    EXPECT_EQ(path.back().velocity, Vec3(0, 0, 0));
    EXPECT_NEAR(base::path_length(path), (target - Vec3(0, 0, 2)).norm(), 0.2);
  }
}

// "With all of them 0 it is unobstructed flight": straight on, at cruise speed, braking for the target, without the
// follower's overshoot.
TEST(PathProblem, ZeroVariablesDoNotOvershootSpeedOrTarget) {
  for (const Vec3& target : kTargets) {
    double cruise = 0.0;
    base::TimedPath path;
    const Straightness s = unobstructed(target, cruise, path);
    EXPECT_LE(s.fastest, cruise + 1e-6);
    EXPECT_LE(s.overshoot, 1e-6);
    EXPECT_LE(s.backward, 1e-6);
  }
}

// Plans are made anew every 50 ms: one that begins by flying back, though it leads on, never gets anywhere.
TEST(PathProblem, WhoSetsOutSlowlyDoesNotFlyBackFirst) {
  for (const Vec3& target : kTargets) {
    PathProblem problem{base::HorizonSettings{}};
    problem.prepare(request(target));
    const base::TimedPath free = problem.unobstructed_motion();
    for (const double share : {0.0, 0.3, 0.7}) {
      base::TimedPath slow = free;
      for (base::TimedPoint& point : slow)
        point.position = free.front().position + share * (point.position - free.front().position);
      std::vector<double> x = zeros(problem);
      problem.encode_path(slow, x);
      const Vec3 axis = (target - free.front().position).normalized();
      for (const base::TimedPoint& point : problem.motion(x)) {
        if (point.t <= problem.settings().leg()) {
          EXPECT_GT(point.velocity.dot(axis), -0.06) << point.t;
        }
      }
    }
  }
}

// For the same reason: who is to be 2 m farther back in a second, and puts that off, puts it off in each plan.
TEST(PathProblem, WhoIsToFlyBackBeginsAtOnce) {
  for (const Vec3& target : kTargets) {
    PathProblem problem{base::HorizonSettings{}};
    const PathRequest r = request(target);
    problem.prepare(r);
    const Vec3 axis = (target - r.position).normalized();
    for (const double speed : {0.3, 1.0}) {
      base::TimedPath back;
      for (int n = 0; n <= problem.steps(); ++n) {
        const double t = 0.1 * n;
        back.push_back({t, r.position - std::min(2.0, speed * t) * axis, Vec3::Zero(), Vec3::Zero()});
      }
      std::vector<double> x = zeros(problem);
      problem.encode_path(back, x);
      const base::TimedPath path = problem.motion(x);
      EXPECT_LT(base::sample(path, 0.5).velocity.dot(axis), -0.8 * speed) << speed;
      EXPECT_NEAR(base::sample(path, 1.0).velocity.dot(axis), -speed, 0.2 * speed) << speed;
    }
  }
}

TEST(PathProblem, ZeroVariablesAreTheCheapestWithoutObstacles) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request();
  problem.prepare(r);
  const optimizer::Cost straight = evaluate(problem, zeros(problem));
  EXPECT_NEAR(straight.f[0], 40.0, 0.01);  // its length, and at most a few milliseconds lost
  EXPECT_NEAR(straight.f[1], 0.0, 1e-6);
  EXPECT_EQ(straight.f[2], 0.0);
  EXPECT_EQ(straight.violation, 0.0);
  base::RandomStream random(1);
  for (int i = 0; i < 200; ++i) EXPECT_GT(evaluate(problem, random_variables(random, problem)).f[0], straight.f[0]);
}

// There after 3 s, for a second, and away again; or through the target without a stop.
TEST(PathProblem, AfterAVisitNeitherLengthNorTimeCounts) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request({4, 0, 2});
  base::TimedPath path;
  for (int step = 0; step <= 60; ++step) {
    const double t = 0.1 * step;
    const double x = t < 3.0 ? 4.0 / 3.0 * t : t < 4.0 ? 4.0 : 4.0 - 1.5 * (t - 4.0);
    path.push_back({t, {x, 0, 2}, Vec3::Zero(), Vec3::Zero()});
  }
  base::TimedPath through = path;
  for (base::TimedPoint& point : through) point.position.x() = 1.2 * point.t;
  const auto lengths = [&](bool visit) {
    r.visit = visit;
    problem.prepare(r);
    return std::array{problem.cost_of(path).f[0], problem.cost_of(through).f[0]};
  };
  const auto [whole, whole_through] = lengths(false);
  const auto [there, visit_through] = lengths(true);
  EXPECT_GT(whole, 4.0 + 3.0 + 1.0);
  EXPECT_GT(there, 4.0);
  EXPECT_LT(there, whole - 3.0 - 1.0);
  EXPECT_EQ(visit_through, whole_through);
}

TEST(PathProblem, StartsInTheRequestsState) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request();
  r.velocity = {1, -1, 0.5};
  problem.prepare(r);
  base::RandomStream random(2);
  const base::TimedPath path = problem.motion(random_variables(random, problem));
  EXPECT_EQ(path.front().t, 0.0);
  EXPECT_EQ(path.front().position, r.position);
  EXPECT_EQ(path.front().velocity, r.velocity);
}

// The limits are those of VehicleLimits, the acceleration acceleration_share of it or of acceleration_limit, whichever
// is less.
TEST(PathProblem, MotionIsFlyableWhateverTheVariables) {
  const base::HorizonSettings settings;
  PathProblem problem{settings};
  base::RandomStream random(3);
  for (int round = 0; round < 300; ++round) {
    PathRequest r = request(Vec3(0, 0, 2) + random_vector(random, round % 2 == 0 ? 30.0 : 5.0));
    r.velocity = 0.3 * random_vector(random, 5.0);
    if (round % 3 == 0) r.vehicle.max_acceleration = 3.0 * settings.acceleration_limit;
    problem.prepare(r);
    const base::TimedPath path = problem.motion(random_variables(random, problem));
    ASSERT_GE(path.size(), 2U);
    for (std::size_t i = 1; i < path.size(); ++i) {
      ASSERT_NEAR(path[i].t - path[i - 1].t, settings.step, 1e-9);
      const Vec3 moved = (path[i].position - path[i - 1].position) / settings.step;
      ASSERT_LE(moved.norm(), r.vehicle.max_speed + 1e-9);
      ASSERT_LE(std::abs(moved.z()), r.vehicle.max_climb + 1e-9);
      ASSERT_LE(path[i].velocity.norm(), r.vehicle.max_speed + 1e-9);
      ASSERT_LE(std::abs(path[i].velocity.z()), r.vehicle.max_climb + 1e-9);
      const Vec3 change = (path[i].velocity - path[i - 1].velocity) / settings.step;
      const double most = std::min(r.vehicle.max_acceleration, settings.acceleration_limit);
      ASSERT_LE(change.norm(), settings.acceleration_share * most + 1e-9);
      ASSERT_LT((change - path[i - 1].acceleration).norm(), 1e-6);
      ASSERT_LT((moved - 0.5 * (path[i].velocity + path[i - 1].velocity)).norm(), 1e-9);
    }
  }
}

/// Vehicles from slow to fast and from lame to agile, all directions, targets from a hair's breadth to far away.
struct AnyVehicle {
  base::HorizonSettings settings;
  PathRequest request;
};

double spread(base::RandomStream& random, double low, double high) {
  return low * std::pow(high / low, random.uniform(0.0, 1.0));
}

AnyVehicle any_vehicle(std::uint64_t seed) {
  base::RandomStream random(seed);
  AnyVehicle any;
  constexpr std::array kSteps = {0.1, 0.02, 0.05, 0.2, 0.5};
  any.settings.step = kSteps[random.below(kSteps.size())];
  any.settings.time = std::min(6.0, 250.0 * any.settings.step);
  if (random.below(3) == 0) any.settings = any.settings.for_emergencies();
  if (random.below(10) == 0) any.settings.acceleration_share = 1.0;
  PathRequest& r = any.request;
  r.vehicle.max_speed = spread(random, 0.1, 20.0);
  r.vehicle.cruise_speed = random.uniform(0.3, 1.0) * r.vehicle.max_speed;
  r.vehicle.max_acceleration = spread(random, 0.5, 30.0);
  r.vehicle.max_climb = std::min(spread(random, 0.1, 5.0), r.vehicle.max_speed);
  r.position = {0, 0, 2};
  // As far as is flown in three minutes, up and down too.
  const double far =
      random.below(20) == 0 ? 0.0 : spread(random, 1e-4, 1.0) * std::min(200.0, 40.0 * r.vehicle.max_speed);
  r.target = r.position + random_vector(random, far);
  r.target.z() = std::clamp(r.target.z(), 2.0 - 100.0 * r.vehicle.max_climb, 2.0 + 100.0 * r.vehicle.max_climb);
  if (random.below(3) != 0) r.velocity = random_vector(random, r.vehicle.max_speed / std::sqrt(3.0));
  r.velocity.z() = std::clamp(r.velocity.z(), -r.vehicle.max_climb, r.vehicle.max_climb);
  if (random.below(15) == 0) r.velocity *= 2.0;  // blown faster than it flies
  return any;
}

// Speed, climb and planned acceleration in every step, the last ones too, in which it comes to rest on the target; what
// is above a limit at the start comes down from there.
TEST(PathProblem, EveryVehicleKeepsItsLimitsToTheTarget) {
  int settled = 0;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    const auto [settings, r] = any_vehicle(seed);
    PathProblem problem{settings};
    problem.prepare(r);
    base::RandomStream random(seed, 1);
    const std::vector<double> x = random_variables(random, problem, seed % 3 == 0 ? 0.0 : spread(random, 0.01, 1.0));
    const base::TimedPath path = problem.motion(x);
    ASSERT_EQ(path.back().position, r.target) << seed;
    ASSERT_EQ(path.back().velocity, Vec3(0, 0, 0)) << seed;
    const double speed = std::max(r.vehicle.max_speed, r.velocity.norm());
    const double climb = std::max(r.vehicle.max_climb, std::abs(r.velocity.z()));
    const double acceleration = settings.planned_acceleration(r.vehicle.max_acceleration);
    for (std::size_t i = 1; i < path.size(); ++i) {
      const double duration = path[i].t - path[i - 1].t;
      ASSERT_NEAR(duration, settings.step, 1e-9) << seed;
      const Vec3 moved = (path[i].position - path[i - 1].position) / duration;
      ASSERT_LE(moved.norm(), speed * (1.0 + 1e-9)) << seed << ", " << path[i].t;
      ASSERT_LE(std::abs(moved.z()), climb * (1.0 + 1e-9)) << seed << ", " << path[i].t;
      const Vec3 change = path[i].velocity - path[i - 1].velocity;
      ASSERT_LE(change.norm(), acceleration * duration * (1.0 + 1e-9)) << seed << ", " << path[i].t;
      ASSERT_LT((change - settings.step * path[i - 1].acceleration).norm(), 1e-9) << seed << ", " << path[i].t;
      ASSERT_LT((moved - 0.5 * (path[i].velocity + path[i - 1].velocity)).norm(), 1e-8) << seed << ", " << path[i].t;
    }
    settled += path.back().t <= problem.horizon() ? 1 : 0;
  }
  EXPECT_GT(settled, 400);
  EXPECT_LT(settled, 3600);
}

// Where the vehicle is what it usually is, it is at the target as soon as it can be: half a second of acceleration at
// most, and braking at 2 m/s², cost it 0.25 s and 0.75 s more than cruise speed all the way.
TEST(PathProblem, ComesToRestWithoutDelay) {
  PathProblem problem{base::HorizonSettings{}};
  for (const double distance : {4.0, 7.0, 10.0, 14.0, 17.0, 20.0, 33.0, 40.0}) {
    const PathRequest r = request({distance, 0, 2});
    problem.prepare(r);
    EXPECT_LT(problem.motion(zeros(problem)).back().t, distance / 3.0 + 0.5 + 0.75 + 0.15) << distance;
  }
}

TEST(PathProblem, MotionEndsAtTheTargetAndAtRest) {
  PathProblem problem{base::HorizonSettings{}};
  base::RandomStream random(4);
  for (int round = 0; round < 100; ++round) {
    PathRequest r = request(Vec3(0, 0, 2) + random_vector(random, 40.0));
    problem.prepare(r);
    const base::TimedPath path = problem.motion(random_variables(random, problem));
    ASSERT_EQ(path.back().position, r.target);
    ASSERT_EQ(path.back().velocity, Vec3(0, 0, 0));
    if (path.size() > 1) {  // it ends where it arrived, and does not wait there
      ASSERT_GT((path[path.size() - 2].position - r.target).norm(), 0.0);
    }
  }
}

TEST(PathProblem, WorksWhereStartAndTargetCoincide) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request({0, 0, 2});
  problem.prepare(r);
  const base::TimedPath path = problem.motion(zeros(problem));
  ASSERT_FALSE(path.empty());
  EXPECT_EQ(path.back().position, r.target);
  const optimizer::Cost cost = evaluate(problem, zeros(problem));
  EXPECT_TRUE(std::isfinite(cost.f[0] + cost.f[1] + cost.f[2] + cost.violation));
}

TEST(PathProblem, WaypointsStayInTheVolumeAndLeavingItIsAViolation) {
  PathProblem problem{base::HorizonSettings{}};
  base::RandomStream random(5);
  PathRequest r = request();
  r.volume = {{-1, -1, 1}, {45, 1, 3}};
  problem.prepare(r);
  for (int round = 0; round < 100; ++round) {
    const std::vector<double> x = random_variables(random, problem);
    double outside = 0.0;  // m·s
    for (const base::TimedPoint& point : problem.motion(x)) {
      if (point.t > problem.horizon() + 1e-9 || point.t == 0.0) continue;
      const Vec3 inside = point.position.cwiseMax(r.volume.min).cwiseMin(r.volume.max);
      outside += 0.1 * (point.position - inside).norm();
    }
    const optimizer::Cost cost = evaluate(problem, x);
    ASSERT_NEAR(cost.violation, outside, 1e-9);
    ASSERT_LT(cost.violation, 4.0);  // overshoot alone, though variables of ±1 ask for 6 m to the side
  }
}

/// What it costs to come as near as `distance` where at least `hard` is asked for, and `extra` more is better, from
/// `advance` farther off on.
void add_to_cost(double distance, double hard, double extra, double weight, optimizer::Cost& cost,
                 double advance = 0.0) {
  cost.violation += weight * std::max(0.0, hard - distance);
  if (extra > 0.0) {
    const double depth = std::clamp((hard + extra + advance - distance) / extra, 0.0, 1.0);
    cost.f[2] += weight * depth * depth;
  }
}

/// What it costs to come as near as `distance` to a track's surface in a step from time t on, by the definition, where
/// the vehicle comes nearer by `nearer` by its own motion.
void add_to_cost(double distance, double nearer, const base::Track& track, double t, const base::HorizonSettings& s,
                 const PathRequest& r, optimizer::Cost& cost) {
  const double weight = s.step / (0.5 + t);
  const double ahead = t + s.step + track.age;
  const double sigma = std::hypot(track.position_sigma, track.velocity_sigma * ahead);
  const double unsure = s.sigma_factor * sigma + 0.5 * r.track_acceleration * ahead * ahead;
  const double evading = s.emergency_share * std::min(r.vehicle.max_acceleration, s.acceleration_limit);
  const double change = sigma > 0.0 ? r.sudden_change : std::min(r.sudden_change, track.sudden_change);  // m/s
  const double evasion = change * std::min(0.45 + change / (2.0 * evading), s.horizon());
  const double extra = std::max(evasion, std::min(s.clearance_limit, unsure));
  const double in_reaction = 0.45 / s.step * std::max(0.0, nearer);
  const double advance = std::min({s.clearance_limit, evasion, in_reaction});
  add_to_cost(distance, r.vehicle.radius + r.margin, extra, weight, cost, advance);
}

/// f3 and violation by their definition, from every track, nothing left out, but for leaving the volume.
optimizer::Cost reference_cost(const PathProblem& problem, const base::HorizonSettings& s, const PathRequest& r,
                               const base::TimedPath& path) {
  optimizer::Cost cost;
  for (int n = 0; n < problem.steps(); ++n) {
    const double t = n * s.step;
    const Vec3 from = base::sample(path, t).position;
    const Vec3 to = base::sample(path, (n + 1) * s.step).position;
    for (const base::Track& track : r.tracks) {
      const Vec3 c = geometry::predict_position(track, t, r.acceleration_trust);
      const Vec3 d = geometry::predict_position(track, (n + 1) * s.step, r.acceleration_trust);
      const double distance = std::sqrt(geometry::swept_distance_squared(from, to, c, d)) - track.radius;
      const Vec3 halfway = 0.5 * (c + d);
      add_to_cost(distance, (from - halfway).norm() - (to - halfway).norm(), track, t, s, r, cost);
    }
    for (const base::Track& track : r.standing) {
      const double distance =
          std::sqrt(geometry::swept_distance_squared(from, to, track.position, track.position)) - track.radius;
      add_to_cost(distance, r.vehicle.radius + r.margin_beside_standing(),
                  std::min(s.clearance_limit, s.sigma_factor * track.position_sigma), s.step / (0.5 + t), cost);
    }
    if (r.volume_clearance > 0.0) {
      const Vec3 inset = (0.25 * (r.volume.max - r.volume.min)).cwiseMin(r.volume_clearance);
      const Vec3 low = (r.volume.min + inset).cwiseMin(r.target), high = (r.volume.max - inset).cwiseMax(r.target);
      const double depth = (to - to.cwiseMax(low).cwiseMin(high)).norm() / r.volume_clearance;
      cost.f[2] += s.step / (0.5 + t) * std::min(1.0, depth * depth);
    }
  }
  return cost;
}

std::vector<base::Track> random_tracks(base::RandomStream& random) {
  std::vector<base::Track> tracks;
  for (std::uint64_t id = 0; id < 110; ++id) {  // several chunks of the inner loop
    base::Track track = sphere(random_vector(random, 25.0), random_vector(random, 4.0), random.uniform(0.2, 1.0));
    track.id = id;
    track.acceleration = random_vector(random, 2.0);
    track.position_sigma = id % 3 == 0 ? 0.0 : random.uniform(0.0, 0.1);
    track.velocity_sigma = id % 3 == 0 ? 0.0 : random.uniform(0.0, 0.1);
    track.age = random.uniform(0.0, 0.3);
    track.sudden_change = id % 2 == 0 ? 0.0 : random.uniform(0.0, 4.0);
    tracks.push_back(track);
  }
  return tracks;
}

// Also proves that no obstacle that can be met is left out.
TEST(PathProblem, ObstacleCostsMatchTheDefinitionOverAllTracks) {
  const base::HorizonSettings settings;
  PathProblem problem{settings};
  base::RandomStream random(6);
  int violated = 0;
  std::size_t kept = 0;
  for (int round = 0; round < 60; ++round) {
    std::vector<base::Track> tracks = random_tracks(random);
    std::vector<base::Track> standing;
    set_apart(round % 3 == 0 ? std::vector<std::uint64_t>() : std::vector<std::uint64_t>{3, 4, 5, 30, 40, 41, 100},
              tracks, standing);
    PathRequest r = request();
    r.velocity = random_vector(random, 2.0);
    r.tracks = tracks;
    r.standing = standing;
    r.margin = 0.35;
    r.standing_margin = round % 2 == 0 ? 0.15 : base::kInfinity;
    r.track_acceleration = 0.4;
    r.sudden_change = round % 4 < 2 ? 0.0 : 0.3 * round;
    r.acceleration_trust = round % 2 == 0 ? 0.7 : base::kInfinity;
    problem.prepare(r);
    kept += problem.obstacles();
    for (int i = 0; i < 10; ++i) {
      const std::vector<double> x = random_variables(random, problem);
      const optimizer::Cost cost = evaluate(problem, x);
      const optimizer::Cost expected = reference_cost(problem, settings, r, problem.motion(x));
      ASSERT_NEAR(cost.f[2], expected.f[2], 1e-9);
      ASSERT_NEAR(cost.violation, expected.violation, 1e-9);
      violated += cost.violation > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(violated, 50);
  EXPECT_LT(violated, 590);
  EXPECT_GT(kept, 60U * 33U);
  EXPECT_LT(kept, 60U * 110U);
}

/// The same tracks, of solids within their spheres, which turn or do not.
std::vector<base::Track> random_solids(base::RandomStream& random) {
  std::vector<base::Track> tracks = random_tracks(random);
  for (base::Track& track : tracks) {
    const Vec3 half = 1.5 * random_vector(random, 1.0).cwiseAbs();
    const double corner = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 0.5);
    const double rounding = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 0.3);
    track.body.solid = random.below(5) == 0
                           ? base::Solid::hull({random_vector(random, 1.0), random_vector(random, 1.0),
                                                random_vector(random, 1.0), random_vector(random, 1.0)})
                           : base::Solid::prism(half, corner, rounding,
                                                {0.3 * random_vector(random, 1.0), Eigen::Matrix3d::Identity()});
    track.body.yaw = random.uniform(-3.0, 3.0);
    track.body.yaw_rate = random.below(2) == 0 ? 0.0 : random.uniform(-2.0, 2.0);
    track.radius = track.body.solid->reach() + random.uniform(0.0, 0.2);
  }
  return tracks;
}

/// f3 and violation from the distances of many places of each step.
optimizer::Cost sampled_cost(const PathProblem& problem, const base::HorizonSettings& s, const PathRequest& r,
                             const base::TimedPath& path) {
  constexpr int kPlaces = 10;
  optimizer::Cost cost;
  for (int n = 0; n < problem.steps(); ++n) {
    const double begin = n * s.step;
    for (const base::Track& track : r.tracks) {
      double distance = base::kInfinity;
      for (int i = 0; i <= kPlaces; ++i) {
        const double t = begin + s.step * i / kPlaces;
        const Vec3 c = geometry::predict_position(track, t, r.acceleration_trust);
        distance = std::min(distance, PlacedSolid(track.body, c, t).distance(base::sample(path, t).position));
      }
      const Vec3 from = geometry::predict_position(track, begin, r.acceleration_trust);
      const Vec3 to = geometry::predict_position(track, begin + s.step, r.acceleration_trust);
      const PlacedSolid halfway(track.body, 0.5 * (from + to), begin + 0.5 * s.step);
      const double nearer = halfway.distance(base::sample(path, begin).position) -
                            halfway.distance(base::sample(path, begin + s.step).position);
      add_to_cost(distance, nearer, track, begin, s, r, cost);
    }
    for (const base::Track& track : r.standing) {
      const PlacedSolid solid(track.body, track.position, 0.0);
      double distance = base::kInfinity;
      for (int i = 0; i <= kPlaces; ++i)
        distance = std::min(distance, solid.distance(base::sample(path, begin + s.step * i / kPlaces).position));
      add_to_cost(distance, r.vehicle.radius + r.margin_beside_standing(),
                  std::min(s.clearance_limit, s.sigma_factor * track.position_sigma), s.step / (0.5 + begin), cost);
    }
  }
  return cost;
}

// Of solids the distance is that of a few places in a step, so a little more than the least.
TEST(PathProblem, SolidsCostTheirTrueDistances) {
  const base::HorizonSettings settings;
  PathProblem problem{settings};
  base::RandomStream random(8);
  int violated = 0;
  for (int round = 0; round < 12; ++round) {
    std::vector<base::Track> tracks = random_solids(random);
    std::vector<base::Track> standing;
    if (round % 2 == 0) set_apart(std::vector<std::uint64_t>{1, 2, 3, 5, 8, 13, 21, 34, 55, 89}, tracks, standing);
    PathRequest r = request();
    r.velocity = random_vector(random, 2.0);
    r.tracks = tracks;
    r.standing = standing;
    r.margin = 0.35;
    r.track_acceleration = 0.4;
    r.sudden_change = round % 3 == 0 ? 1.5 : 0.0;
    r.acceleration_trust = 0.7;
    problem.prepare(r);
    for (int i = 0; i < 5; ++i) {
      const std::vector<double> x = random_variables(random, problem);
      const optimizer::Cost cost = evaluate(problem, x);
      const optimizer::Cost expected = sampled_cost(problem, settings, r, problem.motion(x));
      ASSERT_NEAR(cost.f[2], expected.f[2], 0.04 + 0.1 * expected.f[2]) << round;
      ASSERT_NEAR(cost.violation, expected.violation, 0.04 + 0.1 * expected.violation) << round;
      violated += cost.violation > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(violated, 5);
}

/// Requests that strain the bounds of where the vehicle can be: fast away from the target, beyond the limits of speed
/// and climb, in a narrow volume, on a short way, with other limits.
PathRequest strained(base::RandomStream& random, int round) {
  PathRequest r = request(round % 5 == 0 ? Vec3(3, 1, 2) : Vec3(40, 0, 2));
  r.velocity = random_vector(random, round % 3 == 0 ? 12.0 : 3.0);
  if (round % 4 == 0) r.volume = {{-2, -1, 1}, {45, 1, 3}};
  r.volume_clearance = round % 8 == 0 ? 0.45 : round % 3 == 0 ? 0.8 : 0.0;  // without a volume too
  if (round % 7 == 0) r.vehicle.max_acceleration = 1.0;
  if (round % 11 == 0) r.vehicle.max_speed = 15.0;
  r.margin = 0.35;
  r.track_acceleration = 0.4;
  r.sudden_change = round % 3 == 0 ? 1.5 : 0.0;
  r.acceleration_trust = round % 2 == 0 ? 0.7 : base::kInfinity;
  return r;
}

TEST(PathProblem, LeavesOutNoObstacleThatAnyMotionMeets) {
  const base::HorizonSettings settings;
  PathProblem problem{settings};
  base::RandomStream random(61);
  int met = 0;
  for (int round = 0; round < 150; ++round) {
    std::vector<base::Track> tracks = random_tracks(random);
    for (base::Track& track : tracks) {  // half of them far, of which many come near
      if (random.below(2) == 0) continue;
      track.position *= random.uniform(2.0, 6.0);
      track.velocity = -track.position / random.uniform(1.0, 6.0) + random_vector(random, 4.0);
      track.acceleration *= random.uniform(0.0, 4.0);
    }
    PathRequest r = strained(random, round);
    r.tracks = tracks;
    problem.prepare(r);
    for (int i = 0; i < 8; ++i) {
      const std::vector<double> x = random_variables(random, problem, i < 2 ? 0.1 : 1.0);
      const base::TimedPath path = problem.motion(x);
      const optimizer::Cost cost = evaluate(problem, x);
      const optimizer::Cost expected = reference_cost(problem, settings, r, path);
      double outside = 0.0;
      for (int n = 1; n <= problem.steps(); ++n) {
        const Vec3 p = base::sample(path, n * settings.step).position;
        outside += settings.step * (p - p.cwiseMax(r.volume.min).cwiseMin(r.volume.max)).norm();
      }
      const double scale = 1.0 + expected.violation + outside;
      ASSERT_NEAR(cost.f[2], expected.f[2], 1e-9 * scale) << round;
      if (path.back().t < problem.horizon()) continue;  // put on the target at the end, which evaluation leaves out
      ASSERT_NEAR(cost.violation, expected.violation + outside, 1e-9 * scale) << round;
      met += expected.violation > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(met, 200);
}

// The plan flown until now may be where no new solution can be.
TEST(PathProblem, CostOfCountsObstaclesWhereNoSolutionCanBe) {
  const base::HorizonSettings settings;
  PathProblem problem{settings};
  base::RandomStream random(62);
  for (int round = 0; round < 20; ++round) {
    const std::vector<base::Track> tracks = random_tracks(random);
    PathRequest r = strained(random, 1);
    r.tracks = tracks;
    problem.prepare(r);
    base::TimedPath path;
    for (int i = 0; i < 8; ++i) path.push_back({0.9 * i, random_vector(random, 20.0), Vec3::Zero(), Vec3::Zero()});
    const optimizer::Cost cost = problem.cost_of(path);
    const optimizer::Cost expected = reference_cost(problem, settings, r, path);
    ASSERT_NEAR(cost.f[2], expected.f[2], 1e-9);
    ASSERT_NEAR(cost.violation, expected.violation, 1e-9);
  }
}

// What is measured is what is flown, to the bit.
TEST(PathProblem, MeasuresTheMotionItself) {
  PathProblem problem{base::HorizonSettings{}};
  base::RandomStream random(63);
  for (int round = 0; round < 50; ++round) {
    const std::vector<base::Track> tracks = random_tracks(random);
    PathRequest r = request();
    r.velocity = random_vector(random, 2.0);
    r.tracks = tracks;
    problem.prepare(r);
    const std::vector<double> x = random_variables(random, problem);
    base::TimedPath path = problem.motion(x);
    ASSERT_GT(path.back().t, problem.horizon());
    for (std::size_t n = 0; n < path.size(); ++n) path[n].t = static_cast<double>(n) * 0.1;  // sampled at its points
    EXPECT_EQ(problem.cost_of(path).f, evaluate(problem, x).f);
    EXPECT_EQ(problem.cost_of(path).violation, evaluate(problem, x).violation);
  }
}

TEST(PathProblem, CountsTheStepsInWhichWhatMovesCanBeMet) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request();
  const std::vector<base::Track> tracks{sphere({0, 0.6, 2}, {0.01, 0, 0}), sphere({0, -0.6, 2}, {0, 0.01, 0}),
                                        sphere({100, 0, 2}, {-0.1, 0, 0})};
  r.tracks = tracks;
  problem.prepare(r);
  EXPECT_EQ(problem.meetings(), 2U * static_cast<std::size_t>(problem.steps()));
  r.tracks = {};
  r.standing = tracks;
  problem.prepare(r);
  EXPECT_EQ(problem.meetings(), 0U);
}

// 0.1 s steps at 200 m/s: 20 m between two instants, across the path.
TEST(PathProblem, DoesNotLoseAnObstacleThatIsFarAwayAtEveryInstant) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request();
  const std::vector<base::Track> tracks{sphere({1.5, -210, 2}, {0, 200, 0})};
  r.tracks = tracks;
  problem.prepare(r);
  EXPECT_EQ(problem.obstacles(), 1U);
  EXPECT_GT(evaluate(problem, zeros(problem)).violation, 0.0);
}

TEST(PathProblem, UnreachableObstaclesAreLeftOutAndChangeNothing) {
  PathProblem problem{base::HorizonSettings{}};
  base::RandomStream random(7);
  PathRequest r = request();
  const std::vector<base::Track> near{sphere({6, 0.3, 2}, {-1, 0, 0})};
  std::vector<base::Track> all = near;
  all.push_back(sphere({100, 0, 2}, {0, 0, 0}));
  all.push_back(sphere({20, 40, 2}, {0, 3, 0}));
  const std::vector<double> x = random_variables(random, problem, 0.2);
  r.tracks = near;
  problem.prepare(r);
  const optimizer::Cost without = evaluate(problem, x);
  r.tracks = all;
  problem.prepare(r);
  EXPECT_EQ(problem.obstacles(), 1U);
  const optimizer::Cost with = evaluate(problem, x);
  EXPECT_EQ(with.f, without.f);
  EXPECT_EQ(with.violation, without.violation);
}

// One second late: time_weight · 3 m/s · 1 s in the length objective.
TEST(PathProblem, LostTimeCountsAsLength) {
  base::HorizonSettings settings;
  settings.deviation_weight = 0.0;
  PathProblem problem{settings};
  PathRequest r = request({9, 0, 2});
  problem.prepare(r);
  const base::TimedPath straight = problem.motion(zeros(problem));
  base::TimedPath late = straight;
  for (base::TimedPoint& point : late) point.t += 1.0;
  EXPECT_NEAR(problem.cost_of(straight).f[0], 9.0, 0.2);
  EXPECT_NEAR(problem.cost_of(late).f[0] - problem.cost_of(straight).f[0], settings.time_weight * 3.0 * 1.0, 0.16);
}

// By its cruise speed of 0.3 m/s a vehicle would rather wait for the whole horizon than go round.
TEST(PathProblem, LostTimeHasAPriceThatAPassingSlownessDoesNotLower) {
  base::HorizonSettings settings;
  settings.deviation_weight = 0.0;
  settings.time_weight = 0.5;
  PathProblem problem{settings};
  PathRequest r = request({4, 0, 2});
  r.velocity.setZero();
  r.vehicle.cruise_speed = 0.3;
  const auto cost = [&](const base::TimedPath& path) { return problem.cost_of(path).f[0]; };
  problem.prepare(r);
  const double horizon = problem.horizon();
  const base::TimedPath waits{{0, r.position, Vec3::Zero(), Vec3::Zero()},
                              {horizon, r.position, Vec3::Zero(), Vec3::Zero()}};
  const Vec3 aside = 0.5 * (r.position + r.target) + Vec3(0, 2, 0);
  const base::TimedPath goes{{0, r.position, Vec3::Zero(), Vec3::Zero()},
                             {0.3 * horizon, aside, Vec3::Zero(), Vec3::Zero()},
                             {0.6 * horizon, r.target, Vec3::Zero(), Vec3::Zero()}};
  EXPECT_LT(cost(waits), cost(goes));
  r.time_price = 3.0;
  problem.prepare(r);
  EXPECT_GT(cost(waits), cost(goes));
}

// The way over the place instead of straight on counts in full, and as lost time, `hurry` times as much of it.
TEST(PathProblem, TheWayOnLeadsOverAPlaceThatIsGiven) {
  base::HorizonSettings settings;
  PathProblem problem{settings};
  const PathRequest r = request({40, 0, 2});
  problem.prepare(r);
  const std::vector<double> straight = zeros(problem);
  const double before = evaluate(problem, straight).f[0];
  const base::TimedPoint end = base::sample(problem.motion(straight), problem.horizon());
  const double braking = settings.planned_acceleration(r.vehicle.max_acceleration);
  const Vec3 stop = end.position + Vec3(end.velocity.squaredNorm() / (2.0 * braking), 0, 0);
  const Vec3 via(30, 6, 5);
  const double detour = (via - stop).norm() + (r.target - via).norm() - (r.target - stop).norm();
  ASSERT_GT(detour, 1.0);
  problem.prepare(r, via);
  EXPECT_NEAR(evaluate(problem, straight).f[0] - before, (1.0 + settings.hurry * settings.time_weight) * detour, 0.1);
  problem.prepare(r, Vec3(5, 6, 5));  // passed by then
  EXPECT_NEAR(evaluate(problem, straight).f[0], before, 0.05);
  problem.prepare(r);
  EXPECT_EQ(evaluate(problem, straight).f[0], before);
}

// Right angle to the left, then straight on to the target behind it: π/2, and the way back to the line.
TEST(PathProblem, SteeringIsTheSumOfTheAnglesBetweenLegs) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request({6, 6, 2});
  r.velocity = {1, 0, 0};
  problem.prepare(r);
  // At 2 m/s east for 3 s, then north for 3 s: corners at waypoint 3 (t = 3 s) alone.
  const base::TimedPath path{{0, {0, 0, 2}, Vec3::Zero(), Vec3::Zero()},
                             {3, {6, 0, 2}, Vec3::Zero(), Vec3::Zero()},
                             {6, {6, 6, 2}, Vec3::Zero(), Vec3::Zero()}};
  EXPECT_NEAR(problem.cost_of(path).f[1], std::numbers::pi / 2, 1e-9);
}

TEST(PathProblem, CostOfAMotionIsItsEvaluation) {
  PathProblem problem{base::HorizonSettings{}};
  base::RandomStream random(8);
  for (int round = 0; round < 20; ++round) {
    const std::vector<base::Track> tracks = random_tracks(random);
    PathRequest r = request();
    r.tracks = tracks;
    r.margin = 0.35;
    problem.prepare(r);
    const std::vector<double> x = random_variables(random, problem, 0.5);
    const optimizer::Cost a = evaluate(problem, x);
    const optimizer::Cost b = problem.cost_of(problem.motion(x));
    EXPECT_NEAR(a.f[0], b.f[0], 1e-9);
    EXPECT_NEAR(a.f[1], b.f[1], 1e-9);
    EXPECT_NEAR(a.f[2], b.f[2], 1e-9);
    EXPECT_NEAR(a.violation, b.violation, 1e-9);
  }
}

/// Things beside the way, more than are looked at together, every third of them a sphere.
std::vector<base::Track> random_standing(base::RandomStream& random) {
  std::vector<base::Track> standing;
  for (int i = 0; i < 400; ++i) {
    base::Track track =
        sphere({random.uniform(-1.0, 7.0), random.uniform(-3.0, 3.0), random.uniform(0.5, 4.0)}, Vec3::Zero(), 0.2);
    if (i % 3 > 0) {
      track.body.solid = base::Solid::box(random_vector(random, 0.3).cwiseAbs(), {});
      track.radius = track.body.solid->reach();
    }
    standing.push_back(track);
  }
  return standing;
}

// To the bit, whatever the lane, the block and what else is in it; and it is the motion that is measured.
TEST(PathProblem, EvaluatesSeveralSolutionsLikeOne) {
  PathProblem problem{base::HorizonSettings{}};
  base::RandomStream random(9);
  const std::vector<base::Track> spheres = random_tracks(random), solids = random_solids(random),
                                 many = random_standing(random);
  PathRequest r = request();
  r.margin = 0.35;
  r.volume = {{-1, -4, 0.5}, {50, 4, 6}};
  r.velocity = {2, 1, 0};
  for (const auto& [tracks, standing] :
       {std::pair(&spheres, std::size_t{0}), {&solids, std::size_t{20}}, {&solids, std::size_t{400}}}) {
    r.tracks = *tracks;
    r.standing = std::span(many).first(standing);
    problem.prepare(r);
    for (const std::size_t count : {1U, 3U, 4U, 5U, 8U, 9U, 12U, 13U, 17U, 25U, 48U}) {
      std::vector<double> all;
      for (std::size_t i = 0; i < count; ++i) {
        const std::vector<double> x = random_variables(random, problem, i % 2 == 0 ? 1.0 : 0.2);
        all.insert(all.end(), x.begin(), x.end());
      }
      std::vector<optimizer::Cost> costs(count);
      problem.evaluate(all, costs);
      for (std::size_t i = 0; i < count; ++i) {
        const optimizer::Cost alone = evaluate(problem, std::span(all).subspan(18 * i, 18));
        EXPECT_EQ(costs[i].f, alone.f);
        EXPECT_EQ(costs[i].violation, alone.violation);
      }
    }
  }
}

// Waypoints lie on the path, but the vehicle follows them with a lag, so the motion is not the same again: on average
// it stays within the lag of half a second at the speed of the drift.
TEST(PathProblem, ImitatedMotionStaysClose) {
  PathProblem problem{base::HorizonSettings{}};
  base::RandomStream random(10);
  double worst = 0.0;
  double sum = 0.0;
  int count = 0;
  for (int round = 0; round < 100; ++round) {
    PathRequest r = request();
    r.velocity = {3, 0, 0};
    problem.prepare(r);
    const std::vector<double> x = random_variables(random, problem, 0.15);
    const base::TimedPath path = problem.motion(x);
    std::vector<double> y(x.size());
    problem.encode_path(path, y);
    const base::TimedPath again = problem.motion(y);
    for (int n = 0; n <= problem.steps(); ++n, ++count) {
      const double off = (base::sample(path, 0.1 * n).position - base::sample(again, 0.1 * n).position).norm();
      worst = std::max(worst, off);
      sum += off;
    }
  }
  EXPECT_LT(sum / count, 0.45);
  EXPECT_LT(worst, 2.2);
}

// The first waypoint after 1 s: 2 m to the left and 1 m up of the straight line, of min(6, 5·1) = 5 m that ±1 reaches.
TEST(PathProblem, ImitationIsTheOffsetOverTheReach) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request();
  problem.prepare(r);
  std::vector<double> x = zeros(problem);
  problem.encode_path({{0, {0, 2, 3}, Vec3::Zero(), Vec3::Zero()}}, x);
  EXPECT_NEAR(x[1], 2.0 / 5.0, 1e-12);
  EXPECT_NEAR(x[2], 1.0 / 5.0, 1e-12);
  EXPECT_NEAR(x[4], 2.0 / 6.0, 1e-12);
  EXPECT_LT(x[0], 0.0);  // it stays behind unobstructed flight
  for (const double value : x) EXPECT_LE(std::abs(value), 1.0);
}

// 3 m to the left for two thirds of the horizon. The waypoints reach 5 m and then 6 m aside.
TEST(PathProblem, GoesAsideAndReturns) {
  PathProblem problem{base::HorizonSettings{}};
  PathRequest r = request();
  problem.prepare(r);
  std::vector<double> x = zeros(problem);
  for (std::size_t k = 0; k < 4; ++k) x[3 * k + 1] = 3.0 / (k == 0 ? 5.0 : 6.0);
  double leftmost = 0.0;
  for (const base::TimedPoint& point : problem.motion(x)) leftmost = std::max(leftmost, point.position.y());
  EXPECT_GT(leftmost, 2.9);
  EXPECT_LT(leftmost, 3.9);  // the follower overshoots by a quarter
  EXPECT_EQ(x[15], 0.0);
  EXPECT_EQ(x[16], 0.0);
}

}  // namespace

TEST(PathProblem, RefusesMoreStepsThanItHasRoomFor) {
  base::HorizonSettings settings;
  settings.time = 30.0;
  settings.step = 0.1;
  EXPECT_THROW(PathProblem{settings}, std::invalid_argument);
  settings.step = 0.0;
  EXPECT_THROW(PathProblem{settings}, std::invalid_argument);
}

}  // namespace jink::planner::horizon
