// SPDX-License-Identifier: BSD-3-Clause
// Seeded families of worlds to judge planners on. In every world but those of the literature the straight line is
// blocked: a vehicle that flies it and looks at nothing hits an obstacle, or another vehicle of the team that does
// the same. Whether a free flight exists is not promised; most have one.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "config/scenario.hpp"

namespace jink::sim::families {

/// How a vehicle that ignores all obstacles flies from start to target: from rest, then at cruise speed (less where
/// max_climb asks for it), then to rest.
inline constexpr double kStraightAcceleration = 3.0;  ///< m/s²
inline constexpr double kStraightBraking = 2.0;       ///< m/s²

/// Every obstacle keeps this distance in metres from each vehicle's sphere at its start, at t = 0, surface to surface,
/// and so do the vehicles of a team from each other.
inline constexpr double kStartClearance = 1.5;
/// What is on the map keeps this distance from the vehicle's sphere at its start and at its target.
inline constexpr double kMapClearance = 0.5;

/// On the straight flight, where it is blocked, the vehicle's sphere overlaps an obstacle, the map or another vehicle
/// by at least this much, in metres.
inline constexpr double kStraightOverlap = 0.1;

/// The names of the families that a campaign flies unless told, in a fixed order.
///
/// Constant velocity: crossing (movers timed to meet the vehicle), head_on, overtaking (slower ones ahead and faster
/// ones from behind), falling (from above through the line), gates (pairs of spheres with a gap too small for the
/// vehicle, standing on the line or moving across it), darts (4 to 9 m/s, up to nearly twice as fast as the vehicle),
/// vertical (a steep mission, movers across), backward (the target at smaller or equal x).
///
/// Other motion: walls (one to three, closed across a corridor, with a hole that wanders), target_occupied (by an
/// obstacle that leaves late), crowd (80 bouncing in a low corridor), turning (sines), cloud (60 bouncing in a hall).
///
/// Constant velocity again: late (standing, oncoming and crossing; the sensing reaches no farther than 7 m), odd
/// (everything exactly along or across the line, mirror images, far from the origin), daidalus_head_on,
/// daidalus_crossing, daidalus_overtaking (one or two intruders in the encounters of NASA's DAIDALUS).
///
/// antipodal: no obstacles, two to six vehicles (Scenario::vehicles) that swap places on a circle or a sphere.
///
/// From the literature, with cubes of 0.8 m and a vehicle at v 5, a 20, j 100 that cruises at its speed limit:
/// mader_50, mader_100, mader_250 (75 m, trefoils that peak at 5.3 m/s and cubes that swing in z) and sando_50,
/// sando_100, sando_200 (105 m, 100 s, wider and slower trefoils and standing cubes).
///
/// Known places, with their shapes: what stands is the scenario's map, what moves are its obstacles. People are
/// cylinders that walk there and back at 0.8 to 1.8 m/s, with stops; neither they nor what drives or slides runs into
/// anything but the vehicle.
/// - street: houses, trees, lamps and parked cars; cars at up to 8.9 m/s both ways, people who cross.
/// - office: rooms at a corridor, doors of 1.3 m by 2.1 m or more, ceiling, furniture; people from room to room.
/// - forest: trunks of 0.3 to 0.8 m, their feet 2.4 m apart or more, some fallen; people.
/// - truck: out of an alley over a road into another; trucks of 7 to 9 m at 3 to 8 m/s.
/// - lift_door: through a lift with a door of 1.3 to 1.7 m to either side, each with a time of its own.
/// - racks: a storage hall, rows of racks with a passage each; forklifts, people.
/// - sliding_gate: a hall parted by a wall with a gate that opens and shuts; forklifts drive through, people.
/// - wires: overhead lines and fences of wires 1 to 3 cm thick, masts with stays; people.
[[nodiscard]] std::span<const std::string_view> world_families();

/// The names of those that are flown on request alone, in a fixed order: others' worlds as they launch or describe
/// them, with their vehicle's limits. The straight line may be free. Sources and what differs: launched.cpp, fcp.cpp.
/// - sando_launched_50, _100, _200: the trefoils as their launch file has them, poles and beams.
/// - sando_hover, sando_chaser: the vehicle stays where it starts, among three trefoils or chased at 1 m/s.
/// - panther_slow, panther_fast: five trefoils in a row.
/// - fapp_50: 50 columns that drift and 20 that stand, sensed from 8 m.
/// - cerlab_corridor: nine people and nine boxes; has a map.
/// - fcp_50, fcp_280: small spheres in a box that turn, stop and go, with noise.
[[nodiscard]] std::span<const std::string_view> others_families();

/// Whether every obstacle of the family's worlds keeps a constant velocity for ever, so that a track of t = 0 tells all
/// of its future. False for an unknown family.
[[nodiscard]] bool is_linear(std::string_view family);

/// Whether the straight flight is blocked in every world of the family, by kStraightOverlap. Not so in the corridors of
/// the literature and in others' worlds, whose obstacles are drawn without regard to it. False for an unknown family.
[[nodiscard]] bool blocks_straight_line(std::string_view family);

/// Whether it is one of the known places, whose worlds have a map. False for an unknown family.
[[nodiscard]] bool has_map(std::string_view family);

/// A world of that family: the same for the same arguments. ENU, m, s; named "family-seed", with perfect sensing
/// (Tier::kPerfect). For the AR.Drone, 15 to 40 m from start to target, with the default time limit, unless the family
/// is from the literature or another's. It passes the checks of config::load_scenario; kStartClearance, kMapClearance
/// and kStraightOverlap hold. Throws std::invalid_argument for an unknown family. Deterministic; the C library's sine
/// and cosine have a say in the last bit.
[[nodiscard]] config::Scenario make_world(std::string_view family, std::uint64_t seed);

/// How well obstacles are seen and the vehicle knows where it is.
/// - Field: position noise 0.1 m and velocity noise 0.3 m/s (standard deviations per axis), delay 0.1 s, range 12 m,
///   5 % dropout, 20 Hz, sensed from the vehicle; PX4's estimate; wind of 3 m/s from anywhere, gusts of 1 m/s rms.
/// - Perfect: true tracks without delay at 20 Hz, the true estimate, no wind.
/// - Realistic: the field's tracks with the true estimate and no wind.
/// - Camera, lidar: as perfect, but nobody knows the map: config::depth_camera() or config::lidar() is to find it. A
///   team has neither.
enum class Tier { kCamera, kField, kLidar, kPerfect, kRealistic };
/// "camera", "field", "lidar", "perfect", "realistic".
[[nodiscard]] std::string_view to_string(Tier tier);

/// Replaces the scenario's sensing, estimate and wind by the tier's. A range of the scenario's own that is smaller
/// stays. The direction of the wind follows from `seed`.
void set_tier(config::Scenario& scenario, Tier tier, std::uint64_t seed = 1);

}  // namespace jink::sim::families
