// SPDX-License-Identifier: BSD-3-Clause
// The worlds of the study: the paper's, and others of the same size whose straight line is blocked.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/scenario.hpp"
#include "planner/base/types.hpp"

namespace jink::tools::lab::study {

/// The five worlds of Tables 6 and 7: "table2-1" ... as [Paper] Table 2 has them; blocked: "blocked2-1" ...
[[nodiscard]] std::vector<std::string> numbered_worlds(bool blocked);
/// The fifth of these, which the paper uses wherever it takes one.
[[nodiscard]] std::string hardest_world(bool blocked);
[[nodiscard]] bool is_hardest(std::string_view world);
/// The three worlds of Table 12 and Figures 9-11: "table12-1" ...; blocked: "blocked12-1" ...
[[nodiscard]] std::vector<std::string> pictured_worlds(bool blocked);
[[nodiscard]] bool is_pictured(std::string_view world);
[[nodiscard]] bool is_blocked(std::string_view world);

/// A scenario as it is known at t = 0.
struct World {
  Vec3 start = Vec3::Zero();
  Vec3 target = Vec3::Zero();
  planner::base::VehicleLimits vehicle;
  std::vector<planner::base::Track> tracks;
  planner::base::Box volume;
};

/// A world of start, target, vehicle and number of obstacles of `base` in which the straight flight at cruise speed
/// hits at least half of the obstacles: spheres of 0.5 m in constant motion of 0.5 to 3 m/s in any direction, timed to
/// meet the straight flight one after the other along the middle 70 % of it. Every second one passes through the line
/// itself, no farther than 0.3 m from it, the others 1.0 to 2.5 m beside or above it. None is within 1 m of the vehicle
/// at the start, or within 0.5 m when the straight flight ends. A function of base and seed.
[[nodiscard]] config::Scenario blocked_scenario(const config::Scenario& base, std::uint64_t seed);

/// All worlds by name. Immutable, so threads may share it.
class StudyWorlds {
 public:
  /// Reads the paper's scenarios from config_folder(). Throws config::ConfigError. `seed` is the study's.
  explicit StudyWorlds(std::uint64_t seed);

  /// A paper's world is the same in every run, and so is a pictured one; another blocked one is another in each. Throws
  /// std::out_of_range for a name that is none.
  [[nodiscard]] config::Scenario scenario(const std::string& name, int run) const;
  [[nodiscard]] World world(const std::string& name, int run) const;

 private:
  std::uint64_t seed_;
  std::map<std::string, config::Scenario, std::less<>> paper_;
};

}  // namespace jink::tools::lab::study
