// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/track_inbox.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/geometry/validity.hpp"

namespace jink::bridge::tracking {

// Each comparison is false for NaN.
const char* refusal(const planner::base::Track& t) {
  using L = TrackLimits;
  if (!(t.position.norm() <= L::kPosition)) return "position";
  if (!(t.velocity.norm() <= L::kVelocity)) return "velocity";
  if (!(t.acceleration.norm() <= L::kAcceleration)) return "acceleration";
  if (!(t.radius > 0.0 && t.radius <= L::kRadius)) return "radius";
  if (!planner::geometry::is_valid(t.body, t.radius)) return "shape";
  if (!(t.position_sigma >= 0.0 && t.position_sigma <= L::kSigma)) return "position_sigma";
  if (!(t.velocity_sigma >= 0.0 && t.velocity_sigma <= L::kSigma)) return "velocity_sigma";
  return nullptr;
}

bool elsewhere(const TrackMessage& message, const planner::base::Box& fence) {
  if (message.placed || (message.tracks.empty() && message.far == 0)) return false;
  const double width = (fence.max - fence.min).head<2>().norm();
  return std::all_of(message.tracks.begin(), message.tracks.end(), [&](const planner::base::Track& track) {
    const Vec3 beside = (fence.min - track.position).cwiseMax(track.position - fence.max).cwiseMax(0.0);
    return beside.head<2>().norm() > width + track.radius;  // false where there is no fence
  });
}

TrackValidator::TrackValidator(TrackMessage& message, std::size_t stated) : message_(message), stated_(stated) {
  message_.tracks.reserve(std::min(stated, TrackLimits::kTracksPerMessage));
}

void TrackValidator::add(const planner::base::Track& track, const char* bad) {
  if (++added_ > TrackLimits::kTracksPerMessage) {
    ++message_.dropped;
  } else if (const char* field = refusal(track); bad != nullptr || field != nullptr) {
    bad_what_ = bad != nullptr ? bad : std::string(field) + " is not finite or out of range";
    bad_id_ = track.id;
    ++message_.dropped;
    if (track.position.allFinite() && track.position.norm() > TrackLimits::kPosition) ++message_.far;
  } else {
    message_.tracks.push_back(track);
  }
}

std::string TrackValidator::why() const {
  if (stated_ > TrackLimits::kTracksPerMessage) {
    return "a message of " + std::to_string(stated_) + " tracks; at most " +
           std::to_string(TrackLimits::kTracksPerMessage) + " are taken";
  }
  if (bad_what_.empty()) return {};
  return "track " + std::to_string(bad_id_) + ": " + bad_what_;
}

void TrackInbox::put(TrackMessage message, const std::string& why) {
  const std::scoped_lock lock(mutex_);
  if (queue_.size() == TrackLimits::kQueuedMessages) {
    queue_.pop_front();
    ++overruns_;
  }
  ++status_.messages;
  status_.dropped_tracks += message.dropped;
  if (!why.empty()) status_.last_refusal = why;
  queue_.push_back(std::move(message));
  if (notifier_ != nullptr) notifier_->notify();
}

void TrackInbox::notify(base::Notifier& notifier) {
  const std::scoped_lock lock(mutex_);
  notifier_ = &notifier;
}

void TrackInbox::refuse(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  ++status_.refused;
  status_.last_refusal = why;
}

bool TrackInbox::poll(TrackMessage& message) {
  const std::scoped_lock lock(mutex_);
  if (queue_.empty()) return false;
  message = std::move(queue_.front());
  queue_.pop_front();
  return true;
}

TrackSourceStatus TrackInbox::status() const {
  const std::scoped_lock lock(mutex_);
  return status_;
}

std::uint64_t TrackInbox::overruns() const {
  const std::scoped_lock lock(mutex_);
  return overruns_;
}

}  // namespace jink::bridge::tracking
