// SPDX-License-Identifier: BSD-3-Clause
#include "tools/base/files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "tools/base/exit_code.hpp"

namespace jink::tools::base {

std::string why_unwritable(const std::string& file) {
  if (file.empty()) return "is empty; expected the name of a file";
  std::error_code ignored;  // what cannot be examined is not there, and opening it tells
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_directory(status)) return "'" + file + "' is a directory";
  const bool there = std::filesystem::exists(status);
  if (there && !std::filesystem::is_regular_file(status))
    return "";  // opening a pipe would say something to its reader
  if (!std::ofstream(file, std::ios::app)) return "'" + file + "' cannot be written";
  // A link that leads nowhere yet would be what is removed.
  if (!there && !std::filesystem::is_symlink(file, ignored)) std::filesystem::remove(file, ignored);
  return "";
}

void refuse_same_file(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written) {
  namespace fs = std::filesystem;
  const auto same = [](const NamedFile& a, const NamedFile& b) {
    if (a.file.empty() || b.file.empty() || a.file == "-" || b.file == "-") return false;
    std::error_code error;  // of what is not there yet
    const fs::path one = fs::weakly_canonical(a.file, error), other = fs::weakly_canonical(b.file, error);
    if (error || one != other) return false;
    const fs::file_status status = fs::status(one, error);
    return !fs::exists(status) || fs::is_regular_file(status);
  };
  std::vector<NamedFile> taken = read;
  for (const NamedFile& next : written) {
    for (const NamedFile& other : taken) {
      if (same(next, other))
        throw UsageError(fmt::format("{}: '{}' is {} too; expected another file", next.name, next.file, other.name));
    }
    taken.push_back(next);
  }
}

}  // namespace jink::tools::base
