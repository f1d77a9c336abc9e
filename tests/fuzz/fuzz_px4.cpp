// SPDX-License-Identifier: BSD-3-Clause
// DDS payloads as PX4's VehicleLocalPosition, one after another into the filter: what the vehicle's state says then is
// finite, whatever came in. The input is a sequence of messages: time since the last one (10 ms), length, payload.
#include <cmath>

#include "bridge/cdr/px4_messages.hpp"
#include "tests/fuzz/fuzz.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  jink::fuzz::Input input(data, size);
  jink::bridge::cdr::px4::LocalPositionFilter filter;
  double now = 10.0;
  while (!input.empty()) {
    now += 0.01 * input.byte();
    const auto message = jink::bridge::cdr::px4::decode_local_position(input.bytes(input.byte()));
    if (!message) continue;
    (void)filter.update(*message, now - 0.01, now);
    jink::bridge::vehicle::VehicleState state;
    filter.apply(state, now);
    const bool finite = state.motion.value.position.allFinite() && state.motion.value.velocity.allFinite() &&
                        std::isfinite(state.yaw) && state.estimate_shift.allFinite();
    jink::fuzz::require(finite, "a state that is not finite");
    jink::fuzz::require(!state.local_position_ok || state.motion.stamp >= 0.0, "a position that never came");
    jink::fuzz::require(!state.origin || std::abs(state.origin->latitude_deg) <= 90.0, "an absurd origin");
  }
  return 0;
}
