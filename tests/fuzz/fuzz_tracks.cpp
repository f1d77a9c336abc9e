// SPDX-License-Identifier: BSD-3-Clause
// DDS payloads as the track readers decode them, into the track table: what comes out of that is finite and bounded,
// whatever goes in. The input is a sequence of messages: writer (0 to 3; 4 to 7: of Autoware's TrackedObjects; 8 to 11:
// of detections), time since the last one (10 ms), age of its stamp (100 ms), length (two bytes), payload.
#include <cmath>

#include "bridge/cdr/track_messages.hpp"
#include "bridge/tracking/track_table.hpp"
#include "planner/geometry/validity.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

void check(const std::vector<jink::planner::base::Track>& tracks) {
  for (const jink::planner::base::Track& track : tracks) {
    const bool finite = track.position.allFinite() && track.velocity.allFinite() && track.acceleration.allFinite() &&
                        std::isfinite(track.position_sigma) && std::isfinite(track.velocity_sigma) &&
                        std::isfinite(track.age);
    jink::fuzz::require(finite, "a track that is not finite");
    jink::fuzz::require(track.radius > 0.0 && track.radius <= jink::bridge::tracking::TrackLimits::kRadius,
                        "an absurd radius");
    jink::fuzz::require(jink::planner::geometry::is_valid(track.body, track.radius), "an absurd body");
    jink::fuzz::require(track.age >= 0.0, "a track from the future");
  }
}

std::optional<jink::bridge::tracking::TrackMessage> decode(std::span<const std::uint8_t> payload,
                                                           std::uint64_t writer) {
  using namespace jink::bridge::cdr;
  auto message = writer < 4   ? decode_obstacle_tracks(payload)
                 : writer < 8 ? decode_tracked_objects(payload)
                              : decode_detections(payload);
  return message ? std::optional(std::move(message->tracks)) : std::nullopt;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  jink::fuzz::Input input(data, size);
  jink::bridge::tracking::TrackTable table(1.0);
  double now = 10.0;
  while (!input.empty()) {
    const std::uint64_t writer = input.byte() % 12U;
    now += 0.01 * input.byte();
    const double stamp_age = 0.1 * static_cast<std::int8_t>(input.byte());
    const std::size_t low = input.byte();
    const auto payload = input.bytes(low + 256U * input.byte());
    auto message = decode(payload, writer);
    if (!message) continue;
    jink::fuzz::require(message->tracks.size() <= jink::bridge::tracking::TrackLimits::kTracksPerMessage,
                        "more tracks than a message may have");
    message->writer = writer;
    message->received = now;
    message->stamp_age = stamp_age;
    table.ingest(*message);
    check(table.predict(now, 0.7));
  }
  check(table.predict(now + 0.5, 0.7));
  return 0;
}
