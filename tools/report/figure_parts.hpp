// SPDX-License-Identifier: BSD-3-Clause
// The parts of the flight's figure: views of the flight in space, and panels over time.
#pragma once

#include <limits>
#include <vector>

#include "tools/figures/figure.hpp"
#include "tools/report/figure.hpp"
#include "tools/report/flight_data.hpp"
#include "tools/report/report_data.hpp"

namespace jink::tools::report {

/// A point that is not drawn: the line has a gap.
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMissing = 1.0;  ///< s without a sample, which a line leaves open

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

[[nodiscard]] inline bool is_blocked(const PlanRecord& plan) {
  return plan.status != "reaches" && plan.status != "progresses";
}

/// What the two views share: seen along which axes, and how large.
struct FigureScale {
  std::size_t across = 0;  ///< the axis of ENU that runs across the figure: 0, or 1 where the flight goes north
  Triple low{}, high{};    ///< what is shown, m
  double scale = 1.0;      ///< mm on the page for a metre
};
/// So that the whole way fits views of `width` mm and at most `height` mm each.
[[nodiscard]] FigureScale figure_scale(const FigureFlight& flight, double width, double height);
/// The height in mm of the view from above, or from the side.
[[nodiscard]] double view_height(const FigureScale& scale, bool from_above);
[[nodiscard]] jink::tools::figures::Panel view_panel(const FigureFlight& flight, const FigureScale& scale,
                                                     bool from_above, const jink::tools::figures::Frame& frame);

/// Clearance, speed, height and plan time, without those that the log does not have, in frames under each other that
/// begin with `first`.
[[nodiscard]] std::vector<jink::tools::figures::Panel> time_panels(const FigureFlight& flight,
                                                                   const jink::tools::figures::Frame& first,
                                                                   double gap);

}  // namespace jink::tools::report
