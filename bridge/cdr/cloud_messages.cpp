// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/cdr/cloud_messages.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "bridge/cdr/input.hpp"
#include "bridge/map/clouds.hpp"

namespace jink::bridge::cdr {
namespace {

// sensor_msgs/msg/PointField
constexpr std::uint8_t kFloat32 = 7;
constexpr std::uint8_t kFloat64 = 8;

constexpr std::size_t kField_bytes = 16;  // of a field on the wire, at least: its name's length, offset, type, count
constexpr std::size_t kMostFields = 256;

/// Where a coordinate is in a point.
struct Coordinate {
  std::size_t offset = 0;
  std::size_t bytes = 0;  // 0: there is none

  [[nodiscard]] bool fits(std::size_t step) const { return bytes > 0 && bytes <= step && offset <= step - bytes; }
};

/// How the points lie in the data.
struct Layout {
  std::array<Coordinate, 3> axes;
  std::size_t height = 0, width = 0, point_step = 0, row_step = 0;
  bool big_endian = false;

  /// Whether all points are in so many bytes.
  [[nodiscard]] bool fits(std::size_t bytes) const {
    const std::size_t most = map::CloudLimits::kPoints;
    if (height > most || width > most || height * width > most) return false;
    if (!std::all_of(axes.begin(), axes.end(), [this](const Coordinate& axis) { return axis.fits(point_step); }))
      return false;
    if (height == 0 || width == 0) return true;
    return (height == 1 || row_step >= width * point_step) && (height - 1) * row_step + width * point_step <= bytes;
  }
};

template <typename Unsigned>
Unsigned bits_at(const std::uint8_t* data, bool swapped) {
  Unsigned bits{};
  for (std::size_t i = 0; i < sizeof bits; ++i) {
    const std::size_t place = swapped ? sizeof bits - 1 - i : i;  // from the lowest byte on
    bits |= static_cast<Unsigned>(data[place]) << (8 * i);        // NOLINT: within the layout
  }
  return bits;
}

float number_at(const std::uint8_t* point, const Coordinate& axis, bool big_endian) {
  const std::uint8_t* data = point + axis.offset;  // NOLINT: within the layout
  if (axis.bytes == sizeof(float)) return std::bit_cast<float>(bits_at<std::uint32_t>(data, big_endian));
  return static_cast<float>(std::bit_cast<double>(bits_at<std::uint64_t>(data, big_endian)));
}

void take_field(CdrInput& input, Layout& layout) {
  static constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  const auto name = input.take<std::string>();
  const auto offset = input.take<std::uint32_t>();
  const auto type = input.take<std::uint8_t>();
  input.take<std::uint32_t>();  // count: a coordinate is one
  const auto* const found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return;
  const std::size_t bytes = type == kFloat32 ? sizeof(float) : type == kFloat64 ? sizeof(double) : 0;
  layout.axes.at(static_cast<std::size_t>(found - kNames.begin())) = {offset, bytes};
}

}  // namespace

std::optional<DecodedCloud> decode_cloud(std::span<const std::uint8_t> payload) {
  DecodedCloud cloud;
  const bool whole = decode(payload, [&](CdrInput& input) {
    const StampedFrame header = take_header(input);
    cloud.frame_id = header.frame_id;
    cloud.stamp_unix_s = header.stamp_unix_s;
    Layout layout;
    layout.height = input.take<std::uint32_t>();
    layout.width = input.take<std::uint32_t>();
    const std::uint32_t fields = input.take_length(kField_bytes);
    if (fields > kMostFields) return false;
    for (std::uint32_t i = 0; i < fields; ++i) take_field(input, layout);
    layout.big_endian = input.take<std::uint8_t>() != 0;
    layout.point_step = input.take<std::uint32_t>();
    layout.row_step = input.take<std::uint32_t>();
    std::vector<std::uint8_t> data(input.take_length(1));
    if (!layout.fits(data.size())) return false;
    input.cdr().deserializeArray(data.data(), data.size());
    cloud.points.reserve(layout.height * layout.width);
    for (std::size_t row = 0; row < layout.height; ++row) {
      for (std::size_t column = 0; column < layout.width; ++column) {
        const std::uint8_t* point = data.data() + row * layout.row_step + column * layout.point_step;  // NOLINT
        Eigen::Vector3f& place = cloud.points.emplace_back();
        for (std::size_t axis = 0; axis < 3; ++axis)
          place[static_cast<Eigen::Index>(axis)] = number_at(point, layout.axes[axis], layout.big_endian);
      }
    }
    return true;
  });
  return whole ? std::optional(std::move(cloud)) : std::nullopt;
}

std::vector<std::uint8_t> encode_cloud(std::span<const Eigen::Vector3f> points, double stamp_unix_s,
                                       const std::string& frame_id) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float) && std::endian::native == std::endian::little);
  constexpr std::size_t kHead_bytes = 256;  // all but the data and the frame's name
  const std::size_t bytes = points.size() * sizeof(Eigen::Vector3f);
  std::vector<std::uint8_t> payload(kHead_bytes + frame_id.size() + bytes);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()),
                                       payload.size());  // NOLINT: its interface
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  const double sec = std::floor(stamp_unix_s);
  cdr << static_cast<std::int32_t>(sec) << static_cast<std::uint32_t>((stamp_unix_s - sec) * 1e9) << frame_id;
  cdr << std::uint32_t{1} << static_cast<std::uint32_t>(points.size()) << std::uint32_t{3};
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z"}) {
    cdr << std::string(name) << offset << kFloat32 << std::uint32_t{1};
    offset += sizeof(float);
  }
  cdr << std::uint8_t{0} << offset << static_cast<std::uint32_t>(bytes) << static_cast<std::uint32_t>(bytes);
  cdr.serializeArray(reinterpret_cast<const std::uint8_t*>(points.data()), bytes);  // NOLINT: as bytes
  cdr << std::uint8_t{0};                                                           // is_dense: some may be NaN
  payload.resize(cdr.getSerializedDataLength());
  return payload;
}

}  // namespace jink::bridge::cdr
