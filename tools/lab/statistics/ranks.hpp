// SPDX-License-Identifier: BSD-3-Clause
// Several algorithms compared over several scenarios by ranks.
// Sources: Friedman (1937); Iman and Davenport (1980), Commun. Stat. A9, p. 571; Conover, Practical Nonparametric
// Statistics (3rd ed. 1999), section 5.8, for ties and for Fisher's LSD on rank sums; Holm (1979), Scand. J. Stat. 6,
// p. 65. Pure functions, safe from any thread.
#pragma once

#include <span>
#include <vector>

namespace jink::tools::lab::statistics {

/// A row for each algorithm, a column for each scenario.
using Scores = std::vector<std::vector<double>>;

/// The ranks of the algorithms within each scenario, in the shape of `scores` (algorithms x scenarios): 1 for the
/// smallest score, equal ones share the mean of their ranks. NaN ranks behind every number, also behind infinity.
/// Throws std::invalid_argument where rows have different lengths.
[[nodiscard]] Scores friedman_ranks(const Scores& scores);

/// The sum of each algorithm's ranks.
[[nodiscard]] std::vector<double> rank_sums(const Scores& ranks);

/// Whether the algorithms differ at all. H0: each order of them is as likely as any other.
struct Friedman {
  int algorithms = 0;           ///< mu
  int scenarios = 0;            ///< sigma
  double chi_square = 0.0;      ///< corrected for ties, mu - 1 degrees of freedom
  double p = 1.0;               ///< of chi_square, approximate: rough for few scenarios
  double iman_davenport = 0.0;  ///< F; infinite where all scenarios agree on the order
  double iman_p = 1.0;          ///< of F with mu - 1 and (mu - 1)(sigma - 1) degrees of freedom
  double critical_f = 0.0;      ///< F's 1 - alpha quantile
  bool rejected = false;        ///< H0, by F: iman_davenport > critical_f
};

/// Friedman's test with Iman and Davenport's extension ([Paper] section 5.2). Where all ranks are tied nothing differs:
/// both statistics 0, both p 1. Throws std::invalid_argument for fewer than 2 algorithms or 2 scenarios, rows of
/// different lengths, or alpha outside (0, 1).
[[nodiscard]] Friedman friedman(const Scores& ranks, double alpha = 0.05);

/// Two algorithms, by their places in the ranks; a < b.
struct Comparison {
  int a = 0;
  int b = 0;
  double difference = 0.0;  ///< rank sum of a minus that of b: positive where b is the better one
  bool lsd = false;         ///< |difference| > Lsd::critical: significant as the paper has it
  double p = 1.0;           ///< two-sided, of |difference|, without correction for the number of pairs
  double p_holm = 1.0;      ///< p adjusted by Holm for all pairs
  bool holm = false;        ///< p_holm <= alpha
};

struct Lsd {
  /// t_{1-alpha} sqrt(2 (sigma A - sum R_j^2) / ((sigma - 1)(mu - 1))) with (sigma - 1)(mu - 1) degrees of freedom, A
  /// the sum of squared ranks. The paper's values have t one-sided, so as a test of a difference in either direction
  /// this has the level 2 alpha.
  double critical = 0.0;
  double critical_two_sided = 0.0;  ///< the same with t_{1-alpha/2}: p < alpha beyond it
  std::vector<Comparison> pairs;    ///< in the order (0, 1), (0, 2) ... (mu - 2, mu - 1)
};

/// Fisher's least significant difference of rank sums. Meant for when friedman() rejected. Where all scenarios agree on
/// all ranks, the variance is 0: every difference but 0 has p = 0. Throws as friedman() does.
[[nodiscard]] Lsd fisher_lsd(const Scores& ranks, double alpha = 0.05);

/// P-values adjusted by Holm's step-down procedure, in the order given: the k-th smallest of n times n - k + 1, never
/// less than the one before and at most 1.
[[nodiscard]] std::vector<double> holm(std::span<const double> p);

}  // namespace jink::tools::lab::statistics
