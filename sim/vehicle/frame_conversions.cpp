// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle/frame_conversions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jink::sim::vehicle {

Vec3 swap_enu_ned(const Vec3& v) {
  return {v.y(), v.x(), -v.z()};
}

Vec3 swap_flu_frd(const Vec3& v) {
  return {v.x(), -v.y(), -v.z()};
}

double swap_yaw(double yaw) {
  return std::remainder(std::numbers::pi / 2.0 - yaw, 2.0 * std::numbers::pi);
}

Eigen::Quaterniond attitude_ned(const Eigen::Quaterniond& attitude_enu) {
  const double half = std::sqrt(0.5);
  const Eigen::Quaterniond world(0.0, half, half, 0.0);  // half a turn about north-east: ENU to NED
  const Eigen::Quaterniond body(0.0, 1.0, 0.0, 0.0);     // half a turn about x: FLU to FRD
  Eigen::Quaterniond result = world * attitude_enu * body;
  if (result.w() < 0.0) result.coeffs() *= -1.0;
  return result;
}

RollPitchYaw roll_pitch_yaw(const Eigen::Quaterniond& attitude) {
  const Eigen::Matrix3d r = attitude.toRotationMatrix();
  return {std::atan2(r(2, 1), r(2, 2)), -std::asin(std::clamp(r(2, 0), -1.0, 1.0)), std::atan2(r(1, 0), r(0, 0))};
}

}  // namespace jink::sim::vehicle
