// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/track_feed.hpp"

#include <utility>

namespace jink::bridge::dds {

DdsTrackFeed::DdsTrackFeed(DdsParticipant& node, const base::Clock& clock, const Topic& topic)
    : clock_(clock),
      topic_(topic),
      reader_(node, topic.name, topic.type,
              [this](const Payload& payload, std::uint64_t writer) { accept(payload, writer); }) {}

tracking::TrackSourceStatus DdsTrackFeed::status() const {
  tracking::TrackSourceStatus status = inbox_.status();
  status.writers = reader_.writers();
  status.malformed = malformed_;
  if (status.last_refusal.empty()) status.last_refusal = reader_.mismatch();
  return status;
}

// The payload as a message into the inbox, or refused.
void DdsTrackFeed::accept(const Payload& payload, std::uint64_t writer) {
  const double received = clock_.now();
  std::optional<tracking::DecodedTracks> message = topic_.decode(payload);
  if (!message) {
    ++malformed_;
  } else if (const std::string why = topic_.refuse_frame(message->frame_id); !why.empty()) {
    inbox_.refuse_frame(why);
  } else {
    message->tracks.writer = writer;
    message->tracks.received = received;
    message->tracks.stamp_age = system_time() - message->stamp_unix_s;
    inbox_.put(std::move(message->tracks), message->why);
  }
}

}  // namespace jink::bridge::dds
