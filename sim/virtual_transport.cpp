// SPDX-License-Identifier: BSD-3-Clause
#include "sim/virtual_transport.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bridge/dds_tracks.hpp"

namespace jink::sim {
namespace {

constexpr double kAnswerTimeout = 0.5;      // s, MAVSDK's, after which a command is sent again
constexpr int kRetries = 3;                 // MAVSDK's
constexpr double kLinkUp = 0.3;             // s after a boot, when the autopilot begins to listen
constexpr double kFirstHeartbeat = 1.3;     // s after a boot
constexpr std::uint8_t kStateCritical = 5;  // MAV_STATE

bridge::FlightMode bridge_mode(FlightMode mode) {
  switch (mode) {
    case FlightMode::kManual:
    case FlightMode::kAcro:
    case FlightMode::kStabilized:
      return bridge::FlightMode::kManual;
    case FlightMode::kAltitude:
      return bridge::FlightMode::kAltitude;
    case FlightMode::kPosition:
      return bridge::FlightMode::kPosition;
    case FlightMode::kTakeoff:
      return bridge::FlightMode::kTakeoff;
    case FlightMode::kHold:
      return bridge::FlightMode::kHold;
    case FlightMode::kReturn:
      return bridge::FlightMode::kReturn;
    case FlightMode::kLand:
      return bridge::FlightMode::kLand;
    case FlightMode::kOffboard:
      return bridge::FlightMode::kOffboard;
  }
  return bridge::FlightMode::kOther;
}

bridge::BatteryState bridge_battery(BatteryLevel level) {
  switch (level) {
    case BatteryLevel::kUnknown:
      return bridge::BatteryState::kUnknown;
    case BatteryLevel::kOk:
      return bridge::BatteryState::kOk;
    case BatteryLevel::kLow:
      return bridge::BatteryState::kLow;
    case BatteryLevel::kCritical:
    case BatteryLevel::kEmergency:
      return bridge::BatteryState::kCritical;
  }
  return bridge::BatteryState::kUnknown;
}

}  // namespace

VirtualLink::VirtualLink(Autopilot& autopilot, std::uint64_t seed)
    : autopilot_(autopilot),
      frame_(kSitlOrigin),
      up_(seed, link_stream(autopilot.options().system_id, 0)),
      down_(seed, link_stream(autopilot.options().system_id, 1)) {}

void VirtualLink::impair(const LinkImpairment& impairment) {
  up_.set(impairment.up);
  down_.set(impairment.down);
}

void VirtualLink::note_reset(const Vec3& by) {
  ++resets_;
  shift_ += by;
}

void VirtualLink::advance(double now) {
  now_ = now;
  send_again();
  exchange();
}

void VirtualLink::send_telemetry() {
  if (autopilot_.reboots() > 0 && autopilot_.boot_time() < kFirstHeartbeat) return;
  down_.push(now_, snapshot());
  exchange();
}

bool VirtualLink::send(const bridge::Setpoint& setpoint) {
  up_.push(now_, setpoint);
  exchange();
  return true;
}

void VirtualLink::request(bridge::Command command) {
  const CommandPacket packet{command, commands_++};
  unanswered_.push_back({packet, now_, 0});
  up_.push(now_, packet);
  exchange();
}

std::optional<bridge::CommandReport> VirtualLink::next_report() {
  if (reports_.empty()) return std::nullopt;
  bridge::CommandReport report = std::move(reports_.front());
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

void VirtualLink::deliver(const bridge::Setpoint& setpoint) {
  if (autopilot_.reboots() > 0 && autopilot_.boot_time() < kLinkUp) return;
  Setpoint out;
  out.position = setpoint.position;
  out.velocity = setpoint.velocity;
  out.acceleration = setpoint.acceleration;
  out.yaw = setpoint.yaw;
  autopilot_.offboard_setpoint(out);
}

void VirtualLink::deliver(const CommandPacket& packet) {
  if (autopilot_.reboots() > 0 && autopilot_.boot_time() < kLinkUp) return;
  const Result result = act(packet.command);
  const bool accepted = result == Result::kAccepted;
  const std::string detail = accepted ? "" : "result " + std::to_string(static_cast<int>(result));
  down_.push(now_, AnswerPacket{{packet.command, accepted, detail}, packet.number});
}

Result VirtualLink::act(bridge::Command command) {
  switch (command) {
    case bridge::Command::kArm:
      return autopilot_.arm();
    case bridge::Command::kDisarm:
      return autopilot_.disarm();
    case bridge::Command::kOffboard:
      return autopilot_.set_mode(6);
    case bridge::Command::kHold:
      return autopilot_.hold();
    case bridge::Command::kLand:
      return autopilot_.land();
  }
  return Result::kUnsupported;
}

/// Stamps are those of its arrival, as a receiver has no others.
void VirtualLink::deliver(const bridge::VehicleState& state) {
  state_ = state;
  state_.heartbeat_stamp = state_.position_stamp = now_;
}

void VirtualLink::deliver(const AnswerPacket& answer) {
  const auto asked = std::find_if(unanswered_.begin(), unanswered_.end(),
                                  [&](const Unanswered& u) { return u.packet.number == answer.number; });
  if (asked == unanswered_.end()) return;  // answered before, or given up
  unanswered_.erase(asked);
  reports_.push_back(answer.report);
}

void VirtualLink::send_again() {
  for (Unanswered& waiting : unanswered_) {
    if (now_ - waiting.sent < kAnswerTimeout) continue;
    waiting.sent = now_;
    if (++waiting.retries <= kRetries) up_.push(now_, waiting.packet);
  }
  std::erase_if(unanswered_, [&](const Unanswered& waiting) {
    if (waiting.retries <= kRetries) return false;
    reports_.push_back({waiting.packet.command, false, "no answer"});
    return true;
  });
}

bridge::VehicleState VirtualLink::snapshot() const {
  const Motion& motion = autopilot_.estimated_motion();
  bridge::VehicleState state;
  state.armed = autopilot_.armed();
  state.mode = bridge_mode(autopilot_.mode());
  state.position = motion.position;
  state.velocity = motion.velocity;
  state.yaw = motion.yaw;
  state.armable = autopilot_.prearm_ok();
  state.local_position_ok = autopilot_.position_valid();
  state.gps_lost = !autopilot_.estimator().gps();
  state.in_air = autopilot_.landed_state() != LandedState::kOnGround;
  state.health = state.local_position_ok ? "" : "local position";
  state.failsafe = autopilot_.heartbeat().system_status >= kStateCritical;
  state.estimate_resets = resets_;
  state.estimate_shift = shift_;
  state.battery = bridge_battery(autopilot_.battery_level());
  state.origin = frame_.to_geodetic(autopilot_.estimator().origin());
  state.system_id = static_cast<std::uint32_t>(autopilot_.options().system_id);
  return state;
}

VirtualTracks::VirtualTracks(const World& world, const FaultTimeline& timeline, std::uint64_t seed)
    : world_(world), timeline_(timeline), pipeline_(world.scenario().sensing, seed), faults_(seed) {}

void VirtualTracks::advance(double now, std::span<const VehicleTruth> vehicles) {
  now_ = now;
  vehicles_.assign(vehicles.begin(), vehicles.end());
  std::vector<Vec3> positions;
  for (const VehicleTruth& vehicle : vehicles) positions.push_back(vehicle.position);
  pipeline_.step(now, world_, positions);
}

bool VirtualTracks::poll(bridge::TrackMessage& message) {
  TrackMessage measured;
  do {
    if (!pipeline_.poll(now_, measured)) return false;
  } while (!faults_.apply(timeline_, world_, vehicles_, measured));
  accept(measured, message);
  return true;
}

// As a reader behind a real transport does it.
void VirtualTracks::accept(const TrackMessage& measured, bridge::TrackMessage& message) {
  message = {1, now_, now_ - measured.stamp - measured.clock_offset, {}, 0};
  bridge::TrackSieve sieve(message, measured.tracks.size());
  for (const planner::Track& track : measured.tracks) sieve.add(track);
  ++status_.messages;
  status_.dropped_tracks += message.dropped;
  if (const std::string why = sieve.why(); !why.empty()) status_.last_refusal = why;
}

}  // namespace jink::sim
