// SPDX-License-Identifier: BSD-3-Clause
#include "sim/faults/vehicle_faults.hpp"

#include "planner/base/random.hpp"

namespace jink::sim::faults {
namespace {

using config::FaultKind;
using config::PilotMode;

// A name of its own among the streams of a seed.
constexpr std::uint64_t kVehicleStream = 0x76656869636c65ULL;

vehicle::FlightMode flight_mode(PilotMode mode) {
  switch (mode) {
    case PilotMode::kHold:
      return vehicle::FlightMode::kHold;
    case PilotMode::kPosition:
      return vehicle::FlightMode::kPosition;
    case PilotMode::kAltitude:
      return vehicle::FlightMode::kAltitude;
    case PilotMode::kLand:
      return vehicle::FlightMode::kLand;
    case PilotMode::kReturn:
      return vehicle::FlightMode::kReturn;
    case PilotMode::kManual:
      return vehicle::FlightMode::kManual;
  }
  return vehicle::FlightMode::kHold;
}

}  // namespace

world::EstimateError estimate_error(const vehicle::Autopilot& autopilot) {
  const vehicle::Motion& estimated = autopilot.estimated_motion();
  const vehicle::Motion& truth = autopilot.true_motion();
  return {estimated.position - truth.position, estimated.velocity - truth.velocity};
}

void set_conditions(const config::Scenario& scenario, std::uint64_t seed, int vehicle,
                    vehicle::AutopilotOptions& options) {
  options.wind.mean = scenario.wind.mean;
  options.wind.gust = scenario.wind.gust;
  options.wind.gust_time = scenario.wind.gust_time;
  options.estimate.ins = scenario.estimate.px4;
  options.estimate.position_noise = scenario.estimate.position_noise;
  options.estimate.velocity_noise = scenario.estimate.velocity_noise;
  options.estimate.drift = scenario.estimate.drift;
  options.estimate.drift_time = scenario.estimate.drift_time;
  options.seed = planner::base::RandomStream(seed, kVehicleStream, static_cast<std::uint64_t>(vehicle)).next();
}

void apply(const FaultTimeline& timeline, const FaultChange& change, int vehicle, vehicle::Autopilot& autopilot) {
  const config::Fault& fault = timeline.faults()[change.index];
  if (!fault.befalls(vehicle)) return;
  switch (fault.kind) {
    case FaultKind::kGpsLoss:
      autopilot.set_gps(!timeline.active(fault.kind, vehicle));
      break;
    case FaultKind::kEstimateJump:
      autopilot.jump_estimate(fault.by);
      break;
    case FaultKind::kReboot:
      autopilot.reboot();
      break;
    case FaultKind::kPilotMode:
      autopilot.pilot_mode(flight_mode(fault.mode));
      break;
    case FaultKind::kLowBattery: {
      const config::Fault* low = timeline.find(fault.kind, vehicle);
      autopilot.set_battery(low != nullptr ? low->remaining : 1.0);
      break;
    }
    case FaultKind::kRefuseArming:
      autopilot.refuse_arming(timeline.active(fault.kind, vehicle));
      break;
    case FaultKind::kRefuseOffboard:
      autopilot.refuse_offboard(timeline.active(fault.kind, vehicle));
      break;
    default:
      break;
  }
}

}  // namespace jink::sim::faults
