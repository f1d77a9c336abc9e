// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/calibration/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bridge/tracking/track_table.hpp"
#include "planner/base/settings.hpp"
#include "sim/world/sensing.hpp"
#include "sim/world/world.hpp"

namespace jink::tools::lab::calibration {
namespace {

constexpr double kStep = 0.05;   // s
constexpr double kAsked = 0.25;  // s, between predictions
constexpr double kLasts = 15.0;  // s
constexpr double kRange = 12.0;  // m
constexpr double kTrust = planner::base::HorizonSettings{}.acceleration_trust;
constexpr double kMoving = 0.05;  // m/s; what stands is no test of a prediction

void judge(const bridge::prediction::Prediction& prediction, const bridge::prediction::ErrorLaws& laws,
           const sim::world::World& world, int obstacle, double t, Calibration& tally) {
  for (std::size_t i = 0; i < kLeads.size(); ++i) {
    const double lead = kLeads[i];
    const double error = (world.sphere(obstacle, t + lead).center - prediction.position(lead)).norm();
    const double sigma = prediction.sigma(lead);
    Calibration::Lead& result = tally.leads[i];
    for (std::size_t k = 0; k < kRegions.size(); ++k)
      result.inside[k] += error <= sigma * laws.at(lead).region(kRegions[k]) ? 1.0 : 0.0;
    result.squares += error * error;
    result.all += 1.0;
  }
}

}  // namespace

double Calibration::Lead::rms() const {
  return std::sqrt(squares / all);
}

void Calibration::add(const Calibration& other) {
  for (std::size_t i = 0; i < leads.size(); ++i) {
    for (std::size_t k = 0; k < kRegions.size(); ++k) leads[i].inside[k] += other.leads[i].inside[k];
    leads[i].squares += other.leads[i].squares;
    leads[i].all += other.leads[i].all;
  }
}

Calibration watch(const config::Scenario& scenario, std::uint64_t seed) {
  const sim::world::World world(scenario);
  sim::world::SensingPipeline sensing(scenario.sensing, seed);
  bridge::tracking::TrackTable table(1.0);
  Calibration tally;
  const Vec3 way = scenario.target - scenario.start;
  const double speed = 0.5 * scenario.vehicle.cruise_speed;
  double due = 0.0;
  for (double t = 0.0; t < kLasts; t += kStep) {
    const Vec3 place = scenario.start + std::min(1.0, speed * t / way.norm()) * way;
    sensing.step(t, world, place);
    for (sim::world::TrackMessage measured; sensing.poll(t, measured);) {
      bridge::tracking::TrackMessage message;
      message.writer = 1;
      message.received = t;
      message.stamp_age = t - measured.stamp;
      message.tracks = std::move(measured.tracks);
      table.ingest(message);
      table.find_self(t, place, speed * way.normalized(), scenario.vehicle.radius);
    }
    if (t < due) continue;
    due += kAsked;
    for (const bridge::prediction::Prediction& prediction : table.predictions(t, kTrust, place, kRange)) {
      const int obstacle = static_cast<int>(prediction.id) - 1;
      if (world.exact_track(obstacle, t).velocity.norm() < kMoving) continue;
      judge(prediction, table.error_laws()[prediction.motion.index()], world, obstacle, t, tally);
    }
  }
  return tally;
}

}  // namespace jink::tools::lab::calibration
