// SPDX-License-Identifier: BSD-3-Clause
#include "tools/log/log_reader.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace jink::tools::log {
namespace {

constexpr char kNoHeader[] = "the first line is not a jink-log/1 header";

std::string quoted(const char* key) {
  return std::string("\"") + key + "\"";
}

}  // namespace

void refuse(const std::string& what) {
  throw std::invalid_argument(what);
}

LogReader::LogReader(const std::filesystem::path& log) : file_(log), in_(log, std::ios::binary) {
  if (!in_) throw std::runtime_error(log.string() + ": cannot read the flight log");
  std::string text;
  if (!next_line(text)) fail_at(1, std::string(kNoHeader) + ": the file is empty");
  header_ = Json::parse(text, nullptr, false);
  if (!header_.is_object() || header_.value("type", Json()) != "header") fail(kNoHeader);
  const Json format = header_.value("format", Json());
  if (format != "jink-log/1")
    fail("format: " + format.dump(-1, ' ', false, Json::error_handler_t::replace) + " is not \"jink-log/1\"");
}

// The next line with content, in line_ its number.
bool LogReader::next_line(std::string& text) {
  while (std::getline(in_, text)) {
    ++read_;
    if (text.size() > kLongestLine) fail_at(read_, "is longer than 256 MiB");
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    line_ = read_;
    ++lines_;
    return true;
  }
  if (in_.bad()) throw std::runtime_error(file_.string() + ": cannot be read to its end");
  return false;
}

bool LogReader::next(Json& record) {
  std::string text;
  if (!next_line(text)) return false;
  record = Json::parse(text, nullptr, false);
  if (record.is_discarded()) {
    const std::size_t broken = line_;
    if (next_line(text)) fail_at(broken, "is not JSON");
    cut_off_ = true;
    return false;
  }
  if (!record.is_object()) fail("is not a JSON object");
  return true;
}

void LogReader::fail_at(std::size_t line, const std::string& what) const {
  throw std::runtime_error(file_.string() + ":" + std::to_string(line) + ": " + what);
}

const Json& member(const Json& record, const char* key) {
  const auto found = record.find(key);
  if (found == record.end()) refuse("has no " + quoted(key));
  return *found;
}

double number(const Json& value, const char* key) {
  if (value.is_null()) throw NotFinite{};
  if (!value.is_number()) refuse(quoted(key) + " is not a number");
  const double x = value.get<double>();
  if (!std::isfinite(x)) throw NotFinite{};
  return x;
}

double number_of(const Json& record, const char* key) {
  return number(member(record, key), key);
}

double exact(const Json& value, const char* key) {
  if (value == "inf") return std::numeric_limits<double>::infinity();
  if (value == "-inf") return -std::numeric_limits<double>::infinity();
  if (value == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (!value.is_number()) refuse(quoted(key) + " is not a number");
  return value.get<double>();
}

std::uint64_t count_of(const Json& record, const char* key) {
  const Json& value = member(record, key);
  if (!value.is_number_unsigned()) refuse(quoted(key) + " is not a whole number from 0 on");
  return value.get<std::uint64_t>();
}

std::string text_of(const Json& record, const char* key) {
  const Json& value = member(record, key);
  if (!value.is_string()) refuse(quoted(key) + " is not text");
  return value.get<std::string>();
}

bool flag_of(const Json& record, const char* key) {
  const auto found = record.find(key);
  if (found == record.end()) return false;
  if (!found->is_boolean()) refuse(quoted(key) + " is not true or false");
  return found->get<bool>();
}

const Json& list_of(const Json& record, const char* key) {
  const Json& value = member(record, key);
  if (!value.is_array()) refuse(quoted(key) + " is not a list");
  return value;
}

void check_list(const Json& value, const char* key, std::size_t size) {
  if (value.is_array() && value.size() == size) return;
  refuse(quoted(key) + " is not a list of " + std::to_string(size) + " numbers");
}

}  // namespace jink::tools::log
