// SPDX-License-Identifier: BSD-3-Clause
// Whether the vehicle is to go on, or to where few can reach it, by how likely it is to be hit.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "bridge/prediction/contact_risk.hpp"
#include "planner/base/settings.hpp"
#include "planner/base/trajectory.hpp"
#include "planner/horizon/path_problem.hpp"

namespace jink::bridge::companion {

/// Decides before each plan where that leads to. It looks at movers that nobody understands alone: whose unforeseen
/// acceleration takes them farther than the margin within kSeen. What is understood is the planner's affair. Not
/// thread-safe.
class Retreat {
 public:
  static constexpr double kRange = 12.0;    ///< m, of what is looked at
  static constexpr double kSeen = 0.5;      ///< s, after which something unforeseen has been seen and is evaded
  static constexpr double kMost = 0.005;    ///< probability to be hit, above which what is flown is given up
  static constexpr double kFar = 0.025;     ///< above which at once; else the next plan may mend it
  static constexpr double kLess = 0.00125;  ///< below which the vehicle goes on
  static constexpr double kLongest = 8.0;   ///< s, for which it waits for that; then it goes on for as long

  explicit Retreat(const planner::base::HorizonSettings& settings) : problem_(settings) {}

  /// Where a plan is to lead to instead of request.target; none: to that. `flown`: what is followed at present, from
  /// the request's state at its time 0 on; of the request's obstacles only what stands is looked at. `predictions` are
  /// valid at time 0 too, with their laws. O(places · (predictions + steps)) where a refuge is looked for,
  /// O(predictions) else.
  std::optional<Vec3> choose(double now, const planner::horizon::PathRequest& request,
                             const planner::base::TimedPath& flown, std::vector<prediction::Prediction> predictions,
                             const prediction::LawsByKind& laws);
  /// What the last call gave.
  [[nodiscard]] const std::optional<Vec3>& refuge() const { return refuge_; }
  /// The autopilot's estimate jumped by that: a refuge is where it was.
  void shift(const Vec3& by) {
    if (refuge_) *refuge_ += by;
  }
  /// Probability to be hit on what is flown, or on the way on from a refuge, as of the last call.
  [[nodiscard]] double risk() const { return std::max(risk_, entry_risk_); }
  /// Something that may do what is not foreseen might soon be met, as of the last call.
  [[nodiscard]] bool cautious() const { return cautious_; }

 private:
  [[nodiscard]] planner::base::TimedPath motion_to(const planner::horizon::PathRequest& request, const Vec3& target);
  /// Takes another refuge where one is better than `least`, a probability to be hit.
  void look_for_refuge(const planner::horizon::PathRequest& request, double least,
                       std::span<const prediction::Prediction> predictions, const prediction::LawsByKind& laws);

  planner::horizon::PathProblem problem_;
  bool begun_ = false;
  std::optional<Vec3> refuge_;  // none: it goes on
  bool chosen_ = false;         // it was; else it is where the vehicle began
  double since_ = 0.0;
  double entry_risky_at_ = 0.0;  // last
  double goes_on_until_ = 0.0;   // whatever comes
  double risk_ = 0.0;            // of what is flown
  double entry_risk_ = 0.0;      // of the way on, where there is a refuge
  bool risky_ = false;           // at the last call
  bool cautious_ = false;
};

}  // namespace jink::bridge::companion
