// SPDX-License-Identifier: BSD-3-Clause
// jink study: the paper's experiments, all of them, and what they amount to.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

#include "planner/base/version.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/figures/figure.hpp"
#include "tools/lab/campaign/options.hpp"
#include "tools/lab/study/campaign.hpp"
#include "tools/lab/study/output_files.hpp"

namespace jink::tools::lab::commands {
namespace {

namespace fs = std::filesystem;

constexpr int kRuns = 20;  // [Paper] section 5.2
constexpr int kQuickRuns = 5;
constexpr std::size_t kToldVerdicts = 2;  // on the terminal: against NSGA-II and MOEA/D

constexpr const char* kStudyFooter =
    "Writes into --out: runs.jsonl (a line for each run as it ends), tableNN.csv, .md and .tex, figureNN.png, .svg, "
    ".gp\n"
    "and .dat, worlds/ (the blocked worlds), planner.yaml and report.html, which reads as a short paper.\n"
    "Runs whose time is reported are made last, one at a time: leave the machine alone meanwhile.\n"
    "Exit codes: 0 the study ran to its end, whatever it found; 1 it is not complete (Ctrl-C, runs missing after\n"
    "--merge): --resume goes on; 2 bad usage, file or value.";

struct StudyOptions {
  cli::CommonOptions common;
  int runs = 0;  ///< 0: kRuns or kQuickRuns
  bool quick = false;
  std::string out = "study";
  bool resume = false;
  std::string shard = "1/1";
  std::vector<std::string> merge;
};

study::StudySettings settings_of(const StudyOptions& options, const config::Settings& planner) {
  study::StudySettings s;
  s.version = JINK_VERSION;
  s.seed = options.common.seed;
  s.quick = options.quick;
  s.runs = options.runs > 0 ? options.runs : options.quick ? kQuickRuns : kRuns;
  s.shard = campaign::shard_of(options.shard);
  s.parameters = config::list_settings(planner);
  return s;
}

campaign::Progress progress_of(const study::Progress& p) {
  const double done = p.seconds_before + p.seconds_in_this_call;
  return {done, done + p.seconds_left, p.seconds_in_this_call,
          fmt::format("{} of {} runs{}", p.done, p.total, p.timing ? ", now timing them one by one" : "")};
}

/// Tables, figures and report into the folder, the summary to --json.
void conclude(const study::Results& results, const study::Setting& setting, const StudyOptions& options,
              const cli::Printer& printer) {
  printer.line(fmt::format("{} runs; writing tables, figures and report", results.runs.size()));
  const nlohmann::ordered_json summary =
      study::write_study(results, setting, options.out, options.common.thread_count());
  const auto& verdicts = summary.at("verdicts");
  for (std::size_t i = 0; i < std::min(kToldVerdicts, verdicts.size()); ++i) {
    std::string text = verdicts[i].get<std::string>();
    for (auto at = text.find("**"); at != std::string::npos; at = text.find("**")) text.erase(at, 2);
    printer.line("  " + text);
  }
  printer.line("\nreport: " + fs::absolute(fs::path(options.out) / "report.html").string());
  cli::write_json(options.common.json, summary);
}

int run_study(const StudyOptions& options, const cli::Printer& printer) {
  const config::Settings planner = options.common.settings();
  const study::StudySettings settings = settings_of(options, planner);
  study::Results results = campaign::resumed<study::Results>(
      study::results_path(options.out), settings, options.out, options.resume, printer, study::read_results,
      [](const study::Results& earlier) { return fmt::format("{} runs of an earlier call", earlier.runs.size()); });
  jink::tools::figures::require_gnuplot();
  const study::Setting setting(settings, planner);
  campaign::make_folder(options.out);
  cli::require_json(options.common.json);
  campaign::JsonLinesFile file(study::results_path(options.out), study::to_header(results.settings));
  const study::Machine machine = study::this_machine();
  file.append(study::to_json(machine));
  results.add(machine);
  const std::size_t total = study::jobs_of(settings).size();
  const int threads = options.common.thread_count();
  printer.line(
      fmt::format("seed {}: {} runs on {} threads, results in {}", settings.seed, total, threads, options.out));
  cli::catch_signals();
  campaign::ProgressPrinter progress(printer);
  study::CampaignOptions campaign_options{threads, cli::interrupted,
                                          [&](const study::Progress& p) { progress(progress_of(p)); }};
  const bool complete = study::run_campaign(results, file, setting, campaign_options);
  printer.line("");
  conclude(results, setting, options, printer);
  if (complete) return base::kExitReached;
  printer.line(
      fmt::format("interrupted: the same command with --resume makes the other {} runs", total - results.runs.size()));
  return base::kExitFailed;
}

int run_merge(const StudyOptions& options, const cli::Printer& printer) {
  std::error_code error;
  if (fs::exists(study::results_path(options.out), error))
    throw cli::UsageError(fmt::format("--out: '{}' holds a campaign; merge into another folder", options.out));
  const study::Results results = study::merge_results({options.merge.begin(), options.merge.end()});
  std::vector<std::string> missing;
  const config::Settings planner = config::recorded_settings(study::results_path(options.merge.front()).string(),
                                                             results.settings.parameters, {}, missing);
  jink::tools::figures::require_gnuplot();
  const study::Setting setting(results.settings, planner);
  campaign::make_folder(options.out);
  conclude(results, setting, options, printer);
  // Last, so that a merge that was interrupted can be repeated.
  campaign::write_atomically(study::results_path(options.out), study::to_text(results));
  const std::size_t all = study::jobs_of(results.settings).size();
  if (results.runs.size() == all) return base::kExitReached;
  printer.line(fmt::format("{} of {} runs are missing: the same settings with --out {} --resume make them",
                           all - results.runs.size(), all, options.out));
  return base::kExitFailed;
}

int run(const StudyOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  try {
    return options.merge.empty() ? run_study(options, printer) : run_merge(options, printer);
  } catch (const campaign::ResultsError& error) {
    throw cli::UsageError(error.what());
  } catch (const jink::tools::figures::FigureError& error) {
    throw cli::UsageError(error.what());
  }
}

}  // namespace

cli::Subcommand add_study(const cli::Parser& jink) {
  const cli::Parser app = jink.add_subcommand(
      "study", "run the paper's experiments again: every table and figure of its section 5, and harder ones");
  const auto options = std::make_shared<StudyOptions>();
  app.add_option("--runs", options->runs,
                 fmt::format("runs of each variant, with seeds of their own (default: {}, or {} with --quick)", kRuns,
                             kQuickRuns))
      .transform(cli::whole_number({1, study::kMostStudyRuns}));
  app.add_flag("--quick", options->quick,
               "a first look in about a minute: few runs, Tables 13 and 14 without their largest cells");
  app.add_option("--out", options->out, "folder for the results").check(cli::some_name()).show_default();
  app.add_flag("--resume", options->resume, "go on with what is in --out; all other options as before");
  app.add_option("--shard", options->shard,
                 "K/N: make the K-th of N parts, for several machines; --merge puts them together")
      .show_default();
  app.add_option("--merge", options->merge, "put the results in these folders together into --out")
      .expected(1, campaign::kMostShards);
  options->common.add_to(app);
  app.option("--threads")
      .describe("runs at once, and threads of the planner in timed runs, 1 to 256 (default: one for each core)");
  app.footer(kStudyFooter);
  return {app, [options, app] {
            campaign::refuse_beside(app, "--merge",
                                    {"--runs", "--quick", "--resume", "--shard", "--seed", "--config", "--set"});
            return run(*options);
          }};
}

}  // namespace jink::tools::lab::commands
