// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/html_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/lab/arena/figure.hpp"
#include "tools/lab/arena/flight_runner.hpp"

namespace jink::tools::lab::arena {
namespace {

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>jink arena</title>
<style>
body { margin: 0 auto; padding: 14px 22px 30px; max-width: 1520px; background: #f4f6f8; color: #1c2530;
  font: 14px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif; }
h1 { font-size: 20px; margin: 0 0 4px; }
h2 { font-size: 15px; margin: 22px 0 6px; }
p { margin: 4px 0; color: #45525f; max-width: 1100px; }
section { background: #fff; border: 1px solid #dfe4ea; border-radius: 6px; padding: 10px 12px; overflow-x: auto; }
table { border-collapse: collapse; font-size: 12.5px; font-variant-numeric: tabular-nums; margin-top: 8px; }
th { text-align: left; font-weight: 600; color: #45525f; vertical-align: bottom; }
th, td { padding: 2px 14px 2px 0; border-bottom: 1px solid #eef1f4; white-space: nowrap; }
th { white-space: normal; }
tr.total td { font-weight: 600; }
svg text { font: 12px system-ui, "Liberation Sans", Arial, sans-serif; fill: #1c2530; }
svg text.tick { font-size: 10.5px; fill: #5d6b7a; }
svg text.title { font-weight: 600; }
svg text.family { font-weight: 600; }
svg text.pilot { fill: #45525f; }
code { font: 12px ui-monospace, "DejaVu Sans Mono", monospace; overflow-wrap: anywhere; }
li { margin: 5px 0; }
summary { cursor: pointer; }
</style>
</head>
<body>
)";

std::string table_html(const std::vector<std::vector<std::string>>& cells) {
  std::string html = "<table>\n";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    html += cells[i].front() == "all" ? "<tr class=\"total\">" : "<tr>";
    for (const std::string& cell : cells[i])
      html += i == 0 ? "<th>" + escaped(cell) + "</th>" : "<td>" + escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string failures_html(const Summary& summary, const std::filesystem::path& out) {
  if (summary.failures.empty()) return "<p>Every flight reached its target.</p>\n";
  std::string html = fmt::format(
      "<details><summary>The {} flights that did not reach, with the command that shows each</summary>\n<ol>\n",
      summary.failures.size());
  for (const FlightRecord& r : summary.failures) {
    html += fmt::format("<li>{}:{}, {}, {}: <b>{}</b> ({})<br><code>{}</code></li>\n", escaped(r.family), r.seed,
                        escaped(r.tier), escaped(r.pilot), escaped(r.outcome), escaped(r.reason),
                        escaped(replay_command(out, r)));
  }
  return html + "</ol></details>\n";
}

}  // namespace

std::string page(const Results& results, const Summary& summary, const std::filesystem::path& out) {
  std::string html = kHead;
  std::string meaning = legend();
  std::replace(meaning.begin(), meaning.end(), '`', '"');
  html += fmt::format("<h1>jink arena</h1>\n<p>{}.</p>\n<p>{}</p>\n", escaped(headline(results, summary)),
                      escaped(meaning));
  html +=
      "<p>Drawn: bars with 95 % Wilson intervals; clearance and time from least (time: p5) through p5 and the median "
      "(dot) to p95; plan time from p50 (dot) through p99 to the largest. Point at a mark for its numbers.</p>\n";
  for (const std::string& tier : results.settings.tiers) {
    const std::vector<const Row*> rows = rows_of_tier(summary, tier);
    html += fmt::format("<h2>{} tracks</h2>\n<section>\n{}{}</section>\n", escaped(tier),
                        figure(rows, results.settings.pilots), table_html(reading_cells(rows, true)));
  }
  html += "<h2>Failed flights</h2>\n<section>\n" + failures_html(summary, out) + "</section>\n";
  return html + "</body>\n</html>\n";
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
