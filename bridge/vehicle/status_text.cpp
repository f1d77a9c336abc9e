// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/vehicle/status_text.hpp"

#include <array>

namespace jink::bridge::vehicle {

namespace {

// MAV_SEVERITY.
constexpr std::array<const char*, 8> kSeverities{"emergency", "alert",  "critical", "error",
                                                 "warning",   "notice", "info",     "debug"};

std::string shown(std::uint32_t severity, std::string text) {
  for (char& c : text) {
    if (c < ' ' || c > '~') c = c == '\t' ? ' ' : '?';
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return std::string(severity < kSeverities.size() ? kSeverities[severity] : "text") + ": " + text;
}

}  // namespace

std::vector<std::string> status_text_chunks(const std::string& text) {
  if (text.size() <= kStatusTextChunk) return {text};
  std::vector<std::string> chunks;
  for (std::size_t begin = 0; begin <= text.size(); begin += kStatusTextChunk) {
    chunks.push_back(text.substr(begin, kStatusTextChunk));
  }
  return chunks;
}

void StatusTexts::finish(std::vector<std::string>& complete) {
  if (id_ != 0 && !text_.empty()) complete.push_back(shown(severity_, text_));
  id_ = 0;
  text_.clear();
}

std::vector<std::string> StatusTexts::add(std::uint32_t severity, std::uint32_t id, std::uint32_t chunk,
                                          const std::string& text) {
  std::vector<std::string> complete;
  if (id == 0) {
    complete.push_back(shown(severity, text.substr(0, kLongest)));
    return complete;
  }
  if (id != id_ || chunk < next_) {
    if (id_ != 0 && !text_.empty()) text_ += "...";  // its last chunk never came
    finish(complete);
    id_ = id;
    severity_ = severity;
    next_ = 0;
  }
  if (chunk > next_) text_ += "...";
  text_ += text;
  next_ = chunk + 1;
  if (text.size() < kStatusTextChunk || text_.size() > kLongest) {
    text_.resize(text_.size() > kLongest ? kLongest : text_.size());
    finish(complete);
  }
  return complete;
}

}  // namespace jink::bridge::vehicle
