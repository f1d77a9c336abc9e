// SPDX-License-Identifier: BSD-3-Clause
// A flight log in memory, at its full rate. Reads and checks; measures and thins nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "config/scenario.hpp"
#include "planner/geometry/static_map.hpp"

namespace jink::tools::report {

/// x, y, z in ENU; m or m/s.
using Triple = std::array<double, 3>;

/// The vehicle, or what it was asked to do, at an instant.
struct MotionSample {
  double t = 0.0;
  Triple position{};
  Triple velocity{};
};

/// One obstacle: true, or as tracked. The motion of a true one is not in the log and stays zero.
struct Body {
  std::uint64_t id = 0;
  Triple position{};  ///< of the smallest sphere around it
  Triple velocity{};
  double radius = 0.0;
  Triple acceleration{};
  double age = 0.0;  ///< s, since it was measured
};

/// All obstacles of one instant.
struct BodyFrame {
  double t = 0.0;
  std::vector<Body> bodies;
};

/// Where another vehicle of the team has said that it will be.
struct KnownPathRecord {
  std::uint64_t id = 0;
  double radius = 0.0;
  std::vector<std::array<double, 4>> points;  ///< t, x, y, z; t in the log's clock
};

struct PlanRecord {
  double t = 0.0;
  double ms = 0.0;  ///< the planner's time
  std::string status;
  bool kept = false;                        ///< the previous plan was kept
  bool missed = false;                      ///< the deadline
  std::vector<std::array<double, 4>> path;  ///< t, x, y, z
  /// s, for which the accelerations of the tracks were believed; infinite where the log does not bound it.
  double acceleration_trust = std::numeric_limits<double>::infinity();
  std::vector<KnownPathRecord> known_paths;
  std::vector<Triple> way;       ///< corners of the way round what stands that it was led along, the last being its end
  std::optional<double> map_up;  ///< as FlightData::map_up was then; none: it saw no map
};

/// What had been seen to stand at `t`, besides what was known.
struct SeenRecord {
  double t = 0.0;
  std::shared_ptr<const planner::geometry::StaticMap> map;
};

/// A vehicle of a simulator's log with several.
struct OtherVehicle {
  std::uint64_t number = 0;  ///< from 1: the log's own is 0
  std::vector<MotionSample> truth;
};

struct EventRecord {
  double t = 0.0;
  std::string name;
  std::string detail;
};

// NOLINTNEXTLINE(bugprone-exception-escape): moving a json value does not throw, it only asserts
struct FlightData {
  nlohmann::json header;
  std::map<std::uint64_t, config::Obstacle>
      shapes;  ///< of those that are no spheres, about Body::position; motion unset
  std::shared_ptr<const planner::geometry::StaticMap> map;  ///< what stands, or was known to; none: nothing
  std::vector<SeenRecord> seen;                             ///< by time, two a second at the most
  double map_up = 0.0;               ///< z of the log's frame less the map's, m, by the first plan
  std::vector<OtherVehicle> others;  ///< in the order of their numbers
  std::vector<MotionSample> truth, states, setpoints;
  std::vector<BodyFrame> obstacles, tracks;
  std::vector<PlanRecord> plans;
  std::vector<EventRecord> events;  ///< in the order of the log; changes of `armed` and `mode` are added as "mode"
  double first = 0.0, last = 0.0;   ///< times of the earliest and latest record; both 0 where there is none
  std::size_t lines = 0;
  std::size_t cut_off = 0;     ///< 1 where the last line is not whole: the writer was killed
  std::size_t not_finite = 0;  ///< records that hold a number which is not finite
  std::size_t unknown = 0;     ///< records of another type
};

/// The radius of vehicle `number` by the header: "vehicle", or of several "vehicles"; none where it does not tell.
[[nodiscard]] std::optional<double> vehicle_radius(const FlightData& flight, std::uint64_t number = 0);

/// What had been seen to stand at t; null: nothing.
[[nodiscard]] const planner::geometry::StaticMap* seen_at(const FlightData& flight, double t);

/// Reads `log`. Throws std::runtime_error "FILE: ..." where it cannot be opened and "FILE:LINE: ..." for content that
/// is not jink-log/1; only the last line may be cut off. Linear in the log's size, which is held in memory.
FlightData read_flight(const std::filesystem::path& log);

}  // namespace jink::tools::report
