// SPDX-License-Identifier: BSD-3-Clause
// MOPSO: C. A. Coello Coello, G. T. Pulido and M. S. Lechuga, IEEE Transactions on Evolutionary Computation 8(3), 2004,
// DOI 10.1109/TEVC.2004.826067, with the repository of the code that circulates (Yarpiz 2015).
#include <algorithm>
#include <memory>
#include <vector>

#include "tools/lab/algorithms/comparators.hpp"
#include "tools/lab/algorithms/grid_repository.hpp"
#include "tools/lab/algorithms/swarm.hpp"

namespace jink::tools::lab::algorithms {
namespace {

/// Parameters of [Paper] section 5.5 as printed there (leader pressure 2); the deletion pressure, which it does not
/// give, is that of the circulating code.
constexpr GridSettings kSwarmGrid{
    .inflation = 0.1, .cells = 7, .leader = 2, .deletion = 2, .pressure = Pressure::kExponential};
constexpr double kCognitive = 2.0;  // c1, [Paper] section 5.5
constexpr double kSocial = 2.0;     // c2
constexpr double kInertia = 0.4;    // not given in [Paper]; Coello Coello et al., and stable with c1 = c2 = 2
constexpr int kMutationFall = 10;   // 5 over the mutation rate of 0.5 of Coello Coello et al.

/// Particles with a velocity and a best place, each after its own leader from a sparse part of the repository. A
/// particle that leaves the box stays on its face and turns round. Mutation as in the 2004 paper: a share of the
/// particles that falls from all to none, (1 − t)^10, has one variable drawn again from a range that falls likewise.
/// differs from the circulating code, which evaluates mutants besides: here a mutant takes its particle's place, so
/// that a generation evaluates the population once.
class Mopso final : public Swarm {
 public:
  Mopso(const planner::base::OptimizerSettings& settings, int dimension, int objectives)
      : Swarm(settings, dimension, objectives),
        repository_(kSwarmGrid, static_cast<std::size_t>(settings.archive), dimension, objectives),
        objectives_(objectives) {}

 protected:
  void begin() override {
    repository_.clear();
    velocity_.assign(individuals() * lower().size(), 0.0);
    best_.clear();
    best_costs_.clear();
  }

  void learn() override {
    for (std::size_t i = 0; i < individuals(); ++i) repository_.add(individual(i), cost(i));
    repository_.settle(random());
    if (best_costs_.empty()) {
      for (std::size_t i = 0; i < individuals(); ++i) {
        best_costs_.push_back(cost(i));
        best_.insert(best_.end(), individual(i).begin(), individual(i).end());
      }
      return;
    }
    for (std::size_t i = 0; i < individuals(); ++i) {
      if (!better(cost(i), best_costs_[i])) continue;
      best_costs_[i] = cost(i);
      std::copy(individual(i).begin(), individual(i).end(), best(i).begin());
    }
  }

  void move(double fraction) override {
    double share = 1.0;
    for (int k = 0; k < kMutationFall; ++k) share *= 1.0 - fraction;
    for (std::size_t i = 0; i < individuals(); ++i) {
      fly(i);
      if (random().uniform() < share) mutate(individual(i), share);
    }
  }

  [[nodiscard]] const Repository& repository() const override { return repository_.members(); }

 private:
  [[nodiscard]] std::span<double> best(std::size_t i) { return {best_.data() + i * lower().size(), lower().size()}; }

  /// Whether a particle's new place is its best from now on: where neither dominates, a coin decides.
  bool better(const planner::optimizer::Cost& now, const planner::optimizer::Cost& before) {
    if (planner::optimizer::dominates(now, before, objectives_)) return true;
    if (planner::optimizer::dominates(before, now, objectives_)) return false;
    return random().uniform() < 0.5;
  }

  void fly(std::size_t i) {
    const auto leader = repository_.members().x(repository_.draw(random()));
    const auto x = individual(i);
    const auto own = best(i);
    for (std::size_t j = 0; j < x.size(); ++j) {
      double& v = velocity_[i * x.size() + j];
      const auto [r1, r2] = random().uniform_pair();
      v = kInertia * v + kCognitive * r1 * (own[j] - x[j]) + kSocial * r2 * (leader[j] - x[j]);
      x[j] += v;
      if (x[j] >= lower()[j] && x[j] <= upper()[j]) continue;
      x[j] = std::clamp(x[j], lower()[j], upper()[j]);
      v = -v;
    }
  }

  void mutate(std::span<double> x, double share) {
    const std::size_t j = random().below(x.size());
    const double range = share * (upper()[j] - lower()[j]);
    x[j] = random().uniform(std::max(lower()[j], x[j] - range), std::min(upper()[j], x[j] + range));
  }

  GridRepository repository_;
  int objectives_;
  std::vector<double> velocity_;  // of each particle and variable, per generation
  std::vector<double> best_;
  std::vector<planner::optimizer::Cost> best_costs_;
};

}  // namespace

std::unique_ptr<planner::optimizer::Optimizer> make_mopso(const planner::base::OptimizerSettings& settings,
                                                          int dimension, int objectives) {
  return std::make_unique<Mopso>(settings, dimension, objectives);
}

}  // namespace jink::tools::lab::algorithms
