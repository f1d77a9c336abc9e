// SPDX-License-Identifier: BSD-3-Clause
// Figures are drawn and looked at: what the SVG holds in a colour, and where; labels are text. The PNG is the same
// script's.
#include "tools/figures/figure.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <regex>

#include "tests/support/temporary_folder.hpp"

namespace jink::tools::figures {
namespace {

using support::Folder;
using support::read;

/// What is drawn with one stroke: where it is, in pixels of 1/96 inch, y down.
struct Mark {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
};

constexpr const char *kBlue = "rgb(  0, 114, 178)", *kOrange = "rgb(230, 159,   0)", *kBlack = "rgb(  0,   0,   0)";

/// The marks of a colour, from left to right: "polygon" (bars, boxes, areas), "path" (lines) or "use" (points).
std::vector<Mark> find(const std::string& svg, const std::string& element, const std::string& colour) {
  std::vector<Mark> marks;
  const std::regex number(R"((-?[0-9.]+),(-?[0-9.]+))");
  for (std::size_t at = 0; (at = svg.find('<' + element + ' ', at)) != std::string::npos;) {
    const std::string text = svg.substr(at, svg.find("/>", at) - at);
    at += text.size();
    if (text.find(colour) == std::string::npos) continue;
    const char* const where = element == "polygon" ? "points =" : element == "path" ? " d=" : "translate(";
    const std::string points = text.substr(text.find(where));
    Mark mark;
    for (std::sregex_iterator found(points.begin(), points.end(), number), end; found != end; ++found) {
      const double x = std::stod((*found)[1]), y = std::stod((*found)[2]);
      mark.left = std::min(mark.left, x);
      mark.right = std::max(mark.right, x);
      mark.top = std::min(mark.top, y);
      mark.bottom = std::max(mark.bottom, y);
      if (element == "use") break;  // behind the place is the size
    }
    marks.push_back(mark);
  }
  std::stable_sort(marks.begin(), marks.end(), [](const Mark& a, const Mark& b) { return a.left < b.left; });
  return marks;
}

/// Of a PNG's header.
std::array<unsigned, 2> size_of(const std::string& png) {
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value << 8U | static_cast<unsigned char>(png.at(i));
    return value;
  };
  return {number(16), number(20)};
}

Series series(std::vector<double> x, std::vector<double> y, Kind kind, std::string label = "") {
  Series s;
  s.label = std::move(label);
  s.x = std::move(x);
  s.y = std::move(y);
  s.kind = kind;
  return s;
}

/// One panel of 90 mm with a series.
Figure figure_of(Series s) {
  Figure figure;
  figure.id = "figure13";
  figure.title = "A title";
  figure.width_mm = 90.0;
  figure.panels.emplace_back();
  figure.panels[0].x_label = "Slaves";
  figure.panels[0].y_label = "Time (s)";
  figure.panels[0].series.push_back(std::move(s));
  return figure;
}

Figure in_space() {
  Figure figure = figure_of(series({0, 4, 8}, {0, 4, 8}, Kind::line, "Path"));
  figure.panels[0].series[0].z = {1, 2, 1};
  figure.panels[0].z_label = "z (m)";
  return figure;
}

TEST(Figure, BarsStandWhereTheyShouldAndAreAsHighAsTheirNumbers) {
  Figure figure = figure_of(series({0, 1}, {4.0, 2.0}, Kind::bars));
  figure.panels[0].categories = {"one", "two"};
  figure.panels[0].y_range = {{0.0, 5.0}};
  const std::vector<Mark> bars = find(svg_of(figure), "polygon", kBlue);
  ASSERT_EQ(bars.size(), 2U);
  EXPECT_EQ(bars[0].bottom, bars[1].bottom);
  EXPECT_NEAR(bars[0].height() / bars[1].height(), 2.0, 0.01);
  EXPECT_GT(bars[1].left, bars[0].right + 5.0);  // a gap between
  EXPECT_NEAR(bars[0].width(), bars[1].width(), 0.1);
}

TEST(Figure, BarsOnALogarithmicAxisRiseFromItsBottom) {
  Figure figure = figure_of(series({0, 1}, {0.1, 10.0}, Kind::bars));
  figure.panels[0].log_y = true;
  figure.panels[0].y_range = {{0.01, 10.0}};
  const std::vector<Mark> bars = find(svg_of(figure), "polygon", kBlue);
  ASSERT_EQ(bars.size(), 2U);
  EXPECT_NEAR(bars[1].height() / bars[0].height(), 3.0, 0.01);  // decades
}

TEST(Figure, SeveralBarsStandSideBySide) {
  Figure figure = figure_of(series({0, 1}, {1, 2}, Kind::bars, "a"));
  figure.panels[0].series[0].style = 1;
  figure.panels[0].series.push_back(series({0, 1}, {2, 1}, Kind::bars, "b"));
  figure.panels[0].series[1].style = 2;
  figure.panels[0].legend = false;
  const std::string svg = svg_of(figure);
  const std::vector<Mark> orange = find(svg, "polygon", kOrange), blue = find(svg, "polygon", kBlue);
  ASSERT_EQ(orange.size(), 2U);
  ASSERT_EQ(blue.size(), 2U);
  EXPECT_LE(orange[0].right, blue[0].left);  // of the first place, the first series
  EXPECT_LT(blue[0].right, orange[1].left);
  EXPECT_EQ(orange[1].top, blue[0].top);  // both reach 2
}

TEST(Figure, IntervalsReachFromLowToHigh) {
  Figure figure = figure_of(series({0, 1, 2}, {1, 2, 3}, Kind::points));
  figure.panels[0].series[0].style = 2;
  EXPECT_TRUE(find(svg_of(figure), "path", kBlue).empty());
  figure.panels[0].y_range = {{0.0, 6.0}};
  figure.panels[0].series[0].low = {0.5, 1.0, 1.0};
  figure.panels[0].series[0].high = {1.5, 3.0, 6.0};
  const std::string svg = svg_of(figure);
  const std::vector<Mark> points = find(svg, "use", kBlue), all = find(svg, "path", kBlue);
  ASSERT_EQ(all.size(), 1U);  // one stroke
  ASSERT_EQ(points.size(), 3U);
  const double unit = (points[0].top - points[2].top) / 2.0;
  EXPECT_NEAR(all[0].height() / unit, 5.5, 0.01);  // from 0.5 to 6
  EXPECT_NEAR((all[0].bottom - points[0].top) / unit, 0.5, 0.01);
}

TEST(Figure, EachKindOfCurveIsDrawn) {
  for (const Kind kind : {Kind::line, Kind::line_points, Kind::points, Kind::band, Kind::areas}) {
    Series s = series({1, 10, 100}, {1, 2, 4}, kind, "Curve");
    s.style = 2;
    if (kind == Kind::band) {
      s.low = {0.5, 1, 2};
      s.high = {2, 4, 6};
    }
    Figure figure = figure_of(s);
    figure.panels[0].log_x = true;
    figure.panels[0].legend = false;
    const std::string svg = svg_of(figure);
    double left = 1e9, right = 0.0;
    for (const char* element : {"polygon", "path", "use"}) {
      for (const Mark& mark : find(svg, element, kBlue)) {
        left = std::min(left, mark.left);
        right = std::max(right, mark.right);
      }
    }
    EXPECT_GT(right - left, 200.0) << static_cast<int>(kind);  // of 340
    EXPECT_EQ(find(svg, "use", kBlue).size(), kind == Kind::line_points || kind == Kind::points ? 3U : 0U);
  }
}

TEST(Figure, ABandFillsItsInterval) {
  Series s = series({0, 1, 2}, {3, 3, 3}, Kind::band);
  s.low = {1, 1, 1};
  s.high = {4, 4, 4};
  s.style = 2;
  Figure figure = figure_of(s);
  const std::string svg = svg_of(figure);
  const std::vector<Mark> band = find(svg, "polygon", kBlue), line = find(svg, "path", kBlue);
  ASSERT_EQ(band.size(), 1U);
  ASSERT_EQ(line.size(), 1U);
  EXPECT_NEAR(band[0].width(), line[0].width(), 0.05);
  EXPECT_NEAR((band[0].bottom - line[0].top) / (line[0].top - band[0].top), 2.0, 0.01);
}

TEST(Figure, BoxesShowQuartilesMedianAndWhiskers) {
  const double none = std::nan("");
  Series boxes = series({0, 1, 2}, {3, none, 1}, Kind::boxes);
  boxes.least = {1, none, 0};
  boxes.low = {2, none, 0.5};
  boxes.high = {4, none, 1.5};
  boxes.greatest = {6, none, 2};
  boxes.style = 2;
  Figure figure = figure_of(boxes);
  figure.panels[0].categories = {"a", "b", "c"};
  const std::vector<Mark> drawn = find(svg_of(figure), "polygon", kBlue);
  ASSERT_EQ(drawn.size(), 2U);  // nothing of the empty one
  EXPECT_NEAR(drawn[0].height() / drawn[1].height(), 2.0, 0.01);
  EXPECT_GT(drawn[1].left, drawn[0].right + drawn[0].width());
}

TEST(Figure, AreasAndLinesEndAtAGap) {
  const double none = std::nan("");
  Figure figure = figure_of(series({0, 2, 2, 0, 5, 5, 6, 6}, {0, 0, 2, none, none, 1, 1, 2}, Kind::areas));
  figure.panels[0].series[0].look = Look{.colour = "#0072b2", .edge = "#000000"};
  figure.panels[0].series.push_back(series({0, 1, 2, 3, 4}, {0, 0, none, 1, 1}, Kind::line));
  figure.panels[0].series[1].look = Look{.colour = "#e69f00"};
  const std::string svg = svg_of(figure);
  const std::vector<Mark> areas = find(svg, "polygon", kBlue), line = find(svg, "path", kOrange);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_NEAR(areas[0].width() / areas[1].width(), 2.0, 0.01);
  ASSERT_EQ(line.size(), 1U);
  EXPECT_NEAR(line[0].width(), 4.0 * areas[1].width(), 0.05);
  const std::size_t path = svg.find("d='M", svg.find(kOrange));
  EXPECT_NE(svg.substr(path + 4, svg.find('\'', path + 4) - path).find('M'), std::string::npos) << "pen not lifted";
}

TEST(Figure, PanelsWithFramesAreWhereTheyShouldBe) {
  Figure figure = figure_of(series({0, 1}, {0, 1}, Kind::line));
  figure.height_mm = 60.0;
  figure.heading = "What it is";
  Panel& panel = figure.panels[0];
  panel.frame = Frame{20.0, 10.0, 50.0, 30.0};
  panel.series[0].style = 2;
  panel.x_range = {{0.0, 1.0}};
  panel.y_range = {{1.0, 0.0}};  // upside down
  panel.notes.push_back({.x = 0.5, .y = 0.5, .text = "here"});
  panel.rules.push_back({.at = 0.25, .colour = "#e69f00"});
  const std::string svg = svg_of(figure);
  const double mm = 96.0 / 25.4;
  const std::vector<Mark> line = find(svg, "path", kBlue), rule = find(svg, "path", kOrange);
  ASSERT_EQ(line.size(), 1U);
  ASSERT_EQ(rule.size(), 1U);
  EXPECT_NEAR(line[0].left, 20.0 * mm, 0.6);
  EXPECT_NEAR(line[0].right, 70.0 * mm, 0.6);
  EXPECT_NEAR(line[0].top, 10.0 * mm, 0.6);
  EXPECT_NEAR(line[0].bottom, 40.0 * mm, 0.6);
  EXPECT_NEAR(rule[0].left, 32.5 * mm, 0.6);
  EXPECT_EQ(rule[0].left, rule[0].right);
  EXPECT_NEAR(rule[0].height(), line[0].height(), 0.1);
  for (const char* text : {">What it is<", ">here<"}) EXPECT_NE(svg.find(text), std::string::npos) << text;
}

TEST(Figure, PngHasItsSizeAndTellsItsResolution) {
  const std::string png = png_of(figure_of(series({1, 2}, {1, 2}, Kind::line)));
  EXPECT_EQ(size_of(png)[0], 1063U);  // 90 mm at 300 dots an inch
  const std::size_t chunk = png.find("pHYs");
  ASSERT_NE(chunk, std::string::npos);
  EXPECT_EQ(png.substr(chunk + 4, 13),
            std::string("\0\0\x2E\x23\0\0\x2E\x23\1\x78\xA5\x3F\x76", 13));  // 11811 in a metre
}

TEST(Figure, SpheresAndPathsAreDrawnInSpace) {
  const Folder folder;
  Figure figure = in_space();
  const std::size_t without = read(draw(figure, folder.path()).svg).size();
  figure.panels[0].spheres = {{4, 2, 2, 1.0, 5, 2, 2}, {2, 6, 2, 0.5, 2, 6, 2}};
  const Drawn drawn = draw(figure, folder.path());
  const std::string svg = read(drawn.svg);
  const auto polygons = std::count(svg.begin(), svg.end(), 'p');
  EXPECT_GT(polygons, 100);  // their faces
  EXPECT_GT(svg.size(), without + 10'000U);
  EXPECT_FALSE(find(svg, "path", kBlack).empty());
  EXPECT_NE(read(drawn.data).find("4 2 2 1 5 2 2\n2 6 2 0.5 NaN NaN NaN\n"), std::string::npos);  // one stands still
  EXPECT_LT(svg.size(), 400'000U);
}

TEST(Figure, ElementsOfAPageHaveIdsOfTheirOwn) {
  const Folder folder;
  const Drawn drawn = draw(figure_of(series({1, 2}, {1, 2}, Kind::points)), folder.path());
  const std::string svg = svg_element(drawn.svg, "x-");
  EXPECT_TRUE(svg.starts_with("<svg") && svg.ends_with("</svg>"));
  EXPECT_NE(svg.find("id='x-gpPt"), std::string::npos);
  EXPECT_NE(svg.find("href='#x-gpPt"), std::string::npos);
  EXPECT_EQ(svg.find("'#gpPt"), std::string::npos);
  const auto refusal = [](const std::filesystem::path& file) -> std::string {
    try {
      (void)svg_element(file, "x-");
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "read";
  };
  const std::filesystem::path missing = folder.path() / "missing.svg", other = folder.path() / "other.svg";
  std::ofstream(other) << "no picture";
  EXPECT_EQ(refusal(missing), "cannot read the figure " + missing.string());
  EXPECT_EQ(refusal(other), other.string() + " is no SVG");
}

TEST(Figure, LabelsAreTextAsGiven) {
  const Folder folder;
  Figure figure = figure_of(series({1, 2}, {1, 2}, Kind::line, "it's {a}^2_b & <c>"));
  figure.panels[0].title = "100 % of 'l = 3'";
  figure.panels[0].y_label = "Weite f₁ (m)";
  figure.panels.push_back(figure.panels[0]);
  figure.panels[1].title = "Second";
  const std::string svg = read(draw(figure, folder.path()).svg);
  for (const char* text : {"it's {a}^2_b &amp; &lt;c>", "100 % of 'l = 3'", "Weite f₁ (m)", "Slaves", "Second"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  const std::size_t first = svg.find("it's");
  EXPECT_EQ(svg.find("it's", first + 1), std::string::npos) << "a label of both panels is in the legend twice";
}

TEST(Figure, DataAreExactAndAlwaysTheSame) {
  Figure figure = figure_of(series({1, 2}, {0.1, std::nan("")}, Kind::points, "first\nline"));
  figure.panels[0].title = "Panel";
  figure.panels[0].series.push_back(series({3}, {1.0 / 3.0}, Kind::band, "second"));
  figure.panels[0].series[1].low = {0.25};
  figure.panels[0].series[1].high = {0.5};
  EXPECT_EQ(gnuplot_data(figure),
            "# Panel: first line\n# x y low high least greatest\n1 0.1 NaN NaN NaN NaN\n2 NaN NaN NaN NaN NaN\n\n\n"
            "# Panel: second\n# x y low high least greatest\n3 0.3333333333333333 0.25 0.5 NaN NaN\n");
  EXPECT_EQ(gnuplot_data(figure), gnuplot_data(figure));
  EXPECT_EQ(gnuplot_script(figure), gnuplot_script(figure));
  const Folder folder;
  const Drawn once = draw(figure, folder.path() / "a"), again = draw(figure, folder.path() / "b");
  EXPECT_EQ(read(once.data), gnuplot_data(figure));
  EXPECT_EQ(read(once.script), gnuplot_script(figure));
  EXPECT_EQ(read(once.svg), read(again.svg));
  EXPECT_EQ(read(once.png), read(again.png));
}

TEST(Figure, EqualValuesAndManySeriesAreNoTrouble) {
  const Folder folder;
  Figure figure = figure_of(series({1, 2}, {1, 1}, Kind::line, "s0"));
  for (int i = 1; i < 20; ++i)
    figure.panels[0].series.push_back(series({1, 2}, {1, 1}, Kind::line_points, "s" + std::to_string(i)));
  figure.panels[0].series.push_back(series({}, {}, Kind::line, "empty"));
  const std::string svg = read(draw(figure, folder.path()).svg);
  for (int i = 0; i < 20; ++i) EXPECT_NE(svg.find(">s" + std::to_string(i) + "<"), std::string::npos) << i;
}

TEST(Figure, TicksOfANarrowAxisDiffer) {
  const Folder folder;
  const Figure figure = figure_of(series({1, 2}, {1.00000001, 1.00000003}, Kind::line));
  const std::string svg = read(draw(figure, folder.path()).svg);
  EXPECT_NE(svg.find(">1.00000002<"), std::string::npos);
}

std::string refusal(const Figure& figure) {
  const Folder folder;
  try {
    (void)draw(figure, folder.path());
  } catch (const FigureError& e) {
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "something was written";
    return e.what();
  }
  return "drawn";
}

TEST(Figure, WhatMakesNoSenseIsRefusedInOneLine) {
  const double infinity = std::numeric_limits<double>::infinity();
  Figure figure = figure_of(series({1, 2}, {1}, Kind::line, "s"));
  EXPECT_EQ(refusal(figure), "figure figure13: \"s\" has 1 values of y for 2 of x");
  figure = figure_of(series({1, 2}, {1, infinity}, Kind::line, "s"));
  EXPECT_EQ(refusal(figure), "figure figure13: \"s\" has an infinite value of y");
  figure = figure_of(series({1, 2}, {1, 0}, Kind::line, "s"));
  figure.panels[0].log_y = true;
  EXPECT_EQ(refusal(figure), "figure figure13: \"s\" has y = 0 on a logarithmic axis");
  figure = figure_of(series({1}, {std::nan("")}, Kind::line, "s"));
  figure.panels[0].title = "P";
  EXPECT_EQ(refusal(figure), "figure figure13: panel \"P\" has nothing to draw");
  figure = figure_of(series({1}, {1}, Kind::band, "s"));
  EXPECT_EQ(refusal(figure), "figure figure13: \"s\" has 0 values of low for 1 of x");
  figure = figure_of(series({1}, {1}, Kind::line, "s"));
  figure.panels[0].series[0].high = {2};
  EXPECT_EQ(refusal(figure), "figure figure13: \"s\" has high without low");
  figure = in_space();
  figure.panels[0].series[0].kind = Kind::bars;
  EXPECT_EQ(refusal(figure), "figure figure13: \"Path\" is in space and neither a line nor points");
  figure = figure_of(series({1}, {1}, Kind::line, "s"));
  figure.panels[0].y_range = {{2.0, 2.0}};
  EXPECT_EQ(refusal(figure), "figure figure13: an axis from 2 to 2");
  figure.panels.clear();
  EXPECT_EQ(refusal(figure), "figure figure13: has no panels");
  figure.id = "../x";
  EXPECT_EQ(refusal(figure), "a figure's id has to be of a-z, 0-9, - and _, not \"../x\"");
}

/// PATH for as long as it lives.
// NOLINTBEGIN(concurrency-mt-unsafe): a test has one thread.
class Path {
 public:
  explicit Path(const std::filesystem::path& path) {
    const char* const before = std::getenv("PATH");
    if (before != nullptr) before_ = before;
    ::setenv("PATH", path.c_str(), 1);
  }
  ~Path() { ::setenv("PATH", before_.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

 private:
  std::string before_;
};
// NOLINTEND(concurrency-mt-unsafe)

std::string failure(const std::filesystem::path& folder) {
  try {
    (void)draw(figure_of(series({1, 2}, {1, 2}, Kind::line)), folder);
  } catch (const FigureError& e) {
    return e.what();
  }
  return "drawn";
}

TEST(Figure, SaysThatGnuplotIsMissing) {
  const Folder folder;
  const Path path(folder.path());
  EXPECT_EQ(failure(folder.path() / "out"),
            "figure figure13: gnuplot is not in PATH; figures need it (Debian: apt install gnuplot-nox)");
}

/// A program of that name in the folder.
void fake_gnuplot(const Folder& folder, const std::string& text) {
  std::ofstream(folder.path() / "gnuplot") << "#!/bin/sh\n" << text << '\n';
  std::filesystem::permissions(folder.path() / "gnuplot", std::filesystem::perms::owner_all);
}

/// Ctrl-C in a terminal goes to all of its process group.
TEST(Figure, CtrlCDoesNotReachGnuplot) {
  const Folder folder;
  fake_gnuplot(folder, "cut -d' ' -f5 /proc/$$/stat > group; echo x > figure13.png; echo x > figure13.svg");
  const Path path(folder.path().string() + ":/bin:/usr/bin");
  ASSERT_EQ(failure(folder.path() / "out"), "drawn");
  pid_t group = 0;
  std::ifstream(folder.path() / "out" / "group") >> group;
  EXPECT_GT(group, 0);
  EXPECT_NE(group, ::getpgrp());
}

/// Nor does one that comes before gnuplot has a group of its own.
TEST(Figure, CtrlCDoesNotEndAGnuplotThatIsBeingStarted) {
  const Folder folder;
  fake_gnuplot(folder, "kill -INT $$; echo x > figure13.png; echo x > figure13.svg");
  const Path path(folder.path().string() + ":/bin:/usr/bin");
  EXPECT_EQ(failure(folder.path() / "out"), "drawn");
}

TEST(Figure, SaysWhyGnuplotFailedAndLeavesNoOldPicture) {
  const Folder folder;
  const std::filesystem::path out = folder.path() / "out";
  ASSERT_EQ(failure(out), "drawn");
  const auto fake = [&](const std::string& text) { fake_gnuplot(folder, text); };
  fake("echo 'plot x' >&2; echo '     ^' >&2; echo '\"figure13.gp\" line 7: no such thing' >&2; echo >&2; exit 1");
  const Path path(folder.path().string() + ":/bin:/usr/bin");
  EXPECT_EQ(failure(out), "figure figure13: gnuplot failed: \"figure13.gp\" line 7: no such thing");
  EXPECT_FALSE(std::filesystem::exists(out / "figure13.png"));
  EXPECT_FALSE(std::filesystem::exists(out / "figure13.svg"));
  fake("exit 0");
  EXPECT_EQ(failure(out), "figure figure13: gnuplot has not written " + (out / "figure13.png").string());
  fake("kill -9 $$");
  EXPECT_EQ(failure(out), "figure figure13: gnuplot was ended by signal 9");
  std::ofstream(folder.path() / "file") << "x";
  EXPECT_NE(failure(folder.path() / "file").find("figure figure13: cannot make "), std::string::npos);
}

}  // namespace
}  // namespace jink::tools::figures
