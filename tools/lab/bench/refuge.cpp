// SPDX-License-Identifier: BSD-3-Clause
// To decide before a plan whether it is to lead to a refuge, among movers that nobody understands.
#include <benchmark/benchmark.h>

#include <vector>

#include "bridge/companion/retreat.hpp"
#include "planner/base/random.hpp"

namespace jink::tools::lab::bench {
namespace {

/// All places are looked at each time: the vehicle hovers among them, and what is flown is as bad as can be.
void refuge(benchmark::State& state) {
  planner::base::RandomStream random(1, 1);
  std::vector<bridge::prediction::Prediction> movers(static_cast<std::size_t>(state.range(0)));
  for (bridge::prediction::Prediction& mover : movers) {
    planner::base::Track track;
    for (int axis = 0; axis < 3; ++axis) {
      track.position[axis] = random.uniform(-8.0, 8.0);
      track.velocity[axis] = random.uniform(-3.0, 3.0);
    }
    mover.motion = track;
    mover.radius = 0.7;
    mover.acceleration_sigma = 5.0;
  }
  planner::horizon::PathRequest request;
  request.target = {70.0, 0.0, 0.0};
  request.margin = 0.35;
  const planner::base::TimedPath stays{{0.0, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
  bridge::companion::Retreat retreat{planner::base::HorizonSettings{}};
  const bridge::prediction::LawsByKind laws;
  double now = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(retreat.choose(now, request, stays, movers, laws));
    now += 0.05;
  }
}
BENCHMARK(refuge)->ArgName("movers")->Arg(5)->Arg(50)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace jink::tools::lab::bench
