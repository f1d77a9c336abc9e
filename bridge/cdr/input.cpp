// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/cdr/input.hpp"

#include <fastcdr/exceptions/NotEnoughMemoryException.h>

namespace jink::bridge::cdr {

// FastBuffer takes a mutable pointer, for writing; nothing is written here.
CdrInput::CdrInput(std::span<const std::uint8_t> payload)
    : size_(payload.size()),
      buffer_(reinterpret_cast<char*>(const_cast<std::uint8_t*>(payload.data())), payload.size()),  // NOLINT
      cdr_(buffer_, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::Cdr::DDS_CDR) {
  cdr_.read_encapsulation();
}

std::uint32_t CdrInput::take_length(std::size_t element_bytes) {
  const auto count = take<std::uint32_t>();
  const std::size_t rest = size_ - cdr_.getSerializedDataLength();
  if (static_cast<std::size_t>(count) * element_bytes > rest) {
    throw eprosima::fastcdr::exception::NotEnoughMemoryException(
        eprosima::fastcdr::exception::NotEnoughMemoryException::NOT_ENOUGH_MEMORY_MESSAGE_DEFAULT);
  }
  return count;
}

StampedFrame take_header(CdrInput& input) {
  StampedFrame header;
  const auto sec = input.take<std::int32_t>();
  const auto nanosec = input.take<std::uint32_t>();
  header.stamp_unix_s = sec + 1e-9 * nanosec;
  header.frame_id = input.take<std::string>();
  return header;
}

Vec3 take_vec3(CdrInput& input) {
  const auto x = input.take<double>();
  const auto y = input.take<double>();
  const auto z = input.take<double>();
  return {x, y, z};
}

std::uint64_t fnv1a(std::span<const std::uint8_t> bytes, std::uint64_t hash) {
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001b3U;
  return hash;
}

std::string printable(const std::string& text) {
  constexpr std::size_t kMax = 40;
  std::string shown = text.substr(0, kMax);
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text.size() > kMax ? shown + "..." : shown;
}

}  // namespace jink::bridge::cdr
