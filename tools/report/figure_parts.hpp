// SPDX-License-Identifier: BSD-3-Clause
// The parts of the figure: views of the flight in space, and plots over time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/canvas.hpp"
#include "tools/report/figure.hpp"
#include "tools/report/flight_data.hpp"
#include "tools/report/report_data.hpp"

namespace jink::tools::report {

/// A flight, and the instant of it that the figure shows.
struct FigureFlight {
  const FlightData& data;
  double at = 0.0;  ///< s of the log
  std::vector<ClearanceSample> clearance{};
  bool true_clearance = false;

  [[nodiscard]] const std::vector<MotionSample>& motion() const {
    return data.truth.empty() ? data.states : data.truth;
  }
  /// The plan in use at the instant; null before the first.
  [[nodiscard]] const PlanRecord* plan() const;
};

/// Round numbers that divide [low, high] in about `count` parts, and the digits that they need.
struct Ticks {
  std::vector<double> values{};
  int digits = 0;
  [[nodiscard]] std::string text(double value) const;
};
[[nodiscard]] Ticks ticks_of(double low, double high, double count);

/// What two views side by side of each other share: seen along which axes, and how large.
struct FigureScale {
  std::size_t across = 0;  ///< the axis of ENU that runs across the figure: 0, or 1 where the flight goes north
  Triple low{}, high{};    ///< what is shown, m
  double scale = 1.0;      ///< mm on the sheet for a metre
};
/// So that the whole way fits views of `width` mm and at most `height` mm each.
[[nodiscard]] FigureScale figure_scale(const FigureFlight& flight, double width, double height);
/// The height in mm of the view from above, or from the side.
[[nodiscard]] double view_height(const FigureScale& scale, bool from_above);
void draw_view(Canvas& canvas, const FigureFlight& flight, const FigureScale& scale, bool from_above,
               const Frame& frame);
/// One row that says what is what.
void draw_legend(Canvas& canvas, const FigureFlight& flight, const Spot& at, double width);

/// Clearance, speed, height and plan time under each other, `frame` for all four and their time axis.
void draw_plots(Canvas& canvas, const FigureFlight& flight, const Frame& frame);

}  // namespace jink::tools::report
