// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle/wind.hpp"

#include <stdexcept>

#include "sim/vehicle/vehicle_model.hpp"

namespace jink::sim::vehicle {
namespace {

constexpr std::uint64_t kGustStream = 0x67757374;  // a name of its own among the streams of a seed

const Wind& checked(const Wind& wind) {
  const bool usable = wind.mean.allFinite() && std::isfinite(wind.gust) && wind.gust >= 0.0 &&
                      std::isfinite(wind.gust_time) && wind.gust_time >= 0.0;
  if (!usable) throw std::invalid_argument("wind: mean, gust and gust_time must be finite, the last two not negative");
  return wind;
}

}  // namespace

WindModel::WindModel(const Wind& wind, std::uint64_t seed)
    : mean_(checked(wind).mean),
      gusts_(wind.gust, wind.gust_time, VehicleModel::kStep, planner::base::RandomStream(seed, kGustStream)) {}

void WindModel::set_mean(const Vec3& mean) {
  mean_ = checked({.mean = mean}).mean;
}

}  // namespace jink::sim::vehicle
