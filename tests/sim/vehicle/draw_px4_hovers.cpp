// SPDX-License-Identifier: BSD-3-Clause
// The figure of docs/px4.md: a hover of the real PX4 beside one of the simulator, and how far they wander.
//   draw_px4_hovers FOLDER     writes FOLDER/px4.png
#include <algorithm>
#include <cstdio>
#include <exception>

#include "tests/sim/vehicle/px4_flights.hpp"
#include "tools/figures/figure.hpp"

namespace jink::sim::vehicle::px4 {
namespace {

using tools::figures::Kind;
using tools::figures::Panel;
using tools::figures::Series;

constexpr int kSeeds = 20;

Panel wander(const std::string& whose, const Track& track) {
  Panel panel{.title = whose, .x_label = "Time (s)", .y_label = "East of the setpoint (m)"};
  panel.y_range = {-1.5, 1.5};
  Series truth{.label = "truth", .x = {}, .kind = Kind::line, .style = 1};
  Series estimate{.label = "estimate", .x = {}, .kind = Kind::line, .style = 0};
  for (std::size_t i = 0; i < track.truth.size(); ++i) {
    for (Series* series : {&truth, &estimate}) series->x.push_back(static_cast<double>(i) * kPeriod);
    truth.y.push_back((track.truth[i] - track.setpoint[i]).x());
    estimate.y.push_back((track.estimate[i] - track.setpoint[i]).x());
  }
  panel.series = {truth, estimate};
  return panel;
}

/// For each distance the share of the samples, %, that are no farther from their setpoint.
std::vector<double> shares(const std::vector<Vec3>& offsets, const std::vector<double>& distances) {
  std::vector<double> sorted;
  sorted.reserve(offsets.size());
  for (const Vec3& offset : offsets) sorted.push_back(offset.head<2>().norm());
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> shares;
  for (const double distance : distances) {
    const auto farther = std::upper_bound(sorted.begin(), sorted.end(), distance);
    shares.push_back(100.0 * static_cast<double>(farther - sorted.begin()) / static_cast<double>(sorted.size()));
  }
  return shares;
}

/// Of the recorded hovers, and of the simulated ones what lies between the 5 % and the 95 % quantile.
template <typename Offsets>
Panel distribution(const std::string& of, const std::vector<Flown>& hovers, const std::vector<Track>& simulated,
                   Offsets offsets) {
  Panel panel{.title = of, .x_label = "Horizontal distance (m)", .y_label = "Time that is nearer (%)"};
  std::vector<double> distances;
  for (int i = 0; i <= 60; ++i) distances.push_back(0.025 * i);
  std::vector<std::vector<double>> all;
  all.reserve(simulated.size());
  for (const Track& track : simulated) all.push_back(shares(offsets(track), distances));
  Series band{.label = "simulated: median, 5 to 95 %", .x = distances, .kind = Kind::band, .style = 2};
  for (std::size_t i = 0; i < distances.size(); ++i) {
    std::vector<double> at;
    at.reserve(all.size());
    for (const std::vector<double>& one : all) at.push_back(one[i]);
    std::sort(at.begin(), at.end());
    const auto quantile = [&](double share) {
      return at[static_cast<std::size_t>(share * static_cast<double>(at.size() - 1))];
    };
    band.low.push_back(quantile(0.05));
    band.y.push_back(quantile(0.5));
    band.high.push_back(quantile(0.95));
  }
  panel.series = {band};
  for (const Flown& hover : hovers) {
    Series recorded{.label = "PX4, three hovers", .x = distances, .kind = Kind::line, .style = 0};
    recorded.y = shares(offsets(hover.track), distances);
    panel.series.push_back(recorded);
  }
  return panel;
}

void draw(const std::filesystem::path& folder) {
  std::vector<Flown> hovers;
  std::vector<Track> simulated;
  for (const std::string& name : kHovers) {
    hovers.push_back(flown(name));
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) simulated.push_back(fly(hovers.back(), seed));
  }
  tools::figures::Figure figure{.id = "px4", .title = "Hovers of PX4 and of the simulator", .panels = {}, .columns = 2};
  const auto of_truth = [](const Track& track) { return difference(track.truth, track.setpoint); };
  const auto of_estimate = [](const Track& track) { return difference(track.truth, track.estimate); };
  figure.panels = {wander("PX4 1.17", hovers.front().track), wander("Simulated", simulated.front()),
                   distribution("Truth from setpoint", hovers, simulated, of_truth),
                   distribution("Truth from estimate", hovers, simulated, of_estimate)};
  tools::figures::draw(figure, folder);
}

}  // namespace
}  // namespace jink::sim::vehicle::px4

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: draw_px4_hovers FOLDER\n", stderr);
    return 2;
  }
  try {
    jink::sim::vehicle::px4::draw(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "draw_px4_hovers: %s\n", error.what());
    return 1;
  }
  return 0;
}
