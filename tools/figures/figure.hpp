// SPDX-License-Identifier: BSD-3-Clause
// Figures, said as data and drawn by the program gnuplot: those of the flight report, the arena and the study. Nothing
// of gnuplot is linked.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace jink::tools::figures {

/// A figure that cannot be drawn: one line, fit for stderr.
class FigureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// There is no gnuplot to draw it.
class GnuplotMissing : public FigureError {
 public:
  using FigureError::FigureError;
};

enum class Kind {
  line,         ///< y over x
  line_points,  ///< with a mark at each point
  points,       ///< marks alone
  band,         ///< a line, and the area from low to high around it
  bars,         ///< from 0 up (log axis: from the bottom); of several such series side by side around each x
  boxes,        ///< box plots: y the median, low and high the quartiles, least and greatest the whiskers' ends
  areas,        ///< filled outlines, a NaN in y between one and the next
};

/// How a series looks.
struct Look {
  std::string colour;            ///< "#rrggbb"
  double width = 1.4;            ///< of lines, pt
  std::string dashes = "solid";  ///< as gnuplot's dashtype: "solid" or "(9,4)"
  int mark = 7;                  ///< gnuplot's point type: 6 a ring, 7 a dot, 12 a diamond, 13 a filled one
  double mark_size = 0.7;
  std::string edge = {};  ///< the colour of areas' edges; empty: none
  double opacity = 1.0;   ///< of areas
};

/// One curve, or one bar or box for each category. `y` has the length of `x`, and so have the others where they are not
/// empty; in a panel in space `z` too. A NaN in y is a gap.
struct Series {
  std::string label;  ///< in the legend; empty: not in it
  std::vector<double> x, y{};
  std::vector<double> z{};                  ///< the third axis, in a panel in space
  std::vector<double> low{}, high{};        ///< an interval about y: error bars, a band's edges, or a box's quartiles
  std::vector<double> least{}, greatest{};  ///< boxes alone
  Kind kind = Kind::line_points;
  int style = -1;              ///< one of 16 looks: the same number is the same everywhere; -1: its place in the panel
  std::optional<Look> look{};  ///< in place of `style`
};

/// A sphere in a panel in space: an obstacle at the panel's time, with a line to where it moves.
struct Sphere {
  double x = 0.0, y = 0.0, z = 0.0;           ///< its centre, m
  double radius = 0.0;                        ///< m
  double to_x = 0.0, to_y = 0.0, to_z = 0.0;  ///< the arrow's end, m; drawn where it differs from the centre
};

/// Text in a flat panel.
struct Note {
  enum class Side { centre, left, right };  ///< of the text that is at the place
  double x = 0.0, y = 0.0;                  ///< the place, on the axes; beyond their ends is allowed
  std::string text;
  std::string colour = "#1c2530";
  Side side = Side::centre;
  double above = 0.0;  ///< moved up, mm
};

/// A line across a flat panel at a place of an axis.
struct Rule {
  double at = 0.0;
  std::string colour;
  bool upright = true;  ///< at a place of x; else of y
  bool dashed = false;
};

/// The place of a panel's axes on the page, mm from its upper left corner.
struct Frame {
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;
};

struct Panel {
  std::string title{};
  std::string x_label, y_label;  ///< with units: "Time (s)"
  std::string z_label{};         ///< not empty: a panel in space
  bool log_x = false, log_y = false;
  std::optional<std::pair<double, double>> x_range{}, y_range{},
      z_range{};                          ///< the axes' ends, y's also from high to low; none: what is drawn fits
  std::vector<std::string> categories{};  ///< names at x = 0, 1, ... in place of numbers
  std::vector<double> ticks{};            ///< x ticks at these alone (a log axis of 1, 2, 4)
  std::vector<Series> series{};
  std::vector<Sphere> spheres{};
  std::vector<Note> notes{};
  std::vector<Rule> rules{};
  double y_step = 0.0;           ///< between y ticks; 0: as many as fit
  bool x_numbers = true;         ///< false: ticks without them, above a panel with the same axis
  bool legend = true;            ///< beside the panels or below, once for each label in the figure, never over the data
  std::optional<Frame> frame{};  ///< where the axes are; none: in rows and columns
};

struct Figure {
  std::string id;     ///< "figure13": the files' name
  std::string title;  ///< for the caption; not drawn
  std::vector<Panel> panels;
  int columns = 0;               ///< panels side by side; 0: as many as look well
  double width_mm = 180.0;       ///< a page's width; fonts are 8 pt in print
  double panel_height_mm = 0.0;  ///< 0: fits the width
  double height_mm = 0.0;        ///< where panels have frames: of the page, without the legend below it
  std::string heading{}, subheading{}, remark{};  ///< drawn on top: left, below it, and right; for panels with frames
};

constexpr double kResolution_dpi = 300.0;  ///< of PNG files, which tell it

/// The least of 1, 2 and 5 times a power of ten that divides a length > 0 into `count` parts or fewer.
[[nodiscard]] double round_step(double length, double count);

/// What draw() wrote.
struct Drawn {
  std::filesystem::path script, data, png, svg;
};

/// The figure's script, for gnuplot 5.4: it reads ID.dat and writes ID.png and ID.svg (text as text) in the folder it
/// is run in. Throws FigureError where the figure makes no sense: lengths that differ, nothing to draw, numbers <= 0 on
/// a logarithmic axis, infinite numbers, an id that is no file name.
[[nodiscard]] std::string gnuplot_script(const Figure& figure);
/// The figure's data: a block with its label for each series and sphere, in full precision. The same figure always
/// gives the same text. Throws as gnuplot_script() does.
[[nodiscard]] std::string gnuplot_data(const Figure& figure);

/// Throws GnuplotMissing where there is no gnuplot in PATH: better before hours of work than after.
void require_gnuplot();

/// Writes folder/ID.gp, .dat, .png and .svg; makes the folder. The script and the data stay beside the pictures, so
/// that whoever wants another style edits the script and runs `gnuplot ID.gp` there. Runs `gnuplot` (Debian:
/// gnuplot-nox), found in PATH, and waits for it. Throws FigureError where that fails or a file cannot be written, and
/// GnuplotMissing. Several figures may be drawn at once from several threads.
Drawn draw(const Figure& figure, const std::filesystem::path& folder);

/// The bytes of the figure as a PNG; leaves no file. Throws as draw() does.
[[nodiscard]] std::string png_of(const Figure& figure);
/// The figure as the element <svg>, to stand in a page. Throws as draw() does.
[[nodiscard]] std::string svg_of(const Figure& figure);
/// The same of a file that draw() wrote. Every id of it gets `prefix`: ids are the page's, and each figure has the same
/// ones. Throws std::runtime_error where the file cannot be read or is no SVG.
[[nodiscard]] std::string svg_element(const std::filesystem::path& file, const std::string& prefix);

}  // namespace jink::tools::figures
