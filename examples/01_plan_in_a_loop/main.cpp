// SPDX-License-Identifier: BSD-3-Clause
// Plans again and again along a flight of 20 m past two spheres that cross, as jink does in flight: five times a
// second, each plan from where the one before has led to. No vehicle, no clock and no files: the same output each time.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

#include "planner/base/version.hpp"
#include "planner/horizon/horizon_planner.hpp"

using namespace jink::planner;

int main() {
  constexpr double kStep = 0.2;  // s, between plans
  std::array<base::Track, 2> obstacles;
  obstacles[0].position = {6.0, -6.0, 2.0};
  obstacles[0].velocity = {0.0, 2.5, 0.0};
  obstacles[1].position = {13.0, 5.0, 2.0};
  obstacles[1].velocity = {0.0, -1.0, 0.0};
  for (base::Track& obstacle : obstacles) obstacle.radius = 0.8;

  const base::HorizonSettings settings;
  horizon::HorizonPlanner planner(settings);
  base::WorkerPool pool(1);
  horizon::PathRequest request;
  request.position = {0.0, 0.0, 2.0};
  request.target = {20.0, 0.0, 2.0};
  request.volume = {{-5.0, -10.0, 0.5}, {25.0, 10.0, 8.0}};
  request.margin = settings.margin;
  base::Budget budget;
  budget.generations = settings.generations;

  std::printf("jink %s\n", JINK_VERSION);
  base::TimedPath flown;  // of the plan before, from now on
  double clearance = base::kInfinity;
  for (std::uint64_t number = 0; number < 100; ++number) {
    request.tracks = obstacles;
    const verify::Plan plan = planner.plan(request, flown, 1, number, budget, pool);
    std::printf("%4.1f s  at (%5.2f, %5.2f, %5.2f)  %s\n", kStep * static_cast<double>(number), request.position.x(),
                request.position.y(), request.position.z(), to_string(plan.status).data());
    if (plan.path.empty() || (request.position - request.target).norm() < 0.3) break;
    flown = base::remainder(plan.path, kStep);
    for (base::TimedPoint& point : flown) point.t -= kStep;
    request.position = flown.front().position;
    request.velocity = flown.front().velocity;
    for (base::Track& obstacle : obstacles) {
      obstacle.position += kStep * obstacle.velocity;
      clearance = std::min(clearance, (obstacle.position - request.position).norm() - obstacle.radius);
    }
  }
  clearance -= request.vehicle.radius;
  const bool reached = (request.position - request.target).norm() < 0.3;
  std::printf("%s; never nearer than %.2f m\n", reached ? "reached" : "not reached", clearance);
  return reached && clearance > 0.0 ? 0 : 1;
}
