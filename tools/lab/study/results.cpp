// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/results.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <stdexcept>

#include "tools/lab/campaign/merge.hpp"

namespace jink::tools::lab::study {
namespace {

using Json = nlohmann::ordered_json;
using Expected = std::map<std::size_t, Job>;

void add_line(const Json& line, const Expected& expected, Results& results) {
  const std::string type = line.is_object() ? line.value("type", "") : "";
  if (type == "machine") return results.add(machine_from(line));
  if (type != "run") throw std::runtime_error("neither a run nor a machine");
  Record record = record_from(line);
  const auto found = expected.find(record.job.number);
  if (found == expected.end()) throw std::runtime_error(fmt::format("run {} is not of this study", record.job.number));
  const Job& job = found->second;
  if (job.variant != record.job.variant || job.run != record.job.run || job.seed != record.job.seed)
    throw std::runtime_error(fmt::format("run {} should be {} with seed {}", job.number, job.name(), job.seed));
  results.add(std::move(record));
}

}  // namespace

void Results::add(Record record) {
  const auto found = runs.find(record.job.number);
  if (found == runs.end()) {
    const std::size_t number = record.job.number;
    runs.emplace(number, std::move(record));
  } else if (!same_result(found->second, record)) {
    throw ResultsError(fmt::format("run {} ({}) has two different results", record.job.number, record.job.name()));
  }
}

void Results::add(const Machine& machine) {
  if (std::find(machines.begin(), machines.end(), machine) == machines.end()) machines.push_back(machine);
}

std::filesystem::path results_path(const std::filesystem::path& out) {
  return out / "runs.jsonl";
}

Results read_results(const std::filesystem::path& file) {
  Results results;
  Expected expected;
  results.cut_off = campaign::read_lines(
      file,
      [&](const Json& header) {
        results.settings = from_header(header);
        for (Job& job : jobs_of(results.settings)) {
          const std::size_t number = job.number;
          expected.emplace(number, std::move(job));
        }
      },
      [&](const Json& line) { add_line(line, expected, results); });
  return results;
}

Results merge_results(const std::vector<std::filesystem::path>& folders) {
  return campaign::merge<Results>(
      folders, "studies", [](const std::filesystem::path& folder) { return read_results(results_path(folder)); },
      [](Results& merged, Results& part) {
        for (auto& [number, record] : part.runs) merged.add(std::move(record));
        for (const Machine& machine : part.machines) merged.add(machine);
      });
}

std::string to_text(const Results& results) {
  std::string text = to_header(results.settings).dump() + "\n";
  for (const Machine& machine : results.machines) text += to_json(machine).dump() + "\n";
  for (const auto& [number, record] : results.runs) text += to_json(record).dump() + "\n";
  return text;
}

}  // namespace jink::tools::lab::study
