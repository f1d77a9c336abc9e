// SPDX-License-Identifier: BSD-3-Clause
// Real flights, with a small search: what is flown must not depend on how.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "config/scenario.hpp"
#include "tests/support/repetitions.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/lab/arena/campaign.hpp"
#include "tools/lab/arena/flight_runner.hpp"
#include "tools/lab/arena/html_page.hpp"

namespace jink::tools::lab::arena {
namespace {

namespace fs = std::filesystem;
using support::Folder;
using support::read;

config::Settings quick_planner() {
  config::Settings settings;
  settings.horizon.generations = 4;
  settings.horizon.population = 8;
  settings.companion.largest_replan_rate_hz = 10.0;
  return settings;
}

/// Runs of each family.
constexpr int kFew = support::kSanitized ? 1 : 2;

/// In `gates` and `darts` such a planner comes through most worlds, straight flight through none.
CampaignSettings small(int runs) {
  CampaignSettings settings;
  settings.version = "0.1.0";
  settings.families = {"darts", "gates"};
  settings.pilots = {"jink"};
  settings.tiers = {"perfect", "realistic"};
  settings.runs = runs;
  settings.parameters = config::list_settings(quick_planner());
  return settings;
}

struct Flown {
  Results results;
  bool complete = false;
};

/// Flies on in `out`; interrupted once `flights` have ended there.
Flown fly_in(const fs::path& out, const CampaignSettings& settings, int threads, std::size_t flights = 1000) {
  fs::create_directories(out);
  Flown flown;
  flown.results.settings = settings;
  if (fs::exists(results_path(out))) flown.results = read_results(results_path(out));
  ResultsFile file(results_path(out), flown.results);
  CampaignOptions options;
  options.out = out;
  options.settings = quick_planner();
  options.threads = threads;
  const fs::path written = results_path(out);
  options.interrupted = [written, flights] {
    std::ifstream in(written);
    return static_cast<std::size_t>(std::count(std::istreambuf_iterator<char>(in), {}, '\n')) > flights;
  };
  options.on_progress = [](const Progress&) {};
  flown.complete = fly_campaign(flown.results, file, options);
  return flown;
}

/// All results, without what was measured.
std::string text_of(Results results) {
  for (auto& flight : results.flights) flight.second.measured = {};
  return to_text(results) + table_csv(summarise(results)) + flights_csv(results, "out");
}

TEST(Campaign, IsTheSameAtAnyThreadCountAndInShards) {
  const Folder folder;
  CampaignSettings settings = small(kFew);
  settings.tiers = support::repetitions<std::string>({"perfect", "realistic"});
  const Flown one = fly_in(folder.path() / "one", settings, 1);
  EXPECT_TRUE(one.complete);
  EXPECT_EQ(one.results.flights.size(), jobs_of(settings).size());
  EXPECT_EQ(text_of(fly_in(folder.path() / "four", settings, 4).results), text_of(one.results));
  std::vector<fs::path> parts;
  for (settings.shard = {1, 2}; settings.shard.number <= 2; ++settings.shard.number) {
    parts.push_back(folder.path() / std::to_string(settings.shard.number));
    EXPECT_TRUE(fly_in(parts.back(), settings, 2).complete);
  }
  EXPECT_EQ(text_of(merge_results(parts)), text_of(one.results));
}

TEST(Campaign, GoesOnAfterAnInterruptionAndAfterACutLine) {
  const Folder folder;
  CampaignSettings settings = small(kFew);
  settings.tiers = support::repetitions<std::string>({"perfect", "realistic"});
  const Flown whole = fly_in(folder.path() / "whole", settings, 2);
  const fs::path out = folder.path() / "parts";
  const Flown first = fly_in(out, settings, 2, 1);
  EXPECT_FALSE(first.complete);
  EXPECT_LT(first.results.flights.size(), whole.results.flights.size());
  const std::string text = read(results_path(out));
  std::ofstream(results_path(out), std::ios::binary) << text.substr(0, text.size() - 20);
  const Flown second = fly_in(out, settings, 2);
  EXPECT_TRUE(second.complete);
  EXPECT_EQ(text_of(second.results), text_of(whole.results));
  EXPECT_EQ(text_of(read_results(results_path(out))), text_of(whole.results));
  const Flown nothing_left = fly_in(out, settings, 2);
  EXPECT_TRUE(nothing_left.complete);
  EXPECT_EQ(text_of(nothing_left.results), text_of(whole.results));
}

TEST(Campaign, LeavesScenarioAndLogOfEveryFailedFlightAndNoOther) {
  const Folder folder;
  CampaignSettings settings = small(kFew);
  settings.families = {"darts"};
  settings.pilots = {"jink", "straight"};
  const Flown flown = fly_in(folder.path(), settings, 2);
  const Summary summary = summarise(flown.results);
  ASSERT_FALSE(summary.failures.empty());
  ASSERT_LT(summary.failures.size(), flown.results.flights.size());
  for (const auto& [job, record] : flown.results.flights) {
    const Job job_of{record.job, {0, record.family, 0, record.seed}, record.tier, record.pilot};
    const fs::path left = failure_folder(folder.path(), job_of.name());
    EXPECT_EQ(fs::exists(left), !record.reached()) << left;
    if (record.reached()) continue;
    const config::Scenario scenario = config::load_scenario(left / "scenario.yaml");
    EXPECT_EQ(scenario.sensing.dropout > 0.0, record.tier == "realistic");
    const std::string log = read(left / "flight.jsonl");
    EXPECT_NE(log.find("\"pilot\":\"" + record.pilot + "\""), std::string::npos);
    EXPECT_NE(log.find("\"name\":\"" + record.outcome + "\""), std::string::npos) << left;
    // What is replayed is the same flight.
    const Stop never = [] { return false; };
    EXPECT_TRUE(same_result(fly(job_of, scenario, quick_planner(), never), record));
  }
}

TEST(Campaign, MeasuresEveryPlan) {
  const Folder folder;
  CampaignSettings settings = small(1);
  settings.families = {"gates"};
  for (const auto& [job, record] : fly_in(folder.path(), settings, 1).results.flights) {
    EXPECT_GE(record.measured.plan_ms.count(), record.plans);
    EXPECT_LE(record.measured.plan_ms.count(), record.plans + 1) << "at most the one that the flight's end cut short";
    EXPECT_GT(record.measured.plan_ms.max(), 0.0);
    EXPECT_GT(record.measured.wall_s, 0.0);
  }
}

// With a map and shapes: flown, and what failed written and flown again from the file to the same bits.
TEST(Campaign, FliesKnownPlacesInEachTier) {
  const Folder folder;
  CampaignSettings settings = small(1);
  settings.families = {"truck", "sliding_gate"};
  settings.pilots = {"straight", "stop_and_wait"};
  settings.tiers = {"field", "perfect", "realistic"};
  settings.oracle = false;
  const Flown flown = fly_in(folder.path(), settings, 2);
  ASSERT_TRUE(flown.complete);
  ASSERT_EQ(flown.results.flights.size(), 12U);
  for (const auto& [job, record] : flown.results.flights) {
    SCOPED_TRACE(record.family + ", " + record.tier + ", " + record.pilot);
    EXPECT_GT(record.plans, 0);
    if (record.pilot == "straight" && record.tier == "perfect") {
      EXPECT_EQ(record.outcome, "collision");
    }
    if (record.reached()) continue;
    const Job job_of{record.job, {0, record.family, 0, record.seed}, record.tier, record.pilot};
    const config::Scenario again =
        config::load_scenario(failure_folder(folder.path(), job_of.name()) / "scenario.yaml");
    EXPECT_FALSE(again.map.empty());
    const Stop never = [] { return false; };
    EXPECT_TRUE(same_result(fly(job_of, again, quick_planner(), never), record));
  }
}

TEST(Campaign, JudgesOnlyWorldsInWhichNobodyArrived) {
  const Folder folder;
  CampaignSettings settings = small(kFew);
  settings.families = {"head_on"};
  settings.pilots = {"jink", "straight"};
  settings.tiers = support::repetitions<std::string>({"perfect", "realistic"});
  const Results both = fly_in(folder.path() / "both", settings, 2).results;
  std::set<std::string> arrived;
  for (const auto& [job, record] : both.flights)
    if (record.reached()) arrived.insert(record.pilot);
  ASSERT_EQ(arrived, std::set<std::string>{"jink"});
  EXPECT_TRUE(both.worlds.empty()) << "somebody came through every world";
  settings.pilots = {"straight"};
  EXPECT_EQ(fly_in(folder.path() / "straight", settings, 2).results.worlds.size(),
            static_cast<std::size_t>(settings.runs));
  settings.oracle = false;
  EXPECT_TRUE(fly_in(folder.path() / "off", settings, 2).results.worlds.empty());
}

TEST(Campaign, WhatAFlightThrowsEndsItAndNamesTheFlight) {
  const Folder folder;
  CampaignSettings settings = small(1);
  settings.families = {"gates", "no_such_family"};
  try {
    static_cast<void>(fly_in(folder.path(), settings, 1));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("flight no_such_family-", 0), 0U) << error.what();
  }
  EXPECT_EQ(read_results(results_path(folder.path())).flights.size(), 2U) << "what ended before is kept";
}

TEST(Campaign, GivesUpAFlightUnderWay) {
  const Job job = jobs_of(small(1)).front();
  int asked = 0;
  const Stop soon = [&] { return ++asked > 10; };
  EXPECT_THROW(static_cast<void>(fly(job, scenario_of(job.world, job.tier), quick_planner(), soon)), Cancelled);
  EXPECT_EQ(asked, 11);
}

TEST(Campaign, TiersDifferInSensingEstimateAndWindAlone) {
  const World world{0, "gates", 0, 17};
  config::Scenario perfect = scenario_of(world, "perfect");
  const config::Scenario realistic = scenario_of(world, "realistic");
  EXPECT_EQ(perfect.sensing.dropout, 0.0);
  EXPECT_EQ(realistic.sensing.dropout, 0.05);
  EXPECT_EQ(realistic.sensing.position_noise, 0.1);
  EXPECT_EQ(realistic.sensing.velocity_noise, 0.3);
  EXPECT_EQ(realistic.sensing.delay, 0.1);
  EXPECT_EQ(realistic.sensing.range, 12.0);
  const config::Scenario field = scenario_of(world, "field");
  EXPECT_EQ(field.sensing.dropout, 0.05);
  EXPECT_TRUE(field.estimate.px4);
  EXPECT_FALSE(perfect.estimate.px4 || realistic.estimate.px4);
  EXPECT_EQ(field.start, perfect.start);
  EXPECT_EQ(perfect.start, realistic.start);
  EXPECT_EQ(perfect.obstacles.size(), realistic.obstacles.size());
  EXPECT_THROW(static_cast<void>(scenario_of(world, "wild")), std::invalid_argument);
}

}  // namespace
}  // namespace jink::tools::lab::arena
