// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flight/virtual_clouds.hpp"

#include <utility>

namespace jink::sim::flight {

Eigen::Isometry3d body_of(const vehicle::Autopilot& autopilot) {
  const vehicle::Motion& motion = autopilot.true_motion();
  return Eigen::Translation3d(motion.position) * motion.attitude;
}

void VirtualClouds::advance(double now, const vehicle::Autopilot& autopilot) {
  pipeline_.step(now, body_of(autopilot));
  world::ScanMessage seen;
  while (pipeline_.poll(now, seen)) {
    bridge::map::Cloud cloud;
    cloud.writer = 1;
    cloud.received = now;
    cloud.stamp_age = now - seen.stamp;
    cloud.points = std::move(seen.points);
    inbox_.put(std::move(cloud));
  }
}

bridge::map::CloudSourceStatus VirtualClouds::status() const {
  bridge::map::CloudSourceStatus status = inbox_.status();
  status.writers = 1;
  return status;
}

}  // namespace jink::sim::flight
