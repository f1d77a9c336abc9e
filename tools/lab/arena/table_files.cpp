// SPDX-License-Identifier: BSD-3-Clause
// The tables as CSV, JSON, Markdown and text.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tools/lab/arena/flight_runner.hpp"
#include "tools/lab/arena/tables.hpp"
#include "tools/lab/presentation/table.hpp"

namespace jink::tools::lab::arena {
namespace {

using Json = nlohmann::ordered_json;

/// One cell of a CSV line; what needs quotes has them.
std::string cell(const std::string& text) {
  return presentation::csv_field(text);
}
std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : std::string();
}
std::string line(const std::vector<std::string>& cells) {
  return fmt::format("{}\r\n", fmt::join(cells, ","));
}

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json json(const Proportion& p) {
  return {{"count", p.count},
          {"of", p.of},
          {"share", p.of == 0 ? Json(nullptr) : Json(p.value())},
          {"low", p.low},
          {"high", p.high}};
}
Json json(const Spread& s) {
  return {{"min", number(s.min)},
          {"p5", number(s.p5)},
          {"median", number(s.median)},
          {"p95", number(s.p95)},
          {"max", number(s.max)}};
}

Json json(const Row& row) {
  return {{"family", row.family},
          {"tier", row.tier},
          {"pilot", row.pilot},
          {"flights", row.reached.of},
          {"reached", json(row.reached)},
          {"reached_solvable", json(row.reached_solvable)},
          {"collisions", json(row.collisions)},
          {"left_world", json(row.left_world)},
          {"timeouts", json(row.timeouts)},
          {"others", json(row.others)},
          {"min_clearance", json(row.clearance)},
          {"time_ratio", json(row.time)},
          {"time_ratio_at_limit", json(row.time_at_limit)},
          {"length_ratio", json(row.length)},
          {"plans", row.plans},
          {"deadline_misses", row.deadline_misses},
          {"impossible",
           {{"flights", row.impossible},
            {"collisions", row.impossible_collisions},
            {"min_clearance", json(row.impossible_clearance)}}},
          {"measured",
           {{"plan_ms",
             {{"p50", number(row.plan_ms.quantile(0.5))},
              {"p99", number(row.plan_ms.quantile(0.99))},
              {"max", row.plan_ms.max()}}},
            {"late_plans", json(row.late_plans)}}}};
}

Json rows_json(const std::vector<Row>& rows) {
  Json result = Json::array();
  for (const Row& row : rows) result.push_back(json(row));
  return result;
}

std::string percent(double share) {
  return fmt::format("{:.1f}", 100.0 * share);
}
/// "99.5 (98.2 to 99.9)".
std::string percent(const Proportion& p) {
  return p.of == 0 ? "-" : fmt::format("{} ({} to {})", percent(p.value()), percent(p.low), percent(p.high));
}
std::string fixed(double value, int digits = 2) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

/// Of a plan's time: some pilots take microseconds.
std::string milliseconds(double value) {
  return fixed(value, value < 1.0 ? 3 : 1);
}

/// A column for people.
struct Column {
  const char* name;
  std::function<std::string(const Row&)> text;
  bool on_terminal = true;  // where there is less room
};

std::vector<Column> reading_columns() {
  return {{"family", [](const Row& r) { return r.family; }},
          {"pilot", [](const Row& r) { return r.pilot; }},
          {"flights", [](const Row& r) { return fmt::format("{}", r.reached.of); }},
          {"reached %", [](const Row& r) { return percent(r.reached); }},
          {"of solvable %",
           [](const Row& r) { return r.reached_solvable.of == 0 ? "-" : percent(r.reached_solvable.value()); }, false},
          {"collisions %", [](const Row& r) { return percent(r.collisions); }},
          {"left world", [](const Row& r) { return fmt::format("{}", r.left_world.count); }, false},
          {"time-outs", [](const Row& r) { return fmt::format("{}", r.timeouts.count); }, false},
          {"others", [](const Row& r) { return fmt::format("{}", r.others.count); }, false},
          {"impossible (hit)",
           [](const Row& r) {
             return r.impossible == 0 ? "-" : fmt::format("{} ({})", r.impossible, r.impossible_collisions);
           }},
          {"clearance min / p5 / median m",
           [](const Row& r) {
             return fmt::format("{} / {} / {}", fixed(r.clearance.min), fixed(r.clearance.p5),
                                fixed(r.clearance.median));
           }},
          {"time median / p95",
           [](const Row& r) { return fmt::format("{} / {}", fixed(r.time.median), fixed(r.time.p95)); }},
          {"at limit", [](const Row& r) { return fixed(r.time_at_limit.median); }, false},
          {"length", [](const Row& r) { return fixed(r.length.median, 3); }, false},
          {"plan p50 / p99 / max ms",
           [](const Row& r) {
             return fmt::format("{} / {} / {}", milliseconds(r.plan_ms.quantile(0.5)),
                                milliseconds(r.plan_ms.quantile(0.99)), milliseconds(r.plan_ms.max()));
           }},
          {"late %", [](const Row& r) { return r.late_plans.of == 0 ? "-" : percent(r.late_plans.value()); }, false},
          {"missed", [](const Row& r) { return fmt::format("{}", r.deadline_misses); }, false}};
}

/// Lines of equal width, with bars and a rule under the header if it is Markdown.
std::string aligned(const std::vector<std::vector<std::string>>& cells, bool markdown) {
  std::vector<std::size_t> widths(cells.front().size(), 0);
  for (const auto& one : cells)
    for (std::size_t i = 0; i < one.size(); ++i) widths[i] = std::max(widths[i], one[i].size());
  std::string text;
  for (std::size_t n = 0; n < cells.size(); ++n) {
    for (std::size_t i = 0; i < widths.size(); ++i)
      text += fmt::format("{}{:<{}}{}", markdown ? "| " : "", cells[n][i], widths[i], markdown ? " " : "  ");
    if (!markdown) text.erase(text.find_last_not_of(' ') + 1);
    text += markdown ? "|\n" : "\n";
    if (n > 0 || !markdown) continue;
    for (const std::size_t width : widths) text += "|" + std::string(width + 2, '-');
    text += "|\n";
  }
  return text;
}

std::string shard_text(const CampaignSettings& s) {
  return s.shard.of == 1 ? "" : fmt::format(", shard {}/{}", s.shard.number, s.shard.of);
}

constexpr const char* kLegend =
    "Shares are in per cent of the flights in worlds that are not shown to be impossible, with 95 % Wilson intervals. "
    "`of solvable`: reached, of the worlds that are known to have a flight. `impossible (hit)`: flights in worlds "
    "without a way through, which count nowhere else, and how many of them collided. Clearance: the smallest of each "
    "flight, by the true motion. Time and length: of the straight line, of the flights that reached; `time` at cruise "
    "speed, `at limit` at the vehicle's speed limit. Plan time: wall time, measured; `late`: the share of plans "
    "that took longer than `horizon.deadline_ms`. `missed`: plans that came after their own start in virtual time.";

}  // namespace

std::vector<const Row*> rows_of_tier(const Summary& summary, const std::string& tier) {
  std::vector<const Row*> rows;
  for (const Row& row : summary.rows)
    if (row.tier == tier) rows.push_back(&row);
  for (const Row& row : summary.totals)
    if (row.tier == tier) rows.push_back(&row);
  return rows;
}

std::vector<std::vector<std::string>> reading_cells(const std::vector<const Row*>& rows, bool all) {
  std::vector<Column> columns = reading_columns();
  if (!all)
    columns.erase(std::remove_if(columns.begin(), columns.end(), [](const Column& c) { return !c.on_terminal; }),
                  columns.end());
  std::vector<std::vector<std::string>> cells(1);
  for (const Column& column : columns) cells.front().emplace_back(column.name);
  for (const Row* row : rows) {
    cells.emplace_back();
    for (const Column& column : columns) cells.back().push_back(column.text(*row));
  }
  return cells;
}

std::string headline(const Results& results, const Summary& summary) {
  const CampaignSettings& s = results.settings;
  std::string text = fmt::format("jink {}, seed {}, {} worlds of each family{}: {} of {} flights", s.version, s.seed,
                                 s.runs, shard_text(s), summary.flights, summary.expected);
  if (!s.oracle) return text + "; the oracle was not asked";
  return text +
         fmt::format("; {} worlds shown to be impossible, {} in which nobody arrived and the oracle has no answer",
                     summary.impossible_worlds, summary.unknown_worlds);
}

std::string legend() {
  return kLegend;
}

std::string flights_csv(const Results& results, const std::filesystem::path& out) {
  std::map<std::pair<std::string, std::uint64_t>, std::string> verdicts;
  for (const auto& [number, world] : results.worlds) verdicts[{world.family, world.seed}] = to_string(world.verdict);
  for (const auto& [job, flight] : results.flights)
    if (flight.reached()) verdicts[{flight.family, flight.seed}] = to_string(Verdict::kFlown);
  std::string text = line({"job",
                           "family",
                           "seed",
                           "tier",
                           "pilot",
                           "verdict",
                           "outcome",
                           "reason",
                           "flight_time_s",
                           "path_length",
                           "straight_length",
                           "min_clearance",
                           "max_speed",
                           "cruise_speed",
                           "speed_limit",
                           "max_tracking_error",
                           "plans",
                           "blocked_plans",
                           "deadline_misses",
                           "replay",
                           "wall_s",
                           "late_plans",
                           "plan_ms_p50",
                           "plan_ms_p99",
                           "plan_ms_max"});
  for (const auto& [job, r] : results.flights) {
    const auto verdict = verdicts.find({r.family, r.seed});
    text += line({std::to_string(r.job),
                  cell(r.family),
                  std::to_string(r.seed),
                  cell(r.tier),
                  cell(r.pilot),
                  verdict == verdicts.end() ? "" : verdict->second,
                  cell(r.outcome),
                  cell(r.reason),
                  cell(r.flight_time),
                  cell(r.path_length),
                  cell(r.straight_length),
                  cell(r.min_clearance),
                  cell(r.max_speed),
                  cell(r.cruise_speed),
                  cell(r.speed_limit),
                  cell(r.tracking_error),
                  std::to_string(r.plans),
                  std::to_string(r.blocked_plans),
                  std::to_string(r.deadline_misses),
                  r.reached() ? "" : cell(replay_command(out, r)),
                  cell(r.measured.wall_s),
                  std::to_string(r.measured.late_plans),
                  cell(r.measured.plan_ms.quantile(0.5)),
                  cell(r.measured.plan_ms.quantile(0.99)),
                  cell(r.measured.plan_ms.max())});
  }
  return text;
}

std::string table_csv(const Summary& summary) {
  std::vector<std::string> head{"family", "tier", "pilot", "flights"};
  for (const char* name : {"reached", "reached_solvable", "collisions", "left_world", "timeouts", "others"})
    for (const char* part : {"", "_of", "_low", "_high"}) head.push_back(std::string(name) + part);
  for (const char* name : {"min_clearance", "time_ratio", "time_ratio_at_limit", "length_ratio"})
    for (const char* part : {"_min", "_p5", "_median", "_p95", "_max"}) head.push_back(std::string(name) + part);
  for (const char* name : {"plans", "deadline_misses", "impossible", "impossible_collisions",
                           "impossible_clearance_min", "late_plans", "plan_ms_p50", "plan_ms_p99", "plan_ms_max"})
    head.emplace_back(name);
  std::string text = line(head);
  for (const auto* rows : {&summary.rows, &summary.totals}) {
    for (const Row& row : *rows) {
      std::vector<std::string> cells{cell(row.family), cell(row.tier), cell(row.pilot), std::to_string(row.reached.of)};
      for (const Proportion* p :
           {&row.reached, &row.reached_solvable, &row.collisions, &row.left_world, &row.timeouts, &row.others})
        for (std::string& part :
             std::array{std::to_string(p->count), std::to_string(p->of), cell(p->low), cell(p->high)})
          cells.push_back(std::move(part));
      for (const Spread* s : {&row.clearance, &row.time, &row.time_at_limit, &row.length})
        for (const double value : {s->min, s->p5, s->median, s->p95, s->max}) cells.push_back(cell(value));
      for (const std::int64_t count : {row.plans, row.deadline_misses, row.impossible, row.impossible_collisions})
        cells.push_back(std::to_string(count));
      cells.push_back(cell(row.impossible_clearance.min));
      cells.push_back(std::to_string(row.late_plans.count));
      for (const double value : {row.plan_ms.quantile(0.5), row.plan_ms.quantile(0.99), row.plan_ms.max()})
        cells.push_back(cell(value));
      text += line(cells);
    }
  }
  return text;
}

Json summary_json(const Results& results, const Summary& summary, const std::filesystem::path& out) {
  const CampaignSettings& s = results.settings;
  Json failures = Json::array();
  for (const FlightRecord& r : summary.failures) {
    failures.push_back({{"job", r.job},
                        {"family", r.family},
                        {"seed", r.seed},
                        {"tier", r.tier},
                        {"pilot", r.pilot},
                        {"outcome", r.outcome},
                        {"reason", r.reason},
                        {"replay", replay_command(out, r)}});
  }
  return {{"format", "jink-arena/1"},
          {"version", s.version},
          {"seed", s.seed},
          {"runs", s.runs},
          {"families", s.families},
          {"pilots", s.pilots},
          {"tiers", s.tiers},
          {"oracle", s.oracle},
          {"recorded", s.recorded},
          {"shard", fmt::format("{}/{}", s.shard.number, s.shard.of)},
          {"out", out.string()},
          {"flights", summary.flights},
          {"expected", summary.expected},
          {"complete", summary.flights == summary.expected},
          {"impossible_worlds", summary.impossible_worlds},
          {"unknown_worlds", summary.unknown_worlds},
          {"table", rows_json(summary.rows)},
          {"totals", rows_json(summary.totals)},
          {"failures", std::move(failures)}};
}

std::string table_markdown(const Results& results, const Summary& summary, const std::filesystem::path& out,
                           std::size_t most_failures) {
  std::string text = fmt::format("# jink arena\n\n{}.\n\n{}\n", headline(results, summary), kLegend);
  for (const std::string& tier : results.settings.tiers)
    text += fmt::format("\n## {} tier\n\n{}", tier, aligned(reading_cells(rows_of_tier(summary, tier), true), true));
  if (summary.failures.empty()) return text;
  text += fmt::format("\n## The {} flights that did not reach\n\n", summary.failures.size());
  for (std::size_t i = 0; i < std::min(most_failures, summary.failures.size()); ++i) {
    const FlightRecord& r = summary.failures[i];
    text += fmt::format("- {}:{}, {}, {}: {} ({})\n  `{}`\n", r.family, r.seed, r.tier, r.pilot, r.outcome, r.reason,
                        replay_command(out, r));
  }
  if (summary.failures.size() > most_failures)
    text += fmt::format("- and {} more, in flights.csv\n", summary.failures.size() - most_failures);
  return text;
}

std::string table_text(const Results& results, const Summary& summary) {
  std::string text = headline(results, summary) + "\n";
  for (const std::string& tier : results.settings.tiers)
    text += fmt::format("\n{} tier\n{}", tier, aligned(reading_cells(rows_of_tier(summary, tier), false), false));
  text.pop_back();
  return text;
}

}  // namespace jink::tools::lab::arena
