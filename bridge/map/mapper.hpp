// SPDX-License-Identifier: BSD-3-Clause
// From clouds of points to solids that plans keep clear of: on a thread of its own, or at once in virtual time.
#pragma once

#include <Eigen/Geometry>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/map/occupancy.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/static_map.hpp"

namespace jink::bridge::map {

/// What stands, as far as it has been seen, and what of it was known beforehand. Immutable.
struct Seen {
  std::uint64_t number = 0;                                 ///< counts the changes, from 1
  std::vector<CellBox> boxes;                               ///< that cover the occupied cells
  Vec3 origin = Vec3::Zero();                               ///< of the cells, in the map's frame, m
  double up = 0.0;                                          ///< z of the local frame less the map's, m
  std::shared_ptr<const planner::geometry::StaticMap> map;  ///< all of it: what was known first. Plans share it
};

/// What is known, then boxes of cells about `origin`: the same bits for the same arguments.
[[nodiscard]] std::shared_ptr<const planner::geometry::StaticMap> with_boxes(const planner::geometry::StaticMap& known,
                                                                             std::span<const CellBox> boxes,
                                                                             const Vec3& origin);

/// A cloud with all that is needed to place it. Local ENU, m.
struct CloudJob {
  double time = 0.0;  ///< s, in a clock that goes on
  std::vector<Eigen::Vector3f> points;
  Eigen::Isometry3d to_local = Eigen::Isometry3d::Identity();  ///< from the points' frame
  Vec3 sensor = Vec3::Zero();
  Vec3 vehicle = Vec3::Zero();                ///< its centre
  double floor = -planner::base::kInfinity;   ///< z: what is no higher is the ground
  std::vector<planner::base::Track> tracked;  ///< as they were then: what is tracked is no part of the map
  Vec3 shift = Vec3::Zero();                  ///< of the local frame since the flight began: the cells do not jump
  double up = 0.0;                            ///< Seen::up
  bool anew = false;                          ///< nothing that was seen before counts any more
};

struct MapperCounts {
  std::uint64_t clouds = 0;   ///< taken in
  std::uint64_t skipped = 0;  ///< since a newer one came first
  CloudCounts points;         ///< of all
  double most_ms = 0.0;       ///< that one took, where there is a clock
};

/// Keeps the map of one flight. All functions are safe from any thread.
class Mapper {
 public:
  /// m, about the vehicle at the first cloud: what no sensor sees there is taken to be free.
  static constexpr double kRoomAtStart = 1.5;

  /// `clock`: to measure what a cloud takes on the thread; null: virtual time, clouds are taken in by put() itself.
  /// @throws std::invalid_argument as Occupancy does.
  Mapper(const OccupancySettings& settings, double own_radius,
         std::shared_ptr<const planner::geometry::StaticMap> known, const base::Clock* clock);
  ~Mapper();
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  /// Takes it in at once, or on the thread as soon as that is free; a newer one takes the place of one that waits.
  void put(CloudJob job);
  /// The newest; null before the first cloud. Throws what the thread threw.
  [[nodiscard]] std::shared_ptr<const Seen> seen() const;
  /// How far up and down the vehicle's column was free at the newest cloud, local ENU; none before the first.
  [[nodiscard]] std::optional<Occupancy::Column> column() const;
  /// Of these places of the vehicle, local ENU, on its way from the first one, the first at which it is nearer than
  /// there to what is unknown, and within 0.1 m of it; their number: none. Waits while a cloud is taken in.
  [[nodiscard]] std::size_t first_unseen(std::span<const Vec3> places) const;
  [[nodiscard]] MapperCounts counts() const;

 private:
  void work(const std::stop_token& stop);
  void take(const CloudJob& job);

  const double own_radius_;
  const std::shared_ptr<const planner::geometry::StaticMap> known_;
  const base::Clock* const clock_;
  mutable std::mutex grid_mutex_;  // guards the two below
  Occupancy grid_;
  Vec3 shift_ = Vec3::Zero();  // of the newest cloud
  mutable std::mutex mutex_;   // guards all below but the thread
  std::condition_variable_any wake_;
  std::optional<CloudJob> job_;
  std::shared_ptr<const Seen> seen_;
  std::optional<Occupancy::Column> column_;
  MapperCounts counts_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: its end comes first
};

}  // namespace jink::bridge::map
