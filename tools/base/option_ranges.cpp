// SPDX-License-Identifier: BSD-3-Clause
#include "tools/base/option_ranges.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <system_error>

namespace jink::tools::base {
namespace {

template <class Range>
std::string outside(const std::string& text, const Range& range) {
  return fmt::format("Value {} not in range {} to {}", text, range.least, range.most);
}

}  // namespace

std::string read_whole(const std::string& text, const WholeRange& range, std::uint64_t& value) {
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  const bool whole = !text.empty() && error == std::errc() && end == last;
  return whole && value >= range.least && value <= range.most ? std::string() : outside(text, range);
}

std::string read_number(const std::string& text, const NumberRange& range, double& value) {
  char* end = nullptr;
  value = std::strtod(text.c_str(), &end);
  const bool number = !text.empty() && end == text.c_str() + text.size();
  return number && value >= range.least && value <= range.most ? std::string() : outside(text, range);
}

}  // namespace jink::tools::base
