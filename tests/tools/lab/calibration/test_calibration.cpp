// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/calibration/calibration.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "sim/families/families.hpp"
#include "sim/families/recorded.hpp"

namespace jink::tools::lab::calibration {
namespace {

constexpr double kOff = 0.03;
constexpr double kOffOfFew = 0.07;  // a dozen movers, most of them seen again and again

Calibration watch_realistic(config::Scenario scenario, std::uint64_t seed) {
  set_tier(scenario, sim::families::Tier::kRealistic, seed);
  return watch(scenario, seed);
}

void expect_true(const Calibration& calibration, double off) {
  for (std::size_t i = 0; i < kLeads.size(); ++i) {
    for (std::size_t k = 0; k < kRegions.size(); ++k)
      EXPECT_NEAR(calibration.leads[i].share(k), kRegions[k], off)
          << kLeads[i] << " s ahead, of " << calibration.predictions();
  }
}

TEST(Calibration, MoversOfAllFamiliesAreInTheRegionsAsOftenAsIsStated) {
  Calibration all;
  for (const std::string_view family : sim::families::world_families()) {
    for (const std::uint64_t seed : {101U, 102U, 103U, 104U})
      all.add(watch_realistic(sim::families::make_world(family, seed), seed));
  }
  EXPECT_GT(all.predictions(), 40000.0);
  expect_true(all, kOff);
}

TEST(Calibration, SoAreRecordedOnes) {
  const auto recording =
      sim::recorded::load_recording(std::filesystem::path(JINK_SOURCE_DIR) / "config/recordings/square.csv");
  Calibration all;
  for (std::uint64_t seed = 101; seed < 109; ++seed)
    all.add(watch_realistic(sim::families::make_recorded_world(recording, seed), seed));
  EXPECT_GT(all.predictions(), 1000.0);
  expect_true(all, kOffOfFew);
}

}  // namespace
}  // namespace jink::tools::lab::calibration
