// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim/vehicle/estimator.hpp"
#include "sim/vehicle/wind.hpp"
#include "tests/sim/vehicle/autopilot_flight.hpp"

namespace jink::sim::vehicle {
namespace {

constexpr double kTimeout = 5.0;

/// Mean and standard deviation of numbers that come one by one.
struct Statistics {
  double count = 0, sum = 0, square = 0;
  void add(double x) {
    ++count;
    sum += x;
    square += x * x;
  }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double deviation() const { return std::sqrt(std::max(0.0, square / count - mean() * mean())); }
};

TEST(GaussMarkov, HasItsDeviationAndItsCorrelation) {
  GaussMarkov process(0.5, 2.0, 0.1, planner::base::RandomStream(7));
  Statistics values;
  double products = 0;
  double before = process.value().x();
  constexpr int kSteps = 200000;
  for (int i = 0; i < kSteps; ++i) {
    process.step();
    values.add(process.value().x());
    products += before * process.value().x();
    before = process.value().x();
  }
  EXPECT_NEAR(values.deviation(), 0.5, 0.02);
  EXPECT_NEAR(values.mean(), 0.0, 0.05);
  EXPECT_NEAR(products / kSteps / (0.5 * 0.5), 1.0 - 0.1 / 2.0, 0.08);
}

TEST(GaussMarkov, WithoutADeviationIsZero) {
  GaussMarkov process(0.0, 2.0, 0.1, planner::base::RandomStream(7));
  for (int i = 0; i < 100; ++i) process.step();
  EXPECT_EQ(process.value(), Vec3::Zero());
}

TEST(Wind, IsItsMeanAndItsGusts) {
  WindModel calm({.mean = {3, -1, 0}}, 1);
  for (int i = 0; i < 100; ++i) calm.step();
  EXPECT_EQ(calm.velocity(), Vec3(3, -1, 0));

  WindModel gusty({.mean = {3, -1, 0}, .gust = 1.5, .gust_time = 0.5}, 1);
  Statistics east;
  for (int i = 0; i < 250000; ++i) {
    gusty.step();
    east.add(gusty.velocity().x());
  }
  EXPECT_NEAR(east.mean(), 3.0, 0.15);
  EXPECT_NEAR(east.deviation(), 1.5, 0.1);
}

TEST(Wind, MayChange) {
  WindModel wind({.mean = {3, -1, 0}}, 1);
  wind.set_mean({0, 5, 0});
  wind.step();
  EXPECT_EQ(wind.velocity(), Vec3(0, 5, 0));
  EXPECT_THROW(wind.set_mean({0, kNan, 0}), std::invalid_argument);
}

TEST(Wind, RejectsWhatIsNoWind) {
  EXPECT_THROW(WindModel({.mean = {kNan, 0, 0}}, 1), std::invalid_argument);
  EXPECT_THROW(WindModel({.gust = -1.0}, 1), std::invalid_argument);
  EXPECT_THROW(WindModel({.gust = 1.0, .gust_time = kNan}, 1), std::invalid_argument);
}

TEST(Estimator, WithoutErrorsIsTheTruthBitByBit) {
  Motion truth;
  truth.position = {-0.0, 1.0 / 3.0, 7.1};
  truth.velocity = {1e-300, -2.2, 0.1};
  Estimator estimator({}, 1, truth);
  estimator.step(truth, kTimeout);
  EXPECT_TRUE(estimator.exact());
  EXPECT_EQ(estimator.motion().position, truth.position);
  EXPECT_TRUE(std::signbit(estimator.motion().position.x()));
  EXPECT_EQ(estimator.motion().velocity, truth.velocity);
}

TEST(Estimator, ErrsAsMuchAsItIsTold) {
  const EstimateErrors errors{.position_noise = 0.1, .velocity_noise = 0.2, .drift = 0.3, .drift_time = 5.0};
  const Motion truth;
  Estimator estimator(errors, 3, truth);
  Statistics position;
  Statistics velocity;
  for (int i = 0; i < 1000000; ++i) {
    estimator.step(truth, kTimeout);
    position.add(estimator.motion().position.y());
    velocity.add(estimator.motion().velocity.y());
  }
  EXPECT_NEAR(position.deviation(), std::hypot(0.1, 0.3), 0.03);
  EXPECT_NEAR(velocity.deviation(), 0.2, 0.02);
  EXPECT_EQ(estimator.reset_counter(), 0);
}

TEST(Estimator, JumpsForGoodAndCountsIt) {
  const Motion truth;
  Estimator estimator({}, 1, truth);
  estimator.jump({1, -2, 0.5});
  EXPECT_EQ(estimator.motion().position, Vec3(1, -2, 0.5));
  estimator.step(truth, kTimeout);
  EXPECT_EQ(estimator.motion().position, Vec3(1, -2, 0.5));
  EXPECT_EQ(estimator.reset_counter(), 1);
}

TEST(Estimator, WithoutGpsIsValidUntilTheTimeoutAndThenReset) {
  const Motion truth;
  Estimator estimator({}, 1, truth);
  estimator.set_gps(false);
  for (int i = 0; i < 1245; ++i) estimator.step(truth, kTimeout);
  EXPECT_TRUE(estimator.position_valid());
  EXPECT_GT(estimator.motion().position.head<2>().norm(), 0.0);
  EXPECT_EQ(estimator.motion().position.z(), 0.0);
  for (int i = 0; i < 10; ++i) estimator.step(truth, kTimeout);
  EXPECT_FALSE(estimator.position_valid());
  EXPECT_GT(estimator.horizontal_accuracy(), 1.0);
  estimator.set_gps(true);
  EXPECT_TRUE(estimator.position_valid());
  EXPECT_LT(estimator.motion().position.norm(), 1e-12);
  EXPECT_EQ(estimator.reset_counter(), 1);
}

TEST(Estimator, AShortGapIsForgottenWithoutAReset) {
  const Motion truth;
  Estimator estimator({}, 1, truth);
  estimator.set_gps(false);
  for (int i = 0; i < 750; ++i) estimator.step(truth, kTimeout);
  EXPECT_GT(estimator.motion().position.norm(), 0.01);
  estimator.set_gps(true);
  for (int i = 0; i < 5000; ++i) estimator.step(truth, kTimeout);
  EXPECT_EQ(estimator.motion().position, Vec3::Zero());
  EXPECT_EQ(estimator.reset_counter(), 0);
}

TEST(Estimator, RejectsErrorsThatAreNone) {
  EXPECT_THROW(Estimator({.position_noise = -0.1}, 1, Motion{}), std::invalid_argument);
  EXPECT_THROW(Estimator({.drift = kNan}, 1, Motion{}), std::invalid_argument);
}

/// OFFBOARD hover with PX4's errors, from 10 s after it began.
TEST(EstimatedFlight, HoversAsPx4DoesInItsOwnEyes) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    AutopilotOptions options = airborne_options();
    options.estimate = {.ins = true};
    options.seed = seed;
    Flight flight(options);
    const Setpoint here = position_setpoint({0, 0, 3});
    flight.run(0.1, &here);
    ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
    flight.run(10.0, &here);
    std::array<Statistics, 3> believed;
    double furthest = 0;
    flight.run_until(
        [&] {
          for (int axis = 0; axis < 3; ++axis) {
            believed.at(static_cast<std::size_t>(axis)).add(flight.autopilot.estimated_motion().position[axis]);
          }
          const Vec3 error = flight.autopilot.true_motion().position - flight.autopilot.estimated_motion().position;
          furthest = std::max(furthest, error.norm());
          return false;
        },
        60.0, &here);
    for (const Statistics& axis : believed) {
      RecordProperty("std_" + std::to_string(seed), std::to_string(axis.deviation()));
      EXPECT_GT(axis.deviation(), 0.04);
      EXPECT_LT(axis.deviation(), 0.6);
      EXPECT_NEAR(axis.mean(), axis.mean() > 1.0 ? 3.0 : 0.0, 0.3);
    }
    EXPECT_GT(furthest, 0.2);
    EXPECT_LT(furthest, 1.2);
  }
}

TEST(EstimatedFlight, TheTruthFollowsTheErrorOfTheEstimate) {
  AutopilotOptions options = airborne_options();
  options.estimate = {.drift = 0.5, .drift_time = 30.0};
  Flight flight(options);
  const Setpoint here = position_setpoint({0, 0, 3});
  flight.run(0.1, &here);
  ASSERT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
  Statistics truth;
  Statistics belief;
  flight.run(10.0, &here);
  flight.run_until(
      [&] {
        truth.add((flight.autopilot.true_motion().position - here.position).norm());
        belief.add((flight.autopilot.estimated_motion().position - here.position).norm());
        return false;
      },
      60.0, &here);
  EXPECT_GT(truth.mean(), 3.0 * belief.mean());
}

TEST(WindyFlight, TheIntegralWorksAgainstTheWind) {
  AutopilotOptions options = airborne_options();
  options.wind.mean = {3, -2, 0};
  Flight flight(options);
  flight.run(20.0);
  EXPECT_LT((flight.autopilot.true_motion().position - Vec3(0, 0, 3)).norm(), 0.1);
  // It leans into the wind: drag is 1 m/s^2 per m/s.
  const Vec3 up = flight.autopilot.true_motion().attitude * Vec3::UnitZ();
  EXPECT_NEAR(up.x() / up.z(), -3.0 / kGravity, 0.02);
  EXPECT_NEAR(up.y() / up.z(), 2.0 / kGravity, 0.02);
}

TEST(WindyFlight, GustsMoveItAndItStaysNear) {
  AutopilotOptions options = airborne_options();
  options.wind = {.mean = {2, 0, 0}, .gust = 1.0, .gust_time = 2.0};
  Flight flight(options);
  flight.run(10.0);
  Statistics east;
  double furthest = 0;
  flight.run_until(
      [&] {
        east.add(flight.autopilot.true_motion().position.x());
        furthest = std::max(furthest, (flight.autopilot.true_motion().position - Vec3(0, 0, 3)).norm());
        return false;
      },
      60.0);
  EXPECT_GT(east.deviation(), 0.05);
  EXPECT_LT(furthest, 2.5);
}

TEST(WindyFlight, NoWindAndNoErrorsChangeNoBitWhateverTheSeed) {
  const auto fly = [](std::uint64_t seed) {
    AutopilotOptions options = airborne_options();
    options.seed = seed;
    Flight flight(options);
    const Setpoint there = position_setpoint({7, -3, 5});
    flight.run(0.1, &there);
    EXPECT_EQ(flight.autopilot.set_mode(6), Result::kAccepted);
    flight.run(3.0, &there);
    EXPECT_EQ(flight.autopilot.true_motion().position, flight.autopilot.estimated_motion().position);
    return flight.autopilot.true_motion().position;
  };
  EXPECT_EQ(fly(1), fly(99));
}

TEST(WindyFlight, TheSameSeedGivesTheSameBitsAndAnotherOthers) {
  const auto fly = [](std::uint64_t seed) {
    AutopilotOptions options = airborne_options();
    options.wind.gust = 1.0;
    options.estimate = {.ins = true};
    options.seed = seed;
    Flight flight(options);
    flight.run(5.0);
    return flight.autopilot.true_motion().position;
  };
  EXPECT_EQ(fly(1), fly(1));
  EXPECT_NE(fly(1), fly(2));
}

TEST(WindyFlight, TakesOffAndLandsWithErrorsAndWind) {
  AutopilotOptions options = instant_options();
  options.wind = {.mean = {2, 1, 0}, .gust = 0.7};
  options.estimate = {.ins = true};
  Flight flight(options);
  ASSERT_EQ(flight.autopilot.takeoff(), Result::kAccepted);
  ASSERT_EQ(flight.autopilot.arm(), Result::kAccepted);
  flight.run(15.0);
  EXPECT_EQ(flight.autopilot.mode(), FlightMode::kHold);
  EXPECT_NEAR(flight.autopilot.true_motion().position.z(), 2.5, 1.0);
  ASSERT_EQ(flight.autopilot.land(), Result::kAccepted);
  EXPECT_LT(flight.run_until([&] { return !flight.autopilot.armed(); }, 60.0), 30.0);
  EXPECT_EQ(flight.autopilot.true_motion().position.z(), 0.0);
}

}  // namespace
}  // namespace jink::sim::vehicle
