// SPDX-License-Identifier: BSD-3-Clause
// DDS payloads as the reader of clouds decodes them, into the map: what comes out of that are boxes of cells near the
// vehicle, whatever goes in. The input is a sequence of messages: time since the last one (50 ms), place of the vehicle
// (three signed bytes, 0.5 m), its yaw (a byte, 0.1 rad), length (two bytes), payload.
#include "bridge/cdr/cloud_messages.hpp"
#include "bridge/map/clouds.hpp"
#include "bridge/map/mapper.hpp"
#include "planner/geometry/validity.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using jink::Vec3;
using jink::bridge::map::Occupancy;

void check(const jink::bridge::map::Seen& seen, const Vec3& vehicle) {
  const Vec3 half = 0.5 * Occupancy::kCell * Vec3(Occupancy::kSize[0], Occupancy::kSize[1], Occupancy::kSize[2]);
  jink::fuzz::require(seen.map->tracks().size() == seen.boxes.size(), "boxes that are not in the map");
  for (std::size_t i = 0; i < seen.boxes.size(); ++i) {
    const auto& [min, max] = seen.boxes[i];
    jink::fuzz::require((min.array() < max.array()).all(), "an empty box of cells");
    jink::fuzz::require(jink::planner::geometry::is_valid(seen.map->tracks()[i]), "an absurd obstacle");
    const jink::planner::base::Box& box = seen.map->box(i);
    const bool near = ((box.min - vehicle).array() >= -half.array() - Occupancy::kCell).all() &&
                      ((box.max - vehicle).array() <= half.array() + Occupancy::kCell).all();
    jink::fuzz::require(near, "a box out of the window");
    jink::fuzz::require(i == 0 || jink::bridge::map::comes_before(seen.boxes[i - 1], seen.boxes[i]),
                        "boxes in no order");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr double kOwnRadius = 0.3;
  jink::fuzz::Input input(data, size);
  jink::bridge::map::Mapper mapper({}, kOwnRadius, std::make_shared<const jink::planner::geometry::StaticMap>(),
                                   nullptr);
  double now = 10.0;
  std::size_t points = 0;
  while (!input.empty()) {
    jink::bridge::map::CloudJob job;
    now += 0.05 * input.byte();
    for (double& axis : job.vehicle) axis = 0.5 * static_cast<std::int8_t>(input.byte());
    const Eigen::AngleAxisd yaw(0.1 * input.byte(), Vec3::UnitZ());
    const std::size_t low = input.byte();
    auto cloud = jink::bridge::cdr::decode_cloud(input.bytes(low + 256U * input.byte()));
    if (!cloud) continue;
    jink::fuzz::require(cloud->points.size() <= jink::bridge::map::CloudLimits::kPoints,
                        "more points than there may be");
    points += cloud->points.size();
    job.time = now;
    job.points = std::move(cloud->points);
    job.sensor = job.vehicle;
    job.to_local = Eigen::Translation3d(job.vehicle) * yaw;
    const Vec3 vehicle = job.vehicle;
    mapper.put(std::move(job));
    check(*mapper.seen(), vehicle);
  }
  const jink::bridge::map::CloudCounts counts = mapper.counts().points;
  jink::fuzz::require(counts.hits + counts.clear + counts.none + counts.own + counts.repeated <= points,
                      "points counted twice");
  return 0;
}
