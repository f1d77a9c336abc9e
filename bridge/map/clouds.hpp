// SPDX-License-Identifier: BSD-3-Clause
// Where clouds of points come from. Two implementations: bridge/dds/clouds and the virtual-time scan of
// sim/flight/virtual_clouds.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/base/stamped.hpp"

namespace jink::bridge::map {

/// What a depth camera or a lidar saw at once, m. A point that is not finite is a ray without a return.
struct Cloud : base::Reception<base::Frame::kLocal> {
  std::vector<Eigen::Vector3f> points;
  bool mounted = true;  ///< in the frame that the mission mounts on the vehicle; else local ENU
};

/// Limits beyond which a cloud is of no use.
struct CloudLimits {
  static constexpr double kOldest = 0.5;           ///< s, of a stamp; a vehicle at 4 m/s is 2 m farther then
  static constexpr double kAhead = 0.1;            ///< s, that a stamp may be ahead of this computer's time
  static constexpr std::size_t kPoints = 500'000;  ///< of a cloud
  static constexpr std::size_t kQueued = 4;        ///< clouds
};

/// What was refused at the door since the start; for events and summaries.
struct CloudSourceStatus {
  int writers = 0;              ///< matched now
  std::uint64_t clouds = 0;     ///< accepted
  std::uint64_t refused = 0;    ///< for their frame or their stamp, or since they hold nothing
  std::uint64_t malformed = 0;  ///< payloads that are no clouds of points
  std::string last_refusal;     ///< why, of the newest refusal
};

class CloudSource {
 public:
  virtual ~CloudSource() = default;
  /// Takes the oldest cloud not yet taken; false when there is none. Never blocks.
  virtual bool poll(Cloud& cloud) = 0;
  [[nodiscard]] virtual CloudSourceStatus status() const = 0;
};

/// Clouds on their way to poll(), and what was refused. When nobody polls, the oldest go. Safe from any thread.
class CloudInbox {
 public:
  /// Refuses a cloud without points, and one whose stamp is too old or ahead (CloudLimits).
  void put(Cloud cloud);
  /// A cloud refused whole.
  void refuse(const std::string& why);
  /// A payload that is none.
  void malformed();

  bool poll(Cloud& cloud);
  /// `writers` is left at 0: the transport knows.
  [[nodiscard]] CloudSourceStatus status() const;

 private:
  mutable std::mutex mutex_;  // guards all below
  std::deque<Cloud> queue_;
  CloudSourceStatus status_;
};

}  // namespace jink::bridge::map
