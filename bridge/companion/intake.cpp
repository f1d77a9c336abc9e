// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/intake.hpp"

#include <algorithm>
#include <utility>

#include "bridge/tracking/track_inbox.hpp"

namespace jink::bridge::companion {
namespace {

constexpr std::size_t kMostWriters = 1000;
constexpr int kMostMessages = 64;     // of tracks, in a turn
constexpr double kMissedAfter = 0.5;  // of the time that tracks coast, of silence of a writer

}  // namespace

Intake::Intake(const config::Mission& mission, const config::Settings& settings, vehicle::VehicleLink& link,
               tracking::TrackSource& tracks, team::IntentTransport* intents)
    : mission_(mission), settings_(settings), link_(link), tracks_(tracks), table_(mission.tracks.coast_s) {
  if (mission.intents && intents != nullptr) team_.emplace(*intents, mission.vehicle.radius, mission.tracks.coast_s);
}

Intake::FrameChange Intake::take_state() {
  state_ = link_.state();
  FrameChange change;
  change.rebooted = std::exchange(reboots_, state_.reboots) != state_.reboots;
  if (std::exchange(estimate_resets_, state_.estimate_resets) != state_.estimate_resets)
    change.shift = state_.estimate_shift - std::exchange(estimate_shift_, state_.estimate_shift);
  if (change.rebooted) ground_.reset();
  if (change.shift && ground_) *ground_ += change.shift->z();
  const bool stands = state_.landed_state_known && !state_.in_air && !state_.armed;
  if (stands && state_.local_position_ok) {
    ground_ = state_.motion.value.position.z();
  } else if (!ground_) {
    ground_ = state_.home_height;
  }
  return change;
}

bool Intake::take_tracks(double now) {
  tracking::TrackMessage message;
  bool any = false;
  // A turn takes no more than so many: a writer at full speed must not keep the setpoints waiting.
  for (int taken = 0; taken < kMostMessages && tracks_.poll(message); ++taken) {
    // Who has told of something near sees something far away; and in flight nothing is left out for that.
    const bool elsewhere = tracking::elsewhere(message, mission_.geofence);
    if (elsewhere && flight_began_ > now && !at_home_.contains(message.writer)) {
      ++elsewhere_;
      continue;
    }
    if (!elsewhere && !message.tracks.empty() && at_home_.size() < kMostWriters) at_home_.insert(message.writer);
    table_.ingest(message);
    if (!message.aircraft.empty()) aircraft_ = std::move(message.aircraft);
    any = true;
  }
  // Sooner than that is a hazard: by then the tracks would be forgotten.
  const double missed_after = kMissedAfter * mission_.tracks.coast_s;
  table_.miss(table_.lost_writers(now, missed_after, watched_since_) > 0 ||
              now - newest_tracks().value_or(now) > missed_after);
  if (any && state_.motion.silence(now) <= settings_.companion.stale_state)
    table_.find_self(now, base::position_at(state_.motion, now), state_.motion.value.velocity, mission_.vehicle.radius);
  return any;
}

void Intake::listen_to_team(double now) {
  if (team_) team_->listen(now, state_);
}

std::optional<double> Intake::newest_tracks() const {
  const std::size_t named = mission_.tracks.writers.size();
  if (named == 0) return table_.newest_message();
  std::optional<double> oldest = table_.newest_of(1);
  for (std::size_t i = 2; i <= named && oldest; ++i) {
    const std::optional<double> newest = table_.newest_of(i);
    oldest = newest ? std::optional(std::min(*oldest, *newest)) : std::nullopt;
  }
  return oldest;
}

std::string Intake::silent_writer(double now) const {
  for (std::size_t i = 0; i < mission_.tracks.writers.size(); ++i) {
    const std::optional<double> newest = table_.newest_of(i + 1);
    if (!newest || now - *newest > mission_.tracks.timeout_s) return mission_.tracks.writers[i].participant;
  }
  return {};
}

std::optional<Intake::Approach> Intake::approach(double now) const {
  std::optional<Approach> first;
  if (!state_.motion.heard()) return first;
  for (const tracking::Aircraft& aircraft : aircraft_) {
    const auto seconds = tracking::less_than_well_clear_in(aircraft, now, state_.motion.value.position);
    if (seconds && (!first || *seconds < first->seconds)) first = Approach{aircraft.icao_address, *seconds};
  }
  return first;
}

int Intake::lost_writers(double now, std::optional<double> flight_began) {
  flight_began_ = flight_began.value_or(planner::base::kInfinity);
  const int lost = table_.lost_writers(now, mission_.tracks.timeout_s, watched_since_);
  if (!flight_began && lost == 0) watched_since_ = now - mission_.tracks.timeout_s;
  return lost;
}

}  // namespace jink::bridge::companion
