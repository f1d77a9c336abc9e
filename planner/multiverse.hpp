// SPDX-License-Identifier: BSD-3-Clause
// The multiverse's schedule and moves, [Paper] Eq. (18)-(20), each for itself.
#pragma once

#include <cmath>

#include "planner/random.hpp"
#include "planner/settings.hpp"

namespace jink::planner {

/// Wormhole existence probability, Eq. (19), at the fraction of the budget that is used, in [0, 1].
inline double wormhole_probability(double fraction, const OptimizerSettings& s) {
  return s.wep_min + fraction * (s.wep_max - s.wep_min);
}

/// Travelling distance rate: 1 at the start, 0 at the end. differs: Eq. (20) prints 1 − iter^(1/γ)/n_iter, which stays
/// near 1 to the end; this is 1 − (iter/n_iter)^(1/γ).
inline double travelling_distance(double fraction, const OptimizerSettings& s) {
  return 1.0 - std::pow(fraction, 1.0 / s.exploitation);
}

/// One component moved through a wormhole to the leader's value ± a step, Eq. (18). differs: the printed form adds TDR
/// instead of multiplying, has the same condition on both branches, and a step that depends on where the origin is;
/// this is leader ± tdr · (upper − lower) · r, + for half of the draws. The result may lie outside the box.
inline double wormhole(double leader, double tdr, double lower, double upper, RandomStream& random) {
  const double side = random.uniform() < 0.5 ? 1.0 : -1.0;
  return leader + side * tdr * (upper - lower) * random.uniform();
}

/// Position, in an order from best to worst, of the universe that a black hole takes from: the weight falls linearly
/// with the position, from n to 1.
inline std::size_t white_hole(std::size_t n, RandomStream& random) {
  const auto count = static_cast<double>(n);
  const double total = 0.5 * count * (count + 1.0);
  const double remaining =
      total * (1.0 - random.uniform());  // weight from the drawn position to the end, in (0, total]
  const auto from_end = static_cast<std::size_t>(std::ceil(0.5 * (std::sqrt(1.0 + 8.0 * remaining) - 1.0)));
  return from_end >= n ? 0 : n - from_end;
}

}  // namespace jink::planner
