// SPDX-License-Identifier: BSD-3-Clause
// The flight log: JSON Lines, format jink-log/1. What the companion saw and did, and, from the simulator, the truth.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "bridge/companion/companion.hpp"
#include "config/settings.hpp"
#include "sim/flight/closed_loop.hpp"
#include "tools/base/json_writer.hpp"

namespace jink::tools::log {

struct FlightLogOptions {
  /// What happens to a record while the queue is full: wait for room (virtual time), or drop and count it, so that a
  /// slow disk cannot hold up a flight.
  bool wait = false;
  std::size_t queue_bytes = std::size_t{64} << 20;
};

/// Takes records from the flight's loop and writes them, one line each, in a thread of its own. Numbers are printed so
/// that they read back to the same bits.
///
/// header {type, format, scenario|mission, seed, version, parameters, ...; of a scenario `shapes`: [{id, box:
/// edges}|{id, cylinder: {radius, height}}|{id, capsule: {radius, a, b}}|{id, vertices}, ...], each with `orientation`
/// and `yaw_rate` where it has them, of the obstacles that are no spheres, about the `p` of their `obstacles` records,
/// of the map, where there is one, `map`: [[x, y, z, radius, and of what is no sphere {prism} or {hull} as below], ...]
/// in the map's order, or as `stands` where it is there to be seen and plans do not know it; and, where it has several,
/// `vehicles`: [{name, radius, start, target}, ...] by number from 0}; then, each with `type` and `t` (s): truth {p, v}
/// and one obstacles {id, p, radius} per obstacle, at 50 Hz, from the simulator; where it has several vehicles, one
/// truth {vehicle, p, v} for each, by number from 0; state {p, v, armed, mode}, tracks {tracks:
/// [{id, p, v, a, radius, position_sigma, velocity_sigma, age}]}, plan {path: [[t, x, y, z], ...], ms, status, ...,
/// from}, setpoint {p, v, a, yaw}, event {name, detail}, and before a plan that sees another map than the one before it
/// seen {number, origin, added: [[six integers], ...], removed: likewise}: boxes of cells from the first three up to
/// the last three (bridge::map::Seen; a cell is Occupancy::kCell wide). Vectors are [x, y, z], ENU, m. `t` of truth and
/// obstacles is scenario time, of the others the companion's clock; in `replay` the two are one.
///
/// What a plan was made from is in `searches`, [[scheduled, done], [scheduled, done]] generations of the search and of
/// the one with more acceleration, and in `from`: {begun, start, p, v, target, vehicle: [radius, length, mass,
/// max_speed, cruise_speed, max_acceleration, max_jerk, max_climb], volume: [min, max], volume_clearance, margin,
/// standing_margin, track_acceleration, sudden_change, acceleration_trust, time_price, stuck, holds, visit, tracks:
/// [[id, x, y, z, vx, vy, vz, ax, ay, az, radius, position_sigma, velocity_sigma, age, sudden_change], ...], before the
/// last of each that has a solid {yaw, yaw_rate, prism: [half edges, corner, rounding, centre, three axes] or hull:
/// [vertices]} (planner::base::Solid, numbers in a row), standing: [id, ...] of the tracks that count among what
/// stands, forecasts: [{track, radius, position_sigma, velocity_sigma, plain_until, bounces: [begin, velocity, min,
/// max] or swings: [frequency, terms]}, ...] (bridge::Forecast, numbers in a row), paths: [{id, offset, radius, margin,
/// position_sigma, velocity_sigma, age, until, points: [[t, x, y, z], ...]}, ...] of the team's other vehicles
/// (planner::KnownPath), map: {seen, where: [min, max], up, floor, sigma}, what of the header's map, or of that and the
/// boxes of the `seen` record of that number, was in view (bridge::companion::MapView), and previous: [[t, x, y, z],
/// ...]}, all valid at `start`, the previous path's times from there on. A number in it that is not finite is the text
/// "inf", "-inf" or "nan". With the header's seed and parameters the plan can be made again
/// (tools/log/flight_replay.hpp).
///
/// The observers may be called from one thread at a time.
class FlightLog final : public bridge::companion::FlightObserver, public sim::world::TruthObserver {
 public:
  /// Creates the file and writes the header, to which `format`, `type` and `version` are added. Throws
  /// UsageError naming the file where it cannot be written.
  FlightLog(const std::filesystem::path& file, const nlohmann::ordered_json& header,
            const FlightLogOptions& options = {});
  /// Writes what is queued, unless close() did.
  ~FlightLog() override;
  FlightLog(const FlightLog&) = delete;
  FlightLog& operator=(const FlightLog&) = delete;

  void on_state(double t, const bridge::vehicle::VehicleState& state) override;
  void on_tracks(double t, const std::vector<planner::base::Track>& tracks) override;
  void on_plan(double t, const bridge::companion::PlanResult& result) override;
  void on_setpoint(double t, const bridge::vehicle::Setpoint& setpoint) override;
  void on_event(double t, std::string_view name, const std::string& detail) override;
  void on_truth(double t, std::span<const sim::world::VehicleTruth> vehicles, const sim::world::World& world) override;

  /// Ends the log: writes what is queued and flushes. Records that were dropped are told of in the log where they are
  /// missing (event `log_dropped`) and here on stderr. Throws std::runtime_error where not all could be written (a full
  /// disk).
  void close();
  /// Records left out so far because the queue was full.
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  struct Event {
    std::string name, detail;
  };
  struct Truth {
    std::vector<sim::world::VehicleTruth> vehicles;
    std::vector<planner::geometry::Sphere> spheres;  // of World::id(0), World::id(1), ...
  };
  using Content = std::variant<bridge::vehicle::VehicleState, std::vector<planner::base::Track>,
                               bridge::companion::PlanResult, bridge::vehicle::Setpoint, Event, Truth>;
  struct Record {
    double t = 0.0;
    Content content;
    std::size_t bytes = 0;
  };

  void put(double t, Content content, std::size_t extra_bytes = 0);
  void tell_of_dropped(double t);
  [[nodiscard]] static Event dropped_event(std::uint64_t count);
  void work(const std::stop_token& stop);
  void write(const Record& record);
  void end_line();
  void write_seen(double t, const std::shared_ptr<const bridge::map::Seen>& seen);
  void write_content(double t, const bridge::vehicle::VehicleState& state);
  void write_content(double t, const std::vector<planner::base::Track>& tracks);
  void write_content(double t, const bridge::companion::PlanResult& result);
  void write_content(double t, const bridge::vehicle::Setpoint& setpoint);
  void write_content(double t, const Event& event);
  void write_content(double t, const Truth& truth);
  base::JsonWriter& begin(std::string_view type, double t);
  void add_job(const bridge::companion::PlanJob& job);
  void add_forecast(const bridge::prediction::Forecast& forecast);
  void add_points(std::string_view key, const planner::base::TimedPath& path);
  void add_body(const planner::base::Body& body);

  std::filesystem::path file_;
  FlightLogOptions options_;
  std::ofstream out_;                              // the thread's own, once that runs
  base::JsonWriter line_;                          // likewise
  std::shared_ptr<const bridge::map::Seen> seen_;  // likewise: what was written last

  mutable std::mutex mutex_;  // guards all below but the thread
  std::condition_variable_any filled_, emptied_;
  std::deque<Record> queue_;
  std::size_t queued_bytes_ = 0;  // of the queue and of what is being written
  std::uint64_t dropped_ = 0;
  std::uint64_t dropped_here_ = 0;  // of these, not yet told of in the log
  double dropped_at_ = 0.0;         // t of the last of these
  std::exception_ptr failure_;
  std::jthread thread_;
};

/// [x, y, z].
nlohmann::ordered_json vector_json(const Vec3& v);

/// The header's `map` or `stands`.
nlohmann::ordered_json map_json(const planner::geometry::StaticMap& map);

/// The header's `parameters`: every setting by its key.
nlohmann::ordered_json parameters_of(const config::Settings& settings);

}  // namespace jink::tools::log
