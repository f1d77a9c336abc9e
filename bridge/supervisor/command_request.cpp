// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor/command_request.hpp"

#include <algorithm>

namespace jink::bridge::supervisor {
namespace {

constexpr double kAskAgain = 1.5;  // s; a confirming heartbeat takes up to one
constexpr double kFresh = 1.5;     // s, of a heartbeat to ask on: PX4 sends one a second
constexpr int kMostTries = 5;

}  // namespace

std::optional<vehicle::Command> CommandRequest::ask(vehicle::Command command, double now,
                                                    const vehicle::VehicleState& state) {
  if (!asked_ || asked_->command != command) asked_ = Asked{command, now, 0, {}};
  const bool due = asked_->tries == 0 || (now - asked_->at >= kAskAgain && state.heartbeat_stamp > asked_->at);
  if (!due || now - state.heartbeat_stamp > kFresh) return std::nullopt;
  asked_->at = now;
  ++asked_->tries;
  return command;
}

void CommandRequest::answer(const vehicle::CommandReport& report) {
  if (asked_ && !report.accepted)
    asked_->refusal = std::string(vehicle::to_string(report.command)) + " refused: " + report.detail;
}

bool CommandRequest::exhausted(double now, const vehicle::VehicleState& state) const {
  if (!asked_) return false;
  if (asked_->tries >= kMostTries) return now - asked_->at >= kAskAgain;
  return now - std::max(asked_->at, state.heartbeat_stamp) >= kMostTries * kAskAgain;
}

std::optional<vehicle::Command> CommandRequest::command() const {
  return asked_ ? std::optional(asked_->command) : std::nullopt;
}

}  // namespace jink::bridge::supervisor
