// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/worlds.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "config/settings.hpp"
#include "planner/base/portable_math.hpp"
#include "planner/base/random.hpp"
#include "planner/geometry/geometry.hpp"
#include "sim/world/known_world.hpp"
#include "tools/lab/campaign/settings_diff.hpp"

namespace jink::tools::lab::study {
namespace {

constexpr int kNumbered = 5;
constexpr int kPictured = 3;
constexpr double kRadius = 0.5;  // m, of an obstacle, as in the paper's scenarios here
constexpr double kFirst = 0.15;  // where along the line the meetings begin, and how much of it they fill
constexpr double kFilled = 0.7;
constexpr double kThrough = 0.3;      // m, from the line at most, of those that block it
constexpr double kBesideLeast = 1.0;  // m, of the others
constexpr double kBesideMost = 2.5;
constexpr double kSlowest = 0.5;  // m/s
constexpr double kFastest = 3.0;
constexpr double kClearOfStart = 1.0;  // m, between surfaces
constexpr double kClearOfTarget = 0.5;

std::vector<std::string> names(const char* prefix, int count) {
  std::vector<std::string> result;
  for (int i = 1; i <= count; ++i) result.push_back(fmt::format("{}-{}", prefix, i));
  return result;
}

Vec3 random_direction(planner::base::RandomStream& random) {
  const double z = random.uniform(-1.0, 1.0);
  const auto turn = planner::base::sine_cosine(random.uniform(-std::numbers::pi, std::numbers::pi));
  const double r = std::sqrt(1.0 - z * z);
  return {r * turn.cosine, r * turn.sine, z};
}

/// An obstacle that is `offset` from the straight flight when this is `share` of the way along.
config::LinearMotion meeting(const config::Scenario& base, double share, const Vec3& offset, const Vec3& velocity) {
  const double t = share * (base.target - base.start).norm() / base.vehicle.cruise_speed;
  const Vec3 place = base.start + share * (base.target - base.start) + offset;
  return {place - velocity * t, velocity, Vec3::Zero()};
}

bool keeps_clear_of_ends(const config::Scenario& base, const config::LinearMotion& motion) {
  const double touching = kRadius + base.vehicle.radius;
  const double end = (base.target - base.start).norm() / base.vehicle.cruise_speed;
  return (motion.position - base.start).norm() > touching + kClearOfStart &&
         (motion.position + motion.velocity * end - base.target).norm() > touching + kClearOfTarget;
}

}  // namespace

std::vector<std::string> numbered_worlds(bool blocked) {
  return names(blocked ? "blocked2" : "table2", kNumbered);
}

std::string hardest_world(bool blocked) {
  return numbered_worlds(blocked).back();
}

bool is_hardest(std::string_view world) {
  return world == hardest_world(false) || world == hardest_world(true);
}

std::vector<std::string> pictured_worlds(bool blocked) {
  return names(blocked ? "blocked12" : "table12", kPictured);
}

bool is_pictured(std::string_view world) {
  return world.find("12-") != std::string_view::npos;
}

bool is_blocked(std::string_view world) {
  return world.substr(0, 7) == "blocked";
}

config::Scenario blocked_scenario(const config::Scenario& base, std::uint64_t seed) {
  config::Scenario scenario = base;
  scenario.obstacles.clear();
  const planner::geometry::PathFrame frame(base.start, base.target);
  planner::base::RandomStream random(seed);
  const auto count = base.obstacles.size();
  while (scenario.obstacles.size() < count) {
    const std::size_t i = scenario.obstacles.size();
    const double share = kFirst + kFilled * (static_cast<double>(i) + random.uniform()) / static_cast<double>(count);
    const bool through = i % 2 == 0;
    const double distance = through ? random.uniform(0.0, kThrough) : random.uniform(kBesideLeast, kBesideMost);
    const auto turn = planner::base::sine_cosine(random.uniform(0.0, std::numbers::pi));  // the ground is below
    const Vec3 offset = distance * (turn.cosine * frame.left + turn.sine * frame.up);
    const Vec3 velocity = random.uniform(kSlowest, kFastest) * random_direction(random);
    const config::LinearMotion motion = meeting(base, share, offset, velocity);
    if (keeps_clear_of_ends(base, motion)) scenario.obstacles.push_back({config::SphereShape{kRadius}, motion});
  }
  return scenario;
}

StudyWorlds::StudyWorlds(std::uint64_t seed) : seed_(seed) {
  for (const auto& names : {numbered_worlds(false), pictured_worlds(false)})
    for (const std::string& name : names)
      paper_.emplace(name, config::load_scenario(config::config_folder() / "scenarios" / (name + ".yaml")));
}

config::Scenario StudyWorlds::scenario(const std::string& name, int run) const {
  if (!is_blocked(name)) return paper_.at(name);
  const config::Scenario& base = paper_.at("table" + name.substr(7));
  const bool pictured = is_pictured(name);
  config::Scenario scenario = blocked_scenario(base, campaign::seed_of(seed_, name, pictured ? 0 : run));
  scenario.name = pictured ? name : fmt::format("{}-run{}", name, run + 1);
  return scenario;
}

World StudyWorlds::world(const std::string& name, int run) const {
  const config::Scenario s = scenario(name, run);
  const sim::world::KnownWorld known(s);
  return {s.start, s.target, s.vehicle, known.spheres, known.volume};
}

}  // namespace jink::tools::lab::study
