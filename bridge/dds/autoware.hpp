// SPDX-License-Identifier: BSD-3-Clause
// Obstacles from Autoware's perception: its TrackedObjects on DDS as obstacle tracks.
#pragma once

#include <cstdint>
#include <memory>

#include "bridge/base/clock.hpp"
#include "bridge/dds/participant.hpp"
#include "bridge/tracking/track_inbox.hpp"

namespace jink::bridge::dds {

/// ROS 2: /perception/object_recognition/tracking/objects
inline constexpr const char* kAutowareTopic = "rt/perception/object_recognition/tracking/objects";
inline constexpr const char* kAutowareType = "autoware_perception_msgs::msg::dds_::TrackedObjects_";

/// Reads the topic best effort, volatile, keep last; Autoware publishes reliable, volatile, which matches. Only
/// messages in the frame `map` are taken, which must be ENU about the autopilot's local origin; others are refused
/// whole and counted. All functions are safe from any thread and never block.
class DdsAutowareReader final : public tracking::TrackSource {
 public:
  /// Returns at once. `node` and `clock` must outlive it. @throws std::runtime_error, one line.
  DdsAutowareReader(DdsParticipant& node, const base::Clock& clock);
  ~DdsAutowareReader() override;
  DdsAutowareReader(const DdsAutowareReader&) = delete;
  DdsAutowareReader& operator=(const DdsAutowareReader&) = delete;

  bool poll(tracking::TrackMessage& message) override;
  [[nodiscard]] tracking::TrackSourceStatus status() const override;
  void notify(base::Notifier& notifier) override;
  /// Messages thrown away unread because nobody polled.
  [[nodiscard]] std::uint64_t overruns() const;
  /// Payloads that could not be decoded.
  [[nodiscard]] std::uint64_t malformed() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge::dds
