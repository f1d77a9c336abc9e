// SPDX-License-Identifier: BSD-3-Clause
// DDS payloads as the team's intents: refused with one printable line, or an intent within its limits, which fits into
// the memory that its payload justifies. The input is a sequence of messages: length (two bytes), payload.
#include "bridge/cdr/intent_messages.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using jink::bridge::team::IntentLimits;
using jink::fuzz::require;

void check(const jink::bridge::team::Intent& intent) {
  require(jink::bridge::team::refusal(intent) == nullptr, "an absurd intent was taken");
  double before = -IntentLimits::kTime - 1.0;
  for (const jink::planner::base::TimedPoint& point : intent.path) {
    require(point.position.allFinite(), "a position is not finite");
    require(point.t > before, "the times do not rise");
    before = point.t;
  }
  require(intent.radius > 0.0 && intent.margin >= 0.0, "a size below 0");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  jink::fuzz::Input input(data, size);
  while (!input.empty()) {
    const std::size_t low = input.byte();
    const auto payload = input.bytes(low + 256U * input.byte());
    const auto message = jink::bridge::cdr::decode_intent(payload);
    if (!message) continue;
    require(message->intent.path.capacity() <= payload.size(), "more memory than the payload justifies");
    require(std::all_of(message->why.begin(), message->why.end(), [](char c) { return c >= ' ' && c <= '~'; }),
            "a refusal that is not printable");
    if (message->why.empty()) check(message->intent);
  }
  return 0;
}
