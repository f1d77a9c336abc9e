// SPDX-License-Identifier: BSD-3-Clause
// For the tests of optimizers: problems whose fronts are known, and how good a front is.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "planner/optimizer/indicators.hpp"
#include "planner/optimizer/problem.hpp"

namespace jink::testing_support {

using planner::optimizer::Cost;
using planner::optimizer::Point2;

inline Cost cost(double f1, double f2, double violation = 0.0) {
  return {{f1, f2, 0.0}, violation};
}

/// Another problem, and what it was asked for, batch by batch. Not for several threads.
class Recorded final : public planner::optimizer::Problem {
 public:
  explicit Recorded(const planner::optimizer::Problem& problem) : problem_(problem) {}
  [[nodiscard]] int dimension() const override { return problem_.dimension(); }
  [[nodiscard]] int objectives() const override { return problem_.objectives(); }
  [[nodiscard]] std::span<const double> lower() const override { return problem_.lower(); }
  [[nodiscard]] std::span<const double> upper() const override { return problem_.upper(); }
  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    batches.emplace_back(x.begin(), x.end());
    problem_.evaluate(x, costs);
  }
  mutable std::vector<std::vector<double>> batches;

 private:
  const planner::optimizer::Problem& problem_;
};

/// ZDT1 to ZDT3: E. Zitzler, K. Deb and L. Thiele, Evolutionary Computation 8(2), 2000. Two objectives, variables in
/// [0, 1]; the fronts are where all variables but the first are 0. Fails the test where it is asked outside its box.
class Zdt final : public planner::optimizer::Problem {
 public:
  /// `number` 1 to 3. `shift` moves the box and the front with it: variables in [shift, shift + 1].
  explicit Zdt(int number, int dimension = 30, double shift = 0.0)
      : number_(number),
        shift_(shift),
        lower_(static_cast<std::size_t>(dimension), shift),
        upper_(static_cast<std::size_t>(dimension), shift + 1.0) {}

  [[nodiscard]] int dimension() const override { return static_cast<int>(lower_.size()); }
  [[nodiscard]] int objectives() const override { return 2; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }

  void evaluate(std::span<const double> x, std::span<Cost> costs) const override {
    const std::size_t d = lower_.size();
    for (std::size_t i = 0; i < costs.size(); ++i) {
      double sum = 0.0;
      bool inside = true;
      for (std::size_t j = 0; j < d; ++j) {
        const double value = x[i * d + j] - shift_;
        inside = inside && value >= -kRounding && value <= 1.0 + kRounding;
        if (j > 0) sum += value;
      }
      EXPECT_TRUE(inside);
      const double f1 = x[i * d] - shift_;
      const double g = 1.0 + 9.0 * sum / (static_cast<double>(d) - 1.0);
      costs[i] = {{f1, g * shape(f1, g), 0.0}, 0.0};
    }
  }

  /// The second objective over g.
  [[nodiscard]] double shape(double f1, double g) const {
    const double ratio = f1 / g;
    if (number_ == 1) return 1.0 - std::sqrt(ratio);
    if (number_ == 2) return 1.0 - ratio * ratio;
    return 1.0 - std::sqrt(ratio) - ratio * std::sin(10.0 * std::numbers::pi * f1);
  }

  /// Points of the true front, densely.
  [[nodiscard]] std::vector<Point2> front() const {
    constexpr int kPoints = 2000;
    std::vector<Point2> points;
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kPoints; ++i) {
      const double f1 = static_cast<double>(i) / kPoints;
      const double f2 = shape(f1, 1.0);
      if (f2 >= lowest) continue;  // ZDT3: dominated
      lowest = f2;
      points.push_back({f1, f2});
    }
    return points;
  }

 private:
  static constexpr double kRounding = 1e-12;

  int number_;
  double shift_;
  std::vector<double> lower_, upper_;
};

/// Hypervolume of the first two objectives.
inline double volume_of(std::span<const Cost> costs, const Point2& reference = {1.1, 1.1}) {
  std::vector<Point2> points;
  for (const Cost& c : costs) points.push_back({c.f[0], c.f[1]});
  return planner::optimizer::hypervolume(points, reference);
}

}  // namespace jink::testing_support
