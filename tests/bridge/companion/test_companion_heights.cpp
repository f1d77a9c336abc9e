// SPDX-License-Identifier: BSD-3-Clause
// What the mission's heights are above.
#include <gtest/gtest.h>

#include <string>

#include "tests/bridge/companion/companion_loop.hpp"

namespace jink::bridge::companion {
namespace {

using testing::Loop;

constexpr double kGround = 3.0;

config::Mission mission(config::Heights heights, double waypoint) {
  config::Mission m = Loop::mission();
  m.heights = heights;
  m.waypoints = {{20, 0, waypoint}};
  return m;
}

// Begun where the vehicle stands at the height kGround of its local frame; flown until it plans.
struct FromAbove : Loop {
  explicit FromAbove(const config::Mission& m) : Loop(m) {
    link.telemetry.motion.value.position = {0, 0, kGround};
    link.telemetry.origin = frames::Geodetic{47.0, 8.0, 485.0};
  }
  [[nodiscard]] std::string refusal() {
    run(1.0);
    EXPECT_TRUE(link.sent.empty());
    EXPECT_TRUE(link.requests.empty());
    return companion.summary().reason;
  }
  [[nodiscard]] const planner::horizon::PathRequest& request() const { return planner.jobs.back().request; }
};

TEST(CompanionHeights, CountFromWhereTheVehicleStands) {
  FromAbove loop(mission(config::Heights::kGround, 1.5));
  loop.fly();
  EXPECT_EQ(loop.request().target, Vec3(20, 0, kGround + 1.5));
  EXPECT_GE(loop.request().volume.min.z(), kGround + 1.0);
  EXPECT_LE(loop.request().volume.max.z(), kGround + 12.0);
  EXPECT_GT(loop.request().volume.max.z(), 12.0);
  for (const vehicle::Setpoint& setpoint : loop.link.sent) EXPECT_GE(setpoint.position.z(), kGround);
  EXPECT_NE(loop.recorder.last("ground").find("3.00 m"), std::string::npos) << loop.recorder.last("ground");
  EXPECT_EQ(loop.recorder.count("raised"), 0);
}

TEST(CompanionHeights, AboveTheOriginAndTheSeaAsWell) {
  FromAbove origin(mission(config::Heights::kOrigin, 5.0));
  origin.fly();
  EXPECT_EQ(origin.request().target, Vec3(20, 0, 5));
  EXPECT_GE(origin.request().volume.min.z(), kGround + 1.0);
  config::Mission sea = mission(config::Heights::kSea, 490.0);
  sea.geofence.min.z() = 480.0;
  sea.geofence.max.z() = 500.0;
  FromAbove above_sea(sea);
  above_sea.fly();
  EXPECT_EQ(above_sea.request().target, Vec3(20, 0, 5));
  EXPECT_LE(above_sea.request().volume.max.z(), 15.0);
}

TEST(CompanionHeights, NothingBeginsWithoutTheSeasHeight) {
  FromAbove loop(mission(config::Heights::kSea, 490.0));
  loop.link.telemetry.origin.reset();
  loop.run(2.0);
  EXPECT_EQ(loop.companion.supervisor().phase(), supervisor::Phase::kWaiting);
  EXPECT_TRUE(loop.link.requests.empty());
}

TEST(CompanionHeights, AWaypointUnderTheGroundOrAboveTheFenceIsRefused) {
  EXPECT_EQ(FromAbove(mission(config::Heights::kOrigin, 1.5)).refusal(), "a waypoint is 1.5 m under the ground");
  config::Mission low = mission(config::Heights::kOrigin, 3.2);
  low.geofence.max.z() = 3.5;
  const std::string refusal = FromAbove(low).refusal();
  EXPECT_NE(refusal.find("above the geofence's top"), std::string::npos) << refusal;
}

TEST(CompanionHeights, InTheAirTheyCountFromHome) {
  FromAbove loop(mission(config::Heights::kGround, 1.5));
  loop.airborne({0, 0, 5});
  loop.link.telemetry.home_height = kGround;
  loop.fly();
  EXPECT_EQ(loop.request().target, Vec3(20, 0, kGround + 1.5));
}

TEST(CompanionHeights, WhereNoHomeIsToldThatIsSaid) {
  FromAbove loop(mission(config::Heights::kGround, 1.5));
  loop.airborne({0, 0, 5});
  loop.link.telemetry.home_height.reset();
  loop.fly();
  EXPECT_EQ(loop.request().target, Vec3(20, 0, 1.5));
  EXPECT_NE(loop.recorder.last("ground").find("not known"), std::string::npos);
}

TEST(CompanionHeights, TheGroundJumpsWithTheEstimate) {
  FromAbove loop(mission(config::Heights::kGround, 1.5));
  loop.fly();
  loop.link.telemetry.estimate_resets = 1;
  loop.link.telemetry.estimate_shift = {0, 0, -0.5};
  loop.link.telemetry.motion.value.position.z() -= 0.5;
  loop.run(0.5);
  EXPECT_EQ(loop.request().target, Vec3(20, 0, kGround + 1.0));
}

TEST(CompanionHeights, NothingBeginsOutsideTheFencesSides) {
  FromAbove loop(mission(config::Heights::kGround, 1.5));
  loop.link.telemetry.motion.value.position.x() = -6.0;
  EXPECT_NE(loop.refusal().find("outside the geofence, at east -6.0 m"), std::string::npos);
}

}  // namespace
}  // namespace jink::bridge::companion
