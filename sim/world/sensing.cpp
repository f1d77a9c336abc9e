// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/sensing.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "planner/base/random.hpp"

namespace jink::sim::world {
namespace {

/// Keeps these streams apart from the planner's, which has the same seed: "sensing" in ASCII.
constexpr std::uint64_t kSensingStream = 0x73656e73696e67ULL;

/// k / rate and the sum of steps that the caller's clock is may differ by rounding; what is due is not put off a step.
constexpr double kDueTolerance = 1e-9;

Vec3 noise(planner::base::RandomStream& random, double sigma) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return sigma * Vec3(x, y, z);
}

}  // namespace

std::vector<planner::base::Track> measure(const World& world, const config::Sensing& sensing, std::uint64_t seed,
                                          std::uint64_t sequence, double t, std::span<const Vec3> vehicles) {
  std::vector<planner::base::Track> tracks;
  tracks.reserve(static_cast<std::size_t>(world.obstacle_count()));
  const bool perfect = sensing.position_noise == 0.0 && sensing.velocity_noise == 0.0;
  for (int i = 0; i < world.obstacle_count(); ++i) {
    planner::base::Track track = world.exact_track(i, t);
    const auto near = [&](const Vec3& vehicle) { return world.distance(i, vehicle, t) <= sensing.range; };
    if (std::none_of(vehicles.begin(), vehicles.end(), near)) continue;
    planner::base::RandomStream random(seed ^ kSensingStream, sequence, World::id(i));
    if (random.uniform() < sensing.dropout) continue;
    track.position += noise(random, sensing.position_noise);
    track.velocity += noise(random, sensing.velocity_noise);
    if (!perfect) track.acceleration.setZero();
    track.position_sigma = sensing.position_noise;
    track.velocity_sigma = sensing.velocity_noise;
    tracks.push_back(track);
  }
  return tracks;
}

void SensingPipeline::step(double t, const World& world, std::span<const Vec3> vehicles, double clock_start,
                           const EstimateError& error) {
  for (;; ++next_) {
    const double due = static_cast<double>(next_) / sensing_.rate;
    if (!(due <= t + kDueTolerance)) return;
    pending_.push_back(
        {next_, due, due + sensing_.delay, measure(world, sensing_, seed_, next_, due - clock_start, vehicles), 0.0});
    if (sensing_.sensed_from == config::SensedFrom::kWorld) continue;
    for (planner::base::Track& track : pending_.back().tracks) {
      track.position += error.position;
      track.velocity += error.velocity;
    }
  }
}

bool SensingPipeline::poll(double t, TrackMessage& message) {
  if (pending_.empty() || !(pending_.front().publication <= t + kDueTolerance)) return false;
  message = std::move(pending_.front());
  pending_.pop_front();
  return true;
}

}  // namespace jink::sim::world
