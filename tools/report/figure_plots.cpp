// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "tools/report/event_severity.hpp"
#include "tools/report/figure_parts.hpp"

namespace jink::tools::report {
namespace {

constexpr double kGap = 3.0;         // mm, between panels
constexpr double kCeiling = 6.0;     // m, clearance above which nothing is to be seen
constexpr double kMissing = 1.0;     // s without a sample, which the line leaves open
constexpr double kSheetLimit = 1e4;  // mm, beyond which nothing is drawn

struct Curve {
  std::vector<Spot> samples{};  ///< t, value
  Pen pen{};
};

struct Panel {
  std::string title{}, unit{};
  std::vector<Curve> curves{};
  double floor = 0.0;
  double ceiling = std::numeric_limits<double>::infinity();
};

/// A panel's place on the sheet and its scales.
struct Axes {
  Frame frame{};
  double first = 0.0, last = 1.0, low = 0.0, high = 1.0;

  [[nodiscard]] double x(double t) const {
    return frame.x + (last > first ? (t - first) / (last - first) : 0.0) * frame.width;
  }
  [[nodiscard]] double y(double v) const {
    return std::clamp(frame.y + (1.0 - (v - low) / (high - low)) * frame.height, -kSheetLimit, kSheetLimit);
  }
};

Curve curve_of(const std::vector<MotionSample>& motion, const std::function<double(const MotionSample&)>& value,
               Pen pen) {
  Curve curve{{}, std::move(pen)};
  for (const MotionSample& sample : motion) curve.samples.push_back({sample.t, value(sample)});
  return curve;
}

std::vector<Panel> panels_of(const FigureFlight& flight) {
  const auto speed = [](const MotionSample& m) { return std::hypot(m.velocity[0], m.velocity[1], m.velocity[2]); };
  const auto height = [](const MotionSample& m) { return m.position[2]; };
  const Pen own{.color = FigureColors::kFlown, .width = 0.4}, asked{.color = "#a3adb8", .width = 0.3};
  Panel gap{.title = flight.true_clearance ? "clearance" : "clearance (from tracks)", .unit = "m", .ceiling = kCeiling};
  gap.curves.push_back({{}, own});
  for (const ClearanceSample& sample : flight.clearance) gap.curves[0].samples.push_back({sample.t, sample.distance});
  Panel fast{.title = "speed", .unit = "m/s"}, high{.title = "height", .unit = "m"};
  for (const auto& [panel, value] :
       {std::pair<Panel*, std::function<double(const MotionSample&)>>{&fast, speed}, {&high, height}}) {
    panel->curves.push_back(curve_of(flight.data.setpoints, value, asked));
    panel->curves.push_back(curve_of(flight.motion(), value, own));
  }
  return {gap, fast, high, {.title = "plan time", .unit = "ms"}};
}

void find_range(const Panel& panel, const FlightData& flight, Axes& axes) {
  axes.low = panel.floor;
  axes.high = axes.low + 0.5;
  const auto include = [&](double v) {
    axes.low = std::min(axes.low, v);
    axes.high = std::max(axes.high, std::min(v, panel.ceiling));
  };
  for (const Curve& curve : panel.curves) {
    for (const Spot& sample : curve.samples) include(sample[1]);
  }
  if (panel.curves.empty()) {
    for (const PlanRecord& plan : flight.plans) include(plan.ms);
  }
  axes.high += 0.12 * (axes.high - axes.low);
}

void draw_scales(Canvas& canvas, const Panel& panel, const Axes& axes) {
  const Frame& f = axes.frame;
  const Pen grid{.color = "#dde3e9", .width = 0.15};
  for (const double t : ticks_of(axes.first, axes.last, f.width / 16.0).values)
    canvas.line(std::array<Spot, 2>{{{axes.x(t), f.y}, {axes.x(t), f.y + f.height}}}, grid);
  const Ticks ticks = ticks_of(axes.low, axes.high, 3.0);
  for (const double v : ticks.values) {
    const bool contact = v == 0.0 && std::isfinite(panel.ceiling);
    const Pen zero{.color = FigureColors::kLeast, .width = 0.2};
    canvas.line(std::array<Spot, 2>{{{f.x, axes.y(v)}, {f.x + f.width, axes.y(v)}}}, contact ? zero : grid);
    if (axes.y(v) > f.y + 1.0)
      canvas.text({f.x - 1.2, axes.y(v)}, ticks.text(v), {.size = 2.3, .align = Align::kRight, .color = "#45525f"});
  }
  canvas.text({f.x - 9.0, f.y + 0.5 * f.height}, panel.title + ", " + panel.unit,
              {.size = 2.3, .align = Align::kCentre, .upright = true});
}

void draw_curve(Canvas& canvas, const Curve& curve, const Axes& axes) {
  std::vector<Spot> piece;
  double last = 0.0;
  for (const auto& [t, v] : curve.samples) {
    if (!piece.empty() && t - last > kMissing) {
      canvas.line(piece, curve.pen);
      piece.clear();
    }
    piece.push_back({axes.x(t), axes.y(v)});
    last = t;
  }
  canvas.line(piece, curve.pen);
}

void draw_plans(Canvas& canvas, const FlightData& flight, const Axes& axes) {
  for (const PlanRecord& plan : flight.plans) {
    const Spot at{axes.x(plan.t), axes.y(plan.ms)};
    const bool blocked = plan.status != "reaches" && plan.status != "progresses";
    const Pen none{.width = 0.0, .opacity = 0.0}, ring{.width = 0.25};
    if (blocked) {
      const std::array<Spot, 4> diamond{
          {{at[0], at[1] - 1.0}, {at[0] + 1.0, at[1]}, {at[0], at[1] + 1.0}, {at[0] - 1.0, at[1]}}};
      canvas.polygon(diamond, FigureColors::kBlocked, 1.0, none);
    } else {
      canvas.circle(at, 0.4, FigureColors::kPlan, 1.0, none);
    }
    if (plan.missed) canvas.circle(at, 1.2, "#ffffff", 0.0, ring);
  }
}

/// Lines through all panels, and the names above the first where there is room.
void draw_events(Canvas& canvas, const FlightData& flight, const Axes& axes, double bottom) {
  double free = axes.frame.x;
  std::vector<EventRecord> events = flight.events;
  std::stable_sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a.t < b.t; });
  for (const EventRecord& event : events) {
    const EventSeverity tone = event_severity(event.name, event.detail);
    if (tone == EventSeverity::kPlain) continue;
    const std::string_view color = tone == EventSeverity::kGood  ? "#007a58"
                                   : tone == EventSeverity::kBad ? "#c03a00"
                                                                 : "#9a6400";
    const double x = axes.x(event.t);
    canvas.line(std::array<Spot, 2>{{{x, axes.frame.y - 1.0}, {x, bottom}}},
                {.color = color, .width = 0.2, .opacity = 0.6});
    const bool told = event.name == "fault" || event.name == "phase" || event.name == "plan_status";
    std::string text = told ? event.detail : event.name;
    text = text.substr(0, text.find_first_of(",;"));
    const TextStyle style{.size = 2.2, .color = color};
    const double width = canvas.text_width(text, style);
    const double start =
        std::clamp(x - 0.5 * width, axes.frame.x, std::max(axes.frame.x, axes.frame.x + axes.frame.width - width));
    if (start < free || width > 0.5 * axes.frame.width) continue;
    canvas.text({start, axes.frame.y - 2.4}, text, style);
    free = start + width + 2.0;
  }
}

void mark_least(Canvas& canvas, const FigureFlight& flight, const Axes& axes) {
  if (flight.clearance.empty()) return;
  const auto less = [](const ClearanceSample& a, const ClearanceSample& b) { return a.distance < b.distance; };
  const ClearanceSample& least = *std::min_element(flight.clearance.begin(), flight.clearance.end(), less);
  const Spot at{axes.x(least.t), axes.y(least.distance)};
  canvas.circle(at, 0.8, FigureColors::kLeast, 1.0, {.color = "#ffffff", .width = 0.2});
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "least %.2f m", least.distance);
  const bool left = at[0] > axes.frame.x + 0.8 * axes.frame.width;
  canvas.text({at[0] + (left ? -1.6 : 1.6), at[1] - 1.8}, text.data(),
              {.size = 2.3, .align = left ? Align::kRight : Align::kLeft, .color = FigureColors::kLeast, .halo = true});
}

}  // namespace

Ticks ticks_of(double low, double high, double count) {
  constexpr int kMost = 100;
  const double raw = std::max((high - low) / std::max(1.0, count), 1e-9);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double part : {5.0, 2.0, 1.0}) {
    if (part * power >= raw * (1.0 - 1e-9)) step = part * power;
  }
  Ticks ticks;
  ticks.digits = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 6);
  const double first = std::ceil(low / step - 1e-9);
  for (int i = 0; i < kMost && (first + i) * step <= high + 1e-9 * step; ++i)
    ticks.values.push_back((first + i) * step);
  return ticks;
}

std::string Ticks::text(double value) const {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value == 0.0 ? 0.0 : value);
  return text.data();
}

void draw_plots(Canvas& canvas, const FigureFlight& flight, const Frame& frame) {
  constexpr double kAxis = 8.0;    // mm, under the last panel
  constexpr double kEvents = 4.5;  // mm, over the first
  const std::vector<Panel> panels = panels_of(flight);
  const auto count = static_cast<double>(panels.size());
  const double height = (frame.height - kAxis - kEvents - (count - 1.0) * kGap) / count;
  Axes axes{{frame.x, frame.y + kEvents, frame.width, height}, flight.data.first, flight.data.last};
  const double bottom = frame.y + frame.height - kAxis;
  draw_events(canvas, flight.data, axes, bottom);
  for (const Panel& panel : panels) {
    find_range(panel, flight.data, axes);
    draw_scales(canvas, panel, axes);
    canvas.clip(axes.frame);
    canvas.line(std::array<Spot, 2>{{{axes.x(flight.at), axes.frame.y}, {axes.x(flight.at), axes.frame.y + height}}},
                {.color = "#56626f", .width = 0.25, .dash = {0.8, 0.8}});
    for (const Curve& curve : panel.curves) draw_curve(canvas, curve, axes);
    if (panel.curves.empty()) draw_plans(canvas, flight.data, axes);
    if (std::isfinite(panel.ceiling)) mark_least(canvas, flight, axes);
    canvas.unclip();
    canvas.box(axes.frame, {.color = "#56626f", .width = 0.25});
    axes.frame.y += height + kGap;
  }
  const Ticks ticks = ticks_of(axes.first, axes.last, frame.width / 16.0);
  for (const double t : ticks.values)
    canvas.text({axes.x(t), bottom + 2.2}, ticks.text(t), {.size = 2.3, .align = Align::kCentre, .color = "#45525f"});
  canvas.text({frame.x + 0.5 * frame.width, bottom + 5.8}, "time, s", {.size = 2.5, .align = Align::kCentre});
}

}  // namespace jink::tools::report
