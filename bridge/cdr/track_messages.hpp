// SPDX-License-Identifier: BSD-3-Clause
// Messages of obstacle tracks out of DDS payloads: ours, Autoware's and vision_msgs'. No DDS here: pure functions of
// bytes.
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

/// Decodes a payload (encapsulation and CDR); nothing where it is no Detection3DArray. Pure.
///
/// A detection becomes a track so: its id is the number that the text is, or a hash of the text (FNV-1a); the position
/// is the centre of its box, the body the box, turned as its pose says (an orientation of zeros counts as none), the
/// radius half the box's diagonal; position_sigma is as with TrackedObjects, of the first result, or kDetectionSigma
/// where that states none. It has no velocity (TrackMessage::positions_only), and nothing says how it turns. Left out
/// are those whom nothing tells from others: with no id, or with that of one before in the message; and those with a
/// frame of their own. Classes and scores do not matter. [vision_msgs 4, vision_msgs/msg]
[[nodiscard]] std::optional<tracking::DecodedTracks> decode_detections(std::span<const std::uint8_t> payload);
inline constexpr double kDetectionSigma = 0.1;  ///< m, of a box around some cloud of points

}  // namespace jink::bridge::cdr
