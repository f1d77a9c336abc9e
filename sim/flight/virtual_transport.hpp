// SPDX-License-Identifier: BSD-3-Clause
// What stands for MAVLink and DDS in virtual time: the autopilot and the tracks as the companion sees them, without
// sockets. Both can be as bad as the scenario's faults say.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "bridge/tracking/track_source.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "sim/faults/fault_timeline.hpp"
#include "sim/faults/link_faults.hpp"
#include "sim/faults/track_faults.hpp"
#include "sim/vehicle/autopilot.hpp"
#include "sim/vehicle/frame_conversions.hpp"
#include "sim/world/sensing.hpp"

namespace jink::sim::flight {

/// Telemetry is one packet each time it is sent, a setpoint or command one packet up, the answer to a command one down.
/// Unimpaired, all of them arrive at once. As on the real link (bridge/mavsdk) a command is sent once, and reported as
/// unanswered after a second.
class VirtualLink final : public bridge::vehicle::VehicleLink {
 public:
  /// The autopilot outlives the link.
  VirtualLink(vehicle::Autopilot& autopilot, std::uint64_t seed);

  /// How bad the link is from now on.
  void impair(const faults::LinkImpairment& impairment);
  /// The estimate has just jumped by `by`, as ODOMETRY's reset counter tells.
  void note_reset(const Vec3& by);
  /// Goes on to `now`: what has come through arrives.
  void advance(double now);
  /// The autopilot tells its state, unless it boots.
  void send_telemetry();

  bridge::vehicle::VehicleState state() override { return state_; }
  bool send(const bridge::vehicle::Setpoint& setpoint) override;
  void request(bridge::vehicle::Command command) override;
  std::optional<bridge::vehicle::CommandReport> next_report() override;

 private:
  struct CommandPacket {
    bridge::vehicle::Command command{};
    std::uint64_t number = 0;
  };
  struct AnswerPacket {
    bridge::vehicle::CommandReport report;
    std::uint64_t number = 0;
  };
  struct Unanswered {
    CommandPacket packet;
    double sent = 0.0;
  };
  using UpPacket = std::variant<bridge::vehicle::Setpoint, CommandPacket>;
  using DownPacket = std::variant<bridge::vehicle::VehicleState, AnswerPacket>;

  void exchange();
  void deliver(const bridge::vehicle::Setpoint& setpoint);
  void deliver(const CommandPacket& packet);
  void deliver(const bridge::vehicle::VehicleState& state);
  void deliver(const AnswerPacket& answer);
  void give_up();
  [[nodiscard]] vehicle::Result act(bridge::vehicle::Command command);
  [[nodiscard]] bridge::vehicle::VehicleState snapshot() const;

  vehicle::Autopilot& autopilot_;
  bridge::frames::LocalFrame frame_;
  double now_ = 0.0;
  faults::ImpairedChannel<UpPacket> up_;
  faults::ImpairedChannel<DownPacket> down_;
  double link_delay_ = 0.0;              ///< s, one way, on average
  bridge::vehicle::VehicleState state_;  ///< as it has arrived
  std::uint32_t resets_ = 0;
  Vec3 shift_ = Vec3::Zero();
  std::uint64_t commands_ = 0;
  std::deque<Unanswered> unanswered_;
  std::deque<bridge::vehicle::CommandReport> reports_;
};

/// The world's sensing with the faults of its tracks, checked at the door as the DDS reader checks.
class VirtualTracks final : public bridge::tracking::TrackSource {
 public:
  /// The world and the timeline outlive it.
  VirtualTracks(const world::World& world, const faults::FaultTimeline& timeline, std::uint64_t seed);

  /// Goes on to `now`, with the vehicles as they are then, by number: what is within range of one is in the message.
  /// `error` is that of the vehicle whose tracks these are.
  void advance(double now, std::span<const world::VehicleTruth> vehicles, const world::EstimateError& error = {});
  /// The same for one vehicle.
  void advance(double now, const world::VehicleTruth& vehicle) { advance(now, std::span(&vehicle, 1)); }

  bool poll(bridge::tracking::TrackMessage& message) override;
  [[nodiscard]] bridge::tracking::TrackSourceStatus status() const override { return status_; }

 private:
  void accept(const world::TrackMessage& measured, bridge::tracking::TrackMessage& message);

  const world::World& world_;
  const faults::FaultTimeline& timeline_;
  world::SensingPipeline pipeline_;
  faults::TrackFaults faults_;
  double now_ = 0.0;
  std::vector<world::VehicleTruth> vehicles_;
  bridge::tracking::TrackSourceStatus status_{1, 0, 0, 0, 0, {}};
};

}  // namespace jink::sim::flight
