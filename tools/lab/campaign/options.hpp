// SPDX-License-Identifier: BSD-3-Clause
// What the command lines of campaigns share: shards, folders, going on with an earlier run, progress.
#pragma once

#include <charconv>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "tools/cli/command_line.hpp"
#include "tools/lab/campaign/settings_diff.hpp"

namespace jink::tools::lab::campaign {

inline constexpr int kMostRuns = 1000000;
inline constexpr int kMostShards = 100000;

/// The whole text as a number, or nothing.
template <class Number>
std::optional<Number> whole(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// K/N. Throws UsageError.
[[nodiscard]] Shard shard_of(const std::string& text);

/// Throws UsageError.
void make_folder(const std::filesystem::path& out);

/// Whether to go on with the results in `file`, which is in `out`, or to begin. Throws UsageError where there are some
/// that nobody wants to resume.
[[nodiscard]] bool goes_on(const std::filesystem::path& file, const std::string& out, bool resume,
                           const cli::Printer& printer);
/// Throws UsageError where an earlier run's settings differ.
void require_same(const std::vector<std::string>& differences, const std::string& out);

/// What an earlier call left in `file`, which is in `out`, by `read(file)`; or nothing yet, with these settings.
/// `count(earlier)` says how much that is: "3 flights of an earlier run". Throws UsageError where it is in the way.
template <class Results, class Settings, class Read, class Count>
Results resumed(const std::filesystem::path& file, const Settings& settings, const std::string& out, bool resume,
                const cli::Printer& printer, const Read& read, const Count& count) {
  Results earlier;
  earlier.settings = settings;
  if (!goes_on(file, out, resume, printer)) return earlier;
  earlier = read(file);
  require_same(differences(earlier.settings, out, settings, "this call"), out);
  printer.line("resuming: " + count(earlier) +
               (earlier.cut_off ? " (its last line was cut off and does not count)" : ""));
  return earlier;
}

/// An option without effect beside `mode` is refused with a UsageError.
void refuse_beside(const cli::Parser& app, const char* mode, const std::vector<std::string>& useless);

/// "3 min 07 s".
[[nodiscard]] std::string duration(double seconds);

/// How far a campaign is, in any unit of work.
struct Progress {
  double done = 0.0;  ///< that of an earlier run too
  double total = 0.0;
  double in_this_run = 0.0;
  std::string text;  ///< "12 of 40 flights"
};

/// The progress line, or now and then a plain one. The printer outlives it.
class ProgressPrinter {
 public:
  explicit ProgressPrinter(const cli::Printer& printer) : printer_(printer) {}
  void operator()(const Progress& progress);

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string text(const Progress& progress, Clock::time_point now) const;

  const cli::Printer& printer_;
  Clock::time_point begun_ = Clock::now(), last_ = begun_;
};

}  // namespace jink::tools::lab::campaign
