// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/figure.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "tools/report/figure_parts.hpp"

namespace jink::tools::report {
namespace {

// mm
constexpr double kLeft = 14.0, kRight = 4.0, kTop = 4.0, kTitle = 11.0;
constexpr double kTallestView = 70.0, kBetween = 4.0, kAxis = 9.0, kLegend = 7.0, kPlots = 98.0;

std::string text_of(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// "reached: 8.21 s, 20.35 m, least clearance 0.41 m": what the summary holds, else the log.
std::string outcome_text(const nlohmann::json& data) {
  const nlohmann::json& summary = data["summary"];
  const nlohmann::json& derived = data["derived"];
  const auto figure = [&](const char* key) -> const nlohmann::json* {
    if (summary.is_object() && summary.contains(key) && !summary[key].is_null()) return &summary[key];
    return derived.contains(key) ? &derived[key] : nullptr;
  };
  std::string text;
  if (const auto* outcome = figure("outcome"); outcome != nullptr && outcome->is_string())
    text = outcome->get<std::string>();
  const auto add = [&](const nlohmann::json* value, const char* format) {
    if (value == nullptr || !value->is_number()) return;
    std::array<char, 96> part{};
    std::snprintf(part.data(), part.size(), format, value->get<double>());
    text += (text.empty() ? "" : ", ") + std::string(part.data());
  };
  add(figure("flight_time_s"), "%.2f s");
  add(figure("path_length"), "%.2f m flown");
  const nlohmann::json* clearance = figure("min_clearance");
  const bool measured = clearance == nullptr && data["clearance"].is_object();
  add(measured ? &data["clearance"]["min"]["d"] : clearance, "least clearance %.2f m");
  add(figure("max_speed"), "at most %.2f m/s");
  return text;
}

double instant(const FigureFlight& flight, const std::filesystem::path& log, std::optional<double> at) {
  const double first = flight.data.first, last = flight.data.last;
  if (at) {
    if (*at >= first && *at <= last) return *at;
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), ": --at %g is outside the log's %g to %g s", *at, first, last);
    throw std::runtime_error(log.string() + text.data());
  }
  if (flight.clearance.empty()) return 0.5 * (first + last);
  const auto less = [](const ClearanceSample& a, const ClearanceSample& b) { return a.distance < b.distance; };
  return std::min_element(flight.clearance.begin(), flight.clearance.end(), less)->t;
}

}  // namespace

ReportResult write_figure(const ReportSource& source, const std::filesystem::path& file, std::optional<double> at) {
  const FlightData data = read_flight(source.log);
  FigureFlight flight{data};
  if (flight.motion().empty()) throw std::runtime_error(source.log.string() + ": holds no flight to draw");
  flight.clearance = true_clearance(data);
  flight.true_clearance = !flight.clearance.empty();
  if (!flight.true_clearance) flight.clearance = tracked_clearance(data);
  flight.at = instant(flight, source.log, at);

  const double width = kFigureWidth_mm - kLeft - kRight;
  const FigureScale scale = figure_scale(flight, width, kTallestView);
  const double above = view_height(scale, true), beside = view_height(scale, false);
  const double views = kTop + kTitle + above + kBetween + beside + kAxis;
  Canvas canvas(kFigureWidth_mm, views + kLegend + kPlots, kFigureResolution_dpi);

  const nlohmann::json figures = report_data(data, source.summary ? &*source.summary : nullptr);
  std::string name = text_of(data.header, "scenario") + text_of(data.header, "mission");
  if (name.empty()) name = source.log.filename().string();
  canvas.text({kLeft, kTop + 1.5}, name, {.size = 3.6, .bold = true});
  canvas.text({kLeft, kTop + 6.5}, outcome_text(figures), {.size = 2.6, .color = "#45525f"});
  std::array<char, 64> shown{};
  std::snprintf(shown.data(), shown.size(), "shown as it was at %.2f s", flight.at);
  canvas.text({kFigureWidth_mm - kRight, kTop + 1.5}, shown.data(),
              {.size = 2.6, .align = Align::kRight, .color = "#45525f"});

  draw_view(canvas, flight, scale, true, {kLeft, kTop + kTitle, width, above});
  draw_view(canvas, flight, scale, false, {kLeft, kTop + kTitle + above + kBetween, width, beside});
  draw_legend(canvas, flight, {kLeft, views + 1.5}, width);
  draw_plots(canvas, flight, {kLeft, views + kLegend, width, kPlots - 2.0});
  write_atomically(file, canvas.png(), "the figure");
  return {data.lines, data.cut_off + data.not_finite + data.unknown};
}

}  // namespace jink::tools::report
