// SPDX-License-Identifier: BSD-3-Clause
// MAVLink's STATUSTEXT: texts in chunks of 50 characters, cut and put together again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace jink::bridge::vehicle {

/// MAV_SEVERITY's values that jink sends.
enum class Severity : std::uint8_t { kCritical = 2, kWarning = 4, kInfo = 6 };

struct StatusText {
  Severity severity = Severity::kInfo;
  std::string text;
};

inline constexpr std::size_t kStatusTextChunk = 50;  ///< characters that STATUSTEXT holds

/// The chunks of a text: one where it fits, else as many as it takes, of which the last is shorter than a full one (and
/// may be empty): so its end is known. Pure.
[[nodiscard]] std::vector<std::string> status_text_chunks(const std::string& text);

/// Where a chunk was lost, "..." stands for it. Not thread-safe.
class StatusTexts {
 public:
  /// Takes one message; returns the texts that are complete with it (or were given up because another one began),
  /// printable, without trailing blanks, the severity in front: "warning: ...". `id` 0: a text of one chunk.
  std::vector<std::string> add(std::uint32_t severity, std::uint32_t id, std::uint32_t chunk, const std::string& text);

 private:
  void finish(std::vector<std::string>& complete);

  static constexpr std::size_t kLongest = 500;  // characters of a text; more is cut

  std::uint32_t severity_ = 0;
  std::uint32_t id_ = 0;  // of the text under way; 0: none
  std::uint32_t next_ = 0;
  std::string text_;
};

}  // namespace jink::bridge::vehicle
