// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/tools/lab/arena/example_records.hpp"
#include "tools/lab/arena/figure.hpp"
#include "tools/lab/arena/html_page.hpp"
#include "tools/lab/arena/tables.hpp"

namespace jink::tools::lab::arena {
namespace {

/// crossing in the perfect tier: reached, collision, timeout in an impossible world, left world in one that the oracle
/// solves; reached in the realistic tier but for that impossible world. falling: all reached.
Results mixed() {
  Results results = all_reached(two_families(4));
  const auto at = [&](std::size_t run, std::size_t tier) -> FlightRecord& {
    return results.flights.at(4 * run + tier);
  };
  const auto set = [&](FlightRecord& record, const std::string& outcome, double clearance) {
    record.outcome = outcome;
    record.min_clearance = clearance;
    record.reason = "because";
  };
  set(at(1, 0), "collision", -0.1);
  set(at(2, 0), "timeout", 0.2);
  set(at(2, 1), "collision", -0.3);
  set(at(3, 0), "left_world", 0.9);
  set(at(3, 1), "aborted", 0.8);
  at(0, 0).flight_time = 8.0;
  results.add(WorldRecord{4, "crossing", at(2, 0).seed, Verdict::kImpossible});
  results.add(WorldRecord{6, "crossing", at(3, 0).seed, Verdict::kSolvable});
  return results;
}

const Row& row(const Summary& summary, const std::string& family, const std::string& tier) {
  for (const auto* rows : {&summary.rows, &summary.totals})
    for (const Row& one : *rows)
      if (one.family == family && one.tier == tier) return one;
  throw std::runtime_error("no such row");
}

TEST(Summary, CountsWhatIsPossible) {
  const Summary summary = summarise(mixed());
  ASSERT_EQ(summary.rows.size(), 4U);
  EXPECT_EQ(summary.rows[0].family + summary.rows[0].tier, "crossingperfect");
  EXPECT_EQ(summary.rows[3].family + summary.rows[3].tier, "fallingrealistic");
  const Row& crossing = row(summary, "crossing", "perfect");
  EXPECT_EQ(crossing.reached.count, 1);
  EXPECT_EQ(crossing.reached.of, 3);
  EXPECT_EQ(crossing.collisions.count, 1);
  EXPECT_EQ(crossing.left_world.count, 1);
  EXPECT_EQ(crossing.timeouts.count, 0) << "it was in an impossible world";
  EXPECT_EQ(crossing.others.count, 0);
  EXPECT_EQ(crossing.reached_solvable.count, 1);
  EXPECT_EQ(crossing.reached_solvable.of, 3) << "one is flown in this tier, one in the other, one solved by the oracle";
  EXPECT_EQ(crossing.impossible, 1);
  EXPECT_EQ(crossing.impossible_collisions, 0);
  EXPECT_EQ(crossing.impossible_clearance.min, 0.2);
  EXPECT_EQ(row(summary, "crossing", "realistic").impossible_collisions, 1);
  EXPECT_EQ(row(summary, "crossing", "realistic").others.count, 1);
  const Row& all = row(summary, "all", "perfect");
  EXPECT_EQ(all.reached.count, 5);
  EXPECT_EQ(all.reached.of, 7);
  EXPECT_EQ(summary.failures.size(), 5U);
  EXPECT_EQ(summary.failures.front().outcome, "collision");
  EXPECT_EQ(summary.impossible_worlds, 1U);
  EXPECT_EQ(summary.unknown_worlds, 0U);
  EXPECT_EQ(summary.flights, 16U);
  EXPECT_EQ(summary.expected, 16U);
}

TEST(Summary, SpreadsAreOfTheFlightsThatTheyAreAbout) {
  const Summary summary = summarise(mixed());
  const Row& crossing = row(summary, "crossing", "perfect");
  EXPECT_EQ(crossing.clearance.min, -0.1);
  EXPECT_EQ(crossing.clearance.median, 0.5);
  EXPECT_EQ(crossing.clearance.max, 0.9);
  // 8 s for 20 m: straight at cruise speed (3 m/s) 6.67 s, at the limit (5 m/s) 4 s.
  EXPECT_DOUBLE_EQ(crossing.time.median, 1.2);
  EXPECT_DOUBLE_EQ(crossing.time_at_limit.median, 2.0);
  EXPECT_DOUBLE_EQ(crossing.length.median, 1.1);
  EXPECT_EQ(crossing.plans, 300);
  EXPECT_EQ(crossing.deadline_misses, 3);
  EXPECT_EQ(crossing.late_plans.count, 3);
  EXPECT_EQ(crossing.late_plans.of, 9);
  EXPECT_EQ(crossing.plan_ms.max(), 30.0);
  EXPECT_NEAR(crossing.plan_ms.quantile(0.5), 2.0, 0.03);
}

TEST(Summary, AWorldThatNobodyJudgedIsNotKnownToBeSolvable) {
  Results results = all_reached(two_families(1));
  results.flights.at(0).outcome = results.flights.at(1).outcome = "collision";
  Summary summary = summarise(results);
  EXPECT_EQ(row(summary, "crossing", "perfect").reached_solvable.of, 0);
  EXPECT_EQ(row(summary, "crossing", "perfect").reached.of, 1);
  results.add(WorldRecord{0, "crossing", results.flights.at(0).seed, Verdict::kUnknown});
  summary = summarise(results);
  EXPECT_EQ(summary.unknown_worlds, 1U);
  EXPECT_EQ(row(summary, "crossing", "perfect").collisions.of, 1);
}

TEST(Tables, FlightsAreALineEachWithTheCommandThatShowsThem) {
  Results results = all_reached(two_families(1));
  FlightRecord& failed = results.flights.at(1);
  failed.outcome = "timeout";
  failed.reason = "said, \"so\"";
  failed.min_clearance = planner::base::kInfinity;
  const std::string csv = flights_csv(results, "out here");
  EXPECT_EQ(csv.rfind("job,family,seed,tier,pilot,verdict,outcome,reason,", 0), 0U);
  const std::string seed = std::to_string(failed.seed);
  const std::string expected =
      "\r\n1,crossing," + seed +
      ",realistic,jink,flown,timeout,\"said, \"\"so\"\"\",13.333333333333334,22,20,,3.25,3,5,0.1,"
      "100,2,1,jink replay 'out here/failed/crossing-" +
      seed + "-realistic-jink/scenario.yaml' --pilot jink --seed " + seed +
      " --config 'out here/planner.yaml' --log 'out here/failed/crossing-" + seed +
      "-realistic-jink/flight.jsonl' --report 'out here/failed/crossing-" + seed +
      "-realistic-jink/flight.html',0.5,1,";
  EXPECT_NE(csv.find(expected), std::string::npos) << csv;
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
}

TEST(Tables, RowsAsCsvHaveACellForEachColumn) {
  const std::string csv = table_csv(summarise(mixed()));
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < csv.size();) {
    const std::size_t end = csv.find("\r\n", at);
    lines.push_back(csv.substr(at, end - at));
    at = end + 2;
  }
  ASSERT_EQ(lines.size(), 7U);  // header, 4 rows, 2 totals
  for (const std::string& line : lines)
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(lines[0].begin(), lines[0].end(), ',')) << line;
  EXPECT_EQ(
      lines[0].rfind("family,tier,pilot,flights,reached,reached_of,reached_low,reached_high,reached_solvable,", 0), 0U);
  EXPECT_EQ(lines[1].rfind("crossing,perfect,jink,3,1,3,0.0614", 0), 0U) << lines[1];
  EXPECT_EQ(lines[5].rfind("all,perfect,jink,7,5,7,", 0), 0U) << lines[5];
}

TEST(Tables, JsonHasWhatTheWallClockSaysApart) {
  Results results = mixed();
  nlohmann::ordered_json a = summary_json(results, summarise(results), "out");
  EXPECT_EQ(a["format"], "jink-arena/1");
  EXPECT_EQ(a["complete"], true);
  EXPECT_EQ(a["table"][0]["reached"]["count"], 1);
  EXPECT_EQ(a["failures"].size(), 5U);
  for (auto& [job, record] : results.flights) {
    record.measured = {};
    record.measured.plan_ms.add(123.0);
  }
  nlohmann::ordered_json b = summary_json(results, summarise(results), "out");
  EXPECT_NE(a, b);
  for (auto* json : {&a, &b})
    for (const char* part : {"table", "totals"})
      for (auto& one : (*json)[part]) one.erase("measured");
  EXPECT_EQ(a, b);
  results.flights.erase(0);
  EXPECT_EQ(summary_json(results, summarise(results), "out")["complete"], false);
}

TEST(Tables, MarkdownHasATableForEachTierAndTheCommands) {
  const Results results = mixed();
  const std::string text = table_markdown(results, summarise(results), "out", 2);
  for (const char* part : {"## perfect tier", "## realistic tier", "33.3 (6.1 to 79.2)", "| all ", "-0.10 / ",
                           "The 5 flights that did not reach", "`jink replay out/failed/crossing-", "and 3 more"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(Figure, DrawsEachRowAndNoNumberThatIsNone) {
  Results results = mixed();
  for (auto& [job, record] : results.flights) {
    if (record.family == "falling") record.outcome = "collision";  // no times
    if (record.family == "falling") record.measured = {};          // no plans
  }
  const Summary summary = summarise(results);
  const jink::tools::figures::Figure drawing = figure(rows_of_tier(summary, "perfect"), results.settings.pilots);
  ASSERT_EQ(drawing.panels.size(), 5U);
  for (const jink::tools::figures::Panel& panel : drawing.panels) {
    EXPECT_EQ(panel.categories, (std::vector<std::string>{"crossing", "falling", "all"}));
    ASSERT_EQ(panel.series.size(), 1U);  // one pilot
  }
  EXPECT_NEAR(drawing.panels[0].series[0].y[0], 100.0 / 3.0, 1e-12);  // reached: 1 of 3
  EXPECT_TRUE(std::isnan(drawing.panels[3].series[0].y[1]));
  EXPECT_TRUE(std::isnan(drawing.panels[4].series[0].greatest[1]));
  const std::string svg = jink::tools::figures::svg_of(drawing);
  for (const char* part : {">crossing<", ">falling<", ">all<", ">jink<", "</svg>"})
    EXPECT_NE(svg.find(part), std::string::npos) << part;
  EXPECT_TRUE(figure({}, {"jink"}).panels.empty());
}

TEST(Page, NeedsNoNetworkAndEscapesWhatItShows) {
  Results results = mixed();
  results.flights.at(4).reason = "<script>&";
  const std::string html = page(results, summarise(results), "out");
  EXPECT_NE(html.find("&lt;script&gt;&amp;"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  for (std::size_t at = 0; (at = html.find("://", at + 1)) != std::string::npos;)
    EXPECT_EQ(html.substr(at - 4, 18), "http://www.w3.org/") << "but for the names of SVG's and XLink's namespaces";
}

}  // namespace
}  // namespace jink::tools::lab::arena
