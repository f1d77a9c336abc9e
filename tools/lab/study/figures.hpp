// SPDX-License-Identifier: BSD-3-Clause
// The figures of [Paper] section 5 from the study's records, and those that go beyond it.
#pragma once

#include <string>
#include <vector>

#include "tools/figures/figure.hpp"
#include "tools/lab/study/run.hpp"
#include "tools/lab/study/selection.hpp"

namespace jink::tools::lab::study {

using jink::tools::figures::Figure;
using jink::tools::figures::Kind;
using jink::tools::figures::Panel;
using jink::tools::figures::Series;

/// A figure and what is said below it. Figures without any record are left out by all_figures().
struct CaptionedFigure {
  Figure figure;
  std::string caption;
};

/// Figure 8: fronts of the first run at the first step, a panel for each sharing rate.
[[nodiscard]] CaptionedFigure fronts_figure(const Selection& selection, const Setting& setting, bool blocked);
/// Figures 9 to 11: the first run's path in a pictured world at several times.
[[nodiscard]] std::vector<CaptionedFigure> picture_figures(const Selection& selection, const Setting& setting,
                                                           bool blocked);
/// Figure 12: the paths of the first four runs in one world, of the paper and blocked.
[[nodiscard]] CaptionedFigure seeds_figure(const Selection& selection, const Setting& setting);
/// Figures 13 and 14: planning time over sharing rate and over slaves.
[[nodiscard]] std::vector<CaptionedFigure> time_figures(const Selection& selection);
/// Figure 15: planning times of all algorithms.
[[nodiscard]] CaptionedFigure comparison_figure(const Selection& selection);
/// Figures 16 and 17: over population and iterations.
[[nodiscard]] std::vector<CaptionedFigure> size_figures(const Selection& selection);
/// "anytime": what hypervolume lacks over evaluations and over wall time.
[[nodiscard]] CaptionedFigure anytime_figure(const Selection& selection, const Setting& setting, bool blocked);

[[nodiscard]] std::vector<CaptionedFigure> all_figures(const Selection& selection, const Setting& setting);

}  // namespace jink::tools::lab::study
