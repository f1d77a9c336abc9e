// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's parameter table: names, types and defaults as PX4's. It knows nothing of messages.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "planner/base/types.hpp"
#include "sim/vehicle/px4_version.hpp"

namespace jink::sim::vehicle {

/// PX4 has these two types alone.
using ParameterValue = std::variant<std::int32_t, float>;

struct Parameter {
  std::string name;  ///< at most 16 characters
  ParameterValue value;
};

/// Sorted by name, of fixed size: an index stays valid. Not thread-safe.
class Parameters {
 public:
  /// PX4's defaults; the speed limits are the vehicle's.
  explicit Parameters(const planner::base::VehicleLimits& limits, int system_id = 1,
                      Px4Version version = Px4Version::k1_17);

  [[nodiscard]] std::size_t size() const { return table_.size(); }
  [[nodiscard]] const Parameter& at(std::size_t index) const { return table_.at(index); }
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;

  /// Changes a parameter. False, and nothing changes, when the name is unknown, the type differs or a float is not
  /// finite.
  [[nodiscard]] bool set(std::string_view name, ParameterValue value);

  /// The value of a parameter that the table holds; throws std::out_of_range for a name or type that it does not.
  [[nodiscard]] std::int32_t integer(std::string_view name) const;
  [[nodiscard]] double real(std::string_view name) const;

 private:
  std::vector<Parameter> table_;
};

/// PARAM_VALUE carries every type in a float: PX4 puts the bytes of an integer there as they are.
[[nodiscard]] float encode_bytewise(const ParameterValue& value);
[[nodiscard]] std::int32_t decode_bytewise(float field);

}  // namespace jink::sim::vehicle
