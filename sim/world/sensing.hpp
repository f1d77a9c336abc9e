// SPDX-License-Identifier: BSD-3-Clause
// What a sensor would report of the world: tracks with limited range, noise, dropout, rate and delay. The true shapes
// and motions stay in sim/world.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/types.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::world {

/// The tracks of one measurement at scenario time `t`, from vehicles whose centres are at `vehicles`, in the order of
/// the obstacles: each obstacle whose surface is within range of one of them, and that does not drop out.
/// - position and velocity are those of the enclosing sphere's centre, with independent Gaussian noise on each axis;
///   the sigmas say how much. Radius and body are exact, the age 0.
/// - acceleration is the true one where both noises are zero, otherwise zero: what measures with noise does not report
///   accelerations that anyone could use.
/// The random numbers depend on (seed, sequence, obstacle) alone: not on the range, on other obstacles or on the other
/// settings, so that a change of one of these changes nothing else. O(obstacles). Thread safe.
[[nodiscard]] std::vector<planner::base::Track> measure(const World& world, const config::Sensing& sensing,
                                                        std::uint64_t seed, std::uint64_t sequence, double t,
                                                        std::span<const Vec3> vehicles);
/// The same for one vehicle.
[[nodiscard]] inline std::vector<planner::base::Track> measure(const World& world, const config::Sensing& sensing,
                                                               std::uint64_t seed, std::uint64_t sequence, double t,
                                                               const Vec3& vehicle) {
  return measure(world, sensing, seed, sequence, t, std::span(&vehicle, 1));
}

/// Estimate less truth of the vehicle that senses: what onboard perception adds to every track.
struct EstimateError {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
};

/// One measurement on its way to the planner.
struct TrackMessage {
  std::uint64_t sequence = 0;  ///< counts the measurements from 0
  double stamp = 0.0;          ///< s, when it was measured
  double publication = 0.0;    ///< s, when it may be seen: stamp + delay
  std::vector<planner::base::Track> tracks;
  double clock_offset = 0.0;  ///< s, by which the publisher's clock is ahead: its stamp is stamp + clock_offset
};

/// Takes measurement k at the time k / rate, counted without drift, and holds it back for the delay. Times are those of
/// the caller's clock and begin at 0. Not thread safe.
class SensingPipeline {
 public:
  SensingPipeline(const config::Sensing& sensing, std::uint64_t seed) : sensing_(sensing), seed_(seed) {}

  /// Takes every measurement that is due at `t` and was not taken yet, with the obstacles where they are when it is due
  /// and the vehicles at `vehicles`, so call it at every step of the simulation. A `t` earlier than before does
  /// nothing. `clock_start` is the time at which the scenario's clock starts; until then the obstacles stand, and it
  /// may be kInfinity as long as it is not known. `error` is what tracks sensed from the vehicle carry along.
  void step(double t, const World& world, std::span<const Vec3> vehicles, double clock_start = 0.0,
            const EstimateError& error = {});
  /// The same for one vehicle.
  void step(double t, const World& world, const Vec3& vehicle, double clock_start = 0.0) {
    step(t, world, std::span(&vehicle, 1), clock_start);
  }

  /// Moves the oldest message whose publication is due at `t` into `message` and returns true; false if there is none.
  /// Call it until it returns false.
  [[nodiscard]] bool poll(double t, TrackMessage& message);

 private:
  config::Sensing sensing_;
  std::uint64_t seed_;
  std::uint64_t next_ = 0;            ///< the measurement to take next
  std::deque<TrackMessage> pending_;  ///< taken and not yet polled, oldest first
};

}  // namespace jink::sim::world
