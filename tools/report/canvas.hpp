// SPDX-License-Identifier: BSD-3-Clause
// A sheet of paper in millimetres to draw a figure on, kept as a PNG. Cairo draws; nothing else knows of it.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct _cairo;
struct _cairo_surface;

namespace jink::tools::report {

/// On the sheet, mm: x to the right, y down.
using Spot = std::array<double, 2>;

struct Frame {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;  ///< of the upper left corner, mm
};

struct Pen {
  std::string_view color = "#1c2530";  ///< "#rrggbb"
  double width = 0.25;                 ///< mm
  std::vector<double> dash = {};       ///< mm, on and off; empty: none
  double opacity = 1.0;
};

enum class Align { kLeft, kCentre, kRight };

struct TextStyle {
  double size = 2.5;  ///< mm, of the font
  Align align = Align::kLeft;
  std::string_view color = "#1c2530";
  bool bold = false;
  bool upright = false;  ///< turned a quarter, read from the right
  bool halo = false;     ///< white around the letters
};

/// Not thread safe.
class Canvas {
 public:
  /// A white sheet. Throws std::runtime_error where there is no memory for it.
  Canvas(double width_mm, double height_mm, double dpi);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void line(std::span<const Spot> points, const Pen& pen);
  void polygon(std::span<const Spot> corners, std::string_view fill, double opacity, const Pen& edge);
  void circle(const Spot& centre, double radius, std::string_view fill, double opacity, const Pen& edge);
  void box(const Frame& frame, const Pen& edge);
  /// `at` is on the letters' middle line. UTF-8.
  void text(const Spot& at, const std::string& text, const TextStyle& style = {});
  [[nodiscard]] double text_width(const std::string& text, const TextStyle& style = {});
  /// What is drawn until the next call of unclip() shows within the frame alone.
  void clip(const Frame& frame);
  void unclip();

  /// The sheet as the bytes of a PNG that tells its resolution. Throws std::runtime_error where drawing failed.
  [[nodiscard]] std::string png();

 private:
  void stroke(const Pen& pen);
  void paint(std::string_view color, double opacity);
  void choose_font(const TextStyle& style);
  double dpi_;
  std::unique_ptr<_cairo_surface, void (*)(_cairo_surface*)> surface_;
  std::unique_ptr<_cairo, void (*)(_cairo*)> cairo_;
};

}  // namespace jink::tools::report
