// SPDX-License-Identifier: BSD-3-Clause
// Where obstacle tracks come from. Two implementations: dds_tracks and the virtual-time source of
// sim/flight/closed_loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bridge/base/notifier.hpp"
#include "bridge/base/stamped.hpp"
#include "bridge/tracking/well_clear.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::tracking {

/// One message of one writer: all tracks that it now sees, in ENU.
struct TrackMessage : base::Reception<base::Frame::kLocal> {
  std::vector<planner::base::Track> tracks;
  std::uint32_t dropped = 0;         ///< tracks of this message left out: non-finite or absurd values
  std::uint32_t far = 0;             ///< of these, those farther than TrackLimits::kPosition
  bool placed = false;               ///< its frame's place is known: it has an origin, or is the vehicle's
  std::vector<Aircraft> aircraft{};  ///< those of them with people on board, of a source that knows
  bool positions_only = false;       ///< its writer tells no velocities: the table finds them
  std::size_t named = 0;             ///< i + 1: of the writer i that the mission names; 0: it names none
  bool sends_when_empty =
      true;  ///< its writer speaks also when it sees nothing: as long as it speaks, somebody is watching
};

/// What was refused at the door since the start; for events and summaries.
struct TrackSourceStatus {
  int writers = 0;                   ///< matched now
  std::uint64_t messages = 0;        ///< accepted
  std::uint64_t refused = 0;         ///< messages: for their frame, or for who wrote them
  std::uint64_t dropped_tracks = 0;  ///< tracks left out for their values
  std::uint64_t malformed = 0;       ///< payloads that could not be decoded
  std::string last_refusal;          ///< why, of the newest refusal
};

class TrackSource {
 public:
  virtual ~TrackSource() = default;
  /// Takes the oldest message not yet taken; false when there is none. Never blocks.
  virtual bool poll(TrackMessage& message) = 0;
  [[nodiscard]] virtual TrackSourceStatus status() const = 0;
  /// From now on `notifier`, which outlives the source, is notified when a message has come. Where nothing comes by
  /// itself (virtual time) it does nothing.
  virtual void notify(base::Notifier& /*notifier*/) {}
};

}  // namespace jink::bridge::tracking
