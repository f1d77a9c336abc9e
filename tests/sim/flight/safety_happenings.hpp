// SPDX-License-Identifier: BSD-3-Clause
// What befalls the flights of docs/safety.md: the rows of its tables.
#pragma once

#include <string_view>
#include <vector>

#include "tests/sim/flight/safety_flight.hpp"

namespace jink::sim::flight::safety {

struct Group {
  std::string_view name;  ///< heading of its tables
  std::vector<Happening> happenings;
};
[[nodiscard]] const std::vector<Group>& groups();

}  // namespace jink::sim::flight::safety
