// SPDX-License-Identifier: BSD-3-Clause
// Several sources of obstacle tracks as one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bridge/tracking/track_source.hpp"

namespace jink::bridge::tracking {

/// Polls its sources in turn, one message each, so that a busy one starves none. Not thread-safe.
class TrackSources final : public TrackSource {
 public:
  TrackSources() = default;
  /// `source` must outlive this.
  void add(TrackSource& source);
  [[nodiscard]] std::size_t size() const { return sources_.size(); }

  bool poll(TrackMessage& message) override;
  /// The sum; last_refusal is the newest among them, as far as calls of status() tell: of those that changed between
  /// two calls, the later source's.
  [[nodiscard]] TrackSourceStatus status() const override;
  void notify(base::Notifier& notifier) override {
    for (Source& source : sources_) source.source->notify(notifier);
  }

 private:
  struct Source {
    TrackSource* source = nullptr;
    mutable std::string refusal;  // its last one at the last status()
  };
  std::vector<Source> sources_;
  std::size_t next_ = 0;
  mutable std::string last_refusal_;
};

}  // namespace jink::bridge::tracking
