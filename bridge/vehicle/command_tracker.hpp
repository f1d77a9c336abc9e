// SPDX-License-Identifier: BSD-3-Clause
// Turns the acknowledgements of MAVLink commands into one report per request. Time comes in; no transport.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "bridge/vehicle/vehicle_link.hpp"

namespace jink::bridge::vehicle {

/// Follows the requests that are under way. Each start() or fail() leads to exactly one report from next():
/// - refused, as soon as a refusal comes;
/// - accepted, at the first acknowledgement; for DO_SET_MODE, which PX4 accepts twice and means only the second time,
/// at
///   the second one or after kSecondAnswer_s without one (other autopilots and older PX4 answer once);
/// - "no answer", after kAnswer_s without any.
/// An acknowledgement names the MAV_CMD alone: where two requests share it (arm and disarm, offboard and hold), the
/// newer one supersedes the older, which is reported so. A late refusal of the older one may then count against the
/// newer: the proof is VehicleState. Not thread-safe.
class CommandTracker {
 public:
  static constexpr double kAnswer_s = 1.0;
  static constexpr double kSecondAnswer_s = 0.3;
  static constexpr const char* kNoAnswer = "no answer";  ///< a report's detail

  /// A request has been sent as the command `mav_cmd` at `now`.
  void start(Command command, std::uint16_t mav_cmd, double now);
  /// A request that could not be sent: reported as it stands.
  void fail(Command command, std::string detail);
  /// COMMAND_ACK with MAV_RESULT `result`; one that answers no open request is ignored.
  void acknowledge(std::uint16_t mav_cmd, int result, double now);
  /// The oldest report not yet taken, if any.
  [[nodiscard]] std::optional<CommandReport> next(double now);

 private:
  struct Open {
    Command command = Command::kHold;
    std::uint16_t mav_cmd = 0;
    double deadline = 0.0;
    bool accepted_once = false;
  };

  std::vector<Open> open_;  // at most one per MAV_CMD
  std::deque<CommandReport> reports_;
};

}  // namespace jink::bridge::vehicle
