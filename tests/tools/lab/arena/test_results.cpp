// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>
#include <sstream>

#include "tests/support/temporary_folder.hpp"
#include "tests/tools/lab/arena/example_records.hpp"

namespace jink::tools::lab::arena {
namespace {

using support::Folder;
using support::has;
using support::read;
using support::refusal;
using support::write;

std::string refusal_of(const std::filesystem::path& file, const std::string& text) {
  write(file, text);
  return refusal<ResultsError>([&] { static_cast<void>(read_results(file)); });
}
TEST(WorldSeed, IsAnotherOneForEachRunFamilyAndSeed) {
  std::set<std::uint64_t> of_runs;
  for (int run = 0; run < 20000; ++run) of_runs.insert(world_seed(1, "crossing", run));
  EXPECT_EQ(of_runs.size(), 20000U);
  EXPECT_LT(*of_runs.rbegin(), std::uint64_t{1} << 32U);
  EXPECT_NE(world_seed(1, "crossing", 0), world_seed(2, "crossing", 0));
  EXPECT_NE(world_seed(1, "crossing", 0), world_seed(1, "falling", 0));
  EXPECT_NE(world_seed(1, "ab", 0), world_seed(1, "ba", 0));
}

TEST(Jobs, GoThroughAllFamiliesRunByRunAndNumberThemselves) {
  const std::vector<Job> jobs = jobs_of(two_families(3));
  ASSERT_EQ(jobs.size(), 12U);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    EXPECT_EQ(jobs[i].number, i);
    EXPECT_EQ(jobs[i].world.number, i / 2);
    EXPECT_EQ(jobs[i].world.run, static_cast<int>(i / 4));
    EXPECT_EQ(jobs[i].world.family, i / 2 % 2 == 0 ? "crossing" : "falling");
    EXPECT_EQ(jobs[i].tier, i % 2 == 0 ? "perfect" : "realistic");
    EXPECT_EQ(jobs[i].world.seed, world_seed(1, jobs[i].world.family, jobs[i].world.run));
  }
}

TEST(Jobs, OfTheShardsAreThoseOfTheWholeOnceEach) {
  CampaignSettings settings = two_families(5);
  std::map<std::size_t, std::string> found;
  std::set<std::size_t> worlds;
  for (settings.shard = {1, 3}; settings.shard.number <= 3; ++settings.shard.number) {
    std::set<std::size_t> of_shard;
    std::set<std::string> families;
    for (const Job& job : jobs_of(settings)) {
      EXPECT_TRUE(found.emplace(job.number, job.name()).second);
      of_shard.insert(job.world.number);
      families.insert(job.world.family);
    }
    EXPECT_EQ(families.size(), 2U) << "a shard has something of each family";
    for (const std::size_t world : of_shard) EXPECT_TRUE(worlds.insert(world).second) << "a world is of one shard";
  }
  settings.shard = {};
  const std::vector<Job> whole = jobs_of(settings);
  ASSERT_EQ(found.size(), whole.size());
  for (const Job& job : whole) EXPECT_EQ(found.at(job.number), job.name());
}

TEST(CampaignSettings, DifferencesAreNamed) {
  const CampaignSettings settings = two_families(3);
  EXPECT_TRUE(differences(settings, "A", from_header(to_header(settings)), "B").empty());
  CampaignSettings other = settings;
  other.runs = 4;
  other.parameters[0].value = "0.5";
  other.parameters.pop_back();
  const auto differ = differences(settings, "A", other, "B");
  ASSERT_EQ(differ.size(), 3U);
  EXPECT_EQ(differ[0], "runs: 3 in A, 4 in B");
  EXPECT_EQ(differ[1], "horizon.margin: 0.35 in A, 0.5 in B");
  EXPECT_EQ(differ[2], "companion.drag: 1 in A, missing in B");
}

TEST(CampaignSettings, ParametersAreWrittenAsAPlannerFile) {
  EXPECT_EQ(
      campaign::parameters_yaml(two_families(1).parameters),
      "# The planner's parameters in this campaign.\nformat: jink-planner/1\nhorizon:\n  margin: 0.35\n  time: 6\n"
      "companion:\n  drag: 1\n");
}

TEST(Results, ReadBackToTheSameText) {
  const Folder folder;
  Results results = all_reached(two_families(2));
  FlightRecord& odd = results.flights.at(3);
  odd.min_clearance = planner::base::kInfinity;
  odd.flight_time = 0.1 + 0.2;
  odd.reason = "ends\nwith \xc3\xa9";
  results.add(WorldRecord{1, odd.family, odd.seed, Verdict::kImpossible});
  write(folder.path() / "flights.jsonl", to_text(results));
  const Results again = read_results(folder.path() / "flights.jsonl");
  EXPECT_EQ(to_text(again), to_text(results));
  EXPECT_EQ(again.flights.at(3).flight_time, 0.1 + 0.2);
  EXPECT_EQ(again.flights.at(3).min_clearance, planner::base::kInfinity);
  EXPECT_EQ(again.worlds.at(1).verdict, Verdict::kImpossible);
  EXPECT_FALSE(again.cut_off);
}

TEST(Results, ALastLineThatIsCutOffDoesNotCountWhereverItIsCut) {
  const Folder folder;
  const std::filesystem::path file = folder.path() / "flights.jsonl";
  const Results results = all_reached(two_families(1));
  const std::string text = to_text(results);
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  for (std::size_t length = last + 1; length < text.size(); ++length) {
    write(file, text.substr(0, length));
    const Results cut = read_results(file);
    EXPECT_TRUE(cut.cut_off) << length;
    EXPECT_EQ(cut.flights.size(), results.flights.size() - 1) << length;
  }
  EXPECT_TRUE(campaign::has_begun(file));
  EXPECT_TRUE(has(refusal_of(file, text.substr(0, 30)), "holds no header"));
  EXPECT_FALSE(campaign::has_begun(file));
  EXPECT_FALSE(campaign::has_begun(folder.path() / "none"));
}

TEST(Results, WhatNoCampaignWroteIsNamedWithItsLine) {
  const Folder folder;
  const std::filesystem::path file = folder.path() / "flights.jsonl";
  const std::string text = to_text(all_reached(two_families(1)));
  const std::size_t second = text.find('\n') + 1, third = text.find('\n', second) + 1;
  const std::string header = text.substr(0, second), line = text.substr(second, third - second);
  const std::string name = file.string();
  EXPECT_TRUE(has(refusal_of(file, header + "{\"type\":\n" + line), name + ":2: is not JSON"));
  EXPECT_TRUE(has(refusal_of(file, line), name + ":1: the first line is not a jink-arena-results/1 header"));
  EXPECT_TRUE(has(refusal_of(file, header + "{\"type\":\"flight\"}\n"), name + ":2: no flight: "));
  EXPECT_TRUE(has(refusal_of(file, header + "[1]\n"), name + ":2: neither a flight nor a world"));
  std::string other = line;
  other.replace(other.find("\"job\":0"), 7, "\"job\":4");
  EXPECT_TRUE(has(refusal_of(file, header + other), name + ":2: flight 4 is not of this campaign"));
  other.replace(other.find("\"job\":4"), 7, "\"job\":1");
  EXPECT_TRUE(has(refusal_of(file, header + other), name + ":2: flight 1 should be crossing-"));
  EXPECT_TRUE(has(refusal<ResultsError>([&] { static_cast<void>(read_results(folder.path() / "none")); }),
                  "none: cannot be read"));
}

TEST(Results, OneFlightHasOneResult) {
  const CampaignSettings settings = two_families(1);
  const Job job = jobs_of(settings).front();
  Results results;
  results.settings = settings;
  results.add(flight_of(job, "reached", 0.5));
  FlightRecord again = flight_of(job, "reached", 0.5);
  again.measured.wall_s = 9.0;
  results.add(again);  // the wall clock is no result
  EXPECT_EQ(results.flights.size(), 1U);
  again.min_clearance = 0.4;
  EXPECT_TRUE(has(refusal<ResultsError>([&] { results.add(again); }), "has two different results"));
}

TEST(ResultsFile, GoesOnBehindTheLastWholeLine) {
  const Folder folder;
  const std::filesystem::path file = folder.path() / "flights.jsonl";
  const Results results = all_reached(two_families(1));
  const std::string text = to_text(results);
  write(file, text.substr(0, text.size() - 10));
  {
    const Results earlier = read_results(file);
    ResultsFile out(file, earlier);
    out.append(to_json(results.flights.at(3)));
  }
  EXPECT_EQ(read(file), text);
}

TEST(ResultsFile, IsOneProcessesOwn) {
  const Folder folder;
  const std::filesystem::path file = folder.path() / "flights.jsonl";
  const Results results = all_reached(two_families(1));
  {
    const ResultsFile first(file, results);
    EXPECT_TRUE(has(refusal<ResultsError>([&] { const ResultsFile second(file, results); }),
                    "another process is writing there"));
  }
  const ResultsFile later(file, results);
  EXPECT_TRUE(has(refusal<ResultsError>([&] { const ResultsFile none(folder.path() / "no" / "x", results); }),
                  "cannot be written"));
}

TEST(Merge, OfTheShardsIsTheWhole) {
  const Folder folder;
  CampaignSettings settings = two_families(4);
  const Results whole = all_reached(settings);
  std::vector<std::filesystem::path> parts;
  for (settings.shard = {1, 3}; settings.shard.number <= 3; ++settings.shard.number) {
    parts.push_back(folder.path() / std::to_string(settings.shard.number));
    write(results_path(parts.back()), to_text(all_reached(settings)));
  }
  std::swap(parts[0], parts[2]);
  parts.push_back(parts[0]);  // the same once more
  EXPECT_EQ(to_text(merge_results(parts)), to_text(whole));
}

TEST(Merge, RefusesOtherSettingsAndOtherResults) {
  const Folder folder;
  const CampaignSettings settings = two_families(1);
  Results results = all_reached(settings);
  write(results_path(folder.path() / "a"), to_text(results));
  results.flights.at(2).outcome = "collision";
  write(results_path(folder.path() / "b"), to_text(results));
  CampaignSettings other = settings;
  other.seed = 2;
  write(results_path(folder.path() / "c"), to_text(all_reached(other)));
  const auto merge = [&](const char* second) {
    return refusal<ResultsError>([&] {
      static_cast<void>(merge_results({folder.path() / "a", folder.path() / second}));
    });
  };
  EXPECT_TRUE(has(merge("b"), "flight 2 (falling:")) << merge("b");
  EXPECT_TRUE(has(merge("b"), "two different results"));
  EXPECT_TRUE(has(merge("c"), "these are two campaigns: seed: 1 in ")) << merge("c");
  EXPECT_TRUE(has(merge("none"), "cannot be read"));
}

}  // namespace
}  // namespace jink::tools::lab::arena
