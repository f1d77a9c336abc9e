// SPDX-License-Identifier: BSD-3-Clause
// What the autopilot tells of itself: texts for ground stations, events for all.
#include <utility>

#include "sim/vehicle/autopilot.hpp"

namespace jink::sim::vehicle {
namespace {

constexpr std::size_t kMaxTexts = 64;
constexpr std::size_t kMaxEvents = 64;

template <typename Entry>
void keep_newest(std::vector<Entry>& entries, Entry entry, std::size_t most) {
  if (entries.size() == most) entries.erase(entries.begin());
  entries.push_back(std::move(entry));
}

}  // namespace

void Autopilot::report(Severity severity, std::string text) {
  keep_newest(texts_, {severity, std::move(text)}, kMaxTexts);
}

std::vector<StatusText> Autopilot::take_status_texts() {
  return std::exchange(texts_, {});
}

void Autopilot::emit_event(EventKind kind, std::uint8_t detail) {
  keep_newest(events_, {kind, boot_time(), static_cast<std::uint32_t>(intended_mode_), detail}, kMaxEvents);
}

std::vector<FlightEvent> Autopilot::take_events() {
  return std::exchange(events_, {});
}

void Autopilot::emit_armed_event(EventKind kind, ArmingReason reason) {
  emit_event(kind, static_cast<std::uint8_t>(reason));
}

/// The recordings know two of the actions.
void Autopilot::emit_failsafe_event(FlightMode mode) {
  if (mode == FlightMode::kPosition)
    emit_event(EventKind::kFailsafe, static_cast<std::uint8_t>(FailsafeAction::kPosition));
  if (mode == FlightMode::kHold) emit_event(EventKind::kFailsafe, static_cast<std::uint8_t>(FailsafeAction::kHold));
}

/// The report names all that is amiss. With more than stream and mission amiss it would read otherwise than in the
/// recordings, so that there is none then.
void Autopilot::watch_checks() {
  const bool as_recorded = ready() && position_valid() && !remote_control_ && !refuses_arming_ && !refuses_offboard_ &&
                           !crashed_ && battery_level() == BatteryLevel::kOk;
  const bool known = stream_live() == stream_reported_ && mission_.available() == mission_reported_;
  if (!as_recorded || known) return;
  stream_reported_ = stream_live();
  mission_reported_ = mission_.available();
  emit_event(EventKind::kChecks,
             static_cast<std::uint8_t>((stream_reported_ ? kWithStream : 0) | (mission_reported_ ? kWithMission : 0)));
}

}  // namespace jink::sim::vehicle
