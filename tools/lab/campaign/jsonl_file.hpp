// SPDX-License-Identifier: BSD-3-Clause
// The file that a campaign's results go into as they come: a header, then a line of JSON for each.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>

namespace jink::tools::lab::campaign {

/// A results file that cannot be read, written or used: one line, fit for stderr.
class ResultsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The whole file's bytes. Throws ResultsError.
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

/// Whether a results file has begun: there is a file, and its header is whole.
[[nodiscard]] bool has_begun(const std::filesystem::path& file);

/// Calls on_header with the first line and on_line with each further one. A last line without its end is what a killed
/// process leaves: it does not count, and true is returned. Throws ResultsError with file and line for what is not JSON
/// and for every std::runtime_error of the two, and where there is no header.
bool read_lines(const std::filesystem::path& file, const std::function<void(const nlohmann::ordered_json&)>& on_header,
                const std::function<void(const nlohmann::ordered_json&)>& on_line);

/// Writes a file that appears whole or not at all. Throws ResultsError.
void write_atomically(const std::filesystem::path& file, const std::string& text);

/// The file while a campaign runs; no second process can open it. Not thread-safe.
class JsonLinesFile {
 public:
  /// Creates the file with the header, or, where it is there, goes on behind its last whole line. Throws ResultsError
  /// where it cannot be written or another process has it.
  JsonLinesFile(const std::filesystem::path& file, const nlohmann::ordered_json& header);
  ~JsonLinesFile();
  JsonLinesFile(const JsonLinesFile&) = delete;
  JsonLinesFile& operator=(const JsonLinesFile&) = delete;

  /// Appends a line, which is in the file when this returns. Throws ResultsError (a full disk).
  void append(const nlohmann::ordered_json& line);

 private:
  void write(const std::string& text);

  std::filesystem::path file_;
  int descriptor_ = -1;
  bool broken_ = false;  // nothing may follow a line that could not be written to its end
};

}  // namespace jink::tools::lab::campaign
