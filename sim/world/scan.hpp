// SPDX-License-Identifier: BSD-3-Clause
// What a depth camera or a lidar on a vehicle sees of the true shapes: where its rays end.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <vector>

#include "config/scenario.hpp"
#include "sim/world/world.hpp"

namespace jink::sim::world {

/// How far a ray goes from `from` in `direction`, a unit vector, until it meets the shape, both along the shape's own
/// axes about its reference point; 0 from within, infinite where it is farther than `range`. Exact for boxes and
/// spheres, to 1 mm for others.
[[nodiscard]] double ray_length(const config::Shape& shape, const Vec3& from, const Vec3& direction, double range);

/// One cloud of points, row by row from below, in the frame of `body` (x ahead, y left, z up), which leads to ENU: the
/// world at scenario time `t`, and the ground at `ground`. A ray that meets nothing within the range gives NaN. Noise
/// depends on (seed, sequence, ray) alone. O(rays · what is within range). Thread safe.
[[nodiscard]] std::vector<Eigen::Vector3f> scan(const World& world, const config::Scan& sensor, std::uint64_t seed,
                                                std::uint64_t sequence, double t, double ground,
                                                const Eigen::Isometry3d& body);

/// A cloud on its way.
struct ScanMessage {
  double stamp = 0.0;        ///< s, when it was measured
  double publication = 0.0;  ///< s, when it may be seen
  std::vector<Eigen::Vector3f> points;
};

/// Takes scan k at the time k / rate, of one vehicle, and holds it back for the sensing's delay. Not thread safe.
class ScanPipeline {
 public:
  /// For a world whose sensing has a scan. `world` outlives this.
  ScanPipeline(const World& world, std::uint64_t seed, std::uint64_t vehicle);

  /// Takes what is due at `t`, the vehicle being at `body`. `clock_start` as SensingPipeline's.
  void step(double t, const Eigen::Isometry3d& body, double clock_start = 0.0);
  /// As SensingPipeline's.
  [[nodiscard]] bool poll(double t, ScanMessage& message);

 private:
  const World& world_;
  std::uint64_t seed_;
  double ground_;
  std::uint64_t next_ = 0;
  std::deque<ScanMessage> pending_;
};

}  // namespace jink::sim::world
