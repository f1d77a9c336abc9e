// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "bridge/supervisor/dangers.hpp"

namespace jink::bridge::supervisor {
namespace {

config::Mission mission() {
  config::Mission m;
  m.geofence = {{-50, -50, 3}, {50, 50, 23}};
  m.ground = 3.0;
  return m;
}

TEST(Dangers, NothingIsKnownAgainstAutopilotsAsTheyComeOrThatTellNothing) {
  EXPECT_EQ(danger(mission(), {}), "");
  EXPECT_EQ(danger(mission(), {0.0, 2.0, 30.0}), "");
  EXPECT_EQ(danger(mission(), {5.0, 5.0, 60.0}), "");
}

TEST(Dangers, MotorsThatAreCutInTheAirAreToBeAccepted) {
  config::Mission m = mission();
  EXPECT_NE(danger(m, {6.0, {}, {}}).find("COM_OBL_RC_ACT 6"), std::string::npos);
  EXPECT_NE(danger(m, {7.0, {}, {}}).find("COM_OBL_RC_ACT 7"), std::string::npos);
  EXPECT_NE(danger(m, {0.0, 4.0, {}}).find("GF_ACTION 4"), std::string::npos);
  m.endings.motors_cut = true;
  EXPECT_EQ(danger(m, {6.0, 4.0, {}}), "");
}

// RTL_RETURN_ALT is above home, the fence in the local frame.
TEST(Dangers, AReturnIsToStayUnderTheFencesTop) {
  config::Mission m = mission();
  m.endings.breach = config::EndsIn::kReturn;
  EXPECT_EQ(danger(m, {0.0, {}, 20.0}), "");
  EXPECT_EQ(danger(m, {0.0, {}, {}}), "");  // not told: the flight says so
  const std::string why = danger(m, {0.0, {}, 20.5});
  EXPECT_NE(why.find("RETURN climbs to 20.50 m (RTL_RETURN_ALT), the geofence ends at 20.00 m"), std::string::npos)
      << why;
  m.geofence = {};
  EXPECT_EQ(danger(m, {0.0, {}, 100.0}), "");
  m = mission();
  m.endings.battery = config::EndsIn::kReturn;
  EXPECT_NE(danger(m, {0.0, {}, 30.0}), "");
  m.endings.return_above_fence = true;
  EXPECT_EQ(danger(m, {0.0, {}, 30.0}), "");
}

}  // namespace
}  // namespace jink::bridge::supervisor
