// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/pilot_texts.hpp"

#include <algorithm>
#include <utility>

namespace jink::bridge::companion {
namespace {

using vehicle::Severity;
using vehicle::StatusText;

constexpr std::string_view kName = "jink: ";

/// Phases that are called otherwise for a pilot.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kPhases{
    {{"engaging", "taking over"}, {"handover", "handing over to HOLD"}}};

/// Events besides phases and hazards that a pilot should know of.
constexpr std::array<std::pair<std::string_view, Severity>, 10> kEvents{{{"hazard_over", Severity::kInfo},
                                                                         {"arrived", Severity::kInfo},
                                                                         {"holding", Severity::kInfo},
                                                                         {"waiting", Severity::kInfo},
                                                                         {"waypoint", Severity::kInfo},
                                                                         {"stuck", Severity::kWarning},
                                                                         {"refused", Severity::kWarning},
                                                                         {"stalled", Severity::kWarning},
                                                                         {"send_failed", Severity::kWarning},
                                                                         {"second_autopilot", Severity::kWarning}}};

StatusText phase_text(std::string_view detail) {
  constexpr std::string_view kDone = "done: ";
  if (detail.starts_with(kDone)) {
    const bool reached = detail.substr(kDone.size()).starts_with("reached");
    return {reached ? Severity::kInfo : Severity::kCritical, std::string(kName).append(detail)};
  }
  for (const auto& [phase, words] : kPhases) {
    if (detail == phase) detail = words;
  }
  return {Severity::kInfo, std::string(kName).append(detail)};
}

std::optional<StatusText> text_of(std::string_view name, const std::string& detail) {
  if (name == "hazard") {
    const bool failsafe = detail.find("failsafe") != std::string::npos;
    return StatusText{failsafe ? Severity::kCritical : Severity::kWarning, std::string(kName) + "braking: " + detail};
  }
  if (name == "battery" && (detail == "low" || detail == "critical"))
    return StatusText{detail == "low" ? Severity::kWarning : Severity::kCritical,
                      std::string(kName) + "battery " + detail};
  if (name == "request" && detail == "return") return StatusText{Severity::kWarning, std::string(kName) + "RETURN"};
  if (name == "waiting" && detail.starts_with("an autopilot's heartbeat")) return std::nullopt;  // nobody would hear it
  const auto* const found =
      std::find_if(kEvents.begin(), kEvents.end(), [&](const auto& e) { return e.first == name; });
  if (found == kEvents.end()) return std::nullopt;
  std::string text = std::string(kName).append(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return StatusText{found->second, detail.empty() ? text : text + ": " + detail};
}

}  // namespace

void PilotTexts::on_event(double /*now*/, std::string_view name, const std::string& detail) {
  if (name == "phase") {
    phase_ = phase_text(detail);
    return;
  }
  std::optional<StatusText> text = text_of(name, detail);
  if (!text) return;
  if (waiting_.size() == kWaiting) waiting_.pop_front();
  waiting_.push_back(std::move(*text));
}

bool PilotTexts::repeated(double now, const std::string& text) const {
  const auto found = told_.find(text);
  return found != told_.end() && now - found->second < kRepeat_s;
}

std::optional<StatusText> PilotTexts::next(double now) {
  std::erase_if(told_, [&](const auto& told) { return now - told.second >= kRepeat_s; });
  const bool full = told_.size() >= kPerSecond && now - newest_.front() < 1.0;
  if (full) return std::nullopt;
  std::optional<StatusText> text;
  if (phase_ && !repeated(now, phase_->text)) text = std::exchange(phase_, std::nullopt);
  while (!text && !waiting_.empty()) {
    if (!repeated(now, waiting_.front().text)) text = std::move(waiting_.front());
    waiting_.pop_front();
  }
  if (!text) return std::nullopt;
  told_[text->text] = now;
  std::rotate(newest_.begin(), newest_.begin() + 1, newest_.end());
  newest_.back() = now;
  return text;
}

std::optional<StatusText> PilotTexts::last() {
  return std::exchange(phase_, std::nullopt);
}

}  // namespace jink::bridge::companion
