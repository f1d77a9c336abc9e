// SPDX-License-Identifier: BSD-3-Clause
// One flight of docs/safety.md: the simulator's autopilot on the ground, the companion of `fly` with the real planner,
// one or two writers of tracks, and something that befalls them in a phase of the flight. In virtual time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/companion/companion.hpp"
#include "bridge/map/clouds.hpp"
#include "bridge/tracking/track_sources.hpp"
#include "sim/faults/fault_timeline.hpp"
#include "sim/flight/virtual_transport.hpp"
#include "sim/world/world.hpp"
#include "tests/sim/flight/safety_link.hpp"
#include "tests/support/bridge_fakes.hpp"

namespace jink::sim::flight::safety {

class Flight;

/// What is around the vehicle.
enum class Around {
  kMet,        ///< one obstacle stands beside the way, another crosses it ahead of the vehicle
  kUnsteered,  ///< the same, but not where a vehicle coasts to that nobody steers for a while
  kAside       ///< nothing is where a vehicle gets that does not know where it is, or is blown away
};

/// What befalls a flight.
struct Happening {
  std::string_view name;         ///< in docs/safety.md
  std::string_view hazard = {};  ///< the one of bridge::supervisor::hazards() that it makes, by its text; empty: none
  std::vector<config::Fault> faults = {};  ///< the simulator's; their times count from when it begins
  void (*begin)(Flight&) = nullptr;        ///< what the simulator does not do by itself
  Around around = Around::kMet;
  bool seen = false;                    ///< on the ground, by jink or the autopilot: nothing is armed then
  bool falls = false;                   ///< the motors stop in the air
  bool of_pilot = false;                ///< a pilot does it, and whatever comes of it
  bool time_limit = false;              ///< it is the mission's time limit that passes
  bool sees = false;                    ///< the mission has a `cloud`
  bool takes_two = false;               ///< its hazard is one where there are two writers
  std::optional<int> loss_action = {};  ///< the autopilot's COM_OBL_RC_ACT; none: its default
};

/// A cell of the table.
struct Cell {
  bridge::supervisor::Phase phase = bridge::supervisor::Phase::kWaiting;
  double moment = 0.0;       ///< s after the phase's beginning, at which it happens
  bool transmitter = false;  ///< a pilot's, healthy, sticks centred
  int writers = 1;           ///< of tracks
  bool tells_modes = true;   ///< the autopilot, in CURRENT_MODE, as PX4 does since 1.15
};

/// A writer of tracks with an identity of its own.
class Writer final : public bridge::tracking::TrackSource {
 public:
  Writer(const world::World& world, const faults::FaultTimeline& timeline, std::uint64_t identity)
      : tracks(world, timeline, identity), identity_(identity) {}
  bool poll(bridge::tracking::TrackMessage& message) override;
  [[nodiscard]] bridge::tracking::TrackSourceStatus status() const override { return tracks.status(); }

  VirtualTracks tracks;
  bool silent = false;
  std::optional<bridge::tracking::Aircraft> aircraft;  ///< that is told of in each message

 private:
  std::uint64_t identity_;
};

/// A lidar in empty air.
class Clouds final : public bridge::map::CloudSource {
 public:
  void advance(double now) { now_ = now; }
  bool poll(bridge::map::Cloud& cloud) override;
  [[nodiscard]] bridge::map::CloudSourceStatus status() const override { return {}; }

  bool silent = false;

 private:
  double now_ = 0.0;
  double next_ = 0.0;
};

/// Not thread-safe.
class Flight {
 public:
  /// `what` outlives it.
  Flight(const Happening& what, const Cell& cell);
  ~Flight();
  Flight(const Flight&) = delete;  // its pieces refer to each other
  Flight& operator=(const Flight&) = delete;

  /// Until the companion is done, and kAfter longer.
  void run();

  // What befalls it.
  vehicle::Autopilot& autopilot() { return autopilot_; }
  Link& link() { return wire_; }
  bridge::testing::SmallPlanner& planner() { return *planner_; }
  std::vector<std::unique_ptr<Writer>>& writers() { return writers_; }
  Clouds& clouds() { return clouds_; }
  [[nodiscard]] double now() const { return autopilot_.time(); }
  void interrupt() { companion_->interrupt(now()); }
  void pilot(vehicle::FlightMode mode);
  void jump(const Vec3& by);
  /// Wind of that velocity, and calm again later.
  void blow(const Vec3& wind, double seconds);
  /// The companion does not run for so long.
  void stall(double seconds) { idle_until_ = now() + seconds; }
  /// It is gone, and another one is started so much later; none: none is.
  void kill(std::optional<double> pause);

  // What has become of it.
  struct Event {
    double t;
    std::string name, detail;
  };
  /// What the companions said since it began.
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  [[nodiscard]] const bridge::companion::Companion& companion() const { return *companion_; }
  [[nodiscard]] const vehicle::Autopilot& autopilot() const { return autopilot_; }
  /// When it began; none: the flight never came there.
  [[nodiscard]] std::optional<double> began() const { return began_; }
  [[nodiscard]] bool killed_for_good() const { return killed_for_good_; }
  [[nodiscard]] bool ever_armed() const { return ever_armed_; }
  [[nodiscard]] bool ever_flew() const { return ever_flew_; }
  [[nodiscard]] bool fell() const { return fell_from_ > 0.0; }
  /// The mode in which the motors ran last: the autopilot's own failsafe's, or one that was asked for.
  struct LastMode {
    vehicle::FlightMode mode{}, intended{};
  };
  [[nodiscard]] const LastMode& last_mode() const { return last_mode_; }
  /// What must not have been, in words; empty: all is well.
  [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

  static constexpr double kAfter = 20.0;     // s
  static constexpr double kLongest = 120.0;  // s, from when it began until the companion is done

 private:
  class Observer;
  void start_companion();
  void step();
  void befall();
  void turn();
  // Judging.
  void watch();
  void judge_turn();
  void judge_end();
  void judge_afterwards();
  void fault(const std::string& what);
  [[nodiscard]] bool link_works() const;
  [[nodiscard]] bool done() const { return over_ && now() - ended_at_ > kAfter; }

  const Happening& what_;
  const Cell cell_;
  const config::Mission mission_;
  const config::Settings settings_;
  const world::World world_;
  faults::FaultTimeline timeline_;
  vehicle::Autopilot autopilot_;
  VirtualLink virtual_link_;
  Link wire_;
  std::vector<std::unique_ptr<Writer>> writers_;
  Clouds clouds_;
  bridge::tracking::TrackSources sources_;
  std::unique_ptr<Observer> observer_;
  std::unique_ptr<bridge::testing::SmallPlanner> planner_;
  std::unique_ptr<bridge::companion::Companion> companion_;
  long steps_ = 0;
  std::optional<double> flying_since_, phase_since_, began_;
  double idle_until_ = 0.0;
  double calm_at_ = planner::base::kInfinity;
  bool killed_for_good_ = false;
  bool over_ = false;
  double ended_at_ = 0.0;
  Vec3 last_position_ = Vec3::Zero();
  LastMode last_mode_;
  bool was_armed_ = false, ever_armed_ = false, ever_flew_ = false, was_at_target_ = false, hit_ = false;
  double fell_from_ = 0.0;  // m, when the motors stopped in the air
  std::vector<Event> events_;
  std::vector<std::string> faults_;
};

}  // namespace jink::sim::flight::safety
