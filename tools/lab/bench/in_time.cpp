// SPDX-License-Identifier: BSD-3-Clause
// A way in space and time, where one is looked for.
#include <benchmark/benchmark.h>

#include <vector>

#include "planner/base/solid.hpp"
#include "planner/horizon/safe_intervals.hpp"
#include "tools/lab/bench/moving_world.hpp"

namespace jink::tools::lab::bench {
namespace {

/// Behind a plate that leaves no way, so that as many places are looked at as ever are.
void in_time(benchmark::State& state) {
  MovingWorldShape shape = world_of(static_cast<int>(state.range(0)));
  shape.boxes = true;
  std::vector<planner::base::Track> tracks = MovingWorld(shape, 1).tracks(0.0);
  planner::base::Track plate;
  plate.body.solid = planner::base::Solid::box({0.5, 100.0, 100.0}, {});
  plate.radius = plate.body.solid->reach();
  plate.velocity = {0.1, 0.0, 0.0};
  plate.position = {10.0, 0.0, 0.0};
  tracks.push_back(plate);
  planner::horizon::PathRequest request;
  request.target = {18.0, 0.0, 4.0};
  request.position = {-18.0, 0.0, 4.0};
  request.margin = 0.35;
  request.tracks = tracks;
  planner::horizon::SafeIntervalSearch search;
  for ([[maybe_unused]] auto _ : state)
    benchmark::DoNotOptimize(search.find(request, {0.0, request.position, Vec3::Zero(), Vec3::Zero()}, 0.5));
}
BENCHMARK(in_time)->ArgName("boxes")->Arg(20)->Arg(200)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace jink::tools::lab::bench
