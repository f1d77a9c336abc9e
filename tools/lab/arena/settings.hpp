// SPDX-License-Identifier: BSD-3-Clause
// What a campaign flies: settings, the list of flights that follows from them, and what of two campaigns differs.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "config/settings.hpp"
#include "tools/lab/campaign/settings_diff.hpp"

namespace jink::tools::lab::arena {

using campaign::parameters_yaml;
using campaign::Shard;  // whole worlds, so that shards have none in common

struct CampaignSettings {
  std::string version;  ///< of jink
  std::uint64_t seed = 1;
  std::vector<std::string> families, pilots, tiers;
  int runs = 0;  ///< worlds of each family
  bool oracle = true;
  std::string recorded;  ///< which recording the worlds come from, as "NAME (DIGEST)"; empty: from the families
  Shard shard;
  std::vector<config::SettingText> parameters;  ///< all of the planner's, as config::list_settings()
};

/// A seeded world. `run` counts a family's worlds from 0.
struct World {
  std::size_t number = 0;  ///< in the whole campaign
  std::string family;
  int run = 0;
  std::uint64_t seed = 0;  ///< of the world, and of sensing and planner in it
};

/// "crossing-1234-realistic-jink": names a flight, and the folder of a failed one.
[[nodiscard]] std::string flight_name(const std::string& family, std::uint64_t seed, const std::string& tier,
                                      const std::string& pilot);

/// One flight.
struct Job {
  std::size_t number = 0;  ///< in the whole campaign: the order of all tables
  World world;
  std::string tier, pilot;

  [[nodiscard]] std::string name() const { return flight_name(world.family, world.seed, tier, pilot); }
};

/// The seed of a family's world: below 2^32, and another one for each of up to 2^32 runs. A function of the three
/// alone.
[[nodiscard]] std::uint64_t world_seed(std::uint64_t seed, std::string_view family, int run);

/// The shard's flights in the order in which they are begun: run after run through all families, so that a campaign
/// that is cut short knows something of each. The flights of a world follow one another.
[[nodiscard]] std::vector<Job> jobs_of(const CampaignSettings& settings);

/// The first line of a results file. from_header() throws std::runtime_error for anything that to_header() did not
/// write.
[[nodiscard]] nlohmann::ordered_json to_header(const CampaignSettings& settings);
[[nodiscard]] CampaignSettings from_header(const nlohmann::ordered_json& header);

/// What differs, one text for each setting: "runs: 10 in OLD, 20 in NEW", with the two names in place; empty: nothing.
[[nodiscard]] std::vector<std::string> differences(const CampaignSettings& a, const std::string& name_a,
                                                   const CampaignSettings& b, const std::string& name_b);

}  // namespace jink::tools::lab::arena
