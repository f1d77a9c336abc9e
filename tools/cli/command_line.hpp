// SPDX-License-Identifier: BSD-3-Clause
// What the subcommands share: common options, exit codes, signals, where output goes.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "config/settings.hpp"
#include "tools/base/exit_code.hpp"
#include "tools/base/files.hpp"
#include "tools/base/option_ranges.hpp"
#include "tools/cli/parser.hpp"

namespace jink::tools::cli {

using base::NamedFile;
using base::refuse_same_file;
using base::UsageError;

/// The value of an option, checked as it is parsed. For Option::transform: decimal, so that 010 is ten.
Validator whole_number(const base::WholeRange& range);
/// The same for a number that may have a fraction; NaN is in no range. For Option::check.
Validator number_in(const base::NumberRange& range);
/// The name of a file or folder: not empty, as an unset variable of a shell is. For Option::check.
Validator some_name();
/// The name of a file that can be written, found out before anything is done; what is there stays as it is. "-" passes
/// too. For Option::check.
Validator writable_file();

/// Options that every flying and planning command takes.
struct CommonOptions {
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: one for each core
  std::string config;
  std::vector<std::string> overrides;
  std::string json;

  void add_to(const Parser& parser);
  /// The planner's parameters: the file, then the overrides. Throws config::ConfigError.
  [[nodiscard]] config::Settings settings() const;
  /// `threads`, or the number of cores.
  [[nodiscard]] int thread_count() const;
};

/// Text for people: stdout, but stderr where the JSON summary goes to stdout.
class Printer {
 public:
  explicit Printer(bool to_stderr) : file_(to_stderr ? stderr : stdout) {}
  void line(const std::string& text) const;
  [[nodiscard]] bool terminal() const;
  /// Rewrites the present line of a terminal, cut to its width (text is ASCII); nothing elsewhere.
  void live(const std::string& text) const;

 private:
  std::FILE* file_;
  mutable bool live_ = false;
};

/// Hands lines to a printer in a thread of its own: a terminal that is stopped or a pipe that nobody reads must not
/// hold up who says something. Of progress lines in a row the newest is printed; what does not fit the queue is left
/// out and counted. The printer outlives it.
class BackgroundPrinter {
 public:
  explicit BackgroundPrinter(const Printer& printer);
  /// Prints what is queued.
  ~BackgroundPrinter();
  BackgroundPrinter(const BackgroundPrinter&) = delete;
  BackgroundPrinter& operator=(const BackgroundPrinter&) = delete;

  void line(std::string text) { put(std::move(text), false); }
  void live(std::string text) { put(std::move(text), true); }
  [[nodiscard]] bool terminal() const { return printer_.terminal(); }

 private:
  static constexpr std::size_t kMost = 1000;
  struct Text {
    std::string text;
    bool live = false;
  };
  void put(std::string text, bool live);
  void work(const std::stop_token& stop);

  const Printer& printer_;
  std::mutex mutex_;  // guards queue_ and dropped_
  std::condition_variable_any filled_;
  std::deque<Text> queue_;
  std::uint64_t dropped_ = 0;
  std::jthread thread_;
};

/// Writes a summary as one object: to stdout for "-", else to the file, which appears whole or not at all. Does nothing
/// for an empty name. Throws UsageError.
void write_json(const std::string& file, const nlohmann::ordered_json& summary);

/// Throws UsageError where write_json() would: before hours of work rather than after. Leaves nothing behind.
void require_json(const std::string& file);

/// From now on SIGINT, SIGTERM and SIGHUP set a flag instead of ending the process, and SIGPIPE does nothing.
void catch_signals();
/// True once one came.
bool interrupted();
/// From now on they end the process at once, with one line and exit code 1: for work that leaves nothing half done.
void end_on_signals();
/// Gives stdin, stdout and stderr that are closed to /dev/null: the next file or socket to be opened would take their
/// numbers, and what is printed would go there.
void open_standard_streams();

/// A subcommand: its options are in `parser`; `run` does it and returns the exit code.
struct Subcommand {
  Parser parser;
  std::function<int()> run;
};
}  // namespace jink::tools::cli
