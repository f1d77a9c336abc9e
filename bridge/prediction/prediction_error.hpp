// SPDX-License-Identifier: BSD-3-Clause
// How far a track strays from what is predicted of it, as its own past shows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "bridge/prediction/error_law.hpp"
#include "bridge/prediction/learned_motion.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::prediction {

/// Where an obstacle will be, to the best of what is known, and how well that is known.
struct Prediction {
  std::uint64_t id = 0;                                                       ///< the track's
  std::variant<planner::base::Track, HarmonicMotion, BouncingMotion> motion;  ///< valid at time 0
  double radius = 0.0;                                                        ///< m
  double position_sigma = 0.0;      ///< standard deviation of the position, per axis, m
  double velocity_sigma = 0.0;      ///< and of the velocity, m/s
  double acceleration_sigma = 0.0;  ///< and of a constant acceleration besides, m/s²
  bool watched = true;              ///< long enough to know that better than what is assumed of what is new
  double age = 0.0;                 ///< s, before time 0, that the sigmas are of
  double trust = 0.0;               ///< s, of a track's acceleration
  planner::base::Body body{};       ///< in the sphere, at time 0

  [[nodiscard]] Vec3 position(double t) const;
  /// Standard deviation of the position after t seconds, per axis, m.
  [[nodiscard]] double sigma(double t) const;
};

/// What a flight has taught of predictions, by their kind: Prediction::motion.index().
using LawsByKind = std::array<ErrorLaws, std::variant_size_v<decltype(Prediction::motion)>>;

/// Learns Prediction::acceleration_sigma of one track: what was predicted is kept for a second and held against what
/// was measured then, as an acceleration that was not foreseen. It is kept until it has been held against what came at
/// the last of ErrorLaws::kLeads too, which teaches the laws. Of a new track nothing is known but that it may stop or
/// turn (kTurning). A swing that has just been learned is as doubtful as what was predicted before, until it has shown
/// for half a second that it is better. Not thread-safe; O(kMost) for each measurement, allocates nothing.
class PredictionError {
 public:
  static constexpr double kTurning = 0.7;  ///< s, in which a new track may have lost its velocity

  /// What was measured at t, with its sigma, and what is predicted since, from predicted.age later on.
  void observe(double t, const planner::base::Track& measured, const Prediction& predicted, LawsByKind& laws);
  [[nodiscard]] double acceleration_sigma() const;
  /// By how much the velocity of what is measured exactly has been another than predicted at most, on average over
  /// HorizonSettings::kReaction, m/s. 0 where it is measured with noise.
  [[nodiscard]] double sudden_change() const { return sudden_change_; }
  /// What was seen has more weight in that than what is assumed of a new track.
  [[nodiscard]] bool watched() const;

 private:
  static constexpr std::size_t kMost = 24;
  struct Kept {
    double t = 0.0;  // the prediction's time 0
    Prediction prediction;
    std::size_t judged = 0;      // at how many of the leads
    Vec3 errors = Vec3::Zero();  // about the next of them: their sum, m,
    double measurements = 0.0;   // and number
  };
  void judge(double t, const planner::base::Track& measured, LawsByKind& laws);

  std::array<Kept, kMost> kept_;  // the newest first
  std::size_t size_ = 0;
  std::size_t alike_ = 0;  // of them, that swing or do not, as what was predicted last
  bool begun_ = false;
  bool swings_ = false;                  // what was predicted last
  double errors_ = 0.0, weights_ = 0.0;  // (m/s²)², in units of the lead's fourth power
  double last_ = 0.0;
  double sudden_change_ = 0.0;
};

}  // namespace jink::bridge::prediction
