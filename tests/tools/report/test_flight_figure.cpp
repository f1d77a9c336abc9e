// SPDX-License-Identifier: BSD-3-Clause
// The flight's figure: that what is drawn lies where the log says. How it is drawn: tests/figures.
#include "tools/report/figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "tests/support/temporary_folder.hpp"

namespace jink::tools::report {
namespace {

using Json = nlohmann::json;

/// Where a series lies.
struct Extent {
  double left = 1e9, right = -1e9, low = 1e9, high = -1e9;
  [[nodiscard]] double x() const { return 0.5 * (left + right); }
  [[nodiscard]] double y() const { return 0.5 * (low + high); }
};

const jink::tools::figures::Series* find(const jink::tools::figures::Panel& panel, const std::string& label) {
  const auto found = std::find_if(panel.series.begin(), panel.series.end(),
                                  [&](const jink::tools::figures::Series& s) { return s.label == label; });
  return found == panel.series.end() ? nullptr : &*found;
}

Extent extent(const jink::tools::figures::Panel& panel, const std::string& label) {
  Extent e;
  const jink::tools::figures::Series* series = find(panel, label);
  EXPECT_NE(series, nullptr) << label;
  for (std::size_t i = 0; series != nullptr && i < series->x.size(); ++i) {
    if (std::isnan(series->y[i])) continue;
    e.left = std::min(e.left, series->x[i]);
    e.right = std::max(e.right, series->x[i]);
    e.low = std::min(e.low, series->y[i]);
    e.high = std::max(e.high, series->y[i]);
  }
  return e;
}

jink::tools::figures::Figure figure_of(const support::Folder& folder, const std::string& log,
                                       std::optional<double> at) {
  const ReportSource source{folder.log(log), std::nullopt};
  return flight_figure(read_flight(source.log), source, at);
}

/// 10 s eastwards at 2 m/s from (0, 0, 1.5), beside a box 2.3 m to the north that moves east at 1 m/s, with
/// plans ahead; its least clearance at t = 0.
std::string log_text(const std::string& axis = "east") {
  const auto turned = [&](double along, double beside, double z) {
    return axis == "east" ? Json{along, beside, z} : Json{-beside, along, z};
  };
  const Json header{{"type", "header"},
                    {"format", "jink-log/1"},
                    {"scenario", "figure"},
                    {"start", turned(0, 0, 1.5)},
                    {"target", turned(20, 0, 1.5)},
                    {"vehicle", {{"radius", 0.3}}},
                    {"shapes", {{{"id", 1}, {"box", {2, 2, 2}}}}}};
  std::string text = header.dump() + "\n";
  for (int i = 0; i <= 500; ++i) {
    const double t = 0.02 * i;
    text += Json{{"type", "truth"}, {"t", t}, {"p", turned(2 * t, 0, 1.5)}, {"v", turned(2, 0, 0)}}.dump() + "\n";
    text += Json{{"type", "obstacles"}, {"t", t}, {"id", 1}, {"p", turned(5 + t, 2.3, 1.5)}, {"radius", 1.732}}.dump() +
            "\n";
    if (i % 10 != 0) continue;
    Json plan{{"type", "plan"}, {"t", t}, {"ms", 5}, {"status", "progresses"}, {"path", Json::array()}};
    for (int k = 0; k <= 20; ++k) {
      Json point = turned(2 * (t + 0.1 * k), -0.1 * k, 1.5);
      point.insert(point.begin(), t + 0.1 * k);
      plan["path"].push_back(point);
    }
    text += plan.dump() + "\n";
  }
  return text + R"({"type":"event","t":10,"name":"reached","detail":"at the target"})" + "\n";
}

TEST(FlightFigure, PutsPathObstacleAndPlanWhereTheLogSays) {
  const support::Folder folder;
  for (const double at : {1.0, 6.0}) {
    const jink::tools::figures::Figure figure = figure_of(folder, log_text(), at);
    ASSERT_EQ(figure.panels.size(), 6U);
    const jink::tools::figures::Panel &above = figure.panels[0], &beside = figure.panels[1];
    const Extent flown = extent(above, "flown"), box = extent(above, "obstacle"), plan = extent(above, "plan");
    EXPECT_NEAR(flown.left, 0.0, 1e-9);
    EXPECT_NEAR(flown.right, 20.0, 1e-9);
    EXPECT_NEAR(box.x(), 5.0 + at, 0.02);
    EXPECT_NEAR(box.y(), 2.3, 1e-9);
    EXPECT_NEAR(box.high - box.low, 2.0, 1e-9) << "its true shape, not the sphere around it";
    EXPECT_NEAR(extent(beside, "obstacle").y(), 1.5, 1e-9);
    EXPECT_NEAR(plan.left, 2.0 * at, 0.01) << "the plan of that moment";
    EXPECT_NEAR(plan.right, 2.0 * at + 4.0, 0.01);
    EXPECT_NEAR(extent(above, "its way, 2 s each way").right, 5.0 + at + 2.0, 0.03);
    // A metre is as long across as up, and in both views.
    for (const jink::tools::figures::Panel* view : {&above, &beside}) {
      const double across = view->frame->width / (view->x_range->second - view->x_range->first);
      EXPECT_NEAR(view->frame->height / (view->y_range->second - view->y_range->first), across, 1e-9);
    }
  }
}

TEST(FlightFigure, ShowsTheMapWhatOfItWasSeenAndTheGuide) {
  const Json wall{{"prism", {0.5, 1, 2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  std::istringstream lines(log_text());
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    Json record = Json::parse(line);
    if (record["type"] == "header")
      record["stands"] = Json::array({Json::array({8, -2, 2, 2.3, wall}), Json::array({900, 0, 2, 2.3, wall})});
    if (record["type"] == "plan") record["from"] = {{"start", record["t"]}, {"way", {{14, 1, 1.5}, {20, 0, 1.5}}}};
    text += record.dump() + "\n";
  }
  const auto seen = [](double t, const Json& added, int number) {
    const Json none = Json::array();
    return Json{{"type", "seen"}, {"t", t}, {"number", number}, {"origin", {0, 0, 0}}, {"added", Json::array({added})},
                {"removed", none}}
               .dump() +
           "\n";
  };
  text += seen(2.0, {38, -10, 5, 39, -5, 9}, 1) + seen(8.0, {38, -15, 5, 39, -10, 9}, 2);
  const support::Folder folder;
  const jink::tools::figures::Panel above = figure_of(folder, text, 5.5).panels[0];
  const Extent map = extent(above, "map"), part = extent(above, "map, as seen"), guide = extent(above, "guide");
  EXPECT_NEAR(map.left, 7.5, 1e-6);
  EXPECT_NEAR(map.right, 8.5, 1e-6) << "and nothing of what is far off";
  EXPECT_NEAR(map.low, -3.0, 1e-6);
  EXPECT_NEAR(part.left, 7.6, 1e-6);
  EXPECT_NEAR(part.low, -2.0, 1e-6) << "as far as it had been seen by then";
  EXPECT_NEAR(guide.left, 10.8, 1e-6) << "from where the plan of that moment begins";
  EXPECT_NEAR(guide.right, 20.0, 1e-6);
  EXPECT_NEAR(guide.high, 1.0, 1e-6);
  EXPECT_EQ(find(figure_of(folder, text, 1.0).panels[0], "map, as seen"), nullptr);
}

TEST(FlightFigure, ShowsMeasuresOverTimeWithTheEventsThatMatter) {
  const support::Folder folder;
  const jink::tools::figures::Figure figure = figure_of(folder, log_text(), std::nullopt);
  EXPECT_EQ(figure.heading, "figure");
  EXPECT_NE(figure.subheading.find("20.00 m flown"), std::string::npos) << figure.subheading;
  std::vector<std::string> labels;
  for (const jink::tools::figures::Panel& panel : figure.panels) labels.push_back(panel.y_label);
  EXPECT_EQ(labels, (std::vector<std::string>{"North (m)", "Up (m)", "Clearance (m)", "Speed (m/s)", "Height (m)",
                                              "Plan (ms)"}));
  EXPECT_NEAR(extent(figure.panels[3], "flown").high, 2.0, 1e-9);
  EXPECT_NEAR(extent(figure.panels[4], "flown").low, 1.5, 1e-9);
  for (std::size_t i = 2; i < figure.panels.size(); ++i) {
    const auto& rules = figure.panels[i].rules;
    EXPECT_TRUE(std::any_of(rules.begin(), rules.end(), [](const auto& r) { return r.at == 10.0 && !r.dashed; }));
  }
  const auto& notes = figure.panels[2].notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const auto& note) { return note.text == "reached"; }));
}

TEST(FlightFigure, TurnsAFlightThatGoesNorth) {
  const support::Folder folder;
  const jink::tools::figures::Panel above = figure_of(folder, log_text("north"), 6.0).panels[0];
  const Extent flown = extent(above, "flown");
  EXPECT_NEAR(flown.right, 20.0, 1e-9);  // across the page
  // What is on the left of the way is above it: east runs down.
  EXPECT_LT(extent(above, "obstacle").y(), flown.y());
  EXPECT_GT(above.y_range->first, above.y_range->second);
}

TEST(FlightFigure, DrawsALogOfFlyAloneAndAnEmptyStretch) {
  const support::Folder folder;
  std::string log = R"({"type":"header","format":"jink-log/1","mission":"m"})"
                    "\n";
  for (int i = 0; i < 100; ++i) {
    const double t = i < 50 ? 0.1 * i : 10.0 + 0.1 * i;
    log += Json{{"type", "state"}, {"t", t}, {"p", {t, 0, 2}}, {"v", {1, 0, 0}}, {"armed", true}, {"mode", "hold"}}
               .dump() +
           "\n";
    const Json track{{"id", 1}, {"p", {8, 2, 2}}, {"v", {0, 1, 0}}, {"a", {0, 0, 0}}, {"radius", 0.5}, {"age", 0}};
    log += Json{{"type", "tracks"}, {"t", t}, {"tracks", {track}}}.dump() + "\n";
  }
  const jink::tools::figures::Figure figure = figure_of(folder, log, 3.0);
  EXPECT_NE(find(figure.panels[0], "prediction, 2 s"), nullptr);
  EXPECT_NE(find(figure.panels[0], "obstacle, as tracked"), nullptr);
  const jink::tools::figures::Series* flown = find(figure.panels[0], "flown");
  ASSERT_NE(flown, nullptr);
  EXPECT_EQ(std::count_if(flown->y.begin() + 1, flown->y.end() - 1, [](double y) { return std::isnan(y); }), 1);
  write_figure({folder.log(log), std::nullopt}, folder.path() / "figure.png", 3.0);
  const std::string bytes = support::read(folder.path() / "figure.png");
  ASSERT_TRUE(bytes.starts_with("\x89PNG"));
  EXPECT_EQ(bytes.substr(16, 4), std::string("\0\0\x08\x4E", 4));  // 2126: 180 mm at 300 dots an inch
}

TEST(FlightFigure, RefusesWhatItCannotShow) {
  const support::Folder folder;
  const auto message = [&](const std::string& log, std::optional<double> at, const std::filesystem::path& file) {
    try {
      write_figure({folder.log(log), std::nullopt}, file, at);
    } catch (const std::runtime_error& error) {
      EXPECT_FALSE(std::filesystem::exists(file));
      return std::string(error.what());
    }
    return std::string("drawn");
  };
  const auto png = folder.path() / "figure.png";
  EXPECT_TRUE(message(log_text(), 10.5, png).ends_with("flight.jsonl: --at 10.5 is outside the log's 0 to 10 s"));
  EXPECT_TRUE(message(R"({"type":"header","format":"jink-log/1"})", {}, png).ends_with("holds no flight to draw"));
  EXPECT_NE(message(log_text(), {}, folder.path() / "none" / "x.png").find("x.png: cannot write the figure: "),
            std::string::npos);
}

}  // namespace
}  // namespace jink::tools::report
