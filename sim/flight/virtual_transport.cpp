// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flight/virtual_transport.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bridge/tracking/track_inbox.hpp"
#include "bridge/vehicle/command_tracker.hpp"
#include "bridge/vehicle/px4.hpp"

namespace jink::sim::flight {
namespace {

constexpr double kLinkUp = 0.3;             // s after a boot, when the autopilot begins to listen
constexpr double kFirstHeartbeat = 1.3;     // s after a boot
constexpr std::uint8_t kStateCritical = 5;  // MAV_STATE

bridge::vehicle::FlightMode bridge_mode(vehicle::FlightMode mode) {
  switch (mode) {
    case vehicle::FlightMode::kManual:
    case vehicle::FlightMode::kAcro:
    case vehicle::FlightMode::kStabilized:
      return bridge::vehicle::FlightMode::kManual;
    case vehicle::FlightMode::kAltitude:
      return bridge::vehicle::FlightMode::kAltitude;
    case vehicle::FlightMode::kPosition:
      return bridge::vehicle::FlightMode::kPosition;
    case vehicle::FlightMode::kTakeoff:
      return bridge::vehicle::FlightMode::kTakeoff;
    case vehicle::FlightMode::kHold:
      return bridge::vehicle::FlightMode::kHold;
    case vehicle::FlightMode::kMission:
      return bridge::vehicle::FlightMode::kMission;
    case vehicle::FlightMode::kReturn:
      return bridge::vehicle::FlightMode::kReturn;
    case vehicle::FlightMode::kLand:
      return bridge::vehicle::FlightMode::kLand;
    case vehicle::FlightMode::kOffboard:
      return bridge::vehicle::FlightMode::kOffboard;
  }
  return bridge::vehicle::FlightMode::kOther;
}

bridge::vehicle::BatteryState bridge_battery(vehicle::BatteryLevel level) {
  switch (level) {
    case vehicle::BatteryLevel::kUnknown:
      return bridge::vehicle::BatteryState::kUnknown;
    case vehicle::BatteryLevel::kOk:
      return bridge::vehicle::BatteryState::kOk;
    case vehicle::BatteryLevel::kLow:
      return bridge::vehicle::BatteryState::kLow;
    case vehicle::BatteryLevel::kCritical:
    case vehicle::BatteryLevel::kEmergency:
      return bridge::vehicle::BatteryState::kCritical;
  }
  return bridge::vehicle::BatteryState::kUnknown;
}

}  // namespace

VirtualLink::VirtualLink(vehicle::Autopilot& autopilot, std::uint64_t seed)
    : autopilot_(autopilot),
      frame_(vehicle::kSitlOrigin),
      up_(seed, faults::link_stream(autopilot.options().system_id, 0)),
      down_(seed, faults::link_stream(autopilot.options().system_id, 1)) {}

void VirtualLink::impair(const faults::LinkImpairment& impairment) {
  link_delay_ = 0.5 * (impairment.up.delay + impairment.down.delay);
  up_.set(impairment.up);
  down_.set(impairment.down);
}

void VirtualLink::note_reset(const Vec3& by) {
  ++resets_;
  shift_ += by;
}

void VirtualLink::advance(double now) {
  now_ = now;
  give_up();
  exchange();
}

void VirtualLink::send_telemetry() {
  if (autopilot_.reboots() > 0 && autopilot_.boot_time() < kFirstHeartbeat) return;
  down_.push(now_, snapshot());
  exchange();
}

bool VirtualLink::send(const bridge::vehicle::Setpoint& setpoint) {
  up_.push(now_, setpoint);
  exchange();
  return true;
}

void VirtualLink::request(bridge::vehicle::Command command) {
  const CommandPacket packet{command, commands_++};
  unanswered_.push_back({packet, now_});
  up_.push(now_, packet);
  exchange();
}

std::optional<bridge::vehicle::CommandReport> VirtualLink::next_report() {
  if (reports_.empty()) return std::nullopt;
  bridge::vehicle::CommandReport report = std::move(reports_.front());
  reports_.pop_front();
  return report;
}

void VirtualLink::exchange() {
  const auto take = [this](const auto& packet) { deliver(packet); };
  UpPacket up;
  while (up_.pop(now_, up)) std::visit(take, up);
  DownPacket down;
  while (down_.pop(now_, down)) std::visit(take, down);
}

void VirtualLink::deliver(const bridge::vehicle::Setpoint& setpoint) {
  if (autopilot_.reboots() > 0 && autopilot_.boot_time() < kLinkUp) return;
  vehicle::Setpoint out;
  out.position = setpoint.position;
  out.velocity = setpoint.velocity;
  out.acceleration = setpoint.acceleration;
  out.yaw = setpoint.yaw;
  autopilot_.offboard_setpoint(out);
}

void VirtualLink::deliver(const CommandPacket& packet) {
  if (autopilot_.reboots() > 0 && autopilot_.boot_time() < kLinkUp) return;
  const vehicle::Result result = act(packet.command);
  const bool accepted = result == vehicle::Result::kAccepted;
  const std::string detail = accepted ? "" : "result " + std::to_string(static_cast<int>(result));
  down_.push(now_, AnswerPacket{{packet.command, accepted, detail}, packet.number});
}

vehicle::Result VirtualLink::act(bridge::vehicle::Command command) {
  switch (command) {
    case bridge::vehicle::Command::kArm:
      return autopilot_.arm();
    case bridge::vehicle::Command::kDisarm:
      return autopilot_.disarm();
    case bridge::vehicle::Command::kOffboard:
      return autopilot_.set_mode(6);
    case bridge::vehicle::Command::kHold:
      return autopilot_.hold();
    case bridge::vehicle::Command::kLand:
      return autopilot_.land();
    case bridge::vehicle::Command::kReturn:
      return autopilot_.set_mode(4, 5);
  }
  return vehicle::Result::kUnsupported;
}

/// Stamps are those of its arrival, less half the round trip, as a receiver has no others. An autopilot that does not
/// know where it is tells no position.
void VirtualLink::deliver(const bridge::vehicle::VehicleState& state) {
  const auto motion_before = state_.motion;
  state_ = state;
  state_.heartbeat_stamp = now_;
  state_.link_delay = link_delay_;
  state_.motion.received = now_;
  state_.motion.stamp = now_ - state_.link_delay;
  state_.attitude_stamp = state_.motion.stamp;
  if (!state.local_position_ok) state_.motion = motion_before;
}

void VirtualLink::deliver(const AnswerPacket& answer) {
  const auto asked = std::find_if(unanswered_.begin(), unanswered_.end(),
                                  [&](const Unanswered& u) { return u.packet.number == answer.number; });
  if (asked == unanswered_.end()) return;  // answered before, or given up
  unanswered_.erase(asked);
  reports_.push_back(answer.report);
}

void VirtualLink::give_up() {
  std::erase_if(unanswered_, [&](const Unanswered& waiting) {
    if (now_ - waiting.sent < bridge::vehicle::CommandTracker::kAnswer_s) return false;
    reports_.push_back({waiting.packet.command, false, bridge::vehicle::CommandTracker::kNoAnswer});
    return true;
  });
}

bridge::vehicle::VehicleState VirtualLink::snapshot() const {
  const vehicle::Motion& motion = autopilot_.estimated_motion();
  bridge::vehicle::VehicleState state;
  state.armed = autopilot_.armed();
  state.mode = bridge_mode(autopilot_.mode());
  state.intended_mode = bridge_mode(autopilot_.intended_mode());
  state.remote_control = autopilot_.remote_control();
  state.motion.value = {motion.position, motion.velocity};
  state.position_sigma = bridge::vehicle::px4::position_sigma(autopilot_.estimator().horizontal_accuracy(),
                                                              autopilot_.estimator().vertical_accuracy());
  state.home_height = 0.0;  // a scenario's heights count from its origin, wherever its ground is
  state.yaw = motion.yaw;
  state.attitude = motion.attitude;
  state.armable = autopilot_.prearm_ok();
  state.local_position_ok = autopilot_.position_valid();
  state.gps_lost = !autopilot_.estimator().gps();
  state.in_air = autopilot_.landed_state() != vehicle::LandedState::kOnGround;
  if (!autopilot_.prearm_ok()) state.health = "pre-arm check";
  if (!state.local_position_ok) state.health += state.health.empty() ? "local position" : ", local position";
  state.failsafe = autopilot_.heartbeat().system_status >= kStateCritical;
  state.estimate_resets = resets_;
  state.estimate_shift = shift_;
  state.battery = bridge_battery(autopilot_.battery_level());
  const vehicle::Parameters& parameters = autopilot_.parameters();
  state.failsafe_parameters.offboard_loss = parameters.integer("COM_OBL_RC_ACT");
  state.failsafe_parameters.return_height = parameters.real("RTL_RETURN_ALT");
  state.origin = frame_.to_geodetic(autopilot_.estimator().origin());
  state.system_id = static_cast<std::uint32_t>(autopilot_.options().system_id);
  state.reboots = static_cast<std::uint32_t>(autopilot_.reboots());
  return state;
}

VirtualTracks::VirtualTracks(const world::World& world, const faults::FaultTimeline& timeline, std::uint64_t seed)
    : world_(world), timeline_(timeline), pipeline_(world.scenario().sensing, seed), faults_(seed) {}

void VirtualTracks::advance(double now, std::span<const world::VehicleTruth> vehicles,
                            const world::EstimateError& error) {
  now_ = now;
  vehicles_.assign(vehicles.begin(), vehicles.end());
  std::vector<Vec3> positions;
  for (const world::VehicleTruth& vehicle : vehicles) positions.push_back(vehicle.position);
  pipeline_.step(now, world_, positions, 0.0, error);
}

bool VirtualTracks::poll(bridge::tracking::TrackMessage& message) {
  world::TrackMessage measured;
  do {
    if (!pipeline_.poll(now_, measured)) return false;
  } while (!faults_.apply(timeline_, world_, vehicles_, measured));
  accept(measured, message);
  return true;
}

// As a reader behind a real transport does it.
void VirtualTracks::accept(const world::TrackMessage& measured, bridge::tracking::TrackMessage& message) {
  message = {{1, now_, now_ - measured.stamp - measured.clock_offset}, {}};
  message.placed = true;
  bridge::tracking::TrackValidator validator(message, measured.tracks.size());
  for (const planner::base::Track& track : measured.tracks) validator.add(track);
  ++status_.messages;
  status_.dropped_tracks += message.dropped;
  if (const std::string why = validator.why(); !why.empty()) status_.last_refusal = why;
}

}  // namespace jink::sim::flight
