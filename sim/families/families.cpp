// SPDX-License-Identifier: BSD-3-Clause
#include "sim/families/families.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/base/portable_math.hpp"
#include "sim/families/builders.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::families {
namespace {

double cruise_of(const Vec3& forward, const planner::base::VehicleLimits& limits) {
  const double climb = std::abs(forward.z());
  return climb * limits.cruise_speed > limits.max_climb ? limits.max_climb / climb : limits.cruise_speed;
}

}  // namespace

Mission::Mission(const Vec3& start, const Vec3& target, const planner::base::VehicleLimits& limits)
    : start_(start),
      forward_((target - start).normalized()),
      left_(Vec3::UnitY()),
      up_(Vec3::Zero()),
      length_((target - start).norm()),
      cruise_(cruise_of(forward_, limits)) {
  const double level = planner::base::hypotenuse(forward_.x(), forward_.y());
  if (level > 1e-9) left_ = Vec3(-forward_.y(), forward_.x(), 0.0) / level;
  up_ = Vec3(forward_.y() * left_.z() - forward_.z() * left_.y(), forward_.z() * left_.x() - forward_.x() * left_.z(),
             forward_.x() * left_.y() - forward_.y() * left_.x());
}

double Mission::duration() const {
  return length_ / cruise_ + 0.5 * cruise_ / kStraightAcceleration + 0.5 * cruise_ / kStraightBraking;
}

double Mission::along(double t) const {
  const double speeding_up = cruise_ / kStraightAcceleration;
  const double left = duration() - t;
  if (t <= 0.0) return 0.0;
  if (left <= 0.0) return length_;
  if (t < speeding_up) return 0.5 * kStraightAcceleration * t * t;
  if (left < cruise_ / kStraightBraking) return length_ - 0.5 * kStraightBraking * left * left;
  return cruise_ * (t - 0.5 * speeding_up);
}

double Mission::time_at(double along) const {
  return along / cruise_ + 0.5 * cruise_ / kStraightAcceleration;
}

double Mission::random_place(RandomStream& random, double from, double to) const {
  const double first = 0.5 * cruise_ * cruise_ / kStraightAcceleration;
  const double last = length_ - 0.5 * cruise_ * cruise_ / kStraightBraking;
  return first + (last - first) * random.uniform(from, to);
}

Mission mission_of(const config::Scenario& scenario) {
  return {scenario.start, scenario.target, scenario.vehicle};
}

int random_count(RandomStream& random, int least, int most) {
  return least + static_cast<int>(random.below(static_cast<std::uint64_t>(most - least) + 1));
}

Vec3 random_point(RandomStream& random, const planner::base::Box& box) {
  const double x = random.uniform(box.min.x(), box.max.x());
  const double y = random.uniform(box.min.y(), box.max.y());
  return {x, y, random.uniform(box.min.z(), box.max.z())};
}

Vec3 random_vector(RandomStream& random, const VectorRange& range) {
  const double length = random.uniform(range.min, range.max);
  const double azimuth = random.uniform(-std::numbers::pi, std::numbers::pi);
  const double elevation = kDegree * random.uniform(range.min_elevation_deg, range.max_elevation_deg);
  const double level = length * std::cos(elevation);
  return {level * std::cos(azimuth), level * std::sin(azimuth), length * std::sin(elevation)};
}

void free_mission(config::Scenario& scenario, RandomStream& random, double min_length, double max_length) {
  const double x = random.uniform(-5, 5);
  const double y = random.uniform(-5, 5);
  const Vec3 way = random_vector(random, {min_length, max_length, -12, 12});
  scenario.start = {x, y, random.uniform(1.5, 4.0) + std::max(0.0, -way.z())};
  scenario.target = scenario.start + way;
}

void maybe_enclose(config::Scenario& scenario, RandomStream& random) {
  const double room = random.uniform(3.0, 6.0);
  if (random.below(2) == 0) return;
  scenario.world = planner::base::Box{scenario.start.cwiseMin(scenario.target).array() - room,
                                      scenario.start.cwiseMax(scenario.target).array() + room};
  scenario.world->min.z() = 0.0;
}

void corridor_mission(config::Scenario& scenario, RandomStream& random, double length, double width, double height) {
  constexpr double kMargin = 1.0;  // m, from the walls of the corridor
  const bool along_y = random.below(2) == 1;
  const bool reversed = random.below(2) == 1;
  const auto oriented = [&](double along, double across, double z) {
    return along_y ? Vec3(across, along, z) : Vec3(along, across, z);
  };
  scenario.world =
      planner::base::Box{oriented(-kMargin, -0.5 * width, 0.0), oriented(length - kMargin, 0.5 * width, height)};
  const double across = random.uniform(kMargin - 0.5 * width, 0.5 * width - kMargin);
  const double z = random.uniform(kMargin, height - kMargin);
  scenario.start = oriented(0.0, across, z);
  scenario.target = oriented(length - 2 * kMargin, across, z);
  if (reversed) std::swap(scenario.start, scenario.target);
}

void add_meeting(config::Scenario& scenario, const Mission& mission, double along, double radius, const Vec3& velocity,
                 const Vec3& offset, double wait) {
  const Vec3 position = mission.at(along) + offset - (wait + mission.time_at(along)) * velocity;
  scenario.obstacles.push_back({config::SphereShape{radius}, config::LinearMotion{position, velocity, Vec3::Zero()}});
}

double random_wait(RandomStream& random, int i) {
  constexpr int kAtOnce = 2;
  constexpr double kLongest = 8.0;  // s
  return i < kAtOnce ? 0.0 : random.uniform(0.0, kLongest);
}

Vec3 random_offset(RandomStream& random, double radius) {
  constexpr double kDeepest = 0.5;  // of the way in to the obstacle's centre that remains at least
  return random_vector(random, {0.0, kDeepest * radius, -90, 90});
}

namespace {

using Build = void (*)(config::Scenario&, planner::base::RandomStream&);

struct Family {
  std::string_view name;
  bool linear;
  Build build;
  bool blocked = true;
  bool map = false;
  bool on_request = false;
};

/// One of so many obstacles.
template <auto build, int count>
void build_of(config::Scenario& scenario, planner::base::RandomStream& random) {
  build(scenario, random, count);
}

void build_panther_slow(config::Scenario& scenario, planner::base::RandomStream& random) {
  build_panther(scenario, random, 2.3);
}

void build_panther_fast(config::Scenario& scenario, planner::base::RandomStream& random) {
  build_panther(scenario, random, 1.2);
}

// The place in the list is the random stream: new ones go to the end, so that the worlds of the others stay.

constexpr std::uint64_t kWindStream = 0x77696e64;  // "wind": a name of its own among the streams of a seed
constexpr double kWindSpeed = 3.0;                 // m/s
constexpr double kGust = 1.0;                      // m/s, rms of all three axes

constexpr std::array kFamilies = {
    Family{"crossing", true, build_crossing},
    Family{"head_on", true, build_head_on},
    Family{"overtaking", true, build_overtaking},
    Family{"falling", true, build_falling},
    Family{"gates", true, build_gates},
    Family{"darts", true, build_darts},
    Family{"vertical", true, build_vertical},
    Family{"backward", true, build_backward},
    Family{"walls", false, build_walls},
    Family{"target_occupied", false, build_target_occupied},
    Family{"crowd", false, build_crowd},
    Family{"turning", false, build_turning},
    Family{"cloud", false, build_cloud},
    Family{"late", true, build_late},
    Family{"odd", true, build_odd},
    Family{"daidalus_head_on", true, build_daidalus_head_on},
    Family{"daidalus_crossing", true, build_daidalus_crossing},
    Family{"daidalus_overtaking", true, build_daidalus_overtaking},
    Family{"antipodal", false, build_antipodal},
    Family{"mader_50", false, build_of<build_mader, 50>, false},
    Family{"mader_100", false, build_of<build_mader, 100>, false},
    Family{"mader_250", false, build_of<build_mader, 250>, false},
    Family{"sando_50", false, build_of<build_sando, 50>, false},
    Family{"sando_100", false, build_of<build_sando, 100>, false},
    Family{"sando_200", false, build_of<build_sando, 200>, false},
    Family{"street", false, build_street, true, true},
    Family{"office", false, build_office, true, true},
    Family{"forest", false, build_forest, true, true},
    Family{"truck", true, build_truck, true, true},
    Family{"lift_door", false, build_lift_door, true, true},
    Family{"racks", false, build_racks, true, true},
    Family{"sliding_gate", false, build_sliding_gate, true, true},
    Family{"wires", false, build_wires, true, true},
    Family{"sando_launched_50", false, build_of<build_sando_launched, 50>, false, false, true},
    Family{"sando_launched_100", false, build_of<build_sando_launched, 100>, false, false, true},
    Family{"sando_launched_200", false, build_of<build_sando_launched, 200>, false, false, true},
    Family{"panther_slow", false, build_panther_slow, false, false, true},
    Family{"panther_fast", false, build_panther_fast, false, false, true},
    Family{"fapp_50", false, build_fapp, false, false, true},
    Family{"cerlab_corridor", false, build_cerlab_corridor, false, true, true},
    Family{"fcp_50", false, build_of<build_fcp, 50>, false, false, true},
    Family{"fcp_280", false, build_of<build_fcp, 280>, false, false, true},
    Family{"sando_hover", false, build_sando_hover, false, false, true},
    Family{"sando_chaser", false, build_sando_chaser, false, false, true}};

template <bool on_request>
constexpr auto kNames = [] {
  constexpr auto wanted = [](const Family& family) { return family.on_request == on_request; };
  std::array<std::string_view, std::count_if(kFamilies.begin(), kFamilies.end(), wanted)> names;
  std::size_t next = 0;
  for (const Family& family : kFamilies) {
    if (wanted(family)) names[next++] = family.name;
  }
  return names;
}();

const Family* find_family(std::string_view name) {
  const auto* found =
      std::find_if(kFamilies.begin(), kFamilies.end(), [&](const Family& known) { return known.name == name; });
  return found == kFamilies.end() ? nullptr : found;
}

// Each piece of the flight is taken for a straight way at constant speed: off by kStraightAcceleration · kStep² / 8.
bool hits_straight(const world::World& world) {
  constexpr double kStep = 0.05;  // s
  const auto hit = [](const world::SweepResult& nearest) { return nearest.min_clearance < -kStraightOverlap - 1e-3; };
  const std::vector<config::ScenarioVehicle> team = config::all_vehicles(world.scenario());
  std::vector<Mission> missions;
  missions.reserve(team.size());
  for (const config::ScenarioVehicle& vehicle : team)
    missions.emplace_back(vehicle.start, vehicle.target, vehicle.vehicle);
  const auto way = [&](std::size_t k, double t) {
    return world::SphereSegment{missions[k].at(missions[k].along(t)), missions[k].at(missions[k].along(t + kStep)),
                                team[k].vehicle.radius};
  };
  for (double t = 0.0; t < missions.front().duration(); t += kStep) {
    const world::SphereSegment own = way(0, t);
    if (hit(world.sweep(own.from, t, own.to, t + kStep))) return true;
    for (std::size_t k = 1; k < team.size(); ++k) {
      if (hit(sweep(own, way(k, t), t, t + kStep))) return true;
    }
  }
  return false;
}

/// Of all vehicles, from the obstacles and from each other.
bool starts_are_clear(const config::Scenario& scenario) {
  config::Scenario without_map = scenario;
  without_map.map.clear();
  const world::World world(without_map);
  const std::vector<config::ScenarioVehicle> team = config::all_vehicles(scenario);
  for (std::size_t k = 0; k < team.size(); ++k) {
    if (world.clearance(team[k].start, 0.0, team[k].vehicle.radius) < kStartClearance) return false;
    for (std::size_t j = 0; j < k; ++j) {
      const double apart = (team[k].start - team[j].start).norm() - team[k].vehicle.radius - team[j].vehicle.radius;
      if (apart < kStartClearance) return false;
    }
  }
  return true;
}

/// The map leaves room where the vehicle begins and where it goes to.
bool ends_are_roomy(const config::Scenario& scenario) {
  config::Scenario map_alone = scenario;
  map_alone.obstacles.clear();
  const world::World world(map_alone);
  return std::min(world.clearance(scenario.start, 0.0), world.clearance(scenario.target, 0.0)) >= kMapClearance;
}

}  // namespace

bool is_fair(const config::Scenario& scenario, bool blocked) {
  return starts_are_clear(scenario) && ends_are_roomy(scenario) && (!blocked || hits_straight(world::World(scenario)));
}

double default_time_limit(const config::Scenario& scenario) {
  return 10.0 * (scenario.target - scenario.start).norm() / scenario.vehicle.max_speed + 30.0;
}

std::span<const std::string_view> world_families() {
  return kNames<false>;
}

std::span<const std::string_view> others_families() {
  return kNames<true>;
}

bool is_linear(std::string_view family) {
  const Family* known = find_family(family);
  return known != nullptr && known->linear;
}

bool blocks_straight_line(std::string_view family) {
  const Family* known = find_family(family);
  return known != nullptr && known->blocked;
}

bool has_map(std::string_view family) {
  const Family* known = find_family(family);
  return known != nullptr && known->map;
}

// The builders aim to block the line and to leave the start free. Where a draw fails in that, the next one is taken.
config::Scenario make_world(std::string_view family, std::uint64_t seed) {
  constexpr std::uint64_t kMostAttempts = 1000;
  const Family* known = find_family(family);
  if (known == nullptr) throw std::invalid_argument("unknown world family: " + std::string(family));
  const auto stream = static_cast<std::uint64_t>(known - kFamilies.data());
  for (std::uint64_t attempt = 0; attempt < kMostAttempts; ++attempt) {
    planner::base::RandomStream random(seed, stream, attempt);
    config::Scenario scenario;
    scenario.name = std::string(family) + "-" + std::to_string(seed);
    scenario.vehicle_name = "ardrone2";
    known->build(scenario, random);
    if (scenario.time_limit == 0.0) scenario.time_limit = default_time_limit(scenario);
    if (is_fair(scenario, known->blocked)) return scenario;
  }
  throw std::logic_error("no world of the family " + std::string(family) + " for seed " + std::to_string(seed));
}

std::string_view to_string(Tier tier) {
  constexpr std::array<std::string_view, 5> kTierNames{"camera", "field", "lidar", "perfect", "realistic"};
  return kTierNames.at(static_cast<std::size_t>(tier));
}

void set_tier(config::Scenario& scenario, Tier tier, std::uint64_t seed) {
  config::Sensing sensing;
  const bool alone = scenario.vehicles.empty();
  if (tier == Tier::kCamera && alone) sensing.scan = config::depth_camera();
  if (tier == Tier::kLidar && alone) sensing.scan = config::lidar();
  if (tier == Tier::kRealistic || tier == Tier::kField) {
    sensing.range = 12.0;
    sensing.rate = 20.0;
    sensing.delay = 0.1;
    sensing.position_noise = 0.1;
    sensing.velocity_noise = 0.3;
    sensing.dropout = 0.05;
  }
  sensing.range = std::min(sensing.range, scenario.sensing.range);
  const bool field = tier == Tier::kField;
  // Where several vehicles share the tracks they are an external tracker's.
  if (field && alone) sensing.sensed_from = config::SensedFrom::kVehicle;
  scenario.sensing = sensing;
  scenario.estimate = {.px4 = field};
  scenario.wind = {};
  if (!field) return;
  const double direction = planner::base::RandomStream(seed, kWindStream).uniform() * 2.0 * std::numbers::pi;
  scenario.wind.mean = {kWindSpeed * std::cos(direction), kWindSpeed * std::sin(direction), 0.0};
  scenario.wind.gust = kGust / std::sqrt(3.0);
}

}  // namespace jink::sim::families
