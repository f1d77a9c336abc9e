// SPDX-License-Identifier: BSD-3-Clause
// A topic of obstacle tracks, whatever its type: payloads decoded, checked and queued for poll(). Not a public header:
// the readers of the topics are.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/tracking/track_inbox.hpp"

namespace jink::bridge::dds {

/// Safe from any thread. Payloads are taken in on Fast DDS's thread.
class DdsTrackFeed {
 public:
  struct Topic {
    const char* name;
    const char* type;
    /// Nothing where a payload is not of the type.
    std::optional<tracking::DecodedTracks> (*decode)(std::span<const std::uint8_t> payload);
    /// Why a message in this frame is refused; empty: it is taken.
    std::string (*refuse_frame)(const std::string& frame_id);
  };

  /// `node` and `clock` must outlive it. @throws std::runtime_error, one line, when Fast DDS cannot make a reader.
  DdsTrackFeed(DdsParticipant& node, const base::Clock& clock, const Topic& topic);

  bool poll(tracking::TrackMessage& message) { return inbox_.poll(message); }
  void notify(base::Notifier& notifier) { inbox_.notify(notifier); }
  [[nodiscard]] tracking::TrackSourceStatus status() const;
  [[nodiscard]] std::uint64_t overruns() const { return inbox_.overruns(); }
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }

 private:
  void accept(const Payload& payload, std::uint64_t writer);

  const base::Clock& clock_;
  Topic topic_;
  std::atomic<std::uint64_t> malformed_ = 0;
  tracking::TrackInbox inbox_;
  PayloadReader reader_;  // last: its destruction ends the callbacks while all else still stands
};

}  // namespace jink::bridge::dds
