// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the loaders share: temporary files, and tables of texts that must be refused.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "config/error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace jink::config {

using support::Folder;

/// The message of the ConfigError that `action` throws; fails the test if it throws none.
template <class Action>
std::string error_of(Action&& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no ConfigError";
  return {};
}

inline void expect_contains(const std::string& text, std::string_view part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

/// One change to a valid text that makes it bad, and what the error must name.
struct BadCase {
  std::string from;      ///< occurs once in the valid text
  std::string to;        ///< takes its place
  int line;              ///< that the error names
  std::string key;       ///< full path, that the error names
  std::string value;     ///< that the error names
  std::string expected;  ///< the end of the story: range, type or suggestion
};

/// Applies the change and expects `load(file)` to throw an error of one line that begins with FILE:LINE and the key.
template <class Load>
void expect_refused(const std::string& valid, const BadCase& bad, Load&& load) {
  SCOPED_TRACE(bad.from + " -> " + bad.to);
  const std::size_t at = valid.find(bad.from);
  ASSERT_NE(at, std::string::npos) << "the case changes nothing";
  ASSERT_EQ(valid.find(bad.from, at + 1), std::string::npos) << "the case is ambiguous";
  std::string text = valid;
  text.replace(at, bad.from.size(), bad.to);
  const Folder folder;
  const std::filesystem::path file = folder.write("bad.yaml", text);
  const std::string error = error_of([&] { load(file); });
  const std::string start = file.string() + ":" + std::to_string(bad.line) + ": key '" + bad.key + "': ";
  EXPECT_TRUE(error.starts_with(start)) << error << "\nexpected to begin with " << start;
  expect_contains(error, bad.value.empty() ? "" : "'" + bad.value + "'");
  expect_contains(error, bad.expected);
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

}  // namespace jink::config
