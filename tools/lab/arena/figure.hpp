// SPDX-License-Identifier: BSD-3-Clause
// One drawing of a tier's rows as SVG: panels side by side, with a line for each family and pilot.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/arena/tables.hpp"

namespace jink::tools::lab::arena {

/// Reached and collisions as bars with their intervals; clearance from its least through the 5 % quantile and the
/// median to the 95 % quantile; time against the straight line likewise; plan time p50, p99 and largest on a
/// logarithmic axis. Pilots have the colour of their place in `pilots`. Self-contained; empty without rows.
[[nodiscard]] std::string figure(const std::vector<const Row*>& rows, const std::vector<std::string>& pilots);

/// The colour of a pilot, "#rrggbb".
[[nodiscard]] std::string pilot_colour(const std::vector<std::string>& pilots, const std::string& pilot);

/// Text for HTML and SVG, in elements and in quoted attributes.
[[nodiscard]] std::string escaped(const std::string& text);

}  // namespace jink::tools::lab::arena
