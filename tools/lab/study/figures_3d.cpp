// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "planner/geometry/obstacle_motion.hpp"
#include "tools/lab/study/figures.hpp"

namespace jink::tools::lab::study {
namespace {

constexpr std::array<double, 4> kMoments{0.15, 0.4, 0.65, 0.9};  // shares of the flight that are pictured
constexpr double kArrow = 0.4;                                   // s, of motion that an arrow shows
constexpr std::size_t kSeeds = 4;
constexpr double kAround = 2.0;  // m, shown beyond the path

Vec3 point(const Record& r, std::size_t i) {
  return {r.series.at(key::kX)[i], r.series.at(key::kY)[i], r.series.at(key::kZ)[i]};
}

void append(figures::Series& series, const Vec3& p) {
  series.x.push_back(p.x());
  series.y.push_back(p.y());
  series.z.push_back(p.z());
}

figures::Series path_series(const Record& r, std::string label, int style) {
  figures::Series series;
  series.label = std::move(label);
  series.kind = figures::Kind::line;
  series.style = style;
  for (std::size_t i = 0; i < r.series.at(key::kT).size(); ++i) append(series, point(r, i));
  return series;
}

Vec3 position_at(const Record& r, double t) {
  const std::vector<double>& times = r.series.at(key::kT);
  const auto after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
  if (after == 0) return point(r, 0);
  if (after == times.size()) return point(r, after - 1);
  const double share = (t - times[after - 1]) / (times[after] - times[after - 1]);
  return point(r, after - 1) + share * (point(r, after) - point(r, after - 1));
}

/// What has been flown by then, with the vehicle's place at its end.
figures::Series flown_series(const Record& r, double t, int style) {
  figures::Series series;
  series.label = "flown";
  series.kind = figures::Kind::line_points;
  series.style = style;
  const std::vector<double>& times = r.series.at(key::kT);
  for (std::size_t i = 0; i < times.size() && times[i] < t; ++i) append(series, point(r, i));
  append(series, position_at(r, t));
  return series;
}

figures::Panel space_panel(const World& world) {
  figures::Panel panel;
  panel.x_label = "x (m)";
  panel.y_label = "y (m)";
  panel.z_label = "z (m)";
  const Vec3 low = world.start.cwiseMin(world.target);
  const Vec3 high = world.start.cwiseMax(world.target);
  panel.x_range = {low.x() - kAround, high.x() + kAround};
  panel.y_range = {low.y() - kAround, high.y() + kAround};
  panel.z_range = {low.z(), high.z() + 2.0 * kAround};
  return panel;
}

/// Obstacles at time t, those within the panel.
void add_obstacles(figures::Panel& panel, const World& world, double t) {
  const auto inside = [](double v, const std::optional<std::pair<double, double>>& range) {
    return v >= range->first && v <= range->second;
  };
  for (const planner::base::Track& track : world.tracks) {
    const Vec3 p = planner::geometry::predict_position(track, t);
    const Vec3 to = planner::geometry::predict_position(track, t + kArrow);
    if (inside(p.x(), panel.x_range) && inside(p.y(), panel.y_range) && inside(p.z(), panel.z_range))
      panel.spheres.push_back({p.x(), p.y(), p.z(), track.radius, to.x(), to.y(), to.z()});
  }
}

}  // namespace

std::vector<CaptionedFigure> picture_figures(const Selection& selection, const Setting& setting, bool blocked) {
  std::vector<CaptionedFigure> figures;
  int figure_number = 9;
  for (const std::string& name : pictured_worlds(blocked)) {
    const Records records = selection.paths(kRetained, name);
    CaptionedFigure one;
    one.figure.id = fmt::format("figure{:02}{}", figure_number++, blocked ? "-blocked" : "");
    one.figure.title = fmt::format("Path among moving obstacles, instance {}", world_number(name));
    one.figure.columns = 2;
    if (!records.empty()) {
      const Record& r = *records.front();
      const World world = setting.scenes.world(name, 0);
      one.caption = fmt::format(
          "{} {} of Table 12: the first run's path of {} at four times. Spheres are the obstacles that are near, at "
          "their size; arrows show {} s of their motion. The path {}, {:.3f} m clear at the least.",
          blocked ? "Blocked version of instance" : "Instance", world_number(name), label_of(kRetained), kArrow,
          r.value(key::kReached) > 0.0 ? "is free" : "is not free", r.value(key::kClearance));
      for (const double share : kMoments) {
        const double t = share * r.value(key::kFlight);
        figures::Panel panel = space_panel(world);
        panel.title = fmt::format("t = {:.2f} s", t);
        panel.series = {path_series(r, "planned", 1), flown_series(r, t, 0)};
        add_obstacles(panel, world, t);
        one.figure.panels.push_back(std::move(panel));
      }
    }
    figures.push_back(std::move(one));
  }
  return figures;
}

CaptionedFigure seeds_figure(const Selection& selection, const Setting& setting) {
  CaptionedFigure result;
  result.figure.id = "figure12";
  result.figure.title = "Four seeds in the same world";
  result.figure.columns = 2;
  result.caption = fmt::format(
      "Paths of {} with the first four seeds in instance 1 of Table 12 and in its blocked version, with the obstacles "
      "at half the flight time.",
      label_of(kRetained));
  for (const bool blocked : {false, true}) {
    const std::string name = pictured_worlds(blocked).front();
    const Records records = selection.paths(kRetained, name);
    if (records.empty()) continue;
    const World world = setting.scenes.world(name, 0);
    figures::Panel panel = space_panel(world);
    panel.title = blocked ? "blocked" : "instance 1";
    for (std::size_t i = 0; i < std::min(kSeeds, records.size()); ++i)
      panel.series.push_back(
          path_series(*records[i], fmt::format("run {}", records[i]->job.run + 1), static_cast<int>(i)));
    add_obstacles(panel, world, 0.5 * records.front()->value(key::kFlight));
    result.figure.panels.push_back(std::move(panel));
  }
  return result;
}

}  // namespace jink::tools::lab::study
