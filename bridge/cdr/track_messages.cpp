// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/cdr/track_messages.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unordered_set>
#include <utility>
#include <vector>

#include "bridge/cdr/input.hpp"
#include "bridge/frames/conversions.hpp"
#include "planner/base/portable_math.hpp"
#include "planner/base/solid.hpp"

namespace jink::bridge::cdr {

namespace {

using planner::base::Solid;
using planner::base::Track;

constexpr std::size_t kWireTrack_bytes = 8 + 9 * 8 + 3 * 8;
// At the least: without vertices, and where the type stands in the four bytes before a double.
constexpr std::size_t kWireShape_bytes = 4 + (3 + 4 + 1 + 3) * 8 + 4;
constexpr std::size_t kVertex_bytes = 3 * 8;

// In the order of the IDL.
Track take_track(CdrInput& input, bool ned) {
  Track track;
  track.id = input.take<std::uint64_t>();
  track.position = take_vec3(input);
  track.velocity = take_vec3(input);
  track.acceleration = take_vec3(input);
  if (ned) {
    track.position = frames::enu_from_ned(track.position);
    track.velocity = frames::enu_from_ned(track.velocity);
    track.acceleration = frames::enu_from_ned(track.acceleration);
  }
  track.radius = input.take<double>();
  track.position_sigma = input.take<double>();
  track.velocity_sigma = input.take<double>();
  return track;
}

constexpr const char* kNoShape = "shape is not finite or out of range";
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// At the least, without classification and footprint: what a stated number of objects is checked against.
constexpr std::size_t kObject_bytes = 16 + 4 + 4 + (7 + 36 + 6 + 36 + 6 + 36) * 8 + 2 + 1 + 4 + 3 * 8;
constexpr std::size_t kClassification_bytes = 5;
constexpr std::size_t kPoint32_bytes = 12;
// Likewise, with empty texts.
constexpr std::size_t kDetection_bytes = 8 + 4 + 4 + (7 + 3) * 8 + 4;
constexpr std::size_t kResult_bytes = 4 + 8 + (7 + 36) * 8;

// A variance (m^2, m^2/s^2) beyond which a writer says that it knows nothing in that direction.
constexpr double kNoInformation = 1e4;

enum class ShapeType : std::uint8_t { kBoundingBox = 0, kCylinder = 1, kPolygon = 2 };
constexpr std::uint8_t kOrientationUnavailable = 0;
constexpr double kFastestTurn = 10.0;  // rad/s

Eigen::Quaterniond take_quaternion(CdrInput& input) {
  const Vec3 vec = take_vec3(input);
  const auto w = input.take<double>();
  return {w, vec.x(), vec.y(), vec.z()};
}

// The largest standard deviation in any direction of the upper left block of a 6 x 6 covariance: that of position or
// linear velocity. 0 where the writer marks it as unknown; NaN where it is none.
double take_sigma(CdrInput& input) {
  std::array<double, 36> values{};
  for (double& value : values) value = input.take<double>();
  Eigen::Matrix3d block;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      block(row, column) = values[static_cast<std::size_t>(6 * row + column)];
    }
  }
  if (block(0, 0) == -1.0) return 0.0;
  if (!block.allFinite()) return kNaN;
  const Eigen::Matrix3d symmetric = 0.5 * (block + block.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric, Eigen::EigenvaluesOnly);
  double largest = 0.0;
  for (const double variance : solver.eigenvalues()) {
    if (variance < kNoInformation) largest = std::max(largest, variance);
  }
  return std::sqrt(largest);
}

// A shape in an object's own frame. The radius is that of the sphere around it.
struct ObjectShape {
  double radius = kNaN;
  std::shared_ptr<const Solid> solid;
};

// A footprint and a height as the vertices of their hull; none of more than a sensor's cluster has.
std::shared_ptr<const Solid> prism_over(const std::vector<Vec3>& footprint, double height,
                                        const Eigen::Matrix3d& axes) {
  constexpr std::size_t kMostPoints = 64;
  if (footprint.size() > kMostPoints) return nullptr;
  std::vector<Vec3> vertices;
  for (const Vec3& point : footprint) {
    for (const double z : {-0.5 * height, 0.5 * height}) vertices.emplace_back(axes * (point + Vec3(0.0, 0.0, z)));
  }
  return Solid::hull(std::move(vertices));
}

// The solid is turned as the object's axes are, which may be NaN.
ObjectShape take_shape(CdrInput& input, const Eigen::Matrix3d& axes) {
  const auto type = static_cast<ShapeType>(input.take<std::uint8_t>());
  std::vector<Vec3> footprint;
  double farthest = 0.0;  // of its points from the object's centre
  bool finite = axes.allFinite();
  for (std::uint32_t points = input.take_length(kPoint32_bytes); points > 0; --points) {
    const auto x = static_cast<double>(input.take<float>());
    const auto y = static_cast<double>(input.take<float>());
    input.take<float>();
    const double distance = planner::base::hypotenuse(x, y);
    footprint.emplace_back(x, y, 0.0);
    farthest = std::max(farthest, distance);
    finite = finite && std::isfinite(distance);
  }
  const Vec3 size = take_vec3(input);
  if (!finite || !size.allFinite() || size.minCoeff() < 0.0) return {};
  const Solid::Pose pose{Vec3::Zero(), axes};
  switch (type) {
    case ShapeType::kCylinder: {  // x and y are its diameter
      const double diameter = std::max(size.x(), size.y());
      return {0.5 * planner::base::hypotenuse(diameter, size.z()), Solid::cylinder(0.5 * diameter, size.z(), pose)};
    }
    case ShapeType::kPolygon:
      if (farthest > 0.0)
        return {planner::base::hypotenuse(farthest, 0.5 * size.z()), prism_over(footprint, size.z(), axes)};
      [[fallthrough]];
    case ShapeType::kBoundingBox:
      return {0.5 * size.norm(), Solid::box(size, pose)};
  }
  return {};
}

// The rotation from the object's frame to the map; of NaN where there is no telling.
Eigen::Matrix3d rotation(const Eigen::Quaterniond& orientation, bool available) {
  const double norm = orientation.norm();
  if (norm == 0.0 && !available) return Eigen::Matrix3d::Identity();
  if (!(norm > 0.5 && norm < 2.0)) return Eigen::Matrix3d::Constant(kNaN);
  return orientation.normalized().toRotationMatrix();
}

Track take_object(CdrInput& input) {
  Track track;
  std::array<std::uint8_t, 16> uuid{};
  for (auto& byte : uuid) byte = input.take<std::uint8_t>();
  track.id = fnv1a(uuid);
  input.take<float>();  // existence_probability
  for (std::uint32_t labels = input.take_length(kClassification_bytes); labels > 0; --labels) {
    input.take<std::uint8_t>();
    input.take<float>();
  }
  track.position = take_vec3(input);
  const Eigen::Quaterniond orientation = take_quaternion(input);
  track.position_sigma = take_sigma(input);
  const Vec3 velocity = take_vec3(input);
  const Vec3 turning = take_vec3(input);
  track.velocity_sigma = take_sigma(input);
  const Vec3 acceleration = take_vec3(input);
  take_vec3(input);  // angular
  for (int i = 0; i < 36; ++i) input.take<double>();
  const bool available = input.take<std::uint8_t>() != kOrientationUnavailable;
  input.take<bool>();  // is_stationary
  const Eigen::Matrix3d to_map = rotation(orientation, available);
  track.velocity = to_map * velocity;
  track.acceleration = to_map * acceleration;
  const ObjectShape shape = take_shape(input, to_map);
  track.radius = shape.radius;
  // What turns too fast to be believed may be turned anyhow: all of the sphere.
  const double yaw_rate = (to_map * turning).z();
  if (std::abs(yaw_rate) <= kFastestTurn) track.body = {shape.solid, 0.0, yaw_rate};
  return track;
}

// The solid of a shape; null where it is none. Throws std::invalid_argument where a number of it is none.
std::shared_ptr<const Solid> solid_of(ShapeOnWire type, const Vec3& size, const Solid::Pose& pose,
                                      std::vector<Vec3> vertices) {
  switch (type) {
    case ShapeOnWire::kBox:
      return Solid::box(size, pose);
    case ShapeOnWire::kCylinder:
      return Solid::cylinder(0.5 * size.x(), size.z(), pose);
    case ShapeOnWire::kCapsule: {
      const Vec3 along = 0.5 * (size.z() - size.x()) * pose.axes.col(2);
      if (size.z() < size.x()) return nullptr;
      return Solid::capsule(0.5 * size.x(), pose.center - along, pose.center + along);
    }
    case ShapeOnWire::kHull:
      return vertices.size() > kMostVertices ? nullptr : Solid::hull(std::move(vertices));
    case ShapeOnWire::kSphere:
      break;
  }
  return nullptr;
}

// In the order of the IDL; nothing where it is no shape. `to_enu` turns the message's frame.
std::optional<planner::base::Body> take_body(CdrInput& input, const Eigen::Matrix3d& to_enu) {
  const auto type = static_cast<ShapeOnWire>(input.take<std::uint8_t>());
  Solid::Pose pose;
  pose.center = to_enu * take_vec3(input);
  pose.axes = to_enu * rotation(take_quaternion(input), false);
  const double yaw_rate = to_enu(2, 2) * input.take<double>();
  const Vec3 size = take_vec3(input);
  std::vector<Vec3> vertices(input.take_length(kVertex_bytes));
  for (Vec3& vertex : vertices) vertex = pose.axes * take_vec3(input);
  if (type == ShapeOnWire::kSphere) return planner::base::Body();
  try {
    planner::base::Body body{solid_of(type, size, pose, std::move(vertices)), 0.0, yaw_rate};
    if (body.solid != nullptr) return body;
  } catch (const std::invalid_argument&) {
  }
  return std::nullopt;
}

/// A detection as a track, and what is wrong with it: null for nothing yet.
struct Detection {
  Track track;
  const char* bad = nullptr;
};

std::uint64_t id_of(const std::string& text) {
  std::uint64_t number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec == std::errc() && read.ptr == text.data() + text.size()) return number;
  return fnv1a({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});  // NOLINT: a text's bytes
}

// In the order of the IDL. `frame` is the message's; `named` holds the ids before.
Detection take_detection(CdrInput& input, const std::string& frame, std::unordered_set<std::uint64_t>& named) {
  Detection detection;
  Track& track = detection.track;
  const std::string own_frame = take_header(input).frame_id;
  const std::uint32_t results = input.take_length(kResult_bytes);
  for (std::uint32_t i = 0; i < results; ++i) {
    input.take<std::string>();  // class_id
    input.take<double>();       // score
    for (int k = 0; k < 7; ++k) input.take<double>();
    const double sigma = take_sigma(input);
    if (i == 0) track.position_sigma = sigma;
  }
  if (track.position_sigma == 0.0) track.position_sigma = kDetectionSigma;
  track.position = take_vec3(input);
  const Solid::Pose pose{Vec3::Zero(), rotation(take_quaternion(input), false)};
  const Vec3 size = take_vec3(input);
  track.radius = 0.5 * size.norm();
  const auto id = input.take<std::string>();
  track.id = id_of(id);
  if (id.empty() || !named.insert(track.id).second) {
    detection.bad = "id is empty or that of another";
  } else if (!own_frame.empty() && own_frame != frame) {
    detection.bad = "frame_id is not that of the message";
  } else if (!pose.axes.allFinite() || !size.allFinite() || size.minCoeff() < 0.0) {
    detection.bad = kNoShape;
  } else {
    track.body.solid = Solid::box(size, pose);
  }
  return detection;
}

// How many shapes follow the tracks: none where the writer knows of none.
std::uint32_t shapes_left(CdrInput& input) {
  return input.has(sizeof(std::uint32_t)) ? input.take_length(kWireShape_bytes) : 0;
}

}  // namespace

std::optional<tracking::DecodedTracks> decode_obstacle_tracks(std::span<const std::uint8_t> payload) {
  tracking::DecodedTracks message;
  const bool whole = decode(payload, [&](CdrInput& input) {
    const StampedFrame header = take_header(input);
    message.frame_id = header.frame_id;
    message.stamp_unix_s = header.stamp_unix_s;
    const bool ned = header.frame_id == "ned";
    std::vector<Track> tracks(input.take_length(kWireTrack_bytes));
    for (Track& track : tracks) track = take_track(input, ned);
    const std::uint32_t shapes = shapes_left(input);
    if (shapes != 0 && shapes != tracks.size()) return false;
    const Eigen::Matrix3d to_enu = ned ? frames::enu_from_ned_axes() : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    tracking::TrackValidator validator(message.tracks, tracks.size());
    for (Track& track : tracks) {
      const std::optional<planner::base::Body> body = shapes == 0 ? planner::base::Body() : take_body(input, to_enu);
      if (body) track.body = *body;
      validator.add(track, body ? nullptr : kNoShape);
    }
    message.why = validator.why();
    return true;
  });
  return whole ? std::optional(std::move(message)) : std::nullopt;
}

std::optional<tracking::DecodedTracks> decode_detections(std::span<const std::uint8_t> payload) {
  tracking::DecodedTracks message;
  message.tracks.positions_only = true;
  const bool whole = decode(payload, [&](CdrInput& input) {
    const StampedFrame header = take_header(input);
    message.frame_id = header.frame_id;
    message.stamp_unix_s = header.stamp_unix_s;
    const std::uint32_t count = input.take_length(kDetection_bytes);
    tracking::TrackValidator validator(message.tracks, count);
    std::unordered_set<std::uint64_t> named;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Detection detection = take_detection(input, header.frame_id, named);
      validator.add(detection.track, detection.bad);
    }
    message.why = validator.why();
    return true;
  });
  return whole ? std::optional(std::move(message)) : std::nullopt;
}

std::optional<tracking::DecodedTracks> decode_tracked_objects(std::span<const std::uint8_t> payload) {
  tracking::DecodedTracks message;
  const bool whole = decode(payload, [&](CdrInput& input) {
    const StampedFrame header = take_header(input);
    message.frame_id = header.frame_id;
    message.stamp_unix_s = header.stamp_unix_s;
    const std::uint32_t count = input.take_length(kObject_bytes);
    tracking::TrackValidator validator(message.tracks, count);
    for (std::uint32_t i = 0; i < count; ++i) validator.add(take_object(input));
    message.why = validator.why();
    return true;
  });
  return whole ? std::optional(std::move(message)) : std::nullopt;
}

}  // namespace jink::bridge::cdr
