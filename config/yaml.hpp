// SPDX-License-Identifier: BSD-3-Clause
// Strict reading of YAML: every value is taken by type and range, every key is known, every error names its place.
// Not a public header: only this module's .cpp files include it, so that yaml-cpp stays inside.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/error.hpp"
#include "config/text.hpp"
#include "planner/base/types.hpp"

namespace jink::config {

/// One value of a file with its place: where it stands and the key path that leads there, "obstacles[2].radius".
/// All getters throw ConfigError when the value is not what they are named after or not in range.
class Value {
 public:
  /// `source` is the file as the user named it, or "--set TEXT"; `line` counts from 1, 0: the source has no lines.
  Value(const YAML::Node& node, std::string source, std::string path, int line)
      : node_(node), source_(std::move(source)), path_(std::move(path)), line_(line) {}

  /// A finite number; quoted ones are strings and rejected.
  [[nodiscard]] double number(const Range& range) const;
  [[nodiscard]] int integer(const Range& range) const;
  /// true or false; nothing else that some dialect of YAML takes for a boolean.
  [[nodiscard]] bool boolean() const;
  /// A non-empty scalar of printable text, at most 1000 bytes.
  [[nodiscard]] std::string text() const;
  /// A list of three numbers, each in `range`.
  [[nodiscard]] Vec3 vec3(const Range& range) const;
  /// A list of numbers, min_size to max_size of them.
  [[nodiscard]] std::vector<Value> list(std::size_t min_size, std::size_t max_size) const;
  /// The index of this text among `names`.
  [[nodiscard]] std::size_t choice(std::span<const std::string_view> names) const;
  [[nodiscard]] bool is_map() const { return node_.IsMap(); }
  [[nodiscard]] bool is_list() const { return node_.IsSequence(); }

  /// Throws `PLACE: key 'PATH': value 'VALUE' COMPLAINT`.
  [[noreturn]] void fail(const std::string& complaint) const;
  [[nodiscard]] int line() const { return line_; }

 private:
  friend class Map;
  [[noreturn]] void fail_type(const std::string& expected) const;
  [[noreturn]] void fail_at(int line, const std::string& path, const std::string& complaint) const;
  [[nodiscard]] std::string path_of(std::string_view key) const;

  YAML::Node node_;
  std::string source_;
  std::string path_;
  int line_ = 0;
};

/// A value that is a map with some of the given keys and no others. The constructor checks that, so that a misspelled
/// key is reported as such before the key that it was meant to be is reported missing.
class Map {
 public:
  /// Throws on another type, an unknown key (with the known ones and the nearest of them) and a key given twice. Where
  /// `format` is given, that is what the key of this name must say; it is looked at before all others, since a file of
  /// another kind has other keys.
  Map(const Value& value, std::vector<std::string_view> keys, std::string_view format = {});

  [[nodiscard]] bool has(std::string_view key) const { return find(key).has_value(); }
  [[nodiscard]] std::optional<Value> find(std::string_view key) const;
  /// The value of a required key; when missing, the error says that `expected` belongs there.
  [[nodiscard]] Value at(std::string_view key, const std::string& expected) const;

  [[nodiscard]] double number(std::string_view key, const Range& range) const;
  [[nodiscard]] double number_or(std::string_view key, const Range& range, double fallback) const;
  [[nodiscard]] int integer(std::string_view key, const Range& range) const;
  [[nodiscard]] std::string text(std::string_view key) const;
  [[nodiscard]] Vec3 vec3(std::string_view key, const Range& range) const;
  [[nodiscard]] Vec3 vec3_or(std::string_view key, const Range& range, const Vec3& fallback) const;
  /// The map itself, for errors that concern several of its keys.
  [[nodiscard]] const Value& value() const { return value_; }

 private:
  struct Entry {
    std::string key;
    Value value;
  };
  Value value_;
  std::vector<std::string_view> keys_;
  std::vector<Entry> entries_;
};

/// Reads a file that holds one YAML document; its root is returned, with line 1 or where the root begins. Throws
/// ConfigError on: a file that cannot be read, a directory, more than 16 MiB, an empty file, more than one document,
/// bad syntax, nesting deeper than 32, aliases that contain themselves or expand to more than a million values.
Value read_document(const std::filesystem::path& file);

/// m: of every coordinate. What is beyond is in the wrong unit.
inline constexpr Range kCoordinate = within(1e5);
/// m: of an acceptance radius.
inline constexpr Range kAcceptance = above(0, 100);
/// s: of a hold at the target.
inline constexpr Range kHoldTime = above(0, 86400);

/// A box given by `min` and `max`, both required, min < max on each axis.
planner::base::Box read_box(const Value& value, const Range& range);

}  // namespace jink::config
