// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/presentation/paper_numbers.hpp"
#include "tools/lab/study/run.hpp"
#include "tools/lab/study/tables.hpp"

namespace jink::tools::lab::study {
namespace {

struct Measure {
  const char* number;  ///< of the table
  const char* key;
  const char* name;
  Direction direction;
  int decimals;
};

constexpr std::array<Measure, 3> kMeasures{
    {{"table03", key::kHv, "Hypervolume (HV)", Direction::kLargerIsBetter, 4},
     {"table04", key::kMs, "Maximum spread (MS)", Direction::kLargerIsBetter, 4},
     {"table05", key::kHrs, "Hole relative size (HRS)", Direction::kSmallerIsBetter, 4}}};

presentation::Table front_table(const Selection& selection, const Measure& m, bool blocked) {
  presentation::Table table;
  table.id = table_id(m.number, blocked);
  table.title = fmt::format("{} of problem (16) at {} steps of {} over slaves and sharing rates", m.name, kFrontSteps,
                            blocked ? "a blocked world" : "scenario 5");
  table.label_columns = 2;
  table.columns = {"Algorithm", "Statistic"};
  for (const int l : sharing_rates()) table.columns.push_back(fmt::format("l = {}", l));
  for (const std::string& algorithm : own_algorithms()) {
    const std::string name = label_of(algorithm);
    for (const std::string& which : statistics_of_rows()) {
      std::vector<presentation::Cell> row{presentation::label(name), presentation::label(which)};
      for (const int l : sharing_rates()) {
        const bool run_at = has_slaves(algorithm) || l == 0;
        const Records records = run_at ? selection.fronts(algorithm, hardest_world(blocked), l) : Records();
        const std::string printed = paper_text(blocked, m.number, name, std::to_string(l), which);
        row.push_back(records.empty() ? presentation::nothing(printed)
                                      : presentation::number(statistic(values(records, m.key), which, m.direction),
                                                             m.decimals, printed));
      }
      table.rows.push_back(std::move(row));
    }
  }
  table.notes.push_back(
      "Each run solves the same steps; a value is the mean over them. Objectives are in units of the front that a "
      "search of the whole box finds, HV to the point (1.1, 1.1).");
  if (!blocked) {
    table.notes.push_back(
        "The paper gives neither its reference point nor its normalisation, so its HV cannot be compared with ours in "
        "size, only in order.");
  }
  return table;
}

}  // namespace

std::string paper_text(bool blocked, const std::string& table, const std::string& row, const std::string& column,
                       const std::string& statistic) {
  if (blocked) return {};
  return std::string(presentation::paper_number(table, row, column, statistic).value_or(""));
}

std::string table_id(const char* number, bool blocked) {
  return blocked ? fmt::format("{}-blocked", number) : std::string(number);
}

std::vector<std::string> statistics_of_rows() {
  return {"Best", "Mean", "Worst", "STD"};
}

double statistic(const std::vector<double>& sample, std::string_view which, Direction direction) {
  if (sample.empty()) return std::numeric_limits<double>::quiet_NaN();
  const statistics::Summary s = statistics::summary(sample);
  const bool smaller = direction == Direction::kSmallerIsBetter;
  if (which == "Best") return smaller ? s.least : s.greatest;
  if (which == "Worst") return smaller ? s.greatest : s.least;
  return which == "Mean" ? s.mean : s.deviation;
}

std::vector<presentation::Table> front_tables(const Selection& selection, bool blocked) {
  std::vector<presentation::Table> tables;
  tables.reserve(kMeasures.size());
  for (const Measure& m : kMeasures) tables.push_back(front_table(selection, m, blocked));
  return tables;
}

std::string timing_note(const Selection& selection) {
  std::set<int> threads;
  for (const auto& [number, record] : selection.results().runs)
    if (record.job.variant.timed()) threads.insert(static_cast<int>(record.measured.at(key::kThreads)));
  if (threads.empty()) return "No run whose time is reported has been made yet.";
  std::string counts;
  for (const int count : threads) counts += fmt::format("{}{}", counts.empty() ? "" : " and ", count);
  const std::size_t machines = selection.results().machines.size();
  return fmt::format(
      "Wall time with {} thread{} of the planner, nothing else of the study beside it{}.", counts,
      threads.size() == 1 && *threads.begin() == 1 ? "" : "s",
      machines > 1 || threads.size() > 1 ? "; times of several machines or thread counts are mixed" : "");
}

namespace {

std::vector<double> hv_at(const Records& records, std::size_t checkpoint) {
  std::vector<double> at;
  for (const Record* r : records) at.push_back(r->series.at(key::kHvAt).at(checkpoint));
  return at;
}

/// "MOMVO (0.9783 at 50 %)" where the search had more then than at its end; empty where it is not shown to.
std::string late_loss(const Records& records, const std::vector<double>& shares, const std::string& name) {
  if (records.size() < 2) return {};
  std::size_t best = 0;
  for (std::size_t i = 1; i < shares.size(); ++i)
    if (statistics::mean(hv_at(records, i)) > statistics::mean(hv_at(records, best))) best = i;
  std::vector<double> lost = hv_at(records, best);
  const std::vector<double> end = hv_at(records, shares.size() - 1);
  std::transform(lost.begin(), lost.end(), end.begin(), lost.begin(), std::minus<>());
  if (statistics::summary(lost).low <= 0.0) return {};
  return fmt::format("{} ({:.4f} at {:g} %)", name, statistics::mean(hv_at(records, best)), 100.0 * shares[best]);
}

}  // namespace

presentation::Table anytime_table(const Selection& selection, bool blocked) {
  presentation::Table table;
  table.id = table_id("anytime", blocked);
  table.title = fmt::format(
      "Mean hypervolume after a share of the {} evaluations, with half the width of its 95 % "
      "interval, at {} steps of {}",
      selection.sizes().population * selection.sizes().iterations, kFrontSteps,
      blocked ? "a blocked world" : "scenario 5");
  table.columns = {"Algorithm"};
  const std::vector<double> shares = checkpoints();
  std::vector<std::size_t> shown;  // what a page holds; the figure has all
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (i % 2 == 0) shown.push_back(i);
  for (const std::size_t i : shown) table.columns.push_back(fmt::format("{:g} %", 100.0 * shares[i]));
  table.columns.emplace_back("Time of all (ms)");
  std::vector<std::string> losing;
  bool momvo_loses = false;
  for (const algorithms::Algorithm& algorithm : algorithms::algorithms()) {
    const Records records = selection.anytime(algorithm.name, hardest_world(blocked));
    std::vector<presentation::Cell> row{presentation::label(std::string(algorithm.label))};
    for (const std::size_t i : shown) {
      const std::vector<double> at = hv_at(records, i);
      if (at.empty()) {
        row.push_back(presentation::nothing());
        continue;
      }
      const statistics::Summary s = statistics::summary(at);
      presentation::Cell cell = presentation::number(s.mean, 4);
      if (at.size() > 1) cell.text += fmt::format(" ± {:.4f}", s.high - s.mean);
      row.push_back(std::move(cell));
    }
    const auto all = scaled(measured(records, key::seconds_at(shares.size() - 1)), 1000.0);
    row.push_back(all.empty() ? presentation::nothing() : presentation::number(statistics::mean(all), 3));
    table.rows.push_back(std::move(row));
    const std::string loss = late_loss(records, shares, std::string(algorithm.label));
    if (loss.empty()) continue;
    losing.push_back(loss);
    momvo_loses = momvo_loses || algorithm.name == "momvo";
  }
  table.notes.push_back("Each number is from searches that were stopped there, on the schedule of the whole search.");
  if (!losing.empty())
    table.notes.push_back(fmt::format(
        "Had more before the end: {}. A full archive gives members up by lot, and when the steps get small, newcomers "
        "are found only beside others.{}",
        fmt::join(losing, ", "),
        momvo_loses ? fmt::format(" Part of PMOMVO's lead over MOMVO in {} is this loss.",
                                  presentation::table_name(table_id("table03", blocked)))
                    : ""));
  table.notes.push_back(timing_note(selection));
  return table;
}

}  // namespace jink::tools::lab::study
