// SPDX-License-Identifier: BSD-3-Clause
// Declares the function that makes each comparator, from the list in comparators.inc.
#pragma once

#include <memory>

#include "planner/base/settings.hpp"
#include "planner/optimizer/optimizer.hpp"

namespace jink::tools::lab::algorithms {

#define JINK_COMPARATOR(name, label, source, make)                                                                     \
  std::unique_ptr<planner::optimizer::Optimizer> make(const planner::base::OptimizerSettings& settings, int dimension, \
                                                      int objectives);
#include "tools/lab/algorithms/comparators.inc"
#undef JINK_COMPARATOR

}  // namespace jink::tools::lab::algorithms
