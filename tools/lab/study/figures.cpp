// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/figures.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/study/tables.hpp"

namespace jink::tools::lab::study {
namespace {

constexpr const char* kTimeLabel = "Planning time (ms)";
constexpr double kApart = 0.15;      // by which fronts are moved so that they do not cover one another
constexpr double kLeastLost = 1e-5;  // of hypervolume that a logarithmic axis shows

std::vector<double> planning_times_ms(const Records& records) {
  return scaled(measured(records, key::kPlanning), 1000.0);
}

/// A series that looks the same in every figure.
figures::Series series_of(std::string_view algorithm, figures::Kind kind) {
  figures::Series series;
  series.label = label_of(algorithm);
  series.kind = kind;
  series.style = place_of(algorithm);
  return series;
}

/// Adds a mean with its interval; nothing where there is no value.
void add_mean(figures::Series& series, double x, const std::vector<double>& sample) {
  if (sample.empty()) return;
  const statistics::Summary s = statistics::summary(sample);
  series.x.push_back(x);
  series.y.push_back(s.mean);
  series.low.push_back(sample.size() > 1 ? s.low : s.mean);
  series.high.push_back(sample.size() > 1 ? s.high : s.mean);
}

void add_if_any(figures::Panel& panel, figures::Series series) {
  if (!series.x.empty()) panel.series.push_back(std::move(series));
}

std::string one_world(bool blocked) {
  return blocked ? "a blocked world of scenario 5's size" : "scenario 5";
}

}  // namespace

CaptionedFigure fronts_figure(const Selection& selection, const Setting& setting, bool blocked) {
  const FrontStep& step = setting.steps_of(hardest_world(blocked)).front();
  CaptionedFigure result;
  result.figure.id = blocked ? "figure08-blocked" : "figure08";
  result.figure.title = "Pareto fronts at the first step in " + one_world(blocked);
  result.figure.columns = 2;
  result.caption = fmt::format(
      "Fronts of the first run at the first step (waypoint {} of {}) in {}, in units of the reference front's extent; "
      "a panel for each sharing rate l, and the reference front as a line. Each algorithm is moved up by {} so that "
      "none covers another. MOMVO does not share and is shown at l = 0.",
      step.station + 1, setting.planner.paper.waypoints, one_world(blocked), kApart);
  for (const int l : sharing_rates()) {
    figures::Panel panel;
    panel.title = fmt::format("l = {}", l);
    panel.x_label = "Length f1 (normalised)";
    panel.y_label = "Steering f2 (normalised)";
    panel.x_range = {-0.05, 1.1};
    panel.y_range = {-0.05, 1.1 + kApart * static_cast<double>(own_algorithms().size() - 1)};
    for (const std::string& algorithm : own_algorithms()) {
      const Records records =
          l == 0 || has_slaves(algorithm) ? selection.fronts(algorithm, hardest_world(blocked), l) : Records();
      if (records.empty()) continue;
      figures::Series series = series_of(algorithm, figures::Kind::points);
      series.x = records.front()->series.at(key::kF1);
      for (const double f2 : records.front()->series.at(key::kF2))
        series.y.push_back(f2 + kApart * place_of(algorithm));
      panel.series.push_back(std::move(series));
    }
    if (panel.series.empty()) continue;
    figures::Series best;
    best.label = "reference";
    best.kind = figures::Kind::line;
    best.style = static_cast<int>(algorithms::algorithms().size());
    for (const planner::optimizer::Point2& p : step.reference.points) {
      const planner::optimizer::Point2 scaled_point = planner::optimizer::normalise(p, step.reference.bounds);
      best.x.push_back(scaled_point[0]);
      best.y.push_back(scaled_point[1]);
    }
    panel.series.push_back(std::move(best));
    result.figure.panels.push_back(std::move(panel));
  }
  return result;
}

std::vector<CaptionedFigure> time_figures(const Selection& selection) {
  CaptionedFigure sharing{{},
                          "Mean planning time over the sharing rate in scenario 5 with 95 % intervals. MOMVO, which "
                          "does not share, is drawn across. " +
                              timing_note(selection)};
  sharing.figure.id = "figure13";
  sharing.figure.title = "Planning time over the sharing rate";
  CaptionedFigure slaves{{}, "The same over the number of slaves; 1 is MOMVO. " + timing_note(selection)};
  slaves.figure.id = "figure14";
  slaves.figure.title = "Planning time over the number of slaves";
  figures::Panel over_rates, over_slaves;
  over_rates.x_label = "Sharing rate l";
  over_slaves.x_label = "Slaves m";
  over_rates.y_label = over_slaves.y_label = kTimeLabel;
  const std::string world = hardest_world(false);
  for (const std::string& algorithm : own_algorithms()) {
    figures::Series series = series_of(algorithm, figures::Kind::line_points);
    for (const int l : sharing_rates()) add_mean(series, l, planning_times_ms(selection.paths(algorithm, world, l)));
    add_if_any(over_rates, std::move(series));
  }
  for (const int l : sharing_rates()) {
    figures::Series series;
    series.label = fmt::format("l = {}", l);
    int slaves_of = 1;
    for (const std::string& algorithm : own_algorithms()) {
      if (has_slaves(algorithm)) slaves_of = std::stoi(algorithm.substr(algorithm.rfind('-') + 1));
      add_mean(series, slaves_of, planning_times_ms(selection.paths(algorithm, world, l)));
    }
    add_if_any(over_slaves, std::move(series));
  }
  if (!over_rates.series.empty()) sharing.figure.panels.push_back(std::move(over_rates));
  if (!over_slaves.series.empty()) slaves.figure.panels.push_back(std::move(over_slaves));
  return {std::move(sharing), std::move(slaves)};
}

CaptionedFigure comparison_figure(const Selection& selection) {
  CaptionedFigure result{
      {},
      "Mean planning time in scenario 5 with 95 % intervals, on a logarithmic axis; intervals end at half "
      "the mean. " +
          timing_note(selection)};
  result.figure.id = "figure15";
  result.figure.title = "Planning time of all algorithms";
  figures::Panel panel;
  panel.y_label = kTimeLabel;
  panel.log_y = true;
  panel.legend = false;
  figures::Series bars;
  bars.kind = figures::Kind::bars;
  for (const algorithms::Algorithm& algorithm : algorithms::algorithms()) {
    const std::vector<double> sample = planning_times_ms(selection.paths(algorithm.name, hardest_world(false)));
    if (sample.empty()) continue;
    add_mean(bars, static_cast<double>(panel.categories.size()), sample);
    bars.low.back() = std::max(bars.low.back(), 0.5 * bars.y.back());  // an interval down to 0 has no place on the axis
    panel.categories.emplace_back(algorithm.label);
  }
  add_if_any(panel, std::move(bars));
  if (!panel.series.empty()) result.figure.panels.push_back(std::move(panel));
  return result;
}

namespace {

/// One row of panels: over population for each number of iterations, or the other way about.
void add_size_panels(figures::Figure& figure, const Selection& selection, bool over_population, bool blocked_length) {
  const std::vector<int> inner =
      over_population ? population_factors(selection.settings()) : iteration_factors(selection.settings());
  const std::vector<int> outer =
      over_population ? iteration_factors(selection.settings()) : population_factors(selection.settings());
  const PaperSizes& sizes = selection.sizes();
  for (const int o : outer) {
    figures::Panel panel;
    panel.x_label = over_population ? "Population" : "Iterations";
    panel.y_label = blocked_length ? "Path length, blocked (m)" : kTimeLabel;
    panel.title = over_population ? fmt::format("{} iterations", o * sizes.iterations)
                                  : fmt::format("population {}", o * sizes.population);
    panel.log_y = !blocked_length;
    for (const std::string& algorithm : own_algorithms()) {
      figures::Series series = series_of(algorithm, figures::Kind::line_points);
      for (const int i : inner) {
        const int population = (over_population ? i : o) * sizes.population;
        const int iterations = (over_population ? o : i) * sizes.iterations;
        const Records records = selection.paths(algorithm, hardest_world(blocked_length), population, iterations);
        const std::vector<double> sample =
            blocked_length ? values(reached(records), key::kLength) : planning_times_ms(records);
        if (sample.empty()) continue;
        series.x.push_back(over_population ? population : iterations);
        series.y.push_back(statistics::mean(sample));
      }
      if (panel.ticks.size() < series.x.size()) panel.ticks = series.x;
      add_if_any(panel, std::move(series));
    }
    if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
  }
}

}  // namespace

std::vector<CaptionedFigure> size_figures(const Selection& selection) {
  std::vector<CaptionedFigure> figures;
  for (const bool over_population : {true, false}) {
    CaptionedFigure one;
    one.figure.id = over_population ? "figure16" : "figure17";
    one.figure.title = over_population ? "Effect of the population" : "Effect of the iterations";
    one.caption = fmt::format(
        "Above: mean planning time in scenario 5, logarithmic; below: mean path length in blocked worlds, of the paths "
        "that reach; over the {}. Path lengths in scenario 5 are all the straight line's (Table 13). {}",
        over_population ? "population" : "iterations", timing_note(selection));
    add_size_panels(one.figure, selection, over_population, false);
    one.figure.columns = static_cast<int>(one.figure.panels.size());
    add_size_panels(one.figure, selection, over_population, true);
    figures.push_back(std::move(one));
  }
  return figures;
}

CaptionedFigure anytime_figure(const Selection& selection, const Setting& setting, bool blocked) {
  CaptionedFigure result;
  result.figure.id = blocked ? "anytime-blocked" : "anytime";
  result.figure.title = "Hypervolume during the search in " + one_world(blocked);
  double best = 0.0;
  const std::vector<FrontStep>& steps = setting.steps_of(hardest_world(blocked));
  for (const FrontStep& step : steps) best += step.reference.hypervolume / static_cast<double>(steps.size());
  result.caption = fmt::format(
      "Mean hypervolume that the front lacks to the reference fronts' {:.4f} with 95 % intervals, over evaluations and "
      "over the median wall time, at {} steps of {}; lower is better. All have fronts of at most {} members, so that "
      "something always lacks. {}",
      best, steps.size(), one_world(blocked), setting.planner.optimizer.archive, timing_note(selection));
  figures::Panel by_evaluations, by_time;
  by_evaluations.x_label = "Evaluations";
  by_time.x_label = "Wall time (ms)";
  by_evaluations.y_label = by_time.y_label = "Hypervolume lacking";
  by_evaluations.log_x = by_time.log_x = by_evaluations.log_y = by_time.log_y = true;
  for (const algorithms::Algorithm& algorithm : algorithms::algorithms()) {
    const Records records = selection.anytime(algorithm.name, hardest_world(blocked));
    if (records.empty()) continue;
    figures::Series over = series_of(algorithm.name, figures::Kind::band);
    figures::Series timed = over;
    const std::size_t count = records.front()->series.at(key::kHvAt).size();
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<double> lacking, at;
      for (const Record* r : records) {
        lacking.push_back(best - r->series.at(key::kHvAt).at(i));
        at.push_back(r->series.at(key::kEvaluationsAt).at(i));
      }
      add_mean(over, statistics::mean(at), lacking);
      add_mean(timed, 1000.0 * statistics::summary(measured(records, key::seconds_at(i))).median, lacking);
    }
    for (figures::Series* series : {&over, &timed})
      for (std::vector<double>* edge : {&series->y, &series->low, &series->high})
        for (double& value : *edge) value = std::max(value, kLeastLost);
    by_evaluations.series.push_back(std::move(over));
    by_time.series.push_back(std::move(timed));
  }
  if (!by_evaluations.series.empty()) result.figure.panels = {std::move(by_evaluations), std::move(by_time)};
  return result;
}

std::vector<CaptionedFigure> all_figures(const Selection& selection, const Setting& setting) {
  std::vector<CaptionedFigure> figures;
  const auto add = [&](std::vector<CaptionedFigure> more) {
    for (CaptionedFigure& one : more)
      if (!one.figure.panels.empty()) figures.push_back(std::move(one));
  };
  add({fronts_figure(selection, setting, false)});
  add(picture_figures(selection, setting, false));
  add({seeds_figure(selection, setting)});
  add(time_figures(selection));
  add({comparison_figure(selection)});
  add(size_figures(selection));
  add({anytime_figure(selection, setting, false), fronts_figure(selection, setting, true)});
  add(picture_figures(selection, setting, true));
  add({anytime_figure(selection, setting, true)});
  return figures;
}

}  // namespace jink::tools::lab::study
