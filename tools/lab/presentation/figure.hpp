// SPDX-License-Identifier: BSD-3-Clause
// Figures, said as data and drawn by gnuplot. The script and the data stay beside the picture, so that whoever wants
// another style edits the script and runs `gnuplot ID.gp` in its folder.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace jink::tools::lab::presentation {

/// A figure that cannot be drawn: one line, fit for stderr.
class FigureError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class Kind {
  line,         ///< y over x
  line_points,  ///< with a mark at each point
  points,       ///< marks alone
  steps,        ///< y holds until the next x
  band,         ///< a line, and the area from low to high around it
  bars,         ///< from 0 up (log axis: from the bottom); of several such series side by side around each x
  boxes,        ///< box plots: y the median, low and high the quartiles, least and greatest the whiskers' ends
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
  int style = -1;  ///< colour, dashes and mark: the same number looks the same everywhere; -1: its place in the panel
};

/// A series of boxes over 0, 1, ... with a box for each sample: median, quartiles, and whiskers to the outermost
/// values. An empty sample is a gap.
[[nodiscard]] Series box_series(std::string label, const std::vector<std::vector<double>>& samples);

/// A sphere in a panel in space: an obstacle at the panel's time, with a line to where it moves.
struct Sphere {
  double x = 0.0, y = 0.0, z = 0.0;           ///< its centre, m
  double radius = 0.0;                        ///< m
  double to_x = 0.0, to_y = 0.0, to_z = 0.0;  ///< the arrow's end, m; drawn where it differs from the centre
};

struct Panel {
  std::string title{};
  std::string x_label, y_label;  ///< with units: "Time (s)"
  std::string z_label{};         ///< not empty: a panel in space
  bool log_x = false, log_y = false;
  std::optional<std::pair<double, double>> x_range{}, y_range{},
      z_range{};                          ///< the axes' ends; none: what is drawn fits
  std::vector<std::string> categories{};  ///< names at x = 0, 1, ... in place of numbers
  std::vector<double> ticks{};            ///< x ticks at these alone (a log axis of 1, 2, 4)
  std::vector<Series> series{};
  std::vector<Sphere> spheres{};
  bool legend = true;  ///< beside the panels or below, once for each label in the figure, never over the data
};

struct Figure {
  std::string id;     ///< "figure13": the files' name
  std::string title;  ///< for the caption; not drawn
  std::vector<Panel> panels;
  int columns = 0;               ///< panels side by side; 0: as many as look well
  double width_mm = 180.0;       ///< a page's width; fonts are 8 pt in print
  double panel_height_mm = 0.0;  ///< 0: fits the width
};

/// What draw() wrote.
struct Drawn {
  std::filesystem::path script, data, png, svg;
};

/// The figure's script, for gnuplot 5.4: it reads ID.dat and writes ID.png (300 dots an inch) and ID.svg (text as text)
/// in the folder it is run in. Throws FigureError where the figure makes no sense: lengths that differ, nothing to
/// draw, numbers <= 0 on a logarithmic axis, infinite numbers, an id that is no file name.
[[nodiscard]] std::string gnuplot_script(const Figure& figure);
/// The figure's data: a block with its label for each series and sphere, in full precision. The same figure always
/// gives the same text. Throws as gnuplot_script() does.
[[nodiscard]] std::string gnuplot_data(const Figure& figure);

/// Writes folder/ID.gp, .dat, .png and .svg; makes the folder. Runs `gnuplot` (Debian: gnuplot-nox), found in PATH, and
/// waits for it. Throws FigureError where that is missing or fails, or a file cannot be written. Several figures may be
/// drawn at once from several threads.
Drawn draw(const Figure& figure, const std::filesystem::path& folder);

}  // namespace jink::tools::lab::presentation
