// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "bridge/base/text.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kMarginStep = 0.05;  // m, of a grown margin that is worth saying
constexpr double kLowStart = 0.1;     // m, below min_height: less is noise

/// Whether that is something else than what was said; from now on it is what was said.
template <class T>
bool changed(T& said, const T& now) {
  if (said == now) return false;
  said = now;
  return true;
}

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

void FlightReporter::event(double now, std::string_view name, const std::string& detail) {
  for (FlightObserver* observer : observers_) observer->on_event(now, name, detail);
}

void FlightReporter::state(double now, const vehicle::VehicleState& state) {
  if (state.motion.heard()) summary_.end_estimate = state.motion.value.position;
  for (FlightObserver* observer : observers_) observer->on_state(now, state);
}

void FlightReporter::tracks(double now, const std::vector<planner::base::Track>& tracks) {
  for (FlightObserver* observer : observers_) observer->on_tracks(now, tracks);
}

void FlightReporter::plan(double now, const PlanResult& result) {
  ++summary_.plans;
  summary_.plan_ms.push_back(result.ms);
  if (result.missed) ++summary_.deadline_misses;
  if (result.plan.status == planner::verify::PlanStatus::kBlocked) ++summary_.blocked_plans;
  for (FlightObserver* observer : observers_) observer->on_plan(now, result);
  if (changed(said_.plan_status, result.plan.status))
    event(now, "plan_status", std::string(planner::verify::to_string(result.plan.status)));
}

void FlightReporter::setpoint(double now, const vehicle::Setpoint& setpoint) {
  for (FlightObserver* observer : observers_) observer->on_setpoint(now, setpoint);
}

// Each time that one begins, or is looked at again.
void FlightReporter::stops(double now, const planner::horizon::Stop& stop) {
  const auto& contact = stop.verification.first_contact;
  if (!changed(said_.evades, stop.choice > 0 || contact) || !said_.evades) return;
  event(now, "evades",
        contact ? "no stop stays free, contact in " + base::seconds(*contact) + ": the least bad one"
                : "a straight stop would not stay free: another one");
}

void FlightReporter::stall(double now, double duration, const std::string& text) {
  event(now, "stalled", text);
  summary_.hazards.push_back({text, now - duration, duration});
}

void FlightReporter::estimate_reset(double now, const Vec3& shift) {
  ++summary_.estimate_resets;
  last_position_ += shift;
  event(now, "estimate_reset",
        "the autopilot's position estimate jumped by " + base::metres(shift.norm()) + ": the plan is shifted along");
}

void FlightReporter::flown(double now, const vehicle::VehicleState& state) {
  if (!flight_began_) {
    flight_began_ = now;
    last_position_ = state.motion.value.position;
    Vec3 from = state.motion.value.position;
    for (const Vec3& waypoint : mission_.waypoints) {
      summary_.straight_length += (waypoint - from).norm();
      from = waypoint;
    }
  }
  summary_.flight_time = now - *flight_began_;
  summary_.max_speed = std::max(summary_.max_speed, state.motion.value.velocity.norm());
  summary_.path_length += (state.motion.value.position - last_position_).norm();
  last_position_ = state.motion.value.position;
}

void FlightReporter::hazard_lasts(double now, const std::string& hazard) {
  if (hazard.empty()) return;
  const bool goes_on = hazard == said_.hazard && !summary_.hazards.empty() && summary_.hazards.back().what == hazard;
  if (!goes_on) summary_.hazards.push_back({hazard, now, 0.0});
  summary_.hazards.back().duration = now - summary_.hazards.back().t;
}

void FlightReporter::reference_lost(double now, bool lost, double error, double share) {
  if (changed(said_.reference_lost, lost) && lost)
    event(now, "reference_lost",
          "tracking error " + base::metres(error) + ": planning from the vehicle's position, with " +
              std::to_string(std::lround(100.0 * share)) + " % of the speed and the acceleration");
}

void FlightReporter::cautious(double now, bool cautious) {
  if (changed(said_.cautious, cautious))
    event(now, "caution", cautious ? "a new track nearby moves in a way not understood yet: slower" : "over");
}

void FlightReporter::retreats(double now, const std::optional<Vec3>& refuge, double risk) {
  if (!changed(said_.retreats, refuge.has_value())) return;
  std::array<char, 16> percent{};
  std::snprintf(percent.data(), percent.size(), "%.1f %%", 100.0 * risk);
  event(now, "retreat",
        refuge ? "away from movers that are not understood yet: hit with " + std::string(percent.data()) + " on the way"
               : "over");
}

void FlightReporter::stuck(double now, bool stuck) {
  if (changed(said_.stuck, stuck)) event(now, "stuck", stuck ? "no nearer to the target for 4 s" : "over");
}

void FlightReporter::unseen(double now, bool stays) {
  if (changed(said_.unseen, stays))
    event(now, "unseen", stays ? "the way on was not seen: it waits and looks" : "over");
}

void FlightReporter::aircraft(double now, const std::optional<Intake::Approach>& approach) {
  if (!approach) said_.aircraft.clear();
  if (!approach || !said_.aircraft.insert(approach->icao_address).second) return;
  std::array<char, 16> address{};
  std::snprintf(address.data(), address.size(), "%06X", approach->icao_address);
  event(now, "aircraft",
        std::string(address.data()) + " comes to less than well clear (2000 ft beside, 250 ft above or below) in " +
            std::to_string(std::lround(approach->seconds)) + " s; the vehicle's own? name it as icao_address");
}

void FlightReporter::sending(double now, bool works) {
  if (!changed(said_.sending, works)) return;
  works ? event(now, "send_works", "setpoints can be sent again")
        : event(now, "send_failed", "setpoints cannot be sent");
}

void FlightReporter::clouds(double now, const map::CloudSourceStatus& source, std::uint64_t unplaced,
                            const map::MapperCounts& map) {
  summary_.clouds = map.clouds;
  summary_.dropped_clouds = source.refused + source.malformed + unplaced;
  if (said_.clouds_at && std::floor(now) == std::floor(*said_.clouds_at)) return;
  said_.clouds_at = now;
  if (source.refused != said_.clouds.refused)
    event(now, "clouds_refused", std::to_string(source.refused) + " clouds of points: " + source.last_refusal);
  if (source.malformed != said_.clouds.malformed)
    event(now, "clouds_malformed",
          std::to_string(source.malformed) + " clouds of points could not be decoded, or have no x, y and z");
  if (changed(said_.unplaced, unplaced))
    event(now, "clouds_refused",
          std::to_string(unplaced) + " clouds of points of times at which it is not known where the vehicle was");
  said_.clouds = source;
}

void FlightReporter::announce(double now, const supervisor::Supervisor& supervisor, Intake& intake, double margin,
                              double tracking_error) {
  if (team::Team* team = intake.team()) {
    for (const team::Team::Notice& notice : team->take_notices(now)) event(now, notice.name, notice.detail);
  }
  announce_phase(now, supervisor, intake.state());
  if (changed(said_.waiting, supervisor.waiting_for()) && !said_.waiting.empty()) event(now, "waiting", said_.waiting);
  if (changed(said_.holds, supervisor.holds(now)) && said_.holds)
    event(now, "holding", "for " + base::seconds(mission_.hold_time) + ", out of the way of what comes");
  if (changed(said_.arrived, supervisor.arrived() && !said_.holds) && said_.phase == supervisor::Phase::kFlying)
    event(now, "arrived",
          mission_.arrival == config::Arrival::kLand
              ? "going down as far as plans lead, to land where it stays free"
              : "it does not stay free there: holding out of the way of what comes");
  if (changed(said_.hazard, supervisor.hazard()))
    event(now, said_.hazard.empty() ? "hazard_over" : "hazard", said_.hazard);
  announce_vehicle(now, supervisor, intake.state().battery, margin, tracking_error);

  const tracking::TrackSourceStatus sources = intake.source_status();
  const tracking::TrackTableCounts& table = intake.table().counts();
  summary_.dropped_tracks = sources.dropped_tracks + table.invalid_tracks + table.surplus_tracks;
  // What was refused or put right, at most once a second.
  const bool said_now = said_.at && std::floor(now) == std::floor(*said_.at);
  said_.at = now;
  if (said_now) return;
  if (sources.refused != said_.sources.refused || sources.dropped_tracks != said_.sources.dropped_tracks)
    event(now, "tracks_refused", sources.last_refusal);
  if (changed(said_.elsewhere, intake.elsewhere()))
    event(now, "tracks_refused",
          std::to_string(said_.elsewhere) +
              " track messages: all is farther beside the geofence than that is wide: given in another frame?");
  announce_tracks(now, intake.table());
  if (sources.malformed != said_.sources.malformed)
    event(now, "tracks_malformed", std::to_string(sources.malformed) + " track messages could not be decoded");
  said_.sources = sources;
}

void FlightReporter::announce_phase(double now, const supervisor::Supervisor& supervisor,
                                    const vehicle::VehicleState& state) {
  if (!changed(said_.phase, supervisor.phase())) return;
  const double above_ground = state.motion.value.position.z() - mission_.ground;
  const double start = above_ground + (state.in_air ? 0.0 : mission_.takeoff_height);
  const double least = mission_.min_height - mission_.ground;
  if (said_.phase == supervisor::Phase::kEngaging && start < least - kLowStart)
    event(now, "raised", "a start at " + base::metres(start) + " is raised to min_height " + base::metres(least));
  std::string detail(supervisor::to_string(said_.phase));
  if (supervisor.done())
    detail += ": " + std::string(supervisor::to_string(supervisor.outcome())) + ", " + supervisor.reason();
  event(now, "phase", detail);
}

void FlightReporter::announce_vehicle(double now, const supervisor::Supervisor& supervisor,
                                      vehicle::BatteryState battery, double margin, double tracking_error) {
  if (changed(said_.battery, battery)) event(now, "battery", std::string(vehicle::to_string(battery)));
  if (supervisor.phase() != supervisor::Phase::kFlying) return;
  const bool grown = margin > margin_ + (said_.margin ? 0.0 : kMarginStep);
  if (changed(said_.margin, grown))
    event(now, "margin",
          grown ? "tracking is off by " + base::metres(tracking_error) + ": plans keep so much more from obstacles"
                : "back to " + base::metres(margin_));
}

void FlightReporter::announce_tracks(double now, const tracking::TrackTable& tracks) {
  const tracking::TrackTableCounts before = std::exchange(said_.table, tracks.counts());
  const tracking::TrackTableCounts& counts = said_.table;
  const auto tell = [&](std::uint64_t count, std::uint64_t said, const char* name, const char* what) {
    if (count != said) event(now, name, std::to_string(count) + what);
  };
  if (counts.clock_offsets > 0 && before.clock_offsets == 0)
    event(now, "tracks_clock",
          "a track writer's stamps are not this computer's time: only changes of its delay are known");
  tell(counts.late_messages, before.late_messages, "tracks_late", " track messages came too late to be used");
  tell(counts.frozen_messages, before.frozen_messages, "tracks_frozen",
       " track messages left out: what should move had not moved since the one before");
  tell(counts.invalid_tracks, before.invalid_tracks, "tracks_refused", " tracks that are none were left out");
  tell(counts.surplus_tracks, before.surplus_tracks, "tracks_refused",
       (" tracks beyond " + std::to_string(tracking::TrackTable::kMost) + " were left out").c_str());
  if (changed(said_.own_tracks, tracks.own_tracks()))
    event(now, "tracks_self", std::to_string(said_.own_tracks) + " tracks are taken for this vehicle itself");
}

}  // namespace jink::bridge::companion
