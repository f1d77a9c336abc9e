// SPDX-License-Identifier: BSD-3-Clause
// PX4's events on the wire. Each id, its log levels and its arguments are read from the recordings of PX4's SITL; the
// texts that it sends at the same moments tell what they mean. A lost event is not sent again on request.
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

/// Packed as they go out.
class WireEvent {
 public:
  WireEvent(std::uint32_t id, std::uint8_t log_levels) {
    message_.id = id;
    message_.log_levels = log_levels;
  }
  WireEvent& byte(std::uint8_t value) {
    message_.arguments[size_++] = value;
    return *this;
  }
  WireEvent& word(std::uint32_t value) {
    for (unsigned shift = 0; shift < 32; shift += 8) byte(static_cast<std::uint8_t>(value >> shift));
    return *this;
  }
  [[nodiscard]] const mavlink_event_t& message() const { return message_; }

 private:
  mavlink_event_t message_{};
  std::size_t size_ = 0;
};

// The arming checks: bits of PX4's modes and of its components.
constexpr std::uint32_t kModeMission = 1U << 3U;
constexpr std::uint32_t kModeOffboard = 1U << 14U;
constexpr std::uint32_t kAllModes = 0xFFFFFFFF;
constexpr std::uint32_t kOtherModes = 0x807F3AB0;  ///< that can be armed in and flown, besides OFFBOARD
constexpr std::uint8_t kRemoteControl = 7;
constexpr std::uint8_t kCommunicationLinks = 12;
constexpr std::uint8_t kSystem = 20;
constexpr std::uint32_t kPresent = 0x38020C0A;  ///< components, without a ground station's link

/// What the checks find, from the summary of modes to that of components.
std::vector<WireEvent> checks(std::uint8_t found, bool ground_station) {
  const bool stream = (found & vehicle::kWithStream) != 0;
  const bool mission = (found & vehicle::kWithMission) != 0;
  const std::uint32_t modes = kOtherModes | (stream ? kModeOffboard : 0U) | (mission ? kModeMission : 0U);
  std::vector<WireEvent> events;
  events.push_back(WireEvent(0x01A893E0, 0x88)
                       .byte(0)
                       .word(stream ? 0U : 1U << kSystem)  // errors
                       .word(1U << kRemoteControl)         // warnings
                       .word(modes)                        // to arm in
                       .word(modes));                      // to fly
  if (!mission) events.push_back(WireEvent(0x0105C2D9, 0x66).word(kModeMission).byte(kSystem));
  if (!stream) events.push_back(WireEvent(0x012F1DC7, 0x33).word(kModeOffboard).byte(kSystem));
  events.push_back(WireEvent(0x0106ED29, 0x44).word(kAllModes).byte(kRemoteControl));  // none there
  if (!ground_station) events.push_back(WireEvent(0x0167C97B, 0x66).word(kAllModes).byte(kCommunicationLinks));
  events.push_back(
      WireEvent(0x011D3727, 0x88).byte(0).word(ground_station ? kPresent | 1U << kCommunicationLinks : kPresent));
  return events;
}

std::vector<WireEvent> on_the_wire(const vehicle::FlightEvent& event, bool ground_station) {
  switch (event.kind) {
    case vehicle::EventKind::kArmingRefused:
      return {WireEvent(0x0102089D, 0x62)};
    case vehicle::EventKind::kArmed:
      return {WireEvent(0x0190CAF3, 0x66).byte(event.detail)};
    case vehicle::EventKind::kDisarmed:
      return {WireEvent(0x01F46777, 0x66).byte(event.detail)};
    case vehicle::EventKind::kTakeoffDetected:
      return {WireEvent(0x01414569, 0x66)};
    case vehicle::EventKind::kLanding:
      return {WireEvent(0x0132B2DE, 0x66)};
    case vehicle::EventKind::kLandingDetected:
      return {WireEvent(0x019638AC, 0x66)};
    case vehicle::EventKind::kFailsafe:
      return {WireEvent(0x01DEDBD0, 0x42).word(event.intended_mode).byte(event.detail)};
    case vehicle::EventKind::kChecks:
      return checks(event.detail, ground_station);
  }
  return {};
}

}  // namespace

bool MavlinkEndpoint::Impl::ground_station_heard() const {
  return std::any_of(links_.begin(), links_.end(), [](const MavlinkLink& link) { return link.ground_station; });
}

/// To all links, ground station or not.
void MavlinkEndpoint::Impl::send_events() {
  for (const vehicle::FlightEvent& event : autopilot_.take_events()) {
    for (const WireEvent& wire : on_the_wire(event, ground_station_heard())) {
      mavlink_event_t message = wire.message();
      message.event_time_boot_ms = static_cast<std::uint32_t>(boot_us(event.boot_time) / 1000);
      message.sequence = ++event_sequence_;
      events_sent_ = true;
      for (MavlinkLink& link : links_) link.send(mavlink_msg_event_encode_status, message);
    }
  }
}

void MavlinkEndpoint::Impl::send_event_sequence(MavlinkLink& link) {
  constexpr std::uint8_t kReset = 1;  // MAV_EVENT_CURRENT_SEQUENCE_FLAGS_RESET: none to compare it with
  mavlink_current_event_sequence_t message{};
  message.sequence = event_sequence_;
  message.flags = events_sent_ ? std::uint8_t{0} : kReset;
  link.send(mavlink_msg_current_event_sequence_encode_status, message);
}

}  // namespace jink::sim::mavlink
