// SPDX-License-Identifier: BSD-3-Clause
// The study as a short paper: which tables and figures come where, and the sentences between them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/lab/presentation/report.hpp"
#include "tools/lab/study/run.hpp"
#include "tools/lab/study/selection.hpp"
#include "tools/lab/study/verdicts.hpp"

namespace jink::tools::lab::study {

/// What the report is put together from.
struct ReportParts {
  std::map<std::string, presentation::Table> tables;        ///< by id
  std::map<std::string, presentation::FigureFile> figures;  ///< by id; what was not drawn is missing
  std::vector<Claim> claims;
};

[[nodiscard]] presentation::Report study_report(const Selection& selection, const Setting& setting,
                                                const ReportParts& parts);

/// How much of the study is there: "5680 runs of 284 variants, all there." or how many are missing.
[[nodiscard]] std::string extent_sentence(const Selection& selection);

}  // namespace jink::tools::lab::study
