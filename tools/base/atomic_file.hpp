// SPDX-License-Identifier: BSD-3-Clause
// Files that appear whole or not at all.
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

namespace jink::tools::base {

/// Where the content of `file` is written before a rename puts it in place: beside it, with `suffix`. A device, a pipe
/// or a link is written itself, and the result is `file`: a rename would put a plain file in its place.
inline std::filesystem::path unfinished_name(const std::filesystem::path& file, std::string_view suffix = ".part") {
  std::error_code ignored;  // what cannot be examined is not there
  const std::filesystem::file_status status = std::filesystem::symlink_status(file, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return file;
  std::filesystem::path unfinished = file;
  unfinished += suffix;
  return unfinished;
}

/// Writes `bytes` as `file`, whole or not at all (see unfinished_name() of devices and pipes); gives what failed, or
/// none.
inline std::error_code write_file(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path unfinished = unfinished_name(file);
  std::error_code error;
  errno = 0;
  {
    std::ofstream out(unfinished, std::ios::binary);
    out << bytes << std::flush;
    if (!out) error.assign(errno != 0 ? errno : EIO, std::generic_category());
  }
  if (unfinished == file) return error;
  if (!error) std::filesystem::rename(unfinished, file, error);
  std::error_code ignored;  // the first failure is what is told
  if (error) std::filesystem::remove(unfinished, ignored);
  return error;
}

}  // namespace jink::tools::base
