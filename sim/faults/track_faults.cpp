// SPDX-License-Identifier: BSD-3-Clause
#include "sim/faults/track_faults.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "planner/base/random.hpp"

namespace jink::sim::faults {
namespace {

using config::FaultKind;

// Names of their own among the streams of a seed.
constexpr std::uint64_t kNoiseStream = 0x746e6f697365ULL;
constexpr std::uint64_t kGarbageStream = 0x67617262616765ULL;

constexpr double kSelfRadius = 0.3;      // m
constexpr double kFloodRadius = 1.0;     // m, of each track
constexpr double kFloodDistance = 2000;  // m

constexpr std::uint64_t kWaysToSpoil = 4;

/// `way` is 0 to kWaysToSpoil - 1.
void make_unusable(planner::base::Track& track, std::uint64_t way) {
  switch (way) {
    case 0:
      track.position.x() = std::numeric_limits<double>::quiet_NaN();
      break;
    case 1:
      track.position.y() = 1e300;
      break;
    case 2:
      track.radius = -1.0;
      break;
    default:
      track.velocity.z() = std::numeric_limits<double>::infinity();
      break;
  }
}

void swap_ids(world::TrackMessage& message) {
  for (std::size_t i = 0; i + 1 < message.tracks.size(); i += 2) {
    std::swap(message.tracks[i].id, message.tracks[i + 1].id);
  }
}

void flood(int count, const Vec3& center, world::TrackMessage& message) {
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    planner::base::Track track;
    track.id = kFloodIds + static_cast<std::uint64_t>(i);
    track.position = center + kFloodDistance * Vec3(std::cos(angle), std::sin(angle), 0.0);
    track.radius = kFloodRadius;
    message.tracks.push_back(track);
  }
}

void add_selves(const FaultTimeline& timeline, std::span<const world::VehicleTruth> vehicles,
                world::TrackMessage& message) {
  for (std::size_t k = 0; k < vehicles.size(); ++k) {
    if (!timeline.active(FaultKind::kTracksSelf, static_cast<int>(k))) continue;
    planner::base::Track track;
    track.id = kSelfIds + k;
    track.position = vehicles[k].position;
    track.velocity = vehicles[k].velocity;
    track.radius = kSelfRadius;
    message.tracks.push_back(track);
  }
}

}  // namespace

bool TrackFaults::apply(const FaultTimeline& timeline, const world::World& world,
                        std::span<const world::VehicleTruth> vehicles, world::TrackMessage& message) {
  freeze(timeline, message);
  if (timeline.active(FaultKind::kTracksStop)) return false;
  if (timeline.active(FaultKind::kIdSwap)) swap_ids(message);
  for (const config::Fault* fault : timeline.of_kind(FaultKind::kTrackNoise)) add_noise(*fault, message);
  add_selves(timeline, vehicles, message);
  if (timeline.active(FaultKind::kTracksGarbage)) spoil(message);
  for (const config::Fault* fault : timeline.of_kind(FaultKind::kTracksFlood))
    flood(fault->count, world.scenario().start, message);
  for (const config::Fault* fault : timeline.of_kind(FaultKind::kTracksClock)) message.clock_offset += fault->offset;
  return true;
}

void TrackFaults::freeze(const FaultTimeline& timeline, world::TrackMessage& message) {
  if (last_ && timeline.active(FaultKind::kTracksFreeze)) {
    message.tracks = *last_;
  } else {
    last_ = message.tracks;
  }
}

void TrackFaults::add_noise(const config::Fault& fault, world::TrackMessage& message) const {
  for (planner::base::Track& track : message.tracks) {
    planner::base::RandomStream random(seed_ ^ kNoiseStream, message.sequence, track.id);
    for (int axis = 0; axis < 3; ++axis) track.position[axis] += fault.position * random.normal();
    for (int axis = 0; axis < 3; ++axis) track.velocity[axis] += fault.velocity * random.normal();
  }
}

void TrackFaults::spoil(world::TrackMessage& message) const {
  for (planner::base::Track& track : message.tracks) {
    planner::base::RandomStream random(seed_ ^ kGarbageStream, message.sequence, track.id);
    if (random.uniform() < 0.5) make_unusable(track, random.below(kWaysToSpoil));
  }
  for (std::uint64_t way = 0; way < kWaysToSpoil; ++way) {
    planner::base::Track track;
    track.id = kGarbageIds + way;
    track.radius = kSelfRadius;
    make_unusable(track, way);
    message.tracks.push_back(track);
  }
}

}  // namespace jink::sim::faults
