// SPDX-License-Identifier: BSD-3-Clause
// A DDS payload (encapsulation header and CDR) read field by field, without DDS: by Fast CDR alone, so that decoding is
// a pure function of bytes. Not a public header: only .cpp files and tests include it.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "planner/base/types.hpp"

namespace jink::bridge::cdr {

/// A payload that is being read, field by field, in the order of its type. Every call that would go beyond the payload
/// throws eprosima::fastcdr::exception::Exception, which decode() below catches.
class CdrInput {
 public:
  explicit CdrInput(std::span<const std::uint8_t> payload);

  template <typename T>
  T take() {
    T value{};
    cdr_ >> value;
    return value;
  }
  /// The length of a sequence whose elements take at least `element_bytes` each; one that the rest of the payload
  /// cannot hold is thrown out here, before anything is allocated for it.
  std::uint32_t take_length(std::size_t element_bytes);
  /// Whether so many bytes are left: less is what pads a payload.
  [[nodiscard]] bool has(std::size_t bytes) const { return size_ - cdr_.getSerializedDataLength() >= bytes; }
  [[nodiscard]] eprosima::fastcdr::Cdr& cdr() { return cdr_; }

 private:
  std::size_t size_;
  eprosima::fastcdr::FastBuffer buffer_;
  eprosima::fastcdr::Cdr cdr_;
};

/// Runs `read(CdrInput&)`, which returns whether what it read makes sense; false also when it ran out of bytes.
template <typename Read>
[[nodiscard]] bool decode(std::span<const std::uint8_t> payload, Read read) {
  try {
    CdrInput input(payload);
    return read(input);
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return false;
  }
}

/// ROS 2's std_msgs/Header.
struct StampedFrame {
  double stamp_unix_s = 0.0;
  std::string frame_id;
};
StampedFrame take_header(CdrInput& input);

/// Three doubles: geometry_msgs/Point or Vector3.
Vec3 take_vec3(CdrInput& input);

/// FNV-1a over bytes.
std::uint64_t fnv1a(std::span<const std::uint8_t> bytes, std::uint64_t hash = 0xcbf29ce484222325U);

/// A text of a stranger, short and printable, for the terminal and the log.
std::string printable(const std::string& text);

}  // namespace jink::bridge::cdr
