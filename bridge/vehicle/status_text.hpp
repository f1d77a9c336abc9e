// SPDX-License-Identifier: BSD-3-Clause
// MAVLink's STATUSTEXT: texts in chunks of 50 characters, put together again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace jink::bridge::vehicle {

/// Where a chunk was lost, "..." stands for it. Not thread-safe.
class StatusTexts {
 public:
  /// Takes one message; returns the texts that are complete with it (or were given up because another one began),
  /// printable, without trailing blanks, the severity in front: "warning: ...". `id` 0: a text of one chunk.
  std::vector<std::string> add(std::uint32_t severity, std::uint32_t id, std::uint32_t chunk, const std::string& text);

 private:
  void finish(std::vector<std::string>& complete);

  static constexpr std::size_t kChunk = 50;     // characters
  static constexpr std::size_t kLongest = 500;  // of a text; more is cut

  std::uint32_t severity_ = 0;
  std::uint32_t id_ = 0;  // of the text under way; 0: none
  std::uint32_t next_ = 0;
  std::string text_;
};

}  // namespace jink::bridge::vehicle
