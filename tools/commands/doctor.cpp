// SPDX-License-Identifier: BSD-3-Clause
// jink doctor: what stands in the way of a flight, and what to do about it.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>

#include "bridge/base/clock.hpp"
#include "bridge/doctor/dds_checks.hpp"
#include "bridge/doctor/vehicle_checks.hpp"
#include "bridge/mavsdk/link.hpp"
#include "config/mission.hpp"
#include "tools/cli/command_line.hpp"

namespace jink::tools::commands {
namespace {

using bridge::doctor::Check;
using Checks = std::vector<Check>;

struct DoctorOptions {
  cli::CommonOptions common;
  std::string mission;
  double seconds = 5.0;
};

int exit_code(Check::Level level) {
  switch (level) {
    case Check::Level::kFault:
      return base::kExitFailed;
    case Check::Level::kMissing:
      return base::kExitMissingPeer;
    default:
      return base::kExitReached;
  }
}

const char* colour(Check::Level level) {
  switch (level) {
    case Check::Level::kOk:
      return "\033[32m";
    case Check::Level::kWarning:
      return "\033[33m";
    default:
      return "\033[31m";
  }
}

/// One line a check: level, name, finding; the remedy behind an arrow. Columns as wide as the widest of a usual length.
void tell(const Checks& checks, const cli::Printer& printer) {
  constexpr std::size_t kLevelWidth = 7;
  constexpr std::size_t kWidestFinding = 64;
  std::size_t name_width = 0;
  std::size_t finding_width = 0;
  for (const Check& check : checks) {
    name_width = std::max(name_width, check.name.size());
    if (check.remedy.empty() || check.finding.size() > kWidestFinding) continue;
    finding_width = std::max(finding_width, check.finding.size());
  }
  for (const Check& check : checks) {
    std::string level = fmt::format("{:<{}}", bridge::doctor::to_string(check.level), kLevelWidth);
    if (printer.terminal()) level = fmt::format("{}{}\033[0m", colour(check.level), level);
    const std::string remedy = check.remedy.empty() ? "" : "  -> " + check.remedy;
    printer.line(fmt::format("{}  {:<{}}  {:<{}}{}", level, check.name, name_width, check.finding,
                             remedy.empty() ? 0 : finding_width, remedy));
  }
}

nlohmann::ordered_json as_json(const config::Mission& mission, const Checks& checks) {
  auto list = nlohmann::ordered_json::array();
  for (const Check& check : checks) {
    list.push_back({{"name", check.name},
                    {"level", bridge::doctor::to_string(check.level)},
                    {"finding", check.finding},
                    {"remedy", check.remedy}});
  }
  return {{"format", "jink-doctor/1"},
          {"mission", mission.name},
          {"checks", list},
          {"worst", bridge::doctor::to_string(bridge::doctor::worst(checks))}};
}

std::string verdict(const Checks& checks) {
  const auto count = [&](Check::Level level) {
    return std::count_if(checks.begin(), checks.end(), [&](const Check& c) { return c.level == level; });
  };
  const auto faults = count(Check::Level::kFault) + count(Check::Level::kMissing);
  const auto warnings = count(Check::Level::kWarning);
  if (faults == 0 && warnings == 0) return "ready to fly";
  const auto counted = [](auto number, const char* what) {
    return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
  };
  if (faults == 0) return "ready to fly, with " + counted(warnings, "warning");
  return "not ready to fly: " + counted(faults, "fault") + ", " + counted(warnings, "warning");
}

int run(const DoctorOptions& options) {
  const cli::Printer printer(options.common.json == "-");
  cli::refuse_same_file({{"MISSION", options.mission}}, {{"--json", options.common.json}});
  const config::Mission mission = config::load_mission(options.mission);
  cli::catch_signals();
  const bridge::base::SteadyClock clock;
  std::unique_ptr<bridge::mavsdk::MavsdkLink> link;
  try {
    link = std::make_unique<bridge::mavsdk::MavsdkLink>(mission.connection, clock,
                                                        static_cast<std::uint32_t>(mission.system_id));
  } catch (const std::runtime_error& error) {
    throw cli::UsageError(options.mission + ": key 'connection': " + error.what());
  }
  std::stop_source stop;
  const std::jthread interrupts([&stop](const std::stop_token& end) {
    while (!end.stop_requested() && !cli::interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop.request_stop();
  });
  printer.line(fmt::format("mission {}: listening for {:g} s on {} and DDS domain {}", mission.name, options.seconds,
                           mission.connection, mission.dds_domain));
  auto tracks = std::async(std::launch::async,
                           [&] { return bridge::doctor::inspect_dds(mission, options.seconds, stop.get_token()); });
  const bridge::doctor::LinkFindings heard =
      bridge::doctor::listen(*link, clock, options.seconds, stop.get_token(), mission.autopilot_fence);
  Checks checks = bridge::doctor::inspect_link(mission, heard);
  const auto append = [&checks](Checks more) { std::move(more.begin(), more.end(), std::back_inserter(checks)); };
  append(bridge::doctor::inspect_mission(mission, heard));
  append(tracks.get());
  if (cli::interrupted()) {
    printer.line("interrupted: no result");
    return base::kExitFailed;
  }
  tell(checks, printer);
  printer.line(verdict(checks));
  cli::write_json(options.common.json, as_json(mission, checks));
  return exit_code(bridge::doctor::worst(checks));
}

}  // namespace

cli::Subcommand add_doctor(const cli::Parser& jink) {
  const cli::Parser app = jink.add_subcommand(
      "doctor", "check link, rates, health, frames, parameters and tracks before a flight; nothing is commanded");
  app.footer("Exit codes: 0 nothing worse than a warning; 1 a fault; 2 bad usage, file or value; 3 a peer is missing.");
  const auto options = std::make_shared<DoctorOptions>();
  app.add_option("MISSION", options->mission, "mission file").required();
  app.add_option("--seconds", options->seconds, "how long to wait for the autopilot, and then to listen; 1 to 600")
      .check(cli::number_in({1.0, 600.0}))
      .show_default();
  options->common.add_to(app);
  app.option("--json").check(cli::writable_file());
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools::commands
