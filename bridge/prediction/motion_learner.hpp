// SPDX-License-Identifier: BSD-3-Clause
// Watches tracks for motions that a constant acceleration does not predict, and predicts those that prove predictable.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "bridge/prediction/harmonic_fit.hpp"
#include "bridge/prediction/learned_motion.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::prediction {

/// Where the surfaces of all tracks have been, and where they were thrown back. A bound is known when two different
/// tracks turned at it and none was ever beyond.
class LearnedBounds {
 public:
  /// That the track reached out so far from there, for sure: by less than its radius where noise may have put it there.
  void saw(const Vec3& position, double radius);
  void turned(std::uint64_t track, int axis, bool upper, double surface);
  /// For the centre of a sphere; unbounded where no bound is known.
  [[nodiscard]] planner::base::Box bounds(double radius) const;

 private:
  struct Side {
    double extent = -planner::base::kInfinity;  ///< along the outward direction
    double surface = -planner::base::kInfinity;
    std::uint64_t first = 0;
    bool any = false, confirmed = false;
  };
  std::array<std::array<Side, 2>, 3> sides_;  // axis; lower, upper
};

/// How often what was foreseen came true.
class PredictionRecord {
 public:
  /// The most that may be wrong of what plain prediction gives way to.
  static constexpr double kMostDoubt = 0.1;
  void note(bool came_true) { ++(came_true ? kept_ : broken_); }
  /// Probability that the next one does not: Laplace's rule of succession. 1/2 where nothing was foreseen yet.
  [[nodiscard]] double doubt() const { return (broken_ + 1.0) / (kept_ + broken_ + 2.0); }
  [[nodiscard]] bool good() const { return doubt() <= kMostDoubt; }

 private:
  int kept_ = 0, broken_ = 0;
};

/// What the tracks of a flight have taught together.
struct Experience {
  LearnedBounds bounds;
  PredictionRecord turns;   ///< at places where the same track turned before
  PredictionRecord swings;  ///< of fits that had proved right, one for each kLead seconds of a track
};

/// What one track did, and what follows from it. A learned motion is believed for as long as it keeps being clearly
/// better than plain prediction: each fit is held against what comes in the following kLead seconds, longer where both
/// do. A turn is foreseen where the track turned before or others did. What is foreseen is avoided besides plain
/// prediction; that gives way only where the flight's record is good, and not before the obstacle has had time to show
/// that it moves on as before: so something that is foreseen wrongly, one time in ten at most, is seen kLead before it
/// is where nothing was expected. What swings and has as good a record of its own, as after eight seconds as foreseen,
/// is avoided there alone: what turns more often than each kLead is passed by nobody else.
class MotionLearner {
 public:
  /// The newest measurement, as measured and as estimated, at its instant `t`. O(samples on trial).
  void observe(double t, const planner::base::Track& measured, const planner::base::Track& estimate, std::uint64_t name,
               Experience& all);

  /// When the next fit is due.
  [[nodiscard]] double fit_due() const { return next_fit_; }
  /// Makes a fit of what was observed; `measured` and `estimate` as in the last observe(). Tenths of a millisecond.
  void fit(double t, const planner::base::Track& measured, const planner::base::Track& estimate);

  /// What is known of the way from `now` on, or nothing. `estimate` is the newest estimate, of the instant `t`.
  [[nodiscard]] std::optional<Forecast> forecast(double now, double t, const planner::base::Track& estimate,
                                                 const Experience& all) const;

  /// Whether it is new, and not yet understood: plain prediction has been seen to fail or does not fit what is
  /// measured, and nothing else has proved right. Never longer than kLongestUnexplained.
  [[nodiscard]] bool unexplained(double t) const { return unexplained_ && t - first_ < kLongestUnexplained; }

  static constexpr double kLead = 1.0;                ///< s
  static constexpr double kLongestUnexplained = 2.0;  ///< s

 private:
  static constexpr std::size_t kMost = 64;  // samples
  /// A fit on trial.
  struct Trial {
    double begun = 0.0;
    HarmonicMotion motion;
    planner::base::Track plain;
    double misfit = 0.0, plain_misfit = 0.0;  // m, the most so far
    double noise = 0.0;                       // m, that is part of them
    [[nodiscard]] bool plain_wrong() const;
  };
  void remember(const MotionSample& sample, bool exact);
  void thin_out(bool exact);
  void judge(double t, const planner::base::Track& estimate, PredictionRecord& swings);
  void look_for_turn(double t, const planner::base::Track& measured, std::uint64_t name, Experience& all);
  [[nodiscard]] bool certain(const BouncingMotion& motion, const BouncingMotion::Turn& turn) const;
  void turned(double t, int axis, double where, double speed, std::uint64_t name, double radius, Experience& all);

  std::vector<MotionSample> samples_;  // thinned out as they grow old
  double spacing_ = 0.0;
  double begun_ = 0.0;                // the newest sample
  std::vector<MotionSample> recent_;  // the last few as measured
  std::vector<Trial> trials_;         // oldest first
  double next_fit_ = 0.0;
  double first_ = -1.0;  // when it was observed first
  bool unexplained_ = false;
  double frequency_ = 0.0;                       // of the last fit; 0: none
  std::optional<double> proven_;                 // m, misfit of the last trial that ended well
  bool plain_ = false;                           // constant acceleration does as well
  int failures_ = 0;                             // trials in a row that did not prove right; below 0: that did
  planner::base::Box turns_;                     // of its own
  std::array<std::array<int, 2>, 3> returns_{};  // axis; lower, upper: how often it turned there
  double last_turn_ = -1.0;
  PredictionRecord swings_;  // its own
  double recorded_ = -1.0;   // when it added to the records of swings last
};

}  // namespace jink::bridge::prediction
