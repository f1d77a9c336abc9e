// SPDX-License-Identifier: BSD-3-Clause
// Obstacles from Autoware's perception: its TrackedObjects on DDS as obstacle tracks.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "bridge/clock.hpp"
#include "bridge/dds_node.hpp"
#include "bridge/track_inbox.hpp"

namespace jink::bridge {

/// ROS 2: /perception/object_recognition/tracking/objects
inline constexpr const char* kAutowareTopic = "rt/perception/object_recognition/tracking/objects";
inline constexpr const char* kAutowareType = "autoware_perception_msgs::msg::dds_::TrackedObjects_";

/// Decodes a payload (encapsulation and CDR); nothing where it is no TrackedObjects. Pure.
///
/// An object becomes a track so: its id is a hash (FNV-1a) of the 16 bytes of its UUID; twist and acceleration are in
/// the object's own frame and are turned by its orientation (an orientation of zeros counts as none where the message
/// says that there is none, else the object is left out); the radius is that of the sphere around its shape: half the
/// diagonal of a bounding box, radius and half height of a cylinder, the farthest point of a footprint and half the
/// height of a polygon; position_sigma and velocity_sigma are the largest standard deviation in any direction, leaving
/// out those of 100 and more, which stand for "no information"; 0 where none is left or the covariance is marked as
/// unknown
/// (-1). Classification and existence probability do not matter: all that is
/// tracked is avoided. [autoware_msgs, autoware_perception_msgs/msg]
[[nodiscard]] std::optional<DecodedTracks> decode_tracked_objects(std::span<const std::uint8_t> payload);

/// Reads the topic best effort, volatile, keep last; Autoware publishes reliable, volatile, which matches. Only
/// messages in the frame `map` are taken, which must be ENU about the autopilot's local origin; others are refused
/// whole and counted. All functions are safe from any thread and never block.
class DdsAutowareReader final : public TrackSource {
 public:
  /// Returns at once. `node` and `clock` must outlive it. @throws std::runtime_error, one line.
  DdsAutowareReader(DdsNode& node, const Clock& clock);
  ~DdsAutowareReader() override;
  DdsAutowareReader(const DdsAutowareReader&) = delete;
  DdsAutowareReader& operator=(const DdsAutowareReader&) = delete;

  bool poll(TrackMessage& message) override;
  [[nodiscard]] TrackSourceStatus status() const override;
  void notify(Wake& wake) override;
  /// Messages thrown away unread because nobody polled.
  [[nodiscard]] std::uint64_t overruns() const;
  /// Payloads that could not be decoded.
  [[nodiscard]] std::uint64_t malformed() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge
