// SPDX-License-Identifier: BSD-3-Clause
#include "sim/faults/track_faults.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace jink::sim::faults {
namespace {

using config::Fault;
using config::FaultKind;

constexpr int kObstacles = 7;

world::World row() {
  config::Scenario scenario;
  scenario.start = {1, 2, 3};
  for (int i = 0; i < kObstacles; ++i) {
    scenario.obstacles.push_back(
        {config::SphereShape{0.5}, config::LinearMotion{{10.0 * i, 0, 0}, {1, 0, 0}, Vec3::Zero()}});
  }
  return world::World(std::move(scenario));
}

/// Messages of a world under one fault in [1, 2), at 20 Hz.
class Sensed {
 public:
  explicit Sensed(Fault fault) : timeline_({in_second(fault)}) {}

  /// The message at `t`, which counts up; nothing where it is not published.
  std::optional<world::TrackMessage> at(double t, const world::VehicleTruth& vehicle = {}) {
    timeline_.advance(t);
    world::TrackMessage message;
    message.sequence = static_cast<std::uint64_t>(std::lround(20 * t));
    message.stamp = t;
    message.tracks = world::measure(world_, {}, 1, message.sequence, t, Vec3::Zero());
    const world::VehicleTruth vehicles[] = {vehicle};
    if (!faults_.apply(timeline_, world_, vehicles, message)) return std::nullopt;
    return message;
  }

 private:
  static Fault in_second(Fault fault) {
    fault.at = 1;
    fault.duration = 1;
    return fault;
  }
  world::World world_ = row();
  FaultTimeline timeline_;
  TrackFaults faults_{1};
};

Fault of(FaultKind kind) {
  Fault fault;
  fault.kind = kind;
  return fault;
}

void expect_untouched(const world::TrackMessage& message) {
  ASSERT_EQ(message.tracks.size(), static_cast<std::size_t>(kObstacles));
  for (int i = 0; i < kObstacles; ++i) {
    EXPECT_EQ(message.tracks[static_cast<std::size_t>(i)].id, world::World::id(i));
    EXPECT_EQ(message.tracks[static_cast<std::size_t>(i)].position, Vec3(10.0 * i + message.stamp, 0, 0));
  }
  EXPECT_EQ(message.clock_offset, 0.0);
}

TEST(TrackFaults, NothingIsWrongBeforeAndAfter) {
  for (int kind = 0; kind < 19; ++kind) {
    SCOPED_TRACE(config::to_string(static_cast<FaultKind>(kind)));
    if (of(static_cast<FaultKind>(kind)).instantaneous()) continue;
    Fault fault = of(static_cast<FaultKind>(kind));
    fault.count = 10;
    fault.position = fault.offset = 1.0;
    Sensed sensed(fault);
    for (const double t : {0.0, 0.5, 1.5, 2.0, 2.5}) {
      const auto message = sensed.at(t);
      if (t == 1.5) continue;
      ASSERT_TRUE(message);
      expect_untouched(*message);
    }
  }
}

TEST(TrackFaults, StopSaysNothing) {
  Sensed sensed(of(FaultKind::kTracksStop));
  EXPECT_TRUE(sensed.at(0.95));
  EXPECT_FALSE(sensed.at(1.0));
  EXPECT_FALSE(sensed.at(1.95));
  EXPECT_TRUE(sensed.at(2.0));
}

TEST(TrackFaults, FreezeTellsOldPositionsUnderFreshStamps) {
  Sensed sensed(of(FaultKind::kTracksFreeze));
  sensed.at(0.95);
  const auto message = sensed.at(1.5);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->stamp, 1.5);
  EXPECT_EQ(message->tracks.at(0).position.x(), 0.95);
  // From the very first message on there is nothing older than that.
  Sensed first(of(FaultKind::kTracksFreeze));
  EXPECT_EQ(first.at(1.25)->tracks.at(0).position.x(), 1.25);
  EXPECT_EQ(first.at(1.75)->tracks.at(0).position.x(), 1.25);
}

TEST(TrackFaults, NoiseIsOfItsSizeAndNotOwnedUpTo) {
  Fault fault = of(FaultKind::kTrackNoise);
  fault.position = 0.5;
  fault.velocity = 2.0;
  Sensed sensed(fault);
  double position = 0.0;
  double velocity = 0.0;
  int count = 0;
  for (int k = 0; k < 200; ++k) {
    const double t = 1.0 + 0.0049 * k;
    const auto message = sensed.at(t);
    for (int i = 0; i < kObstacles; ++i, ++count) {
      const planner::base::Track& track = message->tracks[static_cast<std::size_t>(i)];
      position += (track.position - Vec3(10.0 * i + t, 0, 0)).squaredNorm() / 3.0;
      velocity += (track.velocity - Vec3(1, 0, 0)).squaredNorm() / 3.0;
      EXPECT_EQ(track.position_sigma, 0.0);
    }
  }
  // The sequence advances at 20 Hz, so that many draws are the same: a wide band.
  EXPECT_NEAR(std::sqrt(position / count), 0.5, 0.1);
  EXPECT_NEAR(std::sqrt(velocity / count), 2.0, 0.4);
}

TEST(TrackFaults, PairsChangeIds) {
  Sensed sensed(of(FaultKind::kIdSwap));
  std::vector<std::uint64_t> ids;
  const auto message = sensed.at(1.0);
  ASSERT_TRUE(message);
  for (const planner::base::Track& track : message->tracks) ids.push_back(track.id);
  EXPECT_EQ(ids, (std::vector<std::uint64_t>{2, 1, 4, 3, 6, 5, 7}));
}

TEST(TrackFaults, GarbageIsOfEveryKindAndLeavesSomeAlone) {
  Sensed sensed(of(FaultKind::kTracksGarbage));
  bool nan = false;
  bool huge = false;
  bool negative = false;
  int spoiled = 0;
  int good = 0;
  for (int k = 0; k < 20; ++k) {
    const auto message = sensed.at(1.0 + 0.049 * k);
    ASSERT_EQ(message->tracks.size(), static_cast<std::size_t>(kObstacles) + 4);
    for (const planner::base::Track& track : message->tracks) {
      nan = nan || std::isnan(track.position.x());
      huge = huge || track.position.y() == 1e300;
      negative = negative || track.radius < 0.0;
      const bool ok =
          track.position.allFinite() && track.position.y() < 1e5 && track.radius > 0.0 && track.velocity.allFinite();
      EXPECT_FALSE(ok && track.id >= kGarbageIds);
      if (track.id < kGarbageIds) ++(ok ? good : spoiled);
    }
  }
  EXPECT_TRUE(nan && huge && negative);
  EXPECT_GT(spoiled, 40);
  EXPECT_GT(good, 40);
}

TEST(TrackFaults, AFloodIsFarAwayAndHasIdsOfItsOwn) {
  Fault fault = of(FaultKind::kTracksFlood);
  fault.count = 20000;
  Sensed sensed(fault);
  const auto message = sensed.at(1.0);
  ASSERT_EQ(message->tracks.size(), 20000U + kObstacles);
  std::set<std::uint64_t> ids;
  for (const planner::base::Track& track : message->tracks) {
    ids.insert(track.id);
    if (track.id >= kFloodIds) {
      EXPECT_NEAR((track.position - Vec3(1, 2, 3)).norm(), 2000.0, 1e-6);
    }
  }
  EXPECT_EQ(ids.size(), message->tracks.size());
}

TEST(TrackFaults, ATrackOfTheVehicleItself) {
  Sensed sensed(of(FaultKind::kTracksSelf));
  const auto message = sensed.at(1.0, {{4, 5, 6}, {1, 0, 2}});
  ASSERT_EQ(message->tracks.size(), static_cast<std::size_t>(kObstacles) + 1);
  EXPECT_EQ(message->tracks.back().id, kSelfIds);
  EXPECT_EQ(message->tracks.back().position, Vec3(4, 5, 6));
  EXPECT_EQ(message->tracks.back().velocity, Vec3(1, 0, 2));
}

TEST(TrackFaults, AWrongClockIsInTheStampsAlone) {
  Fault fault = of(FaultKind::kTracksClock);
  fault.offset = 3600;
  Sensed sensed(fault);
  const auto message = sensed.at(1.0);
  EXPECT_EQ(message->clock_offset, 3600.0);
  EXPECT_EQ(message->stamp, 1.0);
  EXPECT_EQ(message->tracks.at(0).position.x(), 1.0);
}

}  // namespace
}  // namespace jink::sim::faults
