// SPDX-License-Identifier: BSD-3-Clause
// The paper's numbers: that all are there, that some are as printed, and that what the notes say of them holds.
#include "tools/lab/presentation/paper_numbers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>

namespace jink::tools::lab::presentation {
namespace {

TEST(PaperNumbers, AllTablesAreThere) {
  std::map<std::string, int> counts;
  for (const PaperNumber& n : paper_numbers()) ++counts[std::string(n.table)];
  // Tables 3 to 5: four numbers for MOMVO and 6 x 5 x 4. 6, 7: 7 x 5 x 4. 8, 9: 7 x 6, F and its critical value. 10,
  // 11: 21 differences and marks, and the critical difference. 13, 14: 9 x 7. 15: 5 x 2 x 4.
  const std::map<std::string, int> expected{{"table03", 124}, {"table04", 124}, {"table05", 124}, {"table06", 140},
                                            {"table07", 140}, {"table08", 44},  {"table09", 44},  {"table10", 43},
                                            {"table11", 43},  {"table13", 63},  {"table14", 63},  {"table15", 40}};
  EXPECT_EQ(counts, expected);
}

TEST(PaperNumbers, AreAsPrinted) {
  const auto is = [](const char* table, const char* row, const char* column, const char* statistic) {
    return paper_number(table, row, column, statistic).value_or("nothing");
  };
  EXPECT_EQ(is("table03", "MOMVO", "0", "STD"), "0.0153");
  EXPECT_EQ(is("table03", "PMOMVO-12", "9", "Best"), "0.1084");
  EXPECT_EQ(is("table04", "PMOMVO-8", "4", "Worst"), "0.9863");  // behind "Table 4. Cont."
  EXPECT_EQ(is("table05", "PMOMVO-6", "3", "Mean"), "8.1799");
  EXPECT_EQ(is("table06", "PMOMVO-4", "5", "Worst"), "1.0251");
  EXPECT_EQ(is("table06", "PMOMVO-10", "1", "Best"), "1.0071");
  EXPECT_EQ(is("table07", "MOMVO", "5", "Mean"), "915.5800");
  EXPECT_EQ(is("table08", "PMOMVO-6", "5", "rank"), "3");
  EXPECT_EQ(is("table09", "PMOMVO-12", "sum", "rank"), "26");
  EXPECT_EQ(is("table08", "all", "all", "critical F"), "2.5082");
  EXPECT_EQ(is("table10", "PMOMVO-8", "PMOMVO-10", "difference"), "3");
  EXPECT_EQ(is("table10", "PMOMVO-8", "PMOMVO-10", "underlined"), "no");
  EXPECT_EQ(is("table11", "PMOMVO-10", "PMOMVO-12", "underlined"), "yes");
  EXPECT_EQ(is("table13", "200/100", "PMOMVO-6", "length"), "22.3462");
  EXPECT_EQ(is("table14", "300/200", "MOMVO", "time"), "3937.7016");
  EXPECT_EQ(is("table14", "100/50", "PMOMVO-6", "time"), is("table07", "PMOMVO-6", "5", "Mean"));
  EXPECT_EQ(is("table15", "MOPSO", "FT", "STD"), "6.62");
  EXPECT_EQ(is("table15", "NSGA-II", "SLR", "Best"), "21.204");
}

TEST(PaperNumbers, ThereIsNothingWhereThePaperPrintsNothing) {
  EXPECT_FALSE(paper_number("table03", "MOMVO", "1", "Best"));
  EXPECT_FALSE(paper_number("table03", "PMOMVO-2", "7", "Best"));
  EXPECT_FALSE(paper_number("table15", "MOEA/D", "SLR", "Best"));
  EXPECT_FALSE(paper_number("table12", "1", "1", "Best"));
  EXPECT_FALSE(paper_number("table06", "MOMVO", "1", "mean"));
}

TEST(PaperNumbers, EachHasOnePlaceAndSaysWhereItComesFrom) {
  std::set<std::tuple<std::string_view, std::string_view, std::string_view, std::string_view>> places;
  for (const PaperNumber& n : paper_numbers()) {
    EXPECT_TRUE(places.emplace(n.table, n.row, n.column, n.statistic).second) << n.where;
    EXPECT_TRUE(n.where.starts_with("Table ") || n.where.starts_with("section 5.2")) << n.where;
    if (n.statistic == "underlined")
      EXPECT_TRUE(n.printed == "yes" || n.printed == "no") << n.where;
    else
      EXPECT_EQ(n.printed.find_first_not_of("0123456789."), std::string_view::npos) << n.where << ": " << n.printed;
  }
}

/// A group's best, mean, worst and standard deviation, and the half of the last digit that each was rounded to.
struct Group {
  double best = 0.0, mean = 0.0, worst = 0.0, deviation = 0.0;
  double half_digit = 0.0, deviation_half_digit = 0.0;
  std::string_view note;

  /// Whether 20 values can have them: the squares about the mean are most when all values lie at the ends, and least
  /// when all but the two ends lie midway.
  [[nodiscard]] bool possible() const {
    const double low = std::min(best, worst) - half_digit, high = std::max(best, worst) + half_digit;
    double most = 0.0;
    for (const double m :
         {mean - half_digit, mean + half_digit, std::clamp((low + high) / 2.0, mean - half_digit, mean + half_digit)})
      most = std::max(most, (high - m) * (m - low));
    const double range = std::max(0.0, high - low - 4.0 * half_digit);
    return deviation - deviation_half_digit <= std::sqrt(most * 20.0 / 19.0) &&
           deviation + deviation_half_digit >= range / std::sqrt(2.0 * 19.0);
  }
};

TEST(PaperNumbers, NotesSayWhichDeviationsNoSampleCanHave) {
  std::map<std::string, Group> groups;
  for (const PaperNumber& n : paper_numbers()) {
    if (n.statistic != "Best" && n.statistic != "Mean" && n.statistic != "Worst" && n.statistic != "STD") continue;
    Group& group = groups[std::string(n.table) + ' ' + std::string(n.row) + ' ' + std::string(n.column)];
    const double value = std::stod(std::string(n.printed));
    const double half = 0.5 * std::pow(10.0, -static_cast<double>(n.printed.size() - n.printed.find('.') - 1));
    if (n.statistic == "Best") group.best = value;
    if (n.statistic == "Mean") group.mean = value;
    if (n.statistic == "Worst") group.worst = value;
    if (n.statistic == "STD") {
      group.deviation = value;
      group.deviation_half_digit = half;
      group.note = n.note;
    } else {
      group.half_digit = std::max(group.half_digit, half);
    }
  }
  int impossible = 0;
  for (const auto& [place, group] : groups) {
    EXPECT_EQ(group.note.find("20 values") == std::string_view::npos, group.possible()) << place << ": " << group.note;
    if (!group.possible()) ++impossible;
  }
  EXPECT_EQ(groups.size(), 173U);
  EXPECT_EQ(impossible, 93);
}

}  // namespace
}  // namespace jink::tools::lab::presentation
