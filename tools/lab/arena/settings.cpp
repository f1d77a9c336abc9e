// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

namespace jink::tools::lab::arena {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "jink-arena-results/1";

/// The settings but for the parameters, as name and text.
std::vector<config::SettingText> listed(const CampaignSettings& s) {
  return {{"version", s.version},
          {"seed", std::to_string(s.seed)},
          {"families", fmt::format("{}", fmt::join(s.families, ","))},
          {"pilots", fmt::format("{}", fmt::join(s.pilots, ","))},
          {"tiers", fmt::format("{}", fmt::join(s.tiers, ","))},
          {"runs", std::to_string(s.runs)},
          {"oracle", s.oracle ? "on" : "off"},
          {"recorded", s.recorded.empty() ? "none" : s.recorded},
          {"shard", campaign::to_string(s.shard)}};
}

}  // namespace

std::string flight_name(const std::string& family, std::uint64_t seed, const std::string& tier,
                        const std::string& pilot) {
  return fmt::format("{}-{}-{}-{}", family, seed, tier, pilot);
}

std::uint64_t world_seed(std::uint64_t seed, std::string_view family, int run) {
  return campaign::seed_of(seed, family, run);
}

std::vector<Job> jobs_of(const CampaignSettings& settings) {
  std::vector<Job> jobs;
  const std::size_t flights_of_world = settings.tiers.size() * settings.pilots.size();
  World world;
  for (world.run = 0; world.run < settings.runs; ++world.run) {
    for (std::size_t family = 0; family < settings.families.size(); ++family, ++world.number) {
      // Diagonally: with as many shards as families, none may be left with one family alone.
      const auto shards = static_cast<std::size_t>(settings.shard.of);
      if ((static_cast<std::size_t>(world.run) + family) % shards + 1 !=
          static_cast<std::size_t>(settings.shard.number))
        continue;
      world.family = settings.families[family];
      world.seed = world_seed(settings.seed, world.family, world.run);
      std::size_t number = world.number * flights_of_world;
      for (const std::string& tier : settings.tiers)
        for (const std::string& pilot : settings.pilots) jobs.push_back({number++, world, tier, pilot});
    }
  }
  return jobs;
}

Json to_header(const CampaignSettings& s) {
  return {{"type", "header"},
          {"format", kFormat},
          {"version", s.version},
          {"seed", s.seed},
          {"families", s.families},
          {"pilots", s.pilots},
          {"tiers", s.tiers},
          {"runs", s.runs},
          {"oracle", s.oracle},
          {"recorded", s.recorded},
          {"shard", s.shard.number},
          {"shards", s.shard.of},
          {"parameters", campaign::to_json(s.parameters)}};
}

CampaignSettings from_header(const Json& header) {
  CampaignSettings s;
  campaign::read_header(header, kFormat, [&] {
    header.at("version").get_to(s.version);
    header.at("seed").get_to(s.seed);
    header.at("families").get_to(s.families);
    header.at("pilots").get_to(s.pilots);
    header.at("tiers").get_to(s.tiers);
    header.at("runs").get_to(s.runs);
    header.at("oracle").get_to(s.oracle);
    header.at("recorded").get_to(s.recorded);
    header.at("shard").get_to(s.shard.number);
    header.at("shards").get_to(s.shard.of);
    s.parameters = campaign::parameters_of(header.at("parameters"));
  });
  campaign::check_header(s.runs, std::numeric_limits<int>::max(), s.shard);
  return s;
}

std::vector<std::string> differences(const CampaignSettings& a, const std::string& name_a, const CampaignSettings& b,
                                     const std::string& name_b) {
  std::vector<config::SettingText> of_a = listed(a), of_b = listed(b);
  of_a.insert(of_a.end(), a.parameters.begin(), a.parameters.end());
  of_b.insert(of_b.end(), b.parameters.begin(), b.parameters.end());
  return campaign::differences(of_a, name_a, of_b, name_b);
}

}  // namespace jink::tools::lab::arena
