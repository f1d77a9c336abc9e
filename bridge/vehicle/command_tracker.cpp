// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/vehicle/command_tracker.hpp"

#include <algorithm>
#include <utility>

#include "bridge/vehicle/px4.hpp"

namespace jink::bridge::vehicle {

void CommandTracker::start(Command command, std::uint16_t mav_cmd, double now) {
  std::erase_if(open_, [&](const Open& open) {
    if (open.mav_cmd != mav_cmd) return false;
    reports_.push_back({open.command, false, "superseded by " + std::string(to_string(command))});
    return true;
  });
  open_.push_back({command, mav_cmd, now + kAnswer_s, false});
}

void CommandTracker::fail(Command command, std::string detail) {
  reports_.push_back({command, false, std::move(detail)});
}

void CommandTracker::acknowledge(std::uint16_t mav_cmd, int result, double now) {
  const auto open = std::find_if(open_.begin(), open_.end(), [&](const Open& o) { return o.mav_cmd == mav_cmd; });
  if (open == open_.end()) return;
  if (result == px4::kResultInProgress) {
    open->deadline = now + kAnswer_s;
    return;
  }
  const bool accepted = result == px4::kResultAccepted;
  if (accepted && mav_cmd == px4::kDoSetMode && !open->accepted_once) {
    open->accepted_once = true;
    open->deadline = now + kSecondAnswer_s;
    return;
  }
  reports_.push_back({open->command, accepted, accepted ? std::string() : px4::result_text(result)});
  open_.erase(open);
}

std::optional<CommandReport> CommandTracker::next(double now) {
  std::erase_if(open_, [&](const Open& open) {
    if (now < open.deadline) return false;
    reports_.push_back({open.command, open.accepted_once, open.accepted_once ? "" : kNoAnswer});
    return true;
  });
  if (reports_.empty()) return std::nullopt;
  CommandReport report = std::move(reports_.front());
  reports_.pop_front();
  return report;
}

}  // namespace jink::bridge::vehicle
