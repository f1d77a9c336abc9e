// SPDX-License-Identifier: BSD-3-Clause
// The team's intents out of DDS payloads. No DDS here: a pure function of bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "bridge/team/intents.hpp"

namespace jink::bridge::cdr {

/// An intent as its payload says it.
struct DecodedIntent {
  double stamp_unix_s = 0.0;
  team::Intent intent;  ///< to be used only where `why` is empty
  std::string why;  ///< why it is to be refused, in one line; empty: it is within IntentLimits and in the frame `map`
};

/// Decodes a payload (encapsulation and CDR); nothing where it is no jink_msgs/Intent. A path that is longer than its
/// payload, or than IntentLimits::kPoints, is refused before anything is allocated for it. Pure.
[[nodiscard]] std::optional<DecodedIntent> decode_intent(std::span<const std::uint8_t> payload);

}  // namespace jink::bridge::cdr
