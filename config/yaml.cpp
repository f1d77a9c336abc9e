// SPDX-License-Identifier: BSD-3-Clause
#include "config/yaml.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace jink::config {
namespace {

constexpr std::size_t kLongestShown = 60;  // of a value in a message
constexpr std::size_t kLongestText = 1000;

// yaml-cpp marks quoted scalars "!" and plain ones "?"; a node made from a string, as for --set, has no tag.
bool is_plain(const YAML::Node& node) {
  const std::string& tag = node.Tag();
  return tag.empty() || tag == "?" || tag == "tag:yaml.org,2002:int" || tag == "tag:yaml.org,2002:float";
}

bool is_boolean_word(const std::string& text) {
  static constexpr std::array<std::string_view, 18> kWords = {"true", "True", "TRUE", "false", "False", "FALSE",
                                                              "yes",  "Yes",  "YES",  "no",    "No",    "NO",
                                                              "on",   "On",   "ON",   "off",   "Off",   "OFF"};
  return std::find(kWords.begin(), kWords.end(), text) != kWords.end();
}

std::string kind_of(const YAML::Node& node) {
  if (node.IsMap()) return "a map";
  if (node.IsSequence()) return "a list of " + std::to_string(node.size());
  if (!node.IsScalar()) return "empty";
  const std::string& text = node.Scalar();
  if (!is_plain(node)) return "a string";
  if (text.empty()) return "empty";
  if (is_boolean_word(text)) return "a boolean";
  return parse_number(text) ? "a number" : "a string";
}

// Appends until the text is long enough to be cut: the work is bounded whatever the node holds.
void show(const YAML::Node& node, std::string& out) {
  if (out.size() > kLongestShown) return;
  if (node.IsScalar()) {
    out.append(node.Scalar(), 0, kLongestShown + 1);
  } else if (node.IsSequence() || node.IsMap()) {
    out += node.IsMap() ? '{' : '[';
    const char* separator = "";
    for (const auto& item : node) {
      if (out.size() > kLongestShown) return;
      out += std::exchange(separator, ", ");
      if (node.IsMap()) {
        show(item.first, out);
        out += ": ";
        show(item.second, out);
      } else {
        show(item, out);
      }
    }
    out += node.IsMap() ? '}' : ']';
  } else {
    out += "null";
  }
}

std::string shown(const YAML::Node& node) {
  std::string out;
  show(node, out);
  if (out.size() <= kLongestShown) return out;
  std::size_t cut = kLongestShown;
  while (cut > 0 && (static_cast<unsigned char>(out[cut]) & 0xC0U) == 0x80U) --cut;  // not within a UTF-8 character
  return out.substr(0, cut) + "...";
}

int line_of(const YAML::Node& node, int fallback) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? fallback : mark.line + 1;
}

std::string number_in(const Range& range) {
  return "a number in " + range.text();
}
std::string integer_in(const Range& range) {
  return "an integer in " + range.text();
}
std::string vec3_in(const Range& range) {
  return "[x, y, z], each a number in " + range.text();
}

}  // namespace

void Value::fail_at(int line, const std::string& path, const std::string& complaint) const {
  std::string place = source_;
  if (line > 0) place += ":" + std::to_string(line);
  if (!path.empty()) place += ": key '" + path + "'";
  throw ConfigError(place + ": " + complaint);
}

void Value::fail(const std::string& complaint) const {
  fail_at(line_, path_, "value '" + shown(node_) + "' " + complaint);
}

void Value::fail_type(const std::string& expected) const {
  fail("is " + kind_of(node_) + "; expected " + expected);
}

std::string Value::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

double Value::number(const Range& range) const {
  if (!node_.IsScalar() || !is_plain(node_)) fail_type(number_in(range));
  const std::optional<double> parsed = parse_number(node_.Scalar());
  if (!parsed) fail_type(number_in(range));
  if (!std::isfinite(*parsed)) fail("is not a finite number; expected " + number_in(range));
  if (!range.contains(*parsed)) fail("is not in " + range.text());
  return *parsed;
}

int Value::integer(const Range& range) const {
  if (!node_.IsScalar() || !is_plain(node_)) fail_type(integer_in(range));
  const std::optional<long> parsed = parse_integer(node_.Scalar());
  if (!parsed && parse_number(node_.Scalar())) fail("is not an integer; expected " + integer_in(range));
  if (!parsed) fail_type(integer_in(range));
  if (!range.contains(static_cast<double>(*parsed))) fail("is not in " + range.text());
  return static_cast<int>(*parsed);
}

bool Value::boolean() const {
  const bool scalar = node_.IsScalar() && is_plain(node_);
  if (scalar && node_.Scalar() == "true") return true;
  if (scalar && node_.Scalar() == "false") return false;
  fail("is not true or false");
}

std::string Value::text() const {
  if (!node_.IsScalar()) fail_type("text");
  const std::string& text = node_.Scalar();
  const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (text.empty()) fail("is empty; expected text");
  if (text.size() > kLongestText) fail("is longer than " + std::to_string(kLongestText) + " bytes");
  if (std::any_of(text.begin(), text.end(), control)) fail("is not one line of printable text");
  return text;
}

Vec3 Value::vec3(const Range& range) const {
  if (!node_.IsSequence() || node_.size() != 3) fail_type(vec3_in(range));
  const std::vector<Value> items = list(3, 3);
  return {items[0].number(range), items[1].number(range), items[2].number(range)};
}

std::vector<Value> Value::list(std::size_t min_size, std::size_t max_size) const {
  const Range sizes = closed(static_cast<double>(min_size), static_cast<double>(max_size));
  if (!node_.IsSequence()) fail_type("a list");
  if (!sizes.contains(static_cast<double>(node_.size()))) {
    fail_type("a list with a number of elements in " + sizes.text());
  }
  std::vector<Value> items;
  items.reserve(node_.size());
  for (const auto& node : node_) {
    items.emplace_back(node, source_, path_ + "[" + std::to_string(items.size()) + "]", line_of(node, line_));
  }
  return items;
}

std::size_t Value::choice(std::span<const std::string_view> names) const {
  if (!node_.IsScalar()) fail_type("one of " + join(names));
  const auto found = std::find(names.begin(), names.end(), node_.Scalar());
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const std::string_view near = nearest(node_.Scalar(), names);
  fail("is not one of " + join(names) + (near.empty() ? "" : "; did you mean '" + std::string(near) + "'?"));
}

Map::Map(const Value& value, std::vector<std::string_view> keys, std::string_view format)
    : value_(value), keys_(std::move(keys)) {
  if (!value_.node_.IsMap()) {
    const std::string expected = "expected a map with the keys " + join(keys_);
    if (!value_.path_.empty()) value_.fail("is " + kind_of(value_.node_) + "; " + expected);
    value_.fail_at(value_.line_, "", "the file holds " + kind_of(value_.node_) + "; " + expected);
  }
  for (const auto& item : value_.node_) {
    if (format.empty() || !item.first.IsScalar() || item.first.Scalar() != "format") continue;
    const Value stated(item.second, value_.source_, value_.path_of("format"), line_of(item.first, value_.line_));
    if (stated.text() != format) stated.fail("is not '" + std::string(format) + "'");
  }
  entries_.reserve(value_.node_.size());
  for (const auto& item : value_.node_) {
    const int line = line_of(item.first, value_.line_);
    const std::string key = shown(item.first);
    const std::string path = value_.path_of(key);
    if (!item.first.IsScalar()) value_.fail_at(line, path, "the key is " + kind_of(item.first) + "; expected a name");
    if (std::find(keys_.begin(), keys_.end(), item.first.Scalar()) == keys_.end()) {
      const std::string_view near = nearest(key, keys_);
      value_.fail_at(line, path,
                     "unknown key with value '" + shown(item.second) + "'; " +
                         (near.empty() ? "" : "did you mean '" + std::string(near) + "'? ") +
                         "allowed: " + join(keys_));
    }
    // yaml-cpp keeps both entries of a key given twice and finds the first.
    for (const Entry& entry : entries_) {
      if (entry.key != key) continue;
      value_.fail_at(
          line, path,
          "given again with value '" + shown(item.second) + "', first in line " + std::to_string(entry.value.line()));
    }
    entries_.push_back({key, Value(item.second, value_.source_, path, line)});
  }
  if (!format.empty()) (void)at("format", "'" + std::string(format) + "'");
}

std::optional<Value> Map::find(std::string_view key) const {
  for (const Entry& entry : entries_) {
    if (entry.key == key) return entry.value;
  }
  return std::nullopt;
}

Value Map::at(std::string_view key, const std::string& expected) const {
  if (std::optional<Value> value = find(key)) return *std::move(value);
  value_.fail_at(value_.line_, value_.path_of(key), "missing; expected " + expected);
}

double Map::number(std::string_view key, const Range& range) const {
  return at(key, number_in(range)).number(range);
}

double Map::number_or(std::string_view key, const Range& range, double fallback) const {
  const std::optional<Value> value = find(key);
  return value ? value->number(range) : fallback;
}

int Map::integer(std::string_view key, const Range& range) const {
  return at(key, integer_in(range)).integer(range);
}

std::string Map::text(std::string_view key) const {
  return at(key, "text").text();
}

Vec3 Map::vec3(std::string_view key, const Range& range) const {
  return at(key, vec3_in(range)).vec3(range);
}

Vec3 Map::vec3_or(std::string_view key, const Range& range, const Vec3& fallback) const {
  const std::optional<Value> value = find(key);
  return value ? value->vec3(range) : fallback;
}

planner::base::Box read_box(const Value& value, const Range& range) {
  const Map map(value, {"min", "max"});
  planner::base::Box box{map.vec3("min", range), map.vec3("max", range)};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (box.min[axis] < box.max[axis]) continue;
    const Value max = map.at("max", "").list(3, 3)[static_cast<std::size_t>(axis)];
    max.fail("is not above min, " + number_text(box.min[axis]) + "; expected a number in " +
             Range{box.min[axis], range.max, true, false}.text());
  }
  return box;
}

}  // namespace jink::config
