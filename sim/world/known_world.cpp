// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/known_world.hpp"

#include <algorithm>

#include "sim/world/world.hpp"

namespace jink::sim::world {
namespace {

// The tracks are taken as exact, so what is left to keep is the verifier's own accuracy and a hand's breadth.
constexpr double kMargin = 0.05;  // m

}  // namespace

KnownWorld::KnownWorld(const config::Scenario& scenario) {
  const World world(scenario);
  for (int i = 0; i < world.obstacle_count(); ++i) {
    tracks.push_back(world.exact_track(i, 0.0));
    spheres.push_back(tracks.back());
    spheres.back().body = {};
  }
  volume.min.z() = std::min({0.0, scenario.start.z(), scenario.target.z()});
  if (scenario.world) volume = *scenario.world;
  open_loop.path.position = scenario.start;
  open_loop.path.target = scenario.target;
  open_loop.path.volume = volume;
  open_loop.path.vehicle = scenario.vehicle;
  open_loop.path.tracks = tracks;
  open_loop.path.margin = kMargin;
  map = world.map();
  open_loop.map = map.get();
  open_loop.time_limit = scenario.time_limit;
}

}  // namespace jink::sim::world
