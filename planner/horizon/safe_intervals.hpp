// SPDX-License-Identifier: BSD-3-Clause
// A way in space and time among what moves: aside in time, wait, and on. Safe interval path planning (Phillips and
// Likhachev 2011): a place is looked at once for each stretch of time in which it is free.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"
#include "planner/horizon/grid.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/horizon/placed_solid.hpp"
#include "planner/horizon/standing.hpp"

namespace jink::planner::horizon {

/// A way that is found.
struct WayInTime {
  base::TimedPath path;              ///< times as the request's, linear between the points
  double arrival = base::kInfinity;  ///< at the target, s, where it leads there
  bool stays = false;                ///< its end is free for as long as is looked ahead
};

/// One search after another; keeps its memory. Not thread-safe. Same bits for the same calls.
class SafeIntervalSearch {
 public:
  static constexpr double kInstant = 0.25;                          ///< s, between two at which obstacles are placed
  static constexpr int kInstants = 64;                              ///< of them
  static constexpr double kLookAhead = (kInstants - 1) * kInstant;  ///< s; what is free then stays so
  static constexpr std::size_t kMostPlaces = 2500;                  ///< of the grid, that are looked at
  static constexpr std::size_t kMostTests = 100'000;                ///< of a place and an obstacle

  /// The way that is first at the request's target and keeps the margin, from where the vehicle is at a time of the
  /// request: on a grid of `cell` m that begins there, at 0.7 of its cruise speed, with stops and turns that take no
  /// time. Where none is found, the way to the place nearest to the target that stays free, or none but its start.
  /// A way to plan along: it is not promised to be free.
  [[nodiscard]] WayInTime find(const PathRequest& request, const base::TimedPoint& from, double cell);

 private:
  using Instants = std::uint64_t;  // a bit for each, the lowest is the first
  /// An obstacle but for what stands.
  struct Mover {
    base::Box box;                    // out of which all is free at all times
    std::vector<Vec3> where;          // its centre at each instant up to which it counts; one if it rests
    std::vector<PlacedSolid> solids;  // then; none before the first place that is near
    base::Body body;                  // at the first instant
    double wanted = 0.0;              // from its centre, m
    double kept = 0.0;                // from its surface, m
    double farthest = 0.0;            // from one instant to the next, m
    bool rests = false;

    [[nodiscard]] std::size_t instants_until_near(double farther) const;
  };
  /// One of the grid, and its states.
  struct Place {
    Eigen::Vector3i cell;
    Vec3 position;
    std::size_t first_state = 0, last_state = 0;
  };
  /// A place during one of the stretches in which it is free.
  struct State {
    std::size_t place = 0;
    double begin = 0.0, end = 0.0;  // s
    double arrival = base::kInfinity;
    double departure = 0.0;  // from the parent's place
    int parent = -1;
    bool done = false;
  };
  void place_obstacles(const PathRequest& request, double begin);
  [[nodiscard]] Instants free_at(const Vec3& position, const PathRequest& request);
  std::size_t place_at(const Eigen::Vector3i& cell, const PathRequest& request);
  void leave(std::size_t state, const PathRequest& request);
  [[nodiscard]] double time_over(const Vec3& way) const;
  [[nodiscard]] base::TimedPath way_to(std::size_t state) const;

  Standing standing_;
  std::vector<Mover> movers_;
  std::vector<Place> places_;
  std::vector<State> states_;
  std::unordered_map<std::uint64_t, std::size_t> index_;
  OpenList open_;
  Vec3 origin_ = Vec3::Zero();
  double cell_ = 0.0;   // m
  double speed_ = 0.0;  // m/s
  double climb_ = 0.0;  // m/s
};

}  // namespace jink::planner::horizon
