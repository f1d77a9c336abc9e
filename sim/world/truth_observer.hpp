// SPDX-License-Identifier: BSD-3-Clause
// Who wants to know the truth of a simulation: logs, reports, tests.
#pragma once

#include <span>

#include "sim/world/world.hpp"

namespace jink::sim::world {

class TruthObserver {
 public:
  virtual ~TruthObserver() = default;
  /// Every vehicle's true motion, by number, and the world that they are in, every 20 ms of scenario time `t`.
  virtual void on_truth(double t, std::span<const VehicleTruth> vehicles, const World& world) = 0;
};

}  // namespace jink::sim::world
