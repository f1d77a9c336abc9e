// SPDX-License-Identifier: BSD-3-Clause
// Settings and flights for the tests of what is made of them.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/arena/results.hpp"

namespace jink::tools::lab::arena {

inline CampaignSettings two_families(int runs) {
  CampaignSettings settings;
  settings.version = "0.1.0";
  settings.families = {"crossing", "falling"};
  settings.pilots = {"jink"};
  settings.tiers = {"perfect", "realistic"};
  settings.runs = runs;
  settings.parameters = {{"horizon.margin", "0.35"}, {"horizon.time", "6"}, {"companion.drag", "1"}};
  return settings;
}

/// A flight of 20 m at 3 m/s that took twice as long as the straight line.
inline FlightRecord flight_of(const Job& job, const std::string& outcome, double clearance) {
  FlightRecord record;
  record.job = job.number;
  record.family = job.world.family;
  record.seed = job.world.seed;
  record.tier = job.tier;
  record.pilot = job.pilot;
  record.outcome = outcome;
  record.reason = outcome == "reached" ? "" : "said, \"so\"";
  record.flight_time = 40.0 / 3.0;
  record.path_length = 22.0;
  record.straight_length = 20.0;
  record.min_clearance = clearance;
  record.max_speed = 3.25;
  record.cruise_speed = 3.0;
  record.speed_limit = 5.0;
  record.tracking_error = 0.1;
  record.plans = 100;
  record.blocked_plans = 2;
  record.deadline_misses = 1;
  record.measured.wall_s = 0.5;
  record.measured.late_plans = 1;
  for (const double ms : {1.0, 2.0, 30.0}) record.measured.plan_ms.add(ms);
  return record;
}

/// All flights of a campaign, reached with 0.5 m to spare.
inline Results all_reached(const CampaignSettings& settings) {
  Results results;
  results.settings = settings;
  for (const Job& job : jobs_of(settings)) results.add(flight_of(job, "reached", 0.5));
  return results;
}

}  // namespace jink::tools::lab::arena
