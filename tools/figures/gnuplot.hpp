// SPDX-License-Identifier: BSD-3-Clause
// What a figure's script is made of: styles, the places of panels, text. Internal to the figures.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/figures/figure.hpp"

namespace jink::tools::figures {

/// Text as gnuplot takes it: 'in single quotes', on one line.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// An entry of the legend, which all panels share.
struct LegendEntry {
  std::string label;
  Look look;
  Kind kind = Kind::line;
};

/// Where things are on the page, in mm.
struct Layout {
  int columns = 1, rows = 1;
  double width = 0.0, height = 0.0;  ///< of the picture
  double panel_width = 0.0, panel_height = 0.0;
  double legend_height = 0.0;  ///< at the bottom; 0: no legend
  int legend_columns = 1;
  std::vector<LegendEntry> legend;
};

/// The figure's layout. Requires a figure that check() accepted.
[[nodiscard]] Layout layout_of(const Figure& figure);

/// Throws FigureError, as gnuplot_script() says.
void check(const Figure& figure);

/// How a panel's series looks. Those that are chosen by number have colours of different lightness, with dashes and
/// marks of their own, so that neighbours differ without colour too; they repeat after 16.
[[nodiscard]] const Look& look_of(const Panel& panel, std::size_t series);

/// The script for these formats alone: "png svg".
[[nodiscard]] std::string gnuplot_script(const Figure& figure, const std::string& formats);

[[nodiscard]] bool in_space(const Panel& panel);

}  // namespace jink::tools::figures
