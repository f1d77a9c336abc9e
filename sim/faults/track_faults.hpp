// SPDX-License-Identifier: BSD-3-Clause
// What a scenario's faults do to the tracks on their way to the publisher.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/faults/fault_timeline.hpp"
#include "sim/world/sensing.hpp"
#include "sim/world/truth_observer.hpp"

namespace jink::sim::faults {

/// Ids of tracks that nothing stands behind: beyond those of any scenario's obstacles.
inline constexpr std::uint64_t kFloodIds = 1'000'000;
inline constexpr std::uint64_t kGarbageIds = 2'000'000;
inline constexpr std::uint64_t kSelfIds = 3'000'000;  ///< plus the vehicle's number

/// Applies the faults to one message after another. Random numbers depend on (seed, the message's sequence, track).
/// Not thread-safe.
class TrackFaults {
 public:
  explicit TrackFaults(std::uint64_t seed) : seed_(seed) {}

  /// Changes a message that is about to be published, with the vehicles as they are now, by number. False: it is not to
  /// be published (tracks_stop).
  /// - tracks_freeze: the tracks of the last message before, or of this one if it is the first.
  /// - id_swap: the first and second track change ids, the third and fourth, and so on.
  /// - track_noise: Gaussian, on each axis; the sigmas stay as they are.
  /// - tracks_self: a track of 0.3 m at the vehicle's true position, with its velocity.
  /// - tracks_flood: still tracks of 1 m on a circle of 2 km around the scenario's start.
  /// - tracks_garbage: one track in two is made unusable, and four more that are come with each message.
  /// - tracks_clock: clock_offset, the sum of all in force.
  [[nodiscard]] bool apply(const FaultTimeline& timeline, const world::World& world,
                           std::span<const world::VehicleTruth> vehicles, world::TrackMessage& message);

 private:
  void freeze(const FaultTimeline& timeline, world::TrackMessage& message);
  void add_noise(const config::Fault& fault, world::TrackMessage& message) const;
  void spoil(world::TrackMessage& message) const;

  std::uint64_t seed_;
  std::optional<std::vector<planner::base::Track>> last_;  ///< before any freeze, as measured
};

}  // namespace jink::sim::faults
