// SPDX-License-Identifier: BSD-3-Clause
// One figure of a tier's rows: a bar or a box for each pilot in each family.
#pragma once

#include <string>
#include <vector>

#include "tools/figures/figure.hpp"
#include "tools/lab/arena/tables.hpp"

namespace jink::tools::lab::arena {

/// Reached and collisions as bars with their intervals; clearance as boxes from the 5 % to the 95 % quantile with the
/// least below and a line at the median; time against the straight line likewise; plan time from p50 to p99 and up to
/// the largest on a logarithmic axis. What no row has is left out. Pilots look as their place in `pilots` says.
[[nodiscard]] jink::tools::figures::Figure figure(const std::vector<const Row*>& rows,
                                                  const std::vector<std::string>& pilots);

}  // namespace jink::tools::lab::arena
