// SPDX-License-Identifier: BSD-3-Clause
// Detections in space (vision_msgs): each field's meaning, payloads that are none, velocities, and both vendors'
// writers.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "Detections.h"
#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/tracks.hpp"
#include "bridge/tracking/track_table.hpp"
#include "planner/base/solid.hpp"
#include "planner/geometry/validity.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::dds {
namespace {

using cdr::decode_detections;
using planner::base::Track;
using testing::ChildProcess;
using testing::eventually;
using testing::kNaN;
using testing::own_domain;
using testing::python;
using testing::script;
using testing::stamped_payload;
using tracking::TrackMessage;
using Detection = vision_msgs::msg::dds_::Detection3D_;
using Detections = vision_msgs::msg::dds_::Detection3DArray_;

// A box of 6 m, 2 m and 3 m at (1, 2, 3), that heads north (its x axis along the map's y).
Detection detection(const std::string& id) {
  Detection d;
  d.header().frame_id("map");
  d.results().resize(2);
  d.results()[0].hypothesis().class_id("bus");
  d.results()[0].hypothesis().score(0.75);
  d.bbox().center().position().x(1.0);
  d.bbox().center().position().y(2.0);
  d.bbox().center().position().z(3.0);
  d.bbox().center().orientation().z(std::sqrt(0.5));
  d.bbox().center().orientation().w(std::sqrt(0.5));
  d.bbox().size().x(6.0);
  d.bbox().size().y(2.0);
  d.bbox().size().z(3.0);
  d.id(id);
  return d;
}

Payload array_of(const std::vector<Detection>& detections, const std::string& frame = "map") {
  Detections message;
  message.detections(detections);
  return stamped_payload(std::move(message), frame);
}

Track only_track(const Detection& d) {
  const auto message = decode_detections(array_of({d}));
  EXPECT_TRUE(message);
  EXPECT_EQ(message->tracks.tracks.size(), 1U) << message->why;
  return message->tracks.tracks.at(0);
}

TEST(Detections, BecomeTracksWithBoxes) {
  const auto message = decode_detections(array_of({detection("17"), detection("left door")}));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->frame_id, "map");
  EXPECT_DOUBLE_EQ(message->stamp_unix_s, 100.5);
  EXPECT_TRUE(message->tracks.positions_only);
  ASSERT_EQ(message->tracks.tracks.size(), 2U) << message->why;
  const Track& bus = message->tracks.tracks[0];
  EXPECT_EQ(bus.id, 17U);
  EXPECT_EQ(bus.position, Vec3(1, 2, 3));
  EXPECT_DOUBLE_EQ(bus.radius, 3.5);
  ASSERT_NE(bus.body.solid, nullptr);
  EXPECT_TRUE(planner::geometry::is_valid(bus));
  EXPECT_NEAR(bus.body.solid->extent(Vec3::UnitY()), 3.0, 1e-9);
  EXPECT_NEAR(bus.body.solid->extent(Vec3::UnitX()), 1.0, 1e-9);
}

TEST(Detections, HaveTheNumberOrTheHashOfTheirId) {
  EXPECT_EQ(only_track(detection("18446744073709551615")).id, 18446744073709551615U);
  EXPECT_EQ(only_track(detection("a")).id, 0xaf63dc4c8601ec8cU);  // FNV-1a's own test
  EXPECT_NE(only_track(detection("18446744073709551616")).id, 0U);
  EXPECT_NE(only_track(detection("7 ")).id, 7U);
}

TEST(Detections, HaveTheDeviationOfTheirFirstResult) {
  Detection d = detection("1");
  EXPECT_EQ(only_track(d).position_sigma, cdr::kDetectionSigma);
  d.results()[0].pose().covariance()[7] = 0.09;
  d.results()[1].pose().covariance()[0] = 4.0;
  EXPECT_NEAR(only_track(d).position_sigma, 0.3, 1e-12);
  d.results()[0].pose().covariance()[0] = -1.0;  // unknown
  EXPECT_EQ(only_track(d).position_sigma, cdr::kDetectionSigma);
  d.results().clear();
  EXPECT_EQ(only_track(d).position_sigma, cdr::kDetectionSigma);
}

TEST(Detections, MayLackAnOrientationAndAFrameOfTheirOwn) {
  Detection d = detection("1");
  d.header().frame_id("");
  d.bbox().center().orientation().z(0.0);
  d.bbox().center().orientation().w(0.0);
  EXPECT_NEAR(only_track(d).body.solid->extent(Vec3::UnitX()), 3.0, 1e-9);
}

TEST(Detections, AreLeftOutOneByOneWhereTheyAreAbsurd) {
  const std::vector<std::pair<const char*, std::function<void(Detection&)>>> faults{
      {"id is empty", [](Detection& d) { d.id(""); }},
      {"id is empty or that of another", [](Detection& d) { d.id("1"); }},
      {"frame_id is not", [](Detection& d) { d.header().frame_id("camera"); }},
      {"position is not", [](Detection& d) { d.bbox().center().position().y(kNaN); }},
      {"shape is not", [](Detection& d) { d.bbox().center().orientation().w(kNaN); }},
      {"shape is not", [](Detection& d) { d.bbox().size().x(-1.0); }},
      {"shape is not", [](Detection& d) { d.bbox().size().z(kNaN); }},
      {"radius is not",
       [](Detection& d) {
         d.bbox().size().x(0.0);
         d.bbox().size().y(0.0);
         d.bbox().size().z(0.0);
       }},
      {"radius is not", [](Detection& d) { d.bbox().size().x(1e200); }},
      {"position_sigma is not", [](Detection& d) { d.results()[0].pose().covariance()[0] = kNaN; }},
  };
  for (const auto& [what, spoil] : faults) {
    std::vector<Detection> detections{detection("1"), detection("2"), detection("3")};
    spoil(detections[1]);
    const auto message = decode_detections(array_of(detections));
    ASSERT_TRUE(message) << what;
    EXPECT_EQ(message->tracks.tracks.size(), 2U) << what;
    EXPECT_EQ(message->tracks.dropped, 1U) << what;
    EXPECT_NE(message->why.find(std::string(": ") + what), std::string::npos) << message->why;
  }
}

TEST(Detections, AreNothingInATruncatedPayload) {
  const Payload whole = array_of({detection("1"), detection("two")});
  for (std::size_t size = 0; size < whole.size(); ++size)
    ASSERT_FALSE(decode_detections(std::span(whole).first(size))) << size;
}

TEST(Detections, TakeNoMoreRoomThanTheyHave) {
  Detection bare;
  bare.bbox().size().x(1.0);
  const auto message = decode_detections(array_of(std::vector(100, bare)));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->tracks.dropped, 100U);
  Payload lie = array_of({});
  lie[lie.size() - 1] = 0x7f;
  EXPECT_FALSE(decode_detections(lie));
}

// 2 m/s to the north at 10 Hz: after half a second the table knows it, though nobody has said it.
TEST(Detections, GetTheirVelocityFromTheirWay) {
  tracking::TrackTable table(1.0);
  for (int i = 0; i <= 5; ++i) {
    Detection d = detection("1");
    d.bbox().center().position().y(0.2 * i);
    auto message = decode_detections(array_of({d}));
    ASSERT_TRUE(message);
    message->tracks.received = 10.0 + 0.1 * i;
    table.ingest(message->tracks);
    EXPECT_EQ(table.predict(10.0 + 0.1 * i, 0.7).at(0).velocity.isZero(0.0), i == 0);
  }
  const Track track = table.predict(11.0, 0.7).at(0);
  EXPECT_NEAR(track.velocity.y(), 2.0, 0.1);
  EXPECT_NEAR(track.position.y(), 2.0, 0.1);
  EXPECT_LT(track.velocity_sigma, 0.5);
  EXPECT_NE(track.body.solid, nullptr);
}

TEST(DdsDetections, ComeFromReliableWritersAndInTheFrameMapAlone) {
  const base::SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  DdsParticipant peer(domain);
  DdsTrackReader reader(node, clock, {.format = TrackFormat::kVision});
  PayloadWriter writer(peer, kVisionTopic, kVisionType, {.reliable = true});
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 1 && writer.readers() == 1; }));
  ASSERT_TRUE(writer.write(array_of({detection("1")})));
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
  EXPECT_EQ(message.tracks.size(), 1U);
  EXPECT_TRUE(message.positions_only);
  ASSERT_TRUE(writer.write(array_of({detection("1")}, "ned")));
  ASSERT_TRUE(eventually([&] { return reader.status().refused == 1; }));
  EXPECT_EQ(reader.status().last_refusal, "Detection3DArray: frame_id 'ned' is not 'map'");
}

TEST(DdsDetections, ComeFromAnotherVendorsWriter) {
  const base::SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  DdsTrackReader reader(node, clock, {.format = TrackFormat::kVision});
  ChildProcess peer({python(), script("cyclone_detections.py"), "--domain", std::to_string(domain)});
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }, std::chrono::seconds(60)));
  ASSERT_EQ(message.tracks.size(), 2U);
  EXPECT_EQ(reader.malformed() + reader.status().refused + reader.status().dropped_tracks, 0U);
  EXPECT_LT(std::abs(message.stamp_age), 60.0);
  EXPECT_EQ(message.tracks[0].id, 5U);
  EXPECT_EQ(message.tracks[0].position, Vec3(1, 2, 3));
  EXPECT_DOUBLE_EQ(message.tracks[0].radius, 3.0);
  EXPECT_NEAR(message.tracks[0].position_sigma, 0.5, 1e-12);
  EXPECT_NEAR(message.tracks[0].body.solid->extent(Vec3::UnitY()), 2.0, 1e-9);
  EXPECT_EQ(message.tracks[1].position, Vec3(4, 5, 6));
}

}  // namespace
}  // namespace jink::bridge::dds
