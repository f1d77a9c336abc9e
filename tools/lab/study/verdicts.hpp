// SPDX-License-Identifier: BSD-3-Clause
// What the numbers say: PMOMVO-6 against every other algorithm, and the paper's claims one by one. Nothing here is
// written beforehand; each sentence follows from the records.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/presentation/table.hpp"
#include "tools/lab/study/selection.hpp"

namespace jink::tools::lab::study {

/// How one algorithm compares with another in one respect.
enum class Outcome { kBetter, kWorse, kNoDifference, kUnknown };
[[nodiscard]] std::string_view to_string(Outcome outcome);

/// A path length in µm is resolved so far.
inline constexpr double kResolvedUm = 1.0;

/// By the 95 % interval (Student) of the mean of paired differences, of which smaller ones speak for the first: better
/// or worse where the interval is all on one side of 0; no difference where it is not, or the mean is nearer to 0 than
/// `resolution`, below which a difference means nothing; unknown for fewer than two pairs.
struct Verdict {
  Outcome outcome = Outcome::kUnknown;
  int pairs = 0;
  double mean = 0.0, low = 0.0, high = 0.0;  ///< of first minus second; 0 where there is no pair
};
[[nodiscard]] Verdict judge(const std::vector<double>& differences, double resolution = 0.0);

/// A respect in which algorithms are compared.
struct Metric {
  std::string name;     ///< of the column: "Path length, scenario 5 (µm)"
  std::string subject;  ///< in a sentence: "path length in scenario 5"
  std::string unit;     ///< behind a number: " µm"
};
[[nodiscard]] std::vector<Metric> metrics();
/// Places of two of them: those of Table 15.
inline constexpr std::size_t kLengthMetric = 2, kTimeMetric = 5;

/// The retained algorithm against `other` in each of metrics().
[[nodiscard]] std::vector<Verdict> compare(const Selection& selection, std::string_view other);

/// "verdicts": a row for each other algorithm, a column for each respect.
[[nodiscard]] presentation::Table verdict_table(const Selection& selection);

/// Sentences: against whom the retained algorithm is worse, not shown to differ, or better, in which metrics; first
/// NSGA-II and MOEA/D, which are the standard.
[[nodiscard]] std::vector<std::string> verdict_sentences(const Selection& selection);

/// A claim of the paper and what these runs say of it.
struct Claim {
  std::string claim;                    ///< in our words, with where it is made
  std::string finding;                  ///< with the numbers
  Outcome outcome = Outcome::kUnknown;  ///< better: the runs agree; worse: they contradict; no difference: neither
};
[[nodiscard]] std::vector<Claim> judge_claims(const Selection& selection);

/// "claims".
[[nodiscard]] presentation::Table claim_table(const std::vector<Claim>& claims);

}  // namespace jink::tools::lab::study
