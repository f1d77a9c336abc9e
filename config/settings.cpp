// SPDX-License-Identifier: BSD-3-Clause
#include "config/settings.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>
#include <variant>

#include "config/yaml.hpp"

namespace jink::config {
namespace {

using planner::base::Axis;
using planner::base::Constraint;
using planner::base::HorizonSettings;
using planner::base::Operators;
using planner::base::OptimizerSettings;
using planner::base::PaperSettings;

/// How a file spells the values of an enumeration, in their order.
template <class Enum>
constexpr auto kSpellings = nullptr;
template <>
constexpr std::array<std::string_view, 2> kSpellings<Constraint> = {"paper", "swept"};
template <>
constexpr std::array<std::string_view, 2> kSpellings<Axis> = {"world_x", "path"};
template <>
constexpr std::array<std::string_view, 4> kSpellings<Operators> = {"printed", "common", "corrected", "adaptive"};
template <>
constexpr std::array<std::string_view, 2> kSpellings<bool> = {"false", "true"};

template <class Section>
struct Field {
  std::string_view name;
  std::variant<int Section::*, double Section::*, bool Section::*, Constraint Section::*, Axis Section::*,
               Operators Section::*>
      member;
  Range range;  // of numbers; of no meaning to the others
};

constexpr Range kNoRange{};

// One line per parameter: that is all it takes to add one here. config/planner.yaml needs its line as well.
constexpr Field<OptimizerSettings> kOptimizer[] = {
    {"slaves", &OptimizerSettings::slaves, closed(1, 256)},
    {"sharing", &OptimizerSettings::sharing, closed(0, 1000)},
    {"population", &OptimizerSettings::population, closed(2, 100000)},
    {"iterations", &OptimizerSettings::iterations, closed(1, 1000000)},
    {"archive", &OptimizerSettings::archive, closed(2, 100000)},
    {"wep_min", &OptimizerSettings::wep_min, closed(0, 1)},
    {"wep_max", &OptimizerSettings::wep_max, closed(0, 1)},
    {"exploitation", &OptimizerSettings::exploitation, above(0, 100)},
    {"operators", &OptimizerSettings::operators, kNoRange},
    {"narrow_variables", &OptimizerSettings::narrow_variables, above(0, 1000)},
    {"focus", &OptimizerSettings::focus, closed(0, 1)},
    {"focused", &OptimizerSettings::focused, closed(1, 100000)},
    {"opposition", &OptimizerSettings::opposition, kNoRange},
};

constexpr Field<PaperSettings> kPaper[] = {
    {"waypoints", &PaperSettings::waypoints, closed(3, 1000)},
    {"constraint", &PaperSettings::constraint, kNoRange},
    {"axis", &PaperSettings::axis, kNoRange},
    {"steering_limit_deg", &PaperSettings::steering_limit_deg, above(0, 180)},
    {"penalty", &PaperSettings::penalty, above(0, 1e12)},
    {"lateral_range", &PaperSettings::lateral_range, above(0, 1000)},
    {"narrow_gap", &PaperSettings::narrow_gap, closed(0, 100)},
    {"narrow_altitude", &PaperSettings::narrow_altitude, closed(0, 100)},
    {"margin", &PaperSettings::margin, closed(0, 100)},
};

constexpr Field<HorizonSettings> kHorizon[] = {
    {"waypoints", &HorizonSettings::waypoints, closed(1, 100)},
    {"time", &HorizonSettings::time, above(0, 600)},
    {"step", &HorizonSettings::step, closed(0.001, 10)},
    {"slaves", &HorizonSettings::slaves, closed(1, 256)},
    {"sharing", &HorizonSettings::sharing, closed(0, 1000)},
    {"population", &HorizonSettings::population, closed(2, 100000)},
    {"generations", &HorizonSettings::generations, closed(1, 1000000)},
    {"deadline_ms", &HorizonSettings::deadline_ms, above(0, 60000)},
    {"lateral_range", &HorizonSettings::lateral_range, above(0, 1000)},
    {"back_range", &HorizonSettings::back_range, closed(0, 1000)},
    {"brief_time", &HorizonSettings::brief_time, above(0, 600)},
    {"far_time", &HorizonSettings::far_time, above(0, 600)},
    {"far_range", &HorizonSettings::far_range, above(0, 1000)},
    {"acceleration_share", &HorizonSettings::acceleration_share, above(0, 1)},
    {"emergency_share", &HorizonSettings::emergency_share, above(0, 1)},
    {"acceleration_limit", &HorizonSettings::acceleration_limit, above(0, 1000)},
    {"braking", &HorizonSettings::braking, above(0, 1000)},
    {"catch_up", &HorizonSettings::catch_up, above(0, 60)},
    {"shortest_leg", &HorizonSettings::shortest_leg, closed(0, 100)},
    {"arrival", &HorizonSettings::arrival, above(0, 10)},
    {"near_target", &HorizonSettings::near_target, closed(0, 100)},
    {"visit_range", &HorizonSettings::visit_range, closed(0, 100)},
    {"visit_speed", &HorizonSettings::visit_speed, closed(0, 100)},
    {"visit_time", &HorizonSettings::visit_time, closed(0, 60)},
    {"margin", &HorizonSettings::margin, closed(0, 100)},
    {"sigma_factor", &HorizonSettings::sigma_factor, closed(0, 100)},
    {"track_acceleration", &HorizonSettings::track_acceleration, closed(0, 1000)},
    {"sudden_change", &HorizonSettings::sudden_change, closed(0, 1000)},
    {"acceleration_trust", &HorizonSettings::acceleration_trust, closed(0, 600)},
    {"clearance_limit", &HorizonSettings::clearance_limit, closed(0, 1000)},
    {"time_weight", &HorizonSettings::time_weight, closed(0, 1000)},
    {"deviation_weight", &HorizonSettings::deviation_weight, closed(0, 100)},
    {"hurry", &HorizonSettings::hurry, closed(1, 1000)},
    {"length_band", &HorizonSettings::length_band, closed(0, 100)},
    {"weight_length", &HorizonSettings::weight_length, closed(0, 1000)},
    {"weight_steering", &HorizonSettings::weight_steering, closed(0, 1000)},
    {"weight_clearance", &HorizonSettings::weight_clearance, closed(0, 1000)},
    {"candidates", &HorizonSettings::candidates, closed(1, 100000)},
    {"deadline_share", &HorizonSettings::deadline_share, closed(0.01, 1)},
    {"seeding", &HorizonSettings::seeding, kNoRange},
    {"seed_clearance", &HorizonSettings::seed_clearance, closed(0, 100)},
    {"encounters", &HorizonSettings::encounters, closed(0, 1000)},
    {"gaps", &HorizonSettings::gaps, closed(0, 1000)},
    {"gap_spacing", &HorizonSettings::gap_spacing, closed(0.05, 100)},
    {"guide", &HorizonSettings::guide, kNoRange},
    {"guide_margin", &HorizonSettings::guide_margin, closed(0, 100)},
    {"guide_cell", &HorizonSettings::guide_cell, closed(0.05, 100)},
    {"guide_places", &HorizonSettings::guide_places, closed(1, 1e6)},
    {"guide_deviation", &HorizonSettings::guide_deviation, closed(0, 1000)},
    {"keep_ratio", &HorizonSettings::keep_ratio, below(0, 1)},
    {"search_ratio", &HorizonSettings::search_ratio, below(0, 1)},
    {"keep_limits", &HorizonSettings::keep_limits, closed(0, 100)},
};

constexpr Field<CompanionSettings> kCompanion[] = {
    {"setpoint_rate_hz", &CompanionSettings::setpoint_rate_hz, closed(2, 1000)},  // below 2 Hz PX4 leaves OFFBOARD
    {"replan_rate_hz", &CompanionSettings::replan_rate_hz, above(0, 1000)},
    {"largest_replan_rate_hz", &CompanionSettings::largest_replan_rate_hz, above(0, 1000)},
    {"planner_latency_ms", &CompanionSettings::planner_latency_ms, closed(0, 10000)},
    {"commitment", &CompanionSettings::commitment, closed(0, 5)},
    {"setpoint_lead", &CompanionSettings::setpoint_lead, closed(0, 10)},
    {"acceleration_lead", &CompanionSettings::acceleration_lead, closed(0, 10)},
    {"stale_state", &CompanionSettings::stale_state, above(0, 60)},
    {"stale_plan", &CompanionSettings::stale_plan, above(0, 60)},
    {"margin_limit", &CompanionSettings::margin_limit, closed(0, 10)},
};

std::string path_of(std::string_view section, std::string_view key) {
  return std::string(section) + "." + std::string(key);
}

/// Calls visit(name, section, its fields) for each section, in the order of the file. `settings` may be const.
template <class AnySettings, class Visitor>
void for_each_section(AnySettings& settings, Visitor&& visit) {
  visit("optimizer", settings.optimizer, kOptimizer);
  visit("paper", settings.paper, kPaper);
  visit("horizon", settings.horizon, kHorizon);
  visit("companion", settings.companion, kCompanion);
}

void read_value(int& member, const Value& value, const Range& range) {
  member = value.integer(range);
}
void read_value(double& member, const Value& value, const Range& range) {
  member = value.number(range);
}
template <class Enum>
void read_value(Enum& member, const Value& value, const Range&) {
  member = static_cast<Enum>(value.choice(kSpellings<Enum>));
}

std::string value_text(int value) {
  return std::to_string(value);
}
std::string value_text(double value) {
  return number_text(value);
}
template <class Enum>
std::string value_text(Enum value) {
  return std::string(kSpellings<Enum>[static_cast<std::size_t>(value)]);
}

std::string range_text(int, const Range& range) {
  return "an integer in " + range.text();
}
std::string range_text(double, const Range& range) {
  return "a number in " + range.text();
}
template <class Enum>
std::string range_text(Enum, const Range&) {
  return "one of " + join(kSpellings<Enum>);
}

template <class Section>
void read_field(Section& section, const Field<Section>& field, const Value& value) {
  std::visit([&](auto member) { read_value(section.*member, value, field.range); }, field.member);
}

template <class Section>
std::string field_text(const Section& section, const Field<Section>& field) {
  return std::visit([&](auto member) { return value_text(section.*member); }, field.member);
}

template <class Section>
std::string field_range(const Section& section, const Field<Section>& field) {
  return std::visit([&](auto member) { return range_text(section.*member, field.range); }, field.member);
}

/// What is wrong between keys that are right by themselves.
struct Conflict {
  std::string_view path;  // the key that is reported
  std::string complaint;
};

std::optional<Conflict> find_conflict(const Settings& s) {
  const auto not_in = [](const Range& range) { return "; not in " + range.text(); };
  if (s.optimizer.population < s.optimizer.slaves) {
    return Conflict{"optimizer.population",
                    "is smaller than the number of slaves" + not_in(closed(s.optimizer.slaves, 100000))};
  }
  if (s.optimizer.wep_min > s.optimizer.wep_max) {
    return Conflict{"optimizer.wep_min", "is above wep_max" + not_in(closed(0, s.optimizer.wep_max))};
  }
  if (s.horizon.population < s.horizon.slaves) {
    return Conflict{"horizon.population",
                    "is smaller than the number of slaves" + not_in(closed(s.horizon.slaves, 100000))};
  }
  if (s.horizon.step > s.horizon.time) {
    return Conflict{"horizon.step", "is above time" + not_in(closed(0.001, s.horizon.time))};
  }
  if (s.horizon.weight_length + s.horizon.weight_steering + s.horizon.weight_clearance <= 0.0) {
    return Conflict{"horizon.weight_length", "and the other weights are all 0; expected one that is above 0"};
  }
  return std::nullopt;
}

/// What set_config_folder() said; empty: nothing.
std::filesystem::path& told_folder() {
  static std::filesystem::path folder;
  return folder;
}

Settings read_file(const std::filesystem::path& file) {
  const Map root(read_document(file), {"format", "optimizer", "paper", "horizon", "companion"}, "jink-planner/1");
  Settings settings;
  std::vector<std::pair<std::string, Value>> values;  // for the errors between keys
  for_each_section(settings, [&](std::string_view name, auto& section, const auto& fields) {
    std::vector<std::string_view> keys;
    for (const auto& field : fields) keys.push_back(field.name);
    const std::string expected = "a map with the keys " + join(keys);
    const Map map(root.at(name, expected), std::move(keys));
    for (const auto& field : fields) {
      const Value value = map.at(field.name, field_range(section, field));
      read_field(section, field, value);
      values.emplace_back(path_of(name, field.name), value);
    }
  });
  if (const auto conflict = find_conflict(settings)) {
    for (const auto& [path, value] : values) {
      if (path == conflict->path) value.fail(conflict->complaint);
    }
  }
  return settings;
}

/// dpkg leaves a new version's file beside one that the user has changed and keeps. Empty: there is none.
std::string where_the_new_one_is(const std::filesystem::path& file) {
  const std::string newer = file.string() + ".dpkg-dist";
  std::error_code none;
  return std::filesystem::exists(newer, none) ? "; this version's own file is " + newer : "";
}

/// "section.key=value", and where an error says it comes from.
struct Override {
  std::string source;
  std::string path;
  std::string text;

  explicit Override(const std::string& argument) : source("--set " + argument) {
    const std::size_t equals = argument.find('=');
    if (equals == std::string::npos) throw ConfigError(source + ": has no '='; expected section.key=value");
    path = argument.substr(0, equals);
    text = argument.substr(equals + 1);
  }
  Override(std::string place, const SettingText& setting)
      : source(std::move(place)), path(setting.key), text(setting.value) {}
  [[nodiscard]] Value value() const { return {YAML::Node(text), source, path, 0}; }
};

void apply(const Override& change, Settings& settings) {
  bool found = false;
  std::vector<std::string> paths;
  for_each_section(settings, [&](std::string_view name, auto& section, const auto& fields) {
    for (const auto& field : fields) {
      paths.push_back(path_of(name, field.name));
      if (paths.back() != change.path) continue;
      read_field(section, field, change.value());
      found = true;
    }
  });
  if (found) return;
  const std::vector<std::string_view> known(paths.begin(), paths.end());
  const std::string_view near = nearest(change.path, known);
  throw ConfigError(change.source + ": key '" + change.path + "': unknown key with value '" + change.text + "'; " +
                    (near.empty() ? "allowed: " + join(known) : "did you mean '" + std::string(near) + "'?"));
}

/// In order. What is wrong between keys is looked for after the last one, so that two that belong together may come in
/// any order.
void apply_all(const std::vector<Override>& changes, Settings& settings) {
  for (const Override& change : changes) apply(change, settings);
  const auto conflict = find_conflict(settings);
  if (!conflict) return;
  const std::string path(conflict->path);
  const std::string section = path.substr(0, path.find('.') + 1);
  std::string sources;
  for (const Override& change : changes) {
    if (!change.path.starts_with(section) || sources.ends_with(change.source)) continue;
    sources += (sources.empty() ? "" : " ") + change.source;
  }
  for (const SettingText& setting : list_settings(settings)) {
    if (setting.key == path) Value(YAML::Node(setting.value), sources, path, 0).fail(conflict->complaint);
  }
}

}  // namespace

Settings load_settings(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  const std::filesystem::path read = file.empty() ? config_folder() / "planner.yaml" : file;
  Settings settings;
  try {
    settings = read_file(read);
  } catch (const ConfigError& error) {
    throw ConfigError(error.what() + where_the_new_one_is(read));
  }
  std::vector<Override> changes;
  changes.reserve(overrides.size());
  for (const std::string& argument : overrides) changes.emplace_back(argument);
  apply_all(changes, settings);
  return settings;
}

Settings recorded_settings(const std::string& source, const std::vector<SettingText>& values,
                           const std::vector<std::string>& overrides, std::vector<std::string>& missing) {
  Settings settings;
  for (const SettingText& setting : list_settings(settings)) {
    const bool known = std::any_of(values.begin(), values.end(), [&](const auto& v) { return v.key == setting.key; });
    if (!known) missing.push_back(setting.key);
  }
  std::vector<Override> changes;
  changes.reserve(values.size() + overrides.size());
  for (const SettingText& value : values) changes.emplace_back(source, value);
  for (const std::string& argument : overrides) changes.emplace_back(argument);
  apply_all(changes, settings);
  return settings;
}

std::vector<SettingText> list_settings(const Settings& settings) {
  std::vector<SettingText> out;
  for_each_section(settings, [&](std::string_view name, const auto& section, const auto& fields) {
    for (const auto& field : fields) {
      out.push_back({path_of(name, field.name), field_text(section, field)});
    }
  });
  return out;
}

std::filesystem::path config_folder() {
  // Read only, and nothing in jink changes the environment.
  const char* const folder = std::getenv("JINK_CONFIG_DIR");  // NOLINT(concurrency-mt-unsafe)
  if (folder != nullptr && *folder != '\0') return folder;
  if (!told_folder().empty()) return told_folder();
  std::error_code unknown;  // where there is no /proc
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  const std::filesystem::path prefix = programs.parent_path();
  // What is installed to /usr has its files in /etc; to any other folder, in its own etc. A build folder leads to the
  // source tree's.
  const std::filesystem::path installed = (prefix.filename() == "usr" ? prefix.parent_path() : prefix) / "etc/jink";
  for (const std::filesystem::path& candidate : {installed, programs / "etc/jink"})
    if (std::filesystem::exists(candidate / "planner.yaml", unknown)) return candidate;
  return "/etc/jink";
}

void set_config_folder(std::filesystem::path folder) {
  told_folder() = std::move(folder);
}

}  // namespace jink::config
