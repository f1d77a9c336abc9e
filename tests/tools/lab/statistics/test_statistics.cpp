// SPDX-License-Identifier: BSD-3-Clause
// The statistics against published values, the values that the paper prints, and cases worked by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "planner/base/random.hpp"
#include "tools/lab/presentation/paper_numbers.hpp"
#include "tools/lab/statistics/ranks.hpp"
#include "tools/lab/statistics/samples.hpp"

namespace jink::tools::lab::statistics {
namespace {

using tools::lab::presentation::paper_number;

TEST(Wilson, AgreesWithPublishedIntervals) {
  // Newcombe 1998, Statistics in Medicine 17, p. 857-872, table I, method 3.
  struct Case {
    std::int64_t count, of;
    double low, high;
  };
  for (const Case& c : {Case{81, 263, 0.2553, 0.3662}, Case{15, 148, 0.0624, 0.1605}, Case{0, 20, 0.0, 0.1611},
                        Case{1, 29, 0.0061, 0.1718}}) {
    const Proportion p = wilson(c.count, c.of);
    EXPECT_NEAR(p.low, c.low, 5e-5) << c.count << " of " << c.of;
    EXPECT_NEAR(p.high, c.high, 5e-5) << c.count << " of " << c.of;
    EXPECT_EQ(p.value(), static_cast<double>(c.count) / static_cast<double>(c.of));
  }
}

TEST(Wilson, MirrorsAndEndsAtZeroAndOne) {
  for (const std::int64_t of : {1, 3, 10, 997, 1000000}) {
    EXPECT_EQ(wilson(0, of).low, 0.0);
    EXPECT_EQ(wilson(of, of).high, 1.0);
    for (const std::int64_t count : {std::int64_t{0}, of / 3, of / 2}) {
      const Proportion p = wilson(count, of), q = wilson(of - count, of);
      EXPECT_NEAR(p.low, 1.0 - q.high, 1e-12);
      EXPECT_NEAR(p.high, 1.0 - q.low, 1e-12);
      EXPECT_LE(p.low, p.value());
      EXPECT_GE(p.high, p.value());
    }
  }
}

TEST(Wilson, NothingIsKnownOfNothing) {
  const Proportion p = wilson(0, 0);
  EXPECT_EQ(p.low, 0.0);
  EXPECT_EQ(p.high, 1.0);
}

TEST(Quantile, IsLinearBetweenNeighbours) {
  const std::vector<double> values{1.0, 2.0, 4.0, 8.0};
  EXPECT_EQ(quantile(values, 0.0), 1.0);
  EXPECT_EQ(quantile(values, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quantile(values, 0.05), 1.15);
  EXPECT_DOUBLE_EQ(quantile(values, 0.9), 4.0 + 0.7 * 4.0);
  EXPECT_EQ(quantile(values, 1.0), 8.0);
  EXPECT_EQ(quantile({7.0}, 0.3), 7.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Quantile, KeepsInfinity) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(quantile({1.0, infinity, infinity}, 0.75), infinity);
  EXPECT_EQ(quantile({1.0, infinity}, 0.0), 1.0);
}

TEST(DurationHistogram, QuantilesAreWithinABinOfTheExactOnes) {
  planner::base::RandomStream random(5);
  std::vector<double> values;
  DurationHistogram histogram;
  for (int i = 0; i < 5000; ++i) {
    values.push_back(0.05 * std::exp(6.0 * random.uniform()));
    histogram.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double p : {0.01, 0.5, 0.99}) {
    const double exact = values[static_cast<std::size_t>(std::ceil(p * 5000.0)) - 1];
    EXPECT_NEAR(histogram.quantile(p) / exact, 1.0, 0.011) << p;
  }
  EXPECT_EQ(histogram.max(), values.back());
  EXPECT_LE(histogram.quantile(1.0), histogram.max());
  EXPECT_EQ(histogram.count(), 5000);
}

TEST(DurationHistogram, OfTwoPartsIsThatOfTheWhole) {
  DurationHistogram a, b, whole;
  for (int i = 1; i <= 100; ++i) {
    (i % 3 == 0 ? a : b).add(0.1 * i);
    whole.add(0.1 * i);
  }
  a.add(b);
  EXPECT_EQ(a.bins(), whole.bins());
  EXPECT_EQ(a.max(), whole.max());
  EXPECT_EQ(a.count(), 100);
}

TEST(DurationHistogram, WithoutValuesHasNoQuantile) {
  EXPECT_TRUE(std::isnan(DurationHistogram().quantile(0.5)));
  DurationHistogram zero;
  zero.add(0.0);
  EXPECT_EQ(zero.quantile(0.5), 0.0);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::vector<std::string> kAlgorithms{"MOMVO",    "PMOMVO-2",  "PMOMVO-4", "PMOMVO-6",
                                           "PMOMVO-8", "PMOMVO-10", "PMOMVO-12"};

double printed(const std::string& table, const std::string& row, const std::string& column, const char* statistic) {
  const auto text = paper_number(table, row, column, statistic);
  EXPECT_TRUE(text) << table << ' ' << row << ' ' << column << ' ' << statistic;
  return text ? std::stod(std::string(*text)) : std::nan("");
}

/// The ranks of the paper's Tables 8 and 9.
Scores paper_ranks(const std::string& table) {
  Scores ranks;
  for (const std::string& algorithm : kAlgorithms) {
    ranks.emplace_back();
    for (const char* scenario : {"1", "2", "3", "4", "5"})
      ranks.back().push_back(printed(table, algorithm, scenario, "rank"));
  }
  return ranks;
}

TEST(PaperStatistics, RankSumsAreThePapers) {
  for (const char* table : {"table08", "table09"}) {
    const std::vector<double> sums = rank_sums(paper_ranks(table));
    for (std::size_t a = 0; a < kAlgorithms.size(); ++a)
      EXPECT_EQ(sums[a], printed(table, kAlgorithms[a], "sum", "rank")) << table << ' ' << kAlgorithms[a];
  }
}

TEST(PaperStatistics, ImanDavenportAndItsCriticalValueAreThePapers) {
  const Friedman slr = friedman(paper_ranks("table08"));
  EXPECT_NEAR(slr.iman_davenport, 38.424, 5e-4);
  EXPECT_NEAR(slr.critical_f, 2.5082, 5e-5);
  EXPECT_TRUE(slr.rejected);
  EXPECT_EQ(slr.algorithms, 7);
  EXPECT_EQ(slr.scenarios, 5);
  const Friedman time = friedman(paper_ranks("table09"));
  EXPECT_NEAR(time.iman_davenport, 83.500, 5e-4);
  EXPECT_NEAR(time.critical_f, 2.5082, 5e-5);
  EXPECT_EQ(printed("table08", "all", "all", "Iman-Davenport F"), 38.424);
  EXPECT_EQ(printed("table09", "all", "all", "Iman-Davenport F"), 83.500);
  // The two forms of the test are one: F = (sigma - 1) chi2 / (sigma (mu - 1) - chi2).
  EXPECT_NEAR(slr.iman_davenport, 4.0 * slr.chi_square / (30.0 - slr.chi_square), 1e-9);
  EXPECT_LT(slr.iman_p, 1e-9);
  EXPECT_LT(time.iman_p, slr.iman_p);
}

TEST(PaperStatistics, LeastSignificantDifferencesAreThePapers) {
  EXPECT_NEAR(fisher_lsd(paper_ranks("table08")).critical, 4.0124, 5e-5);
  EXPECT_NEAR(fisher_lsd(paper_ranks("table09")).critical, 2.7939, 5e-5);
  EXPECT_EQ(printed("table10", "all", "all", "critical difference"), 4.0124);
  EXPECT_EQ(printed("table11", "all", "all", "critical difference"), 2.7939);
}

/// The paper's Tables 10 and 11: its differences are ours. Its marks are too, but for three that contradict its own
/// critical values; these and no others.
TEST(PaperStatistics, PairedComparisonsAreThePapersButForThreeMarks) {
  const std::map<std::string, std::string> ranks_of{{"table10", "table08"}, {"table11", "table09"}};
  std::vector<std::string> contradictions;
  for (const auto& [table, ranks] : ranks_of) {
    const Lsd lsd = fisher_lsd(paper_ranks(ranks));
    ASSERT_EQ(lsd.pairs.size(), 21U);
    for (const Comparison& pair : lsd.pairs) {
      const std::string& a = kAlgorithms[static_cast<std::size_t>(pair.a)];
      const std::string& b = kAlgorithms[static_cast<std::size_t>(pair.b)];
      EXPECT_EQ(std::abs(pair.difference), printed(table, a, b, "difference")) << table << ' ' << a << ' ' << b;
      const bool underlined = paper_number(table, a, b, "underlined") == "yes";
      if (underlined != pair.lsd)
        contradictions.push_back(std::string(table).append(" ").append(a).append(" ").append(b));
    }
  }
  EXPECT_EQ(contradictions, (std::vector<std::string>{"table10 PMOMVO-4 PMOMVO-6", "table10 PMOMVO-8 PMOMVO-12",
                                                      "table11 PMOMVO-2 PMOMVO-12"}));
}

/// Ranking the means of Tables 6 and 7 gives Tables 8 and 9, but for scenario 5 of the SLR.
TEST(PaperStatistics, RanksFollowFromThePapersMeansButInOneColumn) {
  for (const auto& [means, ranks] :
       std::map<std::string, std::string>{{"table06", "table08"}, {"table07", "table09"}}) {
    Scores scores;
    for (const std::string& algorithm : kAlgorithms) {
      scores.emplace_back();
      for (const char* scenario : {"1", "2", "3", "4", "5"})
        scores.back().push_back(printed(means, algorithm, scenario, "Mean"));
    }
    const Scores ours = friedman_ranks(scores), papers = paper_ranks(ranks);
    for (std::size_t a = 0; a < ours.size(); ++a)
      for (std::size_t s = 0; s < 5; ++s)
        if (ranks == "table09" || s != 4) {
          EXPECT_EQ(ours[a][s], papers[a][s]) << ranks << ' ' << kAlgorithms[a] << ' ' << s;
        }
  }
  // Printed 1.0202, 1.0203, 1.0199, 1.0203 for 6, 8, 10 and 12 slaves, and ranked 3, 4, 2, 1.
  const Scores tied = friedman_ranks({{1.0378}, {1.0344}, {1.0205}, {1.0202}, {1.0203}, {1.0199}, {1.0203}});
  EXPECT_EQ(tied, (Scores{{7}, {6}, {5}, {2}, {3.5}, {1}, {3.5}}));
}

TEST(FriedmanRanks, TiesShareTheMeanOfTheirRanks) {
  EXPECT_EQ(friedman_ranks({{1, 5}, {1, 5}, {0, 5}, {2, 5}}), (Scores{{2.5, 2.5}, {2.5, 2.5}, {1, 2.5}, {4, 2.5}}));
}

TEST(FriedmanRanks, WhatIsNoNumberComesLast) {
  EXPECT_EQ(friedman_ranks({{std::nan("")}, {kInfinity}, {-1.0}, {std::nan("")}}), (Scores{{3.5}, {2}, {1}, {3.5}}));
}

TEST(FriedmanRanks, RefusesAGap) {
  EXPECT_THROW((void)friedman_ranks({{1, 2}, {1}}), std::invalid_argument);
  EXPECT_TRUE(friedman_ranks({}).empty());
}

TEST(FriedmanRanks, AddUpToTheSameForAnyScores) {
  planner::base::RandomStream random(7);
  for (int round = 0; round < 200; ++round) {
    Scores scores(5, std::vector<double>(4));
    for (auto& row : scores)
      for (double& v : row) v = std::floor(4.0 * random.uniform());  // many ties
    const Scores ranks = friedman_ranks(scores);
    const std::vector<double> sums = rank_sums(ranks);
    EXPECT_EQ(std::accumulate(sums.begin(), sums.end(), 0.0), 4 * 15.0);
    for (std::size_t s = 0; s < 4; ++s)
      for (std::size_t a = 0; a < 5; ++a)
        for (std::size_t b = 0; b < 5; ++b) EXPECT_EQ(scores[a][s] < scores[b][s], ranks[a][s] < ranks[b][s]);
  }
}

/// Conover, section 5.8, example 1: four grasses ranked by twelve homeowners, with ties; T1 = 8.097, T2 = 3.19.
TEST(Friedman, AgreesWithATextbookExampleWithTies) {
  const Scores by_block{{4, 3, 2, 1}, {4, 2, 3, 1}, {3, 1.5, 1.5, 4}, {3, 1, 2, 4}, {4, 2, 1, 3}, {2, 2, 2, 4},
                        {1, 3, 2, 4}, {2, 4, 1, 3}, {3.5, 1, 2, 3.5}, {4, 1, 3, 2}, {4, 2, 3, 1}, {3.5, 1, 2, 3.5}};
  Scores ranks(4, std::vector<double>(12));
  for (std::size_t s = 0; s < 12; ++s)
    for (std::size_t a = 0; a < 4; ++a) ranks[a][s] = by_block[s][a];
  const Friedman test = friedman(ranks);
  EXPECT_NEAR(test.chi_square, 8.097, 5e-4);
  EXPECT_NEAR(test.iman_davenport, 3.19, 5e-3);
  EXPECT_NEAR(test.p, 0.0440, 5e-4);
  EXPECT_NEAR(test.critical_f, 2.8916, 5e-4);  // 3 and 33 degrees of freedom
  EXPECT_TRUE(test.rejected);
}

TEST(Friedman, AllTiedDiffersInNothing) {
  const Scores ranks(3, std::vector<double>(4, 2.0));
  const Friedman test = friedman(ranks);
  EXPECT_EQ(test.chi_square, 0.0);
  EXPECT_EQ(test.p, 1.0);
  EXPECT_EQ(test.iman_davenport, 0.0);
  EXPECT_EQ(test.iman_p, 1.0);
  EXPECT_FALSE(test.rejected);
  for (const Comparison& pair : fisher_lsd(ranks).pairs) {
    EXPECT_FALSE(pair.lsd);
    EXPECT_EQ(pair.p, 1.0);
    EXPECT_FALSE(pair.holm);
  }
}

TEST(Friedman, FullAgreementIsInfinitelyClear) {
  const Scores ranks{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  const Friedman test = friedman(ranks);
  EXPECT_EQ(test.chi_square, 6.0);  // sigma (mu - 1)
  EXPECT_EQ(test.iman_davenport, kInfinity);
  EXPECT_EQ(test.iman_p, 0.0);
  EXPECT_TRUE(test.rejected);
  const Lsd lsd = fisher_lsd(ranks);
  EXPECT_EQ(lsd.critical, 0.0);
  for (const Comparison& pair : lsd.pairs) {
    EXPECT_TRUE(pair.lsd && pair.holm);
    EXPECT_EQ(pair.p, 0.0);
    EXPECT_LT(pair.difference, 0.0);
  }
}

TEST(Friedman, NeedsSomethingToCompare) {
  EXPECT_THROW((void)friedman({}), std::invalid_argument);
  EXPECT_THROW((void)friedman({{1, 1}}), std::invalid_argument);
  EXPECT_THROW((void)friedman({{1}, {2}}), std::invalid_argument);
  EXPECT_THROW((void)friedman({{1, 2}, {2}}), std::invalid_argument);
  EXPECT_THROW((void)friedman({{1, 2}, {2, 1}}, 0.0), std::invalid_argument);
  EXPECT_THROW((void)fisher_lsd({{1, 2}, {2, 1}}, 1.0), std::invalid_argument);
}

TEST(FisherLsd, APairIsAsSignificantAsItsDistanceFromTheCriticalValue) {
  for (const char* table : {"table08", "table09"}) {
    const Lsd lsd = fisher_lsd(paper_ranks(table));
    for (const Comparison& pair : lsd.pairs) {
      EXPECT_EQ(pair.p<0.05, std::abs(pair.difference)> lsd.critical_two_sided);
      EXPECT_EQ(pair.p < 0.10, pair.lsd);  // one-sided at 5 % is two-sided at 10 %
      EXPECT_GE(pair.p_holm, pair.p);
      EXPECT_EQ(pair.holm, pair.p_holm <= 0.05);
    }
  }
}

TEST(FisherLsd, TwoAlgorithmsWorkedByHand) {
  // Rank sums 5 and 7, A = 20: t_{.95,3} sqrt(2 (4 * 20 - 74) / 3) = 2.353363 * 2. Then p is that of |t| = 1.
  const Lsd lsd = fisher_lsd({{1, 1, 1, 2}, {2, 2, 2, 1}});
  ASSERT_EQ(lsd.pairs.size(), 1U);
  EXPECT_NEAR(lsd.critical, 2.0 * 2.353363, 1e-5);
  EXPECT_EQ(lsd.pairs[0].difference, -2.0);
  EXPECT_NEAR(lsd.pairs[0].p, 0.391002, 1e-6);
  EXPECT_EQ(lsd.pairs[0].p_holm, lsd.pairs[0].p);
}

TEST(Holm, StepsDown) {
  // Worked by hand: 0.01 * 4, 0.015 * 3 = 0.045, 0.03 * 2, and 0.04 * 1, which may not be less than the one before.
  const std::vector<double> adjusted = holm(std::vector<double>{0.03, 0.01, 0.04, 0.015});
  EXPECT_DOUBLE_EQ(adjusted[0], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[1], 0.04);
  EXPECT_DOUBLE_EQ(adjusted[2], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[3], 0.045);
  EXPECT_EQ(holm(std::vector<double>{0.9, 0.8}), (std::vector<double>{1.0, 1.0}));
  EXPECT_TRUE(holm({}).empty());
}

TEST(Summary, IsStudentsOfASample) {
  // Mean 5, deviation sqrt(32 / 7), t_{.975,7} = 2.364624.
  const std::vector<double> values{2, 4, 4, 4, 5, 5, 7, 9};
  const Summary s = summary(values);
  EXPECT_EQ(s.count, 8);
  EXPECT_EQ(s.least, 2.0);
  EXPECT_EQ(s.greatest, 9.0);
  EXPECT_EQ(s.mean, 5.0);
  EXPECT_EQ(s.median, 4.5);
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt(32.0 / 7.0));
  EXPECT_NEAR(s.high - s.mean, 2.364624 * std::sqrt(32.0 / 7.0 / 8.0), 1e-5);
  EXPECT_NEAR(s.mean - s.low, s.high - s.mean, 1e-12);
  EXPECT_LT(summary(values, 0.5).high, s.high);
}

TEST(Summary, OfOneOrNothingKnowsNoSpread) {
  const Summary one = summary(std::vector<double>{3.0});
  EXPECT_EQ(one.mean, 3.0);
  EXPECT_TRUE(std::isnan(one.deviation));
  EXPECT_EQ(one.low, -kInfinity);
  EXPECT_EQ(one.high, kInfinity);
  const Summary none = summary({});
  EXPECT_EQ(none.count, 0);
  EXPECT_TRUE(std::isnan(none.mean) && std::isnan(none.low) && std::isnan(none.least));
  EXPECT_EQ(summary(std::vector<double>{2.0, 2.0}).low, 2.0);
  EXPECT_THROW((void)summary(std::vector<double>{1.0, kInfinity}), std::invalid_argument);
  EXPECT_THROW((void)summary(std::vector<double>{1.0}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace jink::tools::lab::statistics
