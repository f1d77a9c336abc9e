// SPDX-License-Identifier: BSD-3-Clause
// jink export: a flight log for other programs.
#include <fmt/format.h>

#include <memory>

#include "tools/command_line.hpp"
#include "tools/export/flight_export.hpp"

namespace jink::tools {
namespace {

struct ExportOptions {
  std::string log;
  std::string mcap;
};

int run(const ExportOptions& options) {
  const std::string file =
      options.mcap.empty() ? std::filesystem::path(options.log).replace_extension(".mcap").string() : options.mcap;
  refuse_same_file({{"FLIGHT.jsonl", options.log}}, {{"--mcap", file}});
  end_on_signals();
  try {
    const ExportResult result = export_mcap(options.log, file);
    fmt::print("{}: {} messages\n", std::filesystem::absolute(file).string(), result.messages);
    if (result.skipped > 0)
      fmt::print("{} of {} lines could not be read and were left out\n", result.skipped, result.lines);
  } catch (const std::runtime_error& error) {
    throw UsageError(error.what());
  }
  return kExitReached;
}

}  // namespace

Subcommand add_export(CLI::App& jink) {
  CLI::App* app = jink.add_subcommand("export", "write a flight log for other programs");
  const auto options = std::make_shared<ExportOptions>();
  app->add_option("FLIGHT.jsonl", options->log, "flight log")->required();
  app->add_option("--mcap", options->mcap,
                  "an MCAP recording for Foxglove and PlotJuggler (default: beside the log, .mcap)")
      ->required()
      ->expected(0, 1);
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools
