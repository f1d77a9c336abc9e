// SPDX-License-Identifier: BSD-3-Clause
// What a vehicle of the team says of itself: where it is going to be. The transport is an interface with two
// implementations: dds_intents, and sim/flight/team_link in virtual time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "bridge/base/stamped.hpp"
#include "bridge/frames/geodetic.hpp"
#include "planner/base/trajectory.hpp"

namespace jink::bridge::team {

/// A vehicle's committed path: what it follows now, a stop or a stay too.
struct Intent {
  std::uint64_t vehicle = 0;               ///< vehicle_id()
  std::optional<frames::Geodetic> origin;  ///< of the frame of `path`; none: the sender does not know it
  double radius = 0.0;                     ///< of the vehicle's sphere
  double margin = 0.0;                     ///< how far the vehicle may be off the path, by its position's error too
  planner::base::TimedPath path;  ///< s from the message's stamp on, ENU from `origin`; only times and positions count
};

/// Beyond these an intent is absurd and refused.
struct IntentLimits {
  static constexpr double kPosition = 1e5;  ///< m from the sender's origin
  static constexpr double kRadius = 1e3;    ///< m, and above 0
  static constexpr double kMargin = 1e3;    ///< m, not negative
  static constexpr double kTime = 3600.0;   ///< s, to either side of the stamp
  static constexpr double kStep = 1e-4;     ///< s, least between two points
  static constexpr std::size_t kPoints = 1024;
};
/// Null where the intent is usable, else what about it is not finite, out of range or out of order. Pure.
const char* refusal(const Intent& intent);

/// The autopilot's MAVLink system in the upper half, so that people know which one it is and an order of precedence
/// follows from it; what tells two processes apart in the lower half.
[[nodiscard]] std::uint64_t vehicle_id(std::uint32_t system_id, std::uint64_t writer);
/// "2": the system of a vehicle_id().
[[nodiscard]] std::uint32_t system_of(std::uint64_t vehicle);

/// An intent as it came.
struct IntentMessage : base::Reception<base::Frame::kSender> {
  Intent intent;  ///< within IntentLimits
};

struct IntentStatus {
  std::uint64_t refused = 0;  ///< messages left out since the start
  std::string last_refusal;   ///< why, of the newest
};

class IntentTransport {
 public:
  virtual ~IntentTransport() = default;
  /// Takes a message not yet taken; false when there is none. Only the newest of each writer is kept. Never blocks.
  /// What this process published may be among them.
  virtual bool poll(IntentMessage& message) = 0;
  /// Sends it to all, stamped with the present; false when it could not be handed over. Never blocks.
  [[nodiscard]] virtual bool publish(const Intent& intent) = 0;
  /// What others know this process by, as IntentMessage::writer.
  [[nodiscard]] virtual std::uint64_t identity() const = 0;
  [[nodiscard]] virtual IntentStatus status() const = 0;
};

}  // namespace jink::bridge::team
