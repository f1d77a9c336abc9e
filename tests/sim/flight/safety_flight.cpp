// SPDX-License-Identifier: BSD-3-Clause
#include "tests/sim/flight/safety_flight.hpp"

#include <algorithm>
#include <utility>

#include "sim/faults/vehicle_faults.hpp"

namespace jink::sim::flight::safety {
namespace {

using bridge::supervisor::Phase;

constexpr int kStepsPerTurn = 5;    // 20 ms
constexpr double kTracksHz = 10.0;  // what learns from tracks is most of the cost
constexpr double kReady = 6.0;      // s, from when on the autopilot may be armed
// s, from the climb's beginning, from which the time limit counts.
constexpr double kClimb = 5.6, kToTarget = kClimb + 6.8, kToLanding = kClimb + 8.2;
constexpr double kPlansFrom = 7.0 + kClimb;  // s, about when plans are flown
constexpr double kAtSpeed = 1.0;             // s later, when it flies at its cruise speed
constexpr double kLeast = 0.01;              // s, of a time limit
constexpr double kPlanTakes = 0.02;          // s

config::Mission mission_of(const Happening& what, const Cell& cell) {
  config::Mission m;
  m.name = "safety";
  m.connection = "virtual time";
  m.system_id = 1;
  m.takeoff_height = 3.0;
  m.min_height = 1.0;
  m.waypoints = {{12, 0, 3}};
  m.arrival = cell.phase == Phase::kHandover ? config::Arrival::kHold : config::Arrival::kLand;
  m.geofence = {{-6, -6, 0}, {18, 6, 8}};
  m.time_limit = 60.0;
  if (what.sees) m.cloud.emplace().all_round = true;
  if (!what.time_limit) return m;
  m.time_limit = cell.moment + kLeast;
  if (cell.phase == Phase::kFlying) m.time_limit += kClimb;
  if (cell.phase == Phase::kStopping) m.time_limit += kClimb + kAtSpeed;
  if (cell.phase == Phase::kHandover) m.time_limit += kToTarget;
  if (cell.phase == Phase::kLanding) m.time_limit += kToLanding;
  return m;
}

config::Obstacle ball(double radius, const Vec3& position, const Vec3& velocity = Vec3::Zero()) {
  return {config::SphereShape{radius}, config::LinearMotion{position, velocity, Vec3::Zero()}};
}

// That crosses the way there, so long after plans are flown: about when the vehicle would be there, too.
config::Obstacle crossing(double x, double later) {
  const Vec3 velocity(0, 1.6, 0);
  return ball(0.4, Vec3(x, 0, 3) - (kPlansFrom + later) * velocity, velocity);
}

config::Scenario scenario_of(Around around) {
  config::Scenario scenario;
  scenario.name = "safety";
  scenario.sensing.rate = kTracksHz;
  if (around == Around::kMet) scenario.obstacles = {crossing(7.0, 2.8), ball(0.5, {4.0, 0.6, 3.0})};
  if (around == Around::kUnsteered) scenario.obstacles = {crossing(9.0, 3.5), ball(0.5, {4.0, 2.4, 3.0})};
  if (around == Around::kAside) scenario.obstacles = {crossing(60.0, 0.0), ball(0.5, {6.0, -60.0, 3.0})};
  return scenario;
}

vehicle::AutopilotOptions autopilot_of(const Cell& cell) {
  vehicle::AutopilotOptions options;
  options.ready_delay = kReady;
  options.remote_control = cell.transmitter;
  return options;
}

}  // namespace

bool Writer::poll(bridge::tracking::TrackMessage& message) {
  while (tracks.poll(message)) {
    if (silent) continue;
    message.writer = identity_;
    if (aircraft) message.aircraft = {*aircraft};
    for (bridge::tracking::Aircraft& each : message.aircraft) each.stamp = message.received;
    return true;
  }
  return false;
}

class Flight::Observer final : public bridge::companion::FlightObserver {
 public:
  explicit Observer(Flight& flight) : flight_(flight) {}
  void on_event(double t, std::string_view name, const std::string& detail) override {
    if (flight_.began_) flight_.events_.push_back({t, std::string(name), detail});
  }

 private:
  Flight& flight_;
};

Flight::Flight(const Happening& what, const Cell& cell)
    : what_(what),
      cell_(cell),
      mission_(mission_of(what, cell)),
      world_(scenario_of(what.around)),
      timeline_(what.faults),
      autopilot_(autopilot_of(cell)),
      virtual_link_(autopilot_, 1),
      wire_(virtual_link_, mission_),
      observer_(std::make_unique<Observer>(*this)) {
  if (what.loss_action) (void)autopilot_.parameters().set("COM_OBL_RC_ACT", std::int32_t{*what.loss_action});
  wire_.tells_modes = cell.tells_modes;
  for (int i = 1; i <= cell.writers; ++i) {
    writers_.push_back(std::make_unique<Writer>(world_, timeline_, static_cast<std::uint64_t>(i)));
    sources_.add(*writers_.back());
  }
  start_companion();
}

// Ten times a second, farther than it is believed.
bool Clouds::poll(bridge::map::Cloud& cloud) {
  if (silent || now_ < next_) return false;
  next_ = now_ + 0.1;
  cloud = {};
  cloud.received = now_;
  cloud.points = {{30.0F, 0.0F, 0.0F}};
  return true;
}

Flight::~Flight() = default;

void Flight::start_companion() {
  companion_.reset();
  planner_ = std::make_unique<bridge::testing::SmallPlanner>(kPlanTakes);
  companion_ = std::make_unique<bridge::companion::Companion>(
      mission_, settings_,
      bridge::companion::CompanionParts{wire_, sources_, *planner_, {observer_.get()}, nullptr, nullptr, &clouds_});
}

void Flight::kill(std::optional<double> pause) {
  start_companion();
  wire_.begin_anew();
  if (pause) return stall(*pause);
  killed_for_good_ = over_ = true;
  ended_at_ = now();
}

// What is chosen while jink waits is what it finds, and the mode in which it believes the vehicle is no news.
void Flight::pilot(vehicle::FlightMode mode) {
  using bridge::vehicle::FlightMode;
  const FlightMode chosen = mode == vehicle::FlightMode::kHold ? FlightMode::kHold : FlightMode::kPosition;
  const bool accepted = autopilot_.pilot_mode(mode) == vehicle::Result::kAccepted;
  const bool waits = companion_->supervisor().phase() == Phase::kWaiting;
  if (accepted && !waits && wire_.told().mode != chosen) wire_.pilot_chose(chosen);
}

void Flight::jump(const Vec3& by) {
  autopilot_.jump_estimate(by);
  virtual_link_.note_reset(by);
}

void Flight::blow(const Vec3& wind, double seconds) {
  autopilot_.set_wind(wind);
  calm_at_ = now() + seconds;
  wire_.steers = false;
}

void Flight::run() {
  while (now() < began_.value_or(now()) + kLongest && now() < 2.0 * kLongest && !done()) step();
  judge_afterwards();
}

void Flight::step() {
  befall();
  virtual_link_.advance(now());
  watch();
  const world::VehicleTruth truth{autopilot_.true_motion().position, autopilot_.true_motion().velocity};
  for (const auto& writer : writers_) writer->tracks.advance(now(), truth);
  clouds_.advance(now());
  if (steps_ % kStepsPerTurn == 0) turn();
  autopilot_.step();
  ++steps_;
}

// A stop begins by Ctrl-C, at cruise speed.
void Flight::befall() {
  const auto in = [&](Phase phase) { return companion_->supervisor().phase() == phase; };
  if (!flying_since_ && in(Phase::kFlying)) flying_since_ = now();
  const bool stops = cell_.phase == Phase::kStopping && in(Phase::kFlying) && !phase_since_;
  if (stops && now() >= *flying_since_ + kAtSpeed - 1e-9) interrupt();
  if (!phase_since_ && in(cell_.phase)) phase_since_ = now();
  if (!began_ && in(cell_.phase) && now() >= *phase_since_ + cell_.moment - 1e-9) {
    began_ = now();
    if (what_.begin != nullptr) what_.begin(*this);
  }
  if (!began_) return;
  if (now() >= calm_at_) autopilot_.set_wind(Vec3::Zero());
  const auto changes = timeline_.advance(now() - *began_);
  for (const faults::FaultChange& change : changes) {
    const auto resets = autopilot_.estimator().reset_counter();
    const int reboots = autopilot_.reboots();
    const Vec3 before = autopilot_.estimated_motion().position;
    faults::apply(timeline_, change, 0, autopilot_);
    if (autopilot_.reboots() == reboots && autopilot_.estimator().reset_counter() != resets)
      virtual_link_.note_reset(autopilot_.estimated_motion().position - before);
  }
  if (!changes.empty()) virtual_link_.impair(timeline_.link(0));
}

void Flight::turn() {
  virtual_link_.send_telemetry();
  wire_.listen(now());
  if (over_ || now() < idle_until_ - 1e-9) return;
  over_ = !companion_->step(now());
  judge_turn();
  if (!over_) return;
  ended_at_ = now();
  judge_end();
}

}  // namespace jink::sim::flight::safety
