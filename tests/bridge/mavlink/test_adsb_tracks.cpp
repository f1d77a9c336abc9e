// SPDX-License-Identifier: BSD-3-Clause
// ADS-B reports into tracks, by hand-worked cases.
#include "bridge/mavlink/adsb_tracks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "bridge/tracking/track_inbox.hpp"
#include "tests/support/bridge_fakes.hpp"

namespace jink::bridge::mavlink {
namespace {

using frames::Geodetic;
using frames::LocalFrame;
using testing::FakeClock;
using tracking::TrackMessage;

constexpr std::uint32_t kAllValid = 1 | 2 | 4 | 8 | 128;

class AdsbTracksTest : public ::testing::Test {
 protected:
  // An aircraft at `position`, flying `speed` along `heading_deg`.
  AdsbReport report(std::uint32_t icao, const Vec3& position) {
    const Geodetic place = LocalFrame(*origin_).to_geodetic(position);
    AdsbReport r;
    r.received = clock_.now();
    r.system = 1;
    r.component = 156;
    r.icao_address = icao;
    r.latitude_deg = place.latitude_deg;
    r.longitude_deg = place.longitude_deg;
    r.altitude_m = place.altitude_m;
    r.heading_deg = 90.0;
    r.horizontal_velocity = 40.0;
    r.vertical_velocity = -3.0;
    r.emitter_type = 1;
    r.flags = kAllValid;
    return r;
  }
  TrackMessage message(const AdsbReport& r) {
    queue_.push_back(r);
    TrackMessage m;
    EXPECT_TRUE(tracks_.poll(m));
    return m;
  }
  void expect_refused(const AdsbReport& r, const std::string& why) {
    queue_.push_back(r);
    TrackMessage m;
    const auto before = tracks_.status().dropped_tracks;
    EXPECT_FALSE(tracks_.poll(m)) << why;
    EXPECT_EQ(tracks_.status().dropped_tracks, before + 1) << why;
    EXPECT_EQ(tracks_.status().last_refusal, "ADS-B aircraft " + std::to_string(r.icao_address) + ": " + why);
  }

  FakeClock clock_;
  std::optional<Geodetic> origin_ = Geodetic{47.3977418, 8.5455939, 488.0};
  std::deque<AdsbReport> queue_;
  AdsbTracks tracks_{[this](AdsbReport& r) {
                       if (queue_.empty()) return false;
                       r = queue_.front();
                       queue_.pop_front();
                       return true;
                     },
                     [this] { return origin_; }, clock_};
};

TEST_F(AdsbTracksTest, AnAircraftIsPlacedWithTheOrigin) {
  const TrackMessage m = message(report(0xABCDEF, {300.0, -200.0, 50.0}));
  EXPECT_EQ(m.writer, AdsbTracks::kWriter);
  EXPECT_EQ(m.stamp_age, 0.0);
  ASSERT_EQ(m.tracks.size(), 1U);
  const auto& t = m.tracks[0];
  EXPECT_EQ(t.id, 0xABCDEFU);
  EXPECT_NEAR((t.position - Vec3(300.0, -200.0, 50.0)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((t.velocity - Vec3(40.0, 0.0, -3.0)).norm(), 0.0, 1e-9);  // heading 90 is east
  EXPECT_EQ(t.radius, 10.0 + 2.0 * 25.0);
  EXPECT_NEAR(t.position_sigma, 25.0, 1e-9);  // 15 and 20, barometric
  EXPECT_EQ(t.velocity_sigma, AdsbTracks::kVelocitySigma);
  EXPECT_EQ(t.age, 0.0);
  EXPECT_EQ(tracks_.status().writers, 1);
  EXPECT_EQ(tracks_.status().messages, 1U);
}

// A light aircraft was passed 11 m from its centre: the planner's margin for what is uncertain ends at 0.8 m.
TEST_F(AdsbTracksTest, WhatIsUncertainOfAnAircraftIsKeptClearOf) {
  AdsbReport r = report(7, {300.0, -200.0, 50.0});
  EXPECT_EQ(message(r).tracks.at(0).radius, 10.0 + 2.0 * std::hypot(15.0, 20.0));
  r.emitter_type = 14;
  r.altitude_type = 1;
  EXPECT_EQ(message(r).tracks.at(0).radius, 5.0 + 2.0 * std::hypot(15.0, 40.0));
}

TEST_F(AdsbTracksTest, CrewedAircraftAreToldAsSuch) {
  for (std::uint32_t type = 0; type < 20; ++type) {
    AdsbReport r = report(7, {300.0, -200.0, 50.0});
    r.emitter_type = type;
    const bool crewed = type != 14 && type != 17 && type != 18 && type != 19;
    EXPECT_EQ(message(r).aircraft.size(), crewed ? 1U : 0U) << type;
  }
  AdsbReport r = report(0x3C6666, {300.0, -200.0, 50.0});
  r.since_contact = 2.0;
  r.flags = kAllValid & ~128U;
  clock_.time += 1.0;
  const auto crewed = message(r).aircraft.back();
  EXPECT_EQ(crewed.icao_address, 0x3C6666U);
  EXPECT_EQ(crewed.stamp, r.received - 2.0);
  EXPECT_NEAR((crewed.position - Vec3(300.0, -200.0, 50.0)).norm(), 0.0, 1e-6);  // where it was then
  EXPECT_NEAR((crewed.velocity - Vec3(40.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(crewed.horizontal_sigma, 15.0);
  EXPECT_EQ(crewed.vertical_sigma, 20.0);
  EXPECT_EQ(crewed.climb_sigma, AdsbTracks::kClimbSigma);
}

TEST_F(AdsbTracksTest, TheVehiclesOwnTransponderIsNoAircraft) {
  std::deque<AdsbReport> echo{report(0x3C6666, {0.0, 0.0, 10.0})};
  AdsbTracks tracks(
      [&](AdsbReport& r) {
        if (echo.empty()) return false;
        r = echo.front();
        echo.pop_front();
        return true;
      },
      [this] { return origin_; }, clock_, 0x3C6666);
  TrackMessage m;
  EXPECT_FALSE(tracks.poll(m));
  EXPECT_EQ(tracks.status().dropped_tracks, 0U);  // nothing to be told of
  echo.push_back(report(0x3C6667, {0.0, 0.0, 10.0}));
  EXPECT_TRUE(tracks.poll(m));
}

TEST_F(AdsbTracksTest, AGeometricAltitudeIsLessCertain) {
  AdsbReport r = report(1, {0.0, 0.0, 100.0});
  r.altitude_type = 1;
  EXPECT_NEAR(message(r).tracks.at(0).position_sigma, std::hypot(15.0, 40.0), 1e-9);
}

TEST_F(AdsbTracksTest, TheFlagsSayWhatIsKnownOfTheVelocity) {
  AdsbReport r = report(1, {0.0, 0.0, 100.0});
  r.flags = kAllValid & ~4U;  // no course: the speed may be along any
  auto t = message(r).tracks.at(0);
  EXPECT_EQ(t.velocity, Vec3(0.0, 0.0, -3.0));
  EXPECT_NEAR(t.velocity_sigma, std::hypot(2.0, 40.0), 1e-9);
  r.flags = kAllValid & ~8U;  // no speed: a light aircraft's
  t = message(r).tracks.at(0);
  EXPECT_EQ(t.velocity, Vec3(0.0, 0.0, -3.0));
  EXPECT_NEAR(t.velocity_sigma, std::hypot(2.0, 80.0), 1e-9);
  r.flags = kAllValid & ~128U;  // no climb
  t = message(r).tracks.at(0);
  EXPECT_NEAR((t.velocity - Vec3(40.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(t.velocity_sigma, std::hypot(2.0, 5.0), 1e-9);
  r.flags = kAllValid;
  r.heading_deg = std::numeric_limits<double>::quiet_NaN();  // valid by its flag alone
  EXPECT_EQ(message(r).tracks.at(0).velocity, Vec3(0.0, 0.0, -3.0));
}

TEST_F(AdsbTracksTest, WhatCannotBePlacedIsLeftOutAndSaid) {
  const AdsbReport good = report(7, {10.0, 0.0, 100.0});
  const auto changed = [&](auto change) {
    AdsbReport r = good;
    change(r);
    return r;
  };
  expect_refused(changed([](AdsbReport& r) { r.flags &= ~1U; }), "no valid coordinates");
  expect_refused(changed([](AdsbReport& r) { r.latitude_deg = 91.0; }), "no valid coordinates");
  expect_refused(changed([](AdsbReport& r) { r.longitude_deg = std::nan(""); }), "no valid coordinates");
  expect_refused(changed([](AdsbReport& r) { r.flags &= ~2U; }), "no valid altitude");
  expect_refused(changed([](AdsbReport& r) { r.altitude_m = std::nan(""); }), "no valid altitude");
  expect_refused(changed([](AdsbReport& r) { r.latitude_deg += 1.0; }), "too far away");
  expect_refused(changed([](AdsbReport& r) { r.since_contact = 30.0; }), "not heard by its receiver for too long");
  expect_refused(changed([](AdsbReport& r) { r.since_contact = std::nan(""); }),
                 "not heard by its receiver for too long");
  origin_.reset();
  expect_refused(good, "the autopilot's local origin is not known yet");
}

// Found by tests/fuzz/fuzz_telemetry: after 4 s its uncertainty was beyond what the track table takes.
TEST_F(AdsbTracksTest, AnAircraftOfUnknownVelocityStaysAUsableTrackAsLongAsItIsInView) {
  AdsbReport r = report(1, {0.0, 0.0, 100.0});
  r.flags = 1 | 2;
  r.emitter_type = 0;  // its class is not told either
  auto track = message(r).tracks.at(0);
  for (const double seconds : {1.0, 4.5, 5.9}) {
    clock_.time = r.received + seconds;
    TrackMessage later;
    ASSERT_TRUE(tracks_.poll(later)) << seconds;
    ASSERT_EQ(later.tracks.size(), 1U) << seconds;
    EXPECT_EQ(tracking::refusal(later.tracks[0]), nullptr) << seconds;
    EXPECT_GT(later.tracks[0].position_sigma, track.position_sigma - 1e-9);
    track = later.tracks[0];
  }
}

TEST_F(AdsbTracksTest, AMessageHoldsAllInViewPredictedToNow) {
  (void)message(report(2, {0.0, 0.0, 100.0}));
  clock_.time += 2.0;
  AdsbReport late = report(1, {500.0, 0.0, 100.0});
  late.since_contact = 1.0;
  const TrackMessage m = message(late);
  ASSERT_EQ(m.tracks.size(), 2U);
  EXPECT_EQ(m.tracks[0].id, 1U);
  EXPECT_NEAR((m.tracks[0].position - Vec3(540.0, 0.0, 97.0)).norm(), 0.0, 1e-6);
  EXPECT_EQ(m.tracks[0].age, 1.0);
  EXPECT_NEAR((m.tracks[1].position - Vec3(80.0, 0.0, 94.0)).norm(), 0.0, 1e-6);
  EXPECT_EQ(m.tracks[1].age, 2.0);
  EXPECT_NEAR(m.tracks[1].position_sigma, std::hypot(25.0, 2.0 * 2.0, 2.0 * 2.0 * 2.0 / 2.0), 1e-9);
  EXPECT_NEAR(m.tracks[1].velocity_sigma, std::hypot(2.0, 4.0), 1e-9);
}

TEST_F(AdsbTracksTest, AnAircraftStaysInViewForAWhileAndThenGoes) {
  (void)message(report(2, {0.0, 0.0, 100.0}));
  TrackMessage m;
  EXPECT_FALSE(tracks_.poll(m));
  clock_.time += AdsbTracks::kRepeat_s;
  ASSERT_TRUE(tracks_.poll(m));
  EXPECT_EQ(m.tracks.size(), 1U);
  EXPECT_FALSE(tracks_.poll(m));
  clock_.time += AdsbTracks::kKeep_s;
  EXPECT_FALSE(tracks_.poll(m));
  EXPECT_EQ(tracks_.status().writers, 1);
  clock_.time += AdsbTracks::kSender_s;
  EXPECT_FALSE(tracks_.poll(m));
  EXPECT_EQ(tracks_.status().writers, 0);
}

TEST(EmitterModel, TheUnknownIsTheLargest) {
  for (std::uint32_t type = 0; type < 300; ++type) {
    const auto model = emitter_model(type);
    EXPECT_GT(model.radius, 0.0);
    EXPECT_LE(model.radius, emitter_model(0).radius);
  }
  EXPECT_EQ(emitter_model(14).radius, 5.0);
}

}  // namespace
}  // namespace jink::bridge::mavlink
