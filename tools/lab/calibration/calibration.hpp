// SPDX-License-Identifier: BSD-3-Clause
// How often movers are in the regions stated of where they will be.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "config/scenario.hpp"

namespace jink::tools::lab::calibration {

inline constexpr std::array kLeads = {0.5, 1.0, 2.0};     ///< s, predictions are held against what came
inline constexpr std::array kRegions = {0.5, 0.9, 0.99};  ///< probabilities of the regions

/// Counts, and what follows from them.
struct Calibration {
  struct Lead {
    std::array<double, kRegions.size()> inside{};  ///< predictions whose mover was in the region
    double squares = 0.0;                          ///< sum of the squared errors, m²
    double all = 0.0;                              ///< predictions

    [[nodiscard]] double share(std::size_t region) const { return inside[region] / all; }
    [[nodiscard]] double rms() const;  ///< of the error, m
  };
  std::array<Lead, kLeads.size()> leads;

  void add(const Calibration& other);
  [[nodiscard]] double predictions() const { return leads[0].all; }
};

/// A vehicle flies straight to the scenario's target for 15 s, through everything, at half its cruise speed, and
/// predicts four times a second all that moves within 12 m.
[[nodiscard]] Calibration watch(const config::Scenario& scenario, std::uint64_t seed);

}  // namespace jink::tools::lab::calibration
