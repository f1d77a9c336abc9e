// SPDX-License-Identifier: BSD-3-Clause
// The multiverse's schedule and moves, [Paper] Eq. (18)-(20), each for itself.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "planner/base/portable_math.hpp"
#include "planner/base/random.hpp"
#include "planner/base/settings.hpp"

namespace jink::planner::optimizer {

/// Wormhole existence probability, Eq. (19), at the fraction of the budget that is used, in [0, 1].
inline double wormhole_probability(double fraction, const base::OptimizerSettings& s) {
  return s.wep_min + fraction * (s.wep_max - s.wep_min);
}

/// Travelling distance rate: 1 at the start, 0 at the end. differs: Eq. (20) prints 1 − iter^(1/γ)/n_iter, which stays
/// near 1 to the end; this is 1 − (iter/n_iter)^(1/γ).
inline double travelling_distance(double fraction, const base::OptimizerSettings& s) {
  const auto root = [&](double x) { return x > 0.0 ? base::exponential(base::logarithm(x) / s.exploitation) : 0.0; };
  if (s.operators == base::Operators::kPrinted) return 1.0 - root(fraction * s.iterations) / s.iterations;
  return fraction < 1.0 ? 1.0 - root(fraction) : 0.0;
}

/// What the schedule says for one iteration.
struct Schedule {
  double wep = 0.0;  ///< wormhole existence probability
  double tdr = 0.0;  ///< travelling distance rate
};

/// The schedule where `fraction` in (0, 1] of the budget is used when the iteration ends.
inline Schedule schedule_at(double fraction, const base::OptimizerSettings& s) {
  return {wormhole_probability(fraction, s), travelling_distance(fraction, s)};
}

/// One component moved through a wormhole to the leader's value ± a step, Eq. (18); the result may lie outside the box.
/// - kCorrected, kAdaptive: leader ± tdr · (upper − lower) · r, + for half of the draws: drawn as one number in [-1,
/// 1).
/// - kPrinted: leader + tdr ± (upper − lower · r + lower). The paper gives both signs the same condition; each is taken
///   for half of the draws.
/// - kCommon: leader ± tdr · ((upper − lower) · r + lower), whose step depends on where the origin is.
inline double wormhole(double leader, double tdr, double lower, double upper, base::Operators operators,
                       base::RandomStream& random) {
  const double signed_r = 2.0 * random.uniform() - 1.0;
  if (operators == base::Operators::kCorrected || operators == base::Operators::kAdaptive) {
    return leader + tdr * (upper - lower) * signed_r;
  }
  const double side = signed_r < 0.0 ? -1.0 : 1.0;
  const double r = std::abs(signed_r);
  if (operators == base::Operators::kPrinted) return leader + tdr + side * (upper - lower * r + lower);
  return leader + side * tdr * ((upper - lower) * r + lower);
}

/// A narrow wormhole, of this project: leader + 2 · tdr · (upper − lower) · r³, r even in [-1, 1): most steps are
/// small, some go far.
inline double narrow_wormhole(double leader, double tdr, double lower, double upper, base::RandomStream& random) {
  const double r = 2.0 * random.uniform() - 1.0;
  return leader + 2.0 * tdr * (upper - lower) * (r * r * r);
}

/// How a universe has come to be where it is: by a kind of move of Operators::kAdaptive, or by none.
enum class Move : unsigned char {
  kWide,     ///< white holes and wormholes in every variable; what is drawn at the start counts as one
  kNarrow,   ///< narrow wormholes in a few variables, the others as the leader has them
  kReceived  ///< not moved: another population's solution
};

/// Draws kinds of move in proportion to how often their results enter the archive.
class MoveChoice {
 public:
  /// Counts one move of this kind: whether its result entered the archive. What was received counts for none.
  void judge(Move move, bool success) {
    if (move == Move::kReceived) return;
    tries_[index(move)] += 1.0;
    successes_[index(move)] += success ? 1.0 : 0.0;
  }
  /// Ends a generation: the past counts less from here on.
  void adapt() {
    const double wide = (successes_[0] + 1.0) / (tries_[0] + 2.0);
    const double narrow = (successes_[1] + 1.0) / (tries_[1] + 2.0);
    const double share = narrow / (wide + narrow);
    narrow_share_ = share < kLeast ? kLeast : (share > 1.0 - kLeast ? 1.0 - kLeast : share);
    for (std::size_t k = 0; k < 2; ++k) {
      tries_[k] *= kMemory;
      successes_[k] *= kMemory;
    }
  }
  /// A kind of move, kNarrow with probability narrow_share().
  Move draw(base::RandomStream& random) const { return random.uniform() < narrow_share_ ? Move::kNarrow : Move::kWide; }
  /// Probability of a narrow move, in [0.1, 0.9].
  [[nodiscard]] double narrow_share() const { return narrow_share_; }

 private:
  static constexpr double kLeast = 0.1;   // share that a kind keeps, so that its success can be seen
  static constexpr double kMemory = 0.8;  // of a generation's counts in the next
  static std::size_t index(Move move) { return move == Move::kNarrow ? 1 : 0; }

  std::array<double, 2> tries_{};
  std::array<double, 2> successes_{};
  double narrow_share_ = 0.5;
};

/// Position, in an order of n <= 2^31 from best to worst, of the universe that a black hole takes from: the better of
/// two drawn evenly, so that the weight falls linearly with the position, from 2n − 1 to 1.
inline std::size_t white_hole(std::size_t n, base::RandomStream& random) {
  const std::uint64_t bits = random.next();
  const std::uint64_t first = ((bits >> 32U) * n) >> 32U;
  const std::uint64_t second = ((bits & 0xffffffffU) * n) >> 32U;
  return first < second ? first : second;
}

}  // namespace jink::planner::optimizer
