// SPDX-License-Identifier: BSD-3-Clause
// Plans again and again along a flight of 20 m past two spheres that cross, as jink does in flight: five times a
// second, each plan from where the one before has led to. No vehicle and no clock: the same output each time.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

#include "planner/geometry/obstacle_motion.hpp"
#include "planner/horizon/horizon_planner.hpp"

using namespace jink::planner;

int main() {
  constexpr double kStep = 0.2;  // s, between plans
  std::array<base::Track, 2> obstacles;
  obstacles[0].position = {6, -6, 2};
  obstacles[0].velocity = {0, 2.5, 0};
  obstacles[1].position = {13, 5, 2};
  obstacles[1].velocity = {0, -1, 0};
  for (base::Track& obstacle : obstacles) obstacle.radius = 0.8;

  const base::HorizonSettings settings;
  horizon::HorizonPlanner planner(settings);
  base::WorkerPool pool(1);
  base::Budget budget;
  budget.generations = settings.generations;  // in flight also a deadline
  auto request = horizon::PathRequest::with(settings);
  request.position = {0, 0, 2};
  request.target = {20, 0, 2};
  request.volume = {{-5, -10, 0.5}, {25, 10, 8}};
  request.tracks = obstacles;

  base::TimedPath flown;  // the plan before, from now on
  bool reached = false;
  double clearance = base::kInfinity;
  for (std::uint64_t number = 0; number < 100 && !reached; ++number) {
    const verify::Plan plan = planner.plan(request, flown, 1, number, budget, pool);
    std::printf("%4.1f s  at (%5.2f, %5.2f, %5.2f)  %s\n", kStep * static_cast<double>(number), request.position.x(),
                request.position.y(), request.position.z(), to_string(plan.status).data());
    if (plan.path.empty()) break;
    flown = base::later(plan.path, kStep);
    request.position = flown.front().position;
    request.velocity = flown.front().velocity;
    for (base::Track& obstacle : obstacles) {
      obstacle = geometry::predict(obstacle, kStep);
      const double distance = (obstacle.position - request.position).norm();
      clearance = std::min(clearance, distance - obstacle.radius - request.vehicle.radius);
    }
    reached = (request.position - request.target).norm() < settings.near_target;
  }
  std::printf("%s; never nearer than %.2f m\n", reached ? "reached" : "not reached", clearance);
  return reached && clearance > 0 ? 0 : 1;
}
