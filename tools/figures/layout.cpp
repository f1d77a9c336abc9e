// SPDX-License-Identifier: BSD-3-Clause
// Whether a figure makes sense, how it looks and where its parts go.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/figures/gnuplot.hpp"

namespace jink::tools::figures {
namespace {

constexpr double kCharacter = 1.9;     // mm, of an average one at 8 pt
constexpr double kSample = 15.0;       // mm, a legend's sample of a line and the space about it
constexpr double kLegendRow = 4.2;     // mm
constexpr double kFlatInSpace = 0.66;  // of one in space
constexpr double kLeastPanel = 56.0;   // mm, width

constexpr int kBarsAlone = 2;  // the style of bars that are a panel's only series

// Colours after Okabe and Ito and after Tol, chosen to be told apart by the colour-blind; dark and light ones
// alternate.
const Look& numbered_look(int style) {
  static const std::array<Look, 16> looks{{{"#000000", 1.4, "solid", 7},
                                           {"#e69f00", 1.4, "(9,4)", 5},
                                           {"#0072b2", 1.4, "solid", 9},
                                           {"#56b4e9", 1.4, "(3,3)", 13},
                                           {"#882255", 1.4, "(12,3,3,3)", 11},
                                           {"#44aa77", 1.4, "solid", 6},
                                           {"#d55e00", 1.4, "(6,3)", 4},
                                           {"#332288", 1.4, "(2,2)", 8},
                                           {"#cc79a7", 1.4, "solid", 12},
                                           {"#117733", 1.4, "(9,3,2,3,2,3)", 10},
                                           {"#999933", 1.4, "(5,2)", 15},
                                           {"#888888", 1.4, "(12,4)", 2},
                                           {"#ddcc77", 1.4, "(2,4)", 1},
                                           {"#0044aa", 1.4, "(1,3)", 3},
                                           {"#aa3377", 1.4, "(4,2,1,2)", 14},
                                           {"#66ccee", 1.4, "solid", 8}}};
  return looks[static_cast<std::size_t>(style) % looks.size()];
}

[[noreturn]] void refuse(const Figure& figure, const std::string& reason) {
  throw FigureError(fmt::format("figure {}: {}", figure.id, reason));
}

/// Refuses a list of another length than x, infinite values, and values that a logarithmic axis cannot show.
void check_values(const Figure& figure, const Series& series, const std::vector<double>& values, const char* name,
                  bool optional, bool log) {
  if (optional && values.empty()) return;
  if (values.size() != series.x.size())
    refuse(figure,
           fmt::format("\"{}\" has {} values of {} for {} of x", series.label, values.size(), name, series.x.size()));
  for (const double v : values) {
    if (std::isinf(v)) refuse(figure, fmt::format("\"{}\" has an infinite value of {}", series.label, name));
    if (log && v <= 0.0) refuse(figure, fmt::format("\"{}\" has {} = {} on a logarithmic axis", series.label, name, v));
  }
}

bool check_series(const Figure& figure, const Panel& panel, const Series& s) {
  check_values(figure, s, s.x, "x", false, panel.log_x);
  check_values(figure, s, s.y, "y", false, panel.log_y);
  check_values(figure, s, s.z, "z", !in_space(panel), false);
  check_values(figure, s, s.low, "low", s.kind != Kind::band && s.kind != Kind::boxes, panel.log_y);
  check_values(figure, s, s.high, "high", s.low.empty(), panel.log_y);
  check_values(figure, s, s.least, "least", s.kind != Kind::boxes, panel.log_y);
  check_values(figure, s, s.greatest, "greatest", s.kind != Kind::boxes, panel.log_y);
  if (s.low.empty() && !s.high.empty()) refuse(figure, fmt::format("\"{}\" has high without low", s.label));
  if (in_space(panel) && s.kind != Kind::line && s.kind != Kind::line_points && s.kind != Kind::points)
    refuse(figure, fmt::format("\"{}\" is in space and neither a line nor points", s.label));
  if (s.kind == Kind::bars && panel.log_x) refuse(figure, "bars over a logarithmic axis");
  bool drawn = false;
  for (std::size_t i = 0; i < s.x.size(); ++i) drawn = drawn || (std::isfinite(s.x[i]) && std::isfinite(s.y[i]));
  return drawn;
}

void check_range(const Figure& figure, const std::optional<std::pair<double, double>>& range, bool log, bool falls) {
  if (!range) return;
  const auto [low, high] = *range;
  const bool ordered = low < high || (falls && low > high);
  if (!std::isfinite(low) || !std::isfinite(high) || !ordered || (log && std::min(low, high) <= 0.0))
    refuse(figure, fmt::format("an axis from {} to {}", low, high));
}

std::vector<LegendEntry> legend_of(const Figure& figure) {
  std::vector<LegendEntry> legend;
  for (const Panel& panel : figure.panels) {
    if (!panel.legend) continue;
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      const Series& series = panel.series[i];
      const auto same = [&](const LegendEntry& entry) { return entry.label == series.label; };
      if (!series.label.empty() && std::none_of(legend.begin(), legend.end(), same))
        legend.push_back({series.label, look_of(panel, i), series.kind});
    }
  }
  return legend;
}

/// Characters, not bytes, of UTF-8.
double length_of(const std::string& text) {
  return static_cast<double>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

bool in_space(const Panel& panel) {
  return !panel.z_label.empty();
}

const Look& look_of(const Panel& panel, std::size_t series) {
  const Series& s = panel.series[series];
  if (s.look) return *s.look;
  if (s.style >= 0) return numbered_look(s.style);
  // Black is for lines: many broad bars of it are hard to look at.
  return numbered_look(s.kind == Kind::bars && panel.series.size() == 1 ? kBarsAlone : static_cast<int>(series));
}

void check(const Figure& figure) {
  if (figure.id.empty() || figure.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") != std::string::npos)
    throw FigureError(fmt::format("a figure's id has to be of a-z, 0-9, - and _, not \"{}\"", figure.id));
  if (figure.panels.empty()) refuse(figure, "has no panels");
  if (!(figure.width_mm >= 30.0 && figure.width_mm <= 1000.0))
    refuse(figure, fmt::format("a width of {} mm", figure.width_mm));
  for (const Panel& panel : figure.panels) {
    bool drawn = !panel.spheres.empty();
    for (const Series& series : panel.series) drawn = check_series(figure, panel, series) || drawn;
    if (!drawn) refuse(figure, fmt::format("panel \"{}\" has nothing to draw", panel.title));
    if (!panel.spheres.empty() && !in_space(panel)) refuse(figure, "spheres in a flat panel");
    for (const Sphere& s : panel.spheres)
      for (const double v : {s.x, s.y, s.z, s.radius, s.to_x, s.to_y, s.to_z})
        if (!std::isfinite(v)) refuse(figure, "a sphere that is nowhere");
    check_range(figure, panel.x_range, panel.log_x, false);
    check_range(figure, panel.y_range, panel.log_y, !in_space(panel));
    check_range(figure, panel.z_range, false, false);
    if (panel.frame.has_value() != (figure.height_mm > 0.0) || (panel.frame && in_space(panel)))
      refuse(figure, "frames are for all panels of a figure that has a height, and for flat ones");
  }
}

double round_step(double length, double count) {
  const double least = length / count * (1.0 - 1e-9);
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double part : {1.0, 2.0, 5.0})
    if (part * power >= least) return part * power;
  return 10.0 * power;
}

Layout layout_of(const Figure& figure) {
  Layout layout;
  const int count = static_cast<int>(figure.panels.size());
  // Four panels are two by two; else as many as a page's width takes, at most three.
  const int fitting = std::clamp(static_cast<int>(figure.width_mm / kLeastPanel), 1, 3);
  layout.columns = figure.columns > 0 ? std::min(figure.columns, count)
                   : count == 4       ? std::min(2, fitting)
                                      : std::min(count, fitting);
  layout.rows = (count + layout.columns - 1) / layout.columns;
  layout.width = figure.width_mm;
  layout.panel_width = layout.width / layout.columns;
  const bool space = std::any_of(figure.panels.begin(), figure.panels.end(), in_space);
  const double flat = space ? kFlatInSpace : layout.columns == 1 ? 0.5 : layout.columns == 2 ? 0.7 : 0.9;
  layout.panel_height = figure.panel_height_mm > 0.0 ? figure.panel_height_mm : flat * layout.panel_width;
  layout.legend = legend_of(figure);
  // One series needs no legend where it is named on the axis or in the caption, but who gave it a label wants to see
  // it.
  if (!layout.legend.empty()) {
    double longest = 0.0;
    for (const LegendEntry& entry : layout.legend) longest = std::max(longest, length_of(entry.label));
    const int entries = static_cast<int>(layout.legend.size());
    const int fit = std::clamp(static_cast<int>(layout.width / (kSample + kCharacter * longest)), 1, entries);
    const int rows = (entries + fit - 1) / fit;
    layout.legend_columns = (entries + rows - 1) / rows;  // rows of about the same length
    layout.legend_height = kLegendRow * rows + 2.0;
  }
  layout.height =
      (figure.height_mm > 0.0 ? figure.height_mm : layout.rows * layout.panel_height) + layout.legend_height;
  return layout;
}

}  // namespace jink::tools::figures
