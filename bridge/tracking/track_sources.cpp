// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/track_sources.hpp"

namespace jink::bridge::tracking {

void TrackSources::add(TrackSource& source) {
  sources_.push_back({&source, {}});
}

bool TrackSources::poll(TrackMessage& message) {
  for (std::size_t tried = 0; tried < sources_.size(); ++tried) {
    TrackSource& source = *sources_[next_].source;
    next_ = (next_ + 1) % sources_.size();
    if (source.poll(message)) return true;
  }
  return false;
}

TrackSourceStatus TrackSources::status() const {
  TrackSourceStatus sum;
  for (const Source& each : sources_) {
    const TrackSourceStatus status = each.source->status();
    sum.writers += status.writers;
    sum.messages += status.messages;
    sum.refused += status.refused;
    sum.dropped_tracks += status.dropped_tracks;
    sum.malformed += status.malformed;
    if (status.last_refusal != each.refusal) last_refusal_ = each.refusal = status.last_refusal;
  }
  sum.last_refusal = last_refusal_;
  return sum;
}

}  // namespace jink::bridge::tracking
