// SPDX-License-Identifier: BSD-3-Clause
// What is around now: the newest of every writer's tracks, predicted to the present, coasting when they go missing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bridge/prediction/imm_filter.hpp"
#include "bridge/prediction/learned_motion.hpp"
#include "bridge/prediction/motion_learner.hpp"
#include "bridge/prediction/position_history.hpp"
#include "bridge/prediction/prediction_error.hpp"
#include "bridge/tracking/clock_offset.hpp"
#include "bridge/tracking/track_source.hpp"
#include "planner/base/types.hpp"

namespace jink::bridge::tracking {

/// What the table left out or corrected since the start; for events and summaries.
struct TrackTableCounts {
  std::uint64_t clock_offsets = 0;    ///< messages whose stamp could not be believed
  std::uint64_t late_messages = 0;    ///< messages left out because they came too late
  std::uint64_t frozen_messages = 0;  ///< messages left out because what moves had not moved since the one before
  std::uint64_t invalid_tracks = 0;   ///< tracks left out: refusal() of track_inbox says why
  std::uint64_t surplus_tracks = 0;   ///< tracks left out because the table was full
};

/// Tracks of several writers, each with its own identities; nothing is fused, so an obstacle that two writers see is
/// avoided twice. Not thread-safe.
class TrackTable {
 public:
  /// `coast_s`: how long a track lives on after the last message that held it; where its writer is missed, and says
  /// nothing that speaks against it, kMissed.
  explicit TrackTable(double coast_s) : coast_s_(coast_s) {}

  /// Takes in one message. The measurement's instant is the reception less the delay that the writer's
  /// ClockOffsetEstimator believes; a message that is too late for it is left out, as if it had not come.
  ///
  /// A message in which every track that should have moved stands where it stood in the one before, to the last bit, is
  /// that message again whatever its stamp says, and is left out. Of a message of positions alone the velocities are
  /// those of prediction::PositionHistory. O(tracks · log(all tracks)).
  void ingest(const TrackMessage& message);

  /// Finds tracks that are the vehicle itself, as a tracker reports them that sees it too: no larger than a few times
  /// `radius`, within that of `position` at nearly its velocity, for kSelfWay of its way. predict() leaves them out for
  /// as long as they stay there. What only stands beside a vehicle that hangs there is never taken for it. To be called
  /// when messages came in.
  void find_self(double now, const Vec3& position, const Vec3& velocity, double radius);

  /// Whether a writer is missed: what the silent ones told is all that is known of what they watched.
  void miss(bool missed) { missed_ = missed; }

  /// All living tracks, predicted to `now`: constant acceleration for at most `trust` seconds, then constant velocity.
  /// Their age counts from the measurement. Order: by writer, then by id; ids are numbered anew where two writers use
  /// the same. `forecasts`, where given, gets what has been learned of their ways, valid at `now` too.
  std::vector<planner::base::Track> predict(double now, double trust,
                                            std::vector<prediction::Forecast>* forecasts = nullptr);

  /// The living tracks about the vehicle (kLearned) that come within `range`, m, of a place: where each will be, from
  /// `now` on, to the best of what is known.
  [[nodiscard]] std::vector<prediction::Prediction> predictions(double now, double trust, const Vec3& place,
                                                                double range) const;
  /// How far off such predictions have been in this flight.
  [[nodiscard]] const prediction::LawsByKind& error_laws() const { return laws_; }

  /// Whether a track that the vehicle could meet within kMeeting at `speed` moves in a way that is not understood yet
  /// (MotionLearner::unexplained). As of the last messages.
  [[nodiscard]] bool has_unexplained(double speed) const;

  /// Reception of the newest message of any writer that sends when it sees nothing; none: none yet.
  [[nodiscard]] std::optional<double> newest_message() const { return newest_message_; }
  [[nodiscard]] const TrackTableCounts& counts() const { return counts_; }
  /// Living tracks that are taken for the vehicle itself.
  [[nodiscard]] int own_tracks() const { return own_tracks_; }

  /// Reception of the newest message of the mission's writer `named` that was taken in; none: none yet.
  [[nodiscard]] std::optional<double> newest_of(std::size_t named) const;
  /// Writers that watched for kEstablished s and more, fell silent since `since`, and in whose place none has come:
  /// none that speaks, or did for so long, whose first word was after their last.
  [[nodiscard]] int lost_writers(double now, double timeout_s, double since) const;

  static constexpr double kEstablished = 1.0;
  static constexpr std::size_t kMost = 20000;       ///< living tracks
  static constexpr std::size_t kMostLearned = 400;  ///< tracks whose ways are learned at a time
  static constexpr double kLearned = 40.0;          ///< m, from the vehicle's place, of these
  static constexpr int kFits = 8;                   ///< for a message, at most
  static constexpr double kMeeting = 2.0;           ///< s
  static constexpr double kSelfWay = 1.0;           ///< m
  static constexpr double kMissed = 10.0;           ///< s: until a flight has been ended for it
  static constexpr double kForgetWriter = 60.0;     ///< s of silence, after which a writer is taken for ended

 private:
  struct Entry {
    base::Stamped<planner::base::Track, base::Frame::kLocal>
        track;                                      // as estimated; stamped when measured, received in the last message
    std::unique_ptr<prediction::ImmFilter> filter;  // of a track that is measured with noise
    prediction::PositionHistory history;            // of a track without a velocity
    std::unique_ptr<prediction::MotionLearner> learned;  // of a track that is near enough
    std::unique_ptr<prediction::PredictionError> error;  // likewise
    std::optional<Vec3> near_from;  // where the vehicle was when the track came near; none: it is elsewhere
    bool is_self = false;
  };
  struct Seen {
    std::uint64_t id = 0;
    Vec3 position;
  };
  struct Writer {
    ClockOffsetEstimator clock;
    std::vector<Seen> last;  // what the newest message that was taken in held
    double received = 0.0;
    std::optional<double> first;     // reception of the first message that was taken in
    std::optional<double> believed;  // likewise of the newest
    std::size_t named = 0;
    bool sends_when_empty = true;
  };
  std::optional<double> stamp_of(const TrackMessage& message);
  [[nodiscard]] bool is_repetition(const TrackMessage& message) const;
  void remember(const TrackMessage& message);
  [[nodiscard]] TrackMessage with_velocities(TrackMessage message, double measured) const;
  void ingest(const TrackMessage& message, double measured);
  static void take(Entry& entry, const base::Stamped<planner::base::Track, base::Frame::kLocal>& measured);
  void learn(const TrackMessage& message, double t);
  [[nodiscard]] prediction::Prediction predict(const Entry& entry, double now, double trust) const;
  void forget(double now);
  [[nodiscard]] bool outlived(const Writer& writer, double received, double now) const;

  using Key = std::pair<std::uint64_t, std::uint64_t>;  // writer, id

  double coast_s_;
  bool missed_ = false;
  std::optional<double> newest_message_;
  TrackTableCounts counts_;
  int own_tracks_ = 0;
  std::map<std::uint64_t, Writer> writers_;
  std::map<Key, Entry> entries_;
  std::optional<Vec3> vehicle_;  // where it was last
  prediction::Experience experience_;
  prediction::LawsByKind laws_;
  std::size_t learned_ = 0;  // tracks
};

}  // namespace jink::bridge::tracking
