// SPDX-License-Identifier: BSD-3-Clause
// A folder for a test's files.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace jink::support {

/// A folder of its own for each test, gone afterwards.
class Folder {
 public:
  Folder() {
    const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    path_ = std::filesystem::temp_directory_path() / ("jink-tools-" + std::to_string(::getpid()) + "-" + test);
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

 private:
  std::filesystem::path path_;
};

}  // namespace jink::support
