// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's face on UDP: MAVLink 2 as PX4's SITL speaks it, one link for a companion and one for a ground
// station. NED, FRD, degrees and global coordinates exist here and nowhere else in the simulator.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "sim/faults/link_faults.hpp"
#include "sim/vehicle/autopilot.hpp"
#include "sim/vehicle/frame_conversions.hpp"

namespace jink::sim::mavlink {

/// How fast PX4's SITL's clock runs against the wall, measured: EndpointOptions::clock_rate of one in real time.
inline constexpr double kSitlClockRate = 0.987;

/// Instance N of PX4's SITL: system id N + 1, ports 14580 + N to 14540 + N and 18570 + N to 14550.
struct EndpointOptions {
  int instance = 0;                                     ///< 0 to 9
  std::string address = "127.0.0.1";                    ///< of both ends
  bool ground_link = true;                              ///< open the second link
  std::optional<std::uint16_t> companion_local_port{};  ///< instead of PX4's; 0: any free port
  std::optional<std::uint16_t> companion_remote_port{};
  std::optional<std::uint16_t> ground_local_port{};
  std::optional<std::uint16_t> ground_remote_port{};
  bridge::frames::Geodetic origin = vehicle::kSitlOrigin;  ///< of the local frame
  std::uint64_t unix_time_at_start_us = 1767225600000000;  ///< for SYSTEM_TIME: 1 January 2026
  std::uint64_t seed = 1;                                  ///< of what befalls packets on an impaired link
  /// Seconds of the autopilot's clock, by which its messages are stamped, in one of the simulation's: 0.9 to 1.1. The
  /// stamps alone: motion, rates and time-outs keep the simulation's time. SYSTEM_TIME's unix time does too.
  double clock_rate = 1.0;
};

struct EndpointCounters {
  std::uint64_t received = 0;   ///< messages
  std::uint64_t malformed = 0;  ///< datagrams with something in them that is no MAVLink message
  std::uint64_t setpoints = 0;  ///< that the companion has sent, also those that an impaired link loses or holds back
};

/// Serves an autopilot that outlives it. Never blocks. Not thread-safe: one thread polls it and steps the autopilot.
class MavlinkEndpoint {
 public:
  /// Throws std::runtime_error, one line that names the port and what to do, when a port is taken, and
  /// std::invalid_argument for an instance, an address, an origin or a clock rate out of range.
  MavlinkEndpoint(vehicle::Autopilot& autopilot, const EndpointOptions& options);
  ~MavlinkEndpoint();
  MavlinkEndpoint(const MavlinkEndpoint&) = delete;
  MavlinkEndpoint& operator=(const MavlinkEndpoint&) = delete;

  /// Handles all that has arrived and sends what is due at `now`, the autopilot's time: call it at 250 Hz of that.
  void poll(double now);
  /// How bad the companion's link is from now on; the ground station's stays as it is.
  void impair(const faults::LinkImpairment& impairment);

  [[nodiscard]] std::uint16_t companion_port() const;
  /// 0 without a ground link.
  [[nodiscard]] std::uint16_t ground_port() const;
  /// Of both links together.
  [[nodiscard]] EndpointCounters counters() const;

  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::sim::mavlink
