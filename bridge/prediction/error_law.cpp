// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/error_law.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/base/portable_math.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr double kFirst = 0.1;        // deviations, the innermost shell's outer radius
constexpr double kGrowth = 1.25;      // of the radii, from shell to shell
constexpr double kAssumed = 40.0;     // movers seen, that what is assumed counts for
constexpr double kMostSeen = 5000.0;  // from which on the oldest count less and less
constexpr double kScale = 0.68;       // of the heavy-tailed law
constexpr int kPieces = 8;            // of a shell, that densities are summed over

using Radii = std::array<double, ErrorLaw::kShells>;

constexpr Radii outer_radii() {
  Radii radii{};
  double radius = kFirst;
  for (double& outer : radii) outer = std::exchange(radius, kGrowth * radius);
  return radii;
}
constexpr Radii kOuter = outer_radii();
const ErrorLaw kNow = ErrorLaw::normal();

/// Share of a sphere of radius s that is within `radius` of a point `distance` from its centre.
double share_within(double s, double distance, double radius) {
  if (s + distance <= radius) return 1.0;
  if (std::abs(distance - s) >= radius) return 0.0;
  return std::clamp((radius * radius - (distance - s) * (distance - s)) / (4.0 * distance * s), 0.0, 1.0);
}

}  // namespace

// By Simpson's rule, which is plain arithmetic: the same bits on every machine.
template <typename Density>
ErrorLaw ErrorLaw::of(Density density) {
  ErrorLaw law;
  double inner = 0.0;
  for (std::size_t i = 0; i < kShells; ++i) {
    const double step = (kOuter[i] - inner) / (2.0 * kPieces);
    for (int n = 0; n < kPieces; ++n) {
      const double from = inner + 2.0 * n * step;
      law.seen_[i] += step / 3.0 * (density(from) + 4.0 * density(from + step) + density(from + 2.0 * step));
    }
    law.all_ += law.seen_[i];
    inner = kOuter[i];
  }
  for (double& seen : law.seen_) seen *= kAssumed / law.all_;
  law.all_ = kAssumed;
  return law;
}

ErrorLaw ErrorLaw::normal() {
  return of([](double u) { return u * u * planner::base::exponential(-0.5 * u * u); });
}

ErrorLaw ErrorLaw::heavy_tailed() {
  return of([](double u) {
    const double one = 1.0 + u * u / (3.0 * kScale * kScale);
    return u * u / (one * one * one);
  });
}

// Noise is part of what was measured: of its mean square where the error is large beside it, else of what is stated.
void ErrorLaw::saw(double error, double sigma, double noise) {
  const double alone = std::sqrt(std::max(0.0, error * error - 3.0 * noise * noise)) / sigma;
  const double deviations = std::max(alone, error / planner::base::hypotenuse(sigma, noise));
  const auto shell = std::lower_bound(kOuter.begin(), kOuter.end() - 1, deviations);
  seen_[static_cast<std::size_t>(shell - kOuter.begin())] += 1.0;
  all_ += 1.0;
  if (all_ < kMostSeen) return;
  for (double& seen : seen_) seen *= 0.5;
  all_ *= 0.5;
}

double ErrorLaw::region(double probability) const {
  const double wanted = probability * all_;
  double within = 0.0;
  double inner = 0.0;
  for (std::size_t i = 0; i < kShells; ++i) {
    if (within + seen_[i] >= wanted) return inner + (wanted - within) / seen_[i] * (kOuter[i] - inner);
    within += seen_[i];
    inner = kOuter[i];
  }
  return inner;
}

double ErrorLaw::contact_probability(double distance, double radius, double sigma) const {
  if (radius <= 0.0) return 0.0;
  if (!(sigma > 1e-9)) return distance < radius ? 1.0 : 0.0;
  double within = 0.0;
  double inner = distance < radius ? 1.0 : 0.0;
  for (std::size_t i = 0; i < kShells; ++i) {
    const double outer = share_within(kOuter[i] * sigma, distance, radius);
    within += seen_[i] * 0.5 * (inner + outer);
    inner = outer;
  }
  return std::clamp(within / all_, 0.0, 1.0);
}

const ErrorLaw& ErrorLaws::at(double ahead) const {
  if (ahead < 0.5 * kLeads[0]) return kNow;
  std::size_t nearest = 0;
  while (nearest + 1 < kLeads.size() && ahead > 0.5 * (kLeads[nearest] + kLeads[nearest + 1])) ++nearest;
  return laws_[nearest];
}

}  // namespace jink::bridge::prediction
