// SPDX-License-Identifier: BSD-3-Clause
// Autoware's tracked objects: each field's meaning, payloads that are none, and both vendors' writers.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "TrackedObjects.h"
#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/tracks.hpp"
#include "planner/base/solid.hpp"
#include "planner/geometry/validity.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::dds {
namespace {

using base::SteadyClock;
using cdr::decode_tracked_objects;
using planner::base::Track;
using testing::ChildProcess;
using testing::eventually;
using testing::kNaN;
using testing::own_domain;
using testing::python;
using testing::script;
using testing::stamped_payload;
using tracking::TrackMessage;
using Object = autoware_perception_msgs::msg::dds_::TrackedObject_;
using Objects = autoware_perception_msgs::msg::dds_::TrackedObjects_;

enum Shape : std::uint8_t { kBox = 0, kCylinder = 1, kPolygon = 2 };

// At (1, 2, 3), heading north (its x axis along the map's y), 2 m/s ahead and 1 m/s to its left, accelerating ahead.
Object object(std::uint8_t id = 1) {
  Object o;
  o.object_id().uuid()[15] = id;
  o.existence_probability(0.9F);
  o.classification().resize(2);
  o.kinematics().pose_with_covariance().pose().position().x(1.0);
  o.kinematics().pose_with_covariance().pose().position().y(2.0);
  o.kinematics().pose_with_covariance().pose().position().z(3.0);
  o.kinematics().pose_with_covariance().pose().orientation().z(std::sin(std::numbers::pi / 4));
  o.kinematics().pose_with_covariance().pose().orientation().w(std::cos(std::numbers::pi / 4));
  o.kinematics().twist_with_covariance().twist().linear().x(2.0);
  o.kinematics().twist_with_covariance().twist().linear().y(1.0);
  o.kinematics().acceleration_with_covariance().accel().linear().x(0.5);
  o.kinematics().orientation_availability(2);
  o.shape().type(kBox);
  o.shape().dimensions().x(4.0);
  o.shape().dimensions().y(4.0);
  o.shape().dimensions().z(2.0);
  return o;
}

Payload payload_of(const std::vector<Object>& objects, const std::string& frame = "map") {
  Objects message;
  message.objects(objects);
  return stamped_payload(std::move(message), frame);
}

Track track_of(const Object& o) {
  const auto message = decode_tracked_objects(payload_of({o}));
  EXPECT_TRUE(message);
  EXPECT_EQ(message->tracks.tracks.size(), 1U) << message->why;
  return message->tracks.tracks.at(0);
}

TEST(AutowareObjects, BecomeTracks) {
  const auto message = decode_tracked_objects(payload_of({object(1), object(2)}, "somewhere"));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->frame_id, "somewhere");
  EXPECT_DOUBLE_EQ(message->stamp_unix_s, 100.5);
  ASSERT_EQ(message->tracks.tracks.size(), 2U);
  EXPECT_EQ(message->why, "");
  const Track& t = message->tracks.tracks[0];
  EXPECT_EQ(t.position, Vec3(1, 2, 3));
  EXPECT_LT((t.velocity - Vec3(-1, 2, 0)).norm(), 1e-12) << t.velocity.transpose();
  EXPECT_LT((t.acceleration - Vec3(0, 0.5, 0)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(t.radius, 3.0);
  EXPECT_EQ(t.position_sigma, 0.0);
  EXPECT_NE(t.id, message->tracks.tracks[1].id);
  EXPECT_EQ(t.id, track_of(object(1)).id);
}

TEST(AutowareObjects, HaveTheRadiusOfTheSphereAroundTheirShape) {
  Object o = object();
  o.shape().dimensions().x(6.0);
  o.shape().dimensions().y(2.0);
  o.shape().dimensions().z(3.0);
  EXPECT_DOUBLE_EQ(track_of(o).radius, 3.5);
  o.shape().type(kCylinder);  // 3 m of radius, 8 m high
  o.shape().dimensions().y(6.0);
  o.shape().dimensions().z(8.0);
  EXPECT_DOUBLE_EQ(track_of(o).radius, 5.0);
  o.shape().type(kPolygon);
  o.shape().footprint().points().resize(3);
  o.shape().footprint().points()[1].x(1.0F);
  o.shape().footprint().points()[2].y(-3.0F);
  EXPECT_DOUBLE_EQ(track_of(o).radius, 5.0);
  o.shape().footprint().points().clear();
  o.shape().dimensions().z(7.0);
  EXPECT_DOUBLE_EQ(track_of(o).radius, 5.5);  // no footprint: the box around it
}

// A bus that is turned by a right angle is long along north, whatever its sphere.
TEST(AutowareObjects, AreSolidsAsTheyAreTurned) {
  Object o = object();
  o.shape().dimensions().x(12.0);
  o.shape().dimensions().y(2.0);
  o.shape().dimensions().z(3.0);
  auto& orientation = o.kinematics().pose_with_covariance().pose().orientation();
  orientation.x(0.0);
  orientation.y(0.0);
  orientation.z(std::sqrt(0.5));
  orientation.w(std::sqrt(0.5));
  o.kinematics().twist_with_covariance().twist().angular().z(0.3);
  const Track bus = track_of(o);
  ASSERT_NE(bus.body.solid, nullptr);
  EXPECT_TRUE(planner::geometry::is_valid(bus));
  EXPECT_NEAR(bus.body.solid->extent(Vec3::UnitY()), 6.0, 1e-9);
  EXPECT_NEAR(bus.body.solid->extent(Vec3::UnitX()), 1.0, 1e-9);
  EXPECT_DOUBLE_EQ(bus.body.yaw_rate, 0.3);
  o.shape().type(kCylinder);
  o.shape().dimensions().y(12.0);
  EXPECT_NEAR(track_of(o).body.solid->extent(Vec3(0.6, 0.8, 0.0)), 6.0, 1e-9);
  EXPECT_NEAR(track_of(o).body.solid->extent(Vec3::UnitZ()), 1.5, 1e-9);
  o.shape().type(kPolygon);
  o.shape().footprint().points().resize(3);
  o.shape().footprint().points()[1].x(2.0F);
  o.shape().footprint().points()[2].y(1.0F);
  const Track wedge = track_of(o);
  EXPECT_TRUE(planner::geometry::is_valid(wedge));
  EXPECT_NEAR(wedge.body.solid->extent(Vec3::UnitY()), 2.0, 1e-9);
  EXPECT_NEAR(wedge.body.solid->extent(-Vec3::UnitX()), 1.0, 1e-9);
  EXPECT_NEAR(wedge.body.solid->extent(-Vec3::UnitY()), 0.0, 1e-9);
  o.shape().footprint().points().resize(65);
  EXPECT_EQ(track_of(o).body.solid, nullptr);  // its sphere
  o = object();
  o.kinematics().twist_with_covariance().twist().angular().z(11.0);
  EXPECT_EQ(track_of(o).body.solid, nullptr);
}

TEST(AutowareObjects, HaveTheLargestDeviationOfTheirCovariances) {
  Object o = object();
  auto& position = o.kinematics().pose_with_covariance().covariance();
  position[0] = 0.05;  // x and y correlated: 0.09 along one diagonal, 0.01 along the other
  position[7] = 0.05;
  position[1] = position[6] = 0.04;
  position[35] = 100.0;  // of the yaw, which is no position
  auto& velocity = o.kinematics().twist_with_covariance().covariance();
  velocity[14] = 4.0;
  EXPECT_NEAR(track_of(o).position_sigma, 0.3, 1e-12);
  EXPECT_NEAR(track_of(o).velocity_sigma, 2.0, 1e-12);
  position[14] = velocity[0] = velocity[7] = 1e9;  // no information in these directions
  EXPECT_NEAR(track_of(o).position_sigma, 0.3, 1e-6);
  EXPECT_NEAR(track_of(o).velocity_sigma, 2.0, 1e-6);
  position[0] = -1.0;  // unknown
  EXPECT_EQ(track_of(o).position_sigma, 0.0);
}

TEST(AutowareObjects, NeedAnOrientationForTheirVelocityUnlessTheyHaveNone) {
  Object o = object();
  auto& orientation = o.kinematics().pose_with_covariance().pose().orientation();
  orientation.z(0.0);
  orientation.w(0.0);
  EXPECT_TRUE(decode_tracked_objects(payload_of({o}))->tracks.tracks.empty());
  o.kinematics().orientation_availability(0);
  EXPECT_EQ(track_of(o).velocity, Vec3(2, 1, 0));
}

TEST(AutowareObjects, AreLeftOutOneByOneWhereTheyAreAbsurd) {
  const std::vector<std::pair<const char*, std::function<void(Object&)>>> faults{
      {"position", [](Object& o) { o.kinematics().pose_with_covariance().pose().position().y(kNaN); }},
      {"velocity", [](Object& o) { o.kinematics().twist_with_covariance().twist().linear().x(1e300); }},
      {"velocity", [](Object& o) { o.kinematics().pose_with_covariance().pose().orientation().w(kNaN); }},
      {"position_sigma", [](Object& o) { o.kinematics().pose_with_covariance().covariance()[0] = kNaN; }},
      {"velocity_sigma", [](Object& o) { o.kinematics().twist_with_covariance().covariance()[7] = kNaN; }},
      {"radius", [](Object& o) { o.shape().dimensions().x(-1.0); }},
      {"radius", [](Object& o) { o.shape().dimensions().z(kNaN); }},
      {"radius", [](Object& o) { o.shape().type(3); }},
      {"radius",
       [](Object& o) {
         o.shape().type(kPolygon);
         o.shape().footprint().points().resize(2);
         o.shape().footprint().points()[0].x(std::numeric_limits<float>::quiet_NaN());
       }},
  };
  for (const auto& [what, spoil] : faults) {
    std::vector<Object> objects{object(1), object(2), object(3)};
    spoil(objects[1]);
    const auto message = decode_tracked_objects(payload_of(objects));
    ASSERT_TRUE(message) << what;
    EXPECT_EQ(message->tracks.tracks.size(), 2U) << what;
    EXPECT_EQ(message->tracks.dropped, 1U);
    EXPECT_NE(message->why.find(std::string(": ") + what + " is not"), std::string::npos) << message->why;
  }
}

TEST(AutowareObjects, AreNothingInATruncatedPayload) {
  Object o = object();
  o.shape().footprint().points().resize(2);
  const Payload whole = payload_of({o, o});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_FALSE(decode_tracked_objects(std::span(whole).first(size))) << size;
  }
}

TEST(AutowareObjects, AreNothingWhereALengthCannotBe) {
  // Encapsulation 4, stamp 8, "map" 8: the number of objects stands at 20; then UUID, probability, labels at 44.
  for (const std::size_t at : {std::size_t{20}, std::size_t{44}}) {
    for (const std::uint8_t high : {std::uint8_t{0x7f}, std::uint8_t{0xff}, std::uint8_t{0x01}}) {
      Payload payload = payload_of({object()});
      ASSERT_EQ(payload[at], at == 20 ? 1 : 2);
      payload[at + 3] = high;
      EXPECT_FALSE(decode_tracked_objects(payload));
    }
  }
}

TEST(DdsAutowareReader, TakesReliableWritersAndRefusesOtherFrames) {
  const SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  DdsParticipant peer(domain);
  DdsTrackReader reader(node, clock, {.format = TrackFormat::kAutoware});
  PayloadWriter writer(peer, kAutowareTopic, kAutowareType, {.reliable = true});
  ASSERT_TRUE(eventually([&] { return reader.status().writers == 1 && writer.readers() == 1; }));
  const double before = clock.now();
  ASSERT_TRUE(writer.write(payload_of({object()})));
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
  EXPECT_EQ(message.tracks.size(), 1U);
  EXPECT_GE(message.received, before);
  EXPECT_NEAR(message.stamp_age, system_time() - 100.5, 60.0);
  ASSERT_TRUE(writer.write(payload_of({object()}, "base_link")));
  ASSERT_TRUE(eventually([&] { return reader.status().refused == 1; }));
  EXPECT_EQ(reader.status().last_refusal, "TrackedObjects: frame_id 'base_link' is not 'map'");
  ASSERT_TRUE(writer.write(Payload{0, 1, 0, 0, 1, 2, 3}));
  ASSERT_TRUE(eventually([&] { return reader.malformed() == 1; }));
  ASSERT_TRUE(writer.write(payload_of({})));
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }));
  EXPECT_TRUE(message.tracks.empty());
  EXPECT_EQ(reader.status().messages, 2U);
}

TEST(DdsAutowareReader, TakesAnotherVendorsWriter) {
  const SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  DdsTrackReader reader(node, clock, {.format = TrackFormat::kAutoware});
  ChildProcess peer({python(), script("cyclone_autoware.py"), "--domain", std::to_string(domain)});
  TrackMessage message;
  ASSERT_TRUE(eventually([&] { return reader.poll(message); }, std::chrono::seconds(60)));
  ASSERT_EQ(message.tracks.size(), 2U);
  EXPECT_EQ(reader.malformed() + reader.status().refused + reader.status().dropped_tracks, 0U);
  EXPECT_LT(std::abs(message.stamp_age), 60.0);
  const Track& box = message.tracks[0];
  EXPECT_EQ(box.position, Vec3(1, 2, 3));
  EXPECT_LT((box.velocity - Vec3(-1, 2, 0)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(box.radius, 3.0);
  EXPECT_NEAR(box.position_sigma, 0.5, 1e-12);
  EXPECT_EQ(message.tracks[1].position, Vec3(4, 5, 6));
  EXPECT_DOUBLE_EQ(message.tracks[1].radius, 5.0);
  EXPECT_NE(box.id, message.tracks[1].id);
}

}  // namespace
}  // namespace jink::bridge::dds
