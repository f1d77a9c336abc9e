// SPDX-License-Identifier: BSD-3-Clause
// jink report: a flight log as one HTML page.
#include <fmt/format.h>

#include <fstream>
#include <memory>

#include "tools/command_line.hpp"
#include "tools/report/report.hpp"

namespace jink::tools {
namespace {

struct ReportOptions {
  std::string log;
  std::string out;
  std::string summary;
};

int run(const ReportOptions& options) {
  const std::filesystem::path html = options.out.empty() ? std::filesystem::path(options.log).replace_extension(".html")
                                                         : std::filesystem::path(options.out);
  nlohmann::json summary;
  if (!options.summary.empty()) {
    std::ifstream in(options.summary);
    summary = nlohmann::json::parse(in, nullptr, false);
    if (!in || !summary.is_object()) throw UsageError("--summary: '" + options.summary + "' is no summary object");
  }
  try {
    const ReportResult result = write_report(options.log, html, options.summary.empty() ? nullptr : &summary);
    fmt::print("{}\n", std::filesystem::absolute(html).string());
    if (result.skipped > 0)
      fmt::print("{} of {} lines could not be read and were left out\n", result.skipped, result.lines);
  } catch (const std::runtime_error& error) {
    throw UsageError(error.what());
  }
  return kExitReached;
}

}  // namespace

Subcommand add_report(CLI::App& jink) {
  CLI::App* app = jink.add_subcommand("report", "make a self-contained HTML page of a flight log");
  const auto options = std::make_shared<ReportOptions>();
  app->add_option("FLIGHT.jsonl", options->log, "flight log")->required();
  app->add_option("--out", options->out, "the page (default: beside the log, .html)");
  app->add_option("--summary", options->summary, "summary object written by --json, shown on top");
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools
