// SPDX-License-Identifier: BSD-3-Clause
// What a flight of docs/safety.md has come to, in a word or two of a small vocabulary.
#pragma once

#include <string_view>

#include "tests/sim/flight/safety_flight.hpp"

namespace jink::sim::flight::safety {

/// Of a flight that has been run: by what the vehicle did, and what the companion says of it.
[[nodiscard]] std::string_view word_of(const Flight& flight, const Happening& what, const Cell& cell);

}  // namespace jink::sim::flight::safety
