// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/cdr/px4_messages.hpp"

#include <cmath>

#include "bridge/cdr/input.hpp"
#include "bridge/frames/conversions.hpp"
#include "bridge/vehicle/px4.hpp"

namespace jink::bridge::cdr::px4 {

namespace {

constexpr std::size_t kEncapsulation_bytes = 4;
constexpr double kMaxPosition = 1e5;
constexpr double kMaxSpeed = 1e3;

enum class Layout { kUnversioned, kVersion0, kVersion1 };

// All layouts are of fixed length. RTPS pads a payload to whole words, which all of them are.
std::optional<Layout> layout_of(std::size_t payload_bytes) {
  switch (payload_bytes) {
    case kEncapsulation_bytes + 192:
      return Layout::kUnversioned;
    case kEncapsulation_bytes + 212:
      return Layout::kVersion0;
    case kEncapsulation_bytes + 216:
      return Layout::kVersion1;
    default:
      return std::nullopt;
  }
}

double take_float(CdrInput& input) {
  return static_cast<double>(input.take<float>());
}

Vec3 take_floats3(CdrInput& input) {
  const double x = take_float(input);
  const double y = take_float(input);
  const double z = take_float(input);
  return {x, y, z};
}

void skip_floats(CdrInput& input, int count) {
  for (int i = 0; i < count; ++i) input.take<float>();
}

// Up to and with the accelerations: the same in all layouts.
void take_motion(CdrInput& input, LocalPosition& message) {
  message.timestamp_us = input.take<std::uint64_t>();
  input.take<std::uint64_t>();  // timestamp_sample
  message.xy_valid = input.take<bool>();
  message.z_valid = input.take<bool>();
  message.v_xy_valid = input.take<bool>();
  message.v_z_valid = input.take<bool>();
  message.position_ned = take_floats3(input);
  message.shift_ned.x() = take_float(input);
  message.shift_ned.y() = take_float(input);
  message.xy_resets = input.take<std::uint8_t>();
  message.shift_ned.z() = take_float(input);
  message.z_resets = input.take<std::uint8_t>();
  message.velocity_ned = take_floats3(input);
  skip_floats(input, 3);       // z_deriv, delta_vxy
  input.take<std::uint8_t>();  // vxy_reset_counter
  skip_floats(input, 1);       // delta_vz
  input.take<std::uint8_t>();  // vz_reset_counter
  skip_floats(input, 3);       // ax, ay, az
}

void take_heading(CdrInput& input, Layout layout, LocalPosition& message) {
  message.heading = take_float(input);
  skip_floats(input, layout == Layout::kUnversioned ? 2 : 3);  // (heading_var), unaided_heading, delta_heading
  input.take<std::uint8_t>();                                  // heading_reset_counter
  input.take<bool>();                                          // heading_good_for_control
  if (layout != Layout::kUnversioned) skip_floats(input, 1);   // tilt_var
}

void take_origin(CdrInput& input, LocalPosition& message) {
  const bool xy_global = input.take<bool>();
  const bool z_global = input.take<bool>();
  message.global = xy_global && z_global;
  input.take<std::uint64_t>();  // ref_timestamp
  message.origin.latitude_deg = input.take<double>();
  message.origin.longitude_deg = input.take<double>();
  message.origin.altitude_m = take_float(input);
}

// From the terrain on; what follows dead_reckoning are limits.
void take_rest(CdrInput& input, Layout layout, LocalPosition& message) {
  if (layout == Layout::kUnversioned) {
    skip_floats(input, 1);       // dist_bottom
    input.take<bool>();          // dist_bottom_valid
    input.take<std::uint8_t>();  // dist_bottom_sensor_bitfield
  } else {
    input.take<bool>();          // dist_bottom_valid
    skip_floats(input, 3);       // dist_bottom, dist_bottom_var, delta_dist_bottom
    input.take<std::uint8_t>();  // dist_bottom_reset_counter
    input.take<std::uint8_t>();  // dist_bottom_sensor_bitfield
  }
  message.horizontal_accuracy = take_float(input);
  message.vertical_accuracy = take_float(input);
  skip_floats(input, 2);  // evh, evv
  message.dead_reckoning = input.take<bool>();
}

bool valid(const LocalPosition& m) {
  return m.xy_valid && m.z_valid && m.v_xy_valid && m.v_z_valid;
}

// Each comparison is false for NaN. An estimate that is not marked as valid may be anything.
bool sane(const LocalPosition& m) {
  if (valid(m) && !(m.position_ned.norm() <= kMaxPosition && m.velocity_ned.norm() <= kMaxSpeed)) return false;
  if (!m.global) return true;
  return std::abs(m.origin.latitude_deg) <= 90.0 && std::abs(m.origin.longitude_deg) <= 180.0 &&
         std::isfinite(m.origin.altitude_m);
}

void add(std::string& health, const char* what) {
  health += health.empty() ? what : std::string(", ") + what;
}

}  // namespace

std::optional<LocalPosition> decode_local_position(std::span<const std::uint8_t> payload) {
  const std::optional<Layout> layout = layout_of(payload.size());
  if (!layout) return std::nullopt;
  LocalPosition message;
  const bool whole = decode(payload, [&](CdrInput& input) {
    take_motion(input, message);
    take_heading(input, *layout, message);
    take_origin(input, message);
    take_rest(input, *layout, message);
    return true;
  });
  return whole ? std::optional(message) : std::nullopt;
}

bool LocalPositionFilter::update(const LocalPosition& message, double stamp, double now) {
  if (!sane(message)) return false;
  newest_ = message;
  if (message.global) origin_ = message.origin;
  if (!valid(message)) return true;
  if (valid_) count_resets(message, stamp);
  valid_ = message;
  valid_stamp_ = stamp;
  valid_at_ = now;
  return true;
}

void LocalPositionFilter::count_resets(const LocalPosition& message, double stamp) {
  const auto xy = static_cast<std::uint8_t>(message.xy_resets - valid_->xy_resets);
  const auto z = static_cast<std::uint8_t>(message.z_resets - valid_->z_resets);
  if (xy == 0 && z == 0) return;
  const Vec3 seen = message.position_ned - valid_->position_ned - (stamp - valid_stamp_) * message.velocity_ned;
  const auto jump = [&](std::uint8_t resets, Eigen::Index axis) {
    if (resets == 0) return 0.0;
    const bool told = resets == 1 && std::abs(message.shift_ned[axis]) <= kMaxPosition;
    return told ? message.shift_ned[axis] : seen[axis];
  };
  shift_ned_ += Vec3(jump(xy, 0), jump(xy, 1), jump(z, 2));
  resets_ += std::max(xy, z);
}

void LocalPositionFilter::apply(vehicle::VehicleState& state, double now) const {
  state.motion.stamp = valid_stamp_;
  state.motion.received = valid_at_;
  state.estimate_resets = resets_;
  state.estimate_shift = frames::enu_from_ned(shift_ned_);
  if (origin_) state.origin = origin_;
  if (valid_) {
    state.motion.value = {frames::enu_from_ned(valid_->position_ned), frames::enu_from_ned(valid_->velocity_ned)};
    const double sigma = vehicle::px4::position_sigma(valid_->horizontal_accuracy, valid_->vertical_accuracy);
    if (sigma > 0.0) state.position_sigma = sigma;
    if (std::isfinite(valid_->heading)) state.yaw = frames::yaw_enu_from_heading(valid_->heading);
  }
  const bool held = valid_ && now - valid_at_ <= kMaxAge_s && valid(*newest_);
  state.local_position_ok = held && std::isfinite(valid_->heading);
  if (!held) {
    add(state.health, "local position");
  } else if (!state.local_position_ok) {
    add(state.health, "heading");
  }
  if (held && valid_->dead_reckoning) add(state.health, "dead reckoning");
}

}  // namespace jink::bridge::cdr::px4
