// SPDX-License-Identifier: BSD-3-Clause
// Files that a command names: that they can be written, and that none is lost to another.
#pragma once

#include <string>
#include <vector>

namespace jink::tools::base {

/// What is wrong with the name of a file to be written, found out before anything is done: what is there stays as it
/// is. Empty: nothing.
[[nodiscard]] std::string why_unwritable(const std::string& file);

/// A file that a command reads or writes, and the option or argument that names it; none where `file` is empty.
struct NamedFile {
  std::string name;
  std::string file;
};
/// Throws UsageError where one of `written` is another one of them or one of `read`: what is in it would be lost.
/// Devices and pipes may be named several times.
void refuse_same_file(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written);

}  // namespace jink::tools::base
