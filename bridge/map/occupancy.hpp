// SPDX-License-Identifier: BSD-3-Clause
// What has been seen to be free and what to be occupied, in cells around the vehicle. From clouds of points by ray
// casting (Amanatides and Woo, 1987) and clamped log odds (Hornung and others, OctoMap, 2013).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "planner/base/types.hpp"

namespace jink::bridge::map {

using Cell = Eigen::Vector3i;  ///< a cell's number along each axis: it begins at that many edges from the origin

/// Cells from `min` on, up to but not with `max`.
struct CellBox {
  Cell min = Cell::Zero();
  Cell max = Cell::Zero();
  bool operator==(const CellBox&) const = default;
};

/// The order of Occupancy::boxes(): by z, y, x of their first cells, then of their last.
[[nodiscard]] bool comes_before(const CellBox& a, const CellBox& b);

struct OccupancySettings {
  double range = 8.0;    ///< m, of a ray, up to Occupancy::kLongestRange; what is beyond it is not believed to be there
  double forget = 60.0;  ///< s, after which what was seen well is unknown again; what was seen once is sooner
};

/// A cloud of points, and from where it was seen. ENU, m.
struct CloudView {
  double time = 0.0;  ///< s, in a clock that goes on
  std::span<const Eigen::Vector3f> points;
  Eigen::Isometry3d to_enu = Eigen::Isometry3d::Identity();  ///< from the points' frame
  Vec3 sensor = Vec3::Zero();
  Vec3 vehicle = Vec3::Zero();               ///< its centre
  double own_radius = 0.0;                   ///< within which points are the vehicle itself
  double floor = -planner::base::kInfinity;  ///< z, m: what is no higher is the ground
  /// Where something else is known to be, which is to be no part of this; may be empty.
  std::function<bool(const Vec3&)> elsewhere{};
};

/// What became of a cloud's points.
struct CloudCounts {
  std::size_t hits = 0;      ///< at which something stands; those of one cell count once
  std::size_t clear = 0;     ///< beyond the range, on the ground, or elsewhere: the way to there is free
  std::size_t none = 0;      ///< not finite: no return
  std::size_t own = 0;       ///< the vehicle itself
  std::size_t repeated = 0;  ///< in the cell of a point before
  bool operator==(const CloudCounts&) const = default;
};

/// A window of cells that slides along with the vehicle: what leaves it is forgotten, what enters it is unknown. All
/// memory is taken at construction but for the longest cloud's rays. Not thread-safe. The same bits for the same calls.
class Occupancy {
 public:
  static constexpr double kCell = 0.2;  ///< m, of a cell's edge
  /// Of the window, cells: 51.2 by 51.2 by 12.8 m. Powers of two, for a ring.
  static constexpr std::array<int, 3> kSize = {256, 256, 64};
  static constexpr double kLongestRange = 25.0;  ///< m

  enum class State { kUnknown, kFree, kOccupied };

  explicit Occupancy(const OccupancySettings& settings);

  /// Takes a cloud in: frees the cells that its rays pass, marks those in which they end, each once. A `time` before
  /// the last call's counts as that. O(cells that rays pass).
  CloudCounts insert(const CloudView& cloud);

  /// Unknown out of the window.
  [[nodiscard]] State at(const Vec3& place) const;
  /// Few boxes that cover all occupied cells and none that is free, though some unknown ones between and behind them: a
  /// wall that is seen a bit at a time is one. In the order of their first cells, by z, y, x.
  [[nodiscard]] std::vector<CellBox> boxes();
  /// How far up and down a place's column is free, z, m: each layer of it but for a quarter of its cells, in which
  /// nothing is. The place's own z where not even that is known.
  struct Column {
    double low = 0.0, high = 0.0;
  };
  [[nodiscard]] Column free_column(const Vec3& place, double radius) const;
  /// Whether no cell is unknown whose middle is within `radius`, m, of a place and nearer to it than to `from`.
  [[nodiscard]] bool is_known(const Vec3& place, double radius, const Vec3& from) const;
  /// What is unknown within `radius`, m, of a place in the window is free.
  void free_around(const Vec3& place, double radius);
  /// All is unknown.
  void forget();

 private:
  // Log odds in twentieths, clamped. As OctoMap's for a hit and at the most; less for a miss, and less at the least: a
  // wall that is seen along its face, by rays that often pass it, stays; and what comes is there with the second hit.
  static constexpr int kHit = 17;
  static constexpr int kMiss = -4;
  static constexpr int kMost = 70;
  static constexpr int kLeast = -20;
  static constexpr std::int8_t kUnknown = std::numeric_limits<std::int8_t>::min();

  struct Value {
    std::int8_t level = kUnknown;
    std::uint8_t mark = 0;  ///< of the last cloud, or walk over the cells, that touched it
  };
  struct Ray {
    Vec3 end = Vec3::Zero();  ///< in cells
    bool hit = false;
  };

  [[nodiscard]] static std::size_t place_of(const Cell& cell);
  [[nodiscard]] bool is_inside(const Cell& cell) const;
  void slide_to(const Vec3& vehicle);
  void clear_plane(int axis, int number);
  void age(double time);
  void age_row(std::size_t row, bool free_too);
  void begin_marks();
  void set_level(std::size_t place, int level);
  [[nodiscard]] Vec3 clipped(const Vec3& from, const Vec3& to) const;
  void take_point(const CloudView& cloud, const Vec3& sensor, const Vec3& point, CloudCounts& counts);
  void free_along(const Vec3& from, const Vec3& to);
  enum class Slice { kNone, kGap, kSolid };
  [[nodiscard]] bool is_new(const Cell& cell) const;
  [[nodiscard]] Slice slice_of(const CellBox& cells) const;
  [[nodiscard]] CellBox grown_box(const Cell& first);

  OccupancySettings settings_;
  std::vector<Value> values_;
  std::vector<std::uint16_t> occupied_;  // cells along x, of each row
  std::vector<Ray> rays_;                // of the cloud that is being taken
  Cell low_ = Cell::Zero();              // the window's first cell
  std::uint8_t mark_ = 0;
  double time_ = -planner::base::kInfinity;
  double begun_ = 0.0;     // when the first cloud came, or all was forgotten for its age
  std::int64_t aged_ = 0;  // rows, since then
};

}  // namespace jink::bridge::map
