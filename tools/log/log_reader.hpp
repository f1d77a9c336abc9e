// SPDX-License-Identifier: BSD-3-Clause
// A flight log line by line: what every reader of jink-log/1 has in common.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace jink::tools::log {

using Json = nlohmann::json;

/// Reads records one by one; holds one line in memory. Lines without content are skipped.
class LogReader {
 public:
  /// Opens `log` and reads its header. Throws std::runtime_error "FILE: ..." where it cannot be read and "FILE:LINE:
  /// ..." where it does not begin with a jink-log/1 header.
  explicit LogReader(const std::filesystem::path& log);

  [[nodiscard]] const Json& header() const { return header_; }
  /// The next record, a JSON object; false at the end. Throws as above for a line that is none; but where the last
  /// line is not whole JSON its writer was killed, and the log ends before it.
  bool next(Json& record);
  /// Number of the line that next() gave, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }
  /// Lines with content so far, the header and one that is cut off included.
  [[nodiscard]] std::size_t lines() const { return lines_; }
  /// At the end: whether the last line is not whole.
  [[nodiscard]] bool cut_off() const { return cut_off_; }
  /// Throws std::runtime_error "FILE:LINE: what" for the line that next() gave.
  [[noreturn]] void fail(const std::string& what) const { fail_at(line_, what); }

  static constexpr std::size_t kLongestLine = std::size_t{256} << 20;  ///< bytes; a longer one is no record

 private:
  bool next_line(std::string& text);
  [[noreturn]] void fail_at(std::size_t line, const std::string& what) const;

  std::filesystem::path file_;
  std::ifstream in_;
  Json header_;
  std::size_t read_ = 0;  // lines, empty ones too
  std::size_t line_ = 1;
  std::size_t lines_ = 0;
  bool cut_off_ = false;
};

// Fields of a record. All throw std::invalid_argument that names the key, for LogReader::fail() to give its place.

[[noreturn]] void refuse(const std::string& what);

/// Null where a number belongs: the log's way to write one that is not finite.
struct NotFinite {};

const Json& member(const Json& record, const char* key);
/// A finite number; throws NotFinite for null.
double number(const Json& value, const char* key);
double number_of(const Json& record, const char* key);
/// Any number: what is not finite is "inf", "-inf" or "nan".
double exact(const Json& value, const char* key);
std::uint64_t count_of(const Json& record, const char* key);
std::string text_of(const Json& record, const char* key);
/// False where it is missing.
bool flag_of(const Json& record, const char* key);
/// A list of any length.
const Json& list_of(const Json& record, const char* key);
/// Throws unless `value` is a list of `size` items.
void check_list(const Json& value, const char* key, std::size_t size);

template <std::size_t N>
std::array<double, N> numbers(const Json& value, const char* key) {
  check_list(value, key, N);
  std::array<double, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = number(value[i], key);
  return result;
}

template <std::size_t N>
std::array<double, N> exact_numbers(const Json& value, const char* key) {
  check_list(value, key, N);
  std::array<double, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = exact(value[i], key);
  return result;
}

}  // namespace jink::tools::log
