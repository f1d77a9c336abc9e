// SPDX-License-Identifier: BSD-3-Clause
// From clouds of points to a map, by a vehicle that flies through a hall of pillars.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <vector>

#include "bridge/map/mapper.hpp"
#include "sim/world/scan.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr int kClouds = 60;                // of a way of 12 m
constexpr double kCloudStep = 0.2;         // m, from one to the next
constexpr double kCloudPeriod = 1.0 / 15;  // s, likewise

config::Scenario hall() {
  config::Scenario scenario;
  scenario.start = {0, 0, 1.5};
  scenario.target = {20, 0, 1.5};
  scenario.map = {{config::BoxShape{{40, 0.2, 4}}, config::LinearMotion{{10, 5, 2}}, {0.1, 0, 0}},
                  {config::BoxShape{{40, 0.2, 4}}, config::LinearMotion{{10, -5, 2}}, {-0.1, 0, 0}},
                  {config::BoxShape{{0.2, 12, 4}}, config::LinearMotion{{19, 0, 2}}}};
  for (double x = 4.0; x < 18.0; x += 3.5)
    scenario.map.push_back({config::CylinderShape{0.3, 4}, config::LinearMotion{{x, 2.0 * std::sin(x), 2}}});
  return scenario;
}

std::vector<bridge::map::CloudJob> clouds(const config::Scan& sensor) {
  const sim::world::World world(hall());
  std::vector<bridge::map::CloudJob> jobs;
  for (int i = 0; i < kClouds; ++i) {
    bridge::map::CloudJob& job = jobs.emplace_back();
    job.time = kCloudPeriod * i;
    job.vehicle = job.sensor = {kCloudStep * i, 0.0, 1.5};
    job.to_local = Eigen::Translation3d(job.vehicle);
    job.floor = 0.3;
    job.points = sim::world::scan(world, sensor, 1, static_cast<std::uint64_t>(i), 0.0, 0.0, job.to_local);
  }
  return jobs;
}

/// A cloud of 160 by 125 points into cells, boxes and a map of these.
void map_update(benchmark::State& state) {
  config::Scan sensor = config::depth_camera();
  sensor.columns = 160;
  sensor.rows = 125;
  sensor.noise = 0.02;
  if (state.range(0) != 0) sensor.horizontal_deg = 360.0;
  sensor.range = static_cast<double>(state.range(1));
  const std::vector<bridge::map::CloudJob> jobs = clouds(sensor);
  bridge::map::Mapper mapper({sensor.range, 60.0}, 0.3, std::make_shared<const planner::geometry::StaticMap>(),
                             nullptr);
  std::size_t next = 0;
  double time = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    bridge::map::CloudJob job = jobs[next++ % jobs.size()];
    job.time = time += kCloudPeriod;
    mapper.put(std::move(job));
  }
  state.counters["boxes"] = static_cast<double>(mapper.seen()->boxes.size());
}
BENCHMARK(map_update)
    ->Name("Mapper::put, 20000 points")
    ->ArgNames({"all_round", "range"})
    ->Args({0, 8})
    ->Args({1, 12})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace jink::tools::lab::bench
