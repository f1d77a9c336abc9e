// SPDX-License-Identifier: BSD-3-Clause
// What must never be, whatever befalls a flight of docs/safety.md. What must never be sent is safety_link.cpp's.
#include <algorithm>
#include <string>
#include <utility>

#include "tests/sim/flight/safety_flight.hpp"

namespace jink::sim::flight::safety {
namespace {

using bridge::supervisor::Outcome;
using bridge::supervisor::Phase;

constexpr double kWorkingHeartbeat = 1.5;  // s
constexpr double kSilence = 0.3;           // s, of the stream, by a companion that runs and has the vehicle
constexpr double kThere = 0.6;             // m, from the target, which counts as reached within 0.5 m
constexpr double kOutside = 2.5;           // m, beyond the geofence: what a vehicle overshoots that nobody steers
constexpr double kFastest = 6.0;           // m/s: the vehicle's 5, and what the air takes it along
constexpr double kTouchDown = 1.5;         // m/s: from so low that it counts as landed it may fall
constexpr double kFalls = 1.0;             // m: from lower it may have landed, as far as jink can tell
constexpr double kLow = 0.6;               // m, above the ground: no height to hang at
constexpr double kLifted = 0.1;            // m, above what the autopilot takes for landed

}  // namespace

bool Flight::link_works() const {
  return timeline_.link(0) == faults::LinkImpairment{} && wire_.sends && wire_.positions &&
         now() - wire_.told().heartbeat_stamp <= kWorkingHeartbeat;
}

void Flight::watch() {
  const vehicle::Motion& motion = autopilot_.true_motion();
  const double before = std::max(0.0, now() - vehicle::VehicleModel::kStep);
  const auto nearest = world_.sweep(last_position_, before, motion.position, now());
  if (nearest.min_clearance < 0.0 && !std::exchange(hit_, true))
    fault("it hits obstacle " + std::to_string(world::World::id(nearest.obstacle)));
  const bool falls = !autopilot_.armed() && last_position_.z() > kLifted;
  if (falls && was_armed_ && !what_.falls) fault("its motors stop in the air");
  if (falls && was_armed_) fell_from_ = last_position_.z();
  const double down = (last_position_.z() - motion.position.z()) / vehicle::VehicleModel::kStep;
  if (motion.position.z() <= 0.0 && down > kTouchDown && !what_.falls) fault("it hits the ground");
  was_armed_ = autopilot_.armed();
  if (was_armed_) last_mode_ = {autopilot_.mode(), autopilot_.intended_mode()};
  ever_armed_ = ever_armed_ || was_armed_;
  ever_flew_ = ever_flew_ || motion.position.z() > kLifted;
  const Vec3& believed = autopilot_.estimated_motion().position;
  was_at_target_ = was_at_target_ || (believed - mission_.waypoints.back()).norm() < kThere;
  last_position_ = motion.position;
  if (what_.around == Around::kAside) return;  // it is somewhere else than it believes, or is blown away
  const Vec3 slack = Vec3::Constant(kOutside);
  const planner::base::Box room{mission_.geofence.min - slack, mission_.geofence.max + slack};
  if (!room.contains(motion.position)) fault("it leaves the geofence");
  if (motion.velocity.norm() > kFastest) fault("it flies too fast");
}

void Flight::judge_turn() {
  const Phase phase = companion_->supervisor().phase();
  const bool ours =
      phase != Phase::kWaiting && phase != Phase::kDone && wire_.told().mode == bridge::vehicle::FlightMode::kOffboard;
  const bool landed = phase == Phase::kLanding && !wire_.told().in_air;
  if (ours && !landed && now() - wire_.last_sent() > kSilence) fault("the stream has a gap");
}

void Flight::judge_end() {
  const bridge::supervisor::Supervisor& supervisor = companion_->supervisor();
  if (supervisor.reason().empty()) fault("it ends without a reason");
  if (supervisor.outcome() == Outcome::kNone) fault("it ends without an outcome");
  if (link_works() && autopilot_.offboard_active()) fault("it ends with the vehicle in OFFBOARD");
  const bool reached = supervisor.outcome() == Outcome::kReached;
  if (reached && !was_at_target_) fault("it says that the target is reached, where it was not");
  if (reached && !wire_.told().armed && fell_from_ > kFalls)
    fault("it says that the target is reached, of a vehicle that falls");
}

void Flight::judge_afterwards() {
  // A crewed aircraft is waited for as long as it stays.
  const bool waits = companion_->supervisor().phase() == Phase::kWaiting && writers_.front()->aircraft;
  if (!began_) return fault("the flight never came there");
  if (!over_ && !waits) fault("it does not end");
  // Who did not watch for a while is not missed.
  const bool seen = what_.seen && *began_ > bridge::tracking::TrackTable::kEstablished + 0.2;
  if (seen && cell_.phase == Phase::kWaiting && ever_armed_) fault("it arms, though that is known");
  if (autopilot_.offboard_active()) fault("the vehicle is left in OFFBOARD");
  const bool by_hand = what_.of_pilot || (autopilot_.remote_control() && vehicle::is_manual(autopilot_.mode()));
  const double height = autopilot_.true_motion().position.z();
  if (autopilot_.armed() && height < kLow && !by_hand && !what_.falls && !autopilot_.in_failsafe())
    fault("it is left with its motors on, so low");
  for (const std::string& text : wire_.faults()) faults_.push_back(text);
}

void Flight::fault(const std::string& what) {
  constexpr std::size_t kMost = 5;
  if (faults_.size() < kMost) faults_.push_back(what + ", at " + std::to_string(now()) + " s");
}

}  // namespace jink::sim::flight::safety
