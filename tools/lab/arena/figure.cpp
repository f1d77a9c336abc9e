// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace jink::tools::lab::arena {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // nothing to draw
constexpr double kLabels = 256.0, kPanel = 200.0, kGap = 36.0;      // px
constexpr double kTop = 44.0, kLine = 15.0, kBetween = 9.0;

// Told apart with colour blindness too (Okabe and Ito 2008).
constexpr std::array<const char*, 8> kColours{"#0072b2", "#e69f00", "#009e73", "#cc79a7",
                                              "#d55e00", "#56b4e9", "#7f6a00", "#555555"};

/// Marks of one panel in one line, in the panel's units.
struct Mark {
  double bar = kNone;               ///< from 0
  double from = kNone, to = kNone;  ///< a thin line
  double dot = kNone;               ///< what counts most
  double tick = kNone, tick2 = kNone;
  std::string told;  ///< when pointed at
};

struct Panel {
  const char* title;
  bool logarithmic;
  std::function<Mark(const Row&)> mark;
  double least, most;  ///< that the axis shows at least; NaN: what there is
};

std::string told(const char* what, const Proportion& p) {
  return fmt::format("{}: {} of {}, {:.1f} % ({:.1f} to {:.1f})", what, p.count, p.of, 100.0 * p.value(), 100.0 * p.low,
                     100.0 * p.high);
}
Mark proportion(const char* what, const Proportion& p) {
  Mark mark;
  if (p.of == 0) return mark;
  mark.bar = 100.0 * p.value();
  mark.from = 100.0 * p.low;
  mark.to = 100.0 * p.high;
  mark.told = told(what, p);
  return mark;
}
Mark spread(const char* what, double from, const Spread& s) {
  Mark mark;
  mark.from = from;
  mark.to = s.p95;
  mark.dot = s.median;
  mark.tick = s.p5;
  mark.told = fmt::format("{}: min {:.2f}, p5 {:.2f}, median {:.2f}, p95 {:.2f}, max {:.2f}", what, s.min, s.p5,
                          s.median, s.p95, s.max);
  return mark;
}
Mark plan_time(const Row& row) {
  Mark mark;
  mark.from = row.plan_ms.quantile(0.5);
  mark.to = row.plan_ms.count() == 0 ? kNone : row.plan_ms.max();
  mark.dot = mark.from;
  mark.tick2 = row.plan_ms.quantile(0.99);
  mark.told = fmt::format("plan time: p50 {:.2f} ms, p99 {:.2f} ms, max {:.2f} ms", mark.from, mark.tick2, mark.to);
  return mark;
}

std::vector<Panel> panels() {
  return {
      {"reached, %", false, [](const Row& r) { return proportion("reached", r.reached); }, 0.0, 100.0},
      {"collisions, %", false, [](const Row& r) { return proportion("collisions", r.collisions); }, 0.0, 1.0},
      {"smallest clearance, m", false,
       [](const Row& r) { return spread("clearance, m", r.clearance.min, r.clearance); }, 0.0, 0.5},
      {"time, of the straight line", false, [](const Row& r) { return spread("time", r.time.p5, r.time); }, 1.0, 1.5},
      {"plan time, ms", true, plan_time, kNone, kNone}};
}

/// Where a panel's values are drawn.
class Axis {
 public:
  Axis(const Panel& panel, const std::vector<const Row*>& rows, double left)
      : logarithmic_(panel.logarithmic), left_(left) {
    low_ = panel.least;
    high_ = panel.most;
    for (const Row* row : rows) {
      const Mark mark = panel.mark(*row);
      for (const double value : {mark.bar, mark.from, mark.to, mark.dot, mark.tick, mark.tick2}) include(value);
    }
    if (!(low_ <= high_)) low_ = high_ = 1.0;
    if (logarithmic_) {
      low_ = std::floor(std::log10(std::max(low_, 1e-3)));
      high_ = std::max(low_ + 1.0, std::ceil(std::log10(std::max(high_, 1e-3))));
    } else {
      step_ = nice_step(high_ - low_);
      low_ = step_ * std::floor(low_ / step_ + 1e-9);
      high_ = std::max(low_ + step_, step_ * std::ceil(high_ / step_ - 1e-9));
    }
  }

  [[nodiscard]] double x(double value) const {
    const double at = logarithmic_ ? std::log10(std::max(value, 1e-3)) : value;
    return left_ + kPanel * std::clamp((at - low_) / (high_ - low_), 0.0, 1.0);
  }
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> values;
    const double step = logarithmic_ ? 1.0 : step_;
    for (int i = 0; low_ + i * step <= high_ + 1e-9; ++i)
      values.push_back(logarithmic_ ? std::pow(10.0, low_ + i) : low_ + i * step);
    return values;
  }

 private:
  void include(double value) {
    if (!std::isfinite(value)) return;
    low_ = std::isnan(low_) ? value : std::min(low_, value);
    high_ = std::isnan(high_) ? value : std::max(high_, value);
  }
  /// 1, 2 or 5 times a power of ten, about four of which make the range.
  static double nice_step(double range) {
    const double rough = std::max(range, 1e-9) / 4.0;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0})
      if (factor * power >= rough) return factor * power;
    return 10.0 * power;
  }

  bool logarithmic_;
  double left_, low_, high_, step_ = 1.0;
};

std::string text(double x, double y, const char* anchor, const char* style, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" class=\"{}\">{}</text>\n", x, y, anchor, style,
                     escaped(words));
}
std::string stroke(double x1, double y1, double x2, double y2, const std::string& colour, double width) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"{}\"/>\n", x1, y1, x2,
      y2, colour, width);
}

/// The marks in one panel of the line whose middle is at `y`.
std::string draw(const Mark& mark, const Axis& axis, double y, const std::string& colour) {
  std::string svg = "<g>";
  if (!mark.told.empty()) svg += fmt::format("<title>{}</title>\n", escaped(mark.told));
  if (std::isfinite(mark.bar)) {
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\" opacity=\"0.45\"/>\n",
        axis.x(0.0), y - 5.0, axis.x(mark.bar) - axis.x(0.0), 10.0, colour);
  }
  if (std::isfinite(mark.from) && std::isfinite(mark.to)) {
    svg += stroke(axis.x(mark.from), y, axis.x(mark.to), y, colour, 1.5);
    for (const double end : {mark.from, mark.to})
      svg += stroke(axis.x(end), y - 3.0, axis.x(end), y + 3.0, colour, 1.5);
  }
  for (const double tick : {mark.tick, mark.tick2})
    if (std::isfinite(tick)) svg += stroke(axis.x(tick), y - 4.0, axis.x(tick), y + 4.0, colour, 3.0);
  if (std::isfinite(mark.dot))
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"/>\n", axis.x(mark.dot), y, colour);
  return svg + "</g>\n";
}

/// The middle of each line: a family's lines stand together.
std::vector<double> line_places(const std::vector<const Row*>& rows) {
  std::vector<double> places;
  double y = kTop;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && rows[i]->family != rows[i - 1]->family) y += kBetween;
    places.push_back(y + 0.5 * kLine);
    y += kLine;
  }
  return places;
}

std::string draw_panel(const Panel& panel, const std::vector<const Row*>& rows, const std::vector<double>& places,
                       double left, const std::vector<std::string>& pilots) {
  const Axis axis(panel, rows, left);
  const double bottom = places.back() + kLine;
  std::string svg = text(left, kTop - 28.0, "start", "title", panel.title);
  for (const double tick : axis.ticks()) {
    svg += stroke(axis.x(tick), kTop - 4.0, axis.x(tick), bottom, "#dfe4ea", 1.0);
    svg += text(axis.x(tick), kTop - 9.0, "middle", "tick", fmt::format("{:g}", std::round(tick * 1e6) / 1e6));
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    svg += draw(panel.mark(*rows[i]), axis, places[i], pilot_colour(pilots, rows[i]->pilot));
  return svg;
}

}  // namespace

std::string escaped(const std::string& words) {
  std::string result;
  for (const char c : words) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string pilot_colour(const std::vector<std::string>& pilots, const std::string& pilot) {
  const auto place = std::find(pilots.begin(), pilots.end(), pilot) - pilots.begin();
  return kColours.at(static_cast<std::size_t>(place) % kColours.size());
}

std::string figure(const std::vector<const Row*>& rows, const std::vector<std::string>& pilots) {
  if (rows.empty()) return {};
  const std::vector<double> places = line_places(rows);
  const std::vector<Panel> all = panels();
  const double width = kLabels + static_cast<double>(all.size()) * (kPanel + kGap);
  const double height = places.back() + kLine + 4.0;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "role=\"img\">\n",
      width, height);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || rows[i]->family != rows[i - 1]->family)
      svg += text(0.0, places[i] + 4.0, "start", "family", rows[i]->family);
    svg += text(kLabels - 12.0, places[i] + 4.0, "end", "pilot", rows[i]->pilot);
  }
  double left = kLabels;
  for (const Panel& panel : all) {
    svg += draw_panel(panel, rows, places, left, pilots);
    left += kPanel + kGap;
  }
  return svg + "</svg>\n";
}

}  // namespace jink::tools::lab::arena
