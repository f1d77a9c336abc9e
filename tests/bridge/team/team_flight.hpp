// SPDX-License-Identifier: BSD-3-Clause
// Several vehicles flown in virtual time, in one process: for each an autopilot and the companion of `fly`; between
// them an exchange of intents with a delay. Judged by the true motion.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bridge/companion/companion.hpp"
#include "bridge/team/intents.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"

namespace jink::bridge::team {

/// One vehicle: from rest in the air at `start` to `target`, ENU from the team's common origin.
struct Vehicle {
  Vec3 start, target;
  std::uint32_t system_id = 0;  ///< 0: its number in the team, from 1
  Vec3 origin = Vec3::Zero();   ///< of its own local frame
  bool knows_origin = true;
  bool listens = true;                            ///< to the others
  bool intents = true;                            ///< tells and listens
  double silent_from = planner::base::kInfinity;  ///< nothing it says after that gets through
  double begins = 0.0;                            ///< when its companion starts
};

struct Options {
  std::uint64_t seed = 1;
  double delay = 0.02;      ///< s, of an intent on its way
  double jitter = 0.0;      ///< s, more at most, drawn for each message and reader
  double loss = 0.0;        ///< share of the messages that do not arrive
  double clock_offset = 0;  ///< s, by which each vehicle's system clock is ahead of the one before
  double time_limit = 60.0;
  int threads = 1;
};

struct Flown {
  companion::FlightSummary summary;
  double arrived = -1.0;  ///< when its flight ended
  std::vector<std::pair<std::string, std::string>> events;
  std::vector<Vec3> trail;  ///< true positions every 0.1 s, common frame
};

struct Result {
  std::vector<Flown> vehicles;
  double least_clearance = planner::base::kInfinity;  ///< between the spheres of any two, at every 4 ms
  double at = 0.0;                                    ///< when
  [[nodiscard]] bool all_reached() const;
  [[nodiscard]] double last_arrival() const;
};

/// Bit-identical for the same arguments.
Result fly(const std::vector<Vehicle>& vehicles, const config::Settings& settings, const Options& options);

/// Two that swap places, `apart` metres from each other.
std::vector<Vehicle> swapping(double apart = 20.0, double height = 5.0);
/// `count` evenly on a circle, each to the opposite side.
std::vector<Vehicle> crossing(int count = 4, double radius = 8.0, double height = 5.0);

}  // namespace jink::bridge::team
