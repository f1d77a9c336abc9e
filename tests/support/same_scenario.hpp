// SPDX-License-Identifier: BSD-3-Clause
// Whether two scenarios are the same in every number, for tests that write and read them.
#pragma once

#include <gtest/gtest.h>

#include "config/scenario.hpp"

namespace jink::testing_support {

inline void expect_same(const planner::base::VehicleLimits& a, const planner::base::VehicleLimits& b) {
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.length, b.length);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.max_speed, b.max_speed);
  EXPECT_EQ(a.cruise_speed, b.cruise_speed);
  EXPECT_EQ(a.max_acceleration, b.max_acceleration);
  EXPECT_EQ(a.max_jerk, b.max_jerk);
  EXPECT_EQ(a.max_climb, b.max_climb);
}

inline void expect_same(const config::ScenarioVehicle& a, const config::ScenarioVehicle& b) {
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.target, b.target);
  EXPECT_EQ(a.vehicle_name, b.vehicle_name);
  expect_same(a.vehicle, b.vehicle);
}

inline void expect_same(const config::Scenario& a, const config::Scenario& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.acceptance_radius, b.acceptance_radius);
  EXPECT_EQ(a.time_limit, b.time_limit);
  ASSERT_EQ(a.world.has_value(), b.world.has_value());
  if (a.world) {
    EXPECT_EQ(a.world->min, b.world->min);
    EXPECT_EQ(a.world->max, b.world->max);
  }
  EXPECT_EQ(a.sensing, b.sensing);
  EXPECT_EQ(a.wind, b.wind);
  EXPECT_EQ(a.estimate, b.estimate);
  EXPECT_EQ(a.obstacles, b.obstacles);
  EXPECT_EQ(a.map, b.map);
  EXPECT_EQ(a.faults, b.faults);
  const auto all_a = config::all_vehicles(a);
  const auto all_b = config::all_vehicles(b);
  ASSERT_EQ(all_a.size(), all_b.size());
  for (std::size_t k = 0; k < all_a.size(); ++k) expect_same(all_a[k], all_b[k]);
}

}  // namespace jink::testing_support
