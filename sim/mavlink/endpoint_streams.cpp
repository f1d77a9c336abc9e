// SPDX-License-Identifier: BSD-3-Clause
// What goes out by itself: the table of messages, their rates and the state of the flight. Constants are PX4 SITL's,
// read from its recordings.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kCenti = 100.0;
constexpr double kMilli = 1000.0;
constexpr double kNearZero = 1e-9;

// What PX4's SITL reports as sensors present, enabled and healthy; the last bit is "ready to arm".
constexpr std::uint32_t kSensorsPresent = 0x0300402F;
constexpr std::uint32_t kSensorsEnabled = 0x0301402F;
constexpr std::uint32_t kSensorsHealthy = 0x0320C83F;
static_assert((kSensorsHealthy & MAV_SYS_STATUS_PREARM_CHECK) == 0);

std::int16_t clamped_16(double value) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value, -32768.0, 32767.0)));
}

std::int32_t rounded_32(double value) {
  return static_cast<std::int32_t>(std::llround(value));
}

/// Degrees clockwise from north in [0, 360).
double heading_deg(const vehicle::Motion& motion) {
  const double yaw = vehicle::swap_yaw(motion.yaw) / vehicle::kDegree;
  return yaw < -kNearZero ? yaw + 360.0 : std::max(0.0, yaw);
}

/// w first. The generated structures are packed: their arrays take no references, hence the copies by memcpy.
std::array<float, 4> wxyz(const Eigen::Quaterniond& q) {
  return {real(q.w()), real(q.x()), real(q.y()), real(q.z())};
}

/// The diagonal of a covariance that is sent as the upper triangle of a 6 x 6 matrix, row by row.
std::array<float, 21> upper_triangle(const std::array<float, 6>& diagonal) {
  std::array<float, 21> triangle{};
  triangle.fill(kNan);
  std::size_t index = 0;
  for (std::size_t row = 0; row < diagonal.size(); ++row) {
    triangle[index] = diagonal[row];
    index += diagonal.size() - row;
  }
  return triangle;
}

/// Major, minor, patch and kind: 255 is a release, 64 an alpha.
std::uint32_t software_version(vehicle::Px4Version version) {
  switch (version) {
    case vehicle::Px4Version::k1_14:
      return 0x010E00FF;
    case vehicle::Px4Version::k1_16:
      return 0x011000FF;
    case vehicle::Px4Version::k1_17:
      return 0x01110040;
    case vehicle::Px4Version::k1_18:
      return 0x011200FF;
  }
  return 0;
}

}  // namespace

std::span<const MavlinkEndpoint::Impl::MessageKind> MavlinkEndpoint::Impl::message_kinds() {
  static constexpr std::array kKinds{
      MessageKind{MAVLINK_MSG_ID_HEARTBEAT, 1, 1.3, &Impl::send_heartbeat},
      MessageKind{MAVLINK_MSG_ID_ATTITUDE, 100, kLinkUp, &Impl::send_attitude},
      MessageKind{MAVLINK_MSG_ID_ATTITUDE_QUATERNION, 50, kLinkUp, &Impl::send_attitude_quaternion},
      MessageKind{MAVLINK_MSG_ID_GLOBAL_POSITION_INT, 50, kLinkUp, &Impl::send_global_position},
      MessageKind{MAVLINK_MSG_ID_HIGHRES_IMU, 50, kLinkUp, &Impl::send_highres_imu},
      MessageKind{MAVLINK_MSG_ID_LOCAL_POSITION_NED, 30, kLinkUp, &Impl::send_local_position},
      MessageKind{MAVLINK_MSG_ID_ODOMETRY, 30, kLinkUp, &Impl::send_odometry},
      MessageKind{MAVLINK_MSG_ID_ALTITUDE, 10, kLinkUp, &Impl::send_altitude},
      MessageKind{MAVLINK_MSG_ID_ATTITUDE_TARGET, 10, kLinkUp, &Impl::send_attitude_target},
      MessageKind{MAVLINK_MSG_ID_DISTANCE_SENSOR, 10, kLinkUp, &Impl::send_distance_sensor},
      MessageKind{MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED, 10, kLinkUp, &Impl::send_position_target},
      MessageKind{MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, 10, kLinkUp, &Impl::send_servos},
      MessageKind{MAVLINK_MSG_ID_TIMESYNC, 10, kLinkUp, &Impl::send_timesync},
      MessageKind{MAVLINK_MSG_ID_VFR_HUD, 10, kLinkUp, &Impl::send_vfr_hud},
      MessageKind{MAVLINK_MSG_ID_GPS_RAW_INT, 8, kLinkUp, &Impl::send_gps_raw},
      MessageKind{MAVLINK_MSG_ID_EXTENDED_SYS_STATE, 5, kLinkUp, &Impl::send_extended_sys_state},
      MessageKind{MAVLINK_MSG_ID_SYS_STATUS, 5, kLinkUp, &Impl::send_sys_status},
      MessageKind{MAVLINK_MSG_ID_ESTIMATOR_STATUS, 1, kLinkUp, &Impl::send_estimator_status},
      MessageKind{MAVLINK_MSG_ID_MISSION_CURRENT, 1, kLinkUp, &Impl::send_mission_current},
      MessageKind{MAVLINK_MSG_ID_PING, 1, kLinkUp, &Impl::send_ping},
      MessageKind{MAVLINK_MSG_ID_SYSTEM_TIME, 1, kLinkUp, &Impl::send_system_time},
      MessageKind{MAVLINK_MSG_ID_SCALED_PRESSURE, 1, kLinkUp, &Impl::send_scaled_pressure},
      MessageKind{MAVLINK_MSG_ID_BATTERY_STATUS, 0.5, kLinkUp, &Impl::send_battery},
      MessageKind{MAVLINK_MSG_ID_CURRENT_MODE, 0.5, kLinkUp, &Impl::send_current_mode, &Impl::modes_at_},
      MessageKind{MAVLINK_MSG_ID_HOME_POSITION, 0.5, 2.4, &Impl::send_home},
      MessageKind{MAVLINK_MSG_ID_VIBRATION, 0.5, kLinkUp, &Impl::send_vibration},
      MessageKind{MAVLINK_MSG_ID_CURRENT_EVENT_SEQUENCE, 1.0 / 3.0, kLinkUp, &Impl::send_event_sequence},
      // Once by itself: next_due passes but once, for its interval is none.
      MessageKind{MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN, 0, 1.4, &Impl::send_gps_origin},
      MessageKind{MAVLINK_MSG_ID_AUTOPILOT_VERSION, 0, planner::base::kInfinity, &Impl::send_autopilot_version},
  };
  return kKinds;
}

std::optional<std::size_t> MavlinkEndpoint::Impl::find_kind(std::uint32_t id) {
  const auto kinds = message_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const MessageKind& kind) { return kind.id == id; });
  if (found == kinds.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kinds.begin());
}

void MavlinkEndpoint::Impl::reset_streams(MavlinkLink& link) const {
  link.streams.clear();
  for (const MessageKind& kind : message_kinds()) {
    const double first = std::isfinite(kind.first_s) ? kind.first_s * start_factor_ : kind.first_s;
    link.streams.push_back({.interval = kind.rate_hz > 0.0 ? 1.0 / kind.rate_hz : 0.0, .next_due = boot_ + first});
  }
}

void MavlinkEndpoint::Impl::send_streams(MavlinkLink& link) {
  const auto kinds = message_kinds();
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    Stream& stream = link.streams[i];
    if (now_ < stream.next_due - kNearZero) continue;
    if (kinds[i].news_at != nullptr && this->*kinds[i].news_at <= stream.sent) continue;
    stream.sent = now_;
    if (stream.interval > 0.0) {
      // In step with the grid of due times, so that the mean rate is the asked one whatever the polling rate; what
      // was missed by more than an interval stays missed.
      stream.next_due = std::max(stream.next_due + stream.interval, now_ - stream.interval);
      (this->*kinds[i].send)(link);
      continue;
    }
    const bool once = std::isfinite(stream.next_due) && kinds[i].rate_hz == 0.0;
    stream.next_due = planner::base::kInfinity;
    if (once) (this->*kinds[i].send)(link);
  }
}

std::uint32_t MavlinkEndpoint::Impl::boot_ms() const {
  return static_cast<std::uint32_t>(boot_us() / 1000);
}

std::uint64_t MavlinkEndpoint::Impl::boot_us(double boot_time) const {
  return static_cast<std::uint64_t>(std::llround(options_.clock_rate * boot_time * 1e6));
}

bridge::frames::Geodetic MavlinkEndpoint::Impl::to_global(const Vec3& local) const {
  return frame_.to_geodetic(local + autopilot_.estimator().origin());
}

Vec3 MavlinkEndpoint::Impl::to_local(const bridge::frames::Geodetic& place) const {
  return frame_.to_enu(place) - autopilot_.estimator().origin();
}

bridge::frames::Geodetic MavlinkEndpoint::Impl::global_position() const {
  return to_global(autopilot_.estimated_motion().position);
}

void MavlinkEndpoint::Impl::send_heartbeat(MavlinkLink& link) {
  const vehicle::Heartbeat heartbeat = autopilot_.heartbeat();
  mavlink_heartbeat_t message{};
  message.type = MAV_TYPE_QUADROTOR;
  message.autopilot = MAV_AUTOPILOT_PX4;
  message.base_mode = heartbeat.base_mode;
  message.custom_mode = heartbeat.custom_mode;
  message.system_status = heartbeat.system_status;
  message.mavlink_version = MAVLINK_VERSION;
  link.send(mavlink_msg_heartbeat_encode_status, message);
}

void MavlinkEndpoint::Impl::send_sys_status(MavlinkLink& link) {
  mavlink_sys_status_t message{};
  const std::uint32_t remote_control =
      autopilot_.remote_control() ? std::uint32_t{MAV_SYS_STATUS_SENSOR_RC_RECEIVER} : 0U;
  message.onboard_control_sensors_present = kSensorsPresent | remote_control;
  message.onboard_control_sensors_enabled = kSensorsEnabled;
  message.onboard_control_sensors_health =
      (autopilot_.estimator().gps() ? kSensorsHealthy : kSensorsHealthy & ~std::uint32_t{MAV_SYS_STATUS_SENSOR_GPS}) |
      (autopilot_.prearm_ok() ? std::uint32_t{MAV_SYS_STATUS_PREARM_CHECK} : 0U) | remote_control;
  message.load = 100;
  message.voltage_battery = 16200;
  message.current_battery = -100;
  message.battery_remaining = battery_percent(autopilot_.battery());
  link.send(mavlink_msg_sys_status_encode_status, message);
}

void MavlinkEndpoint::Impl::send_extended_sys_state(MavlinkLink& link) {
  mavlink_extended_sys_state_t message{};
  message.landed_state = static_cast<std::uint8_t>(autopilot_.landed_state());
  link.send(mavlink_msg_extended_sys_state_encode_status, message);
}

void MavlinkEndpoint::Impl::send_current_mode(MavlinkLink& link) {
  if (autopilot_.options().version < vehicle::Px4Version::k1_16) return;  // PX4 has it since 1.15
  mavlink_current_mode_t message{};
  message.custom_mode = static_cast<std::uint32_t>(autopilot_.mode());
  message.intended_custom_mode = static_cast<std::uint32_t>(autopilot_.intended_mode());
  link.send(mavlink_msg_current_mode_encode_status, message);
}

void MavlinkEndpoint::Impl::send_attitude(MavlinkLink& link) {
  const vehicle::Motion& motion = autopilot_.estimated_motion();
  const vehicle::RollPitchYaw angles = vehicle::roll_pitch_yaw(vehicle::attitude_ned(motion.attitude));
  const Vec3 rates_frd = vehicle::swap_flu_frd(motion.body_rates);
  mavlink_attitude_t message{};
  message.time_boot_ms = boot_ms();
  message.roll = real(angles.roll);
  message.pitch = real(angles.pitch);
  message.yaw = real(angles.yaw);
  message.rollspeed = real(rates_frd.x());
  message.pitchspeed = real(rates_frd.y());
  message.yawspeed = real(rates_frd.z());
  link.send(mavlink_msg_attitude_encode_status, message);
}

void MavlinkEndpoint::Impl::send_attitude_quaternion(MavlinkLink& link) {
  const vehicle::Motion& motion = autopilot_.estimated_motion();
  const Eigen::Quaterniond q = vehicle::attitude_ned(motion.attitude);
  const Vec3 rates_frd = vehicle::swap_flu_frd(motion.body_rates);
  mavlink_attitude_quaternion_t message{};
  message.time_boot_ms = boot_ms();
  message.q1 = real(q.w());
  message.q2 = real(q.x());
  message.q3 = real(q.y());
  message.q4 = real(q.z());
  message.rollspeed = real(rates_frd.x());
  message.pitchspeed = real(rates_frd.y());
  message.yawspeed = real(rates_frd.z());
  link.send(mavlink_msg_attitude_quaternion_encode_status, message);
}

/// PX4 sends neither position while it does not know where it is.
void MavlinkEndpoint::Impl::send_local_position(MavlinkLink& link) {
  if (!autopilot_.position_valid()) return;
  const Vec3 position_ned = vehicle::swap_enu_ned(autopilot_.estimated_motion().position);
  const Vec3 velocity_ned = vehicle::swap_enu_ned(autopilot_.estimated_motion().velocity);
  mavlink_local_position_ned_t message{};
  message.time_boot_ms = boot_ms();
  message.x = real(position_ned.x());
  message.y = real(position_ned.y());
  message.z = real(position_ned.z());
  message.vx = real(velocity_ned.x());
  message.vy = real(velocity_ned.y());
  message.vz = real(velocity_ned.z());
  link.send(mavlink_msg_local_position_ned_encode_status, message);
}

void MavlinkEndpoint::Impl::send_global_position(MavlinkLink& link) {
  if (!autopilot_.position_valid()) return;
  const vehicle::Motion& motion = autopilot_.estimated_motion();
  const bridge::frames::Geodetic place = global_position();
  const Vec3 velocity_ned = vehicle::swap_enu_ned(motion.velocity);
  mavlink_global_position_int_t message{};
  message.time_boot_ms = boot_ms();
  message.lat = rounded_32(place.latitude_deg * kDegreesE7);
  message.lon = rounded_32(place.longitude_deg * kDegreesE7);
  message.alt = rounded_32(place.altitude_m * kMilli);
  message.relative_alt = rounded_32((motion.position.z() - autopilot_.home().z()) * kMilli);
  message.vx = clamped_16(velocity_ned.x() * kCenti);
  message.vy = clamped_16(velocity_ned.y() * kCenti);
  message.vz = clamped_16(velocity_ned.z() * kCenti);
  message.hdg = static_cast<std::uint16_t>(std::min(35999.0, std::floor(heading_deg(motion) * kCenti)));
  link.send(mavlink_msg_global_position_int_encode_status, message);
}

/// As PX4's here: the child frame is NED and so is the velocity.
void MavlinkEndpoint::Impl::send_odometry(MavlinkLink& link) {
  const vehicle::Motion& motion = autopilot_.estimated_motion();
  const Vec3 position_ned = vehicle::swap_enu_ned(motion.position);
  const Vec3 velocity_ned = vehicle::swap_enu_ned(motion.velocity);
  const Vec3 rates_frd = vehicle::swap_flu_frd(motion.body_rates);
  mavlink_odometry_t message{};
  message.time_usec = boot_us();
  message.frame_id = MAV_FRAME_LOCAL_NED;
  message.child_frame_id = MAV_FRAME_LOCAL_NED;
  message.x = real(position_ned.x());
  message.y = real(position_ned.y());
  message.z = real(position_ned.z());
  message.vx = real(velocity_ned.x());
  message.vy = real(velocity_ned.y());
  message.vz = real(velocity_ned.z());
  const auto q = wxyz(vehicle::attitude_ned(motion.attitude));
  std::memcpy(message.q, q.data(), sizeof(message.q));
  message.rollspeed = real(rates_frd.x());
  message.pitchspeed = real(rates_frd.y());
  message.yawspeed = real(rates_frd.z());
  const auto pose_covariance = upper_triangle({0.02F, 0.02F, 0.005F, 0.0005F, 0.0005F, 0.04F});
  std::memcpy(message.pose_covariance, pose_covariance.data(), sizeof(message.pose_covariance));
  const auto velocity_covariance = upper_triangle({0.02F, 0.02F, 0.0015F, kNan, kNan, kNan});
  std::memcpy(message.velocity_covariance, velocity_covariance.data(), sizeof(message.velocity_covariance));
  message.reset_counter = autopilot_.estimator().reset_counter();
  message.estimator_type = MAV_ESTIMATOR_TYPE_AUTOPILOT;
  link.send(mavlink_msg_odometry_encode_status, message);
}

void MavlinkEndpoint::Impl::send_altitude(MavlinkLink& link) {
  const double z = autopilot_.estimated_motion().position.z();
  const double ground = autopilot_.local_ground();
  mavlink_altitude_t message{};
  message.time_usec = boot_us();
  message.altitude_monotonic = message.altitude_amsl = real(global_position().altitude_m);
  message.altitude_local = real(z);
  message.altitude_relative = real(z - autopilot_.home().z());
  message.altitude_terrain = real(ground);
  message.bottom_clearance = real(z - ground);
  link.send(mavlink_msg_altitude_encode_status, message);
}

void MavlinkEndpoint::Impl::send_vfr_hud(MavlinkLink& link) {
  const vehicle::Motion& motion = autopilot_.estimated_motion();
  mavlink_vfr_hud_t message{};
  message.airspeed = kNan;
  message.groundspeed = real(motion.velocity.head<2>().norm());
  message.heading = clamped_16(std::floor(heading_deg(motion)));
  message.throttle = static_cast<std::uint16_t>(std::lround(throttle() * 100.0));
  message.alt = real(global_position().altitude_m);
  message.climb = real(motion.velocity.z());
  link.send(mavlink_msg_vfr_hud_encode_status, message);
}

/// What is followed now; without a flight NaN and a downward acceleration, as PX4's.
void MavlinkEndpoint::Impl::send_position_target(MavlinkLink& link) {
  constexpr double kIdleAcceleration = 100.0;
  constexpr std::uint16_t kNothingGiven = 0x3F;  // position and velocity
  mavlink_position_target_local_ned_t message{};
  message.time_boot_ms = boot_ms();
  message.coordinate_frame = MAV_FRAME_LOCAL_NED;
  const auto setpoint = autopilot_.active_setpoint();
  const Vec3 none = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vec3 position_ned = setpoint ? vehicle::swap_enu_ned(setpoint->position) : none;
  const Vec3 velocity_ned = setpoint ? vehicle::swap_enu_ned(autopilot_.model().commanded_velocity()) : none;
  const Vec3 acceleration_ned =
      setpoint ? vehicle::swap_enu_ned(autopilot_.model().commanded_acceleration()) : Vec3(0, 0, kIdleAcceleration);
  message.type_mask = setpoint ? 0 : kNothingGiven;
  message.x = real(position_ned.x());
  message.y = real(position_ned.y());
  message.z = real(position_ned.z());
  message.vx = real(velocity_ned.x());
  message.vy = real(velocity_ned.y());
  message.vz = real(velocity_ned.z());
  message.afx = real(acceleration_ned.x());
  message.afy = real(acceleration_ned.y());
  message.afz = real(acceleration_ned.z());
  const bool has_yaw = setpoint && std::isfinite(setpoint->yaw);
  message.yaw = real(vehicle::swap_yaw(has_yaw ? setpoint->yaw : autopilot_.estimated_motion().yaw));
  link.send(mavlink_msg_position_target_local_ned_encode_status, message);
}

void MavlinkEndpoint::Impl::send_attitude_target(MavlinkLink& link) {
  const auto setpoint = autopilot_.active_setpoint();
  const double yaw = autopilot_.estimated_motion().yaw;
  Vec3 thrust = Vec3(0, 0, vehicle::kGravity);
  if (setpoint) thrust += autopilot_.model().commanded_acceleration();
  mavlink_attitude_target_t message{};
  message.time_boot_ms = boot_ms();
  const double target_yaw = setpoint && std::isfinite(setpoint->yaw) ? setpoint->yaw : yaw;
  const auto q = wxyz(vehicle::attitude_ned(vehicle::attitude_along(thrust, target_yaw)));
  std::memcpy(message.q, q.data(), sizeof(message.q));
  message.thrust = real(throttle());
  link.send(mavlink_msg_attitude_target_encode_status, message);
}

void MavlinkEndpoint::Impl::send_gps_origin(MavlinkLink& link) {
  const bridge::frames::Geodetic origin = to_global(Vec3::Zero());
  mavlink_gps_global_origin_t message{};
  message.latitude = rounded_32(origin.latitude_deg * kDegreesE7);
  message.longitude = rounded_32(origin.longitude_deg * kDegreesE7);
  message.altitude = rounded_32(origin.altitude_m * kMilli);
  message.time_usec = boot_us();
  link.send(mavlink_msg_gps_global_origin_encode_status, message);
}

void MavlinkEndpoint::Impl::send_home(MavlinkLink& link) {
  const bridge::frames::Geodetic home = to_global(autopilot_.home());
  const Vec3 home_ned = vehicle::swap_enu_ned(autopilot_.home());
  mavlink_home_position_t message{};
  message.latitude = rounded_32(home.latitude_deg * kDegreesE7);
  message.longitude = rounded_32(home.longitude_deg * kDegreesE7);
  message.altitude = rounded_32(home.altitude_m * kMilli);
  message.x = real(home_ned.x());
  message.y = real(home_ned.y());
  message.z = real(home_ned.z());
  const auto q = wxyz(Eigen::Quaterniond::Identity());
  std::memcpy(message.q, q.data(), sizeof(message.q));
  message.time_usec = boot_us();
  link.send(mavlink_msg_home_position_encode_status, message);
}

void MavlinkEndpoint::Impl::send_system_time(MavlinkLink& link) {
  mavlink_system_time_t message{};
  message.time_unix_usec =
      options_.unix_time_at_start_us + static_cast<std::uint64_t>(std::llround(autopilot_.time() * 1e6));
  message.time_boot_ms = boot_ms();
  link.send(mavlink_msg_system_time_encode_status, message);
}

void MavlinkEndpoint::Impl::send_timesync(MavlinkLink& link) {
  mavlink_timesync_t message{};
  message.ts1 = static_cast<std::int64_t>(boot_us()) * 1000;
  link.send(mavlink_msg_timesync_encode_status, message);
}

void MavlinkEndpoint::Impl::send_ping(MavlinkLink& link) {
  mavlink_ping_t message{};
  message.time_usec = boot_us();
  message.seq = next_ping_++;
  link.send(mavlink_msg_ping_encode_status, message);
}

void MavlinkEndpoint::Impl::send_estimator_status(MavlinkLink& link) {
  constexpr std::uint16_t kAllGood = 895;  // PX4's SITL in flight
  constexpr std::uint16_t kNoPosition =
      kAllGood & ~(ESTIMATOR_VELOCITY_HORIZ | ESTIMATOR_POS_HORIZ_REL | ESTIMATOR_POS_HORIZ_ABS |
                   ESTIMATOR_PRED_POS_HORIZ_REL | ESTIMATOR_PRED_POS_HORIZ_ABS);
  mavlink_estimator_status_t message{};
  message.time_usec = boot_us();
  message.flags = autopilot_.position_valid() ? kAllGood : kNoPosition;
  message.vel_ratio = message.pos_horiz_ratio = message.pos_vert_ratio = 0.05F;
  message.mag_ratio = message.hagl_ratio = 0.1F;
  message.tas_ratio = kNan;
  message.pos_horiz_accuracy = real(autopilot_.estimator().horizontal_accuracy());
  message.pos_vert_accuracy = real(autopilot_.estimator().vertical_accuracy());
  link.send(mavlink_msg_estimator_status_encode_status, message);
}

void MavlinkEndpoint::Impl::send_autopilot_version(MavlinkLink& link) {
  mavlink_autopilot_version_t message{};
  message.capabilities = MAV_PROTOCOL_CAPABILITY_MAVLINK2 | MAV_PROTOCOL_CAPABILITY_COMMAND_INT |
                         MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT | MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE |
                         MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT | MAV_PROTOCOL_CAPABILITY_MISSION_INT |
                         MAV_PROTOCOL_CAPABILITY_MISSION_FENCE | MAV_PROTOCOL_CAPABILITY_MISSION_RALLY |
                         MAV_PROTOCOL_CAPABILITY_FTP | MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED;
  message.flight_sw_version = message.middleware_sw_version = software_version(autopilot_.options().version);
  message.board_version = 1;
  message.uid = system_id_;
  link.send(mavlink_msg_autopilot_version_encode_status, message);
}

}  // namespace jink::sim::mavlink
