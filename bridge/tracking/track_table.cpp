// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/track_table.hpp"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "bridge/prediction/plain_prediction.hpp"
#include "bridge/tracking/track_inbox.hpp"
#include "planner/base/settings.hpp"
#include "planner/geometry/obstacle_motion.hpp"

namespace jink::bridge::tracking {
namespace {

constexpr double kMoving = 0.05;     // m/s, above which a track that stands is not a new measurement
constexpr double kSelfSpeed = 1.5;   // m/s, of difference to the vehicle's velocity, at most, of its own track
constexpr double kSelfSigmas = 2.0;  // of a track's position, that it may be off the vehicle's
constexpr double kSelfDoubt = 0.5;   // m, of that at most: who is not seen better than so may be somebody else
constexpr double kSelfLeaves = 1.5;  // times the distance that makes a track its own, at which it no longer is
constexpr double kSelfSize = 3.0;    // times the vehicle's radius, that its own track may have
constexpr double kTrust = planner::base::HorizonSettings{}.acceleration_trust;  // s, of what is held against the future

// The first of its id keeps it, later ones are numbered on from the largest.
void make_ids_unique(std::vector<planner::base::Track>& tracks) {
  std::unordered_set<std::uint64_t> used;
  used.reserve(tracks.size());
  std::uint64_t last = 0;
  for (const planner::base::Track& track : tracks) last = std::max(last, track.id);
  for (planner::base::Track& track : tracks) {
    while (!used.insert(track.id).second) track.id = ++last;
  }
}

}  // namespace

// When the message's tracks were measured; nothing where that is too long ago to say anything of the present.
std::optional<double> TrackTable::stamp_of(const TrackMessage& message) {
  Writer& writer = writers_[message.writer];
  writer.received = message.received;
  const std::optional<double> stamp = writer.clock.stamp(message);
  if (stamp && writer.clock.off()) ++counts_.clock_offsets;
  return stamp;
}

// What moves has not moved. Nothing where nothing moves.
bool TrackTable::is_repetition(const TrackMessage& message) const {
  const std::vector<Seen>& last = writers_.at(message.writer).last;
  if (last.size() != message.tracks.size()) return false;
  bool any = false;
  for (std::size_t i = 0; i < last.size(); ++i) {
    const planner::base::Track& track = message.tracks[i];
    if (!(track.velocity.norm() > kMoving)) continue;
    if (last[i].id != track.id || last[i].position != track.position) return false;
    any = true;
  }
  return any;
}

void TrackTable::remember(const TrackMessage& message) {
  std::vector<Seen>& last = writers_.at(message.writer).last;
  last.clear();
  for (const planner::base::Track& track : message.tracks) last.push_back({track.id, track.position});
}

TrackMessage TrackTable::with_velocities(TrackMessage message, double measured) const {
  for (planner::base::Track& track : message.tracks) {
    const auto known = entries_.find({message.writer, track.id});
    if (known != entries_.end()) {
      known->second.history.set_velocity(measured, track);
    } else {
      prediction::PositionHistory().set_velocity(measured, track);
    }
  }
  return message;
}

void TrackTable::ingest(const TrackMessage& message) {
  const std::optional<double> measured = stamp_of(message);
  if (!measured) {
    ++counts_.late_messages;
  } else if (message.positions_only) {
    ingest(with_velocities(message, *measured), *measured);
  } else {
    ingest(message, *measured);
  }
}

void TrackTable::ingest(const TrackMessage& message, double measured) {
  if (is_repetition(message)) {
    ++counts_.frozen_messages;
    return;
  }
  remember(message);
  if (message.sends_when_empty)
    newest_message_ = std::max(newest_message_.value_or(message.received), message.received);
  Writer& writer = writers_[message.writer];
  if (!writer.first) writer.first = message.received;
  writer.believed = message.received;
  writer.named = message.named;
  writer.sends_when_empty = message.sends_when_empty;
  for (const planner::base::Track& track : message.tracks) {
    if (refusal(track) != nullptr) {
      ++counts_.invalid_tracks;
      continue;
    }
    const Key key{message.writer, track.id};
    auto known = entries_.find(key);
    if (known == entries_.end()) {
      if (entries_.size() >= kMost) forget(message.received);
      if (entries_.size() >= kMost) {
        ++counts_.surplus_tracks;
        continue;
      }
      known = entries_.emplace(key, Entry{}).first;
    }
    Entry& entry = known->second;
    if (measured < entry.track.stamp) continue;  // overtaken on the way
    if (message.positions_only) entry.history.add(measured, track);
    take(entry, {track, measured, message.received});
  }
  learn(message, measured);
}

void TrackTable::take(Entry& entry, const base::Stamped<planner::base::Track, base::Frame::kLocal>& measured) {
  const double before = std::exchange(entry.track, measured).stamp;
  if (!measured.value.is_exact()) {
    if (!entry.filter) entry.filter = std::make_unique<prediction::ImmFilter>();
    entry.filter->update(measured.stamp - before, measured.value);
    entry.filter->apply(entry.track.value);
  } else {
    entry.filter.reset();
  }
}

// The ways of the tracks about the vehicle; the fits of the nearest first.
void TrackTable::learn(const TrackMessage& message, double t) {
  if (!vehicle_) return;
  struct Due {
    double distance_squared;
    const planner::base::Track* measured;
    Entry* entry;
  };
  std::vector<Due> due;
  for (const planner::base::Track& measured : message.tracks) {
    const auto known = entries_.find({message.writer, measured.id});
    if (known == entries_.end() || known->second.track.stamp != t) continue;
    Entry& entry = known->second;
    const double distance_squared = (entry.track.value.position - *vehicle_).squaredNorm();
    const bool near = distance_squared < kLearned * kLearned;
    if (!near && entry.learned) {
      entry.learned.reset();
      entry.error.reset();
      --learned_;
    }
    if (near && !entry.learned && learned_ < kMostLearned) {
      entry.learned = std::make_unique<prediction::MotionLearner>();
      entry.error = std::make_unique<prediction::PredictionError>();
      ++learned_;
    }
    if (!entry.learned) continue;
    entry.learned->observe(t, measured, entry.track.value, measured.id, experience_);
    entry.error->observe(t, measured, predict(entry, message.received, kTrust), laws_);
    if (entry.learned->fit_due() <= t) due.push_back({distance_squared, &measured, &entry});
  }
  std::stable_sort(due.begin(), due.end(),
                   [](const Due& a, const Due& b) { return a.distance_squared < b.distance_squared; });
  if (due.size() > kFits) due.resize(kFits);
  for (const Due& d : due) d.entry->learned->fit(t, *d.measured, d.entry->track.value);
}

prediction::Prediction TrackTable::predict(const Entry& entry, double now, double trust) const {
  prediction::Prediction result;
  result.id = entry.track.value.id;
  result.radius = entry.track.value.radius;
  result.age = std::max(0.0, entry.track.age(now));
  result.position_sigma = entry.track.value.position_sigma;
  result.velocity_sigma = entry.track.value.velocity_sigma;
  result.trust = trust;
  if (auto forecast = entry.learned->forecast(now, entry.track.stamp, entry.track.value, experience_)) {
    std::visit([&](auto& motion) { result.motion = std::move(motion); }, forecast->motion);
    result.position_sigma = forecast->position_sigma;
    result.velocity_sigma = forecast->velocity_sigma;
  } else {
    planner::base::Track track = prediction::predict(entry.track, now, trust);
    track.body = {};
    result.motion = std::move(track);
  }
  return result;
}

std::vector<prediction::Prediction> TrackTable::predictions(double now, double trust, const Vec3& place,
                                                            double range) const {
  std::vector<prediction::Prediction> all;
  for (const auto& [key, entry] : entries_) {
    if (entry.is_self || !entry.learned) continue;
    prediction::Prediction one = predict(entry, now, trust);
    if ((one.position(0.0) - place).norm() - one.radius > range) continue;
    one.acceleration_sigma = entry.error->acceleration_sigma();
    one.watched = entry.error->watched();
    one.body = entry.track.value.body.later(one.age);
    all.push_back(std::move(one));
  }
  return all;
}

bool TrackTable::has_unexplained(double speed) const {
  if (!vehicle_) return false;
  return std::any_of(entries_.begin(), entries_.end(), [&](const auto& item) {
    const Entry& entry = item.second;
    if (!entry.learned || entry.is_self || !entry.learned->unexplained(entry.track.stamp)) return false;
    const double reach = kMeeting * (speed + entry.track.value.velocity.norm());
    return (entry.track.value.position - *vehicle_).squaredNorm() < reach * reach;
  });
}

bool TrackTable::outlived(const Writer& writer, double received, double now) const {
  const bool silent = writer.sends_when_empty && writer.believed.value_or(received) - received <= coast_s_;
  return now - received > (missed_ && silent ? std::max(coast_s_, kMissed) : coast_s_);
}

void TrackTable::forget(double now) {
  std::erase_if(entries_, [&](const auto& item) {
    const bool gone = outlived(writers_.at(item.first.first), item.second.track.received, now);
    if (gone && item.second.learned) --learned_;
    return gone;
  });
  std::erase_if(writers_, [&](const auto& item) { return now - item.second.received > kForgetWriter; });
}

void TrackTable::find_self(double now, const Vec3& position, const Vec3& velocity, double radius) {
  own_tracks_ = 0;
  vehicle_ = position;
  for (auto& [key, entry] : entries_) {
    const double age = std::max(0.0, entry.track.age(now));
    const double doubt = std::min(kSelfDoubt, kSelfSigmas * entry.track.value.position_sigma);
    const double near = (radius + doubt) * (entry.is_self ? kSelfLeaves : 1.0);
    const bool here = (entry.track.value.position + age * entry.track.value.velocity - position).norm() < near &&
                      (entry.track.value.velocity - velocity).norm() < kSelfSpeed &&
                      entry.track.value.radius <= kSelfSize * radius;
    if (here && !entry.near_from) entry.near_from = position;
    if (!here) entry.near_from.reset();
    entry.is_self = here && (entry.is_self || (position - *entry.near_from).norm() > kSelfWay);
    own_tracks_ += entry.is_self ? 1 : 0;
  }
}

std::optional<double> TrackTable::newest_of(std::size_t named) const {
  std::optional<double> newest;
  for (const auto& [identity, writer] : writers_) {
    if (writer.named == named && writer.believed)
      newest = std::max(newest.value_or(*writer.believed), *writer.believed);
  }
  return newest;
}

int TrackTable::lost_writers(double now, double timeout_s, double since) const {
  std::vector<std::pair<double, int>> changes;  // when somebody came (-1) or went (1)
  for (const auto& [identity, writer] : writers_) {
    if (!writer.sends_when_empty || !writer.believed) continue;
    const bool speaks = now - *writer.believed <= timeout_s;
    const bool established = *writer.believed - *writer.first >= kEstablished;
    if (speaks || established) changes.emplace_back(*writer.first, -1);
    if (!speaks && established && *writer.believed >= since) changes.emplace_back(*writer.believed, 1);
  }
  std::sort(changes.begin(), changes.end());
  int lost = 0;
  for (const auto& [when, change] : changes) lost = std::max(0, lost + change);
  return lost;
}

std::vector<planner::base::Track> TrackTable::predict(double now, double trust,
                                                      std::vector<prediction::Forecast>* forecasts) {
  forget(now);
  std::vector<planner::base::Track> tracks;
  tracks.reserve(entries_.size());
  for (const auto& [key, entry] : entries_) {
    if (entry.is_self) continue;
    if (forecasts != nullptr && entry.learned) {
      if (auto forecast = entry.learned->forecast(now, entry.track.stamp, entry.track.value, experience_)) {
        forecast->track = tracks.size();
        forecasts->push_back(std::move(*forecast));
      }
    }
    tracks.push_back(prediction::predict(entry.track, now, trust));
    if (entry.error) tracks.back().sudden_change = entry.error->sudden_change();
  }
  if (writers_.size() > 1) make_ids_unique(tracks);
  return tracks;
}

}  // namespace jink::bridge::tracking
