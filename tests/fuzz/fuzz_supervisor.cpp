// SPDX-License-Identifier: BSD-3-Clause
// A companion in flight, with an autopilot, a pilot, writers of tracks and clocks that do what the input says, held to
// what must never happen: that it arms or commands on old news, streams after a pilot took over, goes while the vehicle
// is in OFFBOARD without having asked for another mode, or sends a setpoint that is not finite, outside of the
// geofence, under the ground or beyond the vehicle's limits. The input: one byte for the mission, then two for each
// event: what happens, and how; between events the loop turns.
#include <cmath>

#include "bridge/companion/companion.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/bridge_fakes.hpp"

namespace {

using namespace jink;
using bridge::vehicle::Command;
using bridge::vehicle::FlightMode;
using fuzz::require;

constexpr double kFreshHeartbeat = 1.5;     // s
constexpr double kVelocityTolerance = 3.0;  // m/s: the way back to a path, and what the estimate is off
constexpr double kBraking = 2.0;            // m/s²
constexpr double kLost = 1.2;               // m, that a vehicle may be off what it is asked for
constexpr double kMostDrag = 1.5;           // 1/s, that is made up for
constexpr double kTolerance = 0.3;          // m, by which what brakes beside a bound may pass it

config::Mission mission_of(std::uint8_t choice) {
  config::Mission m;
  m.system_id = 1;
  m.takeoff_height = 2.0;
  m.min_height = 1.0;
  m.waypoints = {{8, 3, 2}, {18, -5, 4}};
  m.arrival = (choice & 1U) != 0U ? config::Arrival::kLand : config::Arrival::kHold;
  m.geofence = {{-5, -10, 0}, {30, 10, 12}};
  m.time_limit = 60.0;
  m.tracks.required = (choice & 2U) == 0U;
  m.tracks.coast_s = (choice & 4U) != 0U ? 0.2 : 1.0;
  const std::array<config::EndsIn, 3> endings{config::EndsIn::kHold, config::EndsIn::kLand, config::EndsIn::kReturn};
  m.endings.tracks = m.endings.link = endings[(choice >> 3U) % 3U];
  m.endings.breach = m.endings.planner = endings[(choice >> 5U) % 3U];
  m.endings.return_above_fence = true;
  return m;
}

/// Everything around the companion, and what has become of it.
class World {
 public:
  explicit World(std::uint8_t choice)
      : mission_(mission_of(choice)), companion_(mission_, {}, {link_, source_, planner_, {}}) {
    auto& state = link_.telemetry;
    state.mode = state.intended_mode = FlightMode::kHold;
    state.armable = state.local_position_ok = true;
    state.failsafe_parameters.offboard_loss = 0.0;
    if ((choice & 128U) != 0U) {
      state.in_air = state.armed = true_armed_ = true;
      state.home_height = 0.0;
      state.motion.value.position = {0, 0, 2};
    }
  }

  /// False once the flight is over.
  bool turn(double dt) {
    now_ += dt;
    auto& state = link_.telemetry;
    // A heartbeat a second, and soon after a change, as far as the link lives.
    if (link_up_ && (now_ - state.heartbeat_stamp >= 1.0 || told_ != std::pair(true_mode_, true_armed_))) {
      state.heartbeat_stamp = now_;
      state.mode = true_mode_;
      state.armed = true_armed_;
      state.intended_mode = tells_intention_ ? intended_ : FlightMode::kUnknown;
      state.failsafe = failsafe_;
      told_ = {true_mode_, true_armed_};
    }
    if (link_up_ && positions_) state.motion.stamp = state.motion.received = now_;
    if (tracks_) {
      bridge::tracking::TrackMessage message{{1, now_, 0.0}, obstacles_};
      source_.messages.push_back(std::move(message));
    }
    const bool taken_over = told_of_takeover();
    const std::size_t sent = link_.sent.size();
    const std::size_t asked = link_.requests.size();
    const bool on = companion_.step(now_);
    ++turns_;
    if (taken_over && flew_) taken_ = true;
    flew_ = companion_.supervisor().flight_began().has_value();
    require(!taken_ || (link_.sent.size() == sent && link_.requests.size() == asked),
            "setpoints or commands after a take-over");
    for (std::size_t i = asked; i < link_.requests.size(); ++i) check_request(link_.requests[i]);
    for (std::size_t i = sent; i < link_.sent.size(); ++i) check_setpoint(link_.sent[i]);
    if (!on) check_end();
    obey(asked);
    take_setpoint(sent);
    for (double left = dt; left > 1e-9; left -= kStep) fly(std::min(left, kStep));
    if (link_.sent.size() > 4096) link_.sent.clear();
    return on;
  }

  void event(std::uint8_t what, std::uint8_t how) {
    auto& state = link_.telemetry;
    const bool on = (how & 1U) != 0U;
    switch (what % 26U) {
      case 0:
        link_up_ = on;
        break;
      case 1:
        positions_ = on;
        break;
      case 2:
        tracks_ = on;
        break;
      case 3: {
        planner::base::Track track;
        track.id = how;
        track.radius = 0.3 + 0.1 * (how % 8U);
        track.position = state.motion.value.position + Vec3(how % 5U - 2.0, (how >> 3U) % 5U - 2.0, 0.0);
        track.velocity = {0.5 * ((how >> 5U) - 3.0), 0.0, 0.0};
        obstacles_.assign(1, track);
        break;
      }
      case 4:
        obstacles_.clear();
        break;
      case 5: {  // a pilot
        const std::array<FlightMode, 4> modes{FlightMode::kPosition, FlightMode::kAltitude, FlightMode::kManual,
                                              FlightMode::kMission};
        true_mode_ = intended_ = modes[how % 4U];
        failsafe_ = false;
        break;
      }
      case 6: {  // the autopilot's failsafe
        const std::array<FlightMode, 4> modes{FlightMode::kAltitude, FlightMode::kLand, FlightMode::kReturn,
                                              FlightMode::kHold};
        failsafe_ = true;
        true_mode_ = modes[how % 4U];
        break;
      }
      case 7:
        if (failsafe_) true_mode_ = intended_;
        failsafe_ = false;
        break;
      case 8:
        state.battery = static_cast<bridge::vehicle::BatteryState>(how % 4U);
        break;
      case 9:
        state.gps_lost = on;
        break;
      case 10:
        state.local_position_ok = on;
        break;
      case 11:
        state.remote_control = on;
        break;
      case 12:
        (void)turn(0.02 * how);  // the process stalls
        break;
      case 13:
        obeys_ = on;
        break;
      case 14:
        if (!link_.requests.empty()) link_.reports.push_back({link_.requests.back(), on, on ? "" : "denied"});
        break;
      case 15:
        link_.works = on;
        break;
      case 16:
        planner_.silent = on;
        break;
      case 17:
        wind_.setZero();
        break;
      case 18:
        planner_.throws = on && how > 200;
        break;
      case 19: {
        const Vec3 jump(0.02 * (how % 16U - 8.0), 0.02 * ((how >> 4U) - 8.0), 0.0);
        ++state.estimate_resets;
        state.estimate_shift += jump;
        state.motion.value.position += jump;
        break;
      }
      case 20:
        if (how > 250) ++state.reboots;
        break;
      case 21:
        companion_.interrupt(now_);
        break;
      case 22:
        true_armed_ = on;
        break;
      case 23:
        state.in_air = on;
        break;
      case 24:
        tells_intention_ = on;
        break;
      default:
        wind_ = Vec3(0.3 * (how % 16U - 8.0), 0.3 * ((how >> 4U) - 8.0), 0.0);
        break;
    }
  }

  [[nodiscard]] std::uint64_t turns() const { return turns_; }

 private:
  // By its own word the autopilot is in a mode that only a pilot can have chosen.
  [[nodiscard]] bool told_of_takeover() const {
    const auto& state = link_.telemetry;
    const FlightMode mode = state.intended_mode;
    const bool pilots = mode == FlightMode::kPosition || mode == FlightMode::kAltitude || mode == FlightMode::kManual ||
                        mode == FlightMode::kMission;
    return pilots && state.mode == mode;
  }

  void check_request(Command command) const {
    const auto& state = link_.telemetry;
    require(now_ - state.heartbeat_stamp <= kFreshHeartbeat + 1e-9, "a command on an old heartbeat");
    if (command == Command::kArm) {
      require(!state.armed && !state.in_air && state.mode == FlightMode::kOffboard && state.armable,
              "arming where nobody waits for it");
      require(companion_.supervisor().phase() == bridge::supervisor::Phase::kEngaging, "arming unasked");
    }
    require(command != Command::kDisarm, "disarming");
  }

  void check_setpoint(const bridge::vehicle::Setpoint& setpoint) const {
    const auto& limits = mission_.vehicle;
    require(setpoint.position.allFinite() && setpoint.velocity.allFinite() && setpoint.acceleration.allFinite() &&
                std::isfinite(setpoint.yaw),
            "a setpoint that is not finite");
    // What is outside, or will be before it can stop, is asked to be no farther outside; the reference may be beside
    // the vehicle, which the wind holds there.
    const Vec3& p = link_.telemetry.motion.value.position;
    const planner::base::Box& fence = mission_.geofence;
    const bool known = link_.telemetry.motion.silence(now_) <= 0.2;
    for (Eigen::Index axis = 0; axis < 3 && known; ++axis) {
      const double beyond =
          std::max(fence.min[axis] - setpoint.position[axis], setpoint.position[axis] - fence.max[axis]);
      const double own = std::max(fence.min[axis] - p[axis], p[axis] - fence.max[axis]);
      const double stops = std::max(0.0, own + fastest_ * fastest_ / (2.0 * kBraking));
      require(beyond <= stops + kLost + kTolerance, "a setpoint outside of the geofence");
    }
    require(setpoint.position.z() >= std::min(0.0, p.z()) - kTolerance, "a setpoint under the ground");
    // A stop begins at the vehicle's own velocity, which the wind may have made.
    const double fastest = std::max(limits.max_speed, fastest_);
    require(setpoint.velocity.norm() <= fastest + kVelocityTolerance, "a setpoint beyond the speed");
    require(setpoint.acceleration.norm() <= 2.0 * limits.max_acceleration + kMostDrag * fastest,
            "a setpoint beyond the acceleration");
  }

  void check_end() const {
    const auto& state = link_.telemetry;
    const bool ours = state.mode == FlightMode::kOffboard && state.armed && state.in_air;
    if (!flew_ || !ours || now_ - state.heartbeat_stamp > kFreshHeartbeat) return;
    const auto ends = [](Command c) { return c == Command::kHold || c == Command::kLand || c == Command::kReturn; };
    require(std::any_of(link_.requests.begin(), link_.requests.end(), ends), "left in OFFBOARD without a word");
  }

  void obey(std::size_t from) {
    for (std::size_t i = from; i < link_.requests.size() && obeys_ && link_up_; ++i) {
      const Command command = link_.requests[i];
      if (command == Command::kArm) true_armed_ = true;
      if (command == Command::kOffboard) true_mode_ = intended_ = FlightMode::kOffboard;
      if (command == Command::kHold) true_mode_ = intended_ = FlightMode::kHold;
      if (command == Command::kLand) true_mode_ = intended_ = FlightMode::kLand;
      if (command == Command::kReturn) true_mode_ = intended_ = FlightMode::kReturn;
    }
  }

  void take_setpoint(std::size_t from) {
    if (link_.sent.size() == from || true_mode_ != FlightMode::kOffboard || !true_armed_) return;
    target_ = link_.sent.back();
    if (target_.position.z() > 0.2) link_.telemetry.in_air = true;
  }

  void fly(double dt) {
    auto& state = link_.telemetry;
    auto& motion = state.motion.value;
    if (true_mode_ != FlightMode::kOffboard) {  // stands still, or sinks
      target_ = {motion.position, Vec3::Zero(), Vec3::Zero(), 0.0};
      if (true_mode_ == FlightMode::kLand || true_mode_ == FlightMode::kAltitude) target_.velocity.z() = -0.7;
    }
    if (!state.in_air || !true_armed_) return;
    // PX4's cascade: from position to velocity to acceleration, and what the air does.
    const Vec3 wanted = target_.velocity + 0.95 * (target_.position - motion.position);
    Vec3 acceleration = target_.acceleration + 1.8 * (wanted - motion.velocity);
    acceleration *= std::min(1.0, kHardest / std::max(kHardest, acceleration.norm()));
    acceleration += wind_;
    motion.position += dt * motion.velocity + 0.5 * dt * dt * acceleration;
    motion.velocity += dt * acceleration;
    fastest_ = std::max(0.995 * fastest_, motion.velocity.norm());
    if (motion.position.z() > 0.0) return;
    motion.position.z() = 0.0;
    motion.velocity.setZero();
    if (true_mode_ != FlightMode::kOffboard) state.in_air = true_armed_ = false;
  }

  static constexpr double kHardest = 8.0;  // m/s²
  static constexpr double kStep = 0.02;    // s

  config::Mission mission_;
  bridge::testing::FakeLink link_;
  bridge::testing::FakeTracks source_;
  bridge::testing::SmallPlanner planner_{0.04};
  bridge::companion::Companion companion_;
  double now_ = 10.0;
  bool link_up_ = true, positions_ = true, tracks_ = true, obeys_ = true, failsafe_ = false, tells_intention_ = true;
  FlightMode true_mode_ = FlightMode::kHold, intended_ = FlightMode::kHold;
  bool true_armed_ = false;
  std::pair<FlightMode, bool> told_{FlightMode::kUnknown, false};
  std::vector<planner::base::Track> obstacles_;
  bridge::vehicle::Setpoint target_;
  Vec3 wind_ = Vec3::Zero();  // m/s², that it makes
  double fastest_ = 0.0;      // m/s, of the vehicle, lately
  bool flew_ = false, taken_ = false;
  std::uint64_t turns_ = 0;
};

/// Says at the end how many turns of the loop that were.
struct Tally {
  std::uint64_t turns = 0;
  ~Tally() { std::fprintf(stderr, "%llu turns of the loop\n", static_cast<unsigned long long>(turns)); }
};
Tally tally;

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMostEvents = 400;
  fuzz::Input input(data, size);
  World world(input.byte());
  bool on = true;
  for (std::size_t i = 0; i < kMostEvents && on && !input.empty(); ++i) {
    const std::uint8_t what = input.byte();
    const std::uint8_t how = input.byte();
    world.event(what, how);
    const int turns = 1 + (what / 26U) * 12;  // some events in a row, others with seconds between
    for (int k = 0; k < turns && on; ++k) on = world.turn(0.02);
  }
  for (int k = 0; k < 200 && on; ++k) on = world.turn(0.02);
  tally.turns += world.turns();
  return 0;
}
