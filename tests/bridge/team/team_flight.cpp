// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bridge/team/team_flight.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "bridge/frames/conversions.hpp"
#include "sim/flight/team_link.hpp"
#include "sim/vehicle/autopilot.hpp"

namespace jink::bridge::team {
namespace {

const frames::Geodetic kOrigin{47.397742, 8.545594, 488.0};
constexpr double kTurn = 0.02;  // s, of the companions' loops

/// The autopilot without MAVLink between. What the vehicle knows is in its own frame.
class Link final : public vehicle::VehicleLink {
 public:
  Link(sim::vehicle::Autopilot& autopilot, const Vehicle& vehicle) : autopilot_(autopilot), vehicle_(vehicle) {
    if (vehicle.knows_origin) origin_ = frames::LocalFrame(kOrigin).to_geodetic(vehicle.origin);
  }

  vehicle::VehicleState state() override {
    const sim::vehicle::Motion& motion = autopilot_.true_motion();
    vehicle::VehicleState state;
    state.heartbeat_stamp = state.motion.stamp = state.motion.received = autopilot_.time();
    state.armed = autopilot_.armed();
    state.mode = autopilot_.mode() == sim::vehicle::FlightMode::kOffboard ? vehicle::FlightMode::kOffboard
                                                                          : vehicle::FlightMode::kHold;
    state.motion.value = {motion.position - vehicle_.origin, motion.velocity};
    state.yaw = motion.yaw;
    state.armable = autopilot_.prearm_ok();
    state.local_position_ok = true;
    state.in_air = autopilot_.landed_state() != sim::vehicle::LandedState::kOnGround;
    state.home_height = autopilot_.home().z() - vehicle_.origin.z();
    state.failsafe_parameters.offboard_loss = 0.0;
    state.origin = origin_;
    state.system_id = vehicle_.system_id;
    return state;
  }
  bool send(const vehicle::Setpoint& setpoint) override {
    sim::vehicle::Setpoint out;
    out.position = Vec3(setpoint.position + vehicle_.origin);
    out.velocity = setpoint.velocity;
    out.acceleration = setpoint.acceleration;
    out.yaw = setpoint.yaw;
    return autopilot_.offboard_setpoint(out) == sim::vehicle::Result::kAccepted;
  }
  void request(vehicle::Command command) override {
    if (command == vehicle::Command::kOffboard) autopilot_.set_mode(6);
    if (command == vehicle::Command::kHold) autopilot_.hold();
    if (command == vehicle::Command::kArm) autopilot_.arm();
  }
  std::optional<vehicle::CommandReport> next_report() override { return std::nullopt; }

 private:
  sim::vehicle::Autopilot& autopilot_;
  const Vehicle& vehicle_;
  std::optional<frames::Geodetic> origin_;
};

/// A writer that sees nothing.
class NoTracks final : public tracking::TrackSource {
 public:
  bool poll(tracking::TrackMessage&) override { return false; }
  [[nodiscard]] tracking::TrackSourceStatus status() const override { return {}; }
};

class Listener final : public companion::FlightObserver {
 public:
  explicit Listener(Flown& flown) : flown_(flown) {}
  void on_event(double, std::string_view name, const std::string& detail) override {
    flown_.events.emplace_back(name, detail);
  }

 private:
  Flown& flown_;
};

config::Mission mission_of(const Vehicle& vehicle, const Options& options) {
  config::Mission mission;
  mission.name = "team";
  mission.connection = "virtual time";
  mission.waypoints = {vehicle.target - vehicle.origin};
  mission.arrival = config::Arrival::kHold;
  mission.min_height = 1.0 - vehicle.origin.z();
  mission.intents = vehicle.intents;
  mission.tracks.required = false;
  mission.time_limit = options.time_limit;
  return mission;
}

sim::vehicle::AutopilotOptions autopilot_of(const Vehicle& vehicle) {
  sim::vehicle::AutopilotOptions options;
  options.position = vehicle.start;
  options.airborne = true;
  options.ready_delay = 0.0;
  options.cascade.max_descent = options.limits.max_climb;
  return options;
}

/// One vehicle with all that flies it.
struct Member {
  Member(const Vehicle& vehicle_, IntentTransport& transport, const config::Settings& settings, const Options& options,
         Flown& flown)
      : vehicle(vehicle_),
        autopilot(autopilot_of(vehicle)),
        link(autopilot, vehicle),
        listener(flown),
        planner({settings.horizon, settings.optimizer, options.seed, options.threads},
                1e-3 * settings.companion.planner_latency_ms),
        companion(mission_of(vehicle, options), settings, {link, tracks, planner, {&listener}, nullptr, &transport}) {}

  Vehicle vehicle;
  sim::vehicle::Autopilot autopilot;
  Link link;
  NoTracks tracks;
  Listener listener;
  companion::VirtualPlanner planner;
  companion::Companion companion;
  bool over = false;
};

void judge(const std::vector<std::unique_ptr<Member>>& members, double t, Result& result) {
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const planner::base::VehicleLimits limits;
      const double apart =
          (members[i]->autopilot.true_motion().position - members[j]->autopilot.true_motion().position).norm();
      if (apart - 2.0 * limits.radius >= result.least_clearance) continue;
      result.least_clearance = apart - 2.0 * limits.radius;
      result.at = t;
    }
  }
}

}  // namespace

bool Result::all_reached() const {
  return std::all_of(vehicles.begin(), vehicles.end(),
                     [](const Flown& f) { return f.summary.outcome == supervisor::Outcome::kReached; });
}

double Result::last_arrival() const {
  double last = 0.0;
  for (const Flown& f : vehicles) last = std::max(last, f.arrived < 0.0 ? planner::base::kInfinity : f.arrived);
  return last;
}

Result fly(const std::vector<Vehicle>& vehicles, const config::Settings& settings, const Options& options) {
  Result result;
  result.vehicles.resize(vehicles.size());
  sim::flight::TeamLink exchange({options.seed, options.delay, options.jitter, options.loss});
  std::vector<std::unique_ptr<Member>> members;
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    Vehicle vehicle = vehicles[i];
    if (vehicle.system_id == 0) vehicle.system_id = static_cast<std::uint32_t>(i + 1);
    const double clock_ahead = options.clock_offset * static_cast<double>(i);
    IntentTransport& transport = exchange.join({vehicle.listens, vehicle.silent_from, clock_ahead});
    members.push_back(std::make_unique<Member>(vehicle, transport, settings, options, result.vehicles[i]));
  }
  const int steps_per_turn = static_cast<int>(std::lround(kTurn / sim::vehicle::VehicleModel::kStep));
  bool going = true;
  for (int step = 0; going; ++step) {
    const double t = members.front()->autopilot.time();
    exchange.advance(t);
    judge(members, t, result);
    if (step % steps_per_turn == 0) {
      going = false;
      for (std::size_t i = 0; i < members.size(); ++i) {
        Member& m = *members[i];
        if (step % (5 * steps_per_turn) == 0) result.vehicles[i].trail.push_back(m.autopilot.true_motion().position);
        if (m.over) continue;
        going = true;
        if (t + 1e-9 < m.vehicle.begins || m.companion.step(t)) continue;
        m.over = true;
        result.vehicles[i].arrived = t;
      }
    }
    for (const auto& m : members) m->autopilot.step();
  }
  for (std::size_t i = 0; i < members.size(); ++i) result.vehicles[i].summary = members[i]->companion.summary();
  return result;
}

std::vector<Vehicle> swapping(double apart, double height) {
  const Vec3 a(0, 0, height);
  const Vec3 b(apart, 0, height);
  return {{a, b}, {b, a}};
}

std::vector<Vehicle> crossing(int count, double radius, double height) {
  std::vector<Vehicle> vehicles;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    const Vec3 out(radius * std::cos(angle), radius * std::sin(angle), 0.0);
    const Vec3 middle(0, 0, height);
    vehicles.push_back({middle + out, middle - out});
  }
  return vehicles;
}

}  // namespace jink::bridge::team
