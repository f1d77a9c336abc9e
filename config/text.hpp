// SPDX-License-Identifier: BSD-3-Clause
// Numbers, ranges and names as text: how the loaders parse them and how their errors print them. Not a public header.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "planner/base/types.hpp"

namespace jink::config {

/// The numbers that a key allows. Infinite bounds are not used: every number of a file has a sane limit.
struct Range {
  double min = 0.0;
  double max = 0.0;
  bool min_open = false;  ///< min itself is not allowed
  bool max_open = false;  ///< max itself is not allowed

  [[nodiscard]] constexpr bool contains(double value) const {
    return (min_open ? value > min : value >= min) && (max_open ? value < max : value <= max);
  }
  /// As in mathematics: "(0, 1000]".
  [[nodiscard]] std::string text() const;
};

/// [min, max]
constexpr Range closed(double min, double max) {
  return {min, max, false, false};
}
/// (min, max]
constexpr Range above(double min, double max) {
  return {min, max, true, false};
}
/// [min, max)
constexpr Range below(double min, double max) {
  return {min, max, false, true};
}
/// [-size, size]
constexpr Range within(double size) {
  return {-size, size, false, false};
}

/// The whole of `text` as a decimal number, independent of the locale; nothing if it is none. Spelled infinities, NaN
/// (".nan", "inf") and what a double cannot hold ("1e999") come back as NaN, for the caller to reject.
std::optional<double> parse_number(std::string_view text);

/// The whole of `text` as a decimal integer; nothing if it is none. One that a long cannot hold comes back clamped.
std::optional<long> parse_integer(std::string_view text);

/// The shortest decimal that reads back as the same double.
std::string number_text(double value);
/// "[x, y, z]", each as number_text().
std::string vector_text(const Vec3& vector);

/// The names in one line: "a, b, c".
std::string join(std::span<const std::string_view> names);

/// The name that `word` is probably a misspelling of: the smallest edit distance (letters' case does not count, a swap
/// of neighbours is one edit), at most a third of the length and at least 1; ties by order. Empty if none is near.
std::string_view nearest(std::string_view word, std::span<const std::string_view> names);

}  // namespace jink::config
