// SPDX-License-Identifier: BSD-3-Clause
// Where an obstacle will be whose way has been learned: it swings, or it turns where it turned before.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "planner/base/types.hpp"
#include "planner/geometry/known_path.hpp"

namespace jink::bridge::prediction {

/// A periodic motion of a few harmonics, valid at time 0.
struct HarmonicMotion {
  static constexpr int kHarmonics = 3;
  static constexpr int kTerms = 2 * kHarmonics + 1;
  double frequency = 0.0;  ///< rad/s, of the first harmonic
  /// A column per axis; rows: the centre, then for each harmonic the factors of its cosine and its sine.
  Eigen::Matrix<double, kTerms, 3> terms = Eigen::Matrix<double, kTerms, 3>::Zero();

  [[nodiscard]] Vec3 position(double t) const;
  /// The same motion, valid `t` seconds later.
  [[nodiscard]] HarmonicMotion later(double t) const;
};

/// Constant velocity that is thrown back, axis by axis, at the bounds of a room for the centre, valid at time 0.
struct BouncingMotion {
  Vec3 begin = Vec3::Zero();  ///< position at time 0
  Vec3 velocity = Vec3::Zero();
  planner::base::Box room;  ///< unbounded where no turn is known

  [[nodiscard]] Vec3 position(double t) const;
  struct Turn {
    double t = planner::base::kInfinity;  ///< never, to begin with
    int axis = 0;
    bool upper = false;  ///< at the room's upper bound
  };
  /// The first of any axis.
  [[nodiscard]] Turn first_turn() const;
};

/// A learned way of one track.
struct Forecast {
  std::size_t track = 0;  ///< its place in the list of tracks
  std::variant<HarmonicMotion, BouncingMotion> motion;
  double radius = 0.0;
  double position_sigma = 0.0;  ///< standard deviation of the position now, per axis
  double velocity_sigma = 0.0;  ///< and its growth with time
  /// s; up to then the obstacle may as well go on as its plain prediction says. For ever, unless the forecast has
  /// proved right before.
  double plain_until = planner::base::kInfinity;
};

/// The forecast as a known path of so many seconds, a point every `step`, its time 0 the forecast's. Its id is 0.
[[nodiscard]] planner::geometry::KnownPath to_path(const Forecast& forecast, double horizon, double step);

/// What a planner is to avoid: what is predicted plainly, where the others will be, and what stands.
struct Obstacles {
  std::vector<planner::base::Track> tracks;
  std::vector<planner::geometry::KnownPath> paths;
  std::vector<planner::base::Track> standing;
};
/// The tracks whose plain prediction counts for ever; `paths`, then the forecasts' for so many seconds, each followed
/// by its track's plain prediction for as long as that counts.
[[nodiscard]] Obstacles obstacles_of(std::span<const planner::base::Track> tracks, std::span<const Forecast> forecasts,
                                     std::span<const planner::geometry::KnownPath> paths, double horizon, double step,
                                     double trust);

/// Appends, for each of the tracks that moves and is within `reach`, m, of a place, the path on which it stops at once,
/// as people and what people drive may: counted for as long as a vehicle as fast takes to see that and to stop.
void add_stops(std::span<const planner::base::Track> tracks, const Vec3& place, double reach,
               std::vector<planner::geometry::KnownPath>& paths);

}  // namespace jink::bridge::prediction
