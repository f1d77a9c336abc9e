// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/track_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace jink::bridge::tracking {
namespace {

using planner::base::Track;

constexpr double kCoast = 1.0;

Track track(std::uint64_t id, const Vec3& position, const Vec3& velocity = Vec3::Zero(),
            const Vec3& acceleration = Vec3::Zero()) {
  Track t;
  t.id = id;
  t.position = position;
  t.velocity = velocity;
  t.acceleration = acceleration;
  t.radius = 0.5;
  return t;
}

TrackMessage message(double received, double stamp_age, std::vector<Track> tracks, std::uint64_t writer = 1) {
  return {{writer, received, stamp_age}, std::move(tracks), 0};
}

/// A writer at 20 Hz of one track at x = t, as it was `delay` before each reception; its stamps are off by `offset`.
void feed(TrackTable& table, double from, double to, double delay, double offset) {
  for (double t = from; t < to - 1e-9; t += 0.05) {
    table.ingest(message(t, delay + offset, {track(1, {t - delay, 0, 0}, {1, 0, 0})}));
  }
}

double error_of(TrackTable& table, double now) {
  const auto tracks = table.predict(now, 1.0);
  return tracks.size() == 1 ? std::abs(tracks[0].position.x() - now) : planner::base::kInfinity;
}

TEST(TrackTable, IsEmptyAtFirst) {
  TrackTable table(kCoast);
  EXPECT_TRUE(table.predict(5.0, 1.0).empty());
  EXPECT_FALSE(table.newest_message());
}

TEST(TrackTable, PredictsFromTheMeasurementNotFromTheReception) {
  TrackTable table(kCoast);
  table.ingest(message(10.0, 0.2, {track(7, {1, 2, 3}, {1, -2, 0.5})}));
  const auto tracks = table.predict(10.3, 1.0);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].id, 7U);
  EXPECT_NEAR((tracks[0].position - Vec3(1.5, 1, 3.25)).norm(), 0.0, 1e-12);
  EXPECT_EQ(tracks[0].velocity, Vec3(1, -2, 0.5));
  EXPECT_NEAR(tracks[0].age, 0.5, 1e-12);
  EXPECT_EQ(tracks[0].radius, 0.5);
  EXPECT_EQ(table.newest_message(), 10.0);
}

// Velocities that nobody told are the table's to find, and what stands still afterwards is seen to stand.
TEST(TrackTable, FindsTheVelocitiesOfPositions) {
  TrackTable table(kCoast);
  const auto tell = [&](double t, double x) {
    TrackMessage told = message(t, 0.1, {track(1, {x, 0, 0}), track(2, {0, x, 0}, {9, 9, 9})});
    told.positions_only = true;
    for (Track& each : told.tracks) each.position_sigma = 0.05;
    table.ingest(told);
  };
  for (int i = 0; i < 20; ++i) tell(10.0 + 0.1 * i, 0.1 * i);
  auto tracks = table.predict(12.0, 1.0);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_LT((tracks[0].velocity - Vec3(1, 0, 0)).norm(), 0.05);
  EXPECT_LT((tracks[1].velocity - Vec3(0, 1, 0)).norm(), 0.05);
  EXPECT_GT(tracks[0].velocity_sigma, 0.03);
  EXPECT_NEAR(tracks[0].position.x(), 2.1, 0.1);
  for (int i = 20; i < 40; ++i) tell(10.0 + 0.1 * i, 1.9);
  EXPECT_GT(table.counts().frozen_messages, 0U);
  EXPECT_LT(table.counts().frozen_messages, 6U);
  tracks = table.predict(14.0, 1.0);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_LT(tracks[0].velocity.norm(), 0.1);
  EXPECT_NEAR(tracks[0].position.x(), 1.9, 0.1);
}

TEST(TrackTable, TrustsAnAccelerationForAWhileOnly) {
  TrackTable table(kCoast);
  table.ingest(message(10.0, 0.0, {track(1, {0, 0, 0}, {1, 0, 0}, {2, 0, 0})}));
  const Track within = table.predict(10.5, 0.7)[0];
  EXPECT_NEAR(within.position.x(), 0.5 + 0.25, 1e-12);
  EXPECT_NEAR(within.velocity.x(), 2.0, 1e-12);
  EXPECT_EQ(within.acceleration.x(), 2.0);
  const Track beyond = table.predict(10.9, 0.7)[0];
  EXPECT_NEAR(beyond.position.x(), (0.7 + 0.49) + 0.2 * 2.4, 1e-12);
  EXPECT_NEAR(beyond.velocity.x(), 2.4, 1e-12);
  EXPECT_EQ(beyond.acceleration.x(), 0.0);
}

// Somebody walks, and turns round at once.
TEST(TrackTable, TellsOfATrackNearTheVehicleHowSuddenlyItChanged) {
  TrackTable table(kCoast);
  for (int i = 0; i < 40; ++i) {
    const double t = 10.0 + 0.05 * i;
    const double x = std::min(0.05 * i, 2.0 - 0.05 * i);
    if (i > 0) table.find_self(t, {50.0, 0, 0}, Vec3::Zero(), 0.3);
    table.ingest(message(t, 0.0, {track(1, {30.0 + x, 0, 0}, {i < 20 ? 1.0 : -1.0, 0, 0}), track(2, {0, x, 0})}));
    if (i == 19) {
      EXPECT_NEAR(table.predict(t, 1.0).at(0).sudden_change, 0.0, 1e-9);
    }
  }
  const auto tracks = table.predict(12.0, 1.0);
  EXPECT_NEAR(tracks.at(0).sudden_change, 2.0, 0.25);
  EXPECT_EQ(tracks.at(1).sudden_change, 0.0) << "too far away to be watched";
}

TEST(TrackTable, ATrackThatGoesMissingCoastsAndThenGoes) {
  TrackTable table(kCoast);
  table.ingest(message(10.0, 0.0, {track(1, {0, 0, 0}, {1, 0, 0}), track(2, {5, 0, 0})}));
  table.ingest(message(10.5, 0.0, {track(2, {5, 0, 0})}));
  EXPECT_EQ(table.predict(10.99, 1.0).size(), 2U);
  EXPECT_NEAR(table.predict(10.99, 1.0)[0].position.x(), 0.99, 1e-9);
  const auto later = table.predict(11.01, 1.0);
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(later[0].id, 2U);
  EXPECT_TRUE(table.predict(11.51, 1.0).empty());
  EXPECT_EQ(table.newest_message(), 10.5);
}

TEST(TrackTable, KeepsTwoWritersTracksOfTheSameIdApart) {
  TrackTable table(kCoast);
  table.ingest(message(10.0, 0.0, {track(1, {1, 0, 0}), track(2, {2, 0, 0})}, 100));
  table.ingest(message(10.0, 0.0, {track(1, {-1, 0, 0})}, 200));
  const auto tracks = table.predict(10.0, 1.0);
  ASSERT_EQ(tracks.size(), 3U);
  EXPECT_EQ(tracks[0].position.x(), 1.0);
  EXPECT_EQ(tracks[1].position.x(), 2.0);
  EXPECT_EQ(tracks[2].position.x(), -1.0);
  EXPECT_NE(tracks[2].id, tracks[0].id);
  EXPECT_NE(tracks[2].id, tracks[1].id);
}

TEST(TrackTable, IgnoresAMessageThatWasOvertaken) {
  TrackTable table(kCoast);
  table.ingest(message(10.00, 0.02, {track(1, {1, 0, 0})}));
  table.ingest(message(10.05, 0.02, {track(1, {2, 0, 0})}));
  table.ingest(message(10.06, 0.08, {track(1, {1.5, 0, 0})}));  // measured before the second
  const auto tracks = table.predict(10.06, 1.0);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].position.x(), 2.0);
  EXPECT_NEAR(tracks[0].age, 0.03, 1e-9);
}

// An offset cannot be told from a delay: what is left is the smallest delay seen, here 30 ms at 1 m/s.
TEST(TrackTable, WorksWithAClockThatIsOffByAnHourInEitherDirection) {
  for (const double offset : {3600.0, -3600.0, 1.5, -0.5}) {
    SCOPED_TRACE(offset);
    TrackTable table(kCoast);
    feed(table, 10.0, 12.0, 0.03, offset);
    EXPECT_LE(error_of(table, 12.0), 0.03 + 1e-9);
    EXPECT_GT(table.counts().clock_offsets, 0U);
    // A message that is held up for 0.4 s more is known to be.
    table.ingest(message(12.4, 0.43 + offset, {track(1, {11.97, 0, 0}, {1, 0, 0})}));
    EXPECT_LE(error_of(table, 12.4), 0.03 + 1e-9);
    EXPECT_NEAR(table.predict(12.4, 1.0)[0].age, 0.4, 1e-9);
  }
}

TEST(TrackTable, BelievesStampsThatMakeSense) {
  TrackTable table(kCoast);
  feed(table, 10.0, 12.0, 0.25, 0.0);
  EXPECT_LE(error_of(table, 12.0), 1e-9);
  EXPECT_EQ(table.counts().clock_offsets, 0U);
  EXPECT_EQ(table.counts().late_messages, 0U);
}

// One of the clocks is set in flight: until that is certain the tracks count as silent, then they are right again.
TEST(TrackTable, LearnsTheOffsetAnewWhenAClockIsSet) {
  for (const auto& [before, after] : {std::pair{-3600.0, 0.0}, {0.0, 3600.0}, {0.0, -3600.0}, {3600.0, 0.0}}) {
    SCOPED_TRACE(before);
    TrackTable table(kCoast);
    feed(table, 10.0, 12.0, 0.03, before);
    feed(table, 12.0, 14.0, 0.03, after);
    EXPECT_LE(error_of(table, 14.0), 0.03 + 1e-9);
    EXPECT_NEAR(table.newest_message().value(), 13.95, 1e-9);
  }
}

// By less than a delay may be: what tells the two apart is that stamps go back.
TEST(TrackTable, AStepOfAClockIsNoDelay) {
  for (const double step : {0.3, 0.6, 0.9, -0.6}) {
    SCOPED_TRACE(step);
    TrackTable table(kCoast);
    feed(table, 10.0, 12.0, 0.03, 0.0);
    feed(table, 12.0, 12.15, 0.03, step);  // three messages
    EXPECT_LE(error_of(table, 12.15), 0.03 + 1e-9);
    feed(table, 12.15, 20.0, 0.03, step);
    EXPECT_LE(error_of(table, 20.0), 0.03 + 1e-9);
    feed(table, 20.0, 30.0, 0.03, 0.0);  // and back
    EXPECT_LE(error_of(table, 30.0), 0.03 + 1e-9);
  }
}

TEST(TrackTable, ADelayThatGrowsIsNoStepOfAClock) {
  TrackTable table(kCoast);
  feed(table, 10.0, 12.0, 0.03, 0.0);
  feed(table, 12.6, 16.0, 0.63, 0.0);
  EXPECT_LE(error_of(table, 16.0), 1e-9);
}

TEST(TrackTable, OneThatWasOvertakenIsLeftOut) {
  TrackTable table(kCoast);
  feed(table, 10.0, 12.0, 0.03, 0.0);
  table.ingest(message(11.96, 0.53, {track(1, {11.43, 0, 0}, {1, 0, 0})}));
  feed(table, 12.0, 14.0, 0.03, 0.0);
  EXPECT_LE(error_of(table, 14.0), 1e-9);
}

TEST(TrackTable, OneWrongStampDoesNotSpoilTheRest) {
  TrackTable table(kCoast);
  feed(table, 10.0, 11.0, 0.03, 0.0);
  feed(table, 11.0, 11.05, 0.03, -3600.0);
  feed(table, 11.05, 14.0, 0.03, 0.0);
  EXPECT_LE(error_of(table, 14.0), 0.03 + 1e-9);
}

// The link stood for two seconds and everything comes at once: old messages make nothing fresh.
TEST(TrackTable, ABurstOfOldMessagesIsNotTakenForThePresent) {
  TrackTable table(kCoast);
  feed(table, 10.0, 11.0, 0.03, 0.0);
  for (double stamp = 11.0; stamp < 13.0; stamp += 0.05) {
    table.ingest(message(13.0, 13.0 - stamp, {track(1, {stamp, 0, 0}, {1, 0, 0})}));
    if (stamp < 11.9) {
      ASSERT_NEAR(table.newest_message().value(), 10.95, 1e-9) << stamp;
    }
  }
  EXPECT_LE(error_of(table, 13.0), 1e-9);
  EXPECT_GT(table.counts().late_messages, 0U);
}

// A tracker that hangs and publishes its last message again and again.
TEST(TrackTable, TheSamePictureAgainAndAgainGoesStale) {
  TrackTable table(kCoast);
  feed(table, 10.0, 12.0, 0.03, 0.0);
  for (double t = 12.0; t < 20.0; t += 0.05) table.ingest(message(t, t - 11.92, {track(1, {11.92, 0, 0}, {1, 0, 0})}));
  EXPECT_LE(table.newest_message().value(), 11.92 + ClockOffsetEstimator::kLongestDelay + 0.1);
  EXPECT_TRUE(table.predict(20.0, 1.0).empty());
}

// The same with fresh stamps: what moves cannot be where it was.
TEST(TrackTable, AFrozenPictureWithFreshStampsGoesStale) {
  TrackTable table(kCoast);
  const Track still = track(2, {5, 5, 0});
  for (double t = 10.0; t < 12.0; t += 0.05) table.ingest(message(t, 0.03, {track(1, {t, 0, 0}, {1, 0, 0}), still}));
  const Track stuck = track(1, {11.99, 0, 0}, {1, 0, 0});
  table.ingest(message(12.0, 0.03, {stuck, still}));
  for (double t = 12.05; t < 15.0; t += 0.05) {  // longer than the tracks coast
    table.ingest(message(t, 0.03, {stuck, still}));
    if (t < 12.5) {
      EXPECT_NEAR(table.predict(t, 1.0)[0].position.x(), t, 0.1);  // predicted on meanwhile
    }
  }
  EXPECT_EQ(table.newest_message(), 12.0);
  EXPECT_GT(table.counts().frozen_messages, 50U);
  EXPECT_TRUE(table.predict(15.0, 1.0).empty());
}

// Nobody says that it is gone.
TEST(TrackTable, WhatAMissedWriterToldLivesOn) {
  TrackTable table(kCoast);
  table.ingest(message(10.0, 0.0, {track(1, {0, 0, 0}, {1, 0, 0}), track(2, {0, 9, 0})}));
  table.ingest(message(10.5, 0.0, {track(2, {0, 9, 0})}));  // and no more of the first
  table.ingest(message(10.0, 0.0, {track(3, {5, 0, 0}, {1, 0, 0})}, 2));
  table.miss(true);
  EXPECT_EQ(table.predict(11.6, 1.0).size(), 3U);
  table.ingest(message(12.0, 0.0, {track(2, {0, 9, 0})}));
  const auto tracks = table.predict(14.0, 1.0);
  ASSERT_EQ(tracks.size(), 2U);  // the first writer went on without its first
  EXPECT_EQ(tracks[0].id, 2U);
  EXPECT_NEAR(tracks[1].position.x(), 9.0, 1e-9);
  EXPECT_EQ(table.predict(20.5, 1.0).size(), 1U);  // there is an end to it
  table.miss(false);                               // somebody else watches
  EXPECT_TRUE(table.predict(20.6, 1.0).empty());
}

TEST(TrackTable, APictureOfWhatStandsStillIsNotFrozen) {
  TrackTable table(kCoast);
  for (double t = 10.0; t < 12.0; t += 0.05) table.ingest(message(t, 0.03, {track(2, {5, 5, 0})}));
  EXPECT_EQ(table.counts().frozen_messages, 0U);
  EXPECT_EQ(table.predict(12.0, 1.0).size(), 1U);
}

TEST(TrackTable, LeavesOutWhatIsNoTrackAndCountsIt) {
  TrackTable table(kCoast);
  const double nan = std::nan("");
  std::vector<Track> bad(9, track(7, {1, 1, 1}));
  bad[0].position.x() = nan;
  bad[1].position.y() = 1e300;
  bad[2].velocity.z() = planner::base::kInfinity;
  bad[3].acceleration.x() = nan;
  bad[4].radius = 0.0;
  bad[5].radius = nan;
  bad[6].position_sigma = -1.0;
  bad[7].velocity_sigma = nan;
  bad[8].velocity.x() = 2000.0;
  bad.push_back(track(8, {2, 2, 2}));
  table.ingest(message(10.0, 0.0, bad));
  ASSERT_EQ(table.predict(10.0, 1.0).size(), 1U);
  EXPECT_EQ(table.predict(10.0, 1.0)[0].id, 8U);
  EXPECT_EQ(table.counts().invalid_tracks, 9U);
}

TEST(TrackTable, IsBoundedAndMakesRoomWhenTracksGo) {
  TrackTable table(kCoast);
  std::vector<Track> many;
  for (std::uint64_t id = 0; id < TrackTable::kMost + 100; ++id) {
    many.push_back(track(id, {static_cast<double>(id), 0, 0}));
  }
  table.ingest(message(10.0, 0.0, many));
  EXPECT_EQ(table.predict(10.0, 1.0).size(), TrackTable::kMost);
  EXPECT_EQ(table.counts().surplus_tracks, 100U);
  table.ingest(message(11.5, 0.0, {track(1'000'000, {0, 0, 0})}));
  EXPECT_EQ(table.predict(11.5, 1.0).size(), 1U);
}

// A tracker that sees the vehicle too, 10 cm off, while an obstacle passes closely.
TEST(TrackTable, TellsTheVehiclesOwnTrack) {
  TrackTable table(kCoast);
  const Vec3 velocity(2, 0, 0);
  for (double t = 10.0; t < 11.0; t += 0.05) {
    const Vec3 own = (t - 10.0) * velocity;
    table.ingest(message(t, 0.0,
                         {track(1, own + Vec3(0, 0.1, 0), velocity), track(2, own + Vec3(0, 0.6, 0), velocity),
                          track(3, {1, 0, 0}, -velocity)}));
    table.find_self(t, own, velocity, 0.3);
    const auto seen = table.predict(t, 1.0);
    ASSERT_EQ(seen.size(), own.norm() <= TrackTable::kSelfWay ? 3U : 2U) << t;
    EXPECT_EQ(seen[seen.size() - 2].id, 2U);
  }
  EXPECT_EQ(table.own_tracks(), 1);
  // It leaves: then it is somebody else.
  table.ingest(message(11.05, 0.0, {track(1, {2, 2, 0}, velocity)}));
  table.find_self(11.05, {2.1, 0, 0}, velocity, 0.3);
  EXPECT_EQ(table.own_tracks(), 0);
}

// A pole beside a vehicle that hangs there, and somebody who walks up to it.
TEST(TrackTable, WhatStandsBesideAHangingVehicleIsNotItsOwnTrack) {
  TrackTable table(kCoast);
  for (double t = 10.0; t < 13.0; t += 0.05) {
    Track pole = track(1, {0.25, 0, 0});
    pole.position_sigma = 0.3;
    Track walker = track(2, {1.4 - 0.5 * (t - 10.0), 0, 0}, {-0.5, 0, 0});
    walker.position_sigma = 0.3;
    table.ingest(message(t, 0.0, {pole, walker}));
    table.find_self(t, Vec3::Zero(), Vec3::Zero(), 0.3);
    ASSERT_EQ(table.predict(t, 1.0).size(), 2U);
  }
}

TEST(TrackTable, ManyTracksOfTwoWritersThatNumberAlikeAllLive) {
  TrackTable table(kCoast);
  std::vector<Track> many;
  for (std::uint64_t id = 0; id < 5000; ++id) many.push_back(track(id, {static_cast<double>(id), 0, 0}));
  table.ingest(message(10.0, 0.0, many, 1));
  table.ingest(message(10.0, 0.0, many, 2));
  std::set<std::uint64_t> ids;
  for (const Track& t : table.predict(10.0, 1.0)) ids.insert(t.id);
  EXPECT_EQ(ids.size(), 10000U);
}

// Messages of a writer that sees nothing.
void speak(TrackTable& table, std::uint64_t writer, double from, double to) {
  for (double t = from; t < to; t += 0.1) table.ingest(message(t, 0.0, {}, writer));
}

TEST(TrackTable, AWriterThatFallsSilentIsLostUnlessAnotherTakesItsPlace) {
  TrackTable table(kCoast);
  speak(table, 1, 10.0, 15.0);
  speak(table, 2, 10.0, 20.0);
  EXPECT_EQ(table.lost_writers(15.5, 1.0, 12.0), 0);
  EXPECT_EQ(table.lost_writers(19.95, 1.0, 12.0), 1);
  EXPECT_EQ(table.lost_writers(19.95, 1.0, 16.0), 0);  // before the flight
  speak(table, 3, 20.0, 20.15);
  EXPECT_EQ(table.lost_writers(20.2, 1.0, 12.0), 0);
  EXPECT_EQ(table.lost_writers(25.0, 1.0, 12.0), 2);  // 1 and 2: 3 said nothing more
}

// While the old one still counts as live the new one speaks already; then that falls silent, and a third comes.
TEST(TrackTable, AStandbyThatTakesOverAtOnceIsNoneTooMany) {
  TrackTable table(kCoast);
  speak(table, 1, 10.0, 15.0);
  speak(table, 2, 15.3, 20.0);
  speak(table, 3, 20.3, 25.0);
  for (double t = 15.0; t < 25.0; t += 0.1) EXPECT_EQ(table.lost_writers(t, 1.0, 12.0), 0) << t;
  EXPECT_EQ(table.lost_writers(26.5, 1.0, 12.0), 1);
}

TEST(TrackTable, AStrangersWordIsNoWatch) {
  TrackTable table(kCoast);
  speak(table, 1, 10.0, 20.0);
  speak(table, 2, 12.0, 12.05);
  TrackMessage aircraft = message(12.0, 0.0, {}, 3);
  aircraft.sends_when_empty = false;
  table.ingest(aircraft);
  EXPECT_EQ(table.lost_writers(19.95, 1.0, 11.0), 0);
}

TEST(TrackTable, KnowsWhenTheMissionsWritersSpokeLast) {
  TrackTable table(kCoast);
  EXPECT_FALSE(table.newest_of(1));
  TrackMessage named = message(10.0, 0.0, {}, 1);
  named.named = 1;
  table.ingest(named);
  named.writer = 2;
  named.received = 11.0;
  table.ingest(named);
  table.ingest(message(12.0, 0.0, {}, 3));
  EXPECT_EQ(table.newest_of(1), 11.0);
  EXPECT_FALSE(table.newest_of(2));
}

TEST(TrackTable, AWriterThatDoesNotStampIsTakenAsPrompt) {
  TrackTable table(kCoast);
  for (double t = 10.0; t < 15.0; t += 0.05) table.ingest(message(t, 1.8e9 + t, {track(1, {t, 0, 0}, {1, 0, 0})}));
  EXPECT_LE(error_of(table, 15.0), 1e-6);
  EXPECT_GT(table.counts().clock_offsets, 50U);
}

TEST(TrackTable, EachWriterHasItsOwnClock) {
  TrackTable table(kCoast);
  for (double t = 10.0; t < 12.0; t += 0.05) {
    table.ingest(message(t, 0.2, {track(1, {t - 0.2, 0, 0}, {1, 0, 0})}, 1));
    table.ingest(message(t, -3600.0, {track(2, {t, 5, 0}, {1, 0, 0})}, 2));
  }
  const auto tracks = table.predict(12.0, 1.0);
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_NEAR(tracks[0].position.x(), 12.0, 1e-9);
  EXPECT_NEAR(tracks[1].position.x(), 12.0, 1e-9);
}

}  // namespace
}  // namespace jink::bridge::tracking
