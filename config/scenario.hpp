// SPDX-License-Identifier: BSD-3-Clause
// A scenario as the file describes it: plain values, checked. What moves how in time is sim/world/obstacle_models.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/faults.hpp"
#include "config/sensed_from.hpp"
#include "config/unknown.hpp"
#include "planner/base/types.hpp"

namespace jink::config {

struct SphereShape {
  double radius = 0.0;
  bool operator==(const SphereShape&) const = default;
};
/// Centred on the moving reference point; edge lengths along its own axes.
struct BoxShape {
  Vec3 edges = Vec3::Zero();
  bool operator==(const BoxShape&) const = default;
};
/// Centred on the moving reference point, about its own z.
struct CylinderShape {
  double radius = 0.0;
  double height = 0.0;
  bool operator==(const CylinderShape&) const = default;
};
/// All within the radius of a line, whose ends are relative to the moving reference point, along its own axes.
struct CapsuleShape {
  double radius = 0.0;
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  bool operator==(const CapsuleShape&) const = default;
};
/// The convex hull of these points, relative to the moving reference point; at least one, and they may be degenerate.
struct VertexShape {
  std::vector<Vec3> vertices;
  bool operator==(const VertexShape&) const = default;
};
using Shape = std::variant<SphereShape, BoxShape, CylinderShape, CapsuleShape, VertexShape>;

/// Constant acceleration, [Paper] Eq. (4)-(7) in exact form.
struct LinearMotion {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 acceleration = Vec3::Zero();
  bool operator==(const LinearMotion&) const = default;
};
/// center + (sx(sin τ + 2 sin 2τ), sy(cos τ − 2 cos 2τ), −sz sin 3τ), τ = t/slower + offset.
struct TrefoilMotion {
  Vec3 center = Vec3::Zero();
  Vec3 scale = Vec3::Ones();
  double slower = 1.0;
  double offset = 0.0;
  bool operator==(const TrefoilMotion&) const = default;
};
/// Per axis: center + amplitude · sin(2π · frequency · t + phase).
struct SineMotion {
  Vec3 center = Vec3::Zero();
  Vec3 amplitude = Vec3::Zero();
  Vec3 frequency_hz = Vec3::Zero();
  Vec3 phase = Vec3::Zero();
  bool operator==(const SineMotion&) const = default;
};
/// Constant velocity, reflected at the faces of [min, max].
struct BounceMotion {
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
  bool operator==(const BounceMotion&) const = default;
};
/// Piecewise linear through points at times; still before the first and after the last.
struct WaypointsMotion {
  std::vector<double> times;
  std::vector<Vec3> points;
  bool operator==(const WaypointsMotion&) const = default;
};
/// At that speed to where the nearest vehicle is, which it looks at twice a second; it stands where there is none.
/// Where it is depends on what the vehicles do: sim::world::World::advance().
struct ChaseMotion {
  Vec3 position = Vec3::Zero();  ///< at t = 0
  double speed = 0.0;            ///< m/s
  bool operator==(const ChaseMotion&) const = default;
};
using Motion = std::variant<LinearMotion, TrefoilMotion, SineMotion, BounceMotion, WaypointsMotion, ChaseMotion>;

struct Obstacle {
  Shape shape;
  Motion motion;
  Vec3 orientation = Vec3::Zero();  ///< yaw, pitch, roll of its own axes at t = 0, rad: Rz(yaw) Ry(pitch) Rx(roll)
  double yaw_rate = 0.0;            ///< rad/s, about the vertical through the reference point
  bool operator==(const Obstacle&) const = default;
};

/// What a depth camera or a lidar on the vehicle is: rays about the body's x axis, evenly spread in angle.
struct Scan {
  double horizontal_deg = 0.0;  ///< all of the field of view
  double vertical_deg = 0.0;    ///< likewise
  int columns = 0;
  int rows = 0;
  double range = 0.0;                ///< m
  double rate = 0.0;                 ///< Hz
  double noise = 0.0;                ///< m, standard deviation along a ray
  Unknown unknown = Unknown::kFree;  ///< where none of the rays came, to the companion
  bool operator==(const Scan&) const = default;
};
/// 70 by 50 degrees, 8 m, 15 Hz.
[[nodiscard]] Scan depth_camera();
/// 360 by 60 degrees, 12 m, 10 Hz.
[[nodiscard]] Scan lidar();

/// How the world is measured: what the tracks look like.
struct Sensing {
  double range = planner::base::kInfinity;  ///< from the vehicle's centre to the obstacle's surface
  double rate = 20.0;                       ///< Hz
  double delay = 0.0;                       ///< from measurement to publication
  double position_noise = 0.0;              ///< standard deviation per axis
  double velocity_noise = 0.0;              ///< standard deviation per axis
  double dropout = 0.0;                     ///< probability that a track is missing from a message
  SensedFrom sensed_from = SensedFrom::kWorld;
  std::optional<Scan> scan{};  ///< of what stands; none: the map is known
  bool operator==(const Sensing&) const = default;
};

/// The same everywhere in the world.
struct Wind {
  Vec3 mean = Vec3::Zero();  ///< m/s, where the air goes to
  double gust = 0.0;         ///< m/s, standard deviation per axis
  double gust_time = 2.0;    ///< s, over which a gust dies down to 1/e
  bool operator==(const Wind&) const = default;
};

/// What the autopilots' estimates get wrong: as PX4's filter does on its simulated sensors (`estimate: px4`), nothing
/// (`none`), or a wander of these standard deviations per axis (a map).
struct EstimateErrors {
  bool px4 = true;
  double position_noise = 0.0;  ///< m
  double velocity_noise = 0.0;  ///< m/s
  double drift = 0.0;           ///< m, of the slow wander of the position
  double drift_time = 20.0;     ///< s, over which it dies down to 1/e
  bool operator==(const EstimateErrors&) const = default;
};

/// One of several vehicles in the same world, with its own way to go.
struct ScenarioVehicle {
  Vec3 start = Vec3::Zero();
  Vec3 target = Vec3::Zero();
  std::string vehicle_name;  ///< as Scenario's
  planner::base::VehicleLimits vehicle;
};

struct Scenario {
  std::string name;
  Vec3 start = Vec3::Zero();
  Vec3 target = Vec3::Zero();
  double time_limit = 0.0;
  double acceptance_radius = 0.0;  ///< m, about the target, in which it is reached at any speed; 0: at it, slow
  double hold_time = 0.0;          ///< s, that it stays about the target once it has been there, and evades
  std::string vehicle_name;        ///< "inline" where the file gives a map
  planner::base::VehicleLimits vehicle;
  std::optional<planner::base::Box> world;
  Sensing sensing;
  std::vector<Obstacle> obstacles;
  std::vector<Obstacle> map;  ///< of `map`, then of `no_fly`: at rest, and known without being sensed
  Wind wind;
  EstimateErrors estimate;
  std::vector<Fault> faults;              ///< in the file's order
  std::vector<ScenarioVehicle> vehicles;  ///< further ones, numbered from 1: the scenario's own is vehicle 0
};

/// The scenario's own vehicle, then the further ones: the index is the vehicle's number.
[[nodiscard]] std::vector<ScenarioVehicle> all_vehicles(const Scenario& scenario);

/// Reads and checks a jink-scenario/1 file. `vehicles` is the folder of vehicle files by name; empty: `vehicles/`
/// beside the scenario's folder, then the project's own (config_folder() in config/settings.hpp).
///
/// Required: format, name, start, target, vehicle, obstacles (a list, [] for none), and every key of a motion but the
/// velocity and acceleration of a linear one. An obstacle has exactly one of radius, box, cylinder (radius, height),
/// capsule (radius, a, b) and vertices. Optional: orientation and yaw_rate of an obstacle that is no sphere,
/// time_limit, world (with both min and max), map and no_fly (config/map_reader.hpp), sensing and each of its keys,
/// vehicles (further ones, at most 9, each
/// with start and target, and vehicle where it is another one), wind and each of its keys, estimate (px4, the default,
/// none, or a map of any of its keys), faults (a list, at most 1000; kinds and keys as in config/faults.hpp). Checked:
/// starts and targets lie in the world, and no two starts are above each other so that the vehicles would touch on the
/// ground; a bounce starts between min and max, which may coincide only on an axis without velocity; waypoint times
/// start at 0 or later and increase. Bounds: coordinates 1e5, speeds and accelerations 1e3 per axis, radius, height and
/// edges 1e3, yaw_rate 100 rad/s, 10000 obstacles, 10000 points each.
///
/// Throws ConfigError (config/error.hpp) for anything else: unreadable file, syntax, unknown, missing or repeated key,
/// wrong type, value out of range, wrong format, unknown vehicle.
Scenario load_scenario(const std::filesystem::path& file, const std::filesystem::path& vehicles = {});

}  // namespace jink::config
