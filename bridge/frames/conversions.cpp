// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/frames/conversions.hpp"

#include <cmath>
#include <numbers>

namespace jink::bridge::frames {

using std::numbers::pi;

Vec3 enu_from_ned(const Vec3& ned) {
  return {ned.y(), ned.x(), -ned.z()};
}

Eigen::Matrix3d enu_from_ned_axes() {
  Eigen::Matrix3d axes;
  axes << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  return axes;
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

Eigen::Quaterniond attitude_enu(double yaw_enu, double pitch, double roll) {
  return Eigen::AngleAxisd(yaw_enu, Vec3::UnitZ()) * Eigen::AngleAxisd(-pitch, Vec3::UnitY()) *
         Eigen::AngleAxisd(roll, Vec3::UnitX());
}

double heading_from_yaw_enu(double yaw_enu) {
  return wrap_angle(pi / 2.0 - yaw_enu);
}

LocalFrame::LocalFrame(const Geodetic& origin)
    : origin_(origin), tangent_plane_(origin.latitude_deg, origin.longitude_deg, origin.altitude_m) {}

Geodetic LocalFrame::to_geodetic(const Vec3& position_enu) const {
  Geodetic result;
  tangent_plane_.Reverse(position_enu.x(), position_enu.y(), position_enu.z(), result.latitude_deg,
                         result.longitude_deg, result.altitude_m);
  return result;
}

Vec3 LocalFrame::to_enu(const Geodetic& position) const {
  Vec3 result;
  tangent_plane_.Forward(position.latitude_deg, position.longitude_deg, position.altitude_m, result.x(), result.y(),
                         result.z());
  return result;
}

Eigen::Isometry3d between(const Geodetic& from, const Geodetic& to) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  if (from == to) return result;
  constexpr double kArm = 1e4;  // m, so long that the conversions' rounding is nothing to it
  const LocalFrame source(from);
  const LocalFrame target(to);
  const auto convert = [&](const Vec3& position) { return target.to_enu(source.to_geodetic(position)); };
  result.translation() = convert(Vec3::Zero());
  for (Eigen::Index i = 0; i < 3; ++i)
    result.linear().col(i) = (convert(kArm * Vec3::Unit(i)) - result.translation()) / kArm;
  return result;
}

}  // namespace jink::bridge::frames
