// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/setpoints/setpoint_stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace jink::bridge::setpoints {
namespace {

using planner::base::TimedPath;
using planner::base::TimedPoint;

SetpointStream::Settings plain() {
  return {.lead = 0.0, .acceleration_lead = 0.0, .drag = 0.0, .braking = 2.0};
}

/// Constant velocity through `at` at `start`, for `duration`.
TimedPath line(double start, const Vec3& at, const Vec3& velocity, double duration = 10.0) {
  TimedPath path;
  for (double t = 0.0; t <= duration + 1e-9; t += 0.1)
    path.push_back({start + t, at + t * velocity, velocity, Vec3::Zero()});
  return path;
}

TEST(SetpointStream, HoldsAPointAtRest) {
  SetpointStream stream(plain());
  EXPECT_FALSE(stream.active());
  stream.hold({1, 2, 3}, 5.0);
  EXPECT_TRUE(stream.active());
  for (const double t : {4.0, 5.0, 500.0}) {
    const vehicle::Setpoint setpoint = stream.setpoint(t, 0.7);
    EXPECT_EQ(setpoint.position, Vec3(1, 2, 3));
    EXPECT_EQ(setpoint.velocity, Vec3::Zero());
    EXPECT_EQ(setpoint.acceleration, Vec3::Zero());
    EXPECT_EQ(setpoint.yaw, 0.7);
  }
  EXPECT_TRUE(stream.plan(6.0).empty());
}

TEST(SetpointStream, LeadsAVehicleBesideItsReferenceAlongThePath) {
  SetpointStream stream(plain());
  stream.hold({0, 0, 1}, 0.0);
  const OffsetForecast offset{0.5, {0, 0.4, 0}};
  stream.follow(line(1.0, {0, 0.4, 1}, {2, 0, 0}), offset);
  for (const double t : {1.0, 2.0, 4.0, 8.0}) {
    const TimedPoint off = offset.at(t);
    EXPECT_LT((stream.reference(t).position + off.position - Vec3(2.0 * (t - 1.0), 0.4, 1)).norm(), 2e-3) << t;
    EXPECT_LT((stream.reference(t).velocity + off.velocity - Vec3(2, 0, 0)).norm(), 2e-2) << t;
  }
  EXPECT_NEAR(stream.reference(1.0).position.y(), 0.0, 0.01);
  EXPECT_EQ(stream.plan(3.0).front().position, Vec3(4, 0.4, 1));
  EXPECT_EQ(stream.plan(3.0).front().velocity, Vec3(2, 0, 0));
  stream.shift({0, 1, 0});
  EXPECT_EQ(stream.plan(3.0).front().position, Vec3(4, 1.4, 1));
}

TEST(SetpointStream, APlanTakesOverAtItsStart) {
  SetpointStream stream(plain());
  stream.hold({0, 0, 1}, 0.0);
  stream.follow(line(1.0, {0, 0, 1}, {2, 0, 0}));
  EXPECT_EQ(stream.reference(0.9).position, Vec3(0, 0, 1));
  EXPECT_EQ(stream.reference(0.9).velocity, Vec3::Zero());
  EXPECT_NEAR(stream.reference(1.5).position.x(), 1.0, 1e-12);
  EXPECT_EQ(stream.reference(1.5).velocity, Vec3(2, 0, 0));
  stream.follow(line(2.0, {2, 0, 1}, {0, 3, 0}));
  EXPECT_NEAR(stream.reference(1.9).position.x(), 1.8, 1e-12);
  EXPECT_NEAR(stream.reference(2.5).position.y(), 1.5, 1e-12);
  EXPECT_EQ(stream.reference(2.5).velocity, Vec3(0, 3, 0));
}

TEST(SetpointStream, StaysAtThePlansEnd) {
  SetpointStream stream(plain());
  stream.follow(line(0.0, {0, 0, 1}, {1, 0, 0}, 2.0));
  const vehicle::Setpoint after = stream.setpoint(100.0, 0.0);
  EXPECT_NEAR(after.position.x(), 2.0, 1e-9);
  EXPECT_EQ(after.velocity, Vec3::Zero());
}

// Plans may come faster than they start: until the first of them starts, what was followed before is.
TEST(SetpointStream, TwoPlansThatWaitForTheirStartFollowEachOther) {
  SetpointStream stream(plain());
  stream.follow(line(0.0, {0, 0, 1}, {1, 0, 0}));
  stream.follow(line(1.0, {1, 0, 1}, {0, 1, 0}));
  stream.follow(line(2.0, {1, 1, 1}, {0, 0, 1}));
  EXPECT_LT((stream.reference(0.5).position - Vec3(0.5, 0, 1)).norm(), 1e-9);
  EXPECT_LT((stream.reference(1.5).position - Vec3(1, 0.5, 1)).norm(), 1e-9);
  EXPECT_LT((stream.reference(2.5).position - Vec3(1, 1, 1.5)).norm(), 1e-9);
  stream.follow(line(3.0, {1, 1, 2}, {-1, 0, 0}));
  EXPECT_LT((stream.reference(2.5).position - Vec3(1, 1, 1.5)).norm(), 1e-9);
  EXPECT_LT((stream.reference(3.5).position - Vec3(0.5, 1, 2)).norm(), 1e-9);
}

void brake(SetpointStream& stream, double now) {
  stream.brake(stream.straight_stop(stream.reference(now)));
}

TEST(SetpointStream, BrakesAtTheStatedRateWithoutReversing) {
  for (const Vec3& velocity : {Vec3(4, 0, 0), Vec3(-3, 2, 1), Vec3(0, 0, -2), Vec3(0.03, 0, 0)}) {
    SetpointStream stream(plain());
    stream.follow(line(0.0, {0, 0, 5}, velocity));
    const double speed = velocity.norm();
    const Vec3 direction = velocity / speed;
    brake(stream, 1.0);
    EXPECT_LT((stream.reference(1.0).position - (Vec3(0, 0, 5) + velocity)).norm(), 1e-9);
    EXPECT_NEAR(stream.reference(1.0).velocity.norm(), speed, 1e-9);
    double last = speed;
    double travelled = 0.0;
    for (double t = 1.0; t < 5.0; t += 0.01) {
      const TimedPoint point = stream.reference(t);
      EXPECT_NEAR(point.velocity.norm(), std::max(0.0, speed - 2.0 * (t - 1.0)), 0.06) << t;
      EXPECT_GE(point.velocity.dot(direction), -1e-12);
      EXPECT_LE(point.velocity.norm(), last + 1e-12);
      last = point.velocity.norm();
      const double along = (point.position - Vec3(0, 0, 5) - velocity).dot(direction);
      EXPECT_GE(along, travelled - 1e-12);
      travelled = along;
    }
    EXPECT_EQ(last, 0.0);
    EXPECT_NEAR(travelled, speed * speed / 4.0, 0.02 + 0.01 * speed);
    if (speed > 1.0) {
      EXPECT_LT((stream.setpoint(1.2, 0.0).acceleration + 2.0 * direction).norm(), 1e-9);
    }
    EXPECT_EQ(stream.setpoint(9.0, 0.0).acceleration, Vec3::Zero());
  }
}

TEST(SetpointStream, BrakesHarderWhereTheVolumeEndsSoon) {
  SetpointStream::Settings settings = plain();
  settings.hardest = 6.0;
  settings.volume = {{-10, -10, 1}, {10, 10, 8}};
  struct Case {
    Vec3 from, velocity;
    double way;  // of the stop
  };
  const std::vector<Case> cases{{{0, 0, 5}, {4, 0, 0}, 4.0},          // room enough
                                {{8, 0, 5}, {4, 0, 0}, 2.0},          // 4 m/s² does it
                                {{9.5, 0, 5}, {4, 0, 0}, 4.0 / 3.0},  // nothing does: as hard as may be
                                {{0, 0, 2}, {0, 0, -3}, 1.0},
                                {{12, 0, 5}, {4, 0, 0}, 4.0}};  // outside: nothing to keep
  for (const Case& c : cases) {
    SetpointStream stream(settings);
    stream.follow(line(0.0, c.from, c.velocity));
    brake(stream, 0.0);
    EXPECT_NEAR((stream.reference(50.0).position - c.from).norm(), c.way, 0.02) << c.from.transpose();
  }
}

TEST(SetpointStream, MovesAlongWithTheEstimate) {
  SetpointStream stream(plain());
  stream.follow(line(0.0, {0, 0, 5}, {1, 0, 0}));
  stream.follow(line(2.0, {2, 0, 5}, {0, 1, 0}));
  stream.shift({3, 0, -1});
  EXPECT_LT((stream.reference(1.0).position - Vec3(4, 0, 4)).norm(), 1e-9);
  EXPECT_LT((stream.reference(3.0).position - Vec3(5, 1, 4)).norm(), 1e-9);
  EXPECT_EQ(stream.reference(3.0).velocity, Vec3(0, 1, 0));
}

TEST(SetpointStream, AStopFromThereBeginsThere) {
  SetpointStream stream(plain());
  stream.brake(stream.straight_stop({1.0, {5, 0, 2}, {2, 0, 0}, Vec3::Zero()}));
  EXPECT_EQ(stream.reference(1.0).position, Vec3(5, 0, 2));
  EXPECT_NEAR((stream.reference(9.0).position - Vec3(6, 0, 2)).norm(), 0.0, 0.05);
}

TEST(SetpointStream, ABrakeForgetsThePlanAndANewPlanEndsTheBrake) {
  SetpointStream stream(plain());
  stream.follow(line(0.0, {0, 0, 5}, {1, 0, 0}));
  stream.follow(line(1.0, {1, 0, 5}, {1, 0, 0}));
  brake(stream, 0.5);
  EXPECT_EQ(stream.reference(20.0).velocity, Vec3::Zero());
  EXPECT_LT(stream.reference(20.0).position.x(), 0.8);
  EXPECT_TRUE(stream.plan(1.0).empty());
  stream.follow(line(3.0, {0.75, 0, 5}, {1, 0, 0}));
  EXPECT_EQ(stream.reference(2.9).velocity, Vec3::Zero());
  EXPECT_NEAR(stream.reference(4.0).position.x(), 1.75, 1e-9);
}

TEST(SetpointStream, LeadsTheLagsAndFeedsForward) {
  SetpointStream::Settings settings{.lead = 0.1, .acceleration_lead = 0.5, .drag = 0.8, .braking = 2.0};
  SetpointStream stream(settings);
  TimedPath path;  // from rest at 2 m/s²
  for (double t = 0.0; t < 3.01; t += 0.1) path.push_back({t, {t * t, 0, 1}, {2 * t, 0, 0}, {2, 0, 0}});
  stream.follow(path);
  const vehicle::Setpoint setpoint = stream.setpoint(1.0, 0.0);
  EXPECT_NEAR(setpoint.position.x(), 1.21, 1e-9);
  EXPECT_NEAR(setpoint.velocity.x(), 2.2, 1e-9);
  EXPECT_NEAR(setpoint.acceleration.x(), 2.0 + 0.8 * 3.0, 1e-9);
}

// PX4's velocity loop takes its derivative gain times the measured acceleration off: horizontally, not in height.
TEST(SetpointStream, AsksForTheAccelerationThatTheAutopilotTakesOffAgain) {
  SetpointStream::Settings settings = plain();
  settings.damping = 0.2;
  SetpointStream stream(settings);
  TimedPath path;
  for (double t = 0.0; t < 3.01; t += 0.1)
    path.push_back({t, {t * t, -t * t, 1 + t * t}, {2 * t, -2 * t, 2 * t}, {2, -2, 2}});
  stream.follow(path);
  EXPECT_LT((stream.setpoint(1.0, 0.0).acceleration - Vec3(2.4, -2.4, 2.0)).norm(), 1e-9);
}

TEST(SetpointStream, HandsOutWhatIsLeftOfThePlan) {
  SetpointStream stream(plain());
  stream.follow(line(0.0, {0, 0, 1}, {1, 0, 0}, 2.0));
  stream.follow(line(1.0, {1, 0, 1}, {0, 1, 0}, 2.0));
  const TimedPath after = stream.plan(1.25);
  EXPECT_EQ(after.front().t, 1.25);
  EXPECT_NEAR(after.front().position.y(), 0.25, 1e-9);
  EXPECT_NEAR(after.back().position.y(), 2.0, 1e-9);
}

/// One axis of PX4 as px4-sitl.md has it, without its lags: position and velocity loop, drag.
struct Vehicle {
  double x = 0.0, v = 0.0, integral = 0.0;
  void step(const vehicle::Setpoint& setpoint, double drag, double dt, double damping = 0.0) {
    const double wish = 0.95 * (setpoint.position.x() - x) + setpoint.velocity.x();
    integral += 0.4 * (wish - v) * dt;
    v += (1.8 * (wish - v) + integral + setpoint.acceleration.x() - drag * v) / (1.0 + damping) * dt;
    x += v * dt;
  }
};

/// From rest at `acceleration` up to `speed`, on for a second, and back, `times` times.
TimedPath shuttle(double acceleration, double speed, int times) {
  TimedPath path;
  TimedPoint point{0.0, {0, 0, 1}, Vec3::Zero(), Vec3::Zero()};
  const auto go = [&](double a, double seconds) {
    for (int step = 0; step < static_cast<int>(std::round(seconds / 0.02)); ++step) {
      point.acceleration.x() = a;
      path.push_back(point);
      point.position += 0.02 * point.velocity + 0.5 * 0.02 * 0.02 * point.acceleration;
      point.velocity += 0.02 * point.acceleration;
      point.t += 0.02;
    }
  };
  const double seconds = speed / acceleration;
  for (int time = 0; time < times; ++time)
    for (const double way : {1.0, -1.0}) {
      go(way * acceleration, seconds);
      go(0.0, 1.0);
      go(-way * acceleration, seconds);
    }
  return path;
}

/// How far the vehicle was from its reference at most, from `begin` on, m.
double farthest(SetpointStream& stream, double drag, double damping, double begin, double end) {
  Vehicle vehicle;
  double most = 0.0;
  for (double t = 0.0; t < end; t += 0.02) {
    vehicle.step(stream.setpoint(t, 0.0), drag, 0.02, damping);
    stream.observe(t + 0.02, {vehicle.x, 0, 1}, {vehicle.v, 0, 0});
    if (t >= begin) most = std::max(most, std::abs(vehicle.x - stream.reference(t + 0.02).position.x()));
  }
  return most;
}

TEST(SetpointStream, LearnsTheDragWhileItGetsFast) {
  SetpointStream stream(plain());
  stream.follow(shuttle(4.0, 5.0, 1));
  EXPECT_LT(farthest(stream, 1.0, 0.0, 0.0, 2.2), 0.45);
  EXPECT_NEAR(stream.drag(), 1.0, 0.3);
}

TEST(SetpointStream, LearnsTheDampingThatTheAutopilotHas) {
  for (const double truth : {0.0, 0.2, 0.4}) {
    SCOPED_TRACE(truth);
    SetpointStream stream(plain());
    const TimedPath path = shuttle(4.0, 4.0, 8);
    stream.follow(path);
    EXPECT_LT(farthest(stream, 0.5, truth, 0.75 * path.back().t, path.back().t - 0.1), 0.1);
    EXPECT_NEAR(stream.damping(), truth, 0.06);
  }
}

TEST(SetpointStream, LearnsTheDragThatTheVehicleHas) {
  for (const double truth : {0.3, 1.0, 1.6}) {
    SCOPED_TRACE(truth);
    SetpointStream::Settings settings = plain();
    settings.drag = 0.9;
    SetpointStream stream(settings);
    stream.follow(line(0.0, {0, 0, 1}, {3, 0, 0}, 60.0));
    Vehicle vehicle{.v = 3.0};
    for (double t = 0.0; t < 60.0; t += 0.02) {
      vehicle.step(stream.setpoint(t, 0.0), truth, 0.02);
      stream.observe(t + 0.02, {vehicle.x, 0, 1}, {vehicle.v, 0, 0});
      ASSERT_GE(stream.drag(), 0.0);
      ASSERT_LE(stream.drag(), 2.0);
    }
    // The autopilot's own integral takes a part: what matters is that the vehicle is where it is to be.
    EXPECT_LT(std::abs(vehicle.x - stream.reference(60.0).position.x()), 0.05);
    EXPECT_LT(std::abs(stream.drag() - truth), std::abs(0.9 - truth) + 1e-9);
  }
}

TEST(SetpointStream, WhatIsLearnedIsBounded) {
  for (const double speed : {1.0, 5.0}) {  // slower than the reference, and faster
    SetpointStream stream(plain());
    stream.follow(line(0.0, {0, 0, 1}, {3, 0, 0}, 60.0));
    for (double t = 0.0; t < 50.0; t += 0.02) stream.observe(t, {speed * t, 0, 1}, {speed, 0, 0});
    EXPECT_EQ(stream.drag(), speed < 3.0 ? 2.0 : 0.0);
  }
}

// What fell behind at the start and then flies as fast as it may stays behind: that is no drag, and thrust that makes
// up for drag that is not there drives the vehicle beyond its target.
TEST(SetpointStream, LearnsNothingOfALagAtTheLargestSpeed) {
  SetpointStream::Settings settings = plain();
  settings.drag = 1.0;
  settings.max_speed = 3.0;
  SetpointStream stream(settings);
  stream.follow(line(0.0, {0, 0, 1}, {3, 0, 0}, 60.0));
  double t = 0.0;
  for (; t < 10.0; t += 0.02) stream.observe(t, {3 * t - 0.6, 0, 1}, {2.98, 0, 0});
  EXPECT_EQ(stream.drag(), 1.0);
  for (; t < 11.0; t += 0.02) stream.observe(t, {3 * t + 0.3, 0, 1}, {2.98, 0, 0});
  EXPECT_LT(stream.drag(), 1.0);  // ahead of it, there is too much
}

// A vehicle that has to tilt first lags whenever the speed is to change, and leads when it slows down: the more the
// speed changes, the less is learned from it.
TEST(SetpointStream, LearnsLittleWhileTheSpeedChanges) {
  const auto learned = [](double acceleration) {
    SetpointStream stream(plain());
    const auto at = [&](double t) { return Vec3(4 * t + 0.5 * acceleration * t * t, 0, 1); };
    TimedPath path;
    for (double t = 0.0; t <= 1.0; t += 0.1)
      path.push_back({t, at(t), {4 + acceleration * t, 0, 0}, {acceleration, 0, 0}});
    stream.follow(path);
    for (double t = 0.0; t < 0.9; t += 0.02) stream.observe(t, at(t) - Vec3(0.3, 0, 0), {4 + acceleration * t, 0, 0});
    return stream.drag();
  };
  EXPECT_GT(learned(0.0), 0.08);
  EXPECT_LT(learned(-5.0), 0.7 * learned(0.0));
}

TEST(SetpointStream, LearnsNothingWhenSlowHoldingOrBraking) {
  SetpointStream::Settings settings = plain();
  settings.drag = 0.7;
  SetpointStream stream(settings);
  stream.observe(0.0, {1, 0, 0}, {2, 0, 0});
  stream.follow(line(0.0, {0, 0, 1}, {0.9, 0, 0}));
  stream.observe(1.0, {0, 0, 1}, {2, 0, 0});
  EXPECT_EQ(stream.drag(), 0.7);
  stream.follow(line(0.0, {0, 0, 1}, {3, 0, 0}));
  brake(stream, 1.0);
  stream.observe(1.1, {0, 0, 1}, {2, 0, 0});
  stream.hold({5, 0, 1}, 2.0);
  stream.observe(3.0, {0, 0, 1}, {2, 0, 0});
  EXPECT_EQ(stream.drag(), 0.7);
  stream.follow(line(3.0, {5, 0, 1}, {3, 0, 0}));
  stream.observe(4.0, {7.5, 0, 1}, {2, 0, 0});
  EXPECT_EQ(stream.drag(), 0.7);  // the first says nothing of how the lag grows
  stream.observe(4.1, {7.8, 0, 1}, {2, 0, 0});
  EXPECT_GT(stream.drag(), 0.7);
}

// Found by tests/fuzz/fuzz_supervisor: what sank below min_height was to stop under the ground.
TEST(SetpointStream, AStopBelowTheVolumeSinksNoFurther) {
  SetpointStream::Settings settings = plain();
  settings.volume = {{-50, -50, 1}, {50, 50, 20}};
  const SetpointStream stream(settings);
  for (const Vec3& velocity : {Vec3(-5.8, 4.9, -0.8), Vec3(0, 0, -3)}) {
    for (const planner::base::TimedPoint& point : stream.straight_stop({0.0, {0, 0, 0.4}, velocity, Vec3::Zero()})) {
      EXPECT_TRUE(point.position.allFinite() && point.velocity.allFinite() && point.acceleration.allFinite());
      EXPECT_GE(point.position.z(), 0.4);
    }
  }
  double least = 2.0;  // from above it ends inside, as hard as that takes, or at the floor
  for (const planner::base::TimedPoint& point : stream.straight_stop({0.0, {0, 0, 1.2}, {0, 0, -5}, Vec3::Zero()}))
    least = std::min(least, point.position.z());
  EXPECT_NEAR(least, 1.0, 0.15);
}

}  // namespace
}  // namespace jink::bridge::setpoints
