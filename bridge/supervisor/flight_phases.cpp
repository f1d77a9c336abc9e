// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor/flight_phases.hpp"

namespace jink::bridge::supervisor {
namespace {

/// `Found` as const as the phase.
template <typename Found, typename Phases>
Found* ending_in(Phases& phase) {
  return std::visit(
      [](auto& p) -> Found* {
        if constexpr (requires { p.ending; }) return &p.ending;
        return nullptr;
      },
      phase);
}

}  // namespace

std::string_view to_string(Phase phase) {
  switch (phase) {
    case Phase::kWaiting:
      return "waiting";
    case Phase::kEngaging:
      return "engaging";
    case Phase::kClimbing:
      return "climbing";
    case Phase::kFlying:
      return "flying";
    case Phase::kStopping:
      return "stopping";
    case Phase::kHandover:
      return "handover";
    case Phase::kLanding:
      return "landing";
    case Phase::kDone:
      return "done";
  }
  return "done";
}

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kNone:
      return "none";
    case Outcome::kReached:
      return "reached";
    case Outcome::kCollision:
      return "collision";
    case Outcome::kTimeout:
      return "timeout";
    case Outcome::kLeftWorld:
      return "left_world";
    case Outcome::kStartBlocked:
      return "start_blocked";
    case Outcome::kAborted:
      return "aborted";
  }
  return "none";
}

Phase phase_of(const FlightPhase& phase) {
  return std::visit([](const auto& p) { return p.kPhase; }, phase);
}

const Ending* ending_of(const FlightPhase& phase) {
  return ending_in<const Ending>(phase);
}

Ending* ending_of(FlightPhase& phase) {
  return ending_in<Ending>(phase);
}

CommandRequest* request_of(FlightPhase& phase) {
  return std::visit(
      [](auto& p) -> CommandRequest* {
        if constexpr (requires { p.request; }) return &p.request;
        return nullptr;
      },
      phase);
}

}  // namespace jink::bridge::supervisor
