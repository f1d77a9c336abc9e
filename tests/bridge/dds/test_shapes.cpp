// SPDX-License-Identifier: BSD-3-Clause
// The shapes of jink's own tracks on DDS: as sent in either frame, beside writers and readers that know of none, and
// those that are none.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "ObstacleTracks.h"
#include "bridge/cdr/input.hpp"
#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/tracks.hpp"
#include "bridge/tracking/track_table.hpp"
#include "planner/base/solid.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::dds {
namespace {

using planner::base::Body;
using planner::base::Solid;
using planner::base::Track;
using testing::ChildProcess;
using testing::eventually;
using testing::kNaN;
using testing::own_domain;
using testing::python;
using tracking::TrackMessage;
using Message = jink_msgs::msg::dds_::ObstacleTracks_;
using WireShape = jink_msgs::msg::dds_::ObstacleShape_;

Payload bytes_of(const Message& message) {
  Payload payload;
  encode(message, payload);
  return payload;
}

/// `tracks` spheres of a metre with as many boxes in them; none where `shapes` is 0.
Message boxes(std::size_t tracks, std::size_t shapes, const std::string& frame = "map") {
  Message message;
  message.header().frame_id(frame);
  message.tracks().resize(tracks);
  for (auto& track : message.tracks()) track.radius(1.0);
  message.shapes().resize(shapes);
  for (auto& shape : message.shapes()) {
    shape.type(1);
    shape.size().x(1.0);
    shape.size().y(0.5);
    shape.size().z(0.25);
    shape.yaw_rate(0.25);
  }
  return message;
}

/// One of each shape, off its sphere's centre, turned and turning; then a sphere.
std::vector<Track> solids() {
  const Eigen::Matrix3d axes =
      (Eigen::AngleAxisd(0.4, Vec3::UnitX()) * Eigen::AngleAxisd(-0.7, Vec3::UnitY())).toRotationMatrix();
  std::vector<Track> tracks;
  for (const auto& solid :
       {Solid::box({1, 2, 3}, {{0.1, 0.2, 0.3}, axes}), Solid::cylinder(0.5, 4, {{0, 0.1, 0}, axes}),
        Solid::capsule(0.2, {-1, 0, 0.5}, {1, 0.5, 0}),
        Solid::hull({{1, 0, 0}, {0, 1, 0}, {-1, -1, 0.2}, {0, 0, 1}})}) {
    Track track;
    track.id = tracks.size();
    track.radius = solid->reach();
    track.body = {solid, 0.8, -0.25};
    tracks.push_back(track);
  }
  tracks.emplace_back();
  tracks.back().radius = 0.5;
  return tracks;
}

/// How far the body reaches in a direction, as it is turned.
double extent(const Body& body, const Vec3& direction) {
  return body.solid->extent(Eigen::AngleAxisd(-body.yaw, Vec3::UnitZ()) * direction);
}

// The numbers of a message in `ned` are north, east and down: the same ones mean a mirror image's turn.
TEST(DdsShapes, ArriveAsTheyWereSentInEitherFrame) {
  const base::SteadyClock clock;
  const int domain = own_domain();
  DdsTrackReader reader(domain, clock);
  DdsTrackWriter writer(domain);
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 1 && writer.readers() == 1; }));
  const std::vector<Track> sent = solids();
  for (const bool ned : {false, true}) {
    ASSERT_TRUE(writer.publish(sent, system_time(), ned ? "ned" : "map"));
    TrackMessage message;
    ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
    ASSERT_EQ(message.tracks.size(), sent.size());
    for (std::size_t i = 0; i + 1 < sent.size(); ++i) {
      const Body& body = message.tracks[i].body;
      ASSERT_NE(body.solid, nullptr) << i;
      for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.6, 0, -0.8), Vec3(-0.48, 0.6, 0.64)}) {
        const Vec3 there = ned ? Vec3(direction.y(), direction.x(), -direction.z()) : direction;
        EXPECT_NEAR(extent(body, there), extent(sent[i].body, direction), 1e-12) << ned << i;
      }
      EXPECT_EQ(body.yaw_rate, ned ? 0.25 : -0.25);
    }
    EXPECT_EQ(message.tracks.back().body.solid, nullptr);
  }
}

TEST(DdsShapes, OutlastTheTrackTableAndItsFilter) {
  auto decoded = cdr::decode_obstacle_tracks(bytes_of(boxes(1, 1)));
  ASSERT_TRUE(decoded);
  for (const double sigma : {0.0, 0.1}) {
    tracking::TrackTable table(1.0);
    for (int i = 0; i < 3; ++i) {
      decoded->tracks.received = 10.0 + 0.1 * i;
      decoded->tracks.tracks.at(0).position_sigma = sigma;
      table.ingest(decoded->tracks);
    }
    const std::vector<Track> tracks = table.predict(10.6, 0.7);
    ASSERT_EQ(tracks.size(), 1U);
    ASSERT_EQ(tracks[0].body.solid, decoded->tracks.tracks[0].body.solid);
    EXPECT_NEAR(tracks[0].body.yaw, 0.25 * 0.4, 1e-9);  // it has turned on since the last message
  }
}

TEST(DdsShapes, OfManyBoxesTakeNoMoreRoomThanTheyHave) {
  for (const std::string frame : {"map", "n", "ne", "ned"}) {
    const auto decoded = cdr::decode_obstacle_tracks(bytes_of(boxes(100, 100, frame)));
    ASSERT_TRUE(decoded) << frame;
    EXPECT_EQ(decoded->tracks.tracks.size(), 100U);
  }
}

TEST(DdsShapes, AreNoneWhereAWriterDoesNotKnowOfThem) {
  for (const std::size_t tracks : {0U, 2U}) {
    Payload old = bytes_of(boxes(tracks, 0));
    old.resize(old.size() - 4);  // the length of the shapes
    const auto decoded = cdr::decode_obstacle_tracks(old);
    ASSERT_TRUE(decoded);
    ASSERT_EQ(decoded->tracks.tracks.size(), tracks);
    for (const Track& track : decoded->tracks.tracks) EXPECT_EQ(track.body.solid, nullptr);
  }
}

// As the code of Fast DDS reads a type that ends with the tracks.
TEST(DdsShapes, StandBehindAllThatAnOlderReaderKnows) {
  const Payload payload = bytes_of(boxes(3, 3, "ned"));
  std_msgs::msg::dds_::Header_ header;
  std::vector<jink_msgs::msg::dds_::ObstacleTrack_> tracks;
  ASSERT_TRUE(cdr::decode(payload, [&](cdr::CdrInput& input) {
    input.cdr() >> header >> tracks;
    return true;
  }));
  EXPECT_EQ(header.frame_id(), "ned");
  ASSERT_EQ(tracks.size(), 3U);
  EXPECT_EQ(tracks[2].radius(), 1.0);
}

TEST(DdsShapes, AreForAllTracksOrForNone) {
  EXPECT_TRUE(cdr::decode_obstacle_tracks(bytes_of(boxes(2, 0))));
  EXPECT_FALSE(cdr::decode_obstacle_tracks(bytes_of(boxes(2, 1))));
  EXPECT_FALSE(cdr::decode_obstacle_tracks(bytes_of(boxes(2, 3))));
  EXPECT_FALSE(cdr::decode_obstacle_tracks(bytes_of(boxes(0, 1))));
}

TEST(DdsShapes, ThatAreNoneCostTheirTrackAlone) {
  const std::vector<void (*)(WireShape&)> faults{
      [](WireShape& s) { s.size().x(-1.0); },
      [](WireShape& s) { s.size().x(9.0); },  // out of its sphere
      [](WireShape& s) { s.center().z(kNaN); },
      [](WireShape& s) { s.center().z(0.9); },
      [](WireShape& s) { s.orientation().w(0.1); },
      [](WireShape& s) { s.orientation().w(kNaN); },
      [](WireShape& s) { s.yaw_rate(kNaN); },
      [](WireShape& s) { s.yaw_rate(1e9); },
      [](WireShape& s) { s.type(5); },
      [](WireShape& s) { s.type(3); },  // a capsule that is shorter than wide
      [](WireShape& s) { s.type(4); },  // of no vertex
      [](WireShape& s) {
        s.type(4);
        s.vertices().resize(cdr::kMostVertices + 1);
      },
      [](WireShape& s) {
        s.type(4);
        s.vertices().resize(3);
        s.vertices()[1].y(kNaN);
      },
  };
  for (std::size_t i = 0; i < faults.size(); ++i) {
    Message message = boxes(3, 3);
    message.tracks()[1].id(7);
    faults[i](message.shapes()[1]);
    const auto decoded = cdr::decode_obstacle_tracks(bytes_of(message));
    ASSERT_TRUE(decoded) << i;
    EXPECT_EQ(decoded->tracks.tracks.size(), 2U) << i;
    EXPECT_EQ(decoded->tracks.dropped, 1U) << i;
    EXPECT_EQ(decoded->why, "track 7: shape is not finite or out of range") << i;
  }
}

TEST(DdsShapes, AreNothingInATruncatedPayload) {
  Message message = boxes(2, 2);
  message.shapes()[1].type(4);
  message.shapes()[1].vertices().resize(3);
  const Payload whole = bytes_of(message);
  Message spheres = boxes(2, 0);
  const std::size_t tracks_end = bytes_of(spheres).size() - 4;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const bool old = size >= tracks_end && size < tracks_end + 4;
    ASSERT_EQ(cdr::decode_obstacle_tracks(std::span(whole).first(size)).has_value(), old) << size;
  }
}

TEST(DdsShapes, OfTooManyVerticesAreSentAsSpheres) {
  const base::SteadyClock clock;
  const int domain = own_domain();
  DdsTrackReader reader(domain, clock);
  DdsTrackWriter writer(domain);
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 1 && writer.readers() == 1; }));
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i <= cdr::kMostVertices; ++i) vertices.emplace_back(0.001 * static_cast<double>(i), 0.1, 0.2);
  Track track;
  track.radius = 1.0;
  track.body.solid = Solid::hull(vertices);
  ASSERT_TRUE(writer.publish(std::vector{track}, system_time()));
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
  ASSERT_EQ(message.tracks.size(), 1U);
  EXPECT_EQ(message.tracks[0].body.solid, nullptr);
}

TEST(DdsShapes, ComeFromAnotherVendorsWriter) {
  const base::SteadyClock clock;
  const int domain = own_domain();
  DdsTrackReader reader(domain, clock);
  ChildProcess writer({python(), std::string(JINK_SOURCE_DIR) + "/tests/system/cyclone_tracks.py", "--domain",
                       std::to_string(domain), "--duration", "60", "--obstacle", "5,6,1.5,0,0,0,4", "--edges", "1,6,2",
                       "--obstacle", "9,2,2,0,0,0,4"});
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }, std::chrono::seconds(60)));
  ASSERT_EQ(message.tracks.size(), 2U);
  for (const Track& track : message.tracks) {
    ASSERT_NE(track.body.solid, nullptr);
    EXPECT_EQ(track.body.solid->half(), Vec3(0.5, 3.0, 1.0));
  }
  EXPECT_EQ(reader.status().dropped_tracks + reader.status().refused + reader.malformed(), 0U);
}

}  // namespace
}  // namespace jink::bridge::dds
