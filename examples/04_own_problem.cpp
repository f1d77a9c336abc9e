// SPDX-License-Identifier: BSD-3-Clause
// A problem of your own for PMOMVO, the optimizer: any box of real variables, up to three objectives, and constraints.
// This is Binh and Korn's (1997), whose front is known: two variables, two objectives, two constraints.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <span>
#include <vector>

#include "planner/optimizer/pmomvo.hpp"
#include "planner/optimizer/topsis.hpp"

using namespace jink::planner;

namespace {

class BinhKorn final : public optimizer::Problem {
 public:
  [[nodiscard]] int dimension() const override { return 2; }
  [[nodiscard]] int objectives() const override { return 2; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }

  // Called by several threads at once: it changes nothing of its own, and takes no memory.
  void evaluate(std::span<const double> x, std::span<optimizer::Cost> costs) const override {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const double a = x[2 * i];
      const double b = x[2 * i + 1];
      costs[i].f[0] = 4 * (a * a + b * b);
      costs[i].f[1] = (a - 5) * (a - 5) + (b - 5) * (b - 5);
      costs[i].violation =
          std::max(0.0, (a - 5) * (a - 5) + b * b - 25) + std::max(0.0, 7.7 - (a - 8) * (a - 8) - (b + 3) * (b + 3));
    }
  }

 private:
  std::array<double, 2> lower_{0, 0};
  std::array<double, 2> upper_{5, 3};
};

/// The least second objective where the first is f1: along a = b up to 3, then along b = 3.
double known_front(double f1) {
  const double a = f1 <= 72 ? std::sqrt(f1 / 8) : std::sqrt(f1 / 4 - 9);
  const double b = std::min(a, 3.0);
  return (a - 5) * (a - 5) + (b - 5) * (b - 5);
}

}  // namespace

int main() {
  const BinhKorn problem;
  base::OptimizerSettings settings;
  settings.slaves = 2;
  settings.iterations = 200;
  optimizer::Pmomvo pmomvo(settings, problem.dimension(), problem.objectives());
  base::WorkerPool pool;
  const optimizer::Front& front = pmomvo.run(problem, {}, 1, 0, {settings.iterations}, pool);

  std::vector<optimizer::Cost> costs = front.costs;
  std::sort(costs.begin(), costs.end(), [](const auto& one, const auto& other) { return one.f[0] < other.f[0]; });
  double above = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (costs[i].violation > 0) return 1;
    above += (costs[i].f[1] - known_front(costs[i].f[0])) / static_cast<double>(costs.size());
    if (i % 20 == 0) std::printf("%7.2f %7.2f\n", costs[i].f[0], costs[i].f[1]);
  }
  const std::span<const double> best =
      front.solution(static_cast<std::size_t>(optimizer::topsis_order(front.costs, problem.objectives()).front()));
  std::printf("%zu solutions, on average %.3f above the known front; a compromise: a = %.2f, b = %.2f\n", front.size(),
              above, best[0], best[1]);
  return front.size() > 100 && above < 0.1 ? 0 : 1;
}
