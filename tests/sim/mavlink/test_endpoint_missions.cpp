// SPDX-License-Identifier: BSD-3-Clause
// Missions from upload to flight, over loopback.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "sim/mavlink/mission_protocol.hpp"
#include "tests/sim/mavlink/endpoint_fixture.hpp"

namespace jink::sim::mavlink {
namespace {

ListItem place(std::uint16_t command, double north_m, float height, int frame = MAV_FRAME_GLOBAL_RELATIVE_ALT_INT) {
  ListItem item{};
  item.target_system = item.target_component = 1;
  item.command = command;
  item.frame = static_cast<std::uint8_t>(frame);
  item.x = 473977430 + static_cast<std::int32_t>(north_m * 89.93);
  item.y = 85455940;
  item.z = height;
  item.param4 = kNan;
  item.autocontinue = 1;
  return item;
}

class MissionEndpointTest : public MavlinkEndpointTest {
 protected:
  void upload(std::vector<ListItem> items) {
    mavlink_mission_count_t count{};
    count.target_system = count.target_component = 1;
    count.count = static_cast<std::uint16_t>(items.size());
    tell(mavlink_msg_mission_count_encode_status, count);
    poll();
    for (std::size_t i = 0; i < items.size(); ++i) {
      items[i].seq = static_cast<std::uint16_t>(i);
      tell(mavlink_msg_mission_item_int_encode_status, items[i]);
      poll();
    }
    EXPECT_EQ(mavlink_msg_mission_ack_get_type(&last(MAVLINK_MSG_ID_MISSION_ACK)), MAV_MISSION_ACCEPTED);
  }
  [[nodiscard]] mavlink_mission_current_t progress() const {
    mavlink_mission_current_t current;
    mavlink_msg_mission_current_decode(&last(MAVLINK_MSG_ID_MISSION_CURRENT), &current);
    return current;
  }
  /// The items that MISSION_ITEM_REACHED told of, each once.
  static std::vector<int> reached(const std::vector<mavlink_message_t>& messages) {
    std::vector<int> result;
    for (const auto& message : messages) {
      if (message.msgid != MAVLINK_MSG_ID_MISSION_ITEM_REACHED) continue;
      const int seq = mavlink_msg_mission_item_reached_get_seq(&message);
      if (result.empty() || result.back() != seq) result.push_back(seq);
    }
    return result;
  }
};

TEST_F(MissionEndpointTest, FliesWhatWasUploadedAndTellsItsProgressOnBothLinks) {
  run(1.1);
  EXPECT_EQ(progress().total, 65535);
  EXPECT_EQ(progress().mission_state, MISSION_STATE_NO_MISSION);
  ListItem speed{};
  speed.target_system = speed.target_component = 1;
  speed.frame = MAV_FRAME_MISSION;
  speed.command = MAV_CMD_DO_CHANGE_SPEED;
  speed.param2 = 3.0F;
  speed.autocontinue = 1;
  upload({place(MAV_CMD_NAV_TAKEOFF, 0, 4), speed, place(MAV_CMD_NAV_WAYPOINT, 10, 489.4F + 6.0F, MAV_FRAME_GLOBAL_INT),
          place(MAV_CMD_NAV_LAND, 10, 0)});
  run(1.1);
  EXPECT_EQ(progress().total, 4);
  EXPECT_EQ(progress().mission_state, MISSION_STATE_NOT_STARTED);
  heard.clear();
  heard_on_ground.clear();
  EXPECT_EQ(command(MAV_CMD_MISSION_START, {0, 0}), (Results{0}));
  EXPECT_EQ(autopilot.mode(), vehicle::FlightMode::kMission);
  run(8.0);
  EXPECT_EQ(progress().mission_state, MISSION_STATE_ACTIVE);
  EXPECT_EQ(progress().mission_mode, 1);
  EXPECT_EQ(mavlink_msg_extended_sys_state_get_landed_state(&last(MAVLINK_MSG_ID_EXTENDED_SYS_STATE)),
            MAV_LANDED_STATE_IN_AIR);
  run(45.0);
  EXPECT_FALSE(autopilot.armed());
  EXPECT_EQ(reached(heard), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(reached(heard_on_ground), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(progress().seq, 3);
  EXPECT_EQ(progress().mission_state, MISSION_STATE_COMPLETE);
  EXPECT_LT((autopilot.true_motion().position - Vec3(0, 10, 0)).norm(), 0.5);
}

TEST_F(MissionEndpointTest, StartsOnlyWhatIsThere) {
  EXPECT_EQ(command(MAV_CMD_MISSION_START), (Results{2}));
  upload({place(MAV_CMD_NAV_TAKEOFF, 0, 4)});
  EXPECT_EQ(command(MAV_CMD_MISSION_START, {1}), (Results{2}));
  EXPECT_EQ(command(MAV_CMD_MISSION_START, {kNan}), (Results{2}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MODE, {1, 4, 4}), (Results{0, 0}));
  EXPECT_EQ(command(MAV_CMD_COMPONENT_ARM_DISARM, {1}), (Results{0}));
  EXPECT_EQ(command(MAV_CMD_DO_SET_MISSION_CURRENT, {0}), (Results{3}));  // PX4 knows the message alone
}

TEST_F(MissionEndpointTest, MovesToAnotherItemAndSaysSoAtOnce) {
  upload({place(MAV_CMD_NAV_TAKEOFF, 0, 4), place(MAV_CMD_NAV_WAYPOINT, 10, 4)});
  heard.clear();
  heard_on_ground.clear();
  mavlink_mission_set_current_t set{};
  set.target_system = set.target_component = 1;
  set.seq = 1;
  tell(mavlink_msg_mission_set_current_encode_status, set);
  poll();
  EXPECT_EQ(progress().seq, 1);
  EXPECT_EQ(count(heard_on_ground, MAVLINK_MSG_ID_MISSION_CURRENT), 1U);
  EXPECT_EQ(autopilot.mission().current(), 1U);
}

/// The report of the arming checks, which else says that MISSION lacks one.
TEST_F(MissionEndpointTest, IsInTheReportOfTheArmingChecks) {
  constexpr std::uint32_t kSummary = 0x01A893E0;
  constexpr std::uint32_t kNoMission = 0x0105C2D9;
  constexpr std::size_t kModesByte = 9;  // after a byte and two words; then the modes to arm in
  constexpr unsigned kMissionBit = 1U << 3U;
  const auto look = [&](std::uint32_t id) {
    const mavlink_message_t* found = nullptr;
    for (const auto& message : heard) {
      if (message.msgid == MAVLINK_MSG_ID_EVENT && mavlink_msg_event_get_id(&message) == id) found = &message;
    }
    return found;
  };
  run(0.5);
  setpoint(kPositionOnly, {0, 0, -3}, Vec3::Zero());
  run(0.2);
  ASSERT_NE(look(kSummary), nullptr);
  EXPECT_NE(look(kNoMission), nullptr);
  heard.clear();
  upload({place(MAV_CMD_NAV_TAKEOFF, 0, 4)});
  run(0.2);
  ASSERT_NE(look(kSummary), nullptr);
  EXPECT_EQ(look(kNoMission), nullptr);
  mavlink_event_t summary;
  mavlink_msg_event_decode(look(kSummary), &summary);
  EXPECT_NE(summary.arguments[kModesByte] & kMissionBit, 0U);
}

TEST_F(MissionEndpointTest, SurviveAReboot) {
  upload({place(MAV_CMD_NAV_TAKEOFF, 0, 4)});
  EXPECT_EQ(command(MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, {1}), (Results{0}));
  run(2.0);
  EXPECT_EQ(progress().total, 1);
}

}  // namespace
}  // namespace jink::sim::mavlink
