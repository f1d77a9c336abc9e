// SPDX-License-Identifier: BSD-3-Clause
// Over real DDS transports on this machine: each test is alone in a domain of its own, and waits for discovery.
#include "bridge/dds/tracks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/payload_io.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::dds {
namespace {

using base::SteadyClock;
using planner::base::Track;
using testing::ChildProcess;
using testing::eventually;
using testing::kNaN;
using testing::own_domain;
using tracking::TrackLimits;
using tracking::TrackMessage;
using tracking::TrackValidator;

double unix_now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Track track(std::uint64_t id) {
  Track t;
  t.id = id;
  t.position = {1.0, 2.0, 3.0};
  t.velocity = {0.5, -0.25, 0.125};
  t.acceleration = {0.1, 0.2, -0.3};
  t.radius = 0.4;
  t.position_sigma = 0.05;
  t.velocity_sigma = 0.06;
  return t;
}

class DdsTracks : public ::testing::Test {
 protected:
  // Both ends see each other. What is written before that goes nowhere.
  void match() {
    ASSERT_TRUE(eventually([&] { return reader_.status().writers == 1 && writer_.readers() == 1; }));
  }

  TrackMessage next() {
    TrackMessage message;
    EXPECT_TRUE(eventually([&] { return reader_.poll(message); })) << reader_.status().last_refusal;
    return message;
  }

  SteadyClock clock_;
  int domain_ = own_domain();
  DdsTrackReader reader_{domain_, clock_};
  DdsTrackWriter writer_{domain_};
};

TEST_F(DdsTracks, CarriesEveryFieldInTheMapFrame) {
  match();
  const double before = clock_.now();
  ASSERT_TRUE(writer_.publish(std::vector{track(7)}, unix_now() - 2.0));
  const TrackMessage m = next();
  ASSERT_EQ(m.tracks.size(), 1U);
  const Track& t = m.tracks[0];
  EXPECT_EQ(t.id, 7U);
  EXPECT_EQ(t.position, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(t.velocity, Vec3(0.5, -0.25, 0.125));
  EXPECT_EQ(t.acceleration, Vec3(0.1, 0.2, -0.3));
  EXPECT_EQ(t.radius, 0.4);
  EXPECT_EQ(t.position_sigma, 0.05);
  EXPECT_EQ(t.velocity_sigma, 0.06);
  EXPECT_EQ(t.age, 0.0);
  EXPECT_EQ(m.dropped, 0U);
  EXPECT_GE(m.received, before);
  EXPECT_LE(m.received, clock_.now());
  EXPECT_GE(m.stamp_age, 2.0);
  EXPECT_LT(m.stamp_age, 10.0);
  EXPECT_EQ(reader_.status().messages, 1U);
}

TEST_F(DdsTracks, TurnsTheNedFrameIntoEnu) {
  match();
  ASSERT_TRUE(writer_.publish(std::vector{track(7)}, unix_now(), "ned"));
  const TrackMessage m = next();
  ASSERT_EQ(m.tracks.size(), 1U);
  EXPECT_EQ(m.tracks[0].position, Vec3(2.0, 1.0, -3.0));
  EXPECT_EQ(m.tracks[0].velocity, Vec3(-0.25, 0.5, -0.125));
  EXPECT_EQ(m.tracks[0].acceleration, Vec3(0.2, 0.1, 0.3));
}

TEST_F(DdsTracks, RefusesOtherFramesWholeAndSaysWhich) {
  match();
  ASSERT_TRUE(writer_.publish(std::vector{track(1)}, unix_now(), "base_link\n"));
  ASSERT_TRUE(eventually([&] { return reader_.status().refused == 1; }));
  EXPECT_NE(reader_.status().last_refusal.find("'base_link?'"), std::string::npos) << reader_.status().last_refusal;
  ASSERT_TRUE(writer_.publish(std::vector{track(2)}, unix_now(), ""));
  ASSERT_TRUE(eventually([&] { return reader_.status().refused == 2; }));
  ASSERT_TRUE(writer_.publish(std::vector{track(3)}, unix_now(), "map"));
  EXPECT_EQ(next().tracks.at(0).id, 3U);
  EXPECT_EQ(reader_.status().messages, 1U);
}

TEST_F(DdsTracks, AnEmptyMessageIsAMessage) {
  match();
  ASSERT_TRUE(writer_.publish({}, unix_now()));
  EXPECT_TRUE(next().tracks.empty());
}

TEST_F(DdsTracks, LeavesOutAbsurdTracksAndKeepsTheRest) {
  match();
  const std::vector<std::pair<const char*, std::function<void(Track&)>>> faults{
      {"position", [](Track& t) { t.position.y() = kNaN; }},
      {"position", [](Track& t) { t.position.x() = 1.1e5; }},
      {"position", [](Track& t) { t.position.z() = -std::numeric_limits<double>::infinity(); }},
      {"velocity", [](Track& t) { t.velocity.z() = kNaN; }},
      {"velocity",
       [](Track& t) {
         t.velocity = {800, 800, 0};
       }},
      {"acceleration", [](Track& t) { t.acceleration.x() = kNaN; }},
      {"acceleration", [](Track& t) { t.acceleration.x() = -1001; }},
      {"radius", [](Track& t) { t.radius = 0.0; }},
      {"radius", [](Track& t) { t.radius = -1.0; }},
      {"radius", [](Track& t) { t.radius = 1001.0; }},
      {"radius", [](Track& t) { t.radius = kNaN; }},
      {"position_sigma", [](Track& t) { t.position_sigma = -0.1; }},
      {"position_sigma", [](Track& t) { t.position_sigma = kNaN; }},
      {"velocity_sigma", [](Track& t) { t.velocity_sigma = 1001; }},
      {"velocity_sigma", [](Track& t) { t.velocity_sigma = -1e-9; }},
  };
  std::uint64_t dropped = 0;
  for (const auto& [what, spoil] : faults) {
    std::vector<Track> tracks{track(1), track(2), track(3)};
    spoil(tracks[1]);
    ASSERT_TRUE(writer_.publish(tracks, unix_now()));
    const TrackMessage m = next();
    ASSERT_EQ(m.tracks.size(), 2U) << what;
    EXPECT_EQ(m.tracks[0].id, 1U);
    EXPECT_EQ(m.tracks[1].id, 3U);
    EXPECT_EQ(m.dropped, 1U);
    EXPECT_EQ(reader_.status().dropped_tracks, ++dropped);
    EXPECT_EQ(reader_.status().last_refusal, std::string("track 2: ") + what + " is not finite or out of range");
  }
}

TEST_F(DdsTracks, TakesValuesAtTheLimits) {
  match();
  Track t = track(1);
  t.position = {-TrackLimits::kPosition, 0, 0};
  t.velocity = {0, TrackLimits::kVelocity, 0};
  t.acceleration = {0, 0, -TrackLimits::kAcceleration};
  t.radius = TrackLimits::kRadius;
  t.position_sigma = TrackLimits::kSigma;
  t.velocity_sigma = 0.0;
  ASSERT_TRUE(writer_.publish(std::vector{t}, unix_now()));
  EXPECT_EQ(next().tracks.size(), 1U);
}

// 152 kB: more than one UDP datagram or fragment holds.
TEST_F(DdsTracks, CarriesAThousandTracksInOneMessage) {
  match();
  std::vector<Track> tracks;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    tracks.push_back(track(i));
    tracks.back().position.x() = static_cast<double>(i);
  }
  for (int repeat = 0; repeat < 5; ++repeat) {
    ASSERT_TRUE(writer_.publish(tracks, unix_now()));
    const TrackMessage m = next();
    ASSERT_EQ(m.tracks.size(), 1000U);
    for (std::size_t i = 0; i < 1000; ++i) {
      ASSERT_EQ(m.tracks[i].id, i);
      ASSERT_EQ(m.tracks[i].position.x(), static_cast<double>(i));
    }
  }
}

TEST(TrackValidator, TakesNoMoreThanTheLimitFromOneMessage) {
  TrackMessage m;
  constexpr std::size_t kSent = TrackLimits::kTracksPerMessage + 3;
  TrackValidator validator(m, kSent);
  for (std::size_t i = 0; i < kSent; ++i) validator.add(track(i));
  EXPECT_EQ(m.tracks.size(), TrackLimits::kTracksPerMessage);
  EXPECT_EQ(m.dropped, 3U);
  EXPECT_NE(validator.why().find("20003 tracks"), std::string::npos);
}

TEST_F(DdsTracks, ThrowsTheOldestAwayWhenNobodyPolls) {
  match();
  constexpr std::uint64_t kSent = TrackLimits::kQueuedMessages + 10;
  for (std::uint64_t i = 0; i < kSent; ++i) {
    ASSERT_TRUE(writer_.publish(std::vector{track(i)}, unix_now()));
    ASSERT_TRUE(eventually([&] { return reader_.status().messages == i + 1; }));
  }
  EXPECT_EQ(reader_.overruns(), 10U);
  for (std::uint64_t i = 10; i < kSent; ++i) EXPECT_EQ(next().tracks.at(0).id, i);
  TrackMessage m;
  EXPECT_FALSE(reader_.poll(m));
}

TEST_F(DdsTracks, TellsWritersApartAndCountsThem) {
  match();
  std::set<std::uint64_t> writers;
  {
    DdsTrackWriter second(domain_);
    ASSERT_TRUE(eventually([&] { return reader_.status().writers == 2 && second.readers() == 1; }));
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(writer_.publish(std::vector{track(1)}, unix_now()));
      writers.insert(next().writer);
      ASSERT_TRUE(second.publish(std::vector{track(1)}, unix_now()));
      writers.insert(next().writer);
    }
  }
  EXPECT_EQ(writers.size(), 2U);
  EXPECT_TRUE(eventually([&] { return reader_.status().writers == 1; }));
}

TEST_F(DdsTracks, RefusesAStampThatTheWireCannotHold) {
  EXPECT_FALSE(writer_.publish({}, kNaN));
  EXPECT_FALSE(writer_.publish({}, -1.0));
  EXPECT_FALSE(writer_.publish({}, 3e9));
}

TEST(DdsTrackConstruction, RefusesADomainOutOfRange) {
  const SteadyClock clock;
  EXPECT_THROW(DdsTrackReader(-1, clock), std::runtime_error);
  EXPECT_THROW(DdsTrackReader(233, clock), std::runtime_error);
  EXPECT_THROW(DdsTrackWriter(233), std::runtime_error);
}

// Little-endian CDR of a message of no tracks in frame `map`, but for the number of tracks that it states.
std::vector<unsigned char> stated_length(std::uint32_t count) {
  std::vector<unsigned char> bytes{0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, 'm', 'a', 'p', 0};
  for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<unsigned char>(count >> shift));
  return bytes;
}

TEST(DdsTrackReader, SurvivesMalformedPayloads) {
  const SteadyClock clock;
  const int domain = own_domain();
  DdsTrackReader reader(domain, clock);
  DdsParticipant peer(domain);
  // A reliable writer matches the best-effort reader too.
  PayloadWriter writer(peer, kTracksTopic, kTracksType, {.reliable = true});
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 1 && writer.readers() == 1; }));

  std::vector<std::vector<unsigned char>> bad{
      stated_length(1),            // truncated: a track is stated and none is there
      stated_length(0xffffffffU),  // 650 GB stated
      stated_length(0x7fffffffU),
      {0, 1, 0, 0},
      {0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 'm'},  // a string longer than the payload
      {9, 9, 9, 9, 9, 9, 9, 9},
      {0, 1, 0, 0, 1},
  };
  std::uint64_t sent = 0;
  for (auto& bytes : bad) {
    ASSERT_TRUE(writer.write(bytes));
    ++sent;
    EXPECT_TRUE(eventually([&] { return reader.malformed() >= sent; })) << "payload " << sent;
  }
  auto good = stated_length(0);
  ASSERT_TRUE(writer.write(good));
  TrackMessage message;
  EXPECT_TRUE(eventually([&] { return reader.poll(message); }));
  EXPECT_EQ(reader.malformed(), sent);
  EXPECT_EQ(reader.status().messages, 1U);
}

class OtherVendor : public ::testing::TestWithParam<bool> {};

// Another vendor's writer, with a moving and a standing obstacle, best effort and reliable.
TEST_P(OtherVendor, ReachesTheReader) {
  const SteadyClock clock;
  const int domain = own_domain();
  DdsTrackReader reader(domain, clock);
  const std::string root = JINK_SOURCE_DIR;
  std::vector<std::string> arguments{root + "/.venv/bin/python",
                                     root + "/tests/system/cyclone_tracks.py",
                                     "--domain",
                                     std::to_string(domain),
                                     "--rate",
                                     "50",
                                     "--duration",
                                     "60",
                                     "--frame",
                                     "ned",
                                     "--sigma",
                                     "0.25",
                                     "--obstacle",
                                     "5,6,-1.5,0,-1,0,0.4",
                                     "--obstacle",
                                     "9,2,-2,0,0,0,0.5"};
  if (GetParam()) arguments.emplace_back("--reliable");
  ChildProcess writer(arguments);

  TrackMessage first;
  ASSERT_TRUE(eventually([&] { return reader.poll(first); }, std::chrono::seconds(60)));
  EXPECT_EQ(reader.status().writers, 1);
  TrackMessage later;
  ASSERT_TRUE(eventually([&] { return reader.poll(later) && later.received > first.received + 0.5; }));
  ASSERT_EQ(later.tracks.size(), 2U);
  EXPECT_EQ(later.writer, first.writer);
  EXPECT_EQ(later.tracks[0].id, 1U);
  EXPECT_EQ(later.tracks[0].velocity, Vec3(-1, 0, 0));  // west
  EXPECT_EQ(later.tracks[0].position.y(), 5.0);         // north
  EXPECT_EQ(later.tracks[0].position.z(), 1.5);
  EXPECT_LT(later.tracks[0].position.x(), first.tracks.at(0).position.x() - 0.3);
  EXPECT_EQ(later.tracks[0].radius, 0.4);
  EXPECT_EQ(later.tracks[0].velocity_sigma, 0.25);
  EXPECT_EQ(later.tracks[1].id, 2U);
  EXPECT_EQ(later.tracks[1].position, Vec3(2, 9, 2));
  EXPECT_EQ(reader.status().dropped_tracks + reader.status().refused + reader.malformed(), 0U);
}

INSTANTIATE_TEST_SUITE_P(CycloneDds, OtherVendor, ::testing::Values(false, true),
                         [](const auto& parameter) { return parameter.param ? "Reliable" : "BestEffort"; });

TEST(DdsTrackReader, HearsWhomItIsToHearAndMarksThem) {
  const SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  DdsParticipant front(domain, "front");
  DdsParticipant stranger(domain, "stranger");
  DdsTrackReader reader(node, clock, {.writers = {{"front", 2}}});
  DdsTrackWriter good(front);
  DdsTrackWriter bad(stranger);
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 2 && good.readers() == 1 && bad.readers() == 1; }));
  ASSERT_TRUE(bad.publish({}, unix_now()));
  ASSERT_TRUE(eventually([&] { return reader.status().refused == 1; }));
  EXPECT_EQ(reader.status().last_refusal, "tracks of 'stranger', whom the mission does not name");
  ASSERT_TRUE(good.publish(std::vector{track(7)}, unix_now()));
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
  EXPECT_EQ(message.named, 2U);
  EXPECT_EQ(reader.status().messages, 1U);
}

TEST(DdsTrackReader, ReadsItsNamespaceAlone) {
  EXPECT_EQ(track_topic(TrackFormat::kJink, "uav_1"), "rt/uav_1/jink/obstacle_tracks");
  EXPECT_EQ(track_topic(TrackFormat::kAutoware, "a/b"), "rt/a/b/perception/object_recognition/tracking/objects");
  const SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  DdsTrackReader reader(node, clock, {.name_space = "uav_1"});
  DdsTrackWriter ours(domain, "uav_1");
  DdsTrackWriter theirs(domain, "uav_2");
  DdsTrackWriter nobodys(domain);
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 1 && ours.readers() == 1; }));
  EXPECT_EQ(theirs.readers() + nobodys.readers(), 0);
  ASSERT_TRUE(ours.publish(std::vector{track(7)}, unix_now()));
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
}

TEST(DdsTrackReader, PlacesTracksThatHaveAnOriginOfTheirOwn) {
  const SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  const frames::Geodetic map{47.40, 8.50, 430.0};
  std::mutex mutex;
  std::optional<frames::Geodetic> local;
  DdsTrackReader reader(node, clock, {.origin = map, .local_origin = [&] {
                                        const std::scoped_lock lock(mutex);
                                        return local;
                                      }});
  DdsTrackWriter writer(domain);
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 1 && writer.readers() == 1; }));
  ASSERT_TRUE(writer.publish(std::vector{track(7)}, unix_now()));
  ASSERT_TRUE(eventually([&] { return reader.status().refused == 1; }));  // where that is nobody knows
  {
    const std::scoped_lock lock(mutex);
    local = frames::Geodetic{47.41, 8.50, 400.0};
  }
  ASSERT_TRUE(writer.publish(std::vector{track(7)}, unix_now()));
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
  EXPECT_TRUE(message.placed);
  const Vec3 p = message.tracks.at(0).position;
  EXPECT_NEAR(p.x(), 1.0, 0.01);
  EXPECT_NEAR(p.y(), 2.0 - 1111.9, 1.0);  // a hundredth of a degree to the north
  EXPECT_NEAR(p.z(), 33.0, 0.2);
  EXPECT_NEAR(message.tracks[0].velocity.x(), 0.5, 1e-3);
}

}  // namespace
}  // namespace jink::bridge::dds
