// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/cdr/intent_messages.hpp"

#include <cmath>
#include <utility>

#include "bridge/cdr/input.hpp"

namespace jink::bridge::cdr {

namespace {

constexpr std::size_t kWirePoint_bytes = 4 * 8;

// In the order of the IDL. False where the path is longer than is looked at.
bool take_intent(CdrInput& input, team::Intent& intent) {
  intent.vehicle = input.take<std::uint64_t>();
  frames::Geodetic origin;
  origin.latitude_deg = input.take<double>();
  origin.longitude_deg = input.take<double>();
  origin.altitude_m = input.take<double>();
  const bool unknown =
      std::isnan(origin.latitude_deg) && std::isnan(origin.longitude_deg) && std::isnan(origin.altitude_m);
  if (!unknown) intent.origin = origin;
  intent.radius = input.take<double>();
  intent.margin = input.take<double>();
  const std::uint32_t count = input.take_length(kWirePoint_bytes);
  if (count > team::IntentLimits::kPoints) return false;
  intent.path.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    planner::base::TimedPoint point;
    point.t = input.take<double>();
    point.position = take_vec3(input);
    intent.path.push_back(point);
  }
  return true;
}

}  // namespace

std::optional<DecodedIntent> decode_intent(std::span<const std::uint8_t> payload) {
  DecodedIntent message;
  StampedFrame header;
  bool short_enough = true;
  const bool whole = decode(payload, [&](CdrInput& input) {
    header = take_header(input);
    short_enough = take_intent(input, message.intent);
    return true;
  });
  if (!whole) return std::nullopt;
  message.stamp_unix_s = header.stamp_unix_s;
  if (header.frame_id != "map") {
    message.why = "frame_id '" + printable(header.frame_id) + "' is not 'map'";
  } else if (!short_enough) {
    message.why = "a path of more than " + std::to_string(team::IntentLimits::kPoints) + " points";
  } else if (const char* bad = team::refusal(message.intent); bad != nullptr) {
    message.why = "vehicle " + std::to_string(team::system_of(message.intent.vehicle)) + ": " + bad;
  }
  return message;
}

}  // namespace jink::bridge::cdr
