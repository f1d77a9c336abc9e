// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flight/closed_loop_judge.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace jink::sim::flight {
namespace {

std::string at_time(double t) {
  return " at t = " + std::to_string(t) + " s";
}

/// The flight of all: the first vehicle's figures under that outcome, with the reasons of those that it befell, once
/// where it is the same for all.
void sum_up(bridge::supervisor::Outcome outcome, ClosedLoopResult& result) {
  result.flight = result.vehicles.front().flight;
  const auto as_first = [&](const VehicleReport& report) {
    return report.flight.outcome == outcome && report.flight.reason == result.flight.reason;
  };
  result.flight.outcome = outcome;
  if (std::all_of(result.vehicles.begin(), result.vehicles.end(), as_first)) return;
  result.flight.reason.clear();
  for (std::size_t k = 0; k < result.vehicles.size(); ++k) {
    const bridge::companion::FlightSummary& flight = result.vehicles[k].flight;
    if (flight.outcome != outcome) continue;
    result.flight.reason +=
        (result.flight.reason.empty() ? "vehicle " : "; vehicle ") + std::to_string(k) + ": " + flight.reason;
  }
}

}  // namespace

ClosedLoopJudge::ClosedLoopJudge(const world::World& world)
    : world_(world),
      vehicles_(config::all_vehicles(world.scenario())),
      reports_(vehicles_.size()),
      closed_(vehicles_.size(), false) {
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    last_.push_back(vehicles_[k].start);
    reports_[k].flight.straight_length = (vehicles_[k].target - vehicles_[k].start).norm();
  }
}

std::optional<ClosedLoopResult> ClosedLoopJudge::start_blocked() const {
  ClosedLoopResult result;
  result.vehicles = reports_;
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    VehicleReport& report = result.vehicles[k];
    std::string reason;
    report.min_clearance = world_.clearance(vehicles_[k].start, 0.0, vehicles_[k].vehicle.radius);
    if (report.min_clearance < 0.0) reason = "the start is inside an obstacle";
    for (std::size_t j = 0; j < vehicles_.size(); ++j) {
      if (j == k) continue;
      const double apart =
          (vehicles_[k].start - vehicles_[j].start).norm() - vehicles_[k].vehicle.radius - vehicles_[j].vehicle.radius;
      report.min_clearance = std::min(report.min_clearance, apart);
      if (apart < 0.0 && reason.empty()) reason = "the start is inside vehicle " + std::to_string(j);
    }
    result.min_clearance = std::min(result.min_clearance, report.min_clearance);
    if (reason.empty()) continue;
    report.flight.outcome = bridge::supervisor::Outcome::kStartBlocked;
    report.flight.reason = reason;
    result.flight.outcome = bridge::supervisor::Outcome::kStartBlocked;
  }
  if (result.flight.outcome == bridge::supervisor::Outcome::kNone) return std::nullopt;
  sum_up(result.flight.outcome, result);
  return result;
}

bool ClosedLoopJudge::watch(double t, std::span<const world::VehicleTruth> now) {
  assert(now.size() == vehicles_.size());
  for (std::size_t k = 0; k < now.size(); ++k) {
    watch_obstacles(k, t, now[k].position);
    for (std::size_t j = 0; j < k; ++j) watch_pair(j, k, t, now);
  }
  for (std::size_t k = 0; k < now.size(); ++k) {
    const Vec3 from = std::exchange(last_[k], now[k].position);
    if (closed_[k]) continue;
    if (!world_.inside(now[k].position))
      fail(k, bridge::supervisor::Outcome::kLeftWorld, "left the world" + at_time(t));
    bridge::companion::FlightSummary& flight = reports_[k].flight;
    flight.max_speed = std::max(flight.max_speed, now[k].velocity.norm());
    flight.path_length += (now[k].position - from).norm();
    flight.flight_time = t;
  }
  last_t_ = t;
  return ended();
}

void ClosedLoopJudge::watch_obstacles(std::size_t k, double t, const Vec3& to) {
  const world::SweepResult nearest = world_.sweep(last_[k], last_t_, to, t, vehicles_[k].vehicle.radius);
  reports_[k].min_clearance = std::min(reports_[k].min_clearance, nearest.min_clearance);
  if (nearest.min_clearance >= 0.0) return;
  fail(k, bridge::supervisor::Outcome::kCollision, "hit " + world_.name(nearest.obstacle) + at_time(nearest.t_min));
}

void ClosedLoopJudge::watch_pair(std::size_t a, std::size_t b, double t, std::span<const world::VehicleTruth> now) {
  const world::SweepResult nearest = world::sweep({last_[a], now[a].position, vehicles_[a].vehicle.radius},
                                                  {last_[b], now[b].position, vehicles_[b].vehicle.radius}, last_t_, t);
  for (const auto& [k, other] : {std::pair(a, b), std::pair(b, a)}) {
    reports_[k].min_clearance = std::min(reports_[k].min_clearance, nearest.min_clearance);
    if (nearest.min_clearance < 0.0)
      fail(k, bridge::supervisor::Outcome::kCollision, "hit vehicle " + std::to_string(other) + at_time(nearest.t_min));
  }
}

void ClosedLoopJudge::fail(std::size_t k, bridge::supervisor::Outcome outcome, const std::string& reason) {
  bridge::companion::FlightSummary& flight = reports_[k].flight;
  if (flight.outcome != bridge::supervisor::Outcome::kNone) return;
  flight.outcome = outcome;
  flight.reason = reason;
}

bool ClosedLoopJudge::ended() const {
  return std::any_of(reports_.begin(), reports_.end(), [](const VehicleReport& report) {
    return report.flight.outcome != bridge::supervisor::Outcome::kNone;
  });
}

ClosedLoopResult ClosedLoopJudge::result(std::vector<bridge::companion::FlightSummary> seen) const {
  ClosedLoopResult result;
  result.vehicles = reports_;
  for (std::size_t k = 0; k < reports_.size(); ++k) {
    const bridge::companion::FlightSummary& judged = reports_[k].flight;
    bridge::companion::FlightSummary& flight = result.vehicles[k].flight;
    flight = std::move(seen[k]);
    flight.flight_time = judged.flight_time;
    flight.path_length = judged.path_length;
    flight.straight_length = judged.straight_length;
    flight.max_speed = judged.max_speed;
    if (judged.outcome != bridge::supervisor::Outcome::kNone) {
      flight.outcome = judged.outcome;
      flight.reason = judged.reason;
    }
    result.min_clearance = std::min(result.min_clearance, reports_[k].min_clearance);
  }
  sum_up(worst(result.vehicles), result);
  return result;
}

}  // namespace jink::sim::flight
