// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dds/vehicle_topics.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <mutex>
#include <optional>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include "Px4.h"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/px4_link.hpp"
#include "bridge/frames/conversions.hpp"
#include "sim/vehicle/frame_conversions.hpp"

namespace jink::sim::dds {

namespace {

using WireMode = px4_msgs::msg::dds_::OffboardControlMode_;
using WirePosition = px4_msgs::msg::dds_::VehicleLocalPosition_;
using WireSetpoint = px4_msgs::msg::dds_::TrajectorySetpoint_;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Vec3 from_wire(const std::array<float, 3>& ned) {
  return bridge::frames::enu_from_ned(
      {static_cast<double>(ned[0]), static_cast<double>(ned[1]), static_cast<double>(ned[2])});
}

// As far as the mode asks for it; nothing where it asks for something else than a trajectory.
std::optional<vehicle::Setpoint> setpoint_of(const WireSetpoint& wire, const WireMode& mode) {
  if (!mode.position() && !mode.velocity() && !mode.acceleration()) return std::nullopt;
  vehicle::Setpoint setpoint;  // nothing asked for
  if (mode.position()) setpoint.position = from_wire(wire.position());
  if (mode.position() || mode.velocity()) setpoint.velocity = from_wire(wire.velocity());
  setpoint.acceleration = from_wire(wire.acceleration());
  setpoint.yaw = bridge::frames::yaw_enu_from_heading(static_cast<double>(wire.yaw()));
  setpoint.yaw_rate = -static_cast<double>(wire.yawspeed());  // about the axis that points down
  return setpoint;
}

WirePosition position_of(const vehicle::Autopilot& autopilot, const EstimateJumps& jumps, bool yaw_aligned) {
  const vehicle::Motion& motion = autopilot.estimated_motion();
  const Vec3 p = bridge::frames::ned_from_enu(motion.position);
  const Vec3 v = bridge::frames::ned_from_enu(motion.velocity);
  const Vec3 a = bridge::frames::ned_from_enu(motion.acceleration);
  const Vec3 shift = bridge::frames::ned_from_enu(jumps.newest);
  const auto to_float = [](double value) { return static_cast<float>(value); };
  const bool valid = autopilot.ready() && autopilot.position_valid();
  WirePosition wire;
  wire.timestamp(static_cast<std::uint64_t>(bridge::dds::system_time() * 1e6));  // the agent synchronises the clocks
  wire.timestamp_sample(wire.timestamp());
  wire.xy_valid(valid);
  wire.z_valid(valid);
  wire.v_xy_valid(valid);
  wire.v_z_valid(valid);
  wire.x(to_float(p.x()));
  wire.y(to_float(p.y()));
  wire.z(to_float(p.z()));
  wire.delta_xy({to_float(shift.x()), to_float(shift.y())});
  wire.xy_reset_counter(jumps.horizontal);
  wire.delta_z(to_float(shift.z()));
  wire.z_reset_counter(jumps.vertical);
  wire.vx(to_float(v.x()));
  wire.vy(to_float(v.y()));
  wire.vz(to_float(v.z()));
  wire.z_deriv(to_float(v.z()));
  wire.ax(to_float(a.x()));
  wire.ay(to_float(a.y()));
  wire.az(to_float(a.z()));
  wire.heading(to_float(bridge::frames::heading_from_yaw_enu(motion.yaw)));
  wire.unaided_heading(kNaN);
  wire.heading_good_for_control(valid && yaw_aligned);
  wire.xy_global(valid);
  wire.z_global(valid);
  const bridge::frames::Geodetic origin =
      bridge::frames::LocalFrame(vehicle::kSitlOrigin).to_geodetic(autopilot.estimator().origin());
  wire.ref_lat(origin.latitude_deg);
  wire.ref_lon(origin.longitude_deg);
  wire.ref_alt(to_float(origin.altitude_m));
  wire.dist_bottom(kNaN);
  wire.vxy_max(kInfinity);
  wire.vz_max(kInfinity);
  wire.hagl_min(kInfinity);
  wire.hagl_max_z(kInfinity);
  wire.hagl_max_xy(kInfinity);
  return wire;
}

/// The same in the layout of PX4 1.14 or 1.16, field by field as their .msg files have them.
bridge::dds::Payload older(const WirePosition& w, vehicle::Px4Version version) {
  const bool unversioned = version == vehicle::Px4Version::k1_14;
  bridge::dds::Payload payload(256);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());
  eprosima::fastcdr::Cdr out(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
  out.serialize_encapsulation();
  out << w.timestamp() << w.timestamp_sample() << w.xy_valid() << w.z_valid() << w.v_xy_valid() << w.v_z_valid();
  out << w.x() << w.y() << w.z() << w.delta_xy() << w.xy_reset_counter() << w.delta_z() << w.z_reset_counter();
  out << w.vx() << w.vy() << w.vz() << w.z_deriv() << w.delta_vxy() << w.vxy_reset_counter() << w.delta_vz();
  out << w.vz_reset_counter() << w.ax() << w.ay() << w.az() << w.heading();
  if (!unversioned) out << w.heading_var();
  out << w.unaided_heading() << w.delta_heading() << w.heading_reset_counter() << w.heading_good_for_control();
  if (!unversioned) out << w.tilt_var();
  out << w.xy_global() << w.z_global() << w.ref_timestamp() << w.ref_lat() << w.ref_lon() << w.ref_alt();
  if (unversioned) {
    out << w.dist_bottom() << w.dist_bottom_valid() << w.dist_bottom_sensor_bitfield();
  } else {
    out << w.dist_bottom_valid() << w.dist_bottom() << w.dist_bottom_var() << w.delta_dist_bottom();
    out << w.dist_bottom_reset_counter() << w.dist_bottom_sensor_bitfield();
  }
  out << w.eph() << w.epv() << w.evh() << w.evv() << w.dead_reckoning();
  out << w.vxy_max() << w.vz_max() << w.hagl_min() << w.hagl_max_z();  // one limit of the height
  payload.resize(out.getSerializedDataLength());
  return payload;
}

}  // namespace

const EstimateJumps& EstimateJumpDetector::update(std::uint8_t counter, const vehicle::Motion& estimated, double dt) {
  if (position_ && counter != jumps_.horizontal) {
    jumps_.newest = estimated.position - *position_ - dt * estimated.velocity;
  }
  jumps_.horizontal = jumps_.vertical = counter;
  position_ = estimated.position;
  return jumps_;
}

bool YawAlignment::update(double now, bool landed, double height) {
  if (landed_ && !landed) climbed_at_.reset();
  landed_ = landed;
  if (!landed && !climbed_at_ && height > kHeight) climbed_at_ = now;
  return climbed_at_ && now - *climbed_at_ > kSettling_s;
}

class VehicleTopics::Impl {
 public:
  Impl(bridge::dds::DdsParticipant& node, const std::string& name_space, vehicle::Px4Version version)
      : version_(version),
        positions_(node,
                   bridge::dds::px4_topic(name_space, version < vehicle::Px4Version::k1_17
                                                          ? bridge::dds::kLocalPositionTopic
                                                          : bridge::dds::kLocalPositionTopicV1),
                   bridge::dds::kLocalPositionType, {.transient_local = true}),
        setpoint_reader_(node, bridge::dds::px4_topic(name_space, bridge::dds::kTrajectorySetpointTopic),
                         bridge::dds::kTrajectorySetpointType, take_into(setpoint_)),
        mode_reader_(node, bridge::dds::px4_topic(name_space, bridge::dds::kOffboardControlModeTopic),
                     bridge::dds::kOffboardControlModeType, take_into(mode_)) {}

  void step(double now, vehicle::Autopilot& autopilot, const EstimateJumps& jumps) {
    take_orders(now, autopilot);
    const double height = autopilot.estimated_motion().position.z() - autopilot.local_ground();
    const bool yaw_aligned = yaw_.update(now, autopilot.landed(), height);
    if (now < next_position_) return;
    next_position_ = std::max(next_position_ + 1.0 / kPositionRate_hz, now);
    const WirePosition position = position_of(autopilot, jumps, yaw_aligned);
    const bool sent = version_ < vehicle::Px4Version::k1_17 ? positions_.write(older(position, version_))
                                                            : positions_.write_message(position);
    if (!sent) {
      autopilot.report(vehicle::Severity::kWarning, "DDS: a position could not be published");
    }
  }

  int readers() const { return positions_.readers(); }
  std::uint64_t setpoints() const { return setpoints_; }
  std::uint64_t malformed() const { return malformed_; }

 private:
  template <typename Wire>
  struct Newest {
    Wire message;
    bool fresh = false;
  };

  // Both types are of fixed size, so the generated code may decode them.
  template <typename Wire>
  bridge::dds::PayloadReader::Take take_into(Newest<Wire>& newest) {
    return [this, &newest](const bridge::dds::Payload& payload, const bridge::dds::SampleWriter&) {
      Wire message;
      const bool whole = bridge::cdr::decode(payload, [&](bridge::cdr::CdrInput& input) {
        message.deserialize(input.cdr());
        return true;
      });
      if (!whole) {
        ++malformed_;
        return;
      }
      const std::scoped_lock lock(mutex_);
      newest.message = message;
      newest.fresh = true;
    };
  }

  void take_orders(double now, vehicle::Autopilot& autopilot) {
    const std::scoped_lock lock(mutex_);
    if (mode_.fresh) mode_came_ = now;
    const bool live = mode_came_ && now - *mode_came_ <= kModeTimeout_s;
    const bool order = mode_.fresh || (setpoint_.fresh && live);
    any_setpoint_ = any_setpoint_ || setpoint_.fresh;
    mode_.fresh = setpoint_.fresh = false;
    if (!order || !any_setpoint_) return;
    const std::optional<vehicle::Setpoint> setpoint = setpoint_of(setpoint_.message, mode_.message);
    if (!setpoint) {
      autopilot.report(vehicle::Severity::kWarning, "DDS: offboard control mode not supported");
    } else if (autopilot.offboard_setpoint(*setpoint) == vehicle::Result::kAccepted) {
      ++setpoints_;
    }
  }

  std::mutex mutex_;  // guards mode_ and setpoint_
  Newest<WireMode> mode_;
  Newest<WireSetpoint> setpoint_;
  std::atomic<std::uint64_t> malformed_ = 0;

  vehicle::Px4Version version_;
  YawAlignment yaw_;
  double next_position_ = 0.0;
  std::optional<double> mode_came_;
  bool any_setpoint_ = false;
  std::uint64_t setpoints_ = 0;
  bridge::dds::PayloadWriter positions_;
  bridge::dds::PayloadReader setpoint_reader_;  // the readers last: their destruction ends the callbacks
  bridge::dds::PayloadReader mode_reader_;
};

VehicleTopics::VehicleTopics(bridge::dds::DdsParticipant& node, const std::string& name_space,
                             vehicle::Px4Version version)
    : impl_(std::make_unique<Impl>(node, name_space, version)) {}
VehicleTopics::~VehicleTopics() = default;
void VehicleTopics::step(double now, vehicle::Autopilot& autopilot, const EstimateJumps& jumps) {
  impl_->step(now, autopilot, jumps);
}
int VehicleTopics::readers() const {
  return impl_->readers();
}
std::uint64_t VehicleTopics::setpoints() const {
  return impl_->setpoints();
}
std::uint64_t VehicleTopics::malformed() const {
  return impl_->malformed();
}

}  // namespace jink::sim::dds
