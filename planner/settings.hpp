// SPDX-License-Identifier: BSD-3-Clause
// Every parameter of the planner with its one default. config/planner.yaml shows the same values; a test keeps them equal.
#pragma once

#include <cstdint>

namespace jink::planner {

/// Which collision constraint the paper-mode problem uses.
enum class Constraint {
  kPaper,  ///< the discriminant of [Paper] Eq. (14): infinite line, obstacle frozen
  kSwept   ///< both move during the segment
};

/// MOMVO and PMOMVO, [Paper] Algorithms 1 and 2.
struct OptimizerSettings {
  int slaves = 6;             ///< m, sub-swarms
  int sharing = 9;            ///< l, sharings; the iterations are split in l + 1 cycles
  int population = 50;        ///< n_pop, universes of all slaves together
  int iterations = 100;       ///< n_iter
  int archive = 100;          ///< capacity of each archive
  double wep_min = 0.2;       ///< rho_min of Eq. (19)
  double wep_max = 1.0;       ///< rho_max of Eq. (19)
  double exploitation = 6.0;  ///< gamma of Eq. (20)
  double crowding = 2.0;      ///< alpha of Eq. (21), > 1
};

/// The paper's problem: one waypoint at a time along the axis.
struct PaperSettings {
  int waypoints = 20;                 ///< including start and target
  Constraint constraint = Constraint::kSwept;
  double steering_limit_deg = 60.0;   ///< phi_max of Eq. (3)
  double penalty = 1000.0;            ///< lambda of Eq. (17)
  double lateral_range = 4.0;         ///< half width of the search box about the straight line
  double narrow_gap = 0.52;           ///< delta_narrow: surface gap below which a pair gets a virtual sphere, Eq. (15)
  double narrow_altitude = 0.3;       ///< altitude difference up to which two obstacles count as level
  double margin = 0.05;               ///< added to the sum of radii
};

/// The remaining path at once, replanned in flight.
struct HorizonSettings {
  int waypoints = 6;             ///< K
  double time = 6.0;             ///< looked ahead with free waypoints; the rest is straight
  double step = 0.1;             ///< between points of the timed path
  int slaves = 4;
  int sharing = 3;
  int population = 48;
  int generations = 40;          ///< budget of one plan in virtual time, and the upper bound in real time
  double deadline_ms = 20.0;     ///< budget of one plan in real time
  double margin = 0.35;          ///< kept from every obstacle on top of the radii, for the tracking error
  double sigma_factor = 2.0;     ///< standard deviations of a track's position that the margin grows by
  double track_acceleration = 0.3;  ///< bound on what a track's acceleration may be off by, for the margin's growth
  double weight_length = 0.6;    ///< modified TOPSIS
  double weight_steering = 0.1;
  double weight_clearance = 0.3;
  double keep_ratio = 0.05;      ///< a previous plan is kept unless a new one is shorter by this fraction
};

}  // namespace jink::planner
