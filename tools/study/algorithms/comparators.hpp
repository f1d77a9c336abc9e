// SPDX-License-Identifier: BSD-3-Clause
// Declares the function that makes each comparator, from the list in comparators.inc.
#pragma once

#include <memory>

#include "planner/optimizer.hpp"
#include "planner/settings.hpp"

namespace jink::study {

#define JINK_COMPARATOR(name, label, source, make) \
  std::unique_ptr<planner::Optimizer> make(const planner::OptimizerSettings& settings, int dimension, int objectives);
#include "tools/study/algorithms/comparators.inc"
#undef JINK_COMPARATOR

}  // namespace jink::study
