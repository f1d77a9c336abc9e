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
  /// at most, so that a way may be found some calls later. Where a way is closed and there is no other, it leads to
  /// before where it is closed.
  void lead(PathRequest& request, double now, const MapPlace& map = {});

  /// The way that is led along, from beside the vehicle to the target; empty: straight on. ENU, m.
  [[nodiscard]] std::span<const Vec3> way() const { return way_; }

  /// Something that moves is in the way, or straight on: the next calls of lead() look for others, which pass what
  /// stands on other sides and are at most 1.5 times as long, and for as many places of the grid again.
  void want_others() { wants_others_ = true; }
  /// It is gone.
  void forget_others();
  /// Those that were found, from beside the vehicle.
  [[nodiscard]] std::span<const std::vector<Vec3>> others() const { return others_; }
  /// As lead() has led, along one of the others; `request` is as it was given to lead().
  void lead_along(std::size_t other, PathRequest& request);
  /// From now on that one is the way.
  void take(std::size_t other);

  /// The ids of the last request's tracks that stand, where that was led with a `standing_margin` less than the margin;
  /// else none.
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
  [[nodiscard]] GridSearch::State advance(GridSearch& search, const PathRequest& request,
                                          std::span<const GridQuery::Column> closed) const;
  void begin_way(std::vector<Vec3> way);
  void look_for_others(const PathRequest& request);
  [[nodiscard]] std::optional<GridQuery::Column> gate_of(std::span<const Vec3> way, double enough) const;
  [[nodiscard]] bool are_alike(std::span<const Vec3> a, std::span<const Vec3> b) const;
  void look_for_way(const PathRequest& request, double now, bool known);
  [[nodiscard]] std::vector<Vec3> up_to_closed(const PathRequest& request) const;
  void centre(std::vector<Vec3>& way, double enough) const;
  [[nodiscard]] std::vector<Vec3> pulled_tight(std::vector<Vec3> way, const PathRequest& request,
                                               std::span<const GridQuery::Column> closed) const;
  [[nodiscard]] double kept_open(const PathRequest& request) const;
  [[nodiscard]] bool is_open(std::span<const Vec3> way, const PathRequest& request) const;
  bool pass(const Vec3& position);
  [[nodiscard]] double room_at(const Vec3& place, double enough, const base::Box& volume) const;
  void lead_along(std::span<const Vec3> way, PathRequest& request);
  void slow_down(std::span<const Vec3> way, PathRequest& request);
  std::size_t lead_ahead(std::span<const Vec3> way, PathRequest& request) const;

  base::HorizonSettings settings_;
  Knowledge knowledge_;
  std::vector<Seen> seen_;
  std::vector<std::uint64_t> standing_ids_;
  Standing standing_;
  bool narrow_ = false;
  double sigma_ = 0.0;  // m, the largest standard deviation of their positions
  GridSearch search_;
  std::vector<Vec3> way_;
  bool taken_ = false;       // though another was shorter: it is kept even where straight on is free
  bool closed_off_ = false;  // the way is closed, and there is no other
  bool wants_others_ = false;
  GridSearch other_search_;
  int tries_ = 0;
  std::vector<GridQuery::Column> closed_;  // on the way and the others
  std::vector<Vec3> last_;                 // way that was found beside it, one of the others or not
  std::vector<std::vector<Vec3>> others_;
  Vec3 target_ = Vec3::Zero();  // of the flight
  double search_again_ = 0.0;   // s, when, after one that found none
  Progress progress_;
};

}  // namespace jink::planner::horizon
