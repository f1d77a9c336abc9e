// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/harmonic_fit.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "planner/base/portable_math.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr int kTerms = HarmonicMotion::kTerms;
using Normal = Eigen::Matrix<double, kTerms, kTerms>;
using Terms = Eigen::Matrix<double, kTerms, 3>;
using Row = Eigen::Matrix<double, kTerms, 1>;

constexpr double kSlowest = 0.1;    // rad/s
constexpr double kFastest = 6.0;    // rad/s
constexpr int kSearched = 40;       // frequencies, evenly in their logarithm
constexpr int kRefinements = 6;     // halvings of the distance between two of them
constexpr double kAmplitude = 4.0;  // m, standard deviation of the first harmonic's terms; of the others less
constexpr double kCentre = 30.0;    // m, of the centre about the last position

struct Weights {
  double position = 0.0, velocity = 0.0;  ///< 1 / variance
};

struct Solution {
  Terms terms = Terms::Zero();
  double cost = planner::base::kInfinity;
};

/// The best terms for one frequency, times and positions counted from the last sample's.
Solution solve(std::span<const MotionSample> samples, const Weights& weights, double frequency) {
  Normal normal = Normal::Zero();
  normal(0, 0) = 1.0 / (kCentre * kCentre);
  for (int k = 1; k <= HarmonicMotion::kHarmonics; ++k) {
    const double spread = kAmplitude / k;
    normal(2 * k - 1, 2 * k - 1) = normal(2 * k, 2 * k) = 1.0 / (spread * spread);
  }
  Terms right = Terms::Zero();
  double total = 0.0;
  const MotionSample& last = samples.back();
  Row place;
  Row speed;
  place[0] = 1.0;
  speed[0] = 0.0;
  for (const MotionSample& sample : samples) {
    const auto [sine, cosine] = planner::base::sine_cosine(frequency * (sample.t - last.t));
    double c = 1.0;
    double s = 0.0;
    for (int k = 1; k <= HarmonicMotion::kHarmonics; ++k) {
      const double next = c * cosine - s * sine;
      s = s * cosine + c * sine;
      c = next;
      place[2 * k - 1] = c;
      place[2 * k] = s;
      speed[2 * k - 1] = -k * frequency * s;
      speed[2 * k] = k * frequency * c;
    }
    const Vec3 position = sample.position - last.position;
    const double at = sample.measurements * weights.position;
    const double by = sample.measurements * weights.velocity;
    normal += place * (at * place).transpose() + speed * (by * speed).transpose();
    right += at * place * position.transpose() + by * speed * sample.velocity.transpose();
    total += at * position.squaredNorm() + by * sample.velocity.squaredNorm();
  }
  const Eigen::LDLT<Normal> factors(normal);
  Solution solution;
  // Axis by axis: Eigen solves for all at once in blocks, whose sums depend on the processor.
  for (int axis = 0; axis < 3; ++axis) solution.terms.col(axis) = factors.solve(right.col(axis));
  const double cost = total - right.cwiseProduct(solution.terms).sum();
  if (solution.terms.allFinite()) solution.cost = std::max(0.0, cost);
  return solution;
}

}  // namespace

std::optional<HarmonicFit> fit_harmonics(std::span<const MotionSample> samples, double position_sigma,
                                         double velocity_sigma, double guess) {
  if (samples.size() < kFewestSamples) return std::nullopt;
  const Weights weights{1.0 / (position_sigma * position_sigma), 1.0 / (velocity_sigma * velocity_sigma)};
  const double ratio = std::pow(kFastest / kSlowest, 1.0 / (kSearched - 1));
  double best = guess;
  Solution solution;
  if (guess > 0.0) {
    solution = solve(samples, weights, guess);
  } else {
    double frequency = kSlowest;
    for (int n = 0; n < kSearched; ++n, frequency *= ratio) {
      const Solution tried = solve(samples, weights, frequency);
      if (tried.cost < solution.cost) {
        solution = tried;
        best = frequency;
      }
    }
  }
  double factor = guess > 0.0 ? std::sqrt(std::sqrt(ratio)) : std::sqrt(ratio);
  for (int n = 0; n < kRefinements; ++n, factor = std::sqrt(factor)) {
    for (const double frequency : {best / factor, best * factor}) {
      const Solution tried = solve(samples, weights, frequency);
      if (tried.cost < solution.cost) {
        solution = tried;
        best = frequency;
      }
    }
  }
  if (!(solution.cost < planner::base::kInfinity)) return std::nullopt;
  HarmonicFit fit;
  fit.motion.frequency = best;
  fit.motion.terms = solution.terms;
  fit.motion.terms.row(0) += samples.back().position.transpose();
  fit.misfit = std::sqrt(solution.cost / (6.0 * static_cast<double>(samples.size())));
  return fit;
}

}  // namespace jink::bridge::prediction
