// SPDX-License-Identifier: BSD-3-Clause
// The wind that the vehicle flies in: a mean and gusts, the same everywhere in the world.
#pragma once

#include <cstdint>

#include "sim/vehicle/gauss_markov.hpp"

namespace jink::sim::vehicle {

struct Wind {
  Vec3 mean = Vec3::Zero();  ///< m/s, ENU, where the air goes to
  double gust = 0.0;         ///< m/s, standard deviation per axis
  double gust_time = 2.0;    ///< s, over which a gust dies down to 1/e
};

class WindModel {
 public:
  /// Throws std::invalid_argument for figures that are not finite or negative.
  WindModel(const Wind& wind, std::uint64_t seed);

  /// Throws as the constructor does.
  void set_mean(const Vec3& mean);
  /// Advances by VehicleModel::kStep.
  void step() { gusts_.step(); }
  [[nodiscard]] Vec3 velocity() const { return mean_ + gusts_.value(); }

 private:
  Vec3 mean_;
  GaussMarkov gusts_;
};

}  // namespace jink::sim::vehicle
