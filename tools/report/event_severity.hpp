// SPDX-License-Identifier: BSD-3-Clause
// How much an event of a flight log matters, in the page and in the figure.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace jink::tools::report {

enum class EventSeverity : std::uint8_t { kPlain, kGood, kWarn, kBad };

/// By the event's name and detail.
[[nodiscard]] inline EventSeverity event_severity(std::string_view name, std::string_view detail) {
  static constexpr std::array<std::string_view, 5> kFailed{"collision", "timeout", "left_world", "start_blocked",
                                                           "aborted"};
  static constexpr std::array<std::string_view, 3> kBlocked{"blocked", "start_blocked", "invalid"};
  static constexpr std::array<std::string_view, 7> kWarnings{
      "fault", "hazard", "refused", "send_failed", "reference_lost", "tracks_refused", "log_dropped"};
  const auto among = [](const auto& list, std::string_view text) {
    return std::find(list.begin(), list.end(), text) != list.end();
  };
  if (name == "reached" || detail.starts_with("done: reached")) return EventSeverity::kGood;
  if (among(kFailed, name) || detail.starts_with("done: ")) return EventSeverity::kBad;
  if (name == "plan_status") return among(kBlocked, detail) ? EventSeverity::kBad : EventSeverity::kPlain;
  return among(kWarnings, name) ? EventSeverity::kWarn : EventSeverity::kPlain;
}

}  // namespace jink::tools::report
