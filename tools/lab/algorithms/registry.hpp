// SPDX-License-Identifier: BSD-3-Clause
// The optimizers of the study by name: PMOMVO in the sizes of [Paper] section 5, and those that it is compared with.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "planner/base/settings.hpp"
#include "planner/optimizer/optimizer.hpp"

namespace jink::tools::lab::algorithms {

/// One entry of the registry. Every algorithm spends exactly population x iterations evaluations, the iterations being
/// those of the run's budget, and gives a non-dominated set of at most `archive` of the solutions that it evaluated,
/// so that what is compared is the search. Population, iterations and archive of the settings count for all, `sharing`
/// and what is left for MOMVO and PMOMVO alone; `slaves` is the algorithm's own. make() throws std::invalid_argument
/// for settings that cannot work.
struct Algorithm {
  std::string_view name;    ///< as on the command line: "pmomvo-6"
  std::string_view label;   ///< as in tables: "PMOMVO-6"
  std::string_view source;  ///< the paper or library that it is after, for the report
  std::unique_ptr<planner::optimizer::Optimizer> (*make)(const planner::base::OptimizerSettings& settings,
                                                         int dimension, int objectives);
  int slaves = 1;  ///< m of PMOMVO-m
};

/// All of them, in the order of tables.
[[nodiscard]] std::span<const Algorithm> algorithms();

/// nullptr: no algorithm has this name.
[[nodiscard]] const Algorithm* find_algorithm(std::string_view name);

/// The version of pagmo2 that some of them are from.
[[nodiscard]] std::string_view pagmo_version();

}  // namespace jink::tools::lab::algorithms
