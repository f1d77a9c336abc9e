// SPDX-License-Identifier: BSD-3-Clause
#include "sim/families/recorded.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include "sim/families/builders.hpp"
#include "sim/families/families.hpp"

namespace jink::sim::families {
namespace {

constexpr std::uint64_t kStream = 0x7265636f72646564;  // "recorded": a name of its own among the streams of a seed
constexpr double kShortestMission = 15.0;              // m, from start to target
constexpr double kLongestMission = 40.0;               // m
constexpr double kLowestMission = 1.0;                 // m, of the mission above the ground
constexpr double kAround = 100.0;                      // m, from the middle of the mission: who comes there counts
constexpr double kCeiling = 1.2;                       // m, above people's heads
constexpr double kBeside = 10.0;                       // m, of room beside and behind the mission

using recorded::Mover;
using recorded::Recording;

Vec3 place_at(const Mover& mover, double t) {
  const auto later = std::upper_bound(mover.times.begin(), mover.times.end(), t);
  const auto i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(later - mover.times.begin(), 1, static_cast<std::ptrdiff_t>(mover.times.size()) - 1));
  const double share = (t - mover.times[i - 1]) / (mover.times[i] - mover.times[i - 1]);
  return mover.points[i - 1] + share * (mover.points[i] - mover.points[i - 1]);
}

/// Who is recorded between two instants and comes near a place: its way in the meantime, `origin` taken off.
std::optional<config::WaypointsMotion> way_of(const Mover& mover, double begin, double end, const Vec3& near,
                                              const Vec3& origin) {
  if (mover.times.back() < begin || mover.times.front() > end) return std::nullopt;
  config::WaypointsMotion way;
  const auto add = [&](double t) {
    way.times.push_back(t - begin);
    way.points.push_back(place_at(mover, t) - origin);
  };
  add(begin);
  for (const double t : mover.times) {
    if (t > begin && t < end) add(t);
  }
  add(end);
  for (std::size_t i = 1; i < way.points.size(); ++i) {
    const Vec3 a = way.points[i - 1] + origin - near;
    const Vec3 leg = way.points[i] - way.points[i - 1];
    const double length = leg.squaredNorm();
    const double share = length > 0.0 ? std::clamp(-a.dot(leg) / length, 0.0, 1.0) : 0.0;
    if ((a + share * leg).norm() < kAround + mover.radius) return way;
  }
  return std::nullopt;
}

config::Scenario draw(const Recording& recording, RandomStream& random) {
  const bool people = std::all_of(recording.movers.begin(), recording.movers.end(),
                                  [](const Mover& mover) { return mover.height > 0.0; });
  const Mover& met = recording.movers[random.below(recording.movers.size())];
  const double when = random.uniform(met.times.front(), met.times.back());
  const double length = random.uniform(kShortestMission, kLongestMission);
  const Vec3 forward = random_vector(random, {1.0, 1.0, 0.0, 0.0});
  const Vec3 place = place_at(met, when);
  config::Scenario scenario;
  scenario.vehicle_name = "ardrone2";
  const Vec3 origin(place.x(), place.y(), 0.0);
  const Vec3 meeting(0.0, 0.0, people ? std::max(kLowestMission, place.z()) : place.z());
  scenario.start = meeting;
  scenario.target = meeting + length * forward;
  const double along = mission_of(scenario).random_place(random, 0.3, 0.8);
  scenario.start -= along * forward;
  scenario.target -= along * forward;
  scenario.time_limit = default_time_limit(scenario);
  const double begin = when - mission_of(scenario).time_at(along);
  const Vec3 middle = 0.5 * (scenario.start + scenario.target) + origin;
  double top = scenario.start.z();  // of all heads
  for (const Mover& mover : recording.movers) {
    const auto way = way_of(mover, begin, begin + scenario.time_limit, middle, origin);
    if (!way) continue;
    config::Shape shape = config::SphereShape{mover.radius};
    if (mover.height > 0.0) shape = config::CylinderShape{mover.radius, mover.height};
    scenario.obstacles.push_back({shape, *way});
    for (const Vec3& point : way->points) top = std::max(top, point.z() + 0.5 * mover.height);
  }
  if (people) {
    scenario.world = planner::base::Box{scenario.start.cwiseMin(scenario.target).array() - kBeside,
                                        scenario.start.cwiseMax(scenario.target).array() + kBeside};
    scenario.world->min.z() = 0.0;
    scenario.world->max.z() = top + kCeiling;
  }
  return scenario;
}

}  // namespace

config::Scenario make_recorded_world(const Recording& recording, std::uint64_t seed) {
  constexpr std::uint64_t kMostAttempts = 1000;
  constexpr std::size_t kMostObstacles = 10000;  // of a scenario file
  for (std::uint64_t attempt = 0; attempt < kMostAttempts; ++attempt) {
    RandomStream random(seed, kStream, attempt);
    config::Scenario scenario = draw(recording, random);
    scenario.name = std::string(kRecorded) + "-" + std::to_string(seed);
    if (scenario.obstacles.size() <= kMostObstacles && is_fair(scenario, true)) return scenario;
  }
  throw std::runtime_error("no world out of the recording for seed " + std::to_string(seed) +
                           ": in none of 1000 draws is the start clear and the straight way blocked");
}

}  // namespace jink::sim::families
