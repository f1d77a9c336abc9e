// SPDX-License-Identifier: BSD-3-Clause
#include "tests/sim/flight/safety_words.hpp"

#include <algorithm>

namespace jink::sim::flight::safety {
namespace {

using bridge::supervisor::Outcome;
using bridge::supervisor::Phase;

bool said(const Flight& flight, std::string_view name) {
  return std::any_of(flight.events().begin(), flight.events().end(),
                     [&](const Flight::Event& event) { return event.name == name; });
}

std::string_view never_armed(const Flight& flight) {
  const bridge::supervisor::Supervisor& supervisor = flight.companion().supervisor();
  if (flight.killed_for_good()) return "stays";
  const bool waited = !supervisor.done() || supervisor.reason().rfind("waited in vain", 0) == 0;
  return waited ? "waits" : "ends";
}

// In what the motors ran last.
std::string_view left_in(const Flight& flight) {
  const auto& [mode, intended] = flight.last_mode();
  const bool down = !flight.autopilot().armed();
  if (mode != intended) {  // the autopilot's failsafe
    if (vehicle::is_manual(mode) && !down) return "pilot";
    if (intended == vehicle::FlightMode::kHold) return down ? "HOLD, down" : "HOLD";
    if (down) return "PX4 down";
    return mode == vehicle::FlightMode::kReturn ? "PX4 RETURN" : "PX4 HOLD";
  }
  switch (mode) {
    case vehicle::FlightMode::kHold:
      return down ? "HOLD, down" : "HOLD";
    case vehicle::FlightMode::kLand:
      return "LAND";
    case vehicle::FlightMode::kReturn:
      return "RETURN";
    default:
      return "OFFBOARD";  // never, see Flight
  }
}

}  // namespace

std::string_view word_of(const Flight& flight, const Happening& what, const Cell& cell) {
  if (!flight.ever_armed()) return never_armed(flight);
  if (flight.fell()) return "falls";
  const Outcome outcome = flight.companion().supervisor().outcome();
  if (outcome == Outcome::kReached && !flight.killed_for_good()) {
    if (cell.phase == Phase::kLanding) return "lands";
    return said(flight, "hazard") || said(flight, "stalled") ? "brakes, on" : "on";
  }
  if (!flight.ever_flew()) return "stays";
  return what.of_pilot ? "pilot" : left_in(flight);
}

}  // namespace jink::sim::flight::safety
