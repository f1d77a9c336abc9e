// SPDX-License-Identifier: BSD-3-Clause
// Whether what is stated of where movers will be is true: how often they are in the regions stated.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/tracking/track_table.hpp"
#include "planner/base/settings.hpp"
#include "sim/families/families.hpp"
#include "sim/families/recorded.hpp"
#include "sim/world/sensing.hpp"
#include "sim/world/world.hpp"
#include "tools/lab/bench/measure.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr std::array kLeads = {0.5, 1.0, 2.0};  // s
/// Of the chi-square distribution of three degrees of freedom: squared radii of the 50, 90 and 99 % regions.
constexpr std::array kRegions = {2.366, 6.251, 11.345};
constexpr double kStep = 0.05;   // s
constexpr double kAsked = 0.25;  // s, between predictions that are held against the truth
constexpr double kLasts = 15.0;  // s
constexpr double kRange = 12.0;  // m
constexpr double kTrust = planner::base::HorizonSettings{}.acceleration_trust;
constexpr double kMoving = 0.05;  // m/s; what stands is no test of a prediction

struct Calibration {
  struct Lead {
    std::array<double, kRegions.size()> inside{};
    double squares = 0.0, all = 0.0;

    void add(const Lead& other) {
      for (std::size_t i = 0; i < inside.size(); ++i) inside[i] += other.inside[i];
      squares += other.squares;
      all += other.all;
    }
  };
  std::array<Lead, kLeads.size()> leads;

  void add(const Calibration& other) {
    for (std::size_t i = 0; i < leads.size(); ++i) leads[i].add(other.leads[i]);
  }
  [[nodiscard]] std::vector<std::string> cells(const std::string& name) const {
    std::vector<std::string> cells{name, fmt::format("{:.0f}", leads[0].all)};
    for (const Lead& lead : leads) {
      for (const double inside : lead.inside) cells.push_back(fmt::format("{:.1f}", 100.0 * inside / lead.all));
      cells.push_back(fmt::format("{:.2f}", std::sqrt(lead.squares / lead.all)));
    }
    return cells;
  }
};

/// What a vehicle that flies straight to the target, and through everything, predicts on its way.
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
      for (std::size_t i = 0; i < kLeads.size(); ++i) {
        const double lead = kLeads[i];
        const double squared = (world.sphere(obstacle, t + lead).center - prediction.position(lead)).squaredNorm();
        const double sigma = prediction.sigma(lead);
        Calibration::Lead& result = tally.leads[i];
        for (std::size_t k = 0; k < kRegions.size(); ++k)
          result.inside[k] += squared <= kRegions[k] * sigma * sigma ? 1.0 : 0.0;
        result.squares += squared;
        result.all += 1.0;
      }
    }
  }
  return tally;
}

}  // namespace

void bench_prediction(const Options& options) {
  print_title(
      "prediction",
      fmt::format("Realistic tracks: how often a mover is in the region stated for 50, 90 and 99 %, and the root "
                  "mean square of the error, m, at {}, {} and {} s; {} worlds of each family for {} s.",
                  kLeads[0], kLeads[1], kLeads[2], options.seeds, kLasts));
  Table table({"movers", "predictions", "50 %", "90", "99", "0.5 s, m", "50 %", "90", "99", "1 s, m", "50 %", "90",
               "99", "2 s, m"});
  Calibration all;
  const auto add = [&](const std::string& name, const auto& make) {
    Calibration calibration;
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(options.seeds); ++seed) {
      config::Scenario scenario = make(seed);
      set_tier(scenario, sim::families::Tier::kRealistic, seed);
      calibration.add(watch(scenario, seed));
    }
    if (calibration.leads[0].all == 0.0) return;
    all.add(calibration);
    table.row(calibration.cells(name));
  };
  for (const std::string_view family : sim::families::world_families())
    add(std::string(family), [family](std::uint64_t seed) { return sim::families::make_world(family, seed); });
  for (const std::string& file : options.recordings) {
    const sim::recorded::Recording recording = sim::recorded::load_recording(file);
    add(std::filesystem::path(file).filename().string(),
        [&](std::uint64_t seed) { return sim::families::make_recorded_world(recording, seed); });
  }
  table.row(all.cells("all"));
  table.print();
}

}  // namespace jink::tools::lab::bench
