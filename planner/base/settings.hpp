// SPDX-License-Identifier: BSD-3-Clause
// Every parameter of the planner with its one default. config/planner.yaml shows the same values; a test keeps them
// equal.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace jink::planner::base {

/// Which collision constraint the paper-mode problem uses.
enum class Constraint {
  kPaper,  ///< the discriminant of [Paper] Eq. (14): infinite line, obstacle frozen; the nearby ones of Eq. (17)
  kSwept   ///< both move during the segment
};

/// The axis along which the paper-mode problem places its waypoints.
enum class Axis {
  kWorldX,  ///< the world's X as [Paper] Figure 1 has it; needs start and target to differ enough in x
  kPath     ///< from start to target
};

/// How universes move, [Paper] Eq. (18) and (20).
enum class Operators {
  kPrinted,    ///< as the paper prints them, and Algorithms 1 and 2 to the letter
  kCommon,     ///< the step of the circulating MOMVO code, which depends on where the origin is; Eq. (20) mended
  kCorrected,  ///< mended, see planner/optimizer/multiverse.hpp
  kAdaptive    ///< corrected, and a second kind of move, narrow; the kind that succeeds is drawn more often
};

/// MOMVO and PMOMVO, [Paper] Algorithms 1 and 2.
struct OptimizerSettings {
  int slaves = 6;                              ///< m, sub-swarms
  int sharing = 9;                             ///< l, sharings; the iterations are split in l + 1 cycles
  int population = 50;                         ///< n_pop, universes of all slaves together
  int iterations = 100;                        ///< n_iter
  int archive = 100;                           ///< capacity of each archive
  double wep_min = 0.2;                        ///< rho_min of Eq. (19)
  double wep_max = 1.0;                        ///< rho_max of Eq. (19)
  double exploitation = 6.0;                   ///< gamma of Eq. (20)
  Operators operators = Operators::kAdaptive;  ///< how universes move
  double narrow_variables = 3.0;               ///< that a narrow move changes, on average
  double focus = 0.7;       ///< probability that a narrow move starts from the best in the first objective
  int focused = 3;          ///< the best in it, of which that takes one
  bool opposition = false;  ///< whether random universes come in opposite pairs
};

/// The paper's problem: one waypoint at a time along the axis.
struct PaperSettings {
  int waypoints = 20;                          ///< including start and target
  Constraint constraint = Constraint::kSwept;  ///< when a segment hits
  Axis axis = Axis::kWorldX;                   ///< along which the waypoints stand
  double steering_limit_deg = 60.0;            ///< phi_max of Eq. (3)
  double penalty = 1000.0;                     ///< lambda of Eq. (17)
  double lateral_range = 4.0;                  ///< half width of the search box about the straight line
  double narrow_gap = 0.52;      ///< delta_narrow: surface gap below which a pair gets a virtual sphere, Eq. (15)
  double narrow_altitude = 0.3;  ///< altitude difference up to which two obstacles count as level
  double margin = 0.05;          ///< added to the sum of radii
};

/// The remaining path at once, replanned in flight.
struct HorizonSettings {
  int waypoints = 6;                 ///< K
  double time = 6.0;                 ///< looked ahead; the rest is straight
  double step = 0.1;                 ///< between points of the timed path
  int slaves = 2;                    ///< m, as OptimizerSettings::slaves
  int sharing = 3;                   ///< l, as OptimizerSettings::sharing
  int population = 24;               ///< n_pop, as OptimizerSettings::population
  int generations = 200;             ///< of one plan in virtual time, at most, and in real time
  double deadline_ms = 6.0;          ///< budget of one plan in real time
  double lateral_range = 6.0;        ///< how far waypoints may leave the straight line
  double back_range = 2.0;           ///< how far they may fall back behind the start
  double brief_time = 2.0;           ///< looked ahead where the way leads on near by
  double far_time = 9.0;             ///< looked ahead where nothing leads on within lateral_range
  double far_range = 12.0;           ///< how far waypoints may leave the straight line then
  double acceleration_share = 0.5;   ///< of the vehicle's limit that plans use; the rest is for tracking them
  double emergency_share = 0.9;      ///< the same where nothing else keeps the margin
  double acceleration_limit = 10.0;  ///< as which a higher limit counts, m/s²: a tilt of 45 degrees
  double braking = 2.0;              ///< deceleration planned towards a stop, m/s²
  double catch_up = 0.4;             ///< s, in which a distance from the wished position is made good
  double shortest_leg = 0.1;         ///< m, between waypoints: nearer ones are not turned at
  double arrival = 0.05;             ///< m, from the target, where a path is there
  double near_target = 0.3;          ///< m, from it, where time stops counting
  double visit_range = 0.2;          ///< m, from it, where a path that is
  double visit_speed = 0.5;          ///< as slow as this, m/s,
  double visit_time = 0.3;           ///< s, for so long has visited it
  double margin = 0.35;              ///< kept from every obstacle on top of the radii, for the tracking error
  double sigma_factor = 2.0;         ///< standard deviations of a track's position that clearance is asked for
  double track_acceleration = 0.4;   ///< what a track's acceleration may be off by, m/s²
  double sudden_change = 1.5;        ///< by which a track's velocity may be another at once, at most, m/s
  double acceleration_trust = 0.7;   ///< how long a track's measured acceleration is believed to last
  double clearance_limit = 0.8;      ///< the most that uncertainty may ask for on top of the margin
  double time_weight = 3.0;          ///< of lost time, as length at cruise speed, in the length objective
  double deviation_weight = 0.3;     ///< of the mean distance from unobstructed flight, in the length objective
  double hurry = 4.0;                ///< times time_weight, for a vehicle that is stuck
  double length_band = 0.1;    ///< solutions longer than the shortest feasible one by this share and 8 m are not chosen
  double weight_length = 0.6;  ///< of f1 in the modified TOPSIS
  double weight_steering = 0.05;   ///< of f2
  double weight_clearance = 0.35;  ///< of f3
  int candidates = 32;             ///< of the front, that are verified at most
  double deadline_share = 0.9;     ///< of the time left, that generations are scheduled for
  bool seeding = true;             ///< whether the search starts from manoeuvres
  double seed_clearance = 0.2;     ///< beyond the margin, that those aim for: the vehicle cuts corners
  int encounters = 3;              ///< the first obstacles met that they lead past
  int gaps = 3;                    ///< that they lead through, at each of the times at which they do
  double gap_spacing = 0.5;        ///< between two of the places across the path looked at for a gap
  bool guide = true;               ///< whether plans lead along a way round what stands, where there is need for one
  double guide_margin = 0.1;       ///< kept from what stands by a way; the margin gives way down to it, with speed
  double guide_cell = 0.5;         ///< between two places of the grid that ways are looked for on; half where none is
  int guide_places = 1500;         ///< of the grid, that are looked at for each plan
  double guide_deviation = 1.0;    ///< m, of a way from the straight line, up to which plans need no guide
  double keep_ratio = 0.05;        ///< a previous plan is kept unless one that goes another way is better by this
  double search_ratio = 0.01;      ///< a previous plan that is nearer to unobstructed flight is kept without a search
  double keep_limits = 1.1;        ///< times the limits, up to which it counts: who is beside it is led back to it

  static constexpr int kMostSteps = 256;  ///< of a horizon
  /// s, from when something moves otherwise until the vehicle does: delay, filter, commitment.
  static constexpr double kReaction = 0.45;

  /// Steps from one waypoint to the next.
  [[nodiscard]] int steps_per_leg() const {
    return std::max(1, static_cast<int>(std::lround(time / waypoints / step)));
  }
  /// Time from one waypoint to the next.
  [[nodiscard]] double leg() const { return steps_per_leg() * step; }
  /// How far a plan looks ahead, in whole steps: `time`, rounded.
  [[nodiscard]] double horizon() const { return waypoints * leg(); }

  /// The same settings, for where the way leads on near by.
  [[nodiscard]] HorizonSettings for_brief() const {
    HorizonSettings result = *this;
    result.time = std::min(time, brief_time);
    return result;
  }
  /// The same settings, for motion that is known as far ahead as is looked: never brief.
  [[nodiscard]] HorizonSettings for_known_motion() const {
    HorizonSettings result = *this;
    result.brief_time = time;
    return result;
  }
  /// The same settings, for where the way is blocked. With steps so fine that far_time has more than kMostSteps it is
  /// that many.
  [[nodiscard]] HorizonSettings for_far() const {
    HorizonSettings result = *this;
    const int most = kMostSteps / waypoints;  // steps of a leg
    result.time = std::max(time, std::min(far_time, most * waypoints * step));
    result.lateral_range = std::max(lateral_range, far_range);
    return result;
  }
  /// The same settings, of more acceleration.
  [[nodiscard]] HorizonSettings for_emergencies() const {
    HorizonSettings result = *this;
    result.acceleration_share = std::max(acceleration_share, emergency_share);
    return result;
  }
  /// The most that plans use for a vehicle with this limit, m/s².
  [[nodiscard]] double planned_acceleration(double max_acceleration) const {
    return acceleration_share * std::min(max_acceleration, acceleration_limit);
  }
  /// The same in emergencies.
  [[nodiscard]] double emergency_acceleration(double max_acceleration) const {
    return for_emergencies().planned_acceleration(max_acceleration);
  }
};

}  // namespace jink::planner::base
