// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/campaign/jsonl_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <system_error>

#include "tools/base/atomic_file.hpp"

namespace jink::tools::lab::campaign {
namespace {

using Json = nlohmann::ordered_json;

/// Throws nlohmann's exception.
Json parse(const std::string& text) {
  return Json::parse(text);
}

std::string system_error(const std::filesystem::path& file) {
  return fmt::format("{}: cannot be written: {}", file.string(), std::generic_category().message(errno));
}

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw ResultsError(fmt::format("{}: cannot be read", file.string()));
  return text.str();
}

bool has_begun(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(file, error) && read_text(file).find('\n') != std::string::npos;
}

bool read_lines(const std::filesystem::path& file, const std::function<void(const Json&)>& on_header,
                const std::function<void(const Json&)>& on_line) {
  std::istringstream text(read_text(file));
  std::string line;
  bool cut_off = false;
  std::size_t number = 0;
  while (std::getline(text, line)) {
    if (text.eof()) {  // its end is missing
      cut_off = true;
      break;
    }
    ++number;
    try {
      const Json json = parse(line);
      (number == 1 ? on_header : on_line)(json);
    } catch (const Json::exception&) {
      throw ResultsError(fmt::format("{}:{}: is not JSON", file.string(), number));
    } catch (const std::runtime_error& error) {
      throw ResultsError(fmt::format("{}:{}: {}", file.string(), number, error.what()));
    }
  }
  if (number == 0) throw ResultsError(fmt::format("{}: holds no header", file.string()));
  return cut_off;
}

void write_atomically(const std::filesystem::path& file, const std::string& text) {
  if (const std::error_code error = base::write_file(file, text))
    throw ResultsError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

JsonLinesFile::JsonLinesFile(const std::filesystem::path& file, const Json& header) : file_(file) {
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw ResultsError(system_error(file));
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw ResultsError(fmt::format("{}: another process is writing there", file.string()));
    const std::string text = read_text(file);
    const std::size_t end = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    if (::ftruncate(descriptor_, static_cast<off_t>(end)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0)
      throw ResultsError(system_error(file));
    if (end == 0) write(header.dump() + "\n");
  } catch (const ResultsError&) {
    ::close(descriptor_);
    throw;
  }
}

JsonLinesFile::~JsonLinesFile() {
  ::close(descriptor_);
}

void JsonLinesFile::append(const Json& line) {
  write(line.dump() + "\n");
}

void JsonLinesFile::write(const std::string& text) {
  if (broken_) throw ResultsError(fmt::format("{}: could not be written before", file_.string()));
  broken_ = true;
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = ::write(descriptor_, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw ResultsError(system_error(file_));
    written += static_cast<std::size_t>(n);
  }
  broken_ = false;
}

}  // namespace jink::tools::lab::campaign
