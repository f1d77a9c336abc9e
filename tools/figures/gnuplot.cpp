// SPDX-License-Identifier: BSD-3-Clause
// A figure as gnuplot's script and data.
#include "tools/figures/gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace jink::tools::figures {
namespace {

constexpr double kPixelsPerMm = kResolution_dpi / 25.4;  // PNG
constexpr double kSvgPerMm = 96.0 / 25.4;
constexpr double kPoint = 8.0;                  // the font's size in print
constexpr double kBarsWidth = 0.8;              // of the distance between bars' places
constexpr int kTicksOnFloor = 8, kTicksUp = 4;  // at most, in space
constexpr double kRoom = 0.03;                  // left and right of curves, of the axis' length
constexpr double kNames = 5.0;  // mm, from the page's edge to the y axes' names, where panels have frames
constexpr const char* kSphereColour = "#b9cfe6";

/// The number of the style that styles_of() sets for a panel's series.
int line_number(std::size_t series) {
  return 101 + static_cast<int>(series);
}

std::string style_line(int number, const Look& look) {
  return fmt::format("set style line {} lc rgb '{}' lw {} dt {} pt {} ps {}\n", number, look.colour, look.width,
                     look.dashes, look.mark, look.mark_size);
}

std::string styles_of(const Panel& panel) {
  std::string text;
  for (std::size_t i = 0; i < panel.series.size(); ++i) text += style_line(line_number(i), look_of(panel, i));
  return text;
}

std::string areas_plot(const Look& look) {
  const std::string fill = look.opacity < 1.0 ? fmt::format("transparent solid {:g}", look.opacity) : "solid 1.0";
  return look.edge.empty() ? fmt::format("fs {} noborder", fill)
                           : fmt::format("fs {} border lc rgb '{}'", fill, look.edge);
}

std::string value(double v) {
  return std::isnan(v) ? "NaN" : fmt::format("{}", v);
}

std::string row(const std::vector<const std::vector<double>*>& columns, std::size_t i) {
  std::string text;
  for (const std::vector<double>* column : columns) {
    if (!text.empty()) text += ' ';
    text += column->empty() ? "NaN" : value((*column)[i]);
  }
  return text + '\n';
}

/// A blank line ends a line or an outline, another begins behind it; two of them would end the block.
std::string rows(const Series& s, bool in_space) {
  const bool gaps = s.kind == Kind::line || s.kind == Kind::areas;
  std::string text;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (gaps && std::isnan(s.y[i])) continue;
    if (gaps && !text.empty() && std::isnan(s.y[i - 1])) text += '\n';
    text += in_space ? row({&s.x, &s.y, &s.z}, i) : row({&s.x, &s.y, &s.low, &s.high, &s.least, &s.greatest}, i);
  }
  if (text.empty()) text = in_space ? "NaN NaN NaN\n" : "NaN NaN NaN NaN NaN NaN\n";  // keeps the block's number
  return text;
}

/// The smallest distance between two places on x; 1 for fewer than two.
double spacing(const Panel& panel) {
  std::set<double> places;
  for (const Series& s : panel.series)
    if (s.kind == Kind::bars || s.kind == Kind::boxes) places.insert(s.x.begin(), s.x.end());
  double least = std::numeric_limits<double>::infinity();
  for (auto next = places.begin(); next != places.end() && std::next(next) != places.end(); ++next)
    least = std::min(least, *std::next(next) - *next);
  return std::isfinite(least) ? least : 1.0;
}

/// Where the n-th bar of `count` around a place stands, and how wide it is.
struct Slot {
  double offset = 0.0, width = 0.0;
};
Slot slot(const Panel& panel, std::size_t series) {
  const auto stands = [](const Series& s) { return s.kind == Kind::bars || s.kind == Kind::boxes; };
  const auto count = static_cast<double>(std::count_if(panel.series.begin(), panel.series.end(), stands));
  const auto before = static_cast<double>(
      std::count_if(panel.series.begin(), panel.series.begin() + static_cast<std::ptrdiff_t>(series), stands));
  const double width = kBarsWidth * spacing(panel) / count;
  return {(before - (count - 1.0) / 2.0) * width, width};
}

/// The plots of a flat panel's series, each without a title: the legend is drawn apart.
std::vector<std::string> flat_plots(const Panel& panel, std::size_t i, int index) {
  const Series& s = panel.series[i];
  const int ls = line_number(i);
  const std::string data = fmt::format("data index {} using ", index);
  std::vector<std::string> plots;
  const Slot place = slot(panel, i);
  const std::string x = s.kind == Kind::bars || s.kind == Kind::boxes ? fmt::format("($1+{:.6g})", place.offset) : "1";
  switch (s.kind) {
    case Kind::band:
      plots.push_back(data + fmt::format("1:3:4 with filledcurves ls {} fs transparent solid 0.18 noborder", ls));
      plots.push_back(data + fmt::format("1:2 with lines ls {}", ls));
      return plots;
    case Kind::boxes:
      plots.push_back(data + fmt::format("{0}:3:5:6:4:({1:.6g}) with candlesticks ls {2} dt solid fs solid 0.35 border "
                                         "lc rgb 'black' whiskerbars 0.5",
                                         x, 0.85 * place.width, ls));
      plots.push_back(data + fmt::format("({0}-{1:.6g}):2:({2:.6g}):(0) with vectors nohead lc rgb 'black' lw 2.2", x,
                                         0.425 * place.width, 0.85 * place.width));
      return plots;
    case Kind::bars:
      plots.push_back(data + fmt::format("{}:2:({:.6g}) with boxes ls {} dt solid fs solid 0.8 border lc rgb 'black'",
                                         x, 0.92 * place.width, ls));
      break;
    case Kind::line:
      plots.push_back(data + fmt::format("1:2 with lines ls {}", ls));
      break;
    case Kind::line_points:
      plots.push_back(data + fmt::format("1:2 with linespoints ls {}", ls));
      break;
    case Kind::points:
      plots.push_back(data + fmt::format("1:2 with points ls {}", ls));
      break;
    case Kind::areas:
      plots.push_back(data + fmt::format("1:2 with filledcurves closed ls {} {}", ls, areas_plot(look_of(panel, i))));
      break;
  }
  return plots;
}

/// The intervals of a series that is not made of them. gnuplot's own error bars leave a gap about the point.
std::string interval_plot(const Panel& panel, std::size_t i, int index) {
  if (panel.series[i].kind == Kind::bars) {
    const Slot place = slot(panel, i);
    return fmt::format(
        "data index {} using ($1+{:.6g}):2:3:4:2:({:.6g}) with candlesticks lc rgb 'black' lw 1 whiskerbars", index,
        place.offset, 0.4 * place.width);
  }
  return fmt::format("data index {} using 1:3:(0):($4-$3) with vectors nohead ls {} dt solid lw 1", index,
                     line_number(i));
}

bool has_intervals(const Series& s) {
  return !s.low.empty() && s.kind != Kind::band && s.kind != Kind::boxes;
}

/// What a panel shows along an axis; empty: nothing finite.
struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void add(const std::vector<double>& values) {
    for (const double v : values) add(v);
  }
  void add(double v) {
    if (std::isnan(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

std::string range(const char* axis, const std::optional<std::pair<double, double>>& given,
                  const std::string& otherwise) {
  return fmt::format("set {}range {}\n", axis, given ? fmt::format("[{}:{}]", given->first, given->second) : otherwise);
}

/// x and y: bars start at 0, or on a logarithmic axis at the power of ten below the least one.
std::string flat_ranges(const Panel& panel) {
  Extent x, y;
  bool bars = false, stands = false;
  for (const Series& s : panel.series) {
    x.add(s.x);
    for (const auto* values : {&s.y, &s.low, &s.high, &s.least, &s.greatest}) y.add(*values);
    bars = bars || s.kind == Kind::bars;
    stands = stands || s.kind == Kind::bars || s.kind == Kind::boxes;
  }
  const double margin = 0.6 * spacing(panel);
  if (!panel.categories.empty()) {
    x.add(0.0);
    x.add(static_cast<double>(panel.categories.size()) - 1.0);
  }
  std::string x_range;
  if (stands || !panel.categories.empty()) {
    x_range = fmt::format("[{:.6g}:{:.6g}]", x.low - margin, x.high + margin);
  } else if (panel.log_x) {
    const double room = std::pow(std::max(x.high / x.low, 1.1), kRoom);
    x_range = fmt::format("[{:.6g}:{:.6g}]", x.low / room, x.high * room);
  } else {
    const double room = kRoom * (x.high > x.low ? x.high - x.low : 1.0);
    x_range = fmt::format("[{:.6g}:{:.6g}]", x.low - room, x.high + room);
  }
  std::string y_range = "[*:*]";
  if (bars && panel.log_y)
    y_range = fmt::format("[{:.6g}:*]", std::pow(10.0, std::floor(std::log10(0.8 * y.low))));
  else if (bars && y.low >= 0.0)
    y_range = "[0:*]";
  else if (y.low == y.high && !panel.log_y)  // gnuplot would warn of an axis without length
    y_range = fmt::format("[{:.9g}:{:.9g}]", y.low - std::max(1e-3, 0.01 * std::abs(y.low)),
                          y.high + std::max(1e-3, 0.01 * std::abs(y.high)));
  return range("x", panel.x_range, x_range) + range("y", panel.y_range, y_range);
}

std::string x_ticks(const Panel& panel, double panel_width) {
  std::vector<std::string> ticks;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < panel.categories.size(); ++i) {
    const std::string name = panel.x_numbers ? panel.categories[i] : "";
    ticks.push_back(fmt::format("{} {}", in_quotes(name), i));
    longest = std::max(longest, name.size());
  }
  for (const double t : panel.ticks) ticks.push_back(fmt::format("'{0:g}' {0}", t));
  if (ticks.empty()) return "set xtics nomirror auto norotate autojustify; unset bmargin\n";
  const double room = 0.8 * panel_width / static_cast<double>(ticks.size());
  const bool turned = 1.6 * static_cast<double>(longest) > room;
  // gnuplot reserves too little for turned names.
  const double lines = 2.0 + 0.38 * static_cast<double>(longest) + (panel.x_label.empty() ? 0.0 : 1.5);
  return fmt::format("set xtics {} ({}); {}\n", turned ? "rotate by 40 right" : "norotate autojustify",
                     fmt::join(ticks, ", "), turned ? fmt::format("set bmargin {:.1f}", lines) : "unset bmargin");
}

/// Where the axes of a panel with a frame are.
std::string margins(const Frame& frame, const Layout& layout) {
  const auto x = [&](double mm) { return mm / layout.width; };
  const auto y = [&](double mm) { return 1.0 - mm / layout.height; };
  return fmt::format(
      "set lmargin at screen {:.5f}; set rmargin at screen {:.5f}; set tmargin at screen {:.5f}; set bmargin at screen "
      "{:.5f}\n",
      x(frame.left), x(frame.left + frame.width), y(frame.top), y(frame.top + frame.height));
}

/// Rules and notes.
std::string marks(const Panel& panel, const Layout& layout) {
  std::string text;
  for (const Rule& rule : panel.rules) {
    const std::string at = value(rule.at);
    text += fmt::format(fmt::runtime(rule.upright ? "set arrow from {0},graph 0 to {0},graph 1"
                                                  : "set arrow from graph 0,first {0} to graph 1,first {0}"),
                        at);
    text += fmt::format(" nohead lc rgb '#66{}' lw 0.8 dt {} back\n", rule.colour.substr(1),
                        rule.dashed ? "(12,12)" : "solid");
  }
  if (panel.frame)  // in line with those of the other panels
    text += fmt::format("set ylabel ''; set label {} at screen {:.5f},graph 0.5 center rotate\n",
                        in_quotes(panel.y_label), kNames / layout.width);
  for (const Note& note : panel.notes) {
    const char* side = note.side == Note::Side::left ? "left" : note.side == Note::Side::right ? "right" : "center";
    text +=
        fmt::format("set label {} at {},{} {} offset screen 0,{:.5f} tc rgb '{}' font small front\n",
                    in_quotes(note.text), value(note.x), value(note.y), side, note.above / layout.height, note.colour);
  }
  return text;
}

/// What stands above all panels.
std::string headings(const Figure& figure, const Layout& layout) {
  if (figure.height_mm <= 0.0) return "";
  const double left = figure.panels.front().frame->left / layout.width;
  const auto y = [&](double mm) { return 1.0 - mm / layout.height; };
  return fmt::format(
      "set label {} at screen {:.5f},{:.5f} left font large\nset label {} at screen {:.5f},{:.5f} left\n"
      "set label {} at screen {:.5f},{:.5f} right\n",
      in_quotes(figure.heading), left, y(5.0), in_quotes(figure.subheading), left, y(10.0), in_quotes(figure.remark),
      1.0 - 4.0 / layout.width, y(5.0));
}

std::string flat_panel(const Panel& panel, const Layout& layout, int& index) {
  const double panel_width = panel.frame ? panel.frame->width : layout.panel_width;
  std::string text = fmt::format(
      "set border {} lc rgb '#404040' lw 0.8\nset grid {}ytics lt 1 lc rgb '#d8d8d8' lw 0.6 dt solid; set rmargin 3; "
      "set "
      "ytics {}\n",
      panel.frame ? 15 : 3, panel.frame ? "xtics " : "", panel.y_step > 0.0 ? value(panel.y_step) : "auto");
  text += marks(panel, layout);
  text += panel.log_x ? "set logscale x\n" : "unset logscale x\n";
  text += panel.log_y ? "set logscale y\n" : "unset logscale y\n";
  text += x_ticks(panel, panel_width) + flat_ranges(panel);
  if (panel.frame) text += margins(*panel.frame, layout);
  text += panel.x_numbers ? "set format x '%.10g'\n" : "set format x ''\n";
  std::vector<std::string> plots;
  for (std::size_t i = 0; i < panel.series.size(); ++i, ++index) {
    // Marks lie over their intervals, and those of bars over the bars.
    const bool bars = panel.series[i].kind == Kind::bars, intervals = has_intervals(panel.series[i]);
    if (intervals && !bars) plots.push_back(interval_plot(panel, i, index));
    for (std::string& plot : flat_plots(panel, i, index)) plots.push_back(std::move(plot));
    if (intervals && bars) plots.push_back(interval_plot(panel, i, index));
  }
  return text + fmt::format("plot {}\nunset arrow; unset label\n", fmt::join(plots, ", \\\n     "));
}

std::string space_ranges(const Panel& panel, double& floor) {
  Extent x, y, z;
  for (const Series& s : panel.series) {
    x.add(s.x);
    y.add(s.y);
    z.add(s.z);
  }
  for (const Sphere& s : panel.spheres) {
    for (const double end : {s.x - s.radius, s.x + s.radius, s.to_x}) x.add(end);
    for (const double end : {s.y - s.radius, s.y + s.radius, s.to_y}) y.add(end);
    for (const double end : {s.z - s.radius, s.z + s.radius, s.to_z}) z.add(end);
  }
  const auto whole = [](const Extent& e) {
    const double low = std::floor(e.low);
    return std::pair{low, std::max(low + 1.0, std::ceil(e.high))};
  };
  const auto axis = [&](const char* name, const std::optional<std::pair<double, double>>& given, const Extent& e,
                        int most) {
    const auto [low, high] = given ? *given : whole(e);
    // Ticks at whole metres, few enough to stand apart.
    return fmt::format("set {0}range [{1}:{2}]; set {0}tics {3:g} norotate autojustify\n", name, low, high,
                       std::max(1.0, std::ceil((high - low) / most)));
  };
  floor = panel.z_range ? panel.z_range->first : std::floor(z.low);
  return axis("x", panel.x_range, x, kTicksOnFloor) + axis("y", panel.y_range, y, kTicksOnFloor) +
         axis("z", panel.z_range, z, kTicksUp);
}

std::string space_panel(const Panel& panel, int& index) {
  double floor = 0.0;
  std::string text = space_ranges(panel, floor);
  text += "unset logscale; unset rmargin; unset bmargin\n";
  text += fmt::format("set zlabel {} rotate offset 1.2,0; set xyplane at {}\n", in_quotes(panel.z_label), value(floor));
  text +=
      "set view 58,38,1.4; set view equal xyz\n"
      "set border 895 lc rgb '#a0a0a0' lw 0.6; set grid x y lc rgb '#d8d8d8' lw 0.6 dt solid\n"
      "set parametric; set urange [0:2*pi]; set vrange [-pi/2:pi/2]; set isosamples 17,9; set samples 33\n"
      "set pm3d depthorder noborder; set pm3d lighting primary 0.5 specular 0.15; unset colorbox\n";
  std::vector<std::string> shadows, solids, paths;
  for (const Sphere& s : panel.spheres) {
    const auto axis = [&](double centre, const char* direction) {
      return fmt::format("{}+{}*{}", value(centre), value(s.radius), direction);
    };
    shadows.push_back(fmt::format("'+' using ({}):({}):({}) with lines lc rgb '#b0b0b0' lw 0.8", axis(s.x, "cos($1)"),
                                  axis(s.y, "sin($1)"), value(floor)));
    solids.push_back(fmt::format("{}, {}, {} with pm3d fc rgb '{}'", axis(s.x, "cos(u)*cos(v)"),
                                 axis(s.y, "sin(u)*cos(v)"), axis(s.z, "sin(v)"), kSphereColour));
  }
  for (std::size_t i = 0; i < panel.series.size(); ++i, ++index) {
    const Series& s = panel.series[i];
    const int ls = line_number(i);
    const char* how = s.kind == Kind::line ? "lines" : s.kind == Kind::points ? "points" : "linespoints";
    if (s.kind != Kind::points)
      shadows.push_back(
          fmt::format("data index {} using 1:2:({}) with lines lc rgb '#b0b0b0' lw 0.8", index, value(floor)));
    paths.push_back(fmt::format("data index {} using 1:2:3 with {} ls {}", index, how, ls));
  }
  if (!panel.spheres.empty())
    paths.push_back(
        fmt::format("data index {} using 1:2:3:($5-$1):($6-$2):($7-$3) with vectors filled head size graph "
                    "0.025,25 lc rgb '#404040' lw 0.9",
                    index++));
  std::vector<std::string> plots = shadows;
  plots.insert(plots.end(), solids.begin(), solids.end());
  plots.insert(plots.end(), paths.begin(), paths.end());
  return text + fmt::format("splot {}\nunset parametric; unset zlabel\n", fmt::join(plots, ", \\\n      "));
}

std::string legend_strip(const Layout& layout) {
  if (layout.legend.empty()) return "";
  // The first entry is a curve, out of sight: gnuplot draws no legend where nothing is plotted.
  std::vector<std::string> entries;
  std::string styles;
  for (const LegendEntry& entry : layout.legend) {
    const int ls = line_number(entries.size());
    styles += style_line(ls, entry.look);
    const char* with = entry.kind == Kind::points        ? "points ls {0}"
                       : entry.kind == Kind::line_points ? "linespoints ls {0}"
                       : entry.kind == Kind::bars        ? "boxes ls {0} dt solid fs solid 0.8 border lc rgb 'black'"
                       : entry.kind == Kind::boxes       ? "boxes ls {0} dt solid fs solid 0.35 border lc rgb 'black'"
                       : entry.kind == Kind::areas       ? "boxes ls {0} "
                                                         : "lines ls {0}";
    entries.push_back(fmt::format("{} with {}{} title {}", entries.empty() ? "-1" : "keyentry",
                                  fmt::format(fmt::runtime(with), ls),
                                  entry.kind == Kind::areas ? areas_plot(entry.look) : "", in_quotes(entry.label)));
  }
  return fmt::format(
      "\n# The legend.\nset origin 0,0; set size 1,{:.5f}\nset lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0\n"
      "unset title; unset xlabel; unset ylabel; unset border; unset tics; unset grid; unset logscale\n"
      "set xrange [0:1]; set yrange [0:1]\nset key center horizontal maxcols {} reverse Left samplen 3 spacing 1.1 "
      "width 2\n"
      "{}plot {}\n",
      layout.legend_height / layout.height, layout.legend_columns, styles, fmt::join(entries, ", \\\n     "));
}

std::string head(const Figure& figure, const Layout& layout, const std::string& formats) {
  std::string title = figure.title;
  std::replace(title.begin(), title.end(), '\n', ' ');
  std::string text = fmt::format(
      "# {0}: {1}\n# Drawn by gnuplot 5.4 from {0}.dat; after a change, `gnuplot {0}.gp` in this folder draws it "
      "again.\n"
      "data = '{0}.dat'\nset encoding utf8\nset datafile missing 'NaN'\nset format '%.10g'\n",
      figure.id, title);
  const double scale = kResolution_dpi / 96.0;  // the terminal takes a point for 1/72 inch at 96 dots an inch
  text += fmt::format(
      "do for [form in '{}'] {{\n"
      "if (form eq 'png') {{ set terminal pngcairo noenhanced size {:.0f},{:.0f} font 'DejaVu Sans,{:g}' fontscale "
      "{:.4f} "
      "linewidth {:.3f} pointscale {:.3f} }} \\\n"
      "else {{ set terminal svg noenhanced size {:.0f},{:.0f} dynamic font 'DejaVu Sans,{:.2f}' linewidth 1 background "
      "'white' }}\n"
      "font(size) = sprintf(',%g', (form eq 'png' ? 1 : 96.0/72) * size)\n"
      "small = font(6.5); large = 'DejaVu Sans:Bold'.font(10)\n",
      formats, layout.width * kPixelsPerMm, layout.height * kPixelsPerMm, kPoint, scale, scale, scale,
      layout.width * kSvgPerMm, layout.height * kSvgPerMm, kPoint * 96.0 / 72.0);
  return text +
         fmt::format(
             "set output '{}.'.form\nset multiplot\n"
             "set xtics nomirror out scale 0.6; set ytics nomirror out scale 0.6; set ztics nomirror out scale 0.6\n"
             "unset lmargin; unset rmargin; unset tmargin; unset bmargin\n",
             figure.id);
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += '\'';
    out += c == '\n' ? ' ' : c;
  }
  return out + '\'';
}

std::string gnuplot_script(const Figure& figure) {
  return gnuplot_script(figure, "png svg");
}

std::string gnuplot_script(const Figure& figure, const std::string& formats) {
  check(figure);
  const Layout layout = layout_of(figure);
  std::string text = head(figure, layout, formats) + headings(figure, layout);
  int index = 0;
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const Panel& panel = figure.panels[p];
    const int across = static_cast<int>(p) % layout.columns, down = static_cast<int>(p) / layout.columns;
    const double bottom = layout.legend_height + layout.panel_height * (layout.rows - 1 - down);
    text += "\nunset key\n" + styles_of(panel);
    if (!panel.frame)
      text += fmt::format("set origin {:.5f},{:.5f}; set size {:.5f},{:.5f}\n",
                          across / static_cast<double>(layout.columns), bottom / layout.height, 1.0 / layout.columns,
                          layout.panel_height / layout.height);
    text += fmt::format("set title {}; set xlabel {}; set ylabel {}\n", in_quotes(panel.title),
                        in_quotes(panel.x_label), in_quotes(panel.y_label));
    text += in_space(panel) ? space_panel(panel, index) : flat_panel(panel, layout, index);
  }
  return text + legend_strip(layout) + "unset multiplot\nset output\n}\n";
}

std::string gnuplot_data(const Figure& figure) {
  check(figure);
  std::string text;
  const auto begin_block = [&](const Panel& panel, const std::string& series, const char* columns) {
    if (!text.empty()) text += "\n\n";
    std::string name = panel.title + (panel.title.empty() || series.empty() ? "" : ": ") + series;
    std::replace(name.begin(), name.end(), '\n', ' ');
    text += fmt::format("# {}\n# {}\n", name, columns);
  };
  for (const Panel& panel : figure.panels) {
    for (const Series& s : panel.series) {
      begin_block(panel, s.label, in_space(panel) ? "x y z" : "x y low high least greatest");
      text += rows(s, in_space(panel));
    }
    if (panel.spheres.empty()) continue;
    begin_block(panel, "spheres", "x y z radius to_x to_y to_z");
    for (const Sphere& s : panel.spheres) {
      const bool still = s.to_x == s.x && s.to_y == s.y && s.to_z == s.z;
      text += fmt::format("{} {} {} {} ", s.x, s.y, s.z, s.radius);
      text += still ? std::string("NaN NaN NaN\n") : fmt::format("{} {} {}\n", s.to_x, s.to_y, s.to_z);
    }
  }
  return text;
}

}  // namespace jink::tools::figures
