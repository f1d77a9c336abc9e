// SPDX-License-Identifier: BSD-3-Clause
// The figure for print: that it is a PNG of its size and resolution, and that what is drawn lies where the log says.
#include "tools/report/figure.hpp"

#include <cairo.h>
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/support/temporary_folder.hpp"
#include "tools/report/convex_hull.hpp"

namespace jink::tools::report {
namespace {

using Json = nlohmann::json;

/// A PNG, decoded.
class Image {
 public:
  explicit Image(const std::filesystem::path& file)
      : surface_(cairo_image_surface_create_from_png(file.c_str()), cairo_surface_destroy) {
    EXPECT_EQ(cairo_surface_status(surface_.get()), CAIRO_STATUS_SUCCESS) << file;
  }
  [[nodiscard]] int width() const { return cairo_image_surface_get_width(surface_.get()); }
  [[nodiscard]] int height() const { return cairo_image_surface_get_height(surface_.get()); }
  [[nodiscard]] bool is(int x, int y, std::string_view color) const {
    std::uint32_t pixel = 0;
    const auto stride = cairo_image_surface_get_stride(surface_.get());
    std::memcpy(&pixel, cairo_image_surface_get_data(surface_.get()) + y * stride + 4 * x, 4);
    std::uint32_t wanted = 0;
    std::from_chars(color.data() + 1, color.data() + 7, wanted, 16);
    return (pixel & 0xFFFFFFU) == wanted;
  }

 private:
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
};

/// The pixels of a colour within a part of an image.
struct Patch {
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
  long count = 0;
  double x = 0.0, y = 0.0;  ///< their middle
};
Patch find(const Image& image, std::string_view color, int top, int bottom) {
  Patch patch;
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < image.width(); ++x) {
      if (!image.is(x, y, color)) continue;
      patch.left = std::min(patch.left, x);
      patch.right = std::max(patch.right, x);
      patch.top = std::min(patch.top, y);
      patch.bottom = std::max(patch.bottom, y);
      ++patch.count;
      patch.x += x;
      patch.y += y;
    }
  }
  patch.x /= static_cast<double>(std::max(1L, patch.count));
  patch.y /= static_cast<double>(std::max(1L, patch.count));
  return patch;
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

Image draw(const support::Folder& folder, const std::string& log, std::optional<double> at) {
  write_figure({folder.log(log), std::nullopt}, folder.path() / "figure.png", at);
  return Image(folder.path() / "figure.png");
}

constexpr double kPixels = kFigureResolution_dpi / 25.4;  // in a mm

TEST(Figure, IsAPngOfItsWidthAndResolution) {
  const support::Folder folder;
  const Image image = draw(folder, log_text(), std::nullopt);
  EXPECT_EQ(image.width(), std::lround(kFigureWidth_mm * kPixels));
  EXPECT_GT(image.height(), 1000);
  EXPECT_LT(image.height(), 4000);
  std::ostringstream bytes;
  bytes << std::ifstream(folder.path() / "figure.png", std::ios::binary).rdbuf();
  const std::size_t chunk = bytes.str().find("pHYs");
  ASSERT_NE(chunk, std::string::npos);
  EXPECT_EQ(bytes.str().substr(chunk + 4, 9), std::string("\0\0\x2E\x23\0\0\x2E\x23\1", 9));  // 11811 in a metre
}

TEST(Figure, PutsPathObstacleAndPlanWhereTheLogSays) {
  const support::Folder folder;
  for (const double at : {1.0, 6.0}) {
    const Image image = draw(folder, log_text(), at);
    // The view from above is the sheet's first; its flown way tells the scale.
    const int half = static_cast<int>(60 * kPixels);
    const Patch flown = find(image, FigureColors::kFlown, 0, half);
    ASSERT_GT(flown.count, 2000);
    const double scale = (flown.right - flown.left) / 20.6;  // pixels in a metre; a vehicle's radius at an end or none
    const Patch box = find(image, FigureColors::kObstacle, 0, half);
    ASSERT_GT(box.count, 1000);
    EXPECT_NEAR((box.x - flown.left) / scale, 5.0 + at, 0.6) << at;
    EXPECT_NEAR((flown.y - box.y) / scale, 2.3, 0.3) << at;
    EXPECT_NEAR((box.bottom - box.top) / scale, 2.0, 0.3) << "its true shape, not the sphere around it";
    const Patch plan = find(image, FigureColors::kPlan, 0, half);
    ASSERT_GT(plan.count, 200);
    EXPECT_NEAR((plan.left - flown.left) / scale, 2.0 * at, 0.7) << "the plan of that moment";
    EXPECT_NEAR((plan.right - flown.left) / scale, 2.0 * at + 4.0, 0.7);
  }
}

TEST(Figure, TurnsAFlightThatGoesNorth) {
  const support::Folder folder;
  const Image image = draw(folder, log_text("north"), 6.0);
  const int half = static_cast<int>(60 * kPixels);
  const Patch flown = find(image, FigureColors::kFlown, 0, half);
  EXPECT_GT(flown.right - flown.left, 1500);  // across the sheet
  // What is on the left of the way is above it.
  EXPECT_LT(find(image, FigureColors::kObstacle, 0, half).y, flown.y - 50.0);
}

TEST(Figure, DrawsALogOfFlyAloneAndAnEmptyStretch) {
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
  const Image image = draw(folder, log, 3.0);
  EXPECT_GT(find(image, FigureColors::kFlown, 0, image.height()).count, 1000);
  EXPECT_GT(find(image, FigureColors::kTrack, 0, image.height()).count, 50);
}

TEST(Figure, RefusesWhatItCannotShow) {
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
  EXPECT_TRUE(message(log_text(), {}, folder.path() / "none" / "x.png").ends_with("x.png: cannot write the figure"));
}

}  // namespace
}  // namespace jink::tools::report
