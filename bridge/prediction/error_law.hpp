// SPDX-License-Identifier: BSD-3-Clause
// How likely a mover is how far from where it was predicted.
#pragma once

#include <array>
#include <cstddef>

namespace jink::bridge::prediction {

/// The distribution of |error| / stated standard deviation, of equal probability in every direction. Errors are not
/// normal: mostly small, as nearly all go on as before, and at times large, as somebody turns. In shells about the
/// predicted place, each a quarter wider than the one before.
class ErrorLaw {
 public:
  static constexpr std::size_t kShells = 26;

  /// That of three independent normal errors.
  static ErrorLaw normal();
  /// That of Student's multivariate t distribution with three degrees of freedom, times kScale: nearly that of all
  /// movers of docs/prediction.md together.
  static ErrorLaw heavy_tailed();

  /// One more was measured to be so far away where `sigma` was stated; the measurement's own standard deviation per
  /// axis is `noise`. All in m.
  void saw(double error, double sigma, double noise);
  /// Deviations within which a mover is with that probability.
  [[nodiscard]] double region(double probability) const;
  /// Probability that a mover, predicted `distance` away with that standard deviation per axis, is within `radius`; 0
  /// or 1 where that deviation is 0. All in m. O(kShells).
  [[nodiscard]] double contact_probability(double distance, double radius, double sigma) const;

 private:
  template <typename Density>
  static ErrorLaw of(Density density);  // by the radius, in whatever unit

  std::array<double, kShells> seen_{};
  double all_ = 0.0;
};

/// What a flight has taught of one kind of prediction, by how far ahead. Begins as ErrorLaw::heavy_tailed().
class ErrorLaws {
 public:
  static constexpr std::array kLeads = {0.5, 1.0, 2.0};  ///< s, at which predictions are held against what came

  ErrorLaws() { laws_.fill(ErrorLaw::heavy_tailed()); }
  void saw(std::size_t lead, double error, double sigma, double noise) { laws_[lead].saw(error, sigma, noise); }
  /// The law of the nearest of the leads; normal where now is nearer.
  [[nodiscard]] const ErrorLaw& at(double ahead) const;

 private:
  std::array<ErrorLaw, kLeads.size()> laws_;
};

}  // namespace jink::bridge::prediction
