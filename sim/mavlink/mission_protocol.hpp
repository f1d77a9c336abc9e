// SPDX-License-Identifier: BSD-3-Clause
// MAVLink's mission protocol as PX4 speaks it: lists of mission items, fence and rally points go up, come down and are
// cleared. One transfer at a time on a link, one upload at a time on all of them. Messages in, messages out: no socket,
// no clock, and what an item means in flight is not its business. https://mavlink.io/en/services/mission.html
#pragma once

#include <px4_events/mavlink.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace jink::sim::mavlink {

inline constexpr double kDegreesE7 = 1e7;  ///< of MAVLink's whole-numbered coordinates

/// As uploaded. Its frame is GLOBAL_INT, GLOBAL_RELATIVE_ALT_INT or MISSION; its place and height are finite.
using ListItem = mavlink_mission_item_int_t;

/// What the vehicle keeps, for all links together; and what became of it since the endpoint last looked.
struct MissionLists {
  std::array<std::vector<ListItem>, 3> items{};  ///< by MAV_MISSION_TYPE
  bool receiving = false;                        ///< on one of the links
  bool mission_replaced = false;
  std::optional<std::uint16_t> wanted_current{};  ///< item of the mission: asked for, or marked in the new mission
  std::vector<std::string> texts{};               ///< for the ground stations

  [[nodiscard]] const std::vector<ListItem>& mission() const { return items[MAV_MISSION_TYPE_MISSION]; }
};

using MissionMessage = std::variant<mavlink_mission_count_t, mavlink_mission_request_t, mavlink_mission_request_int_t,
                                    mavlink_mission_item_t, mavlink_mission_item_int_t, mavlink_mission_ack_t>;

/// Whether an item may be in a list of its type: MAV_MISSION_ACCEPTED, or why not. Complexity: constant.
[[nodiscard]] MAV_MISSION_RESULT check_item(const ListItem& item);

/// One link's side of it. Not thread-safe.
class MissionProtocol {
 public:
  /// `lists` outlives it.
  MissionProtocol(MissionLists& lists, std::uint8_t system_id) : lists_(&lists), system_id_(system_id) {}

  /// What to send after a message, none for one of another protocol or system. `current`: the mission's item that is
  /// flown. `now` in s, never less than before.
  [[nodiscard]] std::vector<MissionMessage> handle(const mavlink_message_t& message, int current, double now);
  /// What to send because time has passed: the last request again after 0.25 s. After 5 s of silence it gives up.
  [[nodiscard]] std::vector<MissionMessage> update(double now);
  /// As after a boot. The lists stay.
  void reset();

 private:
  enum class State { kIdle, kSending, kReceiving };
  struct Peer {
    std::uint8_t system = 0;
    std::uint8_t component = 0;
    bool operator==(const Peer&) const = default;
  };

  void handle_count(const mavlink_mission_count_t& count);
  void handle_item(const ListItem& item, MAV_MISSION_RESULT readable);
  void handle_request_list(const mavlink_mission_request_list_t& request);
  void handle_request(std::uint16_t seq, std::uint8_t type);
  void handle_ack(const mavlink_mission_ack_t& ack);
  void handle_set_current(std::uint16_t seq);
  void handle_clear(std::uint8_t type);

  [[nodiscard]] bool for_us(std::uint8_t system, std::uint8_t component) const;
  [[nodiscard]] const std::vector<ListItem>& list() const;
  void replace(std::uint8_t type, std::vector<ListItem> items, std::optional<std::uint16_t> marked = std::nullopt);
  void receive_first(const mavlink_mission_count_t& count);
  void finish();
  void request_next();
  void send_item(std::uint16_t seq);
  void acknowledge(MAV_MISSION_RESULT result, std::uint8_t type);
  void report(const char* text) { lists_->texts.emplace_back(text); }

  MissionLists* lists_;
  std::uint8_t system_id_;
  State state_ = State::kIdle;
  std::optional<Peer> peer_{};             ///< of the transfer, or of the last one
  std::uint8_t type_ = 0;                  ///< likewise, MAV_MISSION_TYPE
  std::uint16_t next_ = 0;                 ///< sequence number that is to be sent or received next
  std::uint16_t count_ = 0;                ///< of items on their way
  std::vector<ListItem> items_{};          ///< received
  std::optional<std::uint16_t> marked_{};  ///< of these, as current
  bool integers_ = false;  ///< the peer speaks MISSION_ITEM_INT: not known at first, and PX4 then thinks it does not
  double heard_ = 0.0;
  double sent_ = 0.0;

  // Of the message in hand.
  Peer sender_{};
  int current_ = 0;
  double now_ = 0.0;
  std::vector<MissionMessage> answers_{};
};

}  // namespace jink::sim::mavlink
