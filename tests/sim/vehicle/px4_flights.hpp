// SPDX-License-Identifier: BSD-3-Clause
// Flights of the real PX4 (1.17, SITL with its built-in simulator, stock parameters), recorded at 50 Hz on its ground
// station's link (data/*.csv.gz): what the position controller followed, the estimate, the truth. The simulator flies
// the recorded setpoints again with other seeds.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/vehicle/estimator.hpp"
#include "sim/vehicle/vehicle_model.hpp"

namespace jink::sim::vehicle::px4 {

inline constexpr double kPeriod = 0.02;      // s, between samples
inline constexpr double kTakeoffTime = 4.5;  // s from the first setpoint: PX4's ramp is another matter
inline constexpr double kLandingHeight = 0.35;

struct Recorded {
  double t = 0.0;
  std::array<double, 9> values{};  ///< position, velocity, acceleration; for `attitude` roll, pitch, yaw (FRD in NED)
};
using Recording = std::map<std::string, std::vector<Recorded>>;

inline Recording read_recording(const std::string& name) {
  const std::string path = JINK_SOURCE_DIR "/tests/sim/vehicle/data/" + name + ".csv.gz";
  gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) throw std::runtime_error("cannot read " + path);
  Recording recording;
  std::array<char, 512> line{};
  gzgets(file, line.data(), line.size());  // the names of the columns
  while (gzgets(file, line.data(), line.size()) != nullptr) {
    std::istringstream fields(line.data());
    std::string kind;
    std::string field;
    Recorded sample;
    std::getline(fields, field, ',');
    sample.t = std::stod(field);
    std::getline(fields, kind, ',');
    for (double& value : sample.values) {
      value = std::getline(fields, field, ',') && field.size() > 2 ? std::stod(field)
                                                                   : std::numeric_limits<double>::quiet_NaN();
    }
    recording[kind].push_back(sample);
  }
  gzclose(file);
  return recording;
}

/// The values of `samples` at `t`, between the two next to it, or of the one before it.
inline std::array<double, 9> at(const std::vector<Recorded>& samples, double t, bool between) {
  auto after = std::upper_bound(samples.begin(), samples.end(), t, [](double x, const Recorded& s) { return x < s.t; });
  if (after == samples.begin()) return after->values;
  const Recorded& before = *std::prev(after);
  if (!between || after == samples.end()) return before.values;
  const double part = (t - before.t) / (after->t - before.t);
  std::array<double, 9> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    values.at(i) = before.values.at(i) + part * (after->values.at(i) - before.values.at(i));
  }
  return values;
}

inline Vec3 part(const std::array<double, 9>& values, std::size_t from) {
  return {values.at(from), values.at(from + 1), values.at(from + 2)};
}

/// Where the vehicle should be, believed to be and was.
struct Track {
  std::vector<Vec3> setpoint, estimate, truth, velocity_error;
  void add(const Vec3& should, const Vec3& believed, const Vec3& was, const Vec3& error) {
    setpoint.push_back(should);
    estimate.push_back(believed);
    truth.push_back(was);
    velocity_error.push_back(error);
  }
};

/// A recording from the end of its take-off to its landing.
struct Flown {
  Track track;
  std::vector<Setpoint> setpoints;
  Vec3 velocity = Vec3::Zero();  ///< true, at the beginning
  double height = 0.0;           ///< of the ground
};

/// PX4 tells the velocity and the acceleration that its controller asks for in all; what was fed forward is that less
/// what its gains (MPC_XY_P 0.95, MPC_Z_P 1, MPC_XY_VEL_*_ACC 1.8, 0.4, 0.2, MPC_Z_VEL_*_ACC 4, 2, 0) make of the
/// errors.
inline Flown flown(const std::string& name) {
  const Recording recording = read_recording(name);
  const std::vector<Recorded>& setpoints = recording.at("setpoint");
  const auto held = [](const Recorded& s) { return std::isfinite(s.values[0]) && std::isfinite(s.values[2]); };
  const double begin = std::find_if(setpoints.begin(), setpoints.end(), held)->t + kTakeoffTime;
  const double ground = recording.at("truth").front().values[2];
  const Vec3 position_gain(0.95, 0.95, 1.0);
  const Vec3 velocity_gain(1.8, 1.8, 4.0);
  const Vec3 integral_gain(0.4, 0.4, 2.0);
  const Vec3 derivative_gain(0.2, 0.2, 0.0);
  Flown flown;
  flown.height = ground;
  Vec3 integral = Vec3::Zero();
  Vec3 before = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  Vec3 rate = Vec3::Zero();
  for (double t = begin; t < setpoints.back().t; t += kPeriod) {
    const auto wanted = at(setpoints, t, false);
    const auto believed = at(recording.at("estimate"), t, true);
    const auto was = at(recording.at("truth"), t, true);
    if (!std::isfinite(wanted[0]) || !std::isfinite(wanted[2]) || was[2] < ground + kLandingHeight) break;
    if (flown.setpoints.empty()) flown.velocity = part(was, 3);
    const Vec3 velocity = part(believed, 3);
    const Vec3 error = part(wanted, 3) - velocity;
    if (before.allFinite()) rate += 0.4 * ((velocity - before) / kPeriod - rate);
    before = velocity;
    integral += kPeriod * integral_gain.cwiseProduct(error);
    Setpoint setpoint;
    setpoint.position = part(wanted, 0);
    setpoint.velocity = part(wanted, 3) - position_gain.cwiseProduct(part(wanted, 0) - part(believed, 0));
    setpoint.acceleration =
        part(wanted, 6) - velocity_gain.cwiseProduct(error) - integral + derivative_gain.cwiseProduct(rate);
    setpoint.yaw = std::remainder(1.5707963267948966 - at(recording.at("attitude"), t, false)[2], 6.283185307179586);
    flown.setpoints.push_back(setpoint);
    flown.track.add(part(wanted, 0), part(believed, 0), part(was, 0), part(believed, 3) - part(was, 3));
  }
  return flown;
}

/// The simulator's vehicle on the same setpoints.
inline Track fly(const Flown& flown, std::uint64_t seed) {
  planner::base::VehicleLimits limits;
  limits.mass = 1.0;
  limits.max_speed = 12.0;
  limits.max_acceleration = 20.0;
  limits.max_climb = 3.0;
  Cascade cascade;
  cascade.delay = VehicleModel::kStep;  // these setpoints have arrived
  VehicleModel model(limits, flown.track.truth.front(), flown.height, flown.setpoints.front().yaw, cascade);
  model.set_setpoint(flown.setpoints.front());
  model.set_motors(Motors::kFlying);
  Estimator estimator({.ins = true}, seed, model.motion(), true);
  Track track;
  for (const Setpoint& setpoint : flown.setpoints) {
    model.set_setpoint(setpoint);
    for (int k = 0; k < static_cast<int>(kPeriod / VehicleModel::kStep); ++k) {
      const Motion& believed = estimator.motion();
      model.set_estimate(believed.position, believed.velocity, estimator.attitude_error());
      model.step();
      estimator.step(model.motion(), 5.0, false, model.motion().position.z() - flown.height);
    }
    track.add(setpoint.position, estimator.motion().position, model.motion().position,
              estimator.motion().velocity - model.motion().velocity);
  }
  return track;
}

inline std::vector<Vec3> difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<Vec3> d(a.size());
  std::transform(a.begin(), a.end(), b.begin(), d.begin(), std::minus<>());
  return d;
}

inline const std::array<std::string, 3> kHovers = {"hover", "hover-1", "hover-3"};

}  // namespace jink::sim::vehicle::px4
