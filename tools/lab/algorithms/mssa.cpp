// SPDX-License-Identifier: BSD-3-Clause
// MSSA, the multi-objective salp swarm algorithm: S. Mirjalili, A. H. Gandomi, S. Z. Mirjalili, S. Saremi, H. Faris and
// S. M. Mirjalili, Advances in Engineering Software 114, 2017, DOI 10.1016/j.advengsoft.2017.07.002. Equations are
// those of that paper.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "planner/base/portable_math.hpp"
#include "tools/lab/algorithms/comparators.hpp"
#include "tools/lab/algorithms/swarm.hpp"

namespace jink::tools::lab::algorithms {
namespace {

/// Free of parameters. A chain of salps: the first half (as in the authors' code; the paper's text has one) moves about
/// a food source, the others follow the one before them. The food source comes from where the repository is sparse.
///
/// Eq. (3.1) is as printed but for the threshold of c3, which is 0.5 as in the authors' code (printed 0, which would
/// leave one branch). Its step c1·((ub − lb)·c2 + lb) depends on where the origin is: it goes both ways evenly only
/// where lb = −ub or lb = 0.
class Mssa final : public Swarm {
 public:
  Mssa(const planner::base::OptimizerSettings& settings, int dimension, int objectives)
      : Swarm(settings, dimension, objectives),
        capacity_(static_cast<std::size_t>(settings.archive)),
        repository_(dimension, objectives) {}

 protected:
  void begin() override { repository_.clear(); }

  void learn() override {
    for (std::size_t i = 0; i < individuals(); ++i) repository_.add(individual(i), cost(i));
    count_neighbours();
    while (repository_.size() > capacity_) {
      const std::size_t goes = roulette(neighbours_, random());
      repository_.remove(goes);
      neighbours_.erase(neighbours_.begin() + static_cast<std::ptrdiff_t>(goes));
    }
    count_neighbours();
  }

  void move(double fraction) override {
    weights_.clear();
    for (const double neighbours : neighbours_) weights_.push_back(1.0 / neighbours);
    const auto food = repository_.x(roulette(weights_, random()));
    const double reach = 2.0 * planner::base::exponential(-16.0 * fraction * fraction);  // c1, Eq. (3.2)
    const std::size_t leaders = std::max<std::size_t>(1, individuals() / 2);
    for (std::size_t i = 0; i < individuals(); ++i) {
      const auto salp = individual(i);
      for (std::size_t j = 0; j < salp.size(); ++j) {
        if (i < leaders) {
          const double step = reach * ((upper()[j] - lower()[j]) * random().uniform() + lower()[j]);
          salp[j] = random().uniform() < 0.5 ? food[j] + step : food[j] - step;  // Eq. (3.1)
        } else {
          salp[j] = 0.5 * (salp[j] + individual(i - 1)[j]);  // Eq. (3.4)
        }
      }
    }
  }

  [[nodiscard]] const Repository& repository() const override { return repository_; }

 private:
  /// How many members are no further away than the extent over the capacity in every objective, oneself included.
  void count_neighbours() {
    const auto costs = repository_.costs();
    const auto objectives = static_cast<std::size_t>(repository_.objectives());
    std::array<double, planner::optimizer::kMaxObjectives> near{};
    for (std::size_t k = 0; k < objectives; ++k) {
      const auto [least, most] = std::minmax_element(costs.begin(), costs.end(),
                                                     [&](const auto& a, const auto& b) { return a.f[k] < b.f[k]; });
      near[k] = (most->f[k] - least->f[k]) / static_cast<double>(capacity_);
    }
    neighbours_.assign(costs.size(), 0.0);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      for (const planner::optimizer::Cost& other : costs) {
        bool inside = true;
        for (std::size_t k = 0; k < objectives; ++k) inside &= std::abs(other.f[k] - costs[i].f[k]) <= near[k];
        neighbours_[i] += inside ? 1.0 : 0.0;
      }
    }
  }

  std::size_t capacity_;
  Repository repository_;
  std::vector<double> neighbours_;  // of each member
  std::vector<double> weights_;
};

}  // namespace

std::unique_ptr<planner::optimizer::Optimizer> make_mssa(const planner::base::OptimizerSettings& settings,
                                                         int dimension, int objectives) {
  return std::make_unique<Mssa>(settings, dimension, objectives);
}

}  // namespace jink::tools::lab::algorithms
