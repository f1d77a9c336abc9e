// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/setpoints/vehicle_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "sim/vehicle/vehicle_model.hpp"
#include "tests/sim/vehicle/px4_flights.hpp"

namespace jink::bridge::setpoints {
namespace {

namespace px4 = sim::vehicle::px4;

vehicle::Setpoint sent(const sim::vehicle::Setpoint& setpoint) {
  return {setpoint.position, setpoint.velocity, setpoint.acceleration, 0.0};
}

/// Mean square of a velocity's error, m²/s², on the level and in height.
struct Errors {
  double level = 0.0, height = 0.0;
  int count = 0;
  void add(const Vec3& error) {
    level += error.head<2>().squaredNorm();
    height += error.z() * error.z();
    ++count;
  }
  [[nodiscard]] double rms_level() const { return std::sqrt(level / count); }
  [[nodiscard]] double rms_height() const { return std::sqrt(height / count); }
};

// Recorded flights of the real PX4. As a peer: the difference to the setpoint's velocity dies down within 0.6 s.
TEST(VehicleResponse, ForeseesFlightsOfPx4) {
  constexpr int kAhead = 10;  // samples, 0.2 s
  for (const std::string name : {"turning-900", "cloud-905", "mader50-903", "sando50-902"}) {
    SCOPED_TRACE(name);
    const px4::Flown flown = px4::flown(name);
    const int n = static_cast<int>(flown.velocities.size());
    const auto velocity = [&](int i) { return flown.velocities[static_cast<std::size_t>(i)]; };
    const auto setpoint = [&](int i) { return sent(flown.setpoints[static_cast<std::size_t>(i)]); };
    VehicleResponse response(0.0, 0.0, 12.0);
    Errors ours, peers;
    double drag = 0.0;
    for (int i = 0; i + kAhead < n; ++i) {
      const double t = i * px4::kPeriod;
      response.sent(t, setpoint(i));
      response.observe(t, flown.track.estimate[static_cast<std::size_t>(i)], velocity(i), true);
      if (t < 3.0) continue;
      drag += response.drag();
      const auto then = response.at(t + kAhead * px4::kPeriod, [&](double later) {
        return setpoint(std::min(n - 1, static_cast<int>(std::lround(later / px4::kPeriod))));
      });
      ASSERT_TRUE(then);
      const Vec3 truth = velocity(i + kAhead);
      ours.add(then->velocity - truth);
      peers.add(setpoint(i + kAhead).velocity +
                std::exp(-kAhead * px4::kPeriod / 0.6) * (velocity(i) - setpoint(i).velocity) - truth);
    }
    EXPECT_LT(ours.rms_level(), 0.9 * peers.rms_level());
    EXPECT_LT(ours.rms_height(), 0.9 * peers.rms_height());
    EXPECT_NEAR(drag / ours.count, 1.0, 0.25);  // as its simulator has it
  }
}

/// The simulator's vehicle, to and fro along x at 2 m/s² and up to 3 m/s, against a wind.
struct Shuttle {
  Shuttle(double drag, double damping, double wind)
      : model(limits(), {0, 0, 5}, 0.0, 0.0, cascade(drag, damping)), response(0.5, 0.0, 8.0) {
    model.set_wind({wind, 0, 0});
    model.set_setpoint({Vec3(0, 0, 5), Vec3::Zero(), Vec3::Zero(), 0.0});
    model.set_motors(sim::vehicle::Motors::kFlying);
  }
  static planner::base::VehicleLimits limits() {
    planner::base::VehicleLimits limits;
    limits.mass = 1.0;
    limits.max_speed = 8.0;
    limits.max_acceleration = 9.0;
    limits.max_climb = 3.0;
    return limits;
  }
  static sim::vehicle::Cascade cascade(double drag, double damping) {
    sim::vehicle::Cascade cascade;
    cascade.drag = drag;
    cascade.horizontal.derivative_gain = damping;
    return cascade;
  }
  static vehicle::Setpoint setpoint(double t) {
    const double w = 2.0 / 3.0;
    return {{4.5 * (1.0 - std::cos(w * t)), 0, 5}, {3.0 * std::sin(w * t), 0, 0}, {2.0 * std::cos(w * t), 0, 0}, 0.0};
  }
  void fly(double seconds) {
    for (const double end = t + seconds; t < end; t += 0.02) {
      const vehicle::Setpoint next = setpoint(t);
      response.sent(t, next);
      model.set_setpoint({next.position, next.velocity, next.acceleration, 0.0});
      response.observe(t, model.motion().position, model.motion().velocity, true);
      for (int k = 0; k < 5; ++k) model.step();
    }
  }
  sim::vehicle::VehicleModel model;
  VehicleResponse response;
  double t = 0.0;
};

TEST(VehicleResponse, LearnsDragAndDamping) {
  for (const double drag : {0.3, 1.0, 1.6}) {
    for (const double damping : {0.0, 0.2, 0.4}) {
      Shuttle shuttle(drag, damping, 0.0);
      shuttle.fly(40.0);
      EXPECT_NEAR(shuttle.response.drag(), drag, 0.15) << drag << " " << damping;
      EXPECT_NEAR(shuttle.response.damping(), damping, 0.1) << drag << " " << damping;
    }
  }
}

TEST(VehicleResponse, ForeseesTheVelocityInWind) {
  Shuttle shuttle(1.0, 0.2, 3.0);
  shuttle.fly(20.0);
  Errors errors;
  for (int i = 0; i < 300; ++i) {
    const auto then = shuttle.response.at(shuttle.t + 0.18, Shuttle::setpoint);
    ASSERT_TRUE(then);
    Shuttle later = shuttle;
    later.fly(0.2);
    errors.add(then->velocity - later.model.motion().velocity);
    shuttle.fly(0.02);
  }
  EXPECT_LT(errors.rms_level(), 0.06);
}

TEST(VehicleResponse, KnowsNothingOfWhatIsFarAheadOrAfterASilence) {
  Shuttle shuttle(1.0, 0.2, 0.0);
  EXPECT_FALSE(shuttle.response.at(0.1, Shuttle::setpoint));  // nothing was measured
  shuttle.fly(2.0);
  EXPECT_TRUE(shuttle.response.at(shuttle.t + 0.5, Shuttle::setpoint));
  EXPECT_FALSE(shuttle.response.at(shuttle.t + 1.5, Shuttle::setpoint));
  EXPECT_FALSE(shuttle.response.at(shuttle.t - 0.5, Shuttle::setpoint));
  const double drag = shuttle.response.drag();
  shuttle.response.observe(shuttle.t + 1.0, {0, 0, 5}, {-8, 0, 0}, true);  // that is no acceleration
  EXPECT_EQ(shuttle.response.drag(), drag);
  shuttle.response.forget();
  EXPECT_FALSE(shuttle.response.at(shuttle.t + 1.1, Shuttle::setpoint));
}

TEST(VehicleResponse, WhatIsLearnedIsBounded) {
  for (const double jump : {9.0, -9.0}) {
    VehicleResponse response(1.0, 0.2, 8.0);
    for (int i = 0; i < 500; ++i) {
      const double t = 0.02 * i;
      response.sent(t, {{3.0 * t, 0, 5}, {3, 0, 0}, Vec3::Zero(), 0.0});
      response.observe(t, {3.0 * t, 0, 5}, {3.0 + jump * t, 0, 0}, true);  // it gets faster or slower for ever
    }
    EXPECT_TRUE(response.drag() >= 0.0 && response.drag() <= 2.0);
    EXPECT_TRUE(response.damping() >= 0.0 && response.damping() <= 0.5);
    EXPECT_LE(response.unexplained().norm(), 5.0 + 1e-9);
  }
}

}  // namespace
}  // namespace jink::bridge::setpoints
