// SPDX-License-Identifier: BSD-3-Clause
// PX4's parameters that decide what a loss does to the vehicle: what they mean and what to set. Facts: PX4's parameter
// reference and measurements with PX4 1.17.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "bridge/doctor/check.hpp"
#include "bridge/vehicle/px4.hpp"
#include "config/mission.hpp"

namespace jink::bridge::doctor {

/// The names that inspect_parameters() wants to know.
[[nodiscard]] std::span<const std::string> doctor_parameters();

/// One check for each parameter that matters, beside what the mission wants in the same case; `rc_receiver`: a manual
/// control is there now.
[[nodiscard]] std::vector<Check> inspect_parameters(const std::map<std::string, vehicle::px4::Parameter>& parameters,
                                                    const config::Endings& endings, bool rc_receiver);

}  // namespace jink::bridge::doctor
