// SPDX-License-Identifier: BSD-3-Clause
// Obstacle tracks over DDS, by Fast DDS: what the companion reads, and what the simulator and tools write. The type on
// the wire is ROS 2's (bridge/dds/idl), so that a ROS node, or any other DDS program, can stand at either end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/dds/participant.hpp"
#include "bridge/frames/geodetic.hpp"
#include "bridge/tracking/track_inbox.hpp"

namespace jink::bridge::dds {

// Without a namespace.
inline constexpr const char* kTracksTopic = "rt/jink/obstacle_tracks";  ///< ROS 2: /jink/obstacle_tracks
inline constexpr const char* kTracksType = "jink_msgs::msg::dds_::ObstacleTracks_";
/// ROS 2: /perception/object_recognition/tracking/objects
inline constexpr const char* kAutowareTopic = "rt/perception/object_recognition/tracking/objects";
inline constexpr const char* kAutowareType = "autoware_perception_msgs::msg::dds_::TrackedObjects_";
/// ROS 2: /jink/detections
inline constexpr const char* kVisionTopic = "rt/jink/detections";
inline constexpr const char* kVisionType = "vision_msgs::msg::dds_::Detection3DArray_";

/// Who makes the tracks: a program of jink's topic, in the frame `map` (ENU about the autopilot's local origin) or
/// `ned`; or Autoware's perception, or a detector in space, in `map` alone. In the order of config::TrackTopic.
enum class TrackFormat { kJink, kAutoware, kVision };

/// What a topic of tracks carries.
struct TrackTopicInfo {
  const char* topic;  ///< without a namespace
  const char* type;
  const char* name;  ///< of the type, in words; empty: jink's own
  bool ned;          ///< whether the frame `ned` is known beside `map`
  /// Nothing where a payload is not of the type.
  std::optional<tracking::DecodedTracks> (*decode)(std::span<const std::uint8_t> payload);
};
[[nodiscard]] const TrackTopicInfo& track_topic_info(TrackFormat format);

/// Which topic is read, whose messages of it, and where their frame is.
struct TrackReaderOptions {
  TrackFormat format = TrackFormat::kJink;
  std::string name_space{};  ///< before the topic: "uav_1" means rt/uav_1/...; empty: none
  /// Participants, by name, that are heard, and the number with which their messages are marked (TrackMessage::named);
  /// empty: all are, unmarked.
  std::map<std::string, std::size_t> writers{};
  std::optional<frames::Geodetic> origin{};  ///< of the frame; none: the autopilot's local origin
  /// The autopilot's, as it stands; asked where `origin` is given. Safe from any thread.
  std::function<std::optional<frames::Geodetic>()> local_origin{};
};
/// The topic on the wire.
[[nodiscard]] std::string track_topic(TrackFormat format, const std::string& name_space);

/// Reads a topic of tracks best effort, volatile, keep last, so that a writer of any reliability and durability
/// matches; by the node's transports. Messages are checked and converted to ENU on Fast DDS's thread and queued; when
/// nobody polls, the oldest go. All functions are safe from any thread and never block.
///
/// A message in another frame, of a writer that is not to be heard, or that cannot be placed yet, is refused whole; a
/// track with non-finite or absurd values (TrackLimits) is left out of its message; a payload that is no message of the
/// type is refused before anything is allocated for it.
class DdsTrackReader final : public tracking::TrackSource {
 public:
  /// Returns at once; discovery goes on in the background. `node` and `clock` must outlive the reader.
  /// @throws std::runtime_error, one line, when Fast DDS cannot make it.
  DdsTrackReader(DdsParticipant& node, const base::Clock& clock, const TrackReaderOptions& options = {});
  /// Of jink's topic, on a node of its own. @throws as DdsParticipant's.
  DdsTrackReader(int domain, const base::Clock& clock);
  ~DdsTrackReader() override;
  DdsTrackReader(const DdsTrackReader&) = delete;
  DdsTrackReader& operator=(const DdsTrackReader&) = delete;

  bool poll(tracking::TrackMessage& message) override;
  [[nodiscard]] tracking::TrackSourceStatus status() const override;
  void notify(base::Notifier& notifier) override;

  /// Messages thrown away unread because nobody polled.
  [[nodiscard]] std::uint64_t overruns() const;
  /// Payloads that could not be decoded.
  [[nodiscard]] std::uint64_t malformed() const;

 private:
  class Impl;
  std::unique_ptr<DdsParticipant> own_node_;  // outlives impl_; null where the node is another's
  std::unique_ptr<Impl> impl_;
};

/// Writes the topic best effort, volatile. Not safe for concurrent publish().
class DdsTrackWriter {
 public:
  /// Returns at once; discovery goes on in the background. `node` must outlive the writer. @throws as DdsTrackReader's.
  explicit DdsTrackWriter(DdsParticipant& node, const std::string& name_space = {});
  /// On a node of its own. @throws as DdsParticipant's.
  explicit DdsTrackWriter(int domain, const std::string& name_space = {}, const std::filesystem::path& security = {});
  ~DdsTrackWriter();
  DdsTrackWriter(const DdsTrackWriter&) = delete;
  DdsTrackWriter& operator=(const DdsTrackWriter&) = delete;

  /// Sends one message with all of `tracks`, as they are: in the frame that `frame_id` names, unchecked. Their bodies
  /// go as shapes where they are a box, cylinder, capsule or hull of at most cdr::kMostVertices. `stamp_unix_s` is
  /// system time, seconds since 1970. False when Fast DDS does not take it. With no reader there it goes nowhere.
  [[nodiscard]] bool publish(std::span<const planner::base::Track> tracks, double stamp_unix_s,
                             const std::string& frame_id = "map");
  /// Readers matched now.
  [[nodiscard]] int readers() const;

 private:
  class Impl;
  std::unique_ptr<DdsParticipant> own_node_;  // outlives impl_; null where the node is another's
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge::dds
