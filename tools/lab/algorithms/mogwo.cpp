// SPDX-License-Identifier: BSD-3-Clause
// MOGWO, the multi-objective grey wolf optimizer: S. Mirjalili, S. Saremi, S. M. Mirjalili and L. dos S. Coelho, Expert
// Systems with Applications 47, 2016, DOI 10.1016/j.eswa.2015.10.039. Equations are those of that paper.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "tools/lab/algorithms/comparators.hpp"
#include "tools/lab/algorithms/grid_repository.hpp"
#include "tools/lab/algorithms/swarm.hpp"

namespace jink::tools::lab::algorithms {
namespace {

/// Parameters of [Paper] section 5.5.
constexpr GridSettings kWolfGrid{
    .inflation = 0.1, .cells = 10, .leader = 4, .deletion = 2, .pressure = Pressure::kPower};

/// Each wolf goes to the mean of three places, each about a leader from a sparse part of the repository.
///
/// As published, the distance |C·leader − x| with C in [0, 2] depends on where the origin is: solutions near 0 are
/// found more easily than others. The optima of ZDT1-3 lie at 0 but for one variable, and so does straight flight in
/// [Paper] problem (16), whose variables are offsets from it.
class Mogwo final : public Swarm {
 public:
  Mogwo(const planner::base::OptimizerSettings& settings, int dimension, int objectives)
      : Swarm(settings, dimension, objectives),
        repository_(kWolfGrid, static_cast<std::size_t>(settings.archive), dimension, objectives) {}

 protected:
  void begin() override { repository_.clear(); }

  void learn() override {
    for (std::size_t i = 0; i < individuals(); ++i) repository_.add(individual(i), cost(i));
    repository_.settle(random());
  }

  void move(double fraction) override {
    const double a = 2.0 * (1.0 - fraction);
    for (std::size_t i = 0; i < individuals(); ++i) {
      const std::array<std::size_t, 3> leaders = draw_leaders();
      const auto wolf = individual(i);
      for (std::size_t j = 0; j < wolf.size(); ++j) {
        double sum = 0.0;
        for (const std::size_t number : leaders) {
          const double leader = repository_.members().x(number)[j];
          const auto [r1, r2] = random().uniform_pair();
          const double distance = std::abs(2.0 * r2 * leader - wolf[j]);  // Eq. (1), (4)
          sum += leader - a * (2.0 * r1 - 1.0) * distance;                // Eq. (2), (3)
        }
        wolf[j] = sum / static_cast<double>(leaders.size());
      }
    }
  }

  [[nodiscard]] const Repository& repository() const override { return repository_.members(); }

 private:
  /// Delta, beta and alpha: different ones as far as there are so many members.
  std::array<std::size_t, 3> draw_leaders() {
    std::array<std::size_t, 3> leaders{};
    for (std::size_t k = 0; k < leaders.size(); ++k) {
      const std::size_t excluded = std::min(k, repository_.members().size() - 1);
      leaders[k] = repository_.draw(random(), std::span(leaders).first(excluded));
    }
    return leaders;
  }

  GridRepository repository_;
};

}  // namespace

std::unique_ptr<planner::optimizer::Optimizer> make_mogwo(const planner::base::OptimizerSettings& settings,
                                                          int dimension, int objectives) {
  return std::make_unique<Mogwo>(settings, dimension, objectives);
}

}  // namespace jink::tools::lab::algorithms
