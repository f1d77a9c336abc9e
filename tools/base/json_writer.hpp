// SPDX-License-Identifier: BSD-3-Clause
// One line of JSON, written from left to right without a tree of it in memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "planner/base/types.hpp"

namespace jink::tools::base {

/// Values follow one another; commas are set where they belong. Nothing checks that keys and brackets match.
class JsonWriter {
 public:
  JsonWriter& key(std::string_view name);
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  /// The shortest decimal that reads back to the same bits, -0.0 too; null where it is not finite.
  JsonWriter& number(double value);
  /// As number(), but what is not finite is kept as text: "inf", "-inf" or "nan".
  JsonWriter& exact(double value);
  JsonWriter& integer(std::uint64_t value);
  JsonWriter& flag(bool value);
  /// Bytes that are no UTF-8 are replaced.
  JsonWriter& text(std::string_view value);
  /// [x, y, z], each as number().
  JsonWriter& vector(const Vec3& v);
  /// [x, y, z], each as exact().
  JsonWriter& exact_vector(const Vec3& v);

  [[nodiscard]] const std::string& str() const { return line_; }
  void clear() { line_.clear(); }

 private:
  void separate();
  void append(double value);

  std::string line_;
};

}  // namespace jink::tools::base
