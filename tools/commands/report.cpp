// SPDX-License-Identifier: BSD-3-Clause
// jink report: flight logs as one HTML page, or a flight as one figure.
#include <fmt/format.h>

#include <fstream>
#include <memory>

#include "tools/cli/command_line.hpp"
#include "tools/figures/figure.hpp"
#include "tools/report/figure.hpp"
#include "tools/report/html_report.hpp"

namespace jink::tools::commands {
namespace {

struct ReportOptions {
  std::vector<std::string> logs;
  std::vector<std::string> summaries;
  std::string out;
  std::string png;
  std::optional<double> at;
};

std::vector<report::ReportSource> sources_of(const ReportOptions& options) {
  if (options.summaries.size() > options.logs.size())
    throw cli::UsageError(
        fmt::format("--summary: {} summaries for {} logs", options.summaries.size(), options.logs.size()));
  std::vector<report::ReportSource> sources;
  for (const std::string& log : options.logs) sources.push_back({log, std::nullopt});
  for (std::size_t i = 0; i < options.summaries.size(); ++i) {
    std::ifstream in(options.summaries[i]);
    nlohmann::json summary = nlohmann::json::parse(in, nullptr, false);
    if (!in || !summary.is_object())
      throw cli::UsageError("--summary: '" + options.summaries[i] + "' is no summary object");
    sources[i].summary = std::move(summary);
  }
  return sources;
}

void tell(const std::string& file, const std::string& log, const report::ReportResult& result) {
  if (!file.empty()) fmt::print("{}\n", std::filesystem::absolute(file).string());
  if (result.skipped > 0)
    fmt::print("{}: {} of {} lines could not be read and were left out\n", log, result.skipped, result.lines);
}

int run(const ReportOptions& options) {
  const bool page = options.png.empty() || !options.out.empty();
  if (options.logs.size() > 1 && !options.png.empty())
    throw cli::UsageError(fmt::format("--png: shows one flight, not {}", options.logs.size()));
  if (options.at && options.png.empty()) throw cli::UsageError("--at: is the instant that --png shows");
  if (options.logs.size() > 1 && options.out.empty())
    throw cli::UsageError("--out: names the page that compares several flights");
  const std::vector<report::ReportSource> sources = sources_of(options);
  std::vector<cli::NamedFile> read;
  for (const std::string& log : options.logs) read.push_back({"FLIGHT.jsonl", log});
  for (const std::string& summary : options.summaries) read.push_back({"--summary", summary});
  cli::refuse_same_file(read, {{"--out", options.out}, {"--png", options.png}});
  cli::end_on_signals();
  try {
    if (page) {
      const std::string html = options.out.empty()
                                   ? std::filesystem::path(options.logs[0]).replace_extension(".html").string()
                                   : options.out;
      const std::vector<report::ReportResult> results = report::write_report(sources, html);
      for (std::size_t i = 0; i < results.size(); ++i) tell(i == 0 ? html : "", options.logs[i], results[i]);
    }
    if (!options.png.empty())
      tell(options.png, options.logs[0], report::write_figure(sources[0], options.png, options.at));
  } catch (const jink::tools::figures::GnuplotMissing& error) {
    fmt::print(stderr, "jink: --png: {}\n", error.what());
    return base::kExitMissingPeer;
  } catch (const std::runtime_error& error) {
    throw cli::UsageError(error.what());
  }
  return base::kExitReached;
}

}  // namespace

cli::Subcommand add_report(const cli::Parser& jink) {
  const cli::Parser app = jink.add_subcommand(
      "report", "make a self-contained HTML page of one or more flight logs, or a figure for print of one");
  const auto options = std::make_shared<ReportOptions>();
  app.add_option("FLIGHT.jsonl", options->logs, "flight logs; several stand side by side").required();
  app.add_option("--out", options->out, "the page (default: beside the log, .html; needed for several logs)")
      .check(cli::writable_file());
  app.add_option("--summary", options->summaries,
                 "summary object written by --json, shown on top; may be repeated, in the order of the logs")
      .single_value();
  app.add_option("--png", options->png,
                 "a figure of one flight, 180 mm wide at 300 dpi; then the page is written with --out alone")
      .check(cli::writable_file());
  app.add_option("--at", options->at, "the instant that the figure shows, s of the log (default: least clearance)")
      .check(cli::number_in({0.0, 1e9}));
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools::commands
