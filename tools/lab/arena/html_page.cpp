// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/html_page.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "tools/lab/arena/figure.hpp"
#include "tools/lab/arena/flight_runner.hpp"
#include "tools/lab/presentation/report.hpp"

namespace jink::tools::lab::arena {
namespace {

constexpr const char* kDrawn =
    "bars with 95 % Wilson intervals; clearance as a box from p5 to p95 with a line at the median and the least below "
    "it; time of the straight line's likewise, without the least; plan time from p50 to p99, and up to the largest. A "
    "box or bar for each pilot.";

presentation::Table table_of(const std::string& id, const std::string& tier, const std::vector<const Row*>& rows) {
  std::vector<std::vector<std::string>> cells = reading_cells(rows, true);
  presentation::Table table;
  table.id = id;
  table.title = tier + " tier";
  table.columns = std::move(cells.front());
  table.label_columns = 2;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    table.rows.emplace_back();
    for (std::string& text : cells[i]) {
      table.rows.back().push_back(presentation::label(std::move(text)));
      table.rows.back().back().marked = rows[i - 1]->family == "all";
    }
  }
  return table;
}

presentation::Section tier_section(const Results& results, const Summary& summary, std::size_t number) {
  const std::string& tier = results.settings.tiers[number - 1];
  const std::vector<const Row*> rows = rows_of_tier(summary, tier);
  presentation::Section section{tier + " tier", {}};
  if (rows.empty()) return section;
  const std::string figure_id = fmt::format("figure{:02}", number), table_id = fmt::format("table{:02}", number);
  try {
    jink::tools::figures::Figure drawing = figure(rows, results.settings.pilots);
    drawing.id = figure_id;
    section.parts.emplace_back(presentation::FigureFile{figure_id, fmt::format("{} tier: {}", tier, kDrawn),
                                                        jink::tools::figures::svg_of(drawing)});
  } catch (const jink::tools::figures::FigureError& error) {  // a campaign of hours is worth its tables
    section.parts.emplace_back(fmt::format("There is no figure: {}.", error.what()));
  }
  section.parts.emplace_back(table_of(table_id, tier, rows));
  return section;
}

presentation::Section failures_section(const Summary& summary, const std::filesystem::path& out) {
  presentation::Section section{"Failed flights", {}};
  if (summary.failures.empty()) {
    section.parts.emplace_back("Every flight reached its target.");
    return section;
  }
  presentation::List list;
  list.folded =
      fmt::format("The {} flights that did not reach, with the command that shows each", summary.failures.size());
  for (const FlightRecord& r : summary.failures)
    list.points.push_back(fmt::format("{}:{}, {}, {}: **{}** ({}) `{}`", r.family, r.seed, r.tier, r.pilot, r.outcome,
                                      r.reason, replay_command(out, r)));
  section.parts.emplace_back(std::move(list));
  return section;
}

}  // namespace

std::string page(const Results& results, const Summary& summary, const std::filesystem::path& out) {
  presentation::Report report;
  report.title = "jink arena";
  report.abstract = {headline(results, summary) + ".", legend()};
  for (std::size_t number = 1; number <= results.settings.tiers.size(); ++number)
    report.sections.push_back(tier_section(results, summary, number));
  report.sections.push_back(failures_section(summary, out));
  return presentation::report_html(report);
}

void write_tables(const Results& results, const Summary& summary, const std::filesystem::path& out) {
  campaign::write_atomically(out / "flights.csv", flights_csv(results, out));
  campaign::write_atomically(out / "table.csv", table_csv(summary));
  campaign::write_atomically(out / "table.json", summary_json(results, summary, out).dump(2) + "\n");
  campaign::write_atomically(out / "table.md", table_markdown(results, summary, out));
  campaign::write_atomically(out / "arena.html", page(results, summary, out));
  // Last, so that a merge that was interrupted can be repeated.
  campaign::write_atomically(results_path(out), to_text(results));
}

}  // namespace jink::tools::lab::arena
