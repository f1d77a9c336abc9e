// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/campaign/settings_diff.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <stdexcept>

#include "planner/base/random.hpp"

namespace jink::tools::lab::campaign {
namespace {

/// A bijection of 32 bits (the finalizer of MurmurHash3, public domain): different numbers stay different.
constexpr std::uint32_t mix(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x85ebca6bU;
  x ^= x >> 13U;
  x *= 0xc2b2ae35U;
  return x ^ (x >> 16U);
}

const std::string* find(const std::vector<config::SettingText>& all, const std::string& key) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.key == key; });
  return found == all.end() ? nullptr : &found->value;
}

}  // namespace

std::string to_string(const Shard& shard) {
  return fmt::format("{}/{}", shard.number, shard.of);
}

std::uint64_t seed_of(std::uint64_t seed, std::string_view name, int run) {
  std::uint64_t key = planner::base::SplitMix64(seed).next();
  for (const char c : name) key = planner::base::SplitMix64(key ^ static_cast<unsigned char>(c)).next();
  return mix(static_cast<std::uint32_t>(run) ^ static_cast<std::uint32_t>(key >> 32U));
}

std::vector<std::string> differences(const std::vector<config::SettingText>& a, const std::string& name_a,
                                     const std::vector<config::SettingText>& b, const std::string& name_b) {
  std::vector<std::string> result;
  const auto tell = [&](const std::string& key, const std::string* x, const std::string* y) {
    result.push_back(
        fmt::format("{}: {} in {}, {} in {}", key, x ? *x : "missing", name_a, y ? *y : "missing", name_b));
  };
  for (const config::SettingText& one : a) {
    const std::string* other = find(b, one.key);
    if (other == nullptr || *other != one.value) tell(one.key, &one.value, other);
  }
  for (const config::SettingText& one : b)
    if (find(a, one.key) == nullptr) tell(one.key, nullptr, &one.value);
  return result;
}

nlohmann::ordered_json to_json(const std::vector<config::SettingText>& parameters) {
  nlohmann::ordered_json result = nlohmann::ordered_json::object();
  for (const config::SettingText& one : parameters) result[one.key] = one.value;
  return result;
}

std::vector<config::SettingText> parameters_of(const nlohmann::ordered_json& parameters) {
  std::vector<config::SettingText> result;
  for (const auto& [key, value] : parameters.items()) result.push_back({key, value.get<std::string>()});
  return result;
}

void read_header(const nlohmann::ordered_json& header, std::string_view format, const std::function<void()>& read) {
  if (!header.is_object() || header.value("format", "") != format)
    throw std::runtime_error(fmt::format("the first line is not a {} header", format));
  try {
    read();
  } catch (const nlohmann::ordered_json::exception& error) {
    throw std::runtime_error(std::string("the header: ") + error.what());
  }
}

void check_header(int runs, int most, const Shard& shard) {
  if (runs < 1 || runs > most || shard.of < 1 || shard.number < 1 || shard.number > shard.of)
    throw std::runtime_error("the header: runs, shard and shards do not fit one another");
}

std::string parameters_yaml(const std::vector<config::SettingText>& parameters) {
  std::string text = "# The planner's parameters in this campaign.\nformat: jink-planner/1\n";
  std::string section;
  for (const config::SettingText& one : parameters) {
    const auto dot = one.key.find('.');
    if (one.key.substr(0, dot) != section) {
      section = one.key.substr(0, dot);
      text += section + ":\n";
    }
    text += fmt::format("  {}: {}\n", one.key.substr(dot + 1), one.value);
  }
  return text;
}

}  // namespace jink::tools::lab::campaign
