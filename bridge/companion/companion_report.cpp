// SPDX-License-Identifier: BSD-3-Clause
// What the companion says and keeps of a flight: its events and its summary.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bridge/base/text.hpp"
#include "bridge/companion/companion.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kForgetting = 5.0;   // s, in which a tracking error fades to a third
constexpr double kMarginStep = 0.05;  // m, of a grown margin that is worth saying
constexpr double kLowStart = 0.1;     // m, below min_height: less is noise

}  // namespace

std::optional<Percentiles> percentiles(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    const auto n = static_cast<double>(values.size());
    return values[static_cast<std::size_t>(std::max(0.0, std::ceil(share * n) - 1.0))];
  };
  return Percentiles{rank(0.5), rank(0.99), values.back()};
}

void Companion::event(double now, std::string_view name, const std::string& detail) {
  for (FlightObserver* observer : parts_.observers) observer->on_event(now, name, detail);
}

void Companion::measure(double now) {
  const supervisor::Phase phase = supervisor_.phase();
  if (phase != supervisor::Phase::kFlying && phase != supervisor::Phase::kStopping) return;
  if (flight_began_ < 0.0) {
    flight_began_ = now;
    Vec3 from = state_.position;
    for (const Vec3& waypoint : mission_.waypoints) {
      summary_.straight_length += (waypoint - from).norm();
      from = waypoint;
    }
  }
  summary_.flight_time = now - flight_began_;
  summary_.max_speed = std::max(summary_.max_speed, state_.velocity.norm());
  if (last_position_) summary_.path_length += (state_.position - *last_position_).norm();
  last_position_ = state_.position;
  if (stream_.active() && now - state_.position_stamp <= settings_.companion.stale_state) {
    stream_.observe(state_.position_stamp, state_.position, state_.velocity, std::max(0.0, now - last_step_));
    const double error = (stream_.reference(state_.position_stamp).position - state_.position).norm();
    summary_.largest_tracking_error = std::max(summary_.largest_tracking_error, error);
    tracking_error_ = std::max(error, tracking_error_ * std::exp(-std::max(0.0, now - last_step_) / kForgetting));
  }
}

void Companion::record_hazard(double now) {
  const std::string& hazard = supervisor_.hazard();
  if (hazard.empty()) return;
  const bool goes_on =
      hazard == announced_hazard_ && !summary_.hazards.empty() && summary_.hazards.back().what == hazard;
  if (!goes_on) summary_.hazards.push_back({hazard, now, 0.0});
  summary_.hazards.back().duration = now - summary_.hazards.back().t;
}

// Events for what changed: nothing happens silently, and nothing is said fifty times a second.
void Companion::announce(double now) {
  if (team_) {
    for (const team::Team::Notice& take_notices : team_->take_notices(now))
      event(now, take_notices.name, take_notices.detail);
  }
  if (supervisor_.phase() != announced_phase_) {
    announced_phase_ = supervisor_.phase();
    const double start = state_.position.z() + (state_.in_air ? 0.0 : mission_.takeoff_height);
    if (announced_phase_ == supervisor::Phase::kEngaging && start < mission_.min_height - kLowStart)
      event(now, "raised",
            "a start at " + base::metres(start) + " is raised to min_height " + base::metres(mission_.min_height));
    event(now, "phase",
          std::string(supervisor::to_string(announced_phase_)) +
              (supervisor_.done()
                   ? ": " + std::string(supervisor::to_string(supervisor_.outcome())) + ", " + supervisor_.reason()
                   : ""));
  }
  if (supervisor_.waiting_for() != announced_waiting_) {
    announced_waiting_ = supervisor_.waiting_for();
    if (!announced_waiting_.empty()) event(now, "waiting", announced_waiting_);
  }
  if (supervisor_.hazard() != announced_hazard_) {
    announced_hazard_ = supervisor_.hazard();
    event(now, announced_hazard_.empty() ? "hazard_over" : "hazard", announced_hazard_);
  }
  announce_vehicle(now);
  announce_tracks(now);
}

void Companion::announce_vehicle(double now) {
  if (state_.battery != announced_battery_) {
    announced_battery_ = state_.battery;
    event(now, "battery", std::string(vehicle::to_string(announced_battery_)));
  }
  const double step = announced_margin_ ? 0.0 : kMarginStep;
  const bool grown = margin() > settings_.horizon.margin + step;
  if (grown != announced_margin_ && supervisor_.phase() == supervisor::Phase::kFlying) {
    announced_margin_ = grown;
    event(now, "margin",
          grown ? "tracking is off by " + base::metres(tracking_error_) + ": plans keep so much more from obstacles"
                : "back to " + base::metres(settings_.horizon.margin));
  }
}

// What was refused or put right, at most once a second.
void Companion::announce_tracks(double now) {
  const tracking::TrackSourceStatus tracks = parts_.tracks.status();
  const tracking::TrackTableCounts& table = table_.counts();
  summary_.dropped_tracks = tracks.dropped_tracks + table.invalid_tracks + table.surplus_tracks;
  if (std::floor(now) == std::floor(last_step_)) return;
  if (tracks.bad_frames != announced_tracks_.bad_frames || tracks.dropped_tracks != announced_tracks_.dropped_tracks)
    event(now, "tracks_refused", tracks.last_refusal);
  announced_tracks_ = tracks;
  if (table.clock_offsets > 0 && announced_table_.clock_offsets == 0)
    event(now, "tracks_clock",
          "a track writer's stamps are not this computer's time: only changes of its delay are known");
  if (table.late_messages != announced_table_.late_messages)
    event(now, "tracks_late", std::to_string(table.late_messages) + " track messages came too late to be used");
  if (table.frozen_messages != announced_table_.frozen_messages)
    event(now, "tracks_frozen",
          std::to_string(table.frozen_messages) +
              " track messages left out: what should move had not moved since the one before");
  if (table.invalid_tracks != announced_table_.invalid_tracks)
    event(now, "tracks_refused", std::to_string(table.invalid_tracks) + " tracks that are none were left out");
  if (table.surplus_tracks != announced_table_.surplus_tracks)
    event(now, "tracks_refused",
          std::to_string(table.surplus_tracks) + " tracks beyond " + std::to_string(tracking::TrackTable::kMost) +
              " were left out");
  announced_table_ = table;
  if (table_.own_tracks() != announced_own_)
    event(now, "tracks_self", std::to_string(table_.own_tracks()) + " tracks are taken for this vehicle itself");
  announced_own_ = table_.own_tracks();
  if (tracks.malformed != announced_malformed_)
    event(now, "tracks_malformed", std::to_string(tracks.malformed) + " track messages could not be decoded");
  announced_malformed_ = tracks.malformed;
}

FlightSummary Companion::summary() const {
  FlightSummary summary = summary_;
  summary.outcome = supervisor_.outcome();
  summary.reason = supervisor_.reason();
  summary.missing_peer = supervisor_.missing_peer();
  return summary;
}

}  // namespace jink::bridge::companion
