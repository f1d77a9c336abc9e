// SPDX-License-Identifier: BSD-3-Clause
// A folder for a test's files, and what is in them.
#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>

namespace jink::support {

/// A folder of its own, gone afterwards.
class Folder {
 public:
  Folder() {
    static std::atomic<int> count = 0;
    const std::string name = "jink-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::filesystem::path log(const std::string& text) const {
    std::ofstream(path_ / "flight.jsonl", std::ios::binary) << text;
    return path_ / "flight.jsonl";
  }
  [[nodiscard]] std::filesystem::path html() const { return path_ / "flight.html"; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Writes a file, with the folders on the way to it.
  std::filesystem::path write(const std::string& name, std::string_view text) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }

 private:
  std::filesystem::path path_;
};

/// The whole file.
inline std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Makes the file's folder too.
inline void write(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

inline bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

/// What an action throws is told in; "" where it throws nothing.
template <typename Error>
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace jink::support
