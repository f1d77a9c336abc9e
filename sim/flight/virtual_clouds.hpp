// SPDX-License-Identifier: BSD-3-Clause
// What a vehicle's depth camera or lidar sees in virtual time, without DDS.
#pragma once

#include <cstdint>

#include "bridge/map/clouds.hpp"
#include "sim/vehicle/autopilot.hpp"
#include "sim/world/scan.hpp"

namespace jink::sim::flight {

/// Where the vehicle truly is, and how its body is turned.
[[nodiscard]] Eigen::Isometry3d body_of(const vehicle::Autopilot& autopilot);

/// Clouds in the body's frame, checked at the door as the DDS reader checks.
class VirtualClouds final : public bridge::map::CloudSource {
 public:
  /// The world outlives it, and its sensing has a scan.
  VirtualClouds(const world::World& world, std::uint64_t seed, std::uint64_t vehicle)
      : pipeline_(world, seed, vehicle) {}

  /// Goes on to `now`.
  void advance(double now, const vehicle::Autopilot& autopilot);

  bool poll(bridge::map::Cloud& cloud) override { return inbox_.poll(cloud); }
  [[nodiscard]] bridge::map::CloudSourceStatus status() const override;

 private:
  world::ScanPipeline pipeline_;
  bridge::map::CloudInbox inbox_;
};

}  // namespace jink::sim::flight
