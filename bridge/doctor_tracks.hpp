// SPDX-License-Identifier: BSD-3-Clause
// The doctor on obstacle tracks.
#pragma once

#include <stop_token>
#include <vector>

#include "bridge/check.hpp"
#include "config/mission.hpp"

namespace jink::bridge {

/// Listens for `seconds` (until `stop`) for writers of obstacle tracks on the mission's DDS domain: who is there, how
/// often messages come, how old they are, what is refused. kMissing where no writer is there and the mission requires
/// one. Nothing where the mission takes no such tracks.
[[nodiscard]] std::vector<Check> inspect_tracks(const config::Mission& mission, double seconds,
                                                const std::stop_token& stop);

}  // namespace jink::bridge
