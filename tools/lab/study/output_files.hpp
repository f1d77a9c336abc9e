// SPDX-License-Identifier: BSD-3-Clause
// What the study leaves in its folder beside the results: tables, figures, worlds, the report.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "tools/lab/study/results.hpp"
#include "tools/lab/study/run.hpp"

namespace jink::tools::lab::study {

/// Writes tableNN.csv, .md and .tex, figureNN.gp, .dat, .png and .svg, claims and verdicts likewise, worlds/,
/// planner.yaml and report.html into the folder, which exists; figures are drawn by `threads` at once. Gives back the
/// summary that --json writes. Throws ResultsError or FigureError where something cannot be written or drawn.
[[nodiscard]] nlohmann::ordered_json write_study(const Results& results, const Setting& setting,
                                                 const std::filesystem::path& out, int threads);

}  // namespace jink::tools::lab::study
