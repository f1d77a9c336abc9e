// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/algorithms/registry.hpp"

#include <algorithm>
#include <array>

#include "tools/lab/algorithms/bounded_front.hpp"
#include "tools/lab/algorithms/comparators.hpp"

namespace jink::tools::lab::algorithms {
namespace {

using planner::base::OptimizerSettings;
using Made = std::unique_ptr<planner::optimizer::Optimizer>;

/// [Paper] Algorithm 1.
Made make_momvo(const OptimizerSettings& settings, int dimension, int objectives) {
  OptimizerSettings alone = settings;
  alone.slaves = 1;
  alone.sharing = 0;
  return std::make_unique<BoundedPmomvo>(alone, dimension, objectives);
}

/// [Paper] Algorithm 2.
template <int kSlaves>
Made make_pmomvo(const OptimizerSettings& settings, int dimension, int objectives) {
  OptimizerSettings split = settings;
  split.slaves = kSlaves;
  return std::make_unique<BoundedPmomvo>(split, dimension, objectives);
}

constexpr std::string_view kPaper1 = "[Paper] Algorithm 1, jink's planner";
constexpr std::string_view kPaper2 = "[Paper] Algorithm 2, jink's planner";

constexpr std::array kAlgorithms{
    Algorithm{"momvo", "MOMVO", kPaper1, make_momvo},
    Algorithm{"pmomvo-2", "PMOMVO-2", kPaper2, make_pmomvo<2>, 2},
    Algorithm{"pmomvo-4", "PMOMVO-4", kPaper2, make_pmomvo<4>, 4},
    Algorithm{"pmomvo-6", "PMOMVO-6", kPaper2, make_pmomvo<6>, 6},
    Algorithm{"pmomvo-8", "PMOMVO-8", kPaper2, make_pmomvo<8>, 8},
    Algorithm{"pmomvo-10", "PMOMVO-10", kPaper2, make_pmomvo<10>, 10},
    Algorithm{"pmomvo-12", "PMOMVO-12", kPaper2, make_pmomvo<12>, 12},
#define JINK_COMPARATOR(name, label, source, make) Algorithm{name, label, source, make},
#include "tools/lab/algorithms/comparators.inc"
#undef JINK_COMPARATOR
};

}  // namespace

std::span<const Algorithm> algorithms() {
  return kAlgorithms;
}

const Algorithm* find_algorithm(std::string_view name) {
  const auto* const found =
      std::find_if(kAlgorithms.begin(), kAlgorithms.end(), [&](const Algorithm& a) { return a.name == name; });
  return found == kAlgorithms.end() ? nullptr : found;
}

}  // namespace jink::tools::lab::algorithms
