// SPDX-License-Identifier: BSD-3-Clause
// A flight log in memory, at its full rate. Reads and checks; measures and thins nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace jink::tools {

/// x, y, z in ENU; m or m/s.
using Triple = std::array<double, 3>;

/// The vehicle, or what it was asked to do, at an instant.
struct MotionSample {
  double t = 0.0;
  Triple position{};
  Triple velocity{};
};

/// One obstacle: true, or as tracked. The velocity of a true one is not in the log and stays zero.
struct Body {
  std::uint64_t id = 0;
  Triple position{};
  Triple velocity{};
  double radius = 0.0;
};

/// All obstacles of one instant.
struct BodyFrame {
  double t = 0.0;
  std::vector<Body> bodies;
};

struct PlanRecord {
  double t = 0.0;
  double ms = 0.0;  ///< the planner's time
  std::string status;
  bool kept = false;                        ///< the previous plan was kept
  bool missed = false;                      ///< the deadline
  std::vector<std::array<double, 4>> path;  ///< t, x, y, z
};

struct EventRecord {
  double t = 0.0;
  std::string name;
  std::string detail;
};

// NOLINTNEXTLINE(bugprone-exception-escape): moving a json value does not throw, it only asserts
struct FlightData {
  nlohmann::json header;
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

/// Reads `log`. Throws std::runtime_error "FILE: ..." where it cannot be opened and "FILE:LINE: ..." for content that
/// is not jink-log/1; only the last line may be cut off. Linear in the log's size, which is held in memory.
FlightData read_flight(const std::filesystem::path& log);

}  // namespace jink::tools
