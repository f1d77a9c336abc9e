// SPDX-License-Identifier: BSD-3-Clause
// One line of JSON, written from left to right without a tree of it in memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "planner/base/types.hpp"

namespace jink::tools::base {

/// Values follow one another; commas are set where they belong. Nothing checks that keys and brackets match.
class JsonLine {
 public:
  JsonLine& key(std::string_view name);
  JsonLine& open(char bracket);
  JsonLine& close(char bracket);
  /// The shortest decimal that reads back to the same bits, -0.0 too; null where it is not finite.
  JsonLine& number(double value);
  /// As number(), but what is not finite is kept as text: "inf", "-inf" or "nan".
  JsonLine& exact(double value);
  JsonLine& integer(std::uint64_t value);
  JsonLine& flag(bool value);
  /// Bytes that are no UTF-8 are replaced.
  JsonLine& text(std::string_view value);
  /// [x, y, z], each as number().
  JsonLine& vector(const Vec3& v);
  /// [x, y, z], each as exact().
  JsonLine& exact_vector(const Vec3& v);

  [[nodiscard]] const std::string& str() const { return line_; }
  void clear() { line_.clear(); }

 private:
  void separate();
  void append(double value);

  std::string line_;
};

}  // namespace jink::tools::base
