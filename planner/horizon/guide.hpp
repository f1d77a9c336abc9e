// SPDX-License-Identifier: BSD-3-Clause
// The way through what stands: round houses, through doors, out of dead ends. It says where to plan to; what is flown
// is planned and verified as ever. What moves is not looked at here.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "planner/base/settings.hpp"
#include "planner/base/types.hpp"
#include "planner/horizon/grid_search.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/horizon/progress.hpp"
#include "planner/horizon/standing.hpp"

namespace jink::planner::horizon {

/// Leads one flight. Not thread-safe. The same bits for the same calls.
class Guide {
 public:
  /// How much is known of what stands.
  enum class Knowledge {
    kSensed,  ///< tracks come and go: what has rested for a while stands, and is remembered where nothing is seen
    kWhole    ///< what stands is among the tracks from the start on, and a search may take its time
  };
  /// Leads nowhere where settings.guide is false.
  Guide(const base::HorizonSettings& settings, Knowledge knowledge) : settings_(settings), knowledge_(knowledge) {}

  /// Where the straight way to the target leads through what stands, and the way round goes farther from it than
  /// settings.guide_deviation, `target` becomes a place on that way, in sight or nearly. Where the way is narrower than
  /// the margin, `standing_margin` is as small as it has to be, at least settings.guide_margin, and the vehicle as much
  /// slower; standing() says beside which tracks.
  /// `now`: s, in a clock that goes on. `map` stands too, all of it. Looks at settings.guide_places places of the grid
  /// at most, so that a way may be found some calls later.
  void lead(PathRequest& request, double now, const MapPlace& map = {});

  /// The way that is led along, from beside the vehicle to the target; empty: straight on. ENU, m.
  [[nodiscard]] std::span<const Vec3> way() const { return way_; }
  /// The ids of the last request's tracks that stand, where its `standing_margin` is less than the margin; else none.
  [[nodiscard]] std::span<const std::uint64_t> standing() const {
    return narrow_ ? std::span<const std::uint64_t>(standing_ids_) : std::span<const std::uint64_t>();
  }

 private:
  /// Something that rests.
  struct Seen {
    base::Track track;
    Vec3 from = Vec3::Zero();  // where it has rested since
    double since = 0.0, last = 0.0;
  };
  void notice(const PathRequest& request, double now, const MapPlace& map);
  void watch(const PathRequest& request, double now);
  void look_for_way(const PathRequest& request, double now);
  [[nodiscard]] std::vector<Vec3> pulled_tight(const std::vector<Vec3>& way, const PathRequest& request) const;
  [[nodiscard]] bool is_open(std::span<const Vec3> way, const PathRequest& request) const;
  bool pass(const Vec3& position);
  [[nodiscard]] double room_at(const Vec3& place, double enough, const base::Box& volume) const;
  void slow_down(PathRequest& request);
  std::size_t lead_ahead(PathRequest& request) const;

  base::HorizonSettings settings_;
  Knowledge knowledge_;
  std::vector<Seen> seen_;
  std::vector<std::uint64_t> standing_ids_;
  Standing standing_;
  bool narrow_ = false;
  double sigma_ = 0.0;  // m, the largest standard deviation of their positions
  GridSearch search_;
  std::vector<Vec3> way_;
  Vec3 target_ = Vec3::Zero();  // of the flight
  double search_again_ = 0.0;   // s, when, after one that found none
  Progress progress_;
};

}  // namespace jink::planner::horizon
