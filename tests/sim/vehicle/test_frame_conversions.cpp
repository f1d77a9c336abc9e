// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "sim/vehicle/frame_conversions.hpp"
#include "sim/vehicle/vehicle_model.hpp"

namespace jink::sim::vehicle {
namespace {

TEST(LocalFrame, IsItsOwnInverse) {
  const LocalFrame frame(kSitlOrigin);
  const Vec3 position(120.0, -340.0, 25.0);
  EXPECT_LT((frame.to_enu(frame.to_geodetic(position)) - position).norm(), 1e-6);
  EXPECT_LT(frame.to_enu(kSitlOrigin).norm(), 1e-6);
  EXPECT_EQ(swap_enu_ned(Vec3(1, 2, 3)), Vec3(2, 1, -3));
  EXPECT_NEAR(swap_yaw(0.0), 1.5707963267948966, 1e-15);
}

TEST(LocalFrame, TurnsAttitudesIntoNedAndFrd) {
  // Heading east in ENU is yaw 0 there and 90 deg in NED; level stays level.
  const RollPitchYaw east = roll_pitch_yaw(attitude_ned(attitude_along(Vec3(0, 0, 9.8), 0.0)));
  EXPECT_NEAR(east.yaw, 1.5707963267948966, 1e-12);
  EXPECT_NEAR(east.roll, 0.0, 1e-12);
  EXPECT_NEAR(east.pitch, 0.0, 1e-12);
  // Heading north with the thrust leaning north: nose down.
  const RollPitchYaw north = roll_pitch_yaw(attitude_ned(attitude_along(Vec3(0, 1, 1), 1.5707963267948966)));
  EXPECT_NEAR(north.pitch, -0.7853981633974483, 1e-12);
  EXPECT_NEAR(north.yaw, 0.0, 1e-12);
}

}  // namespace
}  // namespace jink::sim::vehicle
