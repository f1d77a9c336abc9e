// SPDX-License-Identifier: BSD-3-Clause
// Messages of obstacle tracks out of DDS payloads: ours and Autoware's. No DDS here: pure functions of bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "bridge/tracking/track_inbox.hpp"

namespace jink::bridge::cdr {

/// What an ObstacleShape is; ObstacleShape.msg says what its numbers are.
enum class ShapeOnWire : std::uint8_t { kSphere = 0, kBox = 1, kCylinder = 2, kCapsule = 3, kHull = 4 };
inline constexpr std::size_t kMostVertices = 256;  ///< of a hull

/// Decodes a payload (encapsulation and CDR); nothing where it is no ObstacleTracks, or one with shapes for some of its
/// tracks only. Tracks in the frame `ned` come out in ENU. Where the payload ends with its tracks, or has no shapes,
/// all are spheres. A track whose shape is none, or reaches out of its sphere, is left out. Pure.
[[nodiscard]] std::optional<tracking::DecodedTracks> decode_obstacle_tracks(std::span<const std::uint8_t> payload);

/// Decodes a payload (encapsulation and CDR); nothing where it is no TrackedObjects. Pure.
///
/// An object becomes a track so: its id is a hash (FNV-1a) of the 16 bytes of its UUID; twist and acceleration are in
/// the object's own frame and are turned by its orientation (an orientation of zeros counts as none where the message
/// says that there is none, else the object is left out); the radius is that of the sphere around its shape: half the
/// diagonal of a bounding box, radius and half height of a cylinder, the farthest point of a footprint and half the
/// height of a polygon; the body in it is the box, the cylinder, or the hull over the footprint (of at most 64 points),
/// turned as the object is, turning as its twist says about the vertical; position_sigma and velocity_sigma are the
/// largest standard deviation in any direction, leaving out those of 100 and more, which stand for "no information"; 0
/// where none is left or the covariance is marked as unknown (-1). Classification and existence probability do not
/// matter: all that is tracked is avoided. [autoware_msgs, autoware_perception_msgs/msg]
[[nodiscard]] std::optional<tracking::DecodedTracks> decode_tracked_objects(std::span<const std::uint8_t> payload);

}  // namespace jink::bridge::cdr
