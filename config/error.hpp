// SPDX-License-Identifier: BSD-3-Clause
// What every loader of this module throws. Free of yaml-cpp, so that any caller may include it.
#pragma once

#include <stdexcept>
#include <string>

namespace jink::config {

/// A file, key or value that is not as the contract says. what() is one line, fit for stderr (exit code 2), such as
/// `FILE:LINE: key 'sensing.rate': value '-3' is not in (0, 1000]`. The line is missing where the file as a whole is
/// the matter, and `--set TEXT` stands for FILE:LINE where an override is.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(const std::string& message) : std::runtime_error(one_line(message)) {}

 private:
  // File names and values come from outside: a line break in one of them must not break the promise above.
  static std::string one_line(std::string text) {
    for (char& c : text) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte < 0x20 || byte == 0x7f) c = '?';
    }
    return text;
  }
};

}  // namespace jink::config
