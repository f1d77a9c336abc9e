// SPDX-License-Identifier: BSD-3-Clause
// A vehicle that is driven out of the geofence, or farther than it can make good.
#include <gtest/gtest.h>

#include <string>

#include "tests/bridge/companion/companion_loop.hpp"

namespace jink::bridge::companion {
namespace {

using testing::Loop;

struct Driven : Loop {
  using Loop::Loop;
  void drive(const Vec3& to) {
    airborne().fly();
    follows = false;
    link.telemetry.motion.value.position = to;
    link.telemetry.motion.value.velocity.setZero();
    run(0.1);
  }
  [[nodiscard]] const std::string& hazard() const { return companion.supervisor().hazard(); }
};

// The fence: -5 to 30 east, -10 to 10 north, 0 to 12 up.
TEST(CompanionContainment, ABreachIsAHazardAndComesBackInside) {
  for (const Vec3& out : {Vec3(10, 11.5, 2), Vec3(10, -84, 2), Vec3(-6.2, 0, 2), Vec3(31.1, 0, 2), Vec3(3, 0, -1.1)}) {
    SCOPED_TRACE(out.transpose());
    Driven loop;
    loop.drive(out);
    EXPECT_EQ(loop.hazard(), "the vehicle has left the geofence");
    loop.run(0.5);
    ASSERT_EQ(loop.planner.jobs.back().goal, Goal::Kind::kStop);
    EXPECT_TRUE(Loop::mission().geofence.contains(loop.planner.jobs.back().request.target));
    loop.run(4.0);
    EXPECT_EQ(loop.link.requests.back(), vehicle::Command::kHold);
    EXPECT_EQ(loop.companion.supervisor().reason(), "the vehicle has left the geofence");
  }
}

TEST(CompanionContainment, SoIsACeiling) {
  Driven loop;
  loop.drive({3, 0, 13.2});
  EXPECT_EQ(loop.hazard(), "the vehicle is above the geofence");
}

TEST(CompanionContainment, ALittleIsTheWayBackAndInsideItFliesOn) {
  Driven loop;
  loop.drive({10, 10.8, 2});
  EXPECT_EQ(loop.hazard(), "");
  Driven back;
  back.drive({10, 11.5, 2});
  back.link.telemetry.motion.value.position.y() = 10.5;
  back.run(0.1);
  EXPECT_EQ(back.hazard(), "");
  EXPECT_EQ(back.companion.supervisor().phase(), supervisor::Phase::kFlying);
}

// Who takes over a vehicle out there brings it back.
TEST(CompanionContainment, WhatNeverWasInsideHasNotLeft) {
  Loop loop;
  loop.airborne({10, 14, 2}).fly();
  EXPECT_EQ(loop.companion.supervisor().hazard(), "");
  loop.link.telemetry.motion.value.position = {10, 9, 2};
  loop.follows = false;
  loop.run(0.1);
  loop.link.telemetry.motion.value.position = {10, 14, 2};
  loop.run(0.1);
  EXPECT_EQ(loop.companion.supervisor().hazard(), "the vehicle has left the geofence");
}

// Wind that is stronger than the vehicle: less is asked for each time, and it is to no avail.
TEST(CompanionContainment, WhatCannotFollowEndsInHold) {
  config::Mission mission = Loop::mission();
  mission.geofence = {};
  Loop loop(mission);
  loop.airborne().fly();
  loop.follows = false;
  Vec3& position = loop.link.telemetry.motion.value.position;
  loop.link.telemetry.motion.value.velocity = {0, -4, 0};
  for (int i = 0; i < 1000 && !loop.companion.supervisor().done(); ++i) {
    position.y() -= 4.0 * Loop::kTurn;
    loop.planner.silent = false;
    loop.turn();
  }
  EXPECT_TRUE(loop.companion.supervisor().done());
  EXPECT_NE(loop.companion.supervisor().reason().find("the vehicle cannot follow its setpoints"), std::string::npos)
      << loop.companion.supervisor().reason();
  EXPECT_GE(loop.recorder.count("reference_lost"), 4);
}

}  // namespace
}  // namespace jink::bridge::companion
