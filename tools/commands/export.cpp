// SPDX-License-Identifier: BSD-3-Clause
// jink export: a flight log for other programs.
#include <fmt/format.h>

#include <memory>

#include "tools/cli/command_line.hpp"
#include "tools/mcap/flight_export.hpp"

namespace jink::tools::commands {
namespace {

struct ExportOptions {
  std::string log;
  std::string mcap;
};

int run(const ExportOptions& options) {
  const std::string file =
      options.mcap.empty() ? std::filesystem::path(options.log).replace_extension(".mcap").string() : options.mcap;
  cli::refuse_same_file({{"FLIGHT.jsonl", options.log}}, {{"--mcap", file}});
  cli::end_on_signals();
  try {
    const mcap::ExportResult result = mcap::export_mcap(options.log, file);
    fmt::print("{}: {} messages\n", std::filesystem::absolute(file).string(), result.messages);
    if (result.skipped > 0)
      fmt::print("{} of {} lines could not be read and were left out\n", result.skipped, result.lines);
  } catch (const std::runtime_error& error) {
    throw cli::UsageError(error.what());
  }
  return base::kExitReached;
}

}  // namespace

cli::Subcommand add_export(const cli::Parser& jink) {
  const cli::Parser app = jink.add_subcommand("export", "write a flight log for other programs");
  const auto options = std::make_shared<ExportOptions>();
  app.add_option("FLIGHT.jsonl", options->log, "flight log").required();
  app.add_option("--mcap", options->mcap,
                 "an MCAP recording for Foxglove and PlotJuggler (default: beside the log, .mcap)")
      .required()
      .expected(0, 1);
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools::commands
