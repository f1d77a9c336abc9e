// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/study/tables.hpp"

namespace jink::tools::lab::study {
namespace {

std::string world_text(bool blocked) {
  return blocked ? "blocked worlds of scenario 5's size" : "scenario 5";
}

std::string vectors(const config::Scenario& scenario, const std::function<Vec3(const config::LinearMotion&)>& of) {
  std::vector<std::string> texts;
  for (const config::Obstacle& obstacle : scenario.obstacles) {
    const auto* const motion = std::get_if<config::LinearMotion>(&obstacle.motion);
    if (motion == nullptr) continue;
    const Vec3 v = of(*motion);
    texts.push_back(fmt::format("[{:.3g} {:.3g} {:.3g}]", v.x(), v.y(), v.z()));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string point(const Vec3& p) {
  return fmt::format("[{:g}, {:g}, {:g}]", p.x(), p.y(), p.z());
}

/// Lengths or times over iterations, population and algorithm.
presentation::Table sensitivity_table(const Selection& selection, const char* id, std::string title, int decimals,
                                      bool blocked, const char* statistic_of_paper,
                                      const std::function<double(const Records&)>& of) {
  presentation::Table table;
  table.id = table_id(id, blocked);
  table.title = std::move(title);
  table.label_columns = 2;
  table.columns = {"Iterations", "Population"};
  for (const std::string& algorithm : own_algorithms()) table.columns.push_back(label_of(algorithm));
  for (const int i : {1, 2, 3}) {
    for (const int p : {1, 2, 4}) {
      const int iterations = i * selection.sizes().iterations;
      const int population = p * selection.sizes().population;
      std::vector<presentation::Cell> row{presentation::label(std::to_string(iterations)),
                                          presentation::label(std::to_string(population))};
      for (const std::string& algorithm : own_algorithms()) {
        const std::string printed = paper_text(blocked, id, fmt::format("{}/{}", iterations, population),
                                               label_of(algorithm), statistic_of_paper);
        const Records records = selection.paths(algorithm, hardest_world(blocked), population, iterations);
        row.push_back(records.empty() ? presentation::nothing(printed)
                                      : presentation::number(of(records), decimals, printed));
      }
      table.rows.push_back(std::move(row));
    }
  }
  if (selection.settings().quick) table.notes.emplace_back("--quick leaves the largest cells out.");
  return table;
}

presentation::Table reached_table(const Selection& selection) {
  presentation::Table table = sensitivity_table(
      selection, "table13-reached", "Share of paths that reach in " + world_text(true), 2, true, "",
      [](const Records& all) { return static_cast<double>(reached(all).size()) / static_cast<double>(all.size()); });
  return table;
}

struct Criterion15 {
  const char* column;
  const char* paper_column;  ///< "": the paper has none
  int decimals;
  std::function<std::vector<double>(const Records&)> sample;
};

std::vector<Criterion15> criteria_of_comparison() {
  return {
      {"Path length (m)", "SLR", 4, [](const Records& all) { return values(reached(all), key::kLength); }},
      {"Planning time (ms)", "FT", 3, [](const Records& all) { return scaled(measured(all, key::kPlanning), 1000.0); }},
      {"Flight time (s)", "", 4, [](const Records& all) { return values(reached(all), key::kFlight); }}};
}

}  // namespace

presentation::Table picture_table(const Selection& selection, const StudyWorlds& scenes, bool blocked) {
  presentation::Table table;
  table.id = table_id("table12", blocked);
  table.title = fmt::format("{} for the illustration of obstacle avoidance, and paths of {} in them",
                            blocked ? "Blocked worlds" : "Scenarios", label_of(kRetained));
  table.label_columns = 5;
  table.columns = {"Instance", "Start",     "Target",     "Obstacles' positions (m)", "Obstacles' velocities (m/s)",
                   "Reached",  "SLR, mean", "SLR, worst", "Smallest clearance (m)"};
  for (const std::string& world : pictured_worlds(blocked)) {
    const config::Scenario scenario = scenes.scenario(world, 0);
    const Records all = selection.paths(kRetained, world);
    const Records free = reached(all);
    const std::vector<double> slr = values(free, key::kSlr);
    const std::vector<double> clearance = values(free, key::kClearance);
    table.rows.push_back(
        {presentation::label(world_number(world)), presentation::label(point(scenario.start)),
         presentation::label(point(scenario.target)),
         presentation::label(vectors(scenario, [](const config::LinearMotion& m) { return m.position; })),
         presentation::label(vectors(scenario, [](const config::LinearMotion& m) { return m.velocity; })),
         presentation::label(fmt::format("{}/{}", free.size(), all.size())),
         free.empty() ? presentation::nothing() : presentation::number(statistics::mean(slr), 6),
         free.empty() ? presentation::nothing() : presentation::number(*std::max_element(slr.begin(), slr.end()), 6),
         free.empty() ? presentation::nothing()
                      : presentation::number(*std::min_element(clearance.begin(), clearance.end()), 3)});
  }
  table.notes.push_back("All obstacles are spheres of 0.5 m radius; the paper does not say how large they are.");
  if (blocked) table.notes.push_back("Unlike the other blocked worlds these three are the same in every run.");
  return table;
}

std::vector<presentation::Table> sensitivity_tables(const Selection& selection, bool blocked) {
  presentation::Table length = sensitivity_table(
      selection, "table13", "Mean path length (m) over iterations and population in " + world_text(blocked), 6, blocked,
      "length", [](const Records& all) { return statistics::mean(values(reached(all), key::kLength)); });
  length.notes.push_back("Of the paths that reach.");
  presentation::Table time = sensitivity_table(
      selection, "table14", "Mean planning time (ms) over iterations and population in " + world_text(blocked), 3,
      blocked, "time", [](const Records& all) { return 1000.0 * statistics::mean(measured(all, key::kPlanning)); });
  time.notes.push_back(timing_note(selection));
  std::vector<presentation::Table> tables{std::move(length)};
  if (blocked) tables.push_back(reached_table(selection));
  tables.push_back(std::move(time));
  return tables;
}

presentation::Table comparison_table(const Selection& selection, bool blocked) {
  presentation::Table table;
  table.id = table_id("table15", blocked);
  table.title = fmt::format("{} and other algorithms in {}", label_of(kRetained), world_text(blocked));
  table.label_columns = 2;
  table.columns = {"Algorithm", "Statistic"};
  const std::vector<Criterion15> criteria = criteria_of_comparison();
  for (const Criterion15& c : criteria) table.columns.emplace_back(c.column);
  table.columns.emplace_back("Reached");
  std::vector<std::string> rows = other_algorithms();
  rows.emplace_back("momvo");
  rows.emplace_back(kRetained);
  for (const std::string& algorithm : rows) {
    const Records all = selection.paths(algorithm, hardest_world(blocked));
    for (const std::string& which : statistics_of_rows()) {
      std::vector<presentation::Cell> row{presentation::label(label_of(algorithm)), presentation::label(which)};
      for (const Criterion15& c : criteria) {
        const std::string printed =
            *c.paper_column == '\0' ? "" : paper_text(blocked, "table15", label_of(algorithm), c.paper_column, which);
        const std::vector<double> sample = c.sample(all);
        row.push_back(sample.empty() ? presentation::nothing(printed)
                                     : presentation::number(statistic(sample, which, Direction::kSmallerIsBetter),
                                                            c.decimals, printed));
      }
      row.push_back(presentation::label(which == "Mean" ? fmt::format("{}/{}", reached(all).size(), all.size()) : ""));
      table.rows.push_back(std::move(row));
    }
  }
  table.notes.push_back(timing_note(selection));
  table.notes.push_back("Length and flight time are of the paths that reach. The paper's FT is in s; see Table 7.");
  return table;
}

presentation::Table success_table(const Selection& selection) {
  presentation::Table table;
  table.id = "success";
  table.title = "Paths that reach in blocked worlds of the five sizes, with the 95 % interval of all";
  table.columns = {"Algorithm"};
  for (const std::string& world : numbered_worlds(true)) table.columns.push_back("Blocked " + world_number(world));
  table.columns.insert(table.columns.end(), {"All (%)", "Interval (%)", "Mean SLR where it reaches"});
  for (const algorithms::Algorithm& algorithm : algorithms::algorithms()) {
    std::vector<presentation::Cell> row{presentation::label(std::string(algorithm.label))};
    std::int64_t count = 0, of = 0;
    std::vector<double> slr;
    for (const std::string& world : numbered_worlds(true)) {
      const Records all = selection.paths(algorithm.name, world);
      const Records free = reached(all);
      row.push_back(presentation::label(fmt::format("{}/{}", free.size(), all.size())));
      count += static_cast<std::int64_t>(free.size());
      of += static_cast<std::int64_t>(all.size());
      for (const double value : values(free, key::kSlr)) slr.push_back(value);
    }
    const statistics::Proportion share = statistics::wilson(count, of);
    row.push_back(of == 0 ? presentation::nothing() : presentation::number(100.0 * share.value(), 1));
    row.push_back(of == 0
                      ? presentation::nothing()
                      : presentation::label(fmt::format("{:.1f} to {:.1f}", 100.0 * share.low, 100.0 * share.high)));
    row.push_back(slr.empty() ? presentation::nothing() : presentation::number(statistics::mean(slr), 4));
    table.rows.push_back(std::move(row));
  }
  table.notes.push_back(
      "The intervals (Wilson) take runs for independent; all algorithms have the same worlds, so compare them in "
      "pairs: "
      "the table of verdicts does. Who reaches more often reaches also in harder worlds, where paths are longer.");
  return table;
}

}  // namespace jink::tools::lab::study
