// SPDX-License-Identifier: BSD-3-Clause
// Plays the companion's half of two recorded flights of PX4's SITL into the simulator's endpoint, in virtual time, and
// compares what the simulator answers with what PX4 answered. tests/sim/mavlink/data: tlogs of pymavlink, both
// directions.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/mavlink/endpoint.hpp"
#include "tests/sim/mavlink/mavlink_client.hpp"

namespace jink::sim::mavlink {
namespace {

struct Packet {
  double t = 0.0;  ///< s since the first one
  std::vector<std::uint8_t> frame;
  mavlink_message_t message{};
};

/// Each packet of a tlog: 8 bytes of big-endian unix microseconds, then a MAVLink 2 frame.
std::vector<Packet> read_tlog(const std::string& name) {
  constexpr std::size_t kStampSize = 8;
  constexpr std::size_t kFrameOverhead = 12;  // without a signature
  std::ifstream file(JINK_SOURCE_DIR "/tests/sim/mavlink/data/" + name, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::vector<Packet> packets;
  std::uint64_t first = 0;
  mavlink_status_t parser{};
  mavlink_message_t partial{};
  for (std::size_t at = 0; at + kStampSize + kFrameOverhead <= bytes.size();) {
    std::uint64_t stamp = 0;
    for (std::size_t i = 0; i < kStampSize; ++i) stamp = stamp << 8U | static_cast<std::uint8_t>(bytes[at + i]);
    if (packets.empty()) first = stamp;
    at += kStampSize;
    const std::size_t length = static_cast<std::uint8_t>(bytes[at + 1]) + kFrameOverhead;
    if (at + length > bytes.size()) throw std::runtime_error(name + " ends within a packet");
    Packet packet;
    packet.t = static_cast<double>(stamp - first) * 1e-6;
    for (std::size_t i = 0; i < length; ++i) {
      const auto byte = static_cast<std::uint8_t>(bytes[at + i]);
      packet.frame.push_back(byte);
      mavlink_status_t status;
      mavlink_frame_char_buffer(&partial, &parser, byte, &packet.message, &status);
    }
    packets.push_back(std::move(packet));
    at += length;
  }
  if (packets.empty()) throw std::runtime_error("no packets in " + name);
  return packets;
}

bool from_autopilot(const mavlink_message_t& message) {
  return message.sysid == 1 && message.compid == MAV_COMP_ID_AUTOPILOT1;
}

template <typename Value>
struct Timed {
  double t = 0.0;
  Value value{};
};

/// An event of PX4's events interface.
struct Event {
  std::uint32_t id = 0;
  int log_levels = 0;
  std::vector<std::uint8_t> arguments;
  bool operator==(const Event&) const = default;
};

/// What a companion can see of a flight.
struct Story {
  std::vector<Timed<std::pair<int, int>>> acks;       ///< command and result, in order
  std::vector<Timed<vehicle::Heartbeat>> heartbeats;  ///< at each change
  std::vector<Timed<int>> landed_states;              ///< at each change
  std::vector<Timed<std::string>> texts;
  std::vector<Timed<Event>> events;
  std::vector<double> event_sequences;         ///< when the newest sequence number was told
  std::optional<std::uint16_t> last_sequence;  ///< of an event or told, whichever was later
  std::vector<Timed<Vec3>> positions_ned;
};

bool same(const vehicle::Heartbeat& a, const vehicle::Heartbeat& b) {
  return a.base_mode == b.base_mode && a.custom_mode == b.custom_mode && a.system_status == b.system_status;
}

/// Its sequence number is one more than the last; the simulator keeps no log on board, whose event is left out.
void add_event(Story& story, double t, const mavlink_message_t& message) {
  constexpr std::uint32_t kLogStarted = 0x01125BEF;
  mavlink_event_t event;
  mavlink_msg_event_decode(&message, &event);
  if (story.last_sequence) {
    EXPECT_EQ(event.sequence, static_cast<std::uint16_t>(*story.last_sequence + 1)) << t;
  }
  story.last_sequence = event.sequence;
  EXPECT_EQ(event.destination_system, 0);
  EXPECT_EQ(event.destination_component, 0);
  if (event.id == kLogStarted) return;
  story.events.push_back({t, {event.id, event.log_levels, {std::begin(event.arguments), std::end(event.arguments)}}});
}

void add_event_sequence(Story& story, double t, const mavlink_message_t& message) {
  const std::uint16_t sequence = mavlink_msg_current_event_sequence_get_sequence(&message);
  if (story.last_sequence) {
    EXPECT_EQ(sequence, *story.last_sequence) << t;
  }
  story.last_sequence = sequence;
  story.event_sequences.push_back(t);
}

void add(Story& story, double t, const mavlink_message_t& message) {
  switch (message.msgid) {
    case MAVLINK_MSG_ID_COMMAND_ACK:
      story.acks.push_back(
          {t, {mavlink_msg_command_ack_get_command(&message), mavlink_msg_command_ack_get_result(&message)}});
      break;
    case MAVLINK_MSG_ID_HEARTBEAT: {
      const vehicle::Heartbeat heartbeat{mavlink_msg_heartbeat_get_base_mode(&message),
                                         mavlink_msg_heartbeat_get_custom_mode(&message),
                                         mavlink_msg_heartbeat_get_system_status(&message)};
      if (story.heartbeats.empty() || !same(story.heartbeats.back().value, heartbeat)) {
        story.heartbeats.push_back({t, heartbeat});
      }
      break;
    }
    case MAVLINK_MSG_ID_EXTENDED_SYS_STATE: {
      const int state = mavlink_msg_extended_sys_state_get_landed_state(&message);
      if (story.landed_states.empty() || story.landed_states.back().value != state) {
        story.landed_states.push_back({t, state});
      }
      break;
    }
    case MAVLINK_MSG_ID_STATUSTEXT: {
      mavlink_statustext_t text;
      mavlink_msg_statustext_decode(&message, &text);
      const std::string chunk(text.text, strnlen(text.text, sizeof(text.text)));
      if (text.chunk_seq > 0) {
        story.texts.back().value += chunk;
      } else if (chunk.find("[logger]") == std::string::npos) {  // the simulator keeps no log on board
        story.texts.push_back({t, chunk});
      }
      break;
    }
    case MAVLINK_MSG_ID_EVENT:
      add_event(story, t, message);
      break;
    case MAVLINK_MSG_ID_CURRENT_EVENT_SEQUENCE:
      add_event_sequence(story, t, message);
      break;
    case MAVLINK_MSG_ID_LOCAL_POSITION_NED: {
      mavlink_local_position_ned_t p;
      mavlink_msg_local_position_ned_decode(&message, &p);
      story.positions_ned.push_back(
          {t, Vec3(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z))});
      break;
    }
    default:
      break;
  }
}

Story told_by_px4(const std::vector<Packet>& recording) {
  Story story;
  for (const Packet& packet : recording) {
    if (from_autopilot(packet.message)) add(story, packet.t, packet.message);
  }
  return story;
}

/// The simulator's answers to the other half, each packet of it sent at its time.
Story told_by_simulator(const std::vector<Packet>& recording, std::int32_t com_obl_rc_act) {
  vehicle::AutopilotOptions options;
  options.limits.max_speed = 12.0;  // PX4's own
  options.limits.max_acceleration = 9.5;
  options.limits.max_climb = 3.0;
  options.ready_delay = 0.0;  // the recordings begin with a vehicle that has started up
  vehicle::Autopilot autopilot(options);
  EXPECT_TRUE(autopilot.parameters().set("COM_OBL_RC_ACT", com_obl_rc_act));
  Client companion;
  EndpointOptions endpoint_options;
  endpoint_options.ground_link = false;
  endpoint_options.companion_local_port = 0;
  endpoint_options.companion_remote_port = companion.port();
  MavlinkEndpoint endpoint(autopilot, endpoint_options);

  Story story;
  std::size_t next = 0;
  while (autopilot.time() < recording.back().t) {
    for (; next < recording.size() && recording[next].t <= autopilot.time(); ++next) {
      if (!from_autopilot(recording[next].message)) {
        companion.send_raw(endpoint.companion_port(), recording[next].frame);
      }
    }
    autopilot.step();
    endpoint.poll(autopilot.time());
    for (const auto& message : companion.drain()) add(story, autopilot.time(), message);
  }
  return story;
}

// How far apart the two may be, in s. PX4 answers within 15 ms, the simulator at its next step.
constexpr double kAckTolerance = 0.03;
constexpr double kHeartbeatTolerance = 1.1;    // each has its own phase of 1 Hz
constexpr double kLandedStateTolerance = 0.5;  // 5 Hz, and a landing whose height wanders
constexpr double kTextTolerance = 0.5;
constexpr double kEventTolerance =
    0.15;  // of what a command, a setpoint or the want of one causes: that takes PX4 1.0 to 1.1 s
constexpr double kSequencePeriod = 3.0;
// m, over the whole flight: PX4's estimate wanders by up to 0.4 m, its steps differ by as much from one another, and it
// drifts 0.7 m while it sinks without a stream.
constexpr double kPositionRms = 0.6;
constexpr double kPositionWorst = 1.4;

template <typename Value, typename Equal>
void expect_same(const char* what, const std::vector<Timed<Value>>& px4, const std::vector<Timed<Value>>& simulator,
                 double tolerance, Equal equal) {
  ASSERT_EQ(px4.size(), simulator.size()) << what;
  for (std::size_t i = 0; i < px4.size(); ++i) {
    EXPECT_TRUE(equal(px4[i].value, simulator[i].value)) << what << " number " << i << " at " << px4[i].t << " s";
    EXPECT_NEAR(px4[i].t, simulator[i].t, tolerance) << what << " number " << i;
  }
}

/// Those that tell of take-off and landing may be as far apart as the landed states are.
void expect_same_events(const Story& px4, const Story& simulator) {
  constexpr std::uint32_t kTakeoffDetected = 0x01414569;
  constexpr std::uint32_t kLandingDetected = 0x019638AC;
  constexpr std::uint32_t kDisarmedEvent = 0x01F46777;
  ASSERT_GT(px4.events.size(), 15U);
  ASSERT_EQ(px4.events.size(), simulator.events.size());
  for (std::size_t i = 0; i < px4.events.size(); ++i) {
    const Event& event = px4.events[i].value;
    const bool moves = event.id == kTakeoffDetected || event.id == kLandingDetected || event.id == kDisarmedEvent;
    EXPECT_TRUE(event == simulator.events[i].value)
        << "event number " << i << std::hex << ": " << event.id << " and " << simulator.events[i].value.id;
    EXPECT_NEAR(px4.events[i].t, simulator.events[i].t, moves ? kLandedStateTolerance : kEventTolerance)
        << "event number " << i;
  }
  for (const Story* story : {&px4, &simulator}) {
    const auto& times = story->event_sequences;
    ASSERT_GT(times.size(), 10U);
    EXPECT_NEAR((times.back() - times.front()) / static_cast<double>(times.size() - 1), kSequencePeriod,
                0.1 * kSequencePeriod);
  }
}

void expect_same_flight(const Story& px4, const Story& simulator) {
  double square = 0.0;
  double worst = 0.0;
  std::size_t next = 0;
  for (const auto& [t, position] : px4.positions_ned) {
    while (next + 1 < simulator.positions_ned.size() && simulator.positions_ned[next].t < t) ++next;
    const double apart = (position - simulator.positions_ned[next].value).norm();
    square += apart * apart;
    worst = std::max(worst, apart);
  }
  const double rms = std::sqrt(square / static_cast<double>(px4.positions_ned.size()));
  testing::Test::RecordProperty("position_rms", std::to_string(rms));
  testing::Test::RecordProperty("position_worst", std::to_string(worst));
  EXPECT_LT(rms, kPositionRms);
  EXPECT_LT(worst, kPositionWorst);
}

void expect_same_story(const std::string& name, std::int32_t com_obl_rc_act) {
  const auto recording = read_tlog(name);
  const Story px4 = told_by_px4(recording);
  const Story simulator = told_by_simulator(recording, com_obl_rc_act);
  ASSERT_GT(px4.acks.size(), 10U);
  expect_same("ack", px4.acks, simulator.acks, kAckTolerance, std::equal_to<>());
  expect_same("heartbeat", px4.heartbeats, simulator.heartbeats, kHeartbeatTolerance, same);
  expect_same("landed state", px4.landed_states, simulator.landed_states, kLandedStateTolerance, std::equal_to<>());
  expect_same("text", px4.texts, simulator.texts, kTextTolerance, std::equal_to<>());
  expect_same_events(px4, simulator);
  expect_same_flight(px4, simulator);
}

TEST(Px4Recordings, RefusalsTakeoffFlightLostStreamAndLanding) {
  expect_same_story("offboard_flight.tlog", 0);
}

TEST(Px4Recordings, HoldFailsafeReturnToOffboardAndLand) {
  expect_same_story("offboard_hold_land.tlog", 5);
}

}  // namespace
}  // namespace jink::sim::mavlink
