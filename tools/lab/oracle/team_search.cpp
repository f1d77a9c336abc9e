// SPDX-License-Identifier: BSD-3-Clause
// Flights for all vehicles of a team whose world's future is known: find_flights() of judge.hpp.
#include <utility>

#include "sim/world/world.hpp"
#include "tools/lab/oracle/feasibility.hpp"

namespace jink::tools::lab::oracle {
namespace {

/// A vehicle that keeps to its flight and stays at its target, as an obstacle for those who come after it.
config::Obstacle obstacle_of(const Flight& flight, double radius) {
  config::WaypointsMotion motion;
  for (const TimedPoint& point : flight.path) {
    motion.times.push_back(point.t);
    motion.points.push_back(point.position);
  }
  return {config::SphereShape{radius}, std::move(motion)};
}

}  // namespace

config::Scenario alone(const config::Scenario& scenario, std::size_t vehicle) {
  const config::ScenarioVehicle own = config::all_vehicles(scenario).at(vehicle);
  config::Scenario result = scenario;
  result.start = own.start;
  result.target = own.target;
  result.vehicle_name = own.vehicle_name;
  result.vehicle = own.vehicle;
  result.vehicles.clear();
  return result;
}

// Each in turn avoids those before it: the later ones' starts are theirs to leave, as their flights begin at t = 0 too.
std::vector<Flight> find_flights(const config::Scenario& scenario, const OracleOptions& options) {
  std::vector<Flight> flights;
  std::vector<config::Obstacle> others;
  for (std::size_t k = 0; k <= scenario.vehicles.size(); ++k) {
    config::Scenario own = alone(scenario, k);
    own.obstacles.insert(own.obstacles.end(), others.begin(), others.end());
    std::optional<Flight> flight = find_flight(own, options);
    if (!flight) return {};
    others.push_back(obstacle_of(*flight, own.vehicle.radius));
    flights.push_back(*std::move(flight));
  }
  return flights;
}

}  // namespace jink::tools::lab::oracle
