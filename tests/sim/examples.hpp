// SPDX-License-Identifier: BSD-3-Clause
// Pieces of scenarios that the simulator's tests put together.
#pragma once

#include <optional>

#include "config/faults.hpp"
#include "config/scenario.hpp"

namespace jink::sim {

inline config::Obstacle ball(double radius, const Vec3& position, const Vec3& velocity = Vec3::Zero(),
                             const Vec3& acceleration = Vec3::Zero()) {
  return {config::SphereShape{radius}, config::LinearMotion{position, velocity, acceleration}};
}

inline config::Fault fault(config::FaultKind kind, double at, std::optional<double> duration = std::nullopt) {
  config::Fault f;
  f.kind = kind;
  f.at = at;
  f.duration = duration;
  return f;
}

}  // namespace jink::sim
