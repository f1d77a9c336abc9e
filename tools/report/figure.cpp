// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/figure.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "tools/report/figure_parts.hpp"

namespace jink::tools::report {
namespace {

// mm
constexpr double kLeft = 17.0, kRight = 4.0, kTop = 15.0;
constexpr double kTallestView = 70.0, kBetween = 4.0, kAxis = 11.0;
constexpr double kEvents = 4.5, kPanel = 19.0, kGap = 3.0;

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

jink::tools::figures::Figure flight_figure(const FlightData& data, const ReportSource& source,
                                           std::optional<double> at) {
  FigureFlight flight{data};
  if (flight.motion().empty()) throw std::runtime_error(source.log.string() + ": holds no flight to draw");
  flight.clearance = true_clearance(data);
  flight.true_clearance = !flight.clearance.empty();
  if (!flight.true_clearance) flight.clearance = tracked_clearance(data);
  flight.at = instant(flight, source.log, at);

  const double width = kFigureWidth_mm - kLeft - kRight;
  const FigureScale scale = figure_scale(flight, width, kTallestView);
  const double above = view_height(scale, true), beside = view_height(scale, false);
  const double views_end = kTop + above + kBetween + beside + kAxis;
  jink::tools::figures::Figure figure{.id = "flight", .title = source.log.filename().string(), .panels = {}};
  figure.panels = time_panels(flight, {kLeft, views_end + kEvents, width, kPanel}, kGap);
  figure.width_mm = kFigureWidth_mm;
  figure.height_mm = views_end + kEvents + static_cast<double>(figure.panels.size()) * (kPanel + kGap) - kGap + kAxis;
  figure.panels.insert(figure.panels.begin(),
                       {view_panel(flight, scale, true, {kLeft, kTop, width, above}),
                        view_panel(flight, scale, false, {kLeft, kTop + above + kBetween, width, beside})});
  figure.heading = text_of(data.header, "scenario") + text_of(data.header, "mission");
  if (figure.heading.empty()) figure.heading = source.log.filename().string();
  figure.subheading = outcome_text(report_data(data, source.summary ? &*source.summary : nullptr));
  std::array<char, 64> shown{};
  std::snprintf(shown.data(), shown.size(), "shown as it was at %.2f s", flight.at);
  figure.remark = shown.data();
  return figure;
}

ReportResult write_figure(const ReportSource& source, const std::filesystem::path& file, std::optional<double> at) {
  const FlightData data = read_flight(source.log);
  write_atomically(file, jink::tools::figures::png_of(flight_figure(data, source, at)), "the figure");
  return {data.lines, data.cut_off + data.not_finite + data.unknown};
}

}  // namespace jink::tools::report
