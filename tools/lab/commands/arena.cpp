// SPDX-License-Identifier: BSD-3-Clause
// jink arena: many flights of several pilots through seeded worlds, in virtual time, and what they amount to.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <sstream>

#include "config/scenario_writer.hpp"
#include "planner/base/version.hpp"
#include "sim/families/families.hpp"
#include "sim/families/recorded.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/lab/arena/campaign.hpp"
#include "tools/lab/arena/flight_runner.hpp"
#include "tools/lab/arena/html_page.hpp"
#include "tools/lab/arena/tiers.hpp"
#include "tools/lab/baselines/registry.hpp"
#include "tools/lab/campaign/options.hpp"

namespace jink::tools::lab::commands {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostCommands = 10;  // of failed flights that are printed

constexpr const char* kArenaFooter =
    "Writes into --out: flights.jsonl (a line for each flight as it ends), flights.csv, table.csv, table.json, "
    "table.md,\n"
    "arena.html, planner.yaml, and failed/NAME with scenario and log of each flight that did not reach.\n"
    "Exit codes: 0 the campaign ran to its end, whatever its flights came to; 1 it is not complete (Ctrl-C, flights\n"
    "missing after --merge): --resume goes on; 2 bad usage, file or value.";

struct ArenaOptions {
  cli::CommonOptions common;
  std::string families = "all", recorded, pilots = "jink", tiers = "field,perfect,realistic";
  int runs = 20;
  std::string out = "arena";
  bool resume = false;
  std::string shard = "1/1";
  std::vector<std::string> merge;
  std::vector<std::string> write;
  std::string oracle = "on", logs = "on";
};

/// "a,b" or "all": in the order of `known`, then of those that "all" leaves out.
std::vector<std::string> chosen(const char* option, const std::string& text, std::span<const std::string_view> known,
                                std::span<const std::string_view> on_request = {}) {
  std::vector<std::string> wanted;
  std::istringstream list(text);
  for (std::string name; std::getline(list, name, ',');) wanted.push_back(name);
  if (wanted.empty()) wanted.emplace_back();
  std::vector<std::string> result;
  if (text == "all") return {known.begin(), known.end()};
  std::vector<std::string_view> every(known.begin(), known.end());
  every.insert(every.end(), on_request.begin(), on_request.end());
  for (const std::string_view name : every) {
    const auto times = std::count_if(wanted.begin(), wanted.end(), [&](const auto& one) { return one == name; });
    if (times > 1) throw cli::UsageError(fmt::format("{}: '{}' is there twice", option, name));
    if (times == 1) result.emplace_back(name);
  }
  for (const std::string& name : wanted) {
    if (std::find(every.begin(), every.end(), name) == every.end())
      throw cli::UsageError(fmt::format("{}: '{}' is not one of {}, or all", option, name, fmt::join(every, ", ")));
  }
  return result;
}

/// What --recorded names; nothing where it is not given.
std::shared_ptr<const arena::Recording> recording_of(const ArenaOptions& options) {
  if (options.recorded.empty()) return nullptr;
  return std::make_shared<const arena::Recording>(sim::recorded::load_recording(options.recorded));
}

std::vector<std::string> families_of(const char* option, const std::string& text, const arena::Recording* recording) {
  static constexpr std::array kRecordedAlone{sim::families::kRecorded};
  if (recording != nullptr) return chosen(option, text, kRecordedAlone);
  return chosen(option, text, sim::families::world_families(), sim::families::others_families());
}

arena::CampaignSettings settings_of(const ArenaOptions& options, const config::Settings& planner,
                                    const arena::Recording* recording) {
  arena::CampaignSettings s;
  s.version = JINK_VERSION;
  s.seed = options.common.seed;
  s.families = families_of("--families", options.families, recording);
  if (recording != nullptr)
    s.recorded = fmt::format("{} ({:016x})", fs::path(options.recorded).filename().string(), recording->digest);
  s.pilots = chosen("--pilots", options.pilots, baselines::pilots());
  s.tiers = chosen("--tiers", options.tiers, arena::tiers());
  s.runs = options.runs;
  s.oracle = options.oracle == "on";
  s.shard = campaign::shard_of(options.shard);
  s.parameters = config::list_settings(planner);
  return s;
}

campaign::Progress progress_of(const arena::Progress& p) {
  return {static_cast<double>(p.done), static_cast<double>(p.total), static_cast<double>(p.flown),
          fmt::format("{} of {} flights, {} not reached ({} hit)", p.done, p.total, p.failed, p.hit)};
}

void tell_failures(const arena::Summary& summary, const fs::path& out, const cli::Printer& printer) {
  if (summary.failures.empty()) return;
  printer.line(fmt::format("\n{} flights did not reach. To fly one again and see it:", summary.failures.size()));
  for (std::size_t i = 0; i < std::min(kMostCommands, summary.failures.size()); ++i) {
    const arena::FlightRecord& r = summary.failures[i];
    printer.line(fmt::format("  {} ({})\n    {}", r.outcome, r.reason, arena::replay_command(out, r)));
  }
  if (summary.failures.size() > kMostCommands)
    printer.line(
        fmt::format("  and {} more, in {}", summary.failures.size() - kMostCommands, (out / "flights.csv").string()));
}

/// Tables into the folder, to the terminal and to --json.
void conclude(const arena::Results& results, const ArenaOptions& options, const cli::Printer& printer) {
  const fs::path out = options.out;
  const arena::Summary summary = arena::summarise(results);
  arena::write_tables(results, summary, out);
  printer.line(arena::table_text(results, summary));
  tell_failures(summary, out, printer);
  printer.line("\npage: " + fs::absolute(out / "arena.html").string());
  cli::write_json(options.common.json, arena::summary_json(results, summary, out));
}

std::string told(const arena::Recording& recording, const std::string& file) {
  std::string text = fmt::format("{}: {} movers", file, recording.movers.size());
  if (recording.without_place > 0) text += fmt::format(", {} rows without a place left out", recording.without_place);
  if (recording.seen_once > 0) text += fmt::format(", {} seen once left out", recording.seen_once);
  return text;
}

int run_campaign(const ArenaOptions& options, const cli::Printer& printer) {
  const config::Settings planner = options.common.settings();
  const std::shared_ptr<const arena::Recording> recording = recording_of(options);
  const arena::CampaignSettings settings = settings_of(options, planner, recording.get());
  arena::Results results =
      campaign::resumed<arena::Results>(arena::results_path(options.out), settings, options.out, options.resume,
                                        printer, arena::read_results, [](const arena::Results& earlier) {
                                          return fmt::format("{} flights of an earlier run", earlier.flights.size());
                                        });
  campaign::make_folder(options.out);
  cli::require_json(options.common.json);
  arena::ResultsFile file(arena::results_path(options.out), results);
  campaign::write_atomically(fs::path(options.out) / "planner.yaml", campaign::parameters_yaml(settings.parameters));
  if (recording != nullptr) printer.line(told(*recording, options.recorded));
  printer.line(fmt::format("seed {}: {} flights on {} threads, results in {}", settings.seed,
                           arena::jobs_of(settings).size(), options.common.thread_count(), options.out));
  cli::catch_signals();
  campaign::ProgressPrinter progress(printer);
  arena::CampaignOptions campaign;
  campaign.out = options.out;
  campaign.settings = planner;
  campaign.recording = recording;
  campaign.threads = options.common.thread_count();
  campaign.logs = options.logs == "on";
  campaign.interrupted = cli::interrupted;
  campaign.on_progress = [&](const arena::Progress& p) { progress(progress_of(p)); };
  const bool complete = arena::fly_campaign(results, file, campaign);
  printer.line("");
  conclude(results, options, printer);
  if (complete) return base::kExitReached;
  printer.line(fmt::format("interrupted: the same command with --resume flies the other {} flights",
                           arena::jobs_of(settings).size() - results.flights.size()));
  return base::kExitFailed;
}

/// The scenarios and logs of failed flights, which are named by what they are.
void copy_failures(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::is_directory(from / "failed", error)) return;
  fs::copy(from / "failed", to / "failed", fs::copy_options::recursive | fs::copy_options::overwrite_existing, error);
  if (error) throw cli::UsageError(fmt::format("--merge: '{}': {}", (from / "failed").string(), error.message()));
}

int run_merge(const ArenaOptions& options, const cli::Printer& printer) {
  std::error_code error;
  if (fs::exists(arena::results_path(options.out), error))
    throw cli::UsageError(fmt::format("--out: '{}' holds a campaign; merge into another folder", options.out));
  const std::vector<fs::path> folders(options.merge.begin(), options.merge.end());
  const arena::Results results = arena::merge_results(folders);
  campaign::make_folder(options.out);
  for (const fs::path& folder : folders) copy_failures(folder, options.out);
  campaign::write_atomically(fs::path(options.out) / "planner.yaml",
                             campaign::parameters_yaml(results.settings.parameters));
  conclude(results, options, printer);
  const std::size_t all = arena::jobs_of(results.settings).size();
  if (results.flights.size() == all) return base::kExitReached;
  printer.line(fmt::format("{} of {} flights are missing: the same settings with --out {} --resume fly them",
                           all - results.flights.size(), all, options.out));
  return base::kExitFailed;
}

/// FAMILY:SEED FILE.
int run_write(const ArenaOptions& options, const cli::Printer& printer) {
  const std::string& world = options.write.front();
  const std::size_t colon = world.find(':');
  const auto seed = colon == std::string::npos
                        ? std::nullopt
                        : campaign::whole<std::uint64_t>(std::string_view(world).substr(colon + 1));
  if (!seed)
    throw cli::UsageError(fmt::format("--write: '{}' is not FAMILY:SEED with a seed from 0 to 2^64 - 1", world));
  const std::shared_ptr<const arena::Recording> recording = recording_of(options);
  const auto families = families_of("--write", world.substr(0, colon), recording.get());
  const auto tiers = chosen("--tiers", options.tiers, arena::tiers());
  if (families.size() != 1) throw cli::UsageError("--write: takes one family");
  // Of all tiers the true world is the same; what is not asked for is not put in its sensing.
  const config::Scenario scenario = arena::scenario_of({0, families.front(), 0, *seed},
                                                       tiers.size() == 1 ? tiers.front() : "perfect", recording.get());
  campaign::write_atomically(options.write.back(), config::to_yaml(scenario));
  printer.line(fmt::format("{}: {}", options.write.back(), scenario.name));
  return base::kExitReached;
}

/// An option without effect is refused: a merged campaign has the settings of its parts, a written world needs none.
void refuse_useless(const cli::Parser& app) {
  std::vector<std::string> useless{"--families", "--pilots", "--runs",    "--resume", "--shard", "--oracle",
                                   "--logs",     "--seed",   "--threads", "--config", "--set"};
  const char* const mode = app.count("--merge") > 0 ? "--merge" : "--write";
  const bool merges = mode == std::string_view("--merge");
  const std::vector<std::string> more = merges ? std::vector<std::string>{"--tiers", "--write", "--recorded"}
                                               : std::vector<std::string>{"--out", "--json"};
  useless.insert(useless.end(), more.begin(), more.end());
  campaign::refuse_beside(app, mode, useless);
  campaign::refuse_beside(app, "--recorded", {"--families"});
}

int run(const ArenaOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  try {
    if (!options.write.empty()) return run_write(options, printer);
    if (!options.merge.empty()) return run_merge(options, printer);
    return run_campaign(options, printer);
  } catch (const arena::ResultsError& error) {
    throw cli::UsageError(error.what());
  }
}

}  // namespace

cli::Subcommand add_arena(const cli::Parser& jink) {
  const cli::Parser app = jink.add_subcommand(
      "arena",
      "fly many seeded worlds closed loop in virtual time, with jink and the baselines, and make tables of it");
  const auto options = std::make_shared<ArenaOptions>();
  const auto names = [](std::span<const std::string_view> all) { return fmt::format("{}", fmt::join(all, ", ")); };
  app.add_option("--families", options->families,
                 "families of worlds, A,B or all: " + names(sim::families::world_families()) +
                     "; not in all: " + names(sim::families::others_families()))
      .show_default();
  app.add_option("--recorded", options->recorded,
                 "worlds out of a recording instead, of movers that did what they do in it: CSV of t, id, x, y, z\n"
                 "(s, m), ADS-B as the OpenSky Network's CSV, or the pedestrian sets ETH and UCY as text")
      .check(cli::some_name());
  app.add_option("--pilots", options->pilots, "who flies, A,B or all: " + names(baselines::pilots())).show_default();
  app.add_option("--tiers", options->tiers,
                 "how well obstacles and the vehicle itself are known, A,B or all: " + names(arena::tiers()))
      .show_default();
  app.add_option("--runs", options->runs, "worlds of each family, each flown by every pilot in every tier")
      .transform(cli::whole_number({1, campaign::kMostRuns}))
      .show_default();
  app.add_option("--out", options->out, "folder for the results").check(cli::some_name()).show_default();
  app.add_flag("--resume", options->resume, "go on with what is in --out; all other options as before");
  app.add_option("--shard", options->shard,
                 "K/N: fly the K-th of N parts, for several machines; --merge puts them together")
      .show_default();
  app.add_option("--oracle", options->oracle,
                 "on: ask an independent search, which knows the future, whether worlds in which nobody\n"
                 "arrived have a way through; those that have none count apart")
      .one_of({"on", "off"})
      .show_default();
  app.add_option("--logs", options->logs, "off: failed flights leave their scenario but no log")
      .one_of({"on", "off"})
      .show_default();
  app.add_option("--merge", options->merge, "put the results in these folders together into --out")
      .expected(1, campaign::kMostShards);
  app.add_option("--write", options->write, "FAMILY:SEED FILE: write that world as a scenario file and end")
      .expected(2, 2);
  options->common.add_to(app);
  app.option("--threads").describe("flights at once, 1 to 256 (default: one for each core)");
  app.footer(kArenaFooter);
  return {app, [options, app] {
            refuse_useless(app);
            return run(*options);
          }};
}

}  // namespace jink::tools::lab::commands
