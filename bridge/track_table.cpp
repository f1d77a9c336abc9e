// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/track_table.hpp"

#include <algorithm>
#include <set>

#include "planner/obstacle_motion.hpp"

namespace jink::bridge {

void TrackTable::ingest(const TrackMessage& message) {
  const auto [known, first] = smallest_age_.try_emplace(message.writer, message.stamp_age);
  known->second = std::min(known->second, message.stamp_age);
  double delay = message.stamp_age;
  if (known->second < 0.0 || known->second > kLongestDelay) {
    ++clock_offsets_;
    delay -= known->second;
  }
  const double measured = message.received - std::clamp(delay, 0.0, kLongestDelay);
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
