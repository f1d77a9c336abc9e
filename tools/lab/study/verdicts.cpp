// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/verdicts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/study/tables.hpp"

namespace jink::tools::lab::study {
namespace {

bool always(const Record&) {
  return true;
}
bool has_reached(const Record& r) {
  return r.value(key::kReached) > 0.0;
}

/// HV at the last checkpoint, negative: smaller is better.
double lost_hv(const Record& r) {
  return -r.series.at(key::kHvAt).back();
}

Verdict hv(const Selection& s, std::string_view other, bool blocked) {
  return judge(paired_differences(s.anytime(kRetained, hardest_world(blocked)),
                                  s.anytime(other, hardest_world(blocked)), lost_hv, always));
}

Verdict paths(const Selection& s, std::string_view other, const std::vector<std::string>& worlds,
              const std::function<double(const Record&)>& value, const std::function<bool(const Record&)>& counts,
              double resolution = 0.0) {
  std::vector<double> differences;
  for (const std::string& world : worlds) {
    const auto more = paired_differences(s.paths(kRetained, world), s.paths(other, world), value, counts);
    differences.insert(differences.end(), more.begin(), more.end());
  }
  return judge(differences, resolution);
}

/// Three digits, no exponent for large ones: "1550", "0.000972".
std::string brief(double value, bool sign) {
  if (std::abs(value) >= 1000.0) return sign ? fmt::format("{:+.0f}", value) : fmt::format("{:.0f}", value);
  return sign ? fmt::format("{:+.3g}", value) : fmt::format("{:.3g}", value);
}

std::string names_of(const std::vector<std::string>& list) {
  if (list.size() < 2) return list.empty() ? "none" : list.front();
  return fmt::format("{} and {}", fmt::join(list.begin(), list.end() - 1, ", "), list.back());
}

/// The metrics in which the verdict is `wanted`.
std::vector<std::string> subjects(const std::vector<Verdict>& verdicts, Outcome wanted) {
  std::vector<std::string> list;
  const std::vector<Metric> all = metrics();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (verdicts[i].outcome == wanted)
      list.push_back(
          wanted == Outcome::kBetter || wanted == Outcome::kWorse
              ? fmt::format("{} (by {}{})", all[i].subject, brief(std::abs(verdicts[i].mean), false), all[i].unit)
              : all[i].subject);
  return list;
}

}  // namespace

std::string_view to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kBetter:
      return "better";
    case Outcome::kWorse:
      return "worse";
    case Outcome::kNoDifference:
      return "no difference shown";
    case Outcome::kUnknown:
      break;
  }
  return "unknown";
}

Verdict judge(const std::vector<double>& differences, double resolution) {
  Verdict verdict;
  verdict.pairs = static_cast<int>(differences.size());
  if (differences.empty()) return verdict;
  const statistics::Summary s = statistics::summary(differences);
  verdict.mean = s.mean;
  verdict.low = s.low;
  verdict.high = s.high;
  if (verdict.pairs < 2) return verdict;
  if (std::abs(s.mean) < resolution) {
    verdict.outcome = Outcome::kNoDifference;
    return verdict;
  }
  verdict.outcome = s.high < 0.0 ? Outcome::kBetter : s.low > 0.0 ? Outcome::kWorse : Outcome::kNoDifference;
  return verdict;
}

std::vector<Metric> metrics() {
  return {{"Hypervolume lost, scenario 5", "hypervolume in scenario 5", ""},
          {"Hypervolume lost, blocked", "hypervolume in the blocked world", ""},
          {"Path length, scenario 5 (µm)", "path length in scenario 5", " µm"},
          {"Paths that fail, blocked 1-5 (%)", "paths that fail in the blocked worlds", " %"},
          {"Path length where both reach, blocked 1-5 (mm)", "path length in the blocked worlds", " mm"},
          {"Planning time, scenario 5 (ms)", "planning time in scenario 5", " ms"},
          {"Planning time, blocked 5 (ms)", "planning time in blocked worlds of its size", " ms"}};
}

std::vector<Verdict> compare(const Selection& s, std::string_view other) {
  const auto micrometres = [](const Record& r) { return 1e6 * r.value(key::kLength); };
  const auto millimetres = [](const Record& r) { return 1e3 * r.value(key::kLength); };
  const auto failure = [](const Record& r) { return 100.0 * (1.0 - r.value(key::kReached)); };
  const auto time = [](const Record& r) { return 1000.0 * r.measured.at(key::kPlanning); };
  return {hv(s, other, false),
          hv(s, other, true),
          paths(s, other, {hardest_world(false)}, micrometres, has_reached, kResolvedUm),
          paths(s, other, numbered_worlds(true), failure, always),
          paths(s, other, numbered_worlds(true), millimetres, has_reached),
          paths(s, other, {hardest_world(false)}, time, always),
          paths(s, other, {hardest_world(true)}, time, always)};
}

presentation::Table verdict_table(const Selection& selection) {
  presentation::Table table;
  table.id = "verdicts";
  table.title = fmt::format(
      "{} minus each other algorithm: mean of paired differences with 95 % intervals; smaller is "
      "better for {}",
      label_of(kRetained), label_of(kRetained));
  table.columns = {"Against"};
  const std::vector<Metric> all = metrics();
  for (const Metric& respect : all) table.columns.push_back(respect.name);
  for (const algorithms::Algorithm& algorithm : algorithms::algorithms()) {
    if (algorithm.name == kRetained) continue;
    const std::vector<Verdict> verdicts = compare(selection, algorithm.name);
    std::vector<presentation::Cell> row{presentation::label(std::string(algorithm.label))};
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
      const Verdict& v = verdicts[i];
      if (v.pairs == 0) {
        row.push_back(presentation::nothing());
        continue;
      }
      presentation::Cell cell = presentation::number(v.mean, 4);
      cell.text = brief(v.mean, true);
      if (v.pairs > 1)
        cell.text = fmt::format("{} [{}, {}] {}", brief(v.mean, true), brief(v.low, true), brief(v.high, true),
                                to_string(v.outcome));
      cell.marked = v.outcome == Outcome::kWorse;
      row.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
  table.notes.push_back(
      "Bold: the other one is better. Intervals are each for itself, without a correction for their number. Path "
      "lengths in scenario 5 that differ by less than 1 µm on average count as equal.");
  table.notes.push_back(timing_note(selection));
  return table;
}

std::vector<std::string> verdict_sentences(const Selection& selection) {
  std::vector<std::string> names{"nsga2", "moead"};
  for (const algorithms::Algorithm& algorithm : algorithms::algorithms()) {
    const std::string name(algorithm.name);
    if (name != kRetained && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  std::vector<std::string> sentences;
  for (const std::string& name : names) {
    if (algorithms::find_algorithm(name) == nullptr) continue;
    const std::vector<Verdict> verdicts = compare(selection, name);
    const auto better = subjects(verdicts, Outcome::kBetter);
    const auto worse = subjects(verdicts, Outcome::kWorse);
    const auto same = subjects(verdicts, Outcome::kNoDifference);
    const auto unknown = subjects(verdicts, Outcome::kUnknown);
    std::string text = fmt::format("**{} against {}:** ", label_of(kRetained), label_of(name));
    if (unknown.size() == verdicts.size()) {
      sentences.push_back(text + "too few runs to tell.");
      continue;
    }
    text += worse.empty() ? "worse in nothing" : "worse in " + names_of(worse);
    text += better.empty() ? "; better in nothing" : "; better in " + names_of(better);
    if (!same.empty()) text += "; no difference shown in " + names_of(same);
    if (!unknown.empty()) text += "; not known in " + names_of(unknown);
    sentences.push_back(text + ".");
  }
  return sentences;
}

}  // namespace jink::tools::lab::study
