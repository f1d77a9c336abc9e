// SPDX-License-Identifier: BSD-3-Clause
// What is around now: the newest of every writer's tracks, predicted to the present, coasting when they go missing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "bridge/track_source.hpp"
#include "planner/types.hpp"

namespace jink::bridge {

/// Tracks of several writers, each with its own identities; nothing is fused, so an obstacle that two writers see is
/// avoided twice. Not thread-safe.
class TrackTable {
 public:
  /// `coast_s`: how long a track lives on after the last message that held it.
  explicit TrackTable(double coast_s) : coast_s_(coast_s) {}

  /// Takes in one message. The measurement's instant is the reception less the delay read from the stamp. A stamp that
  /// lies in the future or more than kLongestDelay back tells of a clock that is off: then the writer's smallest stamp
  /// age so far stands for the offset and what exceeds it for the delay. A message whose delay exceeds kLongestDelay is
  /// left out, as if it had not come; where that lasts for kLongestDelay with stamps that advance, a clock was set and
  /// its offset is learned anew. A writer whose stamps never advance does not stamp: its delay is taken for 0.
  void ingest(const TrackMessage& message);

  /// All living tracks, predicted to `now`: constant acceleration for at most `trust` seconds, then constant velocity.
  /// Their age counts from the measurement. Order: by writer, then by id; ids are numbered anew where two writers use
  /// the same.
  std::vector<planner::Track> predict(double now, double trust);

  /// Reception of the newest message of any writer; negative: none yet.
  [[nodiscard]] double newest_message() const { return newest_message_; }
  /// Messages whose stamp could not be believed.
  [[nodiscard]] std::uint64_t clock_offsets() const { return clock_offsets_; }

  /// Messages left out because they came too late.
  [[nodiscard]] std::uint64_t late_messages() const { return late_messages_; }

  static constexpr double kLongestDelay = 1.0;  ///< s, from measurement to reception

 private:
  struct Entry {
    planner::Track track;   // as measured
    double measured = 0.0;  // companion's clock
    double seen = 0.0;      // reception of the last message that held it
  };
  struct Writer {
    double smallest_age = 0.0;  // of its stamps
    double stamp = 0.0;         // the newest message's, to within a constant
    double received = 0.0;
    double late_since = -1.0;
    bool advances = false;
  };
  std::optional<double> delay_of(const TrackMessage& message);

  using Key = std::pair<std::uint64_t, std::uint64_t>;  // writer, id

  double coast_s_;
  double newest_message_ = -1.0;
  std::uint64_t clock_offsets_ = 0;
  std::uint64_t late_messages_ = 0;
  std::map<std::uint64_t, Writer> writers_;
  std::map<Key, Entry> entries_;
};

}  // namespace jink::bridge
