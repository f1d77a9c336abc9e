// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace jink::tools::lab::arena {
namespace {

using jink::tools::figures::Kind;
using jink::tools::figures::Panel;
using jink::tools::figures::Series;

constexpr double kWidth = 240.0, kLeft = 20.0, kRight = 4.0, kPanel = 34.0, kGap = 5.0;  // mm
// Told apart with colour blindness too (Okabe and Ito 2008).
constexpr std::array<const char*, 8> kColours{"#0072b2", "#e69f00", "#009e73", "#cc79a7",
                                              "#d55e00", "#56b4e9", "#7f6a00", "#555555"};
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // nothing to draw

/// What is drawn of a row.
struct Mark {
  double y = kNone, low = kNone, high = kNone, least = kNone, greatest = kNone;
};

Mark proportion(const Proportion& p) {
  if (p.of == 0) return {};
  return {100.0 * p.value(), 100.0 * p.low, 100.0 * p.high};
}
Mark spread(const Spread& s, double least) {
  return {s.median, s.p5, s.p95, least, s.p95};
}
Mark plan_time(const Row& row) {
  const double p50 = row.plan_ms.quantile(0.5);
  return {p50, p50, row.plan_ms.quantile(0.99), p50, row.plan_ms.count() == 0 ? kNone : row.plan_ms.max()};
}

struct Quantity {
  const char* label;
  Kind kind;
  std::function<Mark(const Row&)> mark;
  bool log = false;
};
const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all{
      {"Reached (%)", Kind::bars, [](const Row& r) { return proportion(r.reached); }},
      {"Collisions (%)", Kind::bars, [](const Row& r) { return proportion(r.collisions); }},
      {"Clearance (m)", Kind::boxes, [](const Row& r) { return spread(r.clearance, r.clearance.min); }},
      {"Time (of straight)", Kind::boxes, [](const Row& r) { return spread(r.time, r.time.p5); }},
      {"Plan time (ms)", Kind::boxes, plan_time, true}};
  return all;
}

void add(Series& series, double x, const Mark& mark, bool log) {
  const auto put = [&](std::vector<double>& values, double v) {
    values.push_back(std::isfinite(v) && !(log && v <= 0.0) ? v : kNone);
  };
  series.x.push_back(x);
  put(series.y, mark.y);
  put(series.low, mark.low);
  put(series.high, mark.high);
  if (series.kind != Kind::boxes) return;
  put(series.least, mark.least);
  put(series.greatest, mark.greatest);
}

bool has_values(const Series& series) {
  return std::any_of(series.y.begin(), series.y.end(), [](double y) { return !std::isnan(y); });
}

Panel panel_of(const Quantity& quantity, const std::vector<const Row*>& rows, const std::vector<std::string>& pilots,
               const std::vector<std::string>& families) {
  Panel panel;
  panel.y_label = quantity.label;
  panel.log_y = quantity.log;
  panel.categories = families;
  for (std::size_t i = 0; i < pilots.size(); ++i) {
    Series series{.label = pilots[i], .x = {}, .kind = quantity.kind};
    series.look = jink::tools::figures::Look{.colour = kColours.at(i % kColours.size())};
    for (const Row* row : rows) {
      const auto place = std::find(families.begin(), families.end(), row->family) - families.begin();
      if (row->pilot == pilots[i]) add(series, static_cast<double>(place), quantity.mark(*row), quantity.log);
    }
    panel.series.push_back(std::move(series));  // also without values: the others keep their places
  }
  return panel;
}

}  // namespace

jink::tools::figures::Figure figure(const std::vector<const Row*>& rows, const std::vector<std::string>& pilots) {
  jink::tools::figures::Figure figure;
  std::vector<std::string> families;
  for (const Row* row : rows)
    if (families.empty() || families.back() != row->family) families.push_back(row->family);
  figure.id = "arena";
  figure.title = "What the pilots reach in each family";
  figure.width_mm = kWidth;
  for (const Quantity& quantity : quantities()) {
    Panel panel = panel_of(quantity, rows, pilots, families);
    if (std::none_of(panel.series.begin(), panel.series.end(), has_values)) continue;
    panel.frame = {kLeft, kGap + static_cast<double>(figure.panels.size()) * (kPanel + kGap), kWidth - kLeft - kRight,
                   kPanel};
    panel.x_numbers = false;
    figure.panels.push_back(std::move(panel));
  }
  if (figure.panels.empty()) return figure;
  figure.panels.back().x_numbers = true;
  const double names = families.size() > 5 ? 24.0 : 7.0;  // mm: of many the names are turned
  figure.height_mm = kGap + static_cast<double>(figure.panels.size()) * (kPanel + kGap) + names;
  return figure;
}

}  // namespace jink::tools::lab::arena
