// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/canvas.hpp"

#include <cairo.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "tools/report/crc32.hpp"

namespace jink::tools::report {
namespace {

constexpr double kMillimetres = 25.4;     // of an inch
constexpr std::size_t kAfterHeader = 33;  // of a PNG: its signature and the chunk IHDR

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("the figure cannot be drawn: ") + cairo_status_to_string(status));
}

double channel(std::string_view color, std::size_t k) {
  unsigned value = 0;
  std::from_chars(color.data() + 1 + 2 * k, color.data() + 3 + 2 * k, value, 16);
  return value / 255.0;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>((value >> shift) & 0xFFU);
  return bytes;
}

/// The chunk pHYs: pixels per metre, both ways.
std::string resolution_chunk(double dpi) {
  const std::string density = big_endian(static_cast<std::uint32_t>(std::lround(dpi / kMillimetres * 1000.0)));
  const std::string body = "pHYs" + density + density + '\1';
  return big_endian(static_cast<std::uint32_t>(body.size() - 4)) + body + big_endian(crc32(body));
}

}  // namespace

Canvas::Canvas(double width_mm, double height_mm, double dpi)
    : dpi_(dpi), surface_(nullptr, cairo_surface_destroy), cairo_(nullptr, cairo_destroy) {
  const double scale = dpi / kMillimetres;
  surface_.reset(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(width_mm * scale)),
                                            static_cast<int>(std::lround(height_mm * scale))));
  check(cairo_surface_status(surface_.get()));
  cairo_.reset(cairo_create(surface_.get()));
  check(cairo_status(cairo_.get()));
  cairo_scale(cairo_.get(), scale, scale);
  cairo_set_source_rgb(cairo_.get(), 1.0, 1.0, 1.0);
  cairo_paint(cairo_.get());
  cairo_set_line_join(cairo_.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cairo_.get(), CAIRO_LINE_CAP_BUTT);
}

Canvas::~Canvas() = default;

void Canvas::paint(std::string_view color, double opacity) {
  cairo_set_source_rgba(cairo_.get(), channel(color, 0), channel(color, 1), channel(color, 2), opacity);
}

void Canvas::stroke(const Pen& pen) {
  paint(pen.color, pen.opacity);
  cairo_set_line_width(cairo_.get(), pen.width);
  cairo_set_dash(cairo_.get(), pen.dash.data(), static_cast<int>(pen.dash.size()), 0.0);
  cairo_stroke(cairo_.get());
}

void Canvas::line(std::span<const Spot> points, const Pen& pen) {
  if (points.size() < 2) return;
  cairo_new_path(cairo_.get());
  for (const auto& [x, y] : points) cairo_line_to(cairo_.get(), x, y);
  stroke(pen);
}

void Canvas::polygon(std::span<const Spot> corners, std::string_view fill, double opacity, const Pen& edge) {
  cairo_new_path(cairo_.get());
  for (const auto& [x, y] : corners) cairo_line_to(cairo_.get(), x, y);
  cairo_close_path(cairo_.get());
  paint(fill, opacity);
  cairo_fill_preserve(cairo_.get());
  stroke(edge);
}

void Canvas::circle(const Spot& centre, double radius, std::string_view fill, double opacity, const Pen& edge) {
  cairo_new_path(cairo_.get());
  cairo_arc(cairo_.get(), centre[0], centre[1], radius, 0.0, 2.0 * std::numbers::pi);
  paint(fill, opacity);
  cairo_fill_preserve(cairo_.get());
  stroke(edge);
}

void Canvas::box(const Frame& frame, const Pen& edge) {
  cairo_new_path(cairo_.get());
  cairo_rectangle(cairo_.get(), frame.x, frame.y, frame.width, frame.height);
  stroke(edge);
}

void Canvas::choose_font(const TextStyle& style) {
  const auto weight = style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL;
  cairo_select_font_face(cairo_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, weight);
  cairo_set_font_size(cairo_.get(), style.size);
}

double Canvas::text_width(const std::string& text, const TextStyle& style) {
  choose_font(style);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_.get(), text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(const Spot& at, const std::string& text, const TextStyle& style) {
  constexpr double kMiddle = 0.36;  // of the font's size, from the base line
  const double width = text_width(text, style);
  const double back = style.align == Align::kLeft ? 0.0 : style.align == Align::kCentre ? 0.5 * width : width;
  cairo_save(cairo_.get());
  cairo_translate(cairo_.get(), at[0], at[1]);
  if (style.upright) cairo_rotate(cairo_.get(), -0.5 * std::numbers::pi);
  cairo_move_to(cairo_.get(), -back, kMiddle * style.size);
  cairo_text_path(cairo_.get(), text.c_str());
  if (style.halo) {
    paint("#ffffff", 0.85);
    cairo_set_line_width(cairo_.get(), 0.3 * style.size);
    cairo_set_dash(cairo_.get(), nullptr, 0, 0.0);
    cairo_stroke_preserve(cairo_.get());
  }
  paint(style.color, 1.0);
  cairo_fill(cairo_.get());
  cairo_restore(cairo_.get());
}

void Canvas::clip(const Frame& frame) {
  cairo_save(cairo_.get());
  cairo_rectangle(cairo_.get(), frame.x, frame.y, frame.width, frame.height);
  cairo_clip(cairo_.get());
}

void Canvas::unclip() {
  cairo_restore(cairo_.get());
}

std::string Canvas::png() {
  check(cairo_status(cairo_.get()));
  std::string bytes;
  const auto append = [](void* closure, const unsigned char* data, unsigned length) {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  };
  check(cairo_surface_write_to_png_stream(surface_.get(), append, &bytes));
  return bytes.insert(kAfterHeader, resolution_chunk(dpi_));
}

}  // namespace jink::tools::report
