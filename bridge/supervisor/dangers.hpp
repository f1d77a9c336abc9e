// SPDX-License-Identifier: BSD-3-Clause
// What the autopilot's parameters and the mission's endings together make dangerous. Pure logic.
#pragma once

#include <string>

#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"

namespace jink::bridge::supervisor {

/// Why this mission is not to be flown with this autopilot; empty: nothing is known against it, or its author takes it
/// (Endings). `mission` in the local frame, see in_local_frame. Facts: PX4's parameter reference, 1.17.
[[nodiscard]] std::string danger(const config::Mission& mission, const vehicle::FailsafeParameters& parameters);

/// The parameters that such a mission needs to be judged by are told.
[[nodiscard]] bool told(const config::Mission& mission, const vehicle::FailsafeParameters& parameters);

}  // namespace jink::bridge::supervisor
