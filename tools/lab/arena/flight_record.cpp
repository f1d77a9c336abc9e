// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/flight_record.hpp"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace jink::tools::lab::arena {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 4> kVerdicts{"flown", "solvable", "impossible", "unknown"};

Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json measured_json(const Measured& measured) {
  Json bins = Json::array();
  for (const auto& [bin, count] : measured.plan_ms.bins()) bins.push_back({bin, count});
  return {{"wall_s", measured.wall_s},
          {"late_plans", measured.late_plans},
          {"plan_ms_max", measured.plan_ms.max()},
          {"plan_bins", std::move(bins)}};
}

Measured measured_from(const Json& line) {
  Measured measured;
  line.at("wall_s").get_to(measured.wall_s);
  line.at("late_plans").get_to(measured.late_plans);
  for (const Json& bin : line.at("plan_bins"))
    measured.plan_ms.add_bin(bin.at(0).get<int>(), bin.at(1).get<std::int64_t>());
  measured.plan_ms.set_max(line.at("plan_ms_max").get<double>());
  return measured;
}

/// All of a line that does not depend on the wall clock.
Json result_json(const FlightRecord& r) {
  return {{"type", "flight"},
          {"job", r.job},
          {"family", r.family},
          {"seed", r.seed},
          {"tier", r.tier},
          {"pilot", r.pilot},
          {"outcome", r.outcome},
          {"reason", r.reason},
          {"flight_time_s", r.flight_time},
          {"path_length", r.path_length},
          {"straight_length", r.straight_length},
          {"min_clearance", finite_or_null(r.min_clearance)},
          {"max_speed", r.max_speed},
          {"cruise_speed", r.cruise_speed},
          {"speed_limit", r.speed_limit},
          {"max_tracking_error", r.tracking_error},
          {"plans", r.plans},
          {"blocked_plans", r.blocked_plans},
          {"deadline_misses", r.deadline_misses}};
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  return kVerdicts.at(static_cast<std::size_t>(verdict));
}

Json to_json(const FlightRecord& record) {
  Json line = result_json(record);
  line["measured"] = measured_json(record.measured);
  return line;
}

Json to_json(const WorldRecord& record) {
  return {{"type", "world"},
          {"world", record.world},
          {"family", record.family},
          {"seed", record.seed},
          {"verdict", to_string(record.verdict)}};
}

FlightRecord flight_from(const Json& line) {
  FlightRecord r;
  try {
    line.at("job").get_to(r.job);
    line.at("family").get_to(r.family);
    line.at("seed").get_to(r.seed);
    line.at("tier").get_to(r.tier);
    line.at("pilot").get_to(r.pilot);
    line.at("outcome").get_to(r.outcome);
    line.at("reason").get_to(r.reason);
    line.at("flight_time_s").get_to(r.flight_time);
    line.at("path_length").get_to(r.path_length);
    line.at("straight_length").get_to(r.straight_length);
    if (!line.at("min_clearance").is_null()) line.at("min_clearance").get_to(r.min_clearance);
    line.at("max_speed").get_to(r.max_speed);
    line.at("cruise_speed").get_to(r.cruise_speed);
    line.at("speed_limit").get_to(r.speed_limit);
    line.at("max_tracking_error").get_to(r.tracking_error);
    line.at("plans").get_to(r.plans);
    line.at("blocked_plans").get_to(r.blocked_plans);
    line.at("deadline_misses").get_to(r.deadline_misses);
    r.measured = measured_from(line.at("measured"));
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("no flight: ") + error.what());
  }
  return r;
}

WorldRecord world_from(const Json& line) {
  WorldRecord r;
  try {
    line.at("world").get_to(r.world);
    line.at("family").get_to(r.family);
    line.at("seed").get_to(r.seed);
    const auto verdict = line.at("verdict").get<std::string>();
    const auto* const found = std::find(kVerdicts.begin(), kVerdicts.end(), verdict);
    if (found == kVerdicts.end()) throw std::runtime_error("no world: there is no verdict '" + verdict + "'");
    r.verdict = static_cast<Verdict>(found - kVerdicts.begin());
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("no world: ") + error.what());
  }
  return r;
}

bool same_result(const FlightRecord& a, const FlightRecord& b) {
  return result_json(a) == result_json(b);
}

}  // namespace jink::tools::lab::arena
