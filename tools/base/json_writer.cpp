// SPDX-License-Identifier: BSD-3-Clause
#include "tools/base/json_writer.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace jink::tools::base {

void JsonWriter::separate() {
  if (line_.empty()) return;
  const char last = line_.back();
  if (last != '{' && last != '[' && last != ':') line_ += ',';
}

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  line_.append("\"").append(name).append("\":");
  return *this;
}

JsonWriter& JsonWriter::open(char bracket) {
  separate();
  line_ += bracket;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  line_ += bracket;
  return *this;
}

void JsonWriter::append(double value) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  line_.append(digits.data(), end);
  if (value == 0.0 && std::signbit(value)) line_ += ".0";  // "-0" would be read as the integer 0
}

JsonWriter& JsonWriter::number(double value) {
  separate();
  std::isfinite(value) ? append(value) : static_cast<void>(line_.append("null"));
  return *this;
}

JsonWriter& JsonWriter::exact(double value) {
  if (std::isfinite(value)) return number(value);
  return text(std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf");
}

JsonWriter& JsonWriter::integer(std::uint64_t value) {
  separate();
  line_ += std::to_string(value);
  return *this;
}

JsonWriter& JsonWriter::flag(bool value) {
  separate();
  line_ += value ? "true" : "false";
  return *this;
}

JsonWriter& JsonWriter::text(std::string_view value) {
  separate();
  line_ += nlohmann::json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return *this;
}

JsonWriter& JsonWriter::vector(const Vec3& v) {
  return open('[').number(v.x()).number(v.y()).number(v.z()).close(']');
}

JsonWriter& JsonWriter::exact_vector(const Vec3& v) {
  return open('[').exact(v.x()).exact(v.y()).exact(v.z()).close(']');
}

}  // namespace jink::tools::base
