// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/frames.hpp"

#include <cmath>
#include <numbers>

namespace jink::bridge {

using planner::Vec3;
using std::numbers::pi;

Vec3 enu_from_ned(const Vec3& ned) {
  return {ned.y(), ned.x(), -ned.z()};
}

Vec3 ned_from_enu(const Vec3& enu) {
  return {enu.y(), enu.x(), -enu.z()};
}

double wrap_angle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * pi);  // [-pi, pi], exact
  return wrapped <= -pi ? pi : wrapped;
}

double yaw_enu_from_heading(double heading_ned) {
  return wrap_angle(pi / 2.0 - heading_ned);
}

double heading_from_yaw_enu(double yaw_enu) {
  return wrap_angle(pi / 2.0 - yaw_enu);
}

}  // namespace jink::bridge
