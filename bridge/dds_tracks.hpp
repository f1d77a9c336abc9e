// SPDX-License-Identifier: BSD-3-Clause
// Obstacle tracks over DDS, by Fast DDS: what the companion reads, and what the simulator and tools write. The type on
// the wire is ROS 2's (bridge/idl), so that a ROS node, or any other DDS program, can stand at either end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "bridge/clock.hpp"
#include "bridge/track_source.hpp"

namespace jink::bridge {

inline constexpr const char* kTracksTopic = "rt/jink/obstacle_tracks";  ///< ROS 2: /jink/obstacle_tracks
inline constexpr int kMaxDdsDomain = 232;                               ///< the port formula of DDS ends there

/// Limits beyond which a track is absurd and left out, and how much is taken at once. Norms for vectors.
struct TrackLimits {
  static constexpr double kPosition = 1e5;
  static constexpr double kVelocity = 1e3;
  static constexpr double kAcceleration = 1e3;
  static constexpr double kRadius = 1e3;  ///< and above 0
  static constexpr double kSigma = 1e3;   ///< position and velocity; not negative
  static constexpr std::size_t kTracksPerMessage = 4096;
  static constexpr std::size_t kQueuedMessages = 64;
};

/// Reads the topic best effort, volatile, keep last, so that a writer of any reliability and durability matches; over
/// UDP and shared memory, with plain multicast discovery. Messages are checked and converted to ENU on Fast DDS's
/// thread and queued; when nobody polls, the oldest go. All functions are safe from any thread and never block.
///
/// A message whose frame_id is neither `map` (ENU) nor `ned` is refused whole; a track with non-finite or absurd values
/// (TrackLimits) is left out of its message; a payload that is no ObstacleTracks message is refused by its size before
/// anything is allocated for it.
class DdsTrackReader final : public TrackSource {
 public:
  /// Returns at once; discovery goes on in the background. `clock` must outlive the reader.
  /// @throws std::runtime_error, one line, for a domain outside [0, 232] or when Fast DDS cannot open its transports.
  DdsTrackReader(int domain, const Clock& clock);
  ~DdsTrackReader() override;
  DdsTrackReader(const DdsTrackReader&) = delete;
  DdsTrackReader& operator=(const DdsTrackReader&) = delete;

  bool poll(TrackMessage& message) override;
  [[nodiscard]] TrackSourceStatus status() const override;

  /// Messages thrown away unread because nobody polled.
  [[nodiscard]] std::uint64_t overruns() const;
  /// Payloads that could not be decoded.
  [[nodiscard]] std::uint64_t malformed() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes the topic best effort, volatile. Not safe for concurrent publish().
class DdsTrackWriter {
 public:
  /// Returns at once; discovery goes on in the background. @throws as DdsTrackReader's.
  explicit DdsTrackWriter(int domain);
  ~DdsTrackWriter();
  DdsTrackWriter(const DdsTrackWriter&) = delete;
  DdsTrackWriter& operator=(const DdsTrackWriter&) = delete;

  /// Sends one message with all of `tracks`, as they are: in the frame that `frame_id` names, unchecked. `stamp_unix_s`
  /// is system time, seconds since 1970. False when Fast DDS does not take it. With no reader there it goes nowhere.
  [[nodiscard]] bool publish(std::span<const planner::Track> tracks, double stamp_unix_s,
                             const std::string& frame_id = "map");
  /// Readers matched now.
  [[nodiscard]] int readers() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge
