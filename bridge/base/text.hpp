// SPDX-License-Identifier: BSD-3-Clause
// Numbers as people read them in events and reasons.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace jink::bridge::base {

/// "1.50 m".
inline std::string metres(double value, int decimals = 2) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f m", decimals, value);
  return text.data();
}

/// "1.5 s".
inline std::string seconds(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.1f s", value);
  return text.data();
}

}  // namespace jink::bridge::base
