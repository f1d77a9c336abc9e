// SPDX-License-Identifier: BSD-3-Clause
// The timeline of a scenario's faults: given the time, what is in force. Pure: no socket, no clock, nothing at random.
// Who does what they say: sim/faults/track_faults (tracks), sim/faults/vehicle_faults (autopilot),
// sim/faults/link_faults (link).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "config/faults.hpp"
#include "sim/faults/link_faults.hpp"

namespace jink::sim::faults {

/// A fault begins or ends. One that happens at once only begins.
struct FaultChange {
  std::size_t index = 0;  ///< in the scenario's list
  bool begins = true;
  double t = 0.0;  ///< when, scenario time
};

class FaultTimeline {
 public:
  explicit FaultTimeline(std::vector<config::Fault> faults);

  /// Goes on to scenario time `t`, which never decreases, and returns what has begun and ended since the last call, by
  /// time; at the same time ends come first, then the list's order counts. A fault is in force in [at, at + for).
  std::vector<FaultChange> advance(double t);

  [[nodiscard]] std::span<const config::Fault> faults() const { return faults_; }
  /// "packet_loss, rate 0.2 begins"; at once: "reboot".
  [[nodiscard]] std::string describe(const FaultChange& change) const;

  /// Whether one of that kind is in force, for the tracks that all vehicles share.
  [[nodiscard]] bool active(config::FaultKind kind) const;
  /// Whether one of that kind befalls that vehicle now.
  [[nodiscard]] bool active(config::FaultKind kind, int vehicle) const;
  /// The latest in the list of that kind that befalls that vehicle now; null: none.
  [[nodiscard]] const config::Fault* find(config::FaultKind kind, int vehicle) const;
  /// Those of the tracks that are in force, in the list's order.
  [[nodiscard]] std::vector<const config::Fault*> of_kind(config::FaultKind kind) const;
  /// All that is wrong with a vehicle's link: losses and reorderings combine as independent ones, delays add up.
  [[nodiscard]] LinkImpairment link(int vehicle) const;

 private:
  std::vector<config::Fault> faults_;
  std::vector<FaultChange> changes_;  ///< all of them, by time
  std::size_t next_ = 0;              ///< of changes_
  std::vector<bool> active_;          ///< parallel to faults_
};

}  // namespace jink::sim::faults
