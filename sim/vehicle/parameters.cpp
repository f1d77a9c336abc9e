// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle/parameters.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace jink::sim::vehicle {

Parameters::Parameters(const planner::base::VehicleLimits& limits, int system_id, Px4Version version) {
  const auto real = [](double value) { return ParameterValue(static_cast<float>(value)); };
  const auto integer = [](int value) { return ParameterValue(std::int32_t{value}); };
  table_ = {
      {"BAT_CRIT_THR", real(0.07)},
      {"BAT_EMERGEN_THR", real(0.05)},
      {"BAT_LOW_THR", real(0.15)},
      {"CAL_ACC0_ID", integer(1310988)},  // non-zero: calibrated
      {"CAL_GYRO0_ID", integer(1310988)},
      {"CAL_MAG0_ID", integer(197388)},
      {"COM_DISARM_LAND", real(2.0)},
      {"COM_DISARM_PRFLT", real(10.0)},
      {"COM_FAIL_ACT_T", real(5.0)},
      {"COM_LOW_BAT_ACT", integer(0)},
      {"COM_OBL_RC_ACT", integer(0)},
      {"COM_OF_LOSS_T", real(1.0)},
      {"COM_RCL_EXCEPT", integer(0)},
      {"COM_RC_IN_MODE", integer(1)},
      {"COM_SPOOLUP_TIME", real(1.0)},
      {"EKF2_NOAID_TOUT", integer(5000000)},  // us
      {"MAV_COMP_ID", integer(1)},
      {"MAV_SYS_ID", integer(system_id)},
      {"MAV_TYPE", integer(2)},
      {"MIS_TAKEOFF_ALT", real(2.5)},
      {"MIS_YAW_ERR", real(12.0)},  // deg
      {"MPC_LAND_CRWL", real(0.35)},
      {"MPC_LAND_SPEED", real(0.7)},
      {"MPC_XY_CRUISE", real(std::min(5.0, limits.max_speed))},
      {"MPC_XY_VEL_MAX", real(limits.max_speed)},
      {"MPC_Z_VEL_MAX_DN", real(limits.max_climb)},
      {"MPC_Z_VEL_MAX_UP", real(limits.max_climb)},
      {"NAV_ACC_RAD", real(2.0)},
      {"NAV_DLL_ACT", integer(0)},
      {"NAV_MC_ALT_RAD", real(0.8)},
      {"NAV_RCL_ACT", integer(2)},
      {"RTL_DESCEND_ALT", real(30.0)},
      {"RTL_RETURN_ALT", real(30.0)},
      {"SYS_AUTOSTART", integer(10040)},
      {"SYS_HITL", integer(0)},
  };
  if (version >= Px4Version::k1_18) {
    table_.push_back({"MAN_OVERRIDE_SPD", real(1.0)});
  } else {
    table_.push_back({"COM_OBC_LOSS_T", real(5.0)});
    table_.push_back({"COM_RC_OVERRIDE", integer(1)});
    table_.push_back({"COM_RC_STICK_OV", real(30.0)});
  }
  std::sort(table_.begin(), table_.end(), [](const Parameter& a, const Parameter& b) { return a.name < b.name; });
}

std::optional<std::size_t> Parameters::find(std::string_view name) const {
  const auto found = std::find_if(table_.begin(), table_.end(), [&](const Parameter& p) { return p.name == name; });
  if (found == table_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - table_.begin());
}

bool Parameters::set(std::string_view name, ParameterValue value) {
  const auto index = find(name);
  if (!index || table_[*index].value.index() != value.index()) return false;
  if (const float* real = std::get_if<float>(&value); real != nullptr && !std::isfinite(*real)) return false;
  table_[*index].value = value;
  return true;
}

std::int32_t Parameters::integer(std::string_view name) const {
  const auto index = find(name);
  const auto* value = index ? std::get_if<std::int32_t>(&table_[*index].value) : nullptr;
  if (value == nullptr) throw std::out_of_range("no integer parameter " + std::string(name));
  return *value;
}

double Parameters::real(std::string_view name) const {
  const auto index = find(name);
  const auto* value = index ? std::get_if<float>(&table_[*index].value) : nullptr;
  if (value == nullptr) throw std::out_of_range("no float parameter " + std::string(name));
  return static_cast<double>(*value);
}

float encode_bytewise(const ParameterValue& value) {
  if (const auto* integer = std::get_if<std::int32_t>(&value)) return std::bit_cast<float>(*integer);
  return std::get<float>(value);
}

std::int32_t decode_bytewise(float field) {
  return std::bit_cast<std::int32_t>(field);
}

}  // namespace jink::sim::vehicle
