// SPDX-License-Identifier: BSD-3-Clause
// The messages that stand for raw sensors and actuators: noise-free, from the estimated motion.
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

constexpr double kHoverThrottle = 0.5;  ///< of full thrust, PX4's MPC_THR_HOVER
constexpr float kTemperatureDegC = 15.0F;

/// hPa, of the standard atmosphere.
double pressure_hpa(double altitude_m) {
  return 1013.25 * std::pow(1.0 - 2.25577e-5 * altitude_m, 5.25588);
}

}  // namespace

std::int8_t battery_percent(double remaining) {
  return std::isnan(remaining) ? std::int8_t{-1} : static_cast<std::int8_t>(std::lround(remaining * 100.0));
}

double MavlinkEndpoint::Impl::throttle() const {
  const vehicle::VehicleModel& model = autopilot_.model();
  if (model.motors() != vehicle::Motors::kFlying) return 0.0;
  const double weights = (model.commanded_acceleration() + Vec3(0, 0, vehicle::kGravity)).norm() / vehicle::kGravity;
  return std::clamp(kHoverThrottle * weights, 0.0, 1.0);
}

void MavlinkEndpoint::Impl::send_highres_imu(MavlinkLink& link) {
  constexpr std::uint16_t kAllFields = 63;      // as PX4's SITL: accelerometer and gyroscope
  const Vec3 kEarthFieldNed(0.21, 0.01, 0.43);  // gauss, at the origin of PX4's SITL
  const vehicle::Motion& motion = autopilot_.estimated_motion();
  const double altitude = global_position().altitude_m;
  const Vec3 force_frd = vehicle::swap_flu_frd(motion.attitude.conjugate() * motion.specific_force);
  const Vec3 rates_frd = vehicle::swap_flu_frd(motion.body_rates);
  const Vec3 field_frd = vehicle::attitude_ned(motion.attitude).conjugate() * kEarthFieldNed;
  mavlink_highres_imu_t message{};
  message.time_usec = boot_us();
  message.xacc = real(force_frd.x());
  message.yacc = real(force_frd.y());
  message.zacc = real(force_frd.z());
  message.xgyro = real(rates_frd.x());
  message.ygyro = real(rates_frd.y());
  message.zgyro = real(rates_frd.z());
  message.xmag = real(field_frd.x());
  message.ymag = real(field_frd.y());
  message.zmag = real(field_frd.z());
  message.abs_pressure = real(pressure_hpa(altitude));
  message.pressure_alt = real(altitude);
  message.temperature = kTemperatureDegC;
  message.fields_updated = kAllFields;
  link.send(mavlink_msg_highres_imu_encode_status, message);
}

void MavlinkEndpoint::Impl::send_gps_raw(MavlinkLink& link) {
  if (!autopilot_.estimator().gps()) {
    mavlink_gps_raw_int_t nothing{};
    nothing.time_usec = boot_us();
    nothing.fix_type = GPS_FIX_TYPE_NO_FIX;
    nothing.eph = nothing.epv = nothing.vel = nothing.cog = std::numeric_limits<std::uint16_t>::max();
    link.send(mavlink_msg_gps_raw_int_encode_status, nothing);
    return;
  }
  const bridge::frames::Geodetic place = global_position();
  const Vec3 velocity_ned = vehicle::swap_enu_ned(autopilot_.estimated_motion().velocity);
  const double course_deg = std::atan2(velocity_ned.y(), velocity_ned.x()) / vehicle::kDegree;
  mavlink_gps_raw_int_t message{};
  message.time_usec = boot_us();
  message.fix_type = GPS_FIX_TYPE_3D_FIX;
  message.lat = static_cast<std::int32_t>(std::llround(place.latitude_deg * 1e7));
  message.lon = static_cast<std::int32_t>(std::llround(place.longitude_deg * 1e7));
  message.alt = message.alt_ellipsoid = static_cast<std::int32_t>(std::llround(place.altitude_m * 1e3));
  message.eph = 70;
  message.epv = 110;
  message.vel = static_cast<std::uint16_t>(std::min(65534.0, std::round(velocity_ned.head<2>().norm() * 100.0)));
  message.cog = static_cast<std::uint16_t>(
      std::min(35999.0, std::floor((course_deg < 0 ? course_deg + 360.0 : course_deg) * 100.0)));
  message.satellites_visible = 10;
  message.h_acc = 900;
  message.v_acc = 1780;
  message.vel_acc = 400;
  link.send(mavlink_msg_gps_raw_int_encode_status, message);
}

void MavlinkEndpoint::Impl::send_scaled_pressure(MavlinkLink& link) {
  mavlink_scaled_pressure_t message{};
  message.time_boot_ms = boot_ms();
  message.press_abs = real(pressure_hpa(global_position().altitude_m));
  message.temperature = static_cast<std::int16_t>(kTemperatureDegC * 100.0F);
  link.send(mavlink_msg_scaled_pressure_encode_status, message);
}

void MavlinkEndpoint::Impl::send_battery(MavlinkLink& link) {
  constexpr std::size_t kCells = 10;
  constexpr std::uint16_t kVoltageMv = 16200;  // of the pack, as PX4's SITL
  constexpr std::uint16_t kNoCell = 65535;
  constexpr std::int16_t kNoTemperature = 32767;
  mavlink_battery_status_t message{};
  message.battery_function = MAV_BATTERY_FUNCTION_ALL;
  message.type = MAV_BATTERY_TYPE_LIPO;
  message.temperature = kNoTemperature;
  for (std::size_t cell = 0; cell < kCells; ++cell) message.voltages[cell] = cell == 0 ? kVoltageMv : kNoCell;
  message.current_battery = -100;
  message.energy_consumed = -1;
  message.battery_remaining = battery_percent(autopilot_.battery());
  message.charge_state = static_cast<std::uint8_t>(autopilot_.battery_level());
  link.send(mavlink_msg_battery_status_encode_status, message);
}

void MavlinkEndpoint::Impl::send_vibration(MavlinkLink& link) {
  mavlink_vibration_t message{};
  message.time_usec = boot_us();
  link.send(mavlink_msg_vibration_encode_status, message);
}

void MavlinkEndpoint::Impl::send_servos(MavlinkLink& link) {
  constexpr std::uint16_t kStopped = 900;
  const double idle = autopilot_.armed() ? 1000.0 : 900.0;
  const auto pulse = static_cast<std::uint16_t>(std::lround(idle + 1000.0 * throttle()));
  mavlink_servo_output_raw_t message{};
  message.time_usec = static_cast<std::uint32_t>(boot_us());
  message.servo1_raw = message.servo2_raw = message.servo3_raw = message.servo4_raw = pulse;
  message.servo5_raw = message.servo6_raw = message.servo7_raw = message.servo8_raw = kStopped;
  message.servo9_raw = message.servo10_raw = message.servo11_raw = message.servo12_raw = kStopped;
  message.servo13_raw = message.servo14_raw = message.servo15_raw = message.servo16_raw = kStopped;
  link.send(mavlink_msg_servo_output_raw_encode_status, message);
}

void MavlinkEndpoint::Impl::send_distance_sensor(MavlinkLink& link) {
  constexpr double kRange = 100.0;  // m
  const double height = autopilot_.height_above_ground();
  mavlink_distance_sensor_t message{};
  message.time_boot_ms = boot_ms();
  message.max_distance = static_cast<std::uint16_t>(kRange * 100.0);
  message.current_distance = static_cast<std::uint16_t>(std::lround(std::clamp(height, 0.0, kRange) * 100.0));
  message.type = MAV_DISTANCE_SENSOR_LASER;
  message.orientation = MAV_SENSOR_ROTATION_PITCH_270;
  link.send(mavlink_msg_distance_sensor_encode_status, message);
}

}  // namespace jink::sim::mavlink
