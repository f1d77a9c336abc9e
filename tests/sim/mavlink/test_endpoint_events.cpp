// SPDX-License-Identifier: BSD-3-Clause
// Events: what each of them says is held against the recordings in test_px4_recordings.cpp; here, when there is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/sim/mavlink/endpoint_fixture.hpp"

namespace jink::sim::mavlink {
namespace {

constexpr std::uint32_t kArmingRefused = 0x0102089D;
constexpr std::uint32_t kArmed = 0x0190CAF3;
constexpr std::uint32_t kDisarmed = 0x01F46777;
constexpr std::uint32_t kFailsafe = 0x01DEDBD0;
constexpr std::uint32_t kModes = 0x01A893E0;       ///< the first of a report of the arming checks
constexpr std::uint32_t kComponents = 0x011D3727;  ///< the last
constexpr std::uint32_t kNoGroundStation = 0x0167C97B;
constexpr std::uint32_t kNoStream = 0x012F1DC7;

std::vector<mavlink_event_t> events(const std::vector<mavlink_message_t>& messages) {
  std::vector<mavlink_event_t> all;
  for (const auto& message : messages) {
    if (message.msgid == MAVLINK_MSG_ID_EVENT) mavlink_msg_event_decode(&message, &all.emplace_back());
  }
  return all;
}

std::vector<std::uint32_t> ids(const std::vector<mavlink_message_t>& messages) {
  std::vector<std::uint32_t> all;
  for (const auto& event : events(messages)) all.push_back(event.id);
  return all;
}

class EventsTest : public MavlinkEndpointTest {
 protected:
  using MavlinkEndpointTest::MavlinkEndpointTest;
  /// Streams a place in the air for `duration`.
  void stream(double duration) {
    const double end = autopilot.time() + duration;
    while (autopilot.time() < end) {
      setpoint(kPositionOnly, {1, 2, -3}, Vec3::Zero());
      run(0.02);
    }
  }
  [[nodiscard]] bool told(std::uint32_t id) const {
    const auto all = ids(heard);
    return std::find(all.begin(), all.end(), id) != all.end();
  }
};

class AirborneEventsTest : public EventsTest {
 protected:
  AirborneEventsTest() : EventsTest(true) {}
};

TEST_F(EventsTest, GoToBothLinksWithoutAGroundStationAndAreNumbered) {
  run(1.0);
  const auto& before = last(MAVLINK_MSG_ID_CURRENT_EVENT_SEQUENCE);
  EXPECT_EQ(mavlink_msg_current_event_sequence_get_sequence(&before), 0);
  EXPECT_EQ(mavlink_msg_current_event_sequence_get_flags(&before), 1);
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  run(0.1);
  const auto armed = events(heard);
  ASSERT_EQ(ids(heard), (std::vector{kArmed}));
  EXPECT_EQ(armed[0].sequence, 1);
  EXPECT_EQ(armed[0].log_levels, 0x66);
  EXPECT_EQ(armed[0].arguments[0], 4);
  EXPECT_NEAR(armed[0].event_time_boot_ms, 1000, 5);
  EXPECT_EQ(ids(heard_on_ground), ids(heard));
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {0}), (Results{0}));
  run(3.0);
  ASSERT_EQ(ids(heard), (std::vector{kDisarmed}));
  EXPECT_EQ(events(heard)[0].sequence, 2);
  const auto& after = last(MAVLINK_MSG_ID_CURRENT_EVENT_SEQUENCE);
  EXPECT_EQ(mavlink_msg_current_event_sequence_get_sequence(&after), 2);
  EXPECT_EQ(mavlink_msg_current_event_sequence_get_flags(&after), 0);
}

TEST_F(EventsTest, ARefusalIsOne) {
  ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{1}));
  run(0.1);
  EXPECT_EQ(ids(heard), (std::vector{kArmingRefused}));
}

TEST_F(EventsTest, TheChecksAreReportedWhenTheStreamBeginsAndEnds) {
  run(0.1);
  stream(0.5);
  ASSERT_EQ(ids(heard).size(), 5U);
  EXPECT_EQ(ids(heard).front(), kModes);
  EXPECT_EQ(ids(heard).back(), kComponents);
  EXPECT_TRUE(told(kNoGroundStation));
  EXPECT_FALSE(told(kNoStream));
  EXPECT_EQ(events(heard)[0].arguments[10] & 0x40, 0x40);  // OFFBOARD among the modes that it can be armed in
  stream(1.0);
  EXPECT_EQ(ids(heard).size(), 5U);  // nothing new to say
  heard.clear();
  run(1.5);
  ASSERT_EQ(ids(heard).size(), 6U);
  EXPECT_TRUE(told(kNoStream));
  EXPECT_EQ(events(heard)[0].arguments[10] & 0x40, 0);
}

TEST_F(EventsTest, WithAGroundStationItsAbsenceIsNotReported) {
  ground_station_heartbeat();
  stream(0.2);
  EXPECT_EQ(ids(heard).size(), 4U);
  EXPECT_FALSE(told(kNoGroundStation));
  EXPECT_EQ(events(heard).back().arguments[2] & 0x10, 0x10);
}

TEST_F(AirborneEventsTest, AReportThatTheRecordingsDoNotHaveIsNotMadeUp) {
  autopilot.set_gps(false);
  run(6.0);
  ASSERT_FALSE(autopilot.position_valid());
  stream(0.5);
  EXPECT_FALSE(told(kModes));
  autopilot.set_gps(true);
  stream(0.5);
  EXPECT_TRUE(told(kModes));  // it can be told again
}

TEST_F(AirborneEventsTest, AFailsafeSaysForWhichModeAndWhatItDoes) {
  struct Row {
    int com_obl_rc_act;
    int action;  ///< 0: in no recording, hence not told
  };
  for (const Row& row : {Row{0, 2}, Row{5, 5}, Row{4, 0}, Row{3, 0}}) {
    SCOPED_TRACE(row.com_obl_rc_act);
    ASSERT_TRUE(autopilot.parameters().set("COM_OBL_RC_ACT", std::int32_t{row.com_obl_rc_act}));
    stream(0.5);
    ASSERT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 6}), (Results{0, 0}));
    stream(0.5);
    heard.clear();
    run(1.2);
    ASSERT_TRUE(autopilot.in_failsafe());
    EXPECT_EQ(told(kFailsafe), row.action != 0);
    for (const auto& event : events(heard)) {
      if (event.id != kFailsafe) continue;
      EXPECT_EQ(event.arguments[2], 0x06);  // OFFBOARD, 0x00060000
      EXPECT_EQ(event.arguments[4], row.action);
    }
  }
}

TEST_F(EventsTest, AnUnknownReasonIsNotTold) {
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  heard.clear();
  run(11.0);  // auto-disarm before take-off
  ASSERT_FALSE(autopilot.armed());
  EXPECT_EQ(ids(heard), std::vector<std::uint32_t>{});
}

TEST_F(EventsTest, CountAnewAfterAReboot) {
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {0}), (Results{0}));
  ASSERT_EQ(command(MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, {1}), (Results{0}));
  heard.clear();
  run(3.1);
  EXPECT_EQ(mavlink_msg_current_event_sequence_get_flags(&last(MAVLINK_MSG_ID_CURRENT_EVENT_SEQUENCE)), 1);
  ASSERT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  run(0.1);
  ASSERT_EQ(ids(heard), (std::vector{kArmed}));
  EXPECT_EQ(events(heard)[0].sequence, 1);
}

}  // namespace
}  // namespace jink::sim::mavlink
