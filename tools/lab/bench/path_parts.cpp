// SPDX-License-Identifier: BSD-3-Clause
// The parts of horizon mode, each for itself.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/verify/verifier.hpp"
#include "tools/lab/bench/moving_world.hpp"

namespace jink::tools::lab::bench {
namespace {

/// A request at time 0 with its tracks.
struct Scene {
  explicit Scene(std::int64_t obstacles, bool boxes = false) {
    MovingWorldShape shape = world_of(static_cast<int>(obstacles));
    shape.boxes = boxes;
    const MovingWorld world(shape, 1);
    tracks = world.tracks(0.0);
    request = world.request(settings);
    request.velocity = Vec3(request.vehicle.cruise_speed, 0.0, 0.0);
    request.tracks = tracks;
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  planner::base::HorizonSettings settings;
  std::vector<planner::base::Track> tracks;
  planner::horizon::PathRequest request;
};

/// The share of one slave, with random variables of which most turn little.
void path_evaluate(benchmark::State& state) {
  const Scene scene(state.range(0), state.range(1) != 0);
  planner::horizon::PathProblem problem(scene.settings);
  problem.prepare(scene.request);
  std::vector<planner::optimizer::Cost> costs(
      static_cast<std::size_t>(scene.settings.population / scene.settings.slaves));
  std::vector<double> x(costs.size() * problem.lower().size());
  planner::base::RandomStream random(1);
  for (double& value : x) value = std::clamp(0.3 * random.normal(), -1.0, 1.0);
  for ([[maybe_unused]] auto _ : state) {
    problem.evaluate(x, costs);
    benchmark::DoNotOptimize(costs.data());
    benchmark::ClobberMemory();
  }
  state.counters["each"] = {static_cast<double>(costs.size()),
                            benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
  state.counters["near"] = static_cast<double>(problem.obstacles());
}
BENCHMARK(path_evaluate)
    ->Name("PathProblem::evaluate")
    ->ArgNames({"obstacles", "boxes"})
    ->Args({0, 0})
    ->Args({20, 0})
    ->Args({200, 0})
    ->Args({2000, 0})
    ->Args({20, 1});

void path_prepare(benchmark::State& state) {
  const Scene scene(state.range(0));
  planner::horizon::PathProblem problem(scene.settings);
  for ([[maybe_unused]] auto _ : state) {
    problem.prepare(scene.request);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(path_prepare)
    ->Name("PathProblem::prepare")
    ->ArgName("obstacles")
    ->Arg(20)
    ->Arg(200)
    ->Arg(2000)
    ->Unit(benchmark::kMicrosecond);

/// Unobstructed flight to the target.
void path_verify(benchmark::State& state) {
  const Scene scene(state.range(0));
  planner::horizon::PathProblem problem(scene.settings);
  problem.prepare(scene.request);
  const planner::base::TimedPath path = problem.motion(std::vector<double>(problem.lower().size(), 0.0));
  planner::verify::VerifierInput input;
  input.path = path;
  input.tracks = scene.tracks;
  input.vehicle_radius = scene.request.vehicle.radius;
  input.volume = scene.request.volume;
  input.acceleration_trust = scene.request.acceleration_trust;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(planner::verify::verify(input).min_clearance);
  state.counters["points"] = static_cast<double>(path.size());
}
BENCHMARK(path_verify)->Name("verify")->ArgName("tracks")->Arg(20)->Arg(200)->Arg(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace jink::tools::lab::bench
