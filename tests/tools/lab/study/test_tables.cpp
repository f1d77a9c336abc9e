// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tools/lab/study/small_study.hpp"
#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/study/figures.hpp"
#include "tools/lab/study/report_text.hpp"
#include "tools/lab/study/tables.hpp"
#include "tools/lab/study/verdicts.hpp"

namespace jink::tools::lab::study {
namespace {

/// With the paper's sizes, so that its numbers stand beside ours.
StudySettings papers_sizes(int runs) {
  StudySettings settings = small_study(runs);
  settings.parameters = config::list_settings(config::load_settings(config::config_folder() / "planner.yaml"));
  return settings;
}

using Change = std::function<void(Record&)>;

Results changed(int runs, const Change& change) {
  Results results = empty_results(papers_sizes(runs));
  for (auto& [number, record] : results.runs) change(record);
  return results;
}

const presentation::Table& find(const std::vector<presentation::Table>& tables, const std::string& id) {
  for (const presentation::Table& table : tables)
    if (table.id == id) return table;
  throw std::out_of_range(id);
}

/// The row whose labels are these.
const std::vector<presentation::Cell>& row(const presentation::Table& table, const std::vector<std::string>& labels) {
  for (const std::vector<presentation::Cell>& r : table.rows) {
    bool same = true;
    for (std::size_t i = 0; i < labels.size(); ++i) same = same && r[i].text == labels[i];
    if (same) return r;
  }
  throw std::out_of_range(labels.front());
}

std::size_t marks_of(const presentation::Table& table) {
  std::size_t marks = 0;
  for (const std::vector<presentation::Cell>& r : table.rows)
    marks += static_cast<std::size_t>(
        std::count_if(r.begin(), r.end(), [](const presentation::Cell& c) { return c.marked; }));
  return marks;
}

bool is_path(const Record& r, std::string_view algorithm, std::string_view world) {
  const Variant& v = r.job.variant;
  return v.kind == RunKind::kPath && v.algorithm == algorithm && v.world == world && v.population == 50 &&
         v.iterations == 100 && (v.sharing == 9 || !has_slaves(v.algorithm));
}

TEST(PathTables, HaveTheFourStatisticsOfThePathsThatReachAndThePapersBeside) {
  const Results results = changed(4, [](Record& r) {
    if (!is_path(r, "pmomvo-4", "table2-2")) return;
    r.values[key::kSlr] = 1.0 + 0.1 * r.job.run;  // 1.0, 1.1, 1.2 and, not reaching, 1.3
    r.values[key::kReached] = r.job.run < 3 ? 1.0 : 0.0;
    r.measured[key::kPlanning] = 0.010 * (r.job.run + 1);
  });
  const std::vector<presentation::Table> tables = path_tables(Selection(results), false);
  const auto& slr = find(tables, "table06");
  EXPECT_NEAR(*row(slr, {"PMOMVO-4", "Best"})[3].value, 1.0, 1e-12);
  EXPECT_NEAR(*row(slr, {"PMOMVO-4", "Mean"})[3].value, 1.1, 1e-12);
  EXPECT_NEAR(*row(slr, {"PMOMVO-4", "Worst"})[3].value, 1.2, 1e-12);
  EXPECT_NEAR(*row(slr, {"PMOMVO-4", "STD"})[3].value, 0.1, 1e-12);
  EXPECT_EQ(row(slr, {"PMOMVO-4", "Mean"})[3].paper, "1.0162");
  EXPECT_EQ(row(slr, {"PMOMVO-4", "Reached"})[3].text, "3/4");
  const auto& time = find(tables, "table07");
  EXPECT_NEAR(*row(time, {"PMOMVO-4", "Worst"})[3].value, 40.0, 1e-9) << "ms, of all runs";
  EXPECT_EQ(row(time, {"PMOMVO-4", "Worst"})[3].paper, "430.6541");
}

TEST(FrontTables, CallTheLargestHvTheBestAndTheSmallestHrs) {
  const Results results = changed(2, [](Record& r) {
    if (r.job.variant.kind != RunKind::kFront || r.job.variant.world != hardest_world(false)) return;
    r.values[key::kHv] = r.values[key::kHrs] = r.job.variant.sharing + 0.5 * r.job.run;
  });
  const std::vector<presentation::Table> tables = front_tables(Selection(results), false);
  EXPECT_EQ(row(find(tables, "table03"), {"PMOMVO-6", "Best"})[7].value, 9.5);
  EXPECT_EQ(row(find(tables, "table05"), {"PMOMVO-6", "Best"})[7].value, 9.0);
  EXPECT_EQ(row(find(tables, "table03"), {"PMOMVO-6", "Mean"})[7].paper, "0.0950");
  EXPECT_EQ(row(find(tables, "table03"), {"PMOMVO-6", "Mean"})[6].paper, "") << "the paper has no l = 7";
  EXPECT_FALSE(row(find(tables, "table03"), {"MOMVO", "Mean"})[7].value) << "MOMVO does not share";
}

TEST(RankTables, OfThePapersMeansAreThePapersTables) {
  const Results results = changed(1, [](Record& r) {
    const Variant& v = r.job.variant;
    if (v.kind != RunKind::kPath) return;
    for (const std::string& world : numbered_worlds(false)) {
      if (!is_path(r, v.algorithm, world) || v.world != world) continue;
      const std::string time = paper_text(false, "table07", label_of(v.algorithm), world_number(world), "Mean");
      if (!time.empty()) r.measured[key::kPlanning] = std::stod(time);
    }
  });
  const std::vector<presentation::Table> tables = rank_tables(Selection(results), false);
  for (const std::vector<presentation::Cell>& r : find(tables, "table09").rows)
    for (std::size_t i = 1; i < r.size(); ++i) EXPECT_EQ(r[i].text, r[i].paper) << r[0].text << " " << i;
  for (const std::vector<presentation::Cell>& r : find(tables, "table11").rows)
    for (std::size_t i = 1; i < r.size(); ++i) EXPECT_EQ(r[i].text, r[i].paper) << r[0].text << " " << i;
  EXPECT_NE(find(tables, "table09").notes.front().find("F = 83.500 (the paper: 83.500)"), std::string::npos);
  EXPECT_EQ(marks_of(find(tables, "table11")), 20U) << "the paper underlines all 21";
  EXPECT_NE(find(tables, "table11").notes.front().find("2.7939 (the paper: 2.7939)"), std::string::npos);
}

TEST(RankTables, OfBlockedWorldsPutWhoFailsLessOftenFirst) {
  const Results results = changed(2, [](Record& r) {
    if (r.job.variant.kind != RunKind::kPath || !is_blocked(r.job.variant.world)) return;
    if (r.job.variant.algorithm == "momvo") r.values[key::kSlr] = 1.5;
    if (r.job.variant.algorithm == "pmomvo-2") r.values[key::kReached] = r.job.run;  // one fails, the other is short
  });
  const std::optional<statistics::Scores> found = scores(Selection(results), Criterion::kLength, true);
  ASSERT_TRUE(found);
  EXPECT_EQ(statistics::friedman_ranks(*found)[0][0], 6.0);
  EXPECT_EQ(statistics::friedman_ranks(*found)[1][0], 7.0);
}

TEST(RankTables, DoNotRankTheLastBitsOfLengths) {
  const Results results = changed(1, [](Record& r) {
    if (r.job.variant.kind == RunKind::kPath) r.values[key::kSlr] = 1.0 + 1e-11 * place_of(r.job.variant.algorithm);
  });
  const std::vector<presentation::Table> tables = rank_tables(Selection(results), false);
  for (const std::vector<presentation::Cell>& r : find(tables, "table08").rows) EXPECT_EQ(r[1].value, 4.0) << r[0].text;
  EXPECT_NE(find(tables, "table08").notes.front().find("are not shown to differ"), std::string::npos);
}

/// Ranks whose sums are 15 apart at most, LSD's critical difference being 11.5, while F = 1.2 is far from critical.
TEST(RankTables, MarkNoPairsWhereFriedmansTestFindsNothing) {
  const std::vector<std::vector<double>> by_algorithm{{3, 1, 4, 1, 2}, {7, 3, 2, 7, 5}, {4, 4, 3, 3, 4},
                                                      {2, 2, 1, 6, 7}, {1, 7, 6, 4, 1}, {6, 6, 7, 2, 3},
                                                      {5, 5, 5, 5, 6}};
  const Results results = changed(1, [&](Record& r) {
    const Variant& v = r.job.variant;
    const std::vector<std::string> own = own_algorithms();
    const auto a = static_cast<std::size_t>(std::find(own.begin(), own.end(), v.algorithm) - own.begin());
    if (v.kind != RunKind::kPath || a == own.size() || is_blocked(v.world) || is_pictured(v.world)) return;
    r.measured[key::kPlanning] = by_algorithm[a][static_cast<std::size_t>(std::stoi(world_number(v.world)) - 1)];
  });
  ASSERT_TRUE(statistics::fisher_lsd(by_algorithm).pairs[5].lsd) << "MOMVO against PMOMVO-12";
  const std::vector<presentation::Table> tables = rank_tables(Selection(results), false);
  for (const char* id : {"table11", "table11-pairs"}) {
    EXPECT_EQ(marks_of(find(tables, id)), 0U) << id;
    EXPECT_NE(find(tables, id).notes.back().find("LSD marks nothing"), std::string::npos) << id;
  }
}

TEST(AnytimeTable, NamesThoseThatHadMoreBeforeTheEnd) {
  const auto notes = [](double of_momvo) {
    const Results results = changed(3, [=](Record& r) {
      if (r.job.variant.kind != RunKind::kAnytime) return;
      for (double& hv : r.series[key::kHvAt]) hv = 0.9 + 0.01 * r.job.run;
      if (r.job.variant.algorithm == "momvo") r.series[key::kHvAt][5] += of_momvo + 0.001 * r.job.run;
    });
    return fmt::format("{}", fmt::join(anytime_table(Selection(results), false).notes, " "));
  };
  EXPECT_NE(notes(0.05).find("before the end: MOMVO (0.9610 at 35 %). "), std::string::npos) << notes(0.05);
  EXPECT_EQ(notes(-0.05).find("before the end"), std::string::npos);
  EXPECT_EQ(notes(0.0).find("before the end"), std::string::npos) << "no more than the runs' noise";
}

TEST(SizeTables, AreLeftEmptyWhereAQuickStudyHasNothing) {
  const Results results = changed(1, [](Record& r) {
    if (r.job.variant.kind == RunKind::kPath) r.values[key::kLength] = r.job.variant.population;
  });
  const std::vector<presentation::Table> tables = sensitivity_tables(Selection(results), false);
  const auto& length = find(tables, "table13");
  EXPECT_EQ(row(length, {"200", "100"})[5].value, 100.0);
  EXPECT_EQ(row(length, {"200", "100"})[5].paper, "22.3462");
  EXPECT_FALSE(row(length, {"300", "200"})[5].value);
  EXPECT_EQ(row(length, {"300", "200"})[5].paper, "22.2871");
}

TEST(Verdict, IsByTheIntervalOfThePairedDifferences) {
  EXPECT_EQ(judge({-1.0, -1.1, -0.9}).outcome, Outcome::kBetter);
  EXPECT_EQ(judge({1.0, 1.1, 0.9}).outcome, Outcome::kWorse);
  EXPECT_EQ(judge({-1.0, 1.1, 0.1}).outcome, Outcome::kNoDifference);
  EXPECT_EQ(judge({0.0, 0.0}).outcome, Outcome::kNoDifference);
  EXPECT_EQ(judge({-1.0, -1.1, -0.9}, 2.0).outcome, Outcome::kNoDifference) << "below what is resolved";
  EXPECT_EQ(judge({-1.0}).outcome, Outcome::kUnknown);
  EXPECT_EQ(judge({}).outcome, Outcome::kUnknown);
  // Student's t of 2 degrees of freedom at 97.5 % is 4.3027.
  const Verdict v = judge({1.0, 2.0, 3.0});
  EXPECT_NEAR(v.high, 2.0 + 4.3027 / std::sqrt(3.0), 1e-3);
}

TEST(Verdict, SaysAgainstWhomPmomvoIsWorseWhoeverItIs) {
  const auto hv = [](double of_retained, double of_nsga2) {
    return changed(3, [=](Record& r) {
      if (r.job.variant.kind != RunKind::kAnytime) return;
      if (r.job.variant.algorithm == kRetained) r.series[key::kHvAt].back() = of_retained + 0.01 * r.job.run;
      if (r.job.variant.algorithm == "nsga2") r.series[key::kHvAt].back() = of_nsga2 + 0.01 * r.job.run;
    });
  };
  const Results worse = hv(0.8, 0.9), better = hv(0.9, 0.8);
  EXPECT_EQ(compare(Selection(worse), "nsga2")[0].outcome, Outcome::kWorse);
  EXPECT_EQ(compare(Selection(better), "nsga2")[0].outcome, Outcome::kBetter);
  EXPECT_NE(verdict_sentences(Selection(worse)).front().find("**PMOMVO-6 against NSGA-II:** worse in hypervolume"),
            std::string::npos);
  EXPECT_NE(verdict_sentences(Selection(better)).front().find("worse in nothing; better in hypervolume"),
            std::string::npos);
}

TEST(Claims, FollowTheRuns) {
  const auto outcome = [](const Results& results, const std::string& claim) {
    for (const Claim& c : judge_claims(Selection(results)))
      if (c.claim.find(claim) != std::string::npos) return c.outcome;
    throw std::out_of_range(claim);
  };
  const auto sharing = [](double sign) {
    return changed(3, [=](Record& r) {
      if (r.job.variant.kind == RunKind::kFront)
        r.values[key::kHv] = 0.5 + sign * 0.01 * r.job.variant.sharing + 0.001 * r.job.run;
    });
  };
  EXPECT_EQ(outcome(sharing(1.0), "HV grows with the sharing rate"), Outcome::kBetter);
  EXPECT_EQ(outcome(sharing(-1.0), "HV grows with the sharing rate"), Outcome::kWorse);
  EXPECT_EQ(outcome(sharing(0.0), "HV grows with the sharing rate"), Outcome::kNoDifference);
  const auto fastest = [](std::string_view name) {
    return changed(2, [=](Record& r) {
      if (r.job.variant.kind == RunKind::kPath && r.job.variant.algorithm == name) r.measured[key::kPlanning] = 1e-4;
    });
  };
  EXPECT_EQ(outcome(fastest("pmomvo-6"), "PMOMVO-6 is the fastest"), Outcome::kBetter);
  EXPECT_EQ(outcome(fastest("pmomvo-8"), "PMOMVO-6 is the fastest"), Outcome::kWorse);
  const auto spread = [](double in_the_last) {
    return changed(1, [=](Record& r) {
      const bool momvo = r.job.variant.kind == RunKind::kPath && r.job.variant.algorithm == "momvo";
      if (momvo) r.values[key::kSlr] = is_hardest(r.job.variant.world) ? 1.0 + in_the_last : 1.02;
    });
  };
  EXPECT_EQ(outcome(spread(0.01), "differ in path length"), Outcome::kBetter);
  EXPECT_EQ(outcome(spread(0.001), "differ in path length"), Outcome::kWorse) << "not in each scenario";
}

TEST(StudyOutput, OfAStudyThatHasHardlyBegunLeavesPlacesEmptyAndSaysSo) {
  Results results;
  results.settings = small_study(2);
  for (const Job& job : jobs_of(results.settings))
    if (job.number % 7 == 0) results.add(empty_record(job));
  const Selection selection(results);
  const Setting setting(results.settings, small_planner());
  ReportParts parts;
  for (const presentation::Table& table : all_tables(selection, setting.scenes)) {
    EXPECT_NO_THROW(static_cast<void>(presentation::to_csv(table))) << table.id;
    EXPECT_TRUE(parts.tables.emplace(table.id, table).second) << table.id << " is there twice";
  }
  for (const CaptionedFigure& figure : all_figures(selection, setting))
    EXPECT_NO_THROW(static_cast<void>(figures::gnuplot_script(figure.figure))) << figure.figure.id;
  parts.claims = judge_claims(selection);
  EXPECT_NE(presentation::report_html(study_report(selection, setting, parts)).find("Incomplete:"), std::string::npos);
  results.runs.clear();
  EXPECT_TRUE(all_figures(Selection(results), setting).empty());
  EXPECT_NO_THROW(static_cast<void>(all_tables(Selection(results), setting.scenes)));
}

}  // namespace
}  // namespace jink::tools::lab::study
