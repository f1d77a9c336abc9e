// SPDX-License-Identifier: BSD-3-Clause
// The study's records by what they are, for tables and figures.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/lab/statistics/ranks.hpp"
#include "tools/lab/statistics/samples.hpp"
#include "tools/lab/study/results.hpp"

namespace jink::tools::lab::study {

using jink::tools::lab::statistics::Comparison;
using jink::tools::lab::statistics::fisher_lsd;
using jink::tools::lab::statistics::Friedman;
using jink::tools::lab::statistics::friedman;
using jink::tools::lab::statistics::friedman_ranks;
using jink::tools::lab::statistics::Lsd;
using jink::tools::lab::statistics::mean;
using jink::tools::lab::statistics::Proportion;
using jink::tools::lab::statistics::rank_sums;
using jink::tools::lab::statistics::Scores;
using jink::tools::lab::statistics::Summary;
using jink::tools::lab::statistics::summary;
using jink::tools::lab::statistics::wilson;

/// The records of one variant in the order of runs; some may be missing.
using Records = std::vector<const Record*>;

/// Borrows the results.
class Selection {
 public:
  /// Throws std::runtime_error as sizes_of() does.
  explicit Selection(const Results& results);

  [[nodiscard]] const Results& results() const { return results_; }
  [[nodiscard]] const StudySettings& settings() const { return results_.settings; }
  [[nodiscard]] const PaperSizes& sizes() const { return sizes_; }

  /// With the paper's sizes and sharing rate.
  [[nodiscard]] Records paths(std::string_view algorithm, std::string_view world) const;
  [[nodiscard]] Records paths(std::string_view algorithm, std::string_view world, int sharing) const;
  [[nodiscard]] Records paths(std::string_view algorithm, std::string_view world, int population, int iterations) const;
  [[nodiscard]] Records fronts(std::string_view algorithm, std::string_view world, int sharing) const;
  [[nodiscard]] Records anytime(std::string_view algorithm, std::string_view world) const;

 private:
  [[nodiscard]] Records find(RunKind kind, std::string_view algorithm, std::string_view world, int sharing,
                             int population, int iterations) const;

  const Results& results_;
  PaperSizes sizes_;
  std::map<Variant, Records> records_;
};

/// A name of `values`, or of `measured`, of each record.
[[nodiscard]] std::vector<double> values(const Records& records, const std::string& name);
[[nodiscard]] std::vector<double> measured(const Records& records, const std::string& name);
/// Times a factor: seconds in ms.
[[nodiscard]] std::vector<double> scaled(std::vector<double> list, double factor);
/// The paths that are free and end at the target.
[[nodiscard]] Records reached(const Records& records);

/// Which of two records of the same run are compared: value of a minus value of b, for the runs that both have and for
/// which `counts` holds for both.
[[nodiscard]] std::vector<double> paired_differences(const Records& a, const Records& b,
                                                     const std::function<double(const Record&)>& value,
                                                     const std::function<bool(const Record&)>& counts);

/// The label of an algorithm, "PMOMVO-6".
[[nodiscard]] std::string label_of(std::string_view algorithm);
/// Its place in the order of all, which is its style in all figures.
[[nodiscard]] int place_of(std::string_view algorithm);
/// "1" of "table2-1".
[[nodiscard]] std::string world_number(std::string_view world);

}  // namespace jink::tools::lab::study
