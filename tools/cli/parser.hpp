// SPDX-License-Identifier: BSD-3-Clause
// Options and arguments of a command, as it declares them. CLI11 stands behind it and is included by this room's
// sources alone: each file that includes it compiles all of it, which takes as long as the rest of the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
}  // namespace CLI

namespace jink::tools::cli {

/// What is wrong with the text of an option, which it may change; empty: nothing.
using Validator = std::function<std::string(std::string& text)>;

/// An option or argument, of the parser that gave it.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& required();
  Option& check(const Validator& validator);
  /// check() that may change the text.
  Option& transform(const Validator& validator);
  Option& one_of(const std::vector<std::string>& values);
  /// How many values it takes.
  Option& expected(int least, int most);
  /// One value each time that it is given.
  Option& single_value();
  /// The help text shows the present value as the default.
  Option& show_default();
  Option& describe(const std::string& what);
  Option& excludes(const Option& other);

 private:
  CLI::Option* option_;
};

/// A command line's parser, or a subcommand's, which it owns. What is added is written to the variables when it is
/// parsed: they have to stay where they are until then.
class Parser {
 public:
  explicit Parser(CLI::App* app) : app_(app) {}

  [[nodiscard]] Parser add_subcommand(const std::string& name, const std::string& what) const;
  Option add_option(const std::string& name, std::string& value, const std::string& what) const;
  Option add_option(const std::string& name, std::vector<std::string>& values, const std::string& what) const;
  Option add_option(const std::string& name, int& value, const std::string& what) const;
  Option add_option(const std::string& name, std::uint64_t& value, const std::string& what) const;
  Option add_option(const std::string& name, double& value, const std::string& what) const;
  Option add_option(const std::string& name, std::optional<int>& value, const std::string& what) const;
  Option add_option(const std::string& name, std::optional<double>& value, const std::string& what) const;
  Option add_flag(const std::string& name, bool& value, const std::string& what) const;
  /// One that was added.
  [[nodiscard]] Option option(const std::string& name) const;
  void footer(const std::string& text) const;
  /// How often an option was given.
  [[nodiscard]] std::size_t count(const std::string& name) const;

  [[nodiscard]] std::string name() const;
  /// Whether the command line chose this subcommand.
  [[nodiscard]] bool parsed() const;

 private:
  CLI::App* app_;
};

}  // namespace jink::tools::cli
