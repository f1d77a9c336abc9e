// SPDX-License-Identifier: BSD-3-Clause
// The shortest way on a grid among what stands (A*, Hart, Nilsson and Raphael 1968, with a weighted estimate, Pohl
// 1970), a part at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "planner/base/types.hpp"
#include "planner/horizon/grid.hpp"
#include "planner/horizon/standing.hpp"

namespace jink::planner::horizon {

/// What is looked for. ENU, m.
struct GridQuery {
  Vec3 from = Vec3::Zero();  ///< the vehicle
  Vec3 to = Vec3::Zero();    ///< where it is to go
  base::Box volume;          ///< not left
  double radius = 0.0;       ///< of the vehicle
  double least = 0.0;        ///< kept between the surfaces
  double wanted = 0.0;       ///< the same: where less is kept a way costs more, up to 11 times; above `least`
  double steepness = 1.0;    ///< speed / climb: a metre of height costs so many, if more than the way
  double cell = 0.5;         ///< between two places of the grid
  /// Upright, of any height.
  struct Column {
    Vec3 center = Vec3::Zero();  ///< of which z does not count
    double radius = 0.0;         ///< on the level
  };
  std::vector<Column> closed{};  ///< in which no place is
};

/// One search after another. Same bits for the same calls.
class GridSearch {
 public:
  /// How far a search has come.
  enum class State {
    kIdle,       ///< begin() was not called
    kSearching,  ///< advance() it
    kFound,      ///< way() is one
    kNone        ///< none on this grid, or none within kMostPlaces
  };
  static constexpr std::size_t kMostPlaces = 300'000;  ///< of the grid, that are looked at; 20 MB

  /// Gives up what was looked for before. The search goes from `to` to `from`: a target in a closed room is found out
  /// quickly.
  void begin(const GridQuery& query);
  /// Goes on by at most so many places. What stands may have changed since: a way that is found has to be looked at.
  State advance(const Standing& standing, int places);

  [[nodiscard]] State state() const { return state_; }             ///< of the search
  [[nodiscard]] const GridQuery& query() const { return query_; }  ///< of the last begin()
  /// Places from `from` to `to`, both included. Precondition: kFound.
  [[nodiscard]] std::vector<Vec3> way() const;

 private:
  struct Node {
    Eigen::Vector3i place;
    int parent = -1;
    double cost = 0.0;   // to the target
    double spare = 0.0;  // of clearance, from the vehicle's surface; at most what is wanted
    bool done = false;
  };
  [[nodiscard]] Vec3 at(const Eigen::Vector3i& place) const { return query_.to + query_.cell * place.cast<double>(); }
  [[nodiscard]] double length(const Vec3& way) const;
  int node_at(const Eigen::Vector3i& place, const Standing& standing);
  void visit(int node, const Standing& standing);
  [[nodiscard]] bool ends_at(const Node& node, const Standing& standing) const;

  GridQuery query_;
  State state_ = State::kIdle;
  std::vector<Node> nodes_;
  std::unordered_map<std::uint64_t, int> index_;
  OpenList open_;
  int last_ = -1;  // beside `from`
};

}  // namespace jink::planner::horizon
