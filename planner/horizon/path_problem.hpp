// SPDX-License-Identifier: BSD-3-Clause
// The remaining path at once: K waypoints, each a place and a time, and the motion that follows from them.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "planner/base/settings.hpp"
#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/known_path.hpp"
#include "planner/horizon/approach.hpp"
#include "planner/horizon/nearby_obstacles.hpp"
#include "planner/horizon/path_scene.hpp"
#include "planner/optimizer/problem.hpp"

namespace jink::planner::horizon {

/// What a horizon plan starts from. Everything is valid at path time 0, tracks and the known paths' offsets too.
struct PathRequest {
  Vec3 position = Vec3::Zero();                  ///< of the vehicle, ENU, m
  Vec3 velocity = Vec3::Zero();                  ///< of the vehicle, ENU, m/s
  Vec3 target = Vec3::Zero();                    ///< where the path ends, ENU, m
  base::Box volume;                              ///< that the path must not leave
  double volume_clearance = 0.0;                 ///< kept from the volume's bounds where it can be, m
  base::VehicleLimits vehicle;                   ///< size, speeds, acceleration
  std::span<const base::Track> tracks;           ///< obstacles whose motion is extrapolated
  std::span<const geometry::KnownPath> paths{};  ///< of vehicles that say where they will be
  std::span<const base::Track> standing{};       ///< obstacles that stay where they are, for as long as is looked ahead
  double margin = 0.0;                           ///< kept from every obstacle on top of the radii
  double standing_margin = base::kInfinity;      ///< kept from what stands, where that is less
  double track_acceleration = 0.0;               ///< what a track's acceleration may be off by, m/s²
  double sudden_change = 0.0;                    ///< by which a track's velocity may be another at once, at most, m/s
  double acceleration_trust = base::kInfinity;   ///< as in predict_position
  double time_price = 0.0;  ///< length that a lost second counts as, m/s; at least the cruise speed
  bool stuck = false;       ///< the vehicle has come no nearer to the target for a while
  bool holds = false;       ///< the vehicle has arrived, or stops: it is to stay there, and has time
  bool visit = false;       ///< to have been at the target is enough: it need not stay free
  std::vector<Vec3> way{};  ///< corners of a way to the target that a search begins with, the target last; or none

  /// One that keeps the margin of the settings and expects of tracks what they say.
  [[nodiscard]] static PathRequest with(const base::HorizonSettings& settings);

  /// The same among what moves alone.
  [[nodiscard]] PathRequest without_standing() const {
    PathRequest moving = *this;
    moving.standing = {};
    return moving;
  }
  /// Kept from what stands on top of the radii.
  [[nodiscard]] double margin_beside_standing() const { return std::min(margin, standing_margin); }
};

/// Decision variables: for each of K waypoints at times k·T/K three numbers in [-1, 1], its offset from where
/// unobstructed flight (straight on, at cruise speed, braking for the target) would be then: along the path frame's
/// axis (behind, or waiting, below 0; ahead, above), left, and up. Between waypoints the offset changes evenly, along
/// the axis as unobstructed flight gets on. The vehicle follows with bounded speed, climb and acceleration, so whatever
/// the variables are, the motion is flyable at every instant; with all of them 0 it is unobstructed flight.
///
/// f1: length flown in the horizon plus the straight rest (Eq. (2) over the whole path) plus the time lost against
/// unobstructed flight, as length at cruise speed (or PathRequest::time_price), plus a share of the mean distance from
/// it, so that of equal paths the one at cruise speed wins; with PathRequest::visit length and time count until the
/// target has been visited. f2: sum of the steering angles between the legs (Eq. (3)), rad. f3: how deep, how long and
/// how soon the path dips into the clearance that the tracks' uncertainty asks for, and into
/// PathRequest::volume_clearance of the volume's bounds (a quarter of the volume at most, and not beside the target).
/// Violation: the same for the hard margin, and for leaving the volume.
class PathProblem final : public optimizer::Problem {
 public:
  /// Throws std::invalid_argument for no waypoint, a step or time that is not positive, or more than 256 steps.
  explicit PathProblem(const base::HorizonSettings& settings);

  /// Prepares a plan: the frame, unobstructed flight, and for every step of the horizon the obstacles that can be met
  /// in it. The request's tracks and known paths must stay as they are until the next call: cost_of() reads them again.
  /// With `via` the way on from a horizon that ends short of that place, along the axis, leads over it, straight on
  /// being closed, and lost time counts settings().hurry times: what is put off costs next to nothing otherwise.
  /// O(tracks + near tracks · steps); no allocation once it has seen as many obstacles.
  void prepare(const PathRequest& request, const std::optional<Vec3>& via = {});

  [[nodiscard]] int dimension() const override { return 3 * settings_.waypoints; }
  [[nodiscard]] int objectives() const override { return 3; }
  [[nodiscard]] std::span<const double> lower() const override { return lower_; }
  [[nodiscard]] std::span<const double> upper() const override { return upper_; }
  /// Several solutions are evaluated in lockstep; each gets the same bits as alone.
  void evaluate(std::span<const double> x, std::span<optimizer::Cost> costs) const override;

  /// The motion of one solution, on to the target and at rest there: one point for each step. In each step the
  /// acceleration is constant. Speed, climb and planned acceleration keep their limits to the last step; speed and
  /// climb that the request is above are not exceeded. It ends on the target to the bit, unless that takes minutes.
  ///
  /// What evaluate() measures is this motion's first part, to the bit. Only where the measured one comes within
  /// settings().arrival (0.05 m) of the target to stay, within the horizon, does this one end: in the two seconds
  /// before, it leaves it by at most that, and rests on the target then or a few steps later.
  [[nodiscard]] base::TimedPath motion(std::span<const double> x) const;
  /// The motion of unobstructed flight: all variables 0. Allocates.
  [[nodiscard]] base::TimedPath unobstructed_motion() const {
    return motion(std::vector<double>(static_cast<std::size_t>(dimension()), 0.0));
  }
  /// Objectives and violation of any path that starts at time 0, measured like those of a solution. It may be where no
  /// solution can be. O(tracks + near tracks · steps), allocates.
  [[nodiscard]] optimizer::Cost cost_of(const base::TimedPath& path) const;

  /// Variables whose waypoints lie on a path, as near as the box allows: the warm start.
  void encode_path(const base::TimedPath& path, std::span<double> x) const;

  /// Between points of a motion, s.
  [[nodiscard]] double step() const { return settings_.step; }
  /// Steps in the horizon.
  [[nodiscard]] int steps() const { return scene_.steps; }
  /// How far the problem looks ahead, s.
  [[nodiscard]] double horizon() const { return scene_.steps * settings_.step; }
  /// The settings given at construction.
  [[nodiscard]] const base::HorizonSettings& settings() const { return settings_; }
  /// How many obstacles can be met within the horizon.
  [[nodiscard]] std::size_t obstacles() const { return obstacles_.obstacles(); }
  /// In how many steps each of those that move can be, summed up: what evaluate() takes grows with it.
  [[nodiscard]] std::size_t meetings() const { return obstacles_.meetings(); }

 private:
  static constexpr double kBrakingShare = 0.9;  // of the planned acceleration: the rest makes up for whole steps

  [[nodiscard]] double most_acceleration() const {
    return settings_.planned_acceleration(request_.vehicle.max_acceleration);
  }
  /// Planned towards a stop, m/s²: what the vehicle can follow.
  [[nodiscard]] double braking() const { return std::min(settings_.braking, kBrakingShare * most_acceleration()); }
  void unobstructed_flight();
  void change_offsets();
  void predict_obstacles();
  [[nodiscard]] Clearance clearance() const;
  void fly_to_target(base::TimedPath& path) const;
  [[nodiscard]] std::size_t settled_from(const base::TimedPath& path) const;
  bool land_at_end(const Approach& approach, base::TimedPath& path) const;
  template <std::size_t kLanes>
  void evaluate_lanes(const double* x, std::span<optimizer::Cost> costs) const;
  void evaluate_twelve(const double* x, std::span<optimizer::Cost> costs) const;
  void evaluate_eight(const double* x, std::span<optimizer::Cost> costs) const;
  void evaluate_four(const double* x, std::span<optimizer::Cost> costs) const;

  base::HorizonSettings settings_;
  PathRequest request_;
  PathScene scene_;
  NearbyObstacles obstacles_;
  std::vector<double> lower_, upper_;
  std::vector<double> unobstructed_;  // distance along the axis after each step
  std::vector<base::Box> where_;      // the vehicle can be during each step
};

}  // namespace jink::planner::horizon
