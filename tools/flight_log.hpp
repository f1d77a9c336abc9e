// SPDX-License-Identifier: BSD-3-Clause
// The flight log: JSON Lines, format jink-log/1. What the companion saw and did, and, from the simulator, the truth.
#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "bridge/companion.hpp"
#include "config/settings.hpp"
#include "sim/closed_loop.hpp"

namespace jink::tools {

/// Writes one line for each record as it comes. Numbers are printed so that they read back to the same bits.
///
/// header {type, format, scenario|mission, seed, version, parameters, ...}; then, each with `type` and `t` (s):
/// truth {p, v} and one obstacles {id, p, radius} per obstacle, at 50 Hz, from the simulator; where it has several
/// vehicles, one truth {vehicle, p, v} for each, by number from 0;
/// state {p, v, armed, mode}, tracks {tracks: [{id, p, v, a, radius, position_sigma, velocity_sigma, age}]},
/// plan {path: [[t, x, y, z], ...], ms, status}, setpoint {p, v, a, yaw}, event {name, detail}.
/// Vectors are [x, y, z], ENU, m. `t` of truth and obstacles is scenario time, of the others the companion's clock; in
/// `replay` the two are one.
class FlightLog final : public bridge::FlightObserver, public sim::TruthObserver {
 public:
  /// Creates the file and writes the header, to which `format`, `type` and `version` are added. Throws
  /// UsageError naming the file where it cannot be written.
  FlightLog(const std::filesystem::path& file, nlohmann::ordered_json header);

  void on_state(double t, const bridge::VehicleState& state) override;
  void on_tracks(double t, const std::vector<planner::Track>& tracks) override;
  void on_plan(double t, const bridge::PlanResult& result) override;
  void on_setpoint(double t, const bridge::Setpoint& setpoint) override;
  void on_event(double t, std::string_view name, const std::string& detail) override;
  void on_truth(double t, std::span<const sim::VehicleTruth> vehicles, const sim::World& world) override;

  /// Flushes. Throws std::runtime_error where not all could be written (a full disk).
  void close();

 private:
  void write(const nlohmann::ordered_json& record) { out_ << record.dump() << '\n'; }

  std::filesystem::path file_;
  std::ofstream out_;
};

/// [x, y, z].
nlohmann::ordered_json vector_json(const planner::Vec3& v);

/// The header's `parameters`: every setting by its key.
nlohmann::ordered_json parameters_of(const config::Settings& settings);

}  // namespace jink::tools
