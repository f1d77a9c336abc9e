// SPDX-License-Identifier: BSD-3-Clause
// A command that the autopilot is asked for until its telemetry shows the effect.
#pragma once

#include <optional>
#include <string>

#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::supervisor {

/// One command at a time; another begins anew. Pure logic.
class CommandRequest {
 public:
  /// What to send at `now`: the command, once, and again where a heartbeat since then shows no effect. Nothing when it
  /// was asked just now, and on an old heartbeat: the vehicle may be a pilot's by now.
  std::optional<vehicle::Command> ask(vehicle::Command command, double now, const vehicle::VehicleState& state);
  /// Takes in an answer: a refusal is kept while this command is asked for.
  void answer(const vehicle::CommandReport& report);
  /// Asked often enough, and the last request has had its time too; or no heartbeat has come in that time to ask again
  /// on.
  [[nodiscard]] bool exhausted(double now, const vehicle::VehicleState& state) const;
  /// What is wanted; none: nothing.
  [[nodiscard]] std::optional<vehicle::Command> command() const;
  [[nodiscard]] bool asked() const { return asked_ && asked_->tries > 0; }
  /// When it was asked for last. Precondition: asked().
  [[nodiscard]] double asked_at() const { return asked_->at; }
  /// The autopilot's last no, in words; empty: none.
  [[nodiscard]] std::string refusal() const { return asked_ ? asked_->refusal : std::string(); }

 private:
  struct Asked {
    vehicle::Command command;
    double at;  // or, without a try, when it was wanted first
    int tries;
    std::string refusal;
  };
  std::optional<Asked> asked_;
};

}  // namespace jink::bridge::supervisor
