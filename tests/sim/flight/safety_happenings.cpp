// SPDX-License-Identifier: BSD-3-Clause
#include "tests/sim/flight/safety_happenings.hpp"

#include "tests/sim/examples.hpp"

namespace jink::sim::flight::safety {
namespace {

using config::Fault;
using config::FaultKind;
using config::LinkDirection;

Fault at_once(FaultKind kind, std::optional<double> duration = std::nullopt) {
  return fault(kind, 0.0, duration);
}

Fault silence(LinkDirection direction, std::optional<double> duration = std::nullopt) {
  Fault f = at_once(FaultKind::kLinkLoss, duration);
  f.direction = direction;
  return f;
}

Fault delay(double seconds) {
  Fault f = at_once(FaultKind::kDelay);
  f.seconds = seconds;
  return f;
}

Fault battery(double remaining) {
  Fault f = at_once(FaultKind::kLowBattery);
  f.remaining = remaining;
  return f;
}

// A helicopter that hangs there.
void aircraft_comes(Flight& flight) {
  bridge::tracking::Aircraft aircraft;
  aircraft.icao_address = 0xABCDEF;
  aircraft.position = {400.0, 100.0, 40.0};
  flight.writers().front()->aircraft = aircraft;
}

// Not for want of GPS. The estimator says so; a second later (COM_POS_FS_DELAY) PX4 acts.
void position_goes(Flight& flight) {
  (void)flight.autopilot().parameters().set("EKF2_NOAID_TOUT", std::int32_t{1'000'000});
  flight.link().tells_gps = flight.link().estimates = false;
}

// Until it is lost the vehicle flies by the setpoints that it has, unseen by jink.
std::vector<Happening> of_the_link() {
  constexpr Around kAround = Around::kUnsteered;
  constexpr auto kBoth = LinkDirection::kBoth;
  return {
      {.name = "silent for 1 s", .faults = {silence(kBoth, 1.0)}, .around = kAround},
      {.name = "silent for 5 s", .faults = {silence(kBoth, 5.0)}, .around = kAround},
      {.name = "silent for 5 s, loss: hold", .faults = {silence(kBoth, 5.0)}, .around = kAround, .loss_action = 5},
      {.name = "silent for 5 s, loss: land", .faults = {silence(kBoth, 5.0)}, .around = kAround, .loss_action = 4},
      {.name = "silent for good", .faults = {silence(kBoth)}, .around = kAround, .seen = true},
      {.name = "silent from the vehicle", .faults = {silence(LinkDirection::kDown)}, .around = kAround, .seen = true},
      {.name = "silent to it", .faults = {silence(LinkDirection::kUp)}, .around = kAround, .seen = true},
      {.name = "silent to it for 4 s",
       .hazard = "the autopilot's failsafe flies",
       .faults = {silence(LinkDirection::kUp, 4.0)},
       .around = kAround},
      {.name = "0.6 s late each way",
       .hazard = "the vehicle's position comes too late",
       .faults = {delay(0.6)},
       .around = kAround,
       .seen = true},
      {.name = "no positions",
       .hazard = "the vehicle's position is stale",
       .begin = [](Flight& f) { f.link().positions = false; },
       .around = kAround,
       .seen = true},
      {.name = "no heartbeats",
       .hazard = "the autopilot's heartbeat is missing",
       .begin = [](Flight& f) { f.link().heartbeats = false; },
       .seen = true},
      {.name = "setpoints cannot be sent",
       .hazard = "setpoints cannot be sent",
       .begin = [](Flight& f) { f.link().sends = false; },
       .around = kAround,
       .seen = true},
  };
}

std::vector<Happening> of_the_tracks() {
  return {
      {.name = "no tracks for 2 s", .faults = {at_once(FaultKind::kTracksStop, 2.0)}},
      {.name = "no tracks any more",
       .hazard = "the obstacle tracks are stale",
       .faults = {at_once(FaultKind::kTracksStop)},
       .seen = true},
      {.name = "no clouds of points any more",
       .hazard = "the clouds of points are stale",
       .begin = [](Flight& f) { f.clouds().silent = true; },
       .seen = true,
       .sees = true},
      {.name = "a writer falls silent",
       .hazard = "a writer of obstacle tracks has fallen silent",
       .begin = [](Flight& f) { f.writers().back()->silent = true; },
       .seen = true,
       .takes_two = true},
      {.name = "frozen, with fresh stamps", .faults = {at_once(FaultKind::kTracksFreeze)}, .seen = true},
      {.name = "a crewed aircraft comes",
       .hazard = "a crewed aircraft comes too near",
       .begin = aircraft_comes,
       .seen = true},
  };
}

// It drifts by metres where it has lost its GPS, and further in such winds, wherever it believes to be.
std::vector<Happening> of_the_autopilot() {
  constexpr Around kAside = Around::kAside;
  return {
      {.name = "battery low", .faults = {battery(0.12)}, .seen = true},
      {.name = "battery critical", .hazard = "the battery is critical", .faults = {battery(0.06)}, .seen = true},
      {.name = "GPS lost",
       .hazard = "the autopilot has lost its GPS",
       .faults = {at_once(FaultKind::kGpsLoss)},
       .around = kAside,
       .seen = true},
      {.name = "position lost",
       .hazard = "the autopilot has lost its position",
       .faults = {at_once(FaultKind::kGpsLoss)},
       .begin = position_goes,
       .around = kAside,
       .seen = true},
      {.name = "the estimate jumps 1.6 m",
       .begin =
           [](Flight& f) {
             f.jump({0.5, 1.5, 0.3});
           },
       .around = kAside},
      {.name = "blown out of the fence",
       .hazard = "the vehicle has left the geofence",
       .begin =
           [](Flight& f) {
             f.blow({0.0, 12.0, 0.0}, 12.0);
           },
       .around = kAside},
      {.name = "blown up, out of it",
       .hazard = "the vehicle is above the geofence",
       .begin =
           [](Flight& f) {
             f.blow({0.0, 0.0, 9.7}, 25.0);
           },
       .around = kAside},
      {.name = "blown back",
       .hazard = "the vehicle cannot follow its setpoints",
       .begin =
           [](Flight& f) {
             f.blow({-7.0, 0.0, 0.0}, 20.0);
           },
       .around = kAside},
      {.name = "it disarms",
       .begin = [](Flight& f) { (void)f.autopilot().disarm(true); },
       .around = Around::kUnsteered,
       .falls = true},
      {.name = "it boots anew", .faults = {at_once(FaultKind::kReboot)}, .around = Around::kUnsteered, .falls = true},
      {.name = "it refuses to be armed", .faults = {at_once(FaultKind::kRefuseArming)}, .seen = true},
      {.name = "it refuses OFFBOARD", .faults = {at_once(FaultKind::kRefuseOffboard)}, .seen = true},
  };
}

std::vector<Happening> of_people() {
  return {
      {.name = "a pilot chooses HOLD",
       .begin = [](Flight& f) { f.pilot(vehicle::FlightMode::kHold); },
       .around = Around::kUnsteered,
       .of_pilot = true},
      {.name = "a pilot chooses POSITION",
       .begin = [](Flight& f) { f.pilot(vehicle::FlightMode::kPosition); },
       .around = Around::kUnsteered,
       .of_pilot = true},
      {.name = "Ctrl-C", .begin = [](Flight& f) { f.interrupt(); }},
      {.name = "the time limit passes", .time_limit = true},
  };
}

std::vector<Happening> of_the_program() {
  constexpr Around kAround = Around::kUnsteered;
  return {
      {.name = "stalls for 0.5 s", .begin = [](Flight& f) { f.stall(0.5); }, .around = kAround},
      {.name = "stalls for 2 s", .begin = [](Flight& f) { f.stall(2.0); }, .around = kAround},
      {.name = "killed, started at once", .begin = [](Flight& f) { f.kill(0.1); }, .around = kAround},
      {.name = "killed, started in 2 s", .begin = [](Flight& f) { f.kill(2.0); }, .around = kAround},
      {.name = "killed", .begin = [](Flight& f) { f.kill({}); }, .around = kAround},
      {.name = "the planner falls silent",
       .hazard = "the planner is late",
       .begin = [](Flight& f) { f.planner().silent = true; },
       .seen = true},
      {.name = "the planner fails", .begin = [](Flight& f) { f.planner().throws = true; }, .seen = true},
  };
}

}  // namespace

const std::vector<Group>& groups() {
  static const std::vector<Group> kGroups = {{"The link", of_the_link()},
                                             {"The tracks", of_the_tracks()},
                                             {"The autopilot and the air", of_the_autopilot()},
                                             {"People", of_people()},
                                             {"jink itself", of_the_program()}};
  return kGroups;
}

}  // namespace jink::sim::flight::safety
