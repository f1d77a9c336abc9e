// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "tools/report/event_severity.hpp"
#include "tools/report/figure_parts.hpp"

namespace jink::tools::report {
namespace {

using jink::tools::figures::Kind;
using jink::tools::figures::Look;
using jink::tools::figures::Note;
using jink::tools::figures::Panel;
using jink::tools::figures::Series;
using Samples = std::vector<std::array<double, 2>>;  // t, value

constexpr double kCeiling = 6.0;    // m, clearance above which nothing is to be seen
constexpr double kCharacter = 1.4;  // mm, of an average one of a note

void add_curve(Panel& panel, const Samples& samples, std::string label, Kind kind, Look look) {
  if (samples.empty()) return;
  Series series{.label = std::move(label), .x = {}, .kind = kind, .look = std::move(look)};
  const auto add = [&](double x, double y) {
    series.x.push_back(x);
    series.y.push_back(y);
  };
  for (const auto& [t, v] : samples) {
    if (kind == Kind::line && !series.x.empty() && t - series.x.back() > kMissing) add(t, kNone);
    add(t, std::isfinite(v) ? v : kNone);
  }
  panel.series.push_back(std::move(series));
}

template <typename Records, typename Value>
Samples samples_of(const Records& records, const Value& value) {
  Samples samples;
  for (const auto& record : records) samples.push_back({record.t, value(record)});
  return samples;
}

const Look& own() {
  static const Look look{.colour = std::string(FigureColors::kFlown), .width = 1.2};
  return look;
}

/// From 0, or below where there is anything, to a little above the highest value up to the ceiling.
void set_range(Panel& panel, double ceiling = std::numeric_limits<double>::infinity()) {
  double low = 0.0, high = 0.5;
  for (const Series& series : panel.series) {
    for (const double v : series.y) {
      if (std::isnan(v)) continue;
      low = std::min(low, v);
      high = std::max(high, std::min(v, ceiling));
    }
  }
  panel.y_range = {low, high + 0.12 * (high - low)};
  panel.y_step = jink::tools::figures::round_step(high - low, 3.0);
}

Panel clearance_panel(const FigureFlight& flight) {
  Panel panel;
  panel.y_label = "Clearance (m)";
  const Samples samples = samples_of(flight.clearance, [](const ClearanceSample& s) { return s.distance; });
  add_curve(panel, samples, "", Kind::line, own());
  set_range(panel, kCeiling);
  if (samples.empty()) return panel;
  if (!flight.true_clearance)
    panel.notes.push_back({.x = flight.data.first,
                           .y = panel.y_range->second,
                           .text = " by the tracks",
                           .side = Note::Side::left,
                           .above = -2.5});
  panel.rules.push_back({.at = 0.0, .colour = std::string(FigureColors::kLeast), .upright = false});
  const auto [t, least] =
      *std::min_element(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a[1] < b[1]; });
  add_curve(panel, {{t, least}}, "", Kind::points, {.colour = std::string(FigureColors::kLeast), .mark_size = 1.0});
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "    least %.2f m    ", least);
  const bool left = t > flight.data.first + 0.8 * (flight.data.last - flight.data.first);
  panel.notes.push_back({.x = t,
                         .y = least,
                         .text = text.data(),
                         .colour = std::string(FigureColors::kLeast),
                         .side = left ? Note::Side::right : Note::Side::left,
                         .above = 1.6});
  return panel;
}

Panel motion_panel(const FigureFlight& flight, const char* label,
                   const std::function<double(const MotionSample&)>& value) {
  Panel panel;
  panel.y_label = label;
  add_curve(panel, samples_of(flight.data.setpoints, value), "setpoint", Kind::line,
            {.colour = "#a3adb8", .width = 1.0});
  add_curve(panel, samples_of(flight.motion(), value), "flown", Kind::line, own());
  set_range(panel);
  return panel;
}

Panel plan_panel(const FlightData& flight) {
  Panel panel;
  panel.y_label = "Plan (ms)";
  Samples free, blocked, missed;
  for (const PlanRecord& plan : flight.plans) {
    (is_blocked(plan) ? blocked : free).push_back({plan.t, plan.ms});
    if (plan.missed) missed.push_back({plan.t, plan.ms});
  }
  add_curve(panel, free, "", Kind::points, {.colour = std::string(FigureColors::kPlan), .mark_size = 0.35});
  add_curve(panel, blocked, "blocked plan", Kind::points,
            {.colour = std::string(FigureColors::kBlocked), .mark = 13, .mark_size = 0.8});
  add_curve(panel, missed, "missed deadline", Kind::points,
            {.colour = "#1c2530", .width = 0.7, .mark = 6, .mark_size = 1.0});
  set_range(panel);
  return panel;
}

/// Lines through all panels, and the names above the first where there is room.
void add_events(const FigureFlight& flight, std::vector<Panel>& panels) {
  const auto [first, last] = *panels[0].x_range;
  const double most = panels[0].frame->width, mm_per_s = most / (last - first);
  double free = 0.0;  // mm from the left
  std::vector<EventRecord> events = flight.data.events;
  std::stable_sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a.t < b.t; });
  for (const EventRecord& event : events) {
    const EventSeverity tone = event_severity(event.name, event.detail);
    if (tone == EventSeverity::kPlain) continue;
    const std::string colour = tone == EventSeverity::kGood  ? "#007a58"
                               : tone == EventSeverity::kBad ? "#c03a00"
                                                             : "#9a6400";
    for (Panel& panel : panels) panel.rules.push_back({.at = event.t, .colour = colour});
    const bool told = event.name == "fault" || event.name == "phase" || event.name == "plan_status";
    std::string text = told ? event.detail : event.name;
    text = text.substr(0, text.find_first_of(",;"));
    const double width = kCharacter * static_cast<double>(text.size());
    const double start = std::clamp((event.t - first) * mm_per_s - 0.5 * width, 0.0, std::max(0.0, most - width));
    if (start < free || width > 0.5 * most) continue;
    panels[0].notes.push_back({.x = first + (start + 0.5 * width) / mm_per_s,
                               .y = panels[0].y_range->second,
                               .text = text,
                               .colour = colour,
                               .above = 1.8});
    free = start + width + 2.0;
  }
}

}  // namespace

std::vector<Panel> time_panels(const FigureFlight& flight, const jink::tools::figures::Frame& first, double gap) {
  const auto speed = [](const MotionSample& m) { return std::hypot(m.velocity[0], m.velocity[1], m.velocity[2]); };
  const auto height = [](const MotionSample& m) { return m.position[2]; };
  std::vector<Panel> panels{clearance_panel(flight), motion_panel(flight, "Speed (m/s)", speed),
                            motion_panel(flight, "Height (m)", height), plan_panel(flight.data)};
  std::erase_if(panels, [](const Panel& panel) { return panel.series.empty(); });
  jink::tools::figures::Frame frame = first;
  const double last = std::max(flight.data.last, flight.data.first + 1e-3);
  for (Panel& panel : panels) {
    panel.frame = frame;
    frame.top += frame.height + gap;
    panel.x_range = {flight.data.first, last};
    panel.x_numbers = &panel == &panels.back();
    panel.rules.push_back({.at = flight.at, .colour = "#56626f", .dashed = true});
  }
  panels.back().x_label = "Time (s)";
  add_events(flight, panels);
  return panels;
}

}  // namespace jink::tools::report
