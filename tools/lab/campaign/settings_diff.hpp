// SPDX-License-Identifier: BSD-3-Clause
// What the settings of campaigns have in common: shards, seeds of runs, what of two campaigns differs.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "config/settings.hpp"

namespace jink::tools::lab::campaign {

/// Part `number` (from 1) of `of`.
struct Shard {
  int number = 1;
  int of = 1;
  bool operator==(const Shard&) const = default;
};
[[nodiscard]] std::string to_string(const Shard& shard);

/// The seed of run number `run` of what is named: below 2^32, and another one for each of up to 2^32 runs. A function
/// of the three alone.
[[nodiscard]] std::uint64_t seed_of(std::uint64_t seed, std::string_view name, int run);

/// What differs, one text for each setting: "runs: 10 in OLD, 20 in NEW", with the two names in place; empty: nothing.
[[nodiscard]] std::vector<std::string> differences(const std::vector<config::SettingText>& a, const std::string& name_a,
                                                   const std::vector<config::SettingText>& b,
                                                   const std::string& name_b);

/// The parameters in a results file's header: an object of texts, in their order. parameters_of() throws
/// nlohmann::json::exception.
[[nodiscard]] nlohmann::ordered_json to_json(const std::vector<config::SettingText>& parameters);
[[nodiscard]] std::vector<config::SettingText> parameters_of(const nlohmann::ordered_json& parameters);

/// Lets `read` take what it wants from a header of that format. Throws std::runtime_error where it is another's, where
/// `read` throws nlohmann::json::exception.
void read_header(const nlohmann::ordered_json& header, std::string_view format, const std::function<void()>& read);
/// Throws std::runtime_error unless there are 1 to `most` runs and the shard is one.
void check_header(int runs, int most, const Shard& shard);

/// The parameters as a file that config::load_settings() reads, so that what was run can be run again from the results'
/// folder alone.
[[nodiscard]] std::string parameters_yaml(const std::vector<config::SettingText>& parameters);

}  // namespace jink::tools::lab::campaign
