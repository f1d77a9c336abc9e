// SPDX-License-Identifier: BSD-3-Clause
// The mission protocol alone: messages in, messages out.
#include "sim/mavlink/mission_protocol.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace jink::sim::mavlink {
namespace {

constexpr std::uint8_t kSystem = 1;
using Results = std::vector<int>;

ListItem waypoint(int seq, int type = MAV_MISSION_TYPE_MISSION) {
  ListItem item{};
  item.seq = static_cast<std::uint16_t>(seq);
  item.frame = MAV_FRAME_GLOBAL_RELATIVE_ALT_INT;
  item.command = MAV_CMD_NAV_WAYPOINT;
  item.x = 473977430 + seq;
  item.y = 85455940;
  item.z = 10.0F;
  item.param4 = std::numeric_limits<float>::quiet_NaN();
  item.autocontinue = 1;
  item.mission_type = static_cast<std::uint8_t>(type);
  return item;
}

/// The message as it comes from the wire: its trailing zeros are cut there and put back.
template <typename Payload>
mavlink_message_t received(std::uint16_t (*encode)(std::uint8_t, std::uint8_t, mavlink_status_t*, mavlink_message_t*,
                                                   const Payload*),
                           std::uint8_t system, const Payload& payload) {
  mavlink_status_t transmit{};
  mavlink_message_t message{};
  encode(system, 190, &transmit, &message, &payload);
  std::array<std::uint8_t, MAVLINK_MAX_PACKET_LEN> frame{};
  const std::size_t length = mavlink_msg_to_send_buffer(frame.data(), &message);
  mavlink_message_t partial{};
  mavlink_status_t parser{};
  mavlink_status_t status{};
  for (std::size_t i = 0; i < length; ++i) {
    mavlink_frame_char_buffer(&partial, &parser, frame[i], &message, &status);
  }
  return message;
}

/// A ground station and the vehicle's side of its link.
class Station {
 public:
  explicit Station(MissionLists& lists, std::uint8_t system = 255) : protocol(lists, kSystem), system_(system) {}

  template <typename Payload>
  const std::vector<MissionMessage>& tell(std::uint16_t (*encode)(std::uint8_t, std::uint8_t, mavlink_status_t*,
                                                                  mavlink_message_t*, const Payload*),
                                          Payload payload, std::uint8_t as = 0) {
    payload.target_system = kSystem;
    payload.target_component = 1;
    return heard = protocol.handle(received(encode, as == 0 ? system_ : as, payload), current, now);
  }

  const std::vector<MissionMessage>& count(int number, int type = MAV_MISSION_TYPE_MISSION, std::uint8_t as = 0) {
    mavlink_mission_count_t message{};
    message.count = static_cast<std::uint16_t>(number);
    message.mission_type = static_cast<std::uint8_t>(type);
    return tell(mavlink_msg_mission_count_encode_status, message, as);
  }
  const std::vector<MissionMessage>& item(const ListItem& item, std::uint8_t as = 0) {
    return tell(mavlink_msg_mission_item_int_encode_status, item, as);
  }
  const std::vector<MissionMessage>& ask_for_list(int type = MAV_MISSION_TYPE_MISSION) {
    mavlink_mission_request_list_t message{};
    message.mission_type = static_cast<std::uint8_t>(type);
    return tell(mavlink_msg_mission_request_list_encode_status, message);
  }
  const std::vector<MissionMessage>& ask_for(int seq, int type = MAV_MISSION_TYPE_MISSION) {
    mavlink_mission_request_int_t message{};
    message.seq = static_cast<std::uint16_t>(seq);
    message.mission_type = static_cast<std::uint8_t>(type);
    return tell(mavlink_msg_mission_request_int_encode_status, message);
  }
  const std::vector<MissionMessage>& acknowledge(int result, int type = MAV_MISSION_TYPE_MISSION) {
    mavlink_mission_ack_t message{};
    message.type = static_cast<std::uint8_t>(result);
    message.mission_type = static_cast<std::uint8_t>(type);
    return tell(mavlink_msg_mission_ack_encode_status, message);
  }
  /// The result that a list's upload ends with.
  Results upload(const std::vector<ListItem>& items) {
    count(static_cast<int>(items.size()), items.front().mission_type);
    for (const ListItem& each : items) item(each);
    return acks();
  }

  [[nodiscard]] Results acks() const {
    Results results;
    for (const MissionMessage& message : heard) {
      if (const auto* ack = std::get_if<mavlink_mission_ack_t>(&message)) results.push_back(ack->type);
    }
    return results;
  }
  /// The item that is asked for; −1: none.
  [[nodiscard]] int requested() const {
    if (heard.empty()) return -1;
    if (const auto* request = std::get_if<mavlink_mission_request_int_t>(&heard.front())) return request->seq;
    const auto* request = std::get_if<mavlink_mission_request_t>(&heard.front());
    return request != nullptr ? request->seq : -1;
  }
  [[nodiscard]] const ListItem& item_heard() const { return std::get<ListItem>(heard.at(0)); }
  [[nodiscard]] int counted() const { return std::get<mavlink_mission_count_t>(heard.at(0)).count; }

  MissionProtocol protocol;
  std::vector<MissionMessage> heard;
  int current = 0;
  double now = 0.0;

 private:
  std::uint8_t system_;
};

class Missions : public testing::Test {
 protected:
  MissionLists lists;
  Station station{lists};
};

TEST_F(Missions, GoUpItemByItem) {
  station.count(3);
  for (int seq = 0; seq < 3; ++seq) {
    EXPECT_EQ(station.requested(), seq);
    EXPECT_FALSE(lists.mission_replaced);
    station.item(waypoint(seq));
  }
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_TRUE(lists.mission_replaced);
  EXPECT_EQ(lists.mission().size(), 3U);
  EXPECT_EQ(lists.mission()[2].x, 473977432);
  // The acknowledgement may get lost.
  station.item(waypoint(2));
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ACCEPTED}));
}

TEST_F(Missions, ComeDownAsTheyWentUp) {
  ASSERT_EQ(station.upload({waypoint(0), waypoint(1)}), (Results{MAV_MISSION_ACCEPTED}));
  station.current = 1;
  station.ask_for_list();
  EXPECT_EQ(station.counted(), 2);
  station.ask_for(0);
  station.ask_for(0);  // again: it got lost
  EXPECT_EQ(station.item_heard().seq, 0);
  EXPECT_EQ(station.item_heard().current, 0);
  station.ask_for(1);
  EXPECT_EQ(station.item_heard().current, 1);
  EXPECT_EQ(station.item_heard().frame, MAV_FRAME_GLOBAL_RELATIVE_ALT_INT);
  EXPECT_EQ(station.item_heard().z, 10.0F);
  EXPECT_TRUE(std::isnan(station.item_heard().param4));
  EXPECT_EQ(station.item_heard().target_system, 255);
  EXPECT_TRUE(station.acknowledge(MAV_MISSION_ACCEPTED).empty());
  EXPECT_TRUE(station.ask_for(0).empty());  // the transfer is over
}

TEST_F(Missions, OfThreeTypesAreKeptApart) {
  ListItem fence = waypoint(0, MAV_MISSION_TYPE_FENCE);
  fence.command = MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION;
  ListItem rally = waypoint(0, MAV_MISSION_TYPE_RALLY);
  rally.command = MAV_CMD_NAV_RALLY_POINT;
  EXPECT_EQ(station.upload({fence}), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_EQ(station.upload({rally}), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_FALSE(lists.mission_replaced);
  EXPECT_EQ(station.upload({waypoint(0), waypoint(1)}), (Results{MAV_MISSION_ACCEPTED}));
  station.ask_for_list(MAV_MISSION_TYPE_FENCE);
  EXPECT_EQ(station.counted(), 1);
  station.acknowledge(MAV_MISSION_ACCEPTED, MAV_MISSION_TYPE_FENCE);
  mavlink_mission_clear_all_t clear{};
  clear.mission_type = MAV_MISSION_TYPE_FENCE;
  station.tell(mavlink_msg_mission_clear_all_encode_status, clear);
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_TRUE(lists.items[MAV_MISSION_TYPE_FENCE].empty());
  EXPECT_EQ(lists.mission().size(), 2U);
  clear.mission_type = MAV_MISSION_TYPE_ALL;
  station.tell(mavlink_msg_mission_clear_all_encode_status, clear);
  EXPECT_TRUE(lists.mission().empty() && lists.items[MAV_MISSION_TYPE_RALLY].empty());
}

TEST_F(Missions, AreClearedByACountOfNone) {
  ASSERT_EQ(station.upload({waypoint(0)}), (Results{MAV_MISSION_ACCEPTED}));
  lists.mission_replaced = false;
  station.count(0);
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_TRUE(lists.mission().empty());
  EXPECT_TRUE(lists.mission_replaced);
}

TEST_F(Missions, AskAgainForWhatDoesNotComeAndGiveUpInTheEnd) {
  station.count(2);
  station.item(waypoint(0));
  station.now = 0.2;
  EXPECT_TRUE(station.protocol.update(station.now).empty());
  station.now = 0.3;
  station.heard = station.protocol.update(station.now);
  EXPECT_EQ(station.requested(), 1);
  station.now = 5.1;
  EXPECT_TRUE(station.protocol.update(station.now).empty());
  EXPECT_EQ(lists.texts, std::vector<std::string>{"Operation timeout"});
  station.item(waypoint(1));
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ERROR}));
  EXPECT_TRUE(lists.mission().empty());
  EXPECT_EQ(station.upload({waypoint(0)}), (Results{MAV_MISSION_ACCEPTED}));
}

TEST_F(Missions, IgnoreItemsOutOfSequence) {
  station.count(3);
  EXPECT_TRUE(station.item(waypoint(1)).empty());
  station.item(waypoint(0));
  EXPECT_EQ(station.requested(), 1);
  EXPECT_TRUE(station.item(waypoint(0)).empty());
  station.count(3);  // not in the middle
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ERROR}));
}

TEST_F(Missions, EndADownloadThatAsksOutOfSequence) {
  ASSERT_EQ(station.upload({waypoint(0), waypoint(1), waypoint(2)}), (Results{MAV_MISSION_ACCEPTED}));
  station.ask_for_list();
  station.ask_for(2);
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ERROR}));
  EXPECT_TRUE(station.ask_for(0).empty());
}

TEST_F(Missions, OfOneLinkAreNotDisturbedByOthers) {
  Station other(lists, 254);
  station.count(2);
  other.count(1);  // on another link
  EXPECT_EQ(other.acks(), (Results{MAV_MISSION_ERROR}));
  station.count(1, MAV_MISSION_TYPE_MISSION, 77);  // on the same
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ERROR}));
  EXPECT_TRUE(station.item(waypoint(0), 77).empty());
  station.item(waypoint(0));
  station.item(waypoint(1));
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_EQ(other.upload({waypoint(0)}), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_EQ(lists.mission().size(), 1U);
}

TEST_F(Missions, AreFreeAgainAfterAReboot) {
  Station other(lists, 254);
  station.count(2);
  station.protocol.reset();
  EXPECT_EQ(other.upload({waypoint(0)}), (Results{MAV_MISSION_ACCEPTED}));
}

TEST_F(Missions, CanBeCancelled) {
  station.count(2);
  EXPECT_TRUE(station.acknowledge(MAV_MISSION_OPERATION_CANCELLED).empty());
  EXPECT_FALSE(lists.receiving);
  EXPECT_TRUE(station.protocol.update(0.3).empty());
}

TEST_F(Missions, WithMoreItemsThanThereIsRoomForAreRefused) {
  EXPECT_EQ((station.count(10001), station.acks()), (Results{MAV_MISSION_NO_SPACE}));
  EXPECT_EQ((station.count(65, MAV_MISSION_TYPE_FENCE), station.acks()), (Results{MAV_MISSION_NO_SPACE}));
  EXPECT_EQ((station.count(33, MAV_MISSION_TYPE_RALLY), station.acks()), (Results{MAV_MISSION_NO_SPACE}));
  EXPECT_EQ((station.count(1, 99), station.acks()), (Results{MAV_MISSION_NO_SPACE}));
  station.count(10000);
  EXPECT_EQ(station.requested(), 0);
}

TEST_F(Missions, RefuseWhatTheVehicleCannotFly) {
  const auto refused = [&](auto change) {
    ListItem item = waypoint(0);
    change(item);
    return station.upload({item});
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(refused([](auto& i) { i.frame = MAV_FRAME_LOCAL_NED; }), (Results{MAV_MISSION_UNSUPPORTED_FRAME}));
  EXPECT_EQ(refused([](auto& i) { i.command = MAV_CMD_NAV_VTOL_TAKEOFF; }), (Results{MAV_MISSION_UNSUPPORTED}));
  EXPECT_EQ(refused([](auto& i) { i.frame = MAV_FRAME_MISSION; }), (Results{MAV_MISSION_UNSUPPORTED}));
  EXPECT_EQ(refused([](auto& i) { i.command = MAV_CMD_NAV_RALLY_POINT; }), (Results{MAV_MISSION_ERROR}));
  EXPECT_EQ(refused([](auto& i) { i.x = 900000001; }), (Results{MAV_MISSION_INVALID_PARAM5_X}));
  EXPECT_EQ(refused([](auto& i) { i.y = 0x7FFFFFFF; }), (Results{MAV_MISSION_INVALID_PARAM6_Y}));
  EXPECT_EQ(refused([&](auto& i) { i.z = nan; }), (Results{MAV_MISSION_INVALID_PARAM7}));
  EXPECT_EQ(refused([](auto& i) { i.mission_type = MAV_MISSION_TYPE_FENCE; }), (Results{MAV_MISSION_ERROR}));
  ListItem corner = waypoint(0, MAV_MISSION_TYPE_FENCE);
  corner.command = MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION;
  corner.param1 = 2;  // vertices
  EXPECT_EQ(station.upload({corner}), (Results{MAV_MISSION_ERROR}));
  EXPECT_FALSE(lists.mission_replaced);
  EXPECT_FALSE(lists.receiving);
}

TEST_F(Missions, OfFloatsAreUnderstood) {
  station.count(1);
  mavlink_mission_item_t old{};
  old.frame = MAV_FRAME_GLOBAL_RELATIVE_ALT;
  old.command = MAV_CMD_NAV_WAYPOINT;
  old.x = 47.5F;
  old.y = 8.5F;
  old.z = 12.0F;
  station.tell(mavlink_msg_mission_item_encode_status, old);
  EXPECT_EQ(station.acks(), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_EQ(lists.mission()[0].x, 475000000);
  station.ask_for_list();
  station.tell(mavlink_msg_mission_request_encode_status, mavlink_mission_request_t{});
  const auto& back = std::get<mavlink_mission_item_t>(station.heard.at(0));
  EXPECT_EQ(back.x, 47.5F);
  EXPECT_EQ(back.frame, MAV_FRAME_GLOBAL_RELATIVE_ALT);
  station.acknowledge(MAV_MISSION_ACCEPTED);
  // It spoke floats last, and is asked for them; one who knows integers alone says so.
  station.count(1);
  EXPECT_TRUE(std::holds_alternative<mavlink_mission_request_t>(station.heard.at(0)));
  station.acknowledge(MAV_MISSION_UNSUPPORTED);
  EXPECT_TRUE(std::holds_alternative<mavlink_mission_request_int_t>(station.heard.at(0)));
}

TEST_F(Missions, StartAtTheMarkedItemAndMoveOnRequest) {
  ListItem second = waypoint(1);
  second.current = 1;
  station.upload({waypoint(0), second});
  EXPECT_EQ(lists.wanted_current, 1);
  lists.wanted_current.reset();
  mavlink_mission_set_current_t set{};
  station.tell(mavlink_msg_mission_set_current_encode_status, set);
  EXPECT_EQ(lists.wanted_current, 0);
  set.seq = 2;
  lists.wanted_current.reset();
  station.tell(mavlink_msg_mission_set_current_encode_status, set);
  EXPECT_FALSE(lists.wanted_current);
  EXPECT_EQ(lists.texts.back(), "WPM: WP CURR CMD: Not in list");
}

TEST_F(Missions, ThatAreTheSameAgainChangeNothing) {
  station.upload({waypoint(0), waypoint(1)});
  lists.mission_replaced = false;
  EXPECT_EQ(station.upload({waypoint(0), waypoint(1)}), (Results{MAV_MISSION_ACCEPTED}));
  EXPECT_FALSE(lists.mission_replaced);
}

TEST_F(Missions, OfOtherSystemsAreNotOurs) {
  mavlink_mission_count_t count{};
  count.target_system = 2;
  count.target_component = 1;
  count.count = 1;
  const mavlink_message_t message = received(mavlink_msg_mission_count_encode_status, 255, count);
  EXPECT_TRUE(station.protocol.handle(message, 0, 0.0).empty());
}

}  // namespace
}  // namespace jink::sim::mavlink
