// SPDX-License-Identifier: BSD-3-Clause
// A flight as one figure for print.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "tools/figures/figure.hpp"
#include "tools/report/flight_data.hpp"
#include "tools/report/html_report.hpp"

namespace jink::tools::report {

/// The figure's width; its height follows from the flight's proportions. It has 300 dots an inch.
constexpr double kFigureWidth_mm = 180.0;

/// What the figure is drawn with, "#rrggbb": the colours of Okabe and Ito, those of the page.
struct FigureColors {
  static constexpr std::string_view kFlown = "#0072b2", kPlan = "#009e73", kBlocked = "#d55e00", kObstacle = "#d9a441",
                                    kTrack = "#a8478a", kOther = "#3f9bd1", kLeast = "#c03a00", kMap = "#c9cac2",
                                    kSeen = "#7f97ab";
};

/// The figure of a flight: the view from above and from the side (in metres, equal scales) with the flown path, the
/// obstacles' true shapes and ways, the plan and the tracks' predictions as they were at the instant `at` (s of the
/// log; the least clearance's where it is not given), and below them clearance, speed, height and plan time over time
/// with the events that matter. Throws std::runtime_error, which names the source's log, where that holds no flight,
/// and for an instant outside of it.
[[nodiscard]] jink::tools::figures::Figure flight_figure(const FlightData& data, const ReportSource& source,
                                                         std::optional<double> at = std::nullopt);

/// Reads the flight log and draws its figure as a PNG `file`, whole or not at all. gnuplot draws it:
/// figures::GnuplotMissing where there is none. Throws std::runtime_error as write_report() and flight_figure() do.
ReportResult write_figure(const ReportSource& source, const std::filesystem::path& file,
                          std::optional<double> at = std::nullopt);

}  // namespace jink::tools::report
