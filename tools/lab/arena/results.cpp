// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/results.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <optional>

#include "tools/lab/campaign/merge.hpp"

namespace jink::tools::lab::arena {
namespace {

using Json = nlohmann::ordered_json;

/// The flights and worlds that a file with these settings may hold.
struct Expected {
  explicit Expected(const CampaignSettings& settings) {
    for (Job& job : jobs_of(settings)) {
      worlds.emplace(job.world.number, job.world);
      const std::size_t number = job.number;
      jobs.emplace(number, std::move(job));
    }
  }
  void check(const FlightRecord& r) const {
    const auto found = jobs.find(r.job);
    if (found == jobs.end()) throw std::runtime_error(fmt::format("flight {} is not of this campaign", r.job));
    const Job& job = found->second;
    if (job.world.family != r.family || job.world.seed != r.seed || job.tier != r.tier || job.pilot != r.pilot)
      throw std::runtime_error(fmt::format("flight {} should be {}", r.job, job.name()));
  }
  void check(const WorldRecord& r) const {
    const auto found = worlds.find(r.world);
    if (found == worlds.end()) throw std::runtime_error(fmt::format("world {} is not of this campaign", r.world));
    if (found->second.family != r.family || found->second.seed != r.seed)
      throw std::runtime_error(
          fmt::format("world {} should be {}:{}", r.world, found->second.family, found->second.seed));
  }

  std::map<std::size_t, Job> jobs;
  std::map<std::size_t, World> worlds;
};

void add_line(const Json& line, const Expected& expected, Results& results) {
  const std::string type = line.is_object() ? line.value("type", "") : "";
  if (type == "flight") {
    FlightRecord record = flight_from(line);
    expected.check(record);
    results.add(std::move(record));
  } else if (type == "world") {
    const WorldRecord record = world_from(line);
    expected.check(record);
    results.add(record);
  } else {
    throw std::runtime_error("neither a flight nor a world");
  }
}

}  // namespace

void Results::add(FlightRecord record) {
  const auto found = flights.find(record.job);
  if (found == flights.end()) {
    const std::size_t job = record.job;
    flights.emplace(job, std::move(record));
  } else if (!same_result(found->second, record)) {
    throw ResultsError(fmt::format("flight {} ({}:{}, {}, {}) has two different results", record.job, record.family,
                                   record.seed, record.tier, record.pilot));
  }
}

void Results::add(const WorldRecord& record) {
  const auto [found, is_new] = worlds.emplace(record.world, record);
  if (!is_new && found->second.verdict != record.verdict)
    throw ResultsError(fmt::format("world {}:{} has two verdicts", record.family, record.seed));
}

std::filesystem::path results_path(const std::filesystem::path& out) {
  return out / "flights.jsonl";
}

Results read_results(const std::filesystem::path& file) {
  Results results;
  std::optional<Expected> expected;
  results.cut_off = campaign::read_lines(
      file,
      [&](const Json& header) {
        results.settings = from_header(header);
        expected.emplace(results.settings);
      },
      [&](const Json& line) { add_line(line, *expected, results); });
  return results;
}

Results merge_results(const std::vector<std::filesystem::path>& folders) {
  return campaign::merge<Results>(
      folders, "campaigns", [](const std::filesystem::path& folder) { return read_results(results_path(folder)); },
      [](Results& merged, Results& part) {
        for (auto& [job, record] : part.flights) merged.add(std::move(record));
        for (const auto& [world, record] : part.worlds) merged.add(record);
      });
}

std::string to_text(const Results& results) {
  std::string text = to_header(results.settings).dump() + "\n";
  for (const auto& [world, record] : results.worlds) text += to_json(record).dump() + "\n";
  for (const auto& [job, record] : results.flights) text += to_json(record).dump() + "\n";
  return text;
}

ResultsFile::ResultsFile(const std::filesystem::path& file, const Results& results)
    : campaign::JsonLinesFile(file, to_header(results.settings)) {}

}  // namespace jink::tools::lab::arena
