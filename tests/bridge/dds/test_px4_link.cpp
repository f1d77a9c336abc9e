// SPDX-License-Identifier: BSD-3-Clause
// PX4's DDS topics: the three layouts of its local position, what they mean, and both directions over real transports,
// to Fast DDS's writers and to another vendor's.
#include "bridge/dds/px4_link.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "Px4.h"
#include "bridge/cdr/px4_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::dds {
namespace {

using base::SteadyClock;
using cdr::px4::decode_local_position;
using cdr::px4::LocalPosition;
using cdr::px4::LocalPositionFilter;
using testing::ChildProcess;
using testing::eventually;
using testing::kNaN;
using testing::ManualClock;
using testing::own_domain;
using testing::python;
using testing::script;
using vehicle::CommandReport;
using vehicle::Setpoint;
using vehicle::VehicleState;
using WirePosition = px4_msgs::msg::dds_::VehicleLocalPosition_;

constexpr float kNaNf = std::numeric_limits<float>::quiet_NaN();

// All valid, 5 m north, 2 m east, 10 m up; moving north, east and down; heading east.
WirePosition wire_position() {
  WirePosition w;
  w.timestamp(1'000'000);
  w.xy_valid(true);
  w.z_valid(true);
  w.v_xy_valid(true);
  w.v_z_valid(true);
  w.x(5.0F);
  w.y(2.0F);
  w.z(-10.0F);
  w.delta_xy({0.5F, -0.25F});
  w.xy_reset_counter(3);
  w.delta_z(-1.5F);
  w.z_reset_counter(7);
  w.vx(1.0F);
  w.vy(2.0F);
  w.vz(0.5F);
  w.vxy_reset_counter(9);
  w.vz_reset_counter(11);
  w.heading(static_cast<float>(std::numbers::pi / 2));
  w.heading_var(0.01F);
  w.unaided_heading(kNaNf);
  w.heading_good_for_control(true);
  w.xy_global(true);
  w.z_global(true);
  w.ref_lat(47.397743);
  w.ref_lon(8.545594);
  w.ref_alt(489.5F);
  w.eph(0.5F);
  w.epv(0.3F);
  w.dead_reckoning(true);
  w.hagl_max_xy(std::numeric_limits<float>::infinity());
  return w;
}

// The same in the older layouts, written field by field as their .msg files have them.
Payload old_payload(bool version_0) {
  const WirePosition w = wire_position();
  Payload payload(4096);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());
  eprosima::fastcdr::Cdr out(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
  const std::uint8_t count = 0;
  out.serialize_encapsulation();
  out << w.timestamp() << w.timestamp_sample() << w.xy_valid() << w.z_valid() << w.v_xy_valid() << w.v_z_valid();
  out << w.x() << w.y() << w.z() << 0.5F << -0.25F << w.xy_reset_counter() << w.delta_z() << w.z_reset_counter();
  out << w.vx() << w.vy() << w.vz() << 0.0F << 0.0F << 0.0F << count << 0.0F << count << 0.0F << 0.0F << 0.0F;
  out << w.heading();
  if (version_0) out << 0.01F;
  out << kNaNf << 0.0F << count << w.heading_good_for_control();
  if (version_0) out << 0.02F;
  out << w.xy_global() << w.z_global() << w.ref_timestamp() << w.ref_lat() << w.ref_lon() << w.ref_alt();
  if (version_0) {
    out << false << 0.0F << 0.0F << 0.0F << count << count;
  } else {
    out << 0.0F << false << count;
  }
  out << w.eph() << w.epv() << 0.1F << 0.1F << w.dead_reckoning() << 0.0F << 0.0F << 0.0F << 0.0F;
  payload.resize(out.getSerializedDataLength());
  return payload;
}

Payload new_payload(const WirePosition& wire = wire_position()) {
  Payload payload;
  encode(wire, payload);
  return payload;
}

void expect_is_the_position(const std::optional<LocalPosition>& m) {
  ASSERT_TRUE(m);
  EXPECT_EQ(m->timestamp_us, 1'000'000U);
  EXPECT_TRUE(m->xy_valid && m->z_valid && m->v_xy_valid && m->v_z_valid);
  EXPECT_EQ(m->position_ned, Vec3(5, 2, -10));
  EXPECT_EQ(m->velocity_ned, Vec3(1, 2, 0.5));
  EXPECT_EQ(m->shift_ned, Vec3(0.5, -0.25, -1.5));
  EXPECT_EQ(m->xy_resets, 3);
  EXPECT_EQ(m->z_resets, 7);
  EXPECT_NEAR(m->heading, std::numbers::pi / 2, 1e-6);
  EXPECT_TRUE(m->global);
  EXPECT_EQ(m->origin, (frames::Geodetic{47.397743, 8.545594, 489.5}));
  EXPECT_NEAR(m->horizontal_accuracy, 0.5, 1e-6);
  EXPECT_NEAR(m->vertical_accuracy, 0.3, 1e-6);
  EXPECT_TRUE(m->dead_reckoning);
}

TEST(Px4LocalPosition, IsReadInEachOfItsLayouts) {
  expect_is_the_position(decode_local_position(new_payload()));
  expect_is_the_position(decode_local_position(old_payload(true)));
  expect_is_the_position(decode_local_position(old_payload(false)));
}

TEST(Px4LocalPosition, IsReadInBigEndianToo) {
  Payload payload(4096);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());
  eprosima::fastcdr::Cdr out(buffer, eprosima::fastcdr::Cdr::BIG_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
  out.serialize_encapsulation();
  wire_position().serialize(out);
  payload.resize(out.getSerializedDataLength());
  expect_is_the_position(decode_local_position(payload));
}

TEST(Px4LocalPosition, IsNothingInAnyOtherLength) {
  const Payload whole = new_payload();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const bool other_layout = size == 4 + 192 || size == 4 + 212;
    EXPECT_EQ(decode_local_position(std::span(whole).first(size)).has_value(), other_layout) << size;
  }
  Payload longer = whole;
  longer.resize(longer.size() + 4);
  EXPECT_FALSE(decode_local_position(longer));
}

TEST(Px4LocalPosition, IsNothingWithABooleanThatIsNone) {
  Payload payload = new_payload();
  payload[4 + 16] = 7;  // xy_valid
  EXPECT_FALSE(decode_local_position(payload));
  payload = new_payload();
  payload[0] = 9;  // no encapsulation known
  EXPECT_FALSE(decode_local_position(payload));
}

LocalPosition valid_position() {
  LocalPosition m;
  m.xy_valid = m.z_valid = m.v_xy_valid = m.v_z_valid = true;
  return m;
}

VehicleState state_of(const LocalPositionFilter& filter, double now) {
  VehicleState state;
  filter.apply(state, now);
  return state;
}

TEST(Px4LocalPositionFilter, GivesTheStateInEnu) {
  LocalPositionFilter filter;
  EXPECT_FALSE(state_of(filter, 3.0).motion.heard());
  EXPECT_FALSE(state_of(filter, 3.0).local_position_ok);
  ASSERT_TRUE(filter.update(*decode_local_position(new_payload()), 2.5, 2.5));
  const VehicleState s = state_of(filter, 3.0);
  EXPECT_EQ(s.motion.stamp, 2.5);
  EXPECT_EQ(s.motion.value.position, Vec3(2, 5, 10));
  EXPECT_EQ(s.motion.value.velocity, Vec3(2, 1, -0.5));
  EXPECT_NEAR(s.yaw, 0.0, 1e-6);  // east
  EXPECT_TRUE(s.local_position_ok);
  EXPECT_EQ(s.health, "dead reckoning");
  EXPECT_EQ(s.estimate_resets, 0U);  // before the first position
  EXPECT_NEAR(s.position_sigma, 0.5 / std::numbers::sqrt2, 1e-6);
  ASSERT_TRUE(s.origin);
  EXPECT_EQ(s.origin->latitude_deg, 47.397743);
}

TEST(Px4LocalPositionFilter, LetsTheStampAgeWhereAnythingIsNotValid) {
  for (bool LocalPosition::*const flag :
       {&LocalPosition::xy_valid, &LocalPosition::z_valid, &LocalPosition::v_xy_valid, &LocalPosition::v_z_valid}) {
    LocalPositionFilter filter;
    ASSERT_TRUE(filter.update(valid_position(), 1.0, 1.0));
    LocalPosition bad = valid_position();
    bad.*flag = false;
    bad.position_ned = {kNaN, 7.0, 7.0};  // what is not valid may be anything
    ASSERT_TRUE(filter.update(bad, 1.1, 1.1));
    const VehicleState s = state_of(filter, 1.1);
    EXPECT_EQ(s.motion.stamp, 1.0);
    EXPECT_EQ(s.motion.value.position, Vec3::Zero());
    EXPECT_FALSE(s.local_position_ok);
    EXPECT_EQ(s.health, "local position");
  }
}

TEST(Px4LocalPositionFilter, SaysWhatIsMissing) {
  LocalPositionFilter filter;
  LocalPosition m = valid_position();
  m.heading = kNaN;
  ASSERT_TRUE(filter.update(m, 1.0, 1.0));
  EXPECT_FALSE(state_of(filter, 1.0).local_position_ok);
  EXPECT_EQ(state_of(filter, 1.0).health, "heading");
  EXPECT_EQ(state_of(filter, 1.0).yaw, 0.0);
  EXPECT_FALSE(state_of(filter, 1.0).origin);
  ASSERT_TRUE(filter.update(valid_position(), 2.0, 2.0));
  EXPECT_TRUE(state_of(filter, 2.0 + LocalPositionFilter::kMaxAge_s).local_position_ok);
  EXPECT_EQ(state_of(filter, 2.0).health, "");
  EXPECT_FALSE(state_of(filter, 2.01 + LocalPositionFilter::kMaxAge_s).local_position_ok);
}

// As on the ground, before the yaw was aligned in flight.
TEST(Px4LocalPositionFilter, HoldsAPositionWhoseHeadingIsNotGoodForControl) {
  WirePosition wire = wire_position();
  wire.heading_good_for_control(false);
  wire.dead_reckoning(false);
  LocalPositionFilter filter;
  ASSERT_TRUE(filter.update(*decode_local_position(new_payload(wire)), 1.0, 1.0));
  EXPECT_TRUE(state_of(filter, 1.0).local_position_ok);
  EXPECT_EQ(state_of(filter, 1.0).health, "");
  EXPECT_NEAR(state_of(filter, 1.0).yaw, 0.0, 1e-6);
}

TEST(Px4LocalPositionFilter, RefusesValuesThatCannotBe) {
  LocalPositionFilter filter;
  ASSERT_TRUE(filter.update(valid_position(), 1.0, 1.0));
  std::vector<LocalPosition> bad(6, valid_position());
  bad[0].position_ned.y() = kNaN;
  bad[1].position_ned.x() = 2e5;
  bad[2].velocity_ned.z() = std::numeric_limits<double>::infinity();
  bad[3].velocity_ned.x() = -1001.0;
  bad[4].global = true;
  bad[4].origin.latitude_deg = 91.0;
  bad[5].global = true;
  bad[5].origin.altitude_m = kNaN;
  for (const LocalPosition& m : bad) EXPECT_FALSE(filter.update(m, 2.0, 2.0));
  EXPECT_EQ(state_of(filter, 2.0).motion.stamp, 1.0);
}

TEST(Px4LocalPositionFilter, CountsAJumpByWhatTheMessageSays) {
  LocalPositionFilter filter;
  LocalPosition m = valid_position();
  m.xy_resets = 255;
  m.shift_ned = {9, 9, 9};  // of long ago
  ASSERT_TRUE(filter.update(m, 1.0, 1.0));
  EXPECT_EQ(state_of(filter, 1.0).estimate_resets, 0U);
  m.xy_resets = 0;  // the counter wraps
  m.shift_ned = {3.0, -1.0, 9.0};
  ASSERT_TRUE(filter.update(m, 1.02, 1.02));
  EXPECT_EQ(state_of(filter, 1.02).estimate_resets, 1U);
  EXPECT_EQ(state_of(filter, 1.02).estimate_shift, Vec3(-1.0, 3.0, 0.0));
  m.z_resets = 1;
  m.shift_ned = {3.0, -1.0, -2.0};
  ASSERT_TRUE(filter.update(m, 1.04, 1.04));
  EXPECT_EQ(state_of(filter, 1.04).estimate_resets, 2U);
  EXPECT_EQ(state_of(filter, 1.04).estimate_shift, Vec3(-1.0, 3.0, 2.0));
  ASSERT_TRUE(filter.update(m, 1.06, 1.06));
  EXPECT_EQ(state_of(filter, 1.06).estimate_resets, 2U);
}

TEST(Px4LocalPositionFilter, CountsJumpsThatItMissedByWhatThePositionDid) {
  LocalPositionFilter filter;
  LocalPosition m = valid_position();
  m.velocity_ned = {2.0, 0.0, 0.0};
  ASSERT_TRUE(filter.update(m, 1.0, 1.0));
  m.position_ned = {1.0 + 4.0, 0.0, 0.0};  // 0.5 s at 2 m/s, and two jumps of which the message tells one
  m.shift_ned = {1.0, 0.0, 0.0};
  m.xy_resets = 2;
  ASSERT_TRUE(filter.update(m, 1.5, 1.5));
  EXPECT_EQ(state_of(filter, 1.5).estimate_resets, 2U);
  EXPECT_NEAR(state_of(filter, 1.5).estimate_shift.y(), 4.0, 1e-12);
}

TEST(Px4Topic, HasTheAgentsNamespace) {
  EXPECT_EQ(px4_topic("", "out/vehicle_local_position"), "rt/fmu/out/vehicle_local_position");
  EXPECT_EQ(px4_topic("px4_1", "in/trajectory_setpoint"), "rt/px4_1/fmu/in/trajectory_setpoint");
  EXPECT_EQ(px4_topic("/a/b/", "in/x"), "rt/a/b/fmu/in/x");
  EXPECT_EQ(px4_topic("/", "in/x"), "rt/fmu/in/x");
}

class UnderlyingLink final : public vehicle::VehicleLink {
 public:
  VehicleState state() override { return underlying; }
  bool send(const Setpoint& setpoint) override {
    sent.push_back(setpoint);
    return true;
  }
  void request(vehicle::Command command) override { requested.push_back(command); }
  std::optional<CommandReport> next_report() override { return CommandReport{.detail = "from below"}; }

  VehicleState underlying;
  std::vector<Setpoint> sent;
  std::vector<vehicle::Command> requested;
};

class Px4Dds : public ::testing::Test {
 protected:
  DdsVehicleLink link(const DdsVehicleOptions& options) { return {under_, node_, clock_, options}; }
  PayloadWriter position_writer(const std::string& topic, const WriterQos& qos) {
    return {peer_, topic, kLocalPositionType, qos};
  }

  const int domain_ = own_domain();
  ManualClock clock_;
  UnderlyingLink under_;
  DdsParticipant node_{domain_};
  DdsParticipant peer_{domain_, "autopilot"};
};

TEST_F(Px4Dds, TakesPositionsFromPx4sWritersAndTheRestFromTheLinkUnderneath) {
  under_.underlying.armed = true;
  under_.underlying.heartbeat_stamp = 4.0;
  under_.underlying.motion.value.position = {100, 100, 100};
  under_.underlying.motion.stamp = under_.underlying.motion.received = 4.5;
  under_.underlying.health = "gyroscope, local position";
  auto dds = link({.state = true, .setpoints = false, .name_space = "px4_1"});
  EXPECT_FALSE(dds.state().motion.heard());
  EXPECT_EQ(dds.state().health, "gyroscope, local position");
  auto writer = position_writer("rt/px4_1/fmu/out/vehicle_local_position_v1", {.transient_local = true});
  auto other_namespace = position_writer("rt/fmu/out/vehicle_local_position_v1", {.transient_local = true});
  ASSERT_TRUE(eventually([&] { return dds.counts().position_writers == 1 && writer.readers() == 1; }));
  clock_.set(5.0);
  ASSERT_TRUE(writer.write(new_payload()));
  ASSERT_TRUE(eventually([&] { return dds.state().motion.stamp == 5.0; }));
  clock_.set(5.2);
  const VehicleState s = dds.state();
  EXPECT_EQ(s.motion.value.position, Vec3(2, 5, 10));
  EXPECT_TRUE(s.local_position_ok);
  EXPECT_TRUE(s.armed);
  EXPECT_EQ(s.heartbeat_stamp, 4.0);
  EXPECT_EQ(s.health, "gyroscope, dead reckoning");
  EXPECT_EQ(other_namespace.readers(), 0);
  clock_.set(60.0);  // silence
  EXPECT_EQ(dds.state().motion.stamp, 5.0);
  EXPECT_FALSE(dds.state().local_position_ok);

  const Setpoint setpoint{.position = {1, 2, 3}};
  EXPECT_TRUE(dds.send(setpoint));
  ASSERT_EQ(under_.sent.size(), 1U);
  EXPECT_EQ(under_.sent[0].position, setpoint.position);
  dds.request(vehicle::Command::kArm);
  EXPECT_EQ(under_.requested.size(), 1U);
  EXPECT_EQ(dds.next_report()->detail, "from below");
}

// By the stamp of an autopilot whose clock the agent keeps with the system's.
TEST_F(Px4Dds, APositionIsAsOldAsItsStampSays) {
  auto dds = link({.state = true, .setpoints = false, .name_space = ""});
  auto writer = position_writer("rt/fmu/out/vehicle_local_position_v1", {.reliable = true});
  ASSERT_TRUE(eventually([&] { return dds.counts().position_writers == 1 && writer.readers() == 1; }));
  const auto write = [&](double age) {
    WirePosition wire = wire_position();
    wire.timestamp(static_cast<std::uint64_t>((system_time() - age) * 1e6));
    return writer.write(new_payload(wire));
  };
  clock_.set(5.0);
  ASSERT_TRUE(write(0.0));
  ASSERT_TRUE(eventually([&] { return dds.counts().positions == 1; }));
  EXPECT_LT(dds.state().motion.delay(), 0.2);
  clock_.set(5.8);
  ASSERT_TRUE(write(0.7));
  ASSERT_TRUE(eventually([&] { return dds.counts().positions == 2; }));
  EXPECT_GE(dds.state().motion.delay(), 0.7);
  EXPECT_EQ(dds.state().motion.received, 5.8);
  clock_.set(7.5);
  ASSERT_TRUE(write(1.5));
  EXPECT_TRUE(eventually([&] { return dds.counts().late == 1; }));
  EXPECT_EQ(dds.state().motion.received, 5.8);
}

TEST_F(Px4Dds, MatchesReliableAndVolatileWritersOnTheOlderTopic) {
  auto dds = link({.state = true, .setpoints = false, .name_space = ""});
  auto writer = position_writer("rt/fmu/out/vehicle_local_position", {.reliable = true});
  ASSERT_TRUE(eventually([&] { return dds.counts().position_writers == 1 && writer.readers() == 1; }));
  ASSERT_TRUE(writer.write(old_payload(true)));
  EXPECT_TRUE(eventually([&] { return dds.counts().positions == 1; }));
}

TEST_F(Px4Dds, CountsPayloadsAndValuesThatAreNone) {
  auto dds = link({.state = true, .setpoints = false, .name_space = ""});
  auto writer = position_writer("rt/fmu/out/vehicle_local_position_v1", {.reliable = true, .depth = 20});
  ASSERT_TRUE(eventually([&] { return dds.counts().position_writers == 1 && writer.readers() == 1; }));
  const std::vector<Payload> malformed{{0, 1, 0, 0}, {9, 9, 9, 9, 9, 9, 9, 9}, Payload(4 + 216, 0xff)};
  for (const Payload& payload : malformed) ASSERT_TRUE(writer.write(payload));
  EXPECT_TRUE(eventually([&] { return dds.counts().malformed == malformed.size(); })) << dds.counts().malformed;
  WirePosition absurd = wire_position();
  absurd.x(kNaNf);
  ASSERT_TRUE(writer.write(new_payload(absurd)));
  EXPECT_TRUE(eventually([&] { return dds.counts().dropped == 1; }));
  EXPECT_FALSE(dds.state().motion.heard());
  ASSERT_TRUE(writer.write(new_payload()));
  EXPECT_TRUE(eventually([&] { return dds.counts().positions == 1; }));
}

TEST_F(Px4Dds, NeverMixesTwoAutopilots) {
  auto dds = link({.state = true, .setpoints = false, .name_space = ""});
  auto first = position_writer("rt/fmu/out/vehicle_local_position_v1", {.reliable = true});
  auto second = position_writer("rt/fmu/out/vehicle_local_position", {.reliable = true});
  ASSERT_TRUE(
      eventually([&] { return dds.counts().position_writers == 2 && first.readers() == 1 && second.readers() == 1; }));
  clock_.set(1.0);
  ASSERT_TRUE(first.write(new_payload()));
  ASSERT_TRUE(eventually([&] { return dds.counts().positions == 1; }));
  WirePosition elsewhere = wire_position();
  elsewhere.x(50.0F);
  clock_.set(1.4);
  ASSERT_TRUE(second.write(new_payload(elsewhere)));
  ASSERT_TRUE(eventually([&] { return dds.counts().other_writers == 1; }));
  EXPECT_EQ(dds.state().motion.value.position, Vec3(2, 5, 10));
  EXPECT_EQ(dds.state().motion.stamp, 1.0);
  clock_.set(1.0 + DdsVehicleLink::kWriterSilence_s);
  ASSERT_TRUE(second.write(new_payload(elsewhere)));
  EXPECT_TRUE(eventually([&] { return dds.state().motion.value.position == Vec3(2, 50, 10); }));
}

TEST_F(Px4Dds, SendsSetpointsAsPx4TakesThem) {
  auto dds = link({.state = false, .setpoints = true, .name_space = "px4_2"});
  const Setpoint setpoint{.position = {1, 2, 3}, .velocity = {4, 5, 6}, .acceleration = {0.1, 0.2, 0.3}, .yaw = 0.0};
  EXPECT_FALSE(dds.send(setpoint));  // nobody there
  std::atomic<int> taken = 0;
  px4_msgs::msg::dds_::TrajectorySetpoint_ wire;
  px4_msgs::msg::dds_::OffboardControlMode_ mode;
  const auto into = [&taken](auto& message) {
    return [&](const Payload& payload, const SampleWriter&) {
      const bool whole = cdr::decode(payload, [&](auto& in) { return message.deserialize(in.cdr()), true; });
      if (whole) ++taken;
    };
  };
  PayloadReader setpoints(peer_, "rt/px4_2/fmu/in/trajectory_setpoint", kTrajectorySetpointType, into(wire));
  PayloadReader modes(peer_, "rt/px4_2/fmu/in/offboard_control_mode", kOffboardControlModeType, into(mode));
  ASSERT_TRUE(eventually([&] { return dds.counts().setpoint_readers == 1; }));
  Setpoint absurd = setpoint;
  absurd.velocity.x() = kNaN;
  EXPECT_FALSE(dds.send(absurd));
  absurd = setpoint;
  absurd.yaw = kNaN;
  EXPECT_FALSE(dds.send(absurd));
  absurd = setpoint;
  absurd.position.x() = 2e6;
  EXPECT_FALSE(dds.send(absurd));
  ASSERT_TRUE(eventually([&] { return setpoints.writers() == 1 && modes.writers() == 1; }));
  ASSERT_TRUE(dds.send(setpoint));
  ASSERT_TRUE(eventually([&] { return taken == 2; }));
  EXPECT_TRUE(mode.position());
  EXPECT_FALSE(mode.velocity() || mode.acceleration() || mode.attitude() || mode.body_rate() ||
               mode.thrust_and_torque() || mode.direct_actuator());
  EXPECT_EQ(wire.position(), (std::array{2.0F, 1.0F, -3.0F}));
  EXPECT_EQ(wire.velocity(), (std::array{5.0F, 4.0F, -6.0F}));
  EXPECT_EQ(wire.acceleration(), (std::array{0.2F, 0.1F, -0.3F}));
  EXPECT_TRUE(std::isnan(wire.jerk()[0]) && std::isnan(wire.yawspeed()));
  EXPECT_FLOAT_EQ(wire.yaw(), static_cast<float>(std::numbers::pi / 2));
  EXPECT_EQ(wire.timestamp(), 0U);  // as of when it comes
  EXPECT_EQ(mode.timestamp(), 0U);
  EXPECT_EQ(dds.counts().setpoints_sent, 1U);
  EXPECT_TRUE(under_.sent.empty());
}

// Another vendor's writers as PX4's agent has them (version 0 and 1) and its readers of the setpoints.
class Px4DdsOtherVendor : public ::testing::TestWithParam<int> {};

TEST_P(Px4DdsOtherVendor, ExchangesStateAndSetpoints) {
  const SteadyClock clock;
  const int domain = own_domain();
  DdsParticipant node(domain);
  UnderlyingLink under;
  DdsVehicleLink link(under, node, clock, {.state = true, .setpoints = true, .name_space = "px4_1"});
  ChildProcess peer({python(), script("cyclone_px4.py"), "--domain", std::to_string(domain), "--namespace", "px4_1",
                     "--version", std::to_string(GetParam())});
  ASSERT_TRUE(eventually([&] { return link.counts().positions > 0; }, std::chrono::seconds(60)));
  const VehicleState s = link.state();
  EXPECT_EQ(s.motion.value.position, Vec3(2, 5, 10));
  EXPECT_EQ(s.motion.value.velocity, Vec3(2, 1, -0.5));
  EXPECT_TRUE(s.local_position_ok);
  ASSERT_TRUE(s.origin);
  EXPECT_EQ(s.origin->longitude_deg, 8.545594);
  EXPECT_EQ(link.counts().malformed + link.counts().dropped, 0U);
  ASSERT_TRUE(eventually([&] { return link.counts().setpoint_readers == 1; }));
  ASSERT_TRUE(eventually([&] {
    EXPECT_TRUE(link.send({.position = {1, 2, 3}, .velocity = {4, 5, 6}, .acceleration = {7, 8, 9}}));
    return peer
        .wait_line([](const std::string& line) { return line.starts_with("setpoint"); }, 0, std::chrono::seconds(1))
        .has_value();
  }));
  const auto line = peer.wait_line([](const std::string& text) { return text.starts_with("setpoint"); });
  EXPECT_EQ(*line,
            "setpoint position 2 1 -3 velocity 5 4 -6 acceleration 8 7 -9 yaw 1.5708 yawspeed nan mode position");
}

INSTANTIATE_TEST_SUITE_P(CycloneDds, Px4DdsOtherVendor, ::testing::Values(0, 1));

}  // namespace
}  // namespace jink::bridge::dds
