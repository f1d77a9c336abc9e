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

#include "bridge/track_source.hpp"
#include "bridge/vehicle_link.hpp"
#include "sim/autopilot.hpp"
#include "sim/faults.hpp"
#include "sim/impairment.hpp"
#include "sim/local_frame.hpp"
#include "sim/sensing.hpp"
#include "sim/track_faults.hpp"

namespace jink::sim {

/// Telemetry is one packet each time it is sent, a setpoint or command one packet up, the answer to a command one down.
/// Unimpaired, all of them arrive at once. A command that is not answered is sent again as MAVSDK does, three times
/// after half a second each, then reported as unanswered.
class VirtualLink final : public bridge::VehicleLink {
 public:
  /// The autopilot outlives the link.
  VirtualLink(Autopilot& autopilot, std::uint64_t seed);

  /// How bad the link is from now on.
  void impair(const LinkImpairment& impairment);
  /// The estimate has just jumped by `by`, as ODOMETRY's reset counter tells.
  void note_reset(const Vec3& by);
  /// Goes on to `now`: what has come through arrives.
  void advance(double now);
  /// The autopilot tells its state, unless it boots.
  void send_telemetry();

  bridge::VehicleState state() override { return state_; }
  bool send(const bridge::Setpoint& setpoint) override;
  void request(bridge::Command command) override;
  std::optional<bridge::CommandReport> next_report() override;

 private:
  struct CommandPacket {
    bridge::Command command{};
    std::uint64_t number = 0;
  };
  struct AnswerPacket {
    bridge::CommandReport report;
    std::uint64_t number = 0;
  };
  struct Unanswered {
    CommandPacket packet;
    double sent = 0.0;
    int retries = 0;
  };
  using UpPacket = std::variant<bridge::Setpoint, CommandPacket>;
  using DownPacket = std::variant<bridge::VehicleState, AnswerPacket>;

  void exchange();
  void deliver(const bridge::Setpoint& setpoint);
  void deliver(const CommandPacket& packet);
  void deliver(const bridge::VehicleState& state);
  void deliver(const AnswerPacket& answer);
  void send_again();
  [[nodiscard]] Result act(bridge::Command command);
  [[nodiscard]] bridge::VehicleState snapshot() const;

  Autopilot& autopilot_;
  LocalFrame frame_;
  double now_ = 0.0;
  ImpairedChannel<UpPacket> up_;
  ImpairedChannel<DownPacket> down_;
  bridge::VehicleState state_;  ///< as it has arrived
  std::uint32_t resets_ = 0;
  Vec3 shift_ = Vec3::Zero();
  std::uint64_t commands_ = 0;
  std::deque<Unanswered> unanswered_;
  std::deque<bridge::CommandReport> reports_;
};

/// The world's sensing with the faults of its tracks, checked at the door as the DDS reader checks.
class VirtualTracks final : public bridge::TrackSource {
 public:
  /// The world and the timeline outlive it.
  VirtualTracks(const World& world, const FaultTimeline& timeline, std::uint64_t seed);

  /// Goes on to `now`, with the vehicles as they are then, by number: what is within range of one is in the message.
  void advance(double now, std::span<const VehicleTruth> vehicles);
  /// The same for one vehicle.
  void advance(double now, const VehicleTruth& vehicle) { advance(now, std::span(&vehicle, 1)); }

  bool poll(bridge::TrackMessage& message) override;
  [[nodiscard]] bridge::TrackSourceStatus status() const override { return status_; }

 private:
  void accept(const TrackMessage& measured, bridge::TrackMessage& message);

  const World& world_;
  const FaultTimeline& timeline_;
  SensingPipeline pipeline_;
  TrackFaults faults_;
  double now_ = 0.0;
  std::vector<VehicleTruth> vehicles_;
  bridge::TrackSourceStatus status_{1, 0, 0, 0, 0, {}};
};

}  // namespace jink::sim
