// SPDX-License-Identifier: BSD-3-Clause
// sensor_msgs/PointCloud2 out of DDS payloads and into them. No DDS here: pure functions of bytes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace jink::bridge::cdr {

/// A cloud as its payload says it, m in its frame; its frame is the caller's to check.
struct DecodedCloud {
  std::string frame_id;
  double stamp_unix_s = 0.0;
  std::vector<Eigen::Vector3f> points;
};

/// Decodes a payload (encapsulation and CDR); nothing where it is no PointCloud2 with fields x, y and z of the type
/// FLOAT32 or FLOAT64, where a point reaches out of its step or of the data, and where there are more points than
/// map::CloudLimits has. Other fields do not matter; points need not be finite. Pure.
[[nodiscard]] std::optional<DecodedCloud> decode_cloud(std::span<const std::uint8_t> payload);

/// The payload of a cloud of one row, with fields x, y and z of the type FLOAT32. `stamp_unix_s` is in ROS 2's range.
[[nodiscard]] std::vector<std::uint8_t> encode_cloud(std::span<const Eigen::Vector3f> points, double stamp_unix_s,
                                                     const std::string& frame_id);

}  // namespace jink::bridge::cdr
