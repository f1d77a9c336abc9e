// SPDX-License-Identifier: BSD-3-Clause
// What the builders of world families share. For sim/families/families*.cpp alone.
//
// Compilers differ in the order in which they evaluate operands and arguments, so no expression draws more than once
// (but in braces, which go from left to right).
#pragma once

#include <numbers>

#include "config/scenario.hpp"
#include "planner/base/random.hpp"
#include "planner/base/types.hpp"

namespace jink::sim::families {

using planner::base::RandomStream;

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;
inline constexpr double kDegree = std::numbers::pi / 180.0;

/// The straight flight (world_families.hpp) and a frame along it.
class Mission {
 public:
  /// From `start` to `target`, at least 5 m apart. `left` is level, `up` is at right angles to both; for a vertical
  /// mission `left` is along y.
  Mission(const Vec3& start, const Vec3& target, const planner::base::VehicleLimits& limits);

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] double cruise() const { return cruise_; }
  [[nodiscard]] double duration() const;
  [[nodiscard]] const Vec3& forward() const { return forward_; }
  [[nodiscard]] const Vec3& left() const { return left_; }
  [[nodiscard]] const Vec3& up() const { return up_; }

  /// The point `along` metres from the start and so far to the left and up.
  [[nodiscard]] Vec3 at(double along, double left = 0.0, double up = 0.0) const {
    return start_ + along * forward_ + left * left_ + up * up_;
  }

  /// How far along the straight flight is at time `t`; 0 before it begins, length() once it has ended.
  [[nodiscard]] double along(double t) const;

  /// When the straight flight is at `along`, which must lie where it cruises: see random_place().
  [[nodiscard]] double time_at(double along) const;

  /// A place where the straight flight cruises, in metres along it, between these fractions of that way.
  [[nodiscard]] double random_place(RandomStream& random, double from = 0.0, double to = 1.0) const;

 private:
  Vec3 start_;
  Vec3 forward_;
  Vec3 left_;
  Vec3 up_;
  double length_;
  double cruise_;
};

[[nodiscard]] Mission mission_of(const config::Scenario& scenario);

/// Whether kStartClearance and kMapClearance hold and, where the straight flight is to be `blocked`, kStraightOverlap.
[[nodiscard]] bool is_fair(const config::Scenario& scenario, bool blocked);
/// Of a mission that is not limited otherwise, s.
[[nodiscard]] double default_time_limit(const config::Scenario& scenario);

/// An index from 0 to `more`, as an int.
[[nodiscard]] int random_count(RandomStream& random, int least, int most);

/// Uniform in the box.
[[nodiscard]] Vec3 random_point(RandomStream& random, const planner::base::Box& box);

/// Limits of a random vector's length and of its elevation.
struct VectorRange {
  double min = 1.0;
  double max = 1.0;
  double min_elevation_deg = 0.0;
  double max_elevation_deg = 0.0;
};
/// Of any azimuth.
[[nodiscard]] Vec3 random_vector(RandomStream& random, const VectorRange& range);

/// Sets start and target: in any direction, `min_length` to `max_length` apart, climbing or sinking a little, above
/// the ground.
void free_mission(config::Scenario& scenario, RandomStream& random, double min_length, double max_length);

/// Encloses the mission so far in a world with its floor at z = 0 and 3 to 6 m of room around, in half of the draws.
void maybe_enclose(config::Scenario& scenario, RandomStream& random);

/// Sets the world to a corridor of this size with its floor at z = 0, and a level mission down it, along either of the
/// axes, in either sense, 1 m from its ends and at least 1 m from its sides.
void corridor_mission(config::Scenario& scenario, RandomStream& random, double length, double width, double height);

/// Adds a sphere in linear motion that is `offset` from the straight flight when that is at `along`, if it begins after
/// `wait` seconds.
void add_meeting(config::Scenario& scenario, const Mission& mission, double along, double radius, const Vec3& velocity,
                 const Vec3& offset = Vec3::Zero(), double wait = 0.0);

/// For the `i`-th to be met: the first two meet the straight flight itself, the others one that waits up to 8 s first,
/// so that to let them all pass is not the way out.
[[nodiscard]] double random_wait(RandomStream& random, int i);

/// In any direction, and so short that a sphere of `radius` that is so far off still overlaps the vehicle deeply.
[[nodiscard]] Vec3 random_offset(RandomStream& random, double radius);

/// What others fly with.
struct OthersLimits {
  double radius = 0.0;        ///< m
  double speed = 0.0;         ///< m/s, the limit and what is cruised at
  double climb = 0.0;         ///< m/s
  double acceleration = 0.0;  ///< m/s²
  double jerk = 0.0;          ///< m/s³
};
/// The scenario's vehicle is one of these limits.
void set_limits(config::Scenario& scenario, const OthersLimits& limits);

// One builder for each family: start, target, world and obstacles. What they leave out make_world() adds.
void build_crossing(config::Scenario& scenario, RandomStream& random);
void build_head_on(config::Scenario& scenario, RandomStream& random);
void build_overtaking(config::Scenario& scenario, RandomStream& random);
void build_falling(config::Scenario& scenario, RandomStream& random);
void build_gates(config::Scenario& scenario, RandomStream& random);
void build_darts(config::Scenario& scenario, RandomStream& random);
void build_vertical(config::Scenario& scenario, RandomStream& random);
void build_backward(config::Scenario& scenario, RandomStream& random);
void build_walls(config::Scenario& scenario, RandomStream& random);
void build_target_occupied(config::Scenario& scenario, RandomStream& random);
void build_crowd(config::Scenario& scenario, RandomStream& random);
void build_turning(config::Scenario& scenario, RandomStream& random);
void build_cloud(config::Scenario& scenario, RandomStream& random);
void build_late(config::Scenario& scenario, RandomStream& random);
void build_odd(config::Scenario& scenario, RandomStream& random);
void build_daidalus_head_on(config::Scenario& scenario, RandomStream& random);
void build_daidalus_crossing(config::Scenario& scenario, RandomStream& random);
void build_daidalus_overtaking(config::Scenario& scenario, RandomStream& random);
void build_mader(config::Scenario& scenario, RandomStream& random, int count);
void build_sando(config::Scenario& scenario, RandomStream& random, int count);
void build_antipodal(config::Scenario& scenario, RandomStream& random);
void build_street(config::Scenario& scenario, RandomStream& random);
void build_office(config::Scenario& scenario, RandomStream& random);
void build_forest(config::Scenario& scenario, RandomStream& random);
void build_truck(config::Scenario& scenario, RandomStream& random);
void build_lift_door(config::Scenario& scenario, RandomStream& random);
void build_racks(config::Scenario& scenario, RandomStream& random);
void build_sliding_gate(config::Scenario& scenario, RandomStream& random);
void build_wires(config::Scenario& scenario, RandomStream& random);
void build_sando_launched(config::Scenario& scenario, RandomStream& random, int count);
void build_panther(config::Scenario& scenario, RandomStream& random, double slower);
void build_fapp(config::Scenario& scenario, RandomStream& random);
void build_sando_hover(config::Scenario& scenario, RandomStream& random);
void build_sando_chaser(config::Scenario& scenario, RandomStream& random);
void build_cerlab_corridor(config::Scenario& scenario, RandomStream& random);
void build_fcp(config::Scenario& scenario, RandomStream& random, int count);

}  // namespace jink::sim::families
