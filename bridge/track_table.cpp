// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/track_table.hpp"

#include <algorithm>
#include <set>

#include "planner/obstacle_motion.hpp"

namespace jink::bridge {
namespace {

constexpr double kStampRate =
    0.1;  // s of stamp for each second of reception, below which a writer's stamps stand still

}  // namespace

// How old the message's measurement was at reception; nothing where it is too old to say anything of the present.
std::optional<double> TrackTable::delay_of(const TrackMessage& message) {
  const double age = message.stamp_age;
  const double stamp = message.received - age;  // to within a constant
  const auto [known, first] = writers_.try_emplace(message.writer);
  Writer& writer = known->second;
  const bool advanced = !first && stamp - writer.stamp > kStampRate * (message.received - writer.received);
  writer.advances = writer.advances || advanced;
  writer.smallest_age = first ? age : std::min(writer.smallest_age, age);
  writer.stamp = stamp;
  writer.received = message.received;
  if (!first && !writer.advances) {  // it does not stamp at all
    ++clock_offsets_;
    return 0.0;
  }
  if (age - writer.smallest_age > kLongestDelay) {
    if (writer.late_since < 0.0) writer.late_since = message.received;
    // Held up on the way, or the same old measurement again. Only where it goes on so and new ones come was a clock
    // set.
    if (!advanced || message.received - writer.late_since <= kLongestDelay) return std::nullopt;
    writer.smallest_age = age;
  }
  writer.late_since = -1.0;
  if (writer.smallest_age >= 0.0 && writer.smallest_age <= kLongestDelay) return std::min(age, kLongestDelay);
  ++clock_offsets_;
  return std::min(age - writer.smallest_age, kLongestDelay);
}

void TrackTable::ingest(const TrackMessage& message) {
  const std::optional<double> delay = delay_of(message);
  if (!delay) {
    ++late_messages_;
    return;
  }
  const double measured = message.received - *delay;
  newest_message_ = std::max(newest_message_, message.received);
  for (const planner::Track& track : message.tracks) {
    Entry& entry = entries_[{message.writer, track.id}];
    if (entry.seen > 0.0 && measured < entry.measured) continue;  // overtaken on the way
    entry = {track, measured, message.received};
  }
}

std::vector<planner::Track> TrackTable::predict(double now, double trust) {
  std::erase_if(entries_, [&](const auto& item) { return now - item.second.seen > coast_s_; });
  std::vector<planner::Track> tracks;
  tracks.reserve(entries_.size());
  std::set<std::uint64_t> used;
  for (const auto& [key, entry] : entries_) {
    const double age = std::max(0.0, now - entry.measured);
    planner::Track track = planner::predict(entry.track, age, trust);
    track.age = age;
    while (!used.insert(track.id).second) ++track.id;
    tracks.push_back(track);
  }
  return tracks;
}

}  // namespace jink::bridge
