// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/statistics/ranks.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace jink::tools::lab::statistics {
namespace {

void check_alpha(double alpha) {
  if (!(alpha > 0.0 && alpha < 1.0))
    throw std::invalid_argument("alpha has to be between 0 and 1, not " + std::to_string(alpha));
}

void check_shape(const Scores& table) {
  for (const auto& row : table)
    if (row.size() != table.front().size())
      throw std::invalid_argument("every algorithm needs a value for each scenario: rows of " +
                                  std::to_string(table.front().size()) + " and " + std::to_string(row.size()));
}

/// The sums that both tests are made of. mu algorithms, sigma scenarios, as the paper calls them.
struct Sums {
  double mu = 0.0, sigma = 0.0;
  std::vector<double> of_ranks;  ///< R_j
  double squared_ranks = 0.0;    ///< A
  double squared_sums = 0.0;     ///< sum of R_j^2

  /// (sigma A - sum R_j^2): sigma times what scenarios disagree about. All terms are multiples of 1/4, so it is exact.
  [[nodiscard]] double disagreement() const { return sigma * squared_ranks - squared_sums; }
  [[nodiscard]] double freedom() const { return (sigma - 1.0) * (mu - 1.0); }
};

Sums sums_of(const Scores& ranks, double alpha) {
  check_alpha(alpha);
  if (ranks.size() < 2 || ranks.front().size() < 2)
    throw std::invalid_argument("a comparison by ranks needs at least 2 algorithms and 2 scenarios");
  check_shape(ranks);
  Sums sums;
  sums.mu = static_cast<double>(ranks.size());
  sums.sigma = static_cast<double>(ranks.front().size());
  sums.of_ranks = rank_sums(ranks);
  for (const auto& row : ranks) sums.squared_ranks += std::inner_product(row.begin(), row.end(), row.begin(), 0.0);
  sums.squared_sums = std::inner_product(sums.of_ranks.begin(), sums.of_ranks.end(), sums.of_ranks.begin(), 0.0);
  return sums;
}

/// The ranks of one scenario.
std::vector<double> ranks_of(const std::vector<double>& scores) {
  const auto before = [&](std::size_t a, std::size_t b) {
    if (std::isnan(scores[a]) || std::isnan(scores[b])) return !std::isnan(scores[a]) && std::isnan(scores[b]);
    return scores[a] < scores[b];
  };
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), before);
  std::vector<double> ranks(scores.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && !before(order[first], order[end])) ++end;
    const double shared = static_cast<double>(first + 1 + end) / 2.0;  // mean of first + 1 ... end
    for (; first < end; ++first) ranks[order[first]] = shared;
  }
  return ranks;
}

double two_sided_p(double difference, double error, double freedom) {
  if (difference == 0.0) return 1.0;
  if (error == 0.0) return 0.0;
  const boost::math::students_t t(freedom);
  return 2.0 * boost::math::cdf(boost::math::complement(t, std::abs(difference) / error));
}

}  // namespace

Scores friedman_ranks(const Scores& scores) {
  if (scores.empty()) return {};
  check_shape(scores);
  Scores ranks(scores.size(), std::vector<double>(scores.front().size()));
  std::vector<double> column(scores.size());
  for (std::size_t s = 0; s < scores.front().size(); ++s) {
    for (std::size_t a = 0; a < scores.size(); ++a) column[a] = scores[a][s];
    const std::vector<double> ranked = ranks_of(column);
    for (std::size_t a = 0; a < scores.size(); ++a) ranks[a][s] = ranked[a];
  }
  return ranks;
}

std::vector<double> rank_sums(const Scores& ranks) {
  std::vector<double> sums;
  for (const auto& row : ranks) sums.push_back(std::accumulate(row.begin(), row.end(), 0.0));
  return sums;
}

Friedman friedman(const Scores& ranks, double alpha) {
  const Sums sums = sums_of(ranks, alpha);
  Friedman result;
  result.algorithms = static_cast<int>(sums.mu);
  result.scenarios = static_cast<int>(sums.sigma);
  const boost::math::fisher_f f(sums.mu - 1.0, sums.freedom());
  result.critical_f = boost::math::quantile(boost::math::complement(f, alpha));
  // Conover (1999), section 5.8: the squares about the mean rank, among algorithms and in all.
  const double correction = sums.sigma * sums.mu * (sums.mu + 1.0) * (sums.mu + 1.0) / 4.0;
  const double total = sums.squared_ranks - correction;
  if (total <= 0.0) return result;  // all tied
  const double among = sums.squared_sums / sums.sigma - correction;
  result.chi_square = (sums.mu - 1.0) * sums.sigma * among / total;
  result.p = boost::math::cdf(boost::math::complement(boost::math::chi_squared(sums.mu - 1.0), result.chi_square));
  const double rest = sums.disagreement() / sums.sigma;
  result.iman_davenport = rest <= 0.0 ? std::numeric_limits<double>::infinity() : (sums.sigma - 1.0) * among / rest;
  result.iman_p = rest <= 0.0 ? 0.0 : boost::math::cdf(boost::math::complement(f, result.iman_davenport));
  result.rejected = result.iman_davenport > result.critical_f;
  return result;
}

Lsd fisher_lsd(const Scores& ranks, double alpha) {
  const Sums sums = sums_of(ranks, alpha);
  const double error = std::sqrt(2.0 * std::max(0.0, sums.disagreement()) / sums.freedom());
  const boost::math::students_t t(sums.freedom());
  Lsd result;
  result.critical = error * boost::math::quantile(boost::math::complement(t, alpha));
  result.critical_two_sided = error * boost::math::quantile(boost::math::complement(t, alpha / 2.0));
  std::vector<double> p;
  for (std::size_t a = 0; a < ranks.size(); ++a) {
    for (std::size_t b = a + 1; b < ranks.size(); ++b) {
      Comparison pair;
      pair.a = static_cast<int>(a);
      pair.b = static_cast<int>(b);
      pair.difference = sums.of_ranks[a] - sums.of_ranks[b];
      pair.lsd = std::abs(pair.difference) > result.critical;
      pair.p = two_sided_p(pair.difference, error, sums.freedom());
      p.push_back(pair.p);
      result.pairs.push_back(pair);
    }
  }
  const std::vector<double> adjusted = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    result.pairs[i].p_holm = adjusted[i];
    result.pairs[i].holm = adjusted[i] <= alpha;
  }
  return result;
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - k) * p[order[k]]));
    adjusted[order[k]] = largest;
  }
  return adjusted;
}

}  // namespace jink::tools::lab::statistics
