// SPDX-License-Identifier: BSD-3-Clause
// A mission for `jink fly` and `jink doctor`, as the file describes it: plain values, checked.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/types.hpp"

namespace jink::config {

enum class Arrival { kLand, kHold };

struct TrackPolicy {
  bool required = true;    ///< no flight without a live track writer
  double timeout_s = 1.0;  ///< silence of the writers after which the picture is stale
  double coast_s = 1.0;    ///< how long a track that is no longer reported is predicted on
};

struct Mission {
  std::string name;
  std::string connection;  ///< a MAVSDK URL
  std::string vehicle_name;
  planner::VehicleLimits vehicle;
  double takeoff_height = 1.5;  ///< above the ground at take-off
  double min_height = 1.0;      ///< the plan never goes below; ENU z
  std::vector<planner::Vec3> waypoints;
  Arrival arrival = Arrival::kLand;
  planner::Box geofence;
  int dds_domain = 0;
  TrackPolicy tracks;
  double time_limit = 300.0;
};

/// Reads and checks a jink-mission/1 file; throws ConfigError as load_scenario does.
Mission load_mission(const std::filesystem::path& file, const std::filesystem::path& vehicles = {});

}  // namespace jink::config
