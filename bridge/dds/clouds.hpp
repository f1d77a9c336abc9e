// SPDX-License-Identifier: BSD-3-Clause
// Clouds of points over DDS, by Fast DDS: what the companion reads, and what the simulator writes. The type on the wire
// is ROS 2's sensor_msgs/PointCloud2.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/dds/participant.hpp"
#include "bridge/map/clouds.hpp"

namespace jink::bridge::dds {

inline constexpr const char* kCloudTopic = "rt/jink/points";  ///< ROS 2: /jink/points; without a namespace
inline constexpr const char* kCloudType = "sensor_msgs::msg::dds_::PointCloud2_";

/// kCloudTopic in a namespace; empty: none.
[[nodiscard]] std::string cloud_topic(const std::string& name_space);

/// Whose clouds are read, and in which frame.
struct CloudReaderOptions {
  std::string name_space{};         ///< before the topic: "uav_1" means rt/uav_1/...; empty: none
  std::string frame = "base_link";  ///< the one that the mission mounts; `map` (ENU) and `ned` are known in any case
};

/// Reads the topic best effort, volatile, keep last, so that any writer matches. Clouds are decoded on Fast DDS's
/// thread and queued; when nobody polls, the oldest go. A cloud in another frame is refused, and so is what CloudInbox
/// refuses. All functions are safe from any thread and never block.
class DdsCloudReader final : public map::CloudSource {
 public:
  /// Returns at once; discovery goes on in the background. `node` and `clock` must outlive the reader.
  /// @throws std::runtime_error, one line, when Fast DDS cannot make it.
  DdsCloudReader(DdsParticipant& node, const base::Clock& clock, const CloudReaderOptions& options = {});
  ~DdsCloudReader() override;
  DdsCloudReader(const DdsCloudReader&) = delete;
  DdsCloudReader& operator=(const DdsCloudReader&) = delete;

  bool poll(map::Cloud& cloud) override;
  [[nodiscard]] map::CloudSourceStatus status() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes the topic best effort, volatile. Not safe for concurrent publish().
class DdsCloudWriter {
 public:
  /// Returns at once. `node` must outlive the writer. @throws as DdsCloudReader's.
  explicit DdsCloudWriter(DdsParticipant& node, const std::string& name_space = {});
  ~DdsCloudWriter();
  DdsCloudWriter(const DdsCloudWriter&) = delete;
  DdsCloudWriter& operator=(const DdsCloudWriter&) = delete;

  /// Sends the points as they are. `stamp_unix_s` is system time, seconds since 1970. False when Fast DDS does not take
  /// it. With no reader there it goes nowhere.
  [[nodiscard]] bool publish(std::span<const Eigen::Vector3f> points, double stamp_unix_s,
                             const std::string& frame_id = "base_link");
  /// Readers matched now.
  [[nodiscard]] int readers() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge::dds
