// SPDX-License-Identifier: BSD-3-Clause
#include "config/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

namespace jink::config {
namespace {

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// from_chars knows no leading plus, which YAML allows.
std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+';
  return plus ? text.substr(1) : text;
}

// The spellings of YAML 1.2 and of C, with or without a sign.
bool names_non_finite(std::string_view text) {
  const std::string word = lower(text);
  const std::string_view bare =
      !word.empty() && (word[0] == '+' || word[0] == '-') ? std::string_view(word).substr(1) : std::string_view(word);
  static constexpr std::array<std::string_view, 5> kNames = {".nan", ".inf", "nan", "inf", "infinity"};
  return std::find(kNames.begin(), kNames.end(), bare) != kNames.end();
}

// Damerau-Levenshtein distance in its restricted form (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> cost((a.size() + 1) * width);
  for (std::size_t j = 0; j < width; ++j) cost[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    cost[i * width] = i;
    for (std::size_t j = 1; j < width; ++j) {
      const std::size_t same = a[i - 1] == b[j - 1] ? 0 : 1;
      std::size_t best = std::min(cost[(i - 1) * width + j], cost[i * width + j - 1]) + 1;
      best = std::min(best, cost[(i - 1) * width + j - 1] + same);
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        best = std::min(best, cost[(i - 2) * width + j - 2] + 1);
      }
      cost[i * width + j] = best;
    }
  }
  return cost.back();
}

}  // namespace

std::string Range::text() const {
  return (min_open ? "(" : "[") + number_text(min) + ", " + number_text(max) + (max_open ? ")" : "]");
}

std::optional<double> parse_number(std::string_view text) {
  if (names_non_finite(text)) return std::numeric_limits<double>::quiet_NaN();
  const std::string_view digits = without_plus(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::quiet_NaN();
  // from_chars also takes "nan(...)"; whatever is not finite is told apart from a string here.
  return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN();
}

std::optional<long> parse_integer(std::string_view text) {
  const std::string_view digits = without_plus(text);
  long value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    return digits[0] == '-' ? std::numeric_limits<long>::min() : std::numeric_limits<long>::max();
  }
  return value;
}

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  // to_chars prefers 1e+05 to 100000 where it is shorter; up to seven digits the plain form reads better.
  const bool negative_zero = value == 0.0 && std::signbit(value);
  if (error == std::errc() && value == std::floor(value) && std::abs(value) < 1e7 && !negative_zero) {
    return std::to_string(static_cast<long>(value));
  }
  return {buffer.data(), end};
}

std::string vector_text(const Vec3& vector) {
  return "[" + number_text(vector.x()) + ", " + number_text(vector.y()) + ", " + number_text(vector.z()) + "]";
}

std::string join(std::span<const std::string_view> names) {
  std::string out;
  for (const std::string_view name : names) out.append(out.empty() ? "" : ", ").append(name);
  return out;
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> names) {
  // Far longer than any name: no misspelling, and the quadratic comparison is not worth it.
  constexpr std::size_t kLongestWord = 100;
  if (word.size() > kLongestWord) return {};
  const std::string wanted = lower(word);
  std::string_view best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string_view name : names) {
    const std::size_t distance = edit_distance(wanted, lower(name));
    if (distance < best_distance) {
      best_distance = distance;
      best = name;
    }
  }
  return best;
}

}  // namespace jink::config
