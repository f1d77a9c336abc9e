// SPDX-License-Identifier: BSD-3-Clause
// What every source of tracks has behind its door: the check of each track, and the queue between the thread that
// receives and the loop that polls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>

#include "bridge/tracking/track_source.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::tracking {

/// Limits beyond which a track is absurd and left out, and how much is taken at once. Norms for vectors.
struct TrackLimits {
  static constexpr double kPosition = 1e5;
  static constexpr double kVelocity = 1e3;
  static constexpr double kAcceleration = 1e3;
  static constexpr double kRadius = 1e3;  ///< and above 0
  static constexpr double kSigma = 1e3;   ///< position and velocity; not negative
  static constexpr std::size_t kTracksPerMessage = 20000;
  static constexpr std::size_t kQueuedMessages = 64;
};

/// Null when the track is usable, else what is wrong with it, by the name of its field. The one check of tracks, for
/// every source and before the planner.
[[nodiscard]] const char* refusal(const planner::base::Track& track);

/// Whether all tracks of a message, and there are some, are farther beside the fence than it is wide or beyond
/// TrackLimits::kPosition: they are given in another frame, or concern nobody here. Never of a message that is
/// `placed`; heights do not count.
[[nodiscard]] bool elsewhere(const TrackMessage& message, const planner::base::Box& fence);

/// Takes the tracks of one message in, one by one; what is non-finite, absurd or beyond kTracksPerMessage stays out and
/// is counted in message.dropped. Pure.
class TrackValidator {
 public:
  /// `stated`: how many tracks the message has. `message` must outlive the validator.
  TrackValidator(TrackMessage& message, std::size_t stated);

  /// `bad`: what is wrong with it already, in words; null: nothing yet.
  void add(const planner::base::Track& track, const char* bad = nullptr);
  /// Why the last of those left out was; empty when none was.
  [[nodiscard]] std::string why() const;

 private:
  TrackMessage& message_;
  std::size_t stated_;
  std::size_t added_ = 0;
  std::string bad_what_;
  std::uint64_t bad_id_ = 0;
};

/// One message of tracks as its payload says it; its frame is the caller's to check.
struct DecodedTracks {
  std::string frame_id;
  double stamp_unix_s = 0.0;
  TrackMessage tracks;  ///< writer, received and stamp_age are the caller's
  std::string why;      ///< TrackValidator::why()
};

/// Messages on their way to poll(), and what was refused. When nobody polls, the oldest go. Safe from any thread.
class TrackInbox {
 public:
  /// `why`: what TrackValidator::why() said.
  void put(TrackMessage message, const std::string& why);
  /// A message refused whole.
  void refuse(const std::string& why);

  bool poll(TrackMessage& message);
  /// Notified from now on by each message; outlives the inbox.
  void notify(base::Notifier& notifier);
  /// `writers` is left at 0: the transport knows.
  [[nodiscard]] TrackSourceStatus status() const;
  /// Messages thrown away unread because nobody polled.
  [[nodiscard]] std::uint64_t overruns() const;

 private:
  mutable std::mutex mutex_;  // guards all below
  std::deque<TrackMessage> queue_;
  TrackSourceStatus status_;
  std::uint64_t overruns_ = 0;
  base::Notifier* notifier_ = nullptr;
};

}  // namespace jink::bridge::tracking
