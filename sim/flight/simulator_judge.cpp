// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flight/simulator_judge.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdio>
#include <utility>

namespace jink::sim::flight {
namespace {

std::string at_rounded_time(double t) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), " at t = %.2f s", t);
  return text.data();
}

int severity(bridge::supervisor::Outcome outcome) {
  switch (outcome) {
    case bridge::supervisor::Outcome::kCollision:
      return 3;
    case bridge::supervisor::Outcome::kLeftWorld:
      return 2;
    case bridge::supervisor::Outcome::kReached:
      return 0;
    default:
      return 1;
  }
}

}  // namespace

bridge::supervisor::Outcome worst(std::span<const VehicleReport> reports) {
  const auto found = std::max_element(reports.begin(), reports.end(), [](const auto& a, const auto& b) {
    return severity(a.flight.outcome) < severity(b.flight.outcome);
  });
  return found == reports.end() ? bridge::supervisor::Outcome::kNone : found->flight.outcome;
}

SimulatorJudge::SimulatorJudge(const world::World& world, std::vector<config::ScenarioVehicle> vehicles,
                               std::span<const Vec3> positions)
    : world_(world),
      vehicles_(std::move(vehicles)),
      last_(positions.begin(), positions.end()),
      reports_(vehicles_.size()) {
  assert(last_.size() == vehicles_.size());
  for (std::size_t k = 0; k < vehicles_.size(); ++k) {
    reports_[k].flight.straight_length = (vehicles_[k].target - vehicles_[k].start).norm();
  }
}

std::vector<Verdict> SimulatorJudge::watch(double t, bool clock_runs, std::span<const JudgedVehicle> now) {
  assert(now.size() == vehicles_.size());
  std::vector<Verdict> verdicts;
  judge_collisions(t, now, verdicts);
  for (std::size_t k = 0; k < now.size(); ++k) {
    if (clock_runs) judge_progress(k, t, now[k], verdicts);
    last_[k] = now[k].position;
  }
  last_t_ = t;
  return verdicts;
}

void SimulatorJudge::judge_collisions(double t, std::span<const JudgedVehicle> now, std::vector<Verdict>& verdicts) {
  for (std::size_t k = 0; k < now.size(); ++k) judge_obstacles(k, t, now[k].position, verdicts);
  for (std::size_t a = 0; a < now.size(); ++a) {
    for (std::size_t b = a + 1; b < now.size(); ++b) judge_pair(a, b, t, now, verdicts);
  }
}

void SimulatorJudge::judge_obstacles(std::size_t k, double t, const Vec3& to, std::vector<Verdict>& verdicts) {
  if (reports_[k].failed()) return;
  const world::SweepResult sweep = world_.sweep(last_[k], last_t_, to, t, vehicles_[k].vehicle.radius);
  reports_[k].min_clearance = std::min(reports_[k].min_clearance, sweep.min_clearance);
  if (sweep.min_clearance >= 0.0) return;
  hit(k, world_.name(sweep.obstacle), sweep.t_min, verdicts);
}

// One that has failed falls or flies on, and can still be hit by another.
void SimulatorJudge::judge_pair(std::size_t a, std::size_t b, double t, std::span<const JudgedVehicle> now,
                                std::vector<Verdict>& verdicts) {
  if (reports_[a].failed() && reports_[b].failed()) return;
  const world::SweepResult nearest = world::sweep({last_[a], now[a].position, vehicles_[a].vehicle.radius},
                                                  {last_[b], now[b].position, vehicles_[b].vehicle.radius}, last_t_, t);
  for (const auto& [k, other] : {std::pair(a, b), std::pair(b, a)}) {
    if (reports_[k].failed()) continue;
    reports_[k].min_clearance = std::min(reports_[k].min_clearance, nearest.min_clearance);
    if (nearest.min_clearance < 0.0) hit(k, "vehicle " + std::to_string(other), nearest.t_min, verdicts);
  }
}

void SimulatorJudge::judge_progress(std::size_t k, double t, const JudgedVehicle& now, std::vector<Verdict>& verdicts) {
  bridge::companion::FlightSummary& flight = reports_[k].flight;
  if (flight.outcome != bridge::supervisor::Outcome::kNone) return;
  flight.flight_time = t;
  flight.path_length += (now.position - last_[k]).norm();
  flight.max_speed = std::max(flight.max_speed, now.velocity.norm());
  if (!world_.inside(now.position) && now.offboard) {
    decide(k, bridge::supervisor::Outcome::kLeftWorld, "left the world" + at_rounded_time(t), verdicts);
  } else if ((now.position - vehicles_[k].target).norm() <= kAtTarget) {
    decide(k, bridge::supervisor::Outcome::kReached, "the vehicle came to the target" + at_rounded_time(t), verdicts);
  }
}

void SimulatorJudge::hit(std::size_t k, const std::string& what, double t, std::vector<Verdict>& verdicts) {
  decide(k, bridge::supervisor::Outcome::kCollision, "hit " + what + at_rounded_time(t), verdicts);
}

void SimulatorJudge::decide(std::size_t k, bridge::supervisor::Outcome outcome, std::string reason,
                            std::vector<Verdict>& verdicts) {
  reports_[k].flight.outcome = outcome;
  reports_[k].flight.reason = reason;
  verdicts.push_back({static_cast<int>(k), outcome, std::move(reason)});
}

}  // namespace jink::sim::flight
