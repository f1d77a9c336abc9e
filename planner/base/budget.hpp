// SPDX-License-Identifier: BSD-3-Clause
// How much an optimizer may work: a number of generations, and at most so much time.
#pragma once

#include <chrono>
#include <limits>

namespace jink::planner::base {

/// Generations alone make a run repeatable bit by bit. With a deadline too, the run stops after the generation in which
/// the deadline passes; the same `generations` with `stop_after` set to the generations that it then reports repeat it.
struct Budget {
  /// The clock of deadlines: steady, never set back.
  using Time = std::chrono::steady_clock::time_point;
  int generations = 100;        ///< the schedule's length (WEP, TDR, cycles)
  Time deadline = Time::max();  ///< the run ends after the generation in which this passes; default: none
  int stop_after = std::numeric_limits<int>::max();  ///< the run ends with this generation

  /// Whether the clock has a say.
  [[nodiscard]] bool has_deadline() const { return deadline != Time::max(); }
  /// Whether it repeats a run that is known to have gone so far.
  [[nodiscard]] bool repeats() const { return stop_after != std::numeric_limits<int>::max(); }
  /// Whether there is a deadline and it has passed. Reads the clock where there is one.
  [[nodiscard]] bool expired() const { return has_deadline() && std::chrono::steady_clock::now() >= deadline; }
};

}  // namespace jink::planner::base
