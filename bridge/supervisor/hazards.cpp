// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/supervisor/hazards.hpp"

#include <algorithm>

namespace jink::bridge::supervisor {
namespace {

// s: a link that loses every fifth packet loses three heartbeats in a row twice in five minutes.
constexpr double kHeartbeatLost = 5.0;
constexpr double kUnsent = 0.2;            // s
constexpr double kLatest = 0.5;            // s, that a position is on its way: at 4 m/s it is 2 m behind
constexpr double kBreach = 1.0;            // m; less is the way back of a vehicle that is beside its path
constexpr double kForgetting = 1.0 / 3.0;  // s of hazard forgotten in each second without one

using S = Situation;
constexpr auto kBrake = Hazard::Reaction::kBrake;
using E = config::Endings;

constexpr Hazard kHazards[] = {
    {"the battery is critical", [](const S& s) { return s.state.battery == vehicle::BatteryState::kCritical; },
     Hazard::Reaction::kStop, &E::battery, /*names_mode=*/false, /*decides=*/true},
    {"the vehicle's position is stale",
     [](const S& s) { return s.state.motion.silence(s.now) > s.settings.stale_state; }, kBrake, &E::link},
    {"the vehicle's position comes too late", [](const S& s) { return s.state.motion.delay() > kLatest; }, kBrake,
     &E::link},
    {"the autopilot's heartbeat is missing",
     [](const S& s) { return s.now - s.state.heartbeat_stamp > kHeartbeatLost; }, kBrake, &E::link},
    {"the autopilot's failsafe flies", [](const S& s) { return s.failsafe; }, kBrake, &E::link, /*names_mode=*/true},
    {"the autopilot has lost its position", [](const S& s) { return !s.state.local_position_ok; }, kBrake,
     &E::position},
    {"the autopilot has lost its GPS", [](const S& s) { return s.state.gps_lost; }, kBrake, &E::position},
    {"a crewed aircraft comes too near", [](const S& s) { return s.flight.aircraft_comes; }, kBrake, &E::traffic,
     /*names_mode=*/false, /*decides=*/true},
    {"the vehicle has left the geofence", [](const S& s) { return s.flight.outside > kBreach; }, kBrake, &E::breach},
    {"the vehicle is above the geofence", [](const S& s) { return s.flight.above > kBreach; }, kBrake, &E::breach},
    {"the vehicle cannot follow its setpoints", [](const S& s) { return s.flight.cannot_follow; }, kBrake, &E::breach},
    {"the obstacle tracks are stale",
     [](const S& s) {
       return s.tracks.required && (!s.flight.newest_tracks || s.now - *s.flight.newest_tracks > s.tracks.timeout_s);
     },
     kBrake, &E::tracks},
    {"a writer of obstacle tracks has fallen silent",
     [](const S& s) { return s.tracks.required && s.flight.lost_writers > 0; }, kBrake, &E::tracks},
    {"the clouds of points are stale", [](const S& s) { return s.flight.blind; }, kBrake, &E::tracks},
    {"setpoints cannot be sent", [](const S& s) { return s.flight.unsent_for > kUnsent; }, kBrake, &E::link},
    {"the planner is late",
     [](const S& s) {
       if (!s.following_since) return false;
       const double newest = s.flight.newest_plan.value_or(*s.following_since);
       return s.now - std::max(newest, *s.following_since) > s.settings.stale_plan;
     },
     kBrake, &E::planner},
};

}  // namespace

std::span<const Hazard> hazards() {
  return kHazards;
}

const Hazard* find_hazard(Hazard::Reaction reaction, const Situation& situation) {
  const auto* const found = std::find_if(std::begin(kHazards), std::end(kHazards), [&](const Hazard& hazard) {
    return hazard.reaction == reaction && hazard.present(situation);
  });
  return found == std::end(kHazards) ? nullptr : found;
}

const Hazard* find_deciding(const Situation& situation) {
  const auto* const found = std::find_if(std::begin(kHazards), std::end(kHazards), [&](const Hazard& hazard) {
    return hazard.decides && hazard.present(situation);
  });
  return found == std::end(kHazards) ? nullptr : found;
}

void HazardWatch::advance(double now) {
  spent_ = std::max(0.0, spent_ + (text_.empty() ? -kForgetting : 1.0) * (now - advanced_.value_or(now)));
  advanced_ = now;
}

void HazardWatch::see(const Hazard* hazard, const Situation& situation) {
  text_.clear();
  if (hazard == nullptr) {
    since_.reset();
    return;
  }
  text_ = hazard->what;
  if (hazard->names_mode) text_ += ", mode " + std::string(vehicle::to_string(situation.state.mode));
  if (!since_) since_ = situation.now;
}

std::string HazardWatch::given_up(double now, double give_up) const {
  if (!since_) return {};
  if (now - *since_ > give_up) return text_;
  return spent_ > 2.0 * give_up ? text_ + ", again and again" : std::string();
}

}  // namespace jink::bridge::supervisor
