// SPDX-License-Identifier: BSD-3-Clause
// Figures are drawn and looked at: where a bar is, there is colour; where nothing is, there is none; labels are text.
#include "tools/lab/presentation/figure.hpp"

#include <cairo.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>

#include "tests/support/temporary_folder.hpp"

namespace jink::tools::lab::presentation {
namespace {

using support::Folder;

/// A PNG, decoded.
class Image {
 public:
  explicit Image(const std::filesystem::path& file)
      : surface_(cairo_image_surface_create_from_png(file.c_str()), cairo_surface_destroy) {
    EXPECT_EQ(cairo_surface_status(surface_.get()), CAIRO_STATUS_SUCCESS) << file;
  }
  [[nodiscard]] int width() const { return cairo_image_surface_get_width(surface_.get()); }
  [[nodiscard]] int height() const { return cairo_image_surface_get_height(surface_.get()); }
  struct Pixel {
    int red = 0, green = 0, blue = 0;
  };
  [[nodiscard]] Pixel at(int x, int y) const {
    std::uint32_t pixel = 0;
    const auto stride = cairo_image_surface_get_stride(surface_.get());
    std::memcpy(&pixel, cairo_image_surface_get_data(surface_.get()) + y * stride + 4 * x, 4);
    return {static_cast<int>(pixel >> 16U & 255U), static_cast<int>(pixel >> 8U & 255U),
            static_cast<int>(pixel & 255U)};
  }

 private:
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
};

using Colour = std::function<bool(const Image::Pixel&)>;
bool is_blue(const Image::Pixel& p) {
  return p.blue > p.red + 60 && p.blue > p.green + 20;
}
bool is_orange(const Image::Pixel& p) {
  return p.red > p.blue + 60 && p.green > p.blue + 40;
}
bool is_black(const Image::Pixel& p) {
  return p.red < 30 && p.green < 30 && p.blue < 30;
}
bool is_grey(const Image::Pixel& p) {
  return p.red == p.green && p.green == p.blue && p.red > 120 && p.red < 200;
}

/// The pixels of a part of an image that pass a test; sides in shares of its width.
struct Patch {
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
  long count = 0;
};
Patch find(const Image& image, const Colour& test, double from = 0.0, double to = 1.0) {
  Patch patch;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = static_cast<int>(from * image.width()); x < static_cast<int>(to * image.width()); ++x) {
      if (!test(image.at(x, y))) continue;
      patch.left = std::min(patch.left, x);
      patch.right = std::max(patch.right, x);
      patch.top = std::min(patch.top, y);
      patch.bottom = std::max(patch.bottom, y);
      ++patch.count;
    }
  }
  return patch;
}

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
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
  const Folder folder;
  Figure figure = figure_of(series({0, 1}, {4.0, 2.0}, Kind::bars));
  figure.panels[0].categories = {"one", "two"};
  figure.panels[0].y_range = {{0.0, 5.0}};
  const Image image(draw(figure, folder.path()).png);
  EXPECT_EQ(image.width(), 1063);  // 90 mm at 300 dots an inch
  const Patch all = find(image, is_blue);
  const double middle = 0.5 * (all.left + all.right) / image.width();
  const Patch left = find(image, is_blue, 0.0, middle), right = find(image, is_blue, middle, 1.0);
  EXPECT_EQ(left.bottom, right.bottom);
  EXPECT_NEAR(static_cast<double>(left.bottom - left.top) / (right.bottom - right.top), 2.0, 0.05);
  EXPECT_GT(right.left, left.right + 20);  // a gap between
  EXPECT_NEAR(left.right - left.left, right.right - right.left, 2);
}

TEST(Figure, BarsOnALogarithmicAxisRiseFromItsBottom) {
  const Folder folder;
  Figure figure = figure_of(series({0, 1}, {0.1, 10.0}, Kind::bars));
  figure.panels[0].log_y = true;
  figure.panels[0].y_range = {{0.01, 10.0}};
  const Image image(draw(figure, folder.path()).png);
  const Patch all = find(image, is_blue);
  const double middle = 0.5 * (all.left + all.right) / image.width();
  const Patch left = find(image, is_blue, 0.0, middle), right = find(image, is_blue, middle, 1.0);
  EXPECT_NEAR(static_cast<double>(right.bottom - right.top) / (left.bottom - left.top), 3.0, 0.1);  // decades
}

TEST(Figure, SeveralBarsStandSideBySide) {
  const Folder folder;
  Figure figure = figure_of(series({0, 1}, {1, 2}, Kind::bars, "a"));
  figure.panels[0].series[0].style = 1;
  figure.panels[0].series.push_back(series({0, 1}, {2, 1}, Kind::bars, "b"));
  figure.panels[0].series[1].style = 2;
  figure.panels[0].legend = false;
  const Image image(draw(figure, folder.path()).png);
  const Patch orange = find(image, is_orange), blue = find(image, is_blue);
  EXPECT_GT(orange.count, 2000);
  EXPECT_GT(blue.count, 2000);
  EXPECT_LT(orange.left, blue.left);  // of the first place, the first series
  EXPECT_LT(orange.right, blue.right);
  EXPECT_NEAR(orange.top, blue.top, 2);  // both reach 2
}

TEST(Figure, IntervalsReachFromLowToHigh) {
  const Folder folder;
  Series s = series({0, 1, 2}, {1, 2, 3}, Kind::line_points);
  s.style = 2;
  const Patch without = find(Image(draw(figure_of(s), folder.path()).png), is_blue);
  Figure figure = figure_of(s);
  figure.panels[0].y_range = {{0.0, 6.0}};
  figure.panels[0].series[0].low = {0.5, 1.0, 1.0};
  figure.panels[0].series[0].high = {1.5, 3.0, 6.0};
  const Image image(draw(figure, folder.path()).png);
  const Patch with = find(image, is_blue);
  const Patch last = find(image, is_blue, static_cast<double>(with.right - 40) / image.width(), 1.0);
  EXPECT_GT(without.count, 500);
  EXPECT_GT(last.bottom - last.top, image.height() / 2);  // 5 of the axis' 6
}

TEST(Figure, EachKindOfCurveIsDrawn) {
  for (const Kind kind : {Kind::line, Kind::line_points, Kind::points, Kind::steps, Kind::band}) {
    const Folder folder;
    Series s = series({1, 10, 100}, {1, 2, 4}, kind, "Curve");
    s.style = 2;
    if (kind == Kind::band) {
      s.low = {0.5, 1, 2};
      s.high = {2, 4, 6};
    }
    Figure figure = figure_of(s);
    figure.panels[0].log_x = true;
    figure.panels[0].legend = false;
    const Patch patch = find(Image(draw(figure, folder.path()).png), is_blue);
    EXPECT_GT(patch.count, 300) << static_cast<int>(kind);
    EXPECT_GT(patch.right - patch.left, 600) << static_cast<int>(kind);
  }
}

TEST(Figure, ABandFillsItsInterval) {
  const Folder folder;
  Series s = series({0, 1, 2}, {3, 3, 3}, Kind::band);
  s.low = {1, 1, 1};
  s.high = {5, 5, 5};
  Figure figure = figure_of(s);
  figure.panels[0].y_range = {{0.0, 6.0}};
  const Image image(draw(figure, folder.path()).png);
  const Patch line = find(image, is_black, 0.4, 0.6);
  const auto shade = [&](double share) {  // above the line, in shares of the axis
    return image.at(image.width() / 2, line.top - static_cast<int>(share * 0.75 * image.height())).red;
  };
  EXPECT_LT(shade(0.2), 240);
  EXPECT_EQ(shade(0.42), 255);
}

TEST(Figure, BoxesShowQuartilesMedianAndWhiskers) {
  const Folder folder;
  Figure figure = figure_of(box_series("", {{4, 1, 2, 3, 5}, {}, {1, 1, 1}}));
  figure.panels[0].categories = {"a", "b", "c"};
  const Series& boxes = figure.panels[0].series[0];
  EXPECT_EQ(boxes.least[0], 1.0);
  EXPECT_EQ(boxes.low[0], 2.0);
  EXPECT_EQ(boxes.y[0], 3.0);
  EXPECT_EQ(boxes.high[0], 4.0);
  EXPECT_EQ(boxes.greatest[0], 5.0);
  EXPECT_TRUE(std::isnan(boxes.y[1]));
  const Image image(draw(figure, folder.path()).png);
  const Patch box = find(image, is_grey, 0.2, 0.4);
  EXPECT_GT(box.count, 5000);
  EXPECT_LT(find(image, is_grey, 0.45, 0.65).count, box.count / 20);  // nothing of the empty one but gridlines
}

TEST(Figure, SpheresAndPathsAreDrawnInSpace) {
  const Folder folder;
  Figure figure = in_space();
  const Patch without = find(Image(draw(figure, folder.path()).png), is_blue);
  const Colour bluish = [](const Image::Pixel& p) { return p.blue > p.red + 20; };
  EXPECT_EQ(find(Image(draw(figure, folder.path()).png), bluish).count, 0) << without.count;
  figure.panels[0].spheres = {{4, 2, 2, 1.0, 5, 2, 2}, {2, 6, 2, 0.5, 2, 6, 2}};
  const Drawn drawn = draw(figure, folder.path());
  const Image image(drawn.png);
  EXPECT_GT(find(image, bluish).count, 2000);
  EXPECT_GT(find(image, is_black).count, 1000);
  EXPECT_NE(read(drawn.data).find("4 2 2 1 5 2 2\n2 6 2 0.5 NaN NaN NaN\n"), std::string::npos);  // one stands still
  EXPECT_LT(std::filesystem::file_size(drawn.svg), 400'000U);
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
            "figure figure13: gnuplot is not installed (Debian: gnuplot-nox; tools/setup.sh installs it)");
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
}  // namespace jink::tools::lab::presentation
