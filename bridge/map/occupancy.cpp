// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/occupancy.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace jink::bridge::map {
namespace {

constexpr double kOwnMore = 0.1;     // m, beyond its radius, of what is the vehicle itself
constexpr double kEdge = 1e-6;       // cells, from the window's far side, where a ray that leaves it ends
constexpr double kFarthest = 1e6;    // m, of a point: numbers of cells stay integers
constexpr double kBlurred = 2.5;     // cells, before what it hits, that a ray does not free: it may be along its face
constexpr int kMarks = 3;            // what a cell is to a cloud: these
constexpr std::uint8_t kPassed = 0;  // a ray has passed it
constexpr std::uint8_t kEnd = 1;     // a ray ends in it, and nothing is there
constexpr std::uint8_t kMarked = 2;  // something is
constexpr std::array<int, 3> kShift = {0, 8, 16};  // of a cell's number along an axis, in its place

constexpr int kUnknownShare = 4;  // of a layer's cells, one in so many may be unknown where it is free
constexpr int kShare = 3;         // of the cells that a box grows by, one in so many is occupied
constexpr int kWidestGap = 1;     // cells, that it grows across

template <typename Visit>
void for_each_cell(const CellBox& cells, const Visit& visit) {
  Cell cell;
  for (cell.z() = cells.min.z(); cell.z() < cells.max.z(); ++cell.z())
    for (cell.y() = cells.min.y(); cell.y() < cells.max.y(); ++cell.y())
      for (cell.x() = cells.min.x(); cell.x() < cells.max.x(); ++cell.x()) visit(cell);
}

Cell cell_of(const Vec3& in_cells) {
  return in_cells.array().floor().matrix().cast<int>();
}

/// Those whose middle is within `radius`, m, of a place.
template <typename Visit>
void for_each_cell_within(const Vec3& place, double radius, const Visit& visit) {
  const Vec3 middle = place / Occupancy::kCell;
  const double most = radius / Occupancy::kCell;
  for_each_cell({cell_of(middle.array() - most), cell_of(middle.array() + most) + Cell::Ones()}, [&](const Cell& cell) {
    if (((cell.cast<double>().array() + 0.5).matrix() - middle).norm() <= most) visit(cell);
  });
}

}  // namespace

static_assert(Occupancy::kSize[0] == 1 << kShift[1] && Occupancy::kSize[1] == 1 << (kShift[2] - kShift[1]));

bool comes_before(const CellBox& a, const CellBox& b) {
  const auto key = [](const CellBox& box) {
    return std::array{box.min.z(), box.min.y(), box.min.x(), box.max.z(), box.max.y(), box.max.x()};
  };
  return key(a) < key(b);
}

Occupancy::Occupancy(const OccupancySettings& settings)
    : settings_(settings),
      values_(static_cast<std::size_t>(kSize[0]) * kSize[1] * kSize[2]),
      occupied_(static_cast<std::size_t>(kSize[1]) * kSize[2]) {
  if (!(settings.range > 0.0 && settings.range <= kLongestRange) || !(settings.forget > 0.0))
    throw std::invalid_argument("occupancy: a range or a time to forget that is none");
}

std::size_t Occupancy::place_of(const Cell& cell) {
  std::size_t place = 0;
  for (std::size_t i = 0; i < 3; ++i)
    place |= static_cast<std::size_t>(cell[static_cast<Eigen::Index>(i)] & (kSize[i] - 1)) << kShift[i];
  return place;
}

bool Occupancy::is_inside(const Cell& cell) const {
  const Cell from = cell - low_;
  return (from.array() >= 0).all() && from.x() < kSize[0] && from.y() < kSize[1] && from.z() < kSize[2];
}

Occupancy::State Occupancy::at(const Vec3& place) const {
  const Cell cell = cell_of(place / kCell);
  if (!is_inside(cell)) return State::kUnknown;
  const std::int8_t level = values_[place_of(cell)].level;
  return level == kUnknown ? State::kUnknown : level > 0 ? State::kOccupied : State::kFree;
}

void Occupancy::forget() {
  std::fill(values_.begin(), values_.end(), Value());
  std::fill(occupied_.begin(), occupied_.end(), std::uint16_t{0});
  mark_ = 0;
}

Occupancy::Column Occupancy::free_column(const Vec3& place, double radius) const {
  const Vec3 middle = place / kCell;
  const double most = radius / kCell;
  const Cell low = cell_of(middle.array() - most);
  const Cell high = cell_of(middle.array() + most);
  const auto is_free = [&](int z) {
    int cells = 0, unknown = 0;
    bool occupied = false;
    for_each_cell({{low.x(), low.y(), z}, {high.x() + 1, high.y() + 1, z + 1}}, [&](const Cell& cell) {
      if (((cell.cast<double>().array() + 0.5).matrix() - middle).head<2>().norm() > most) return;
      const std::int8_t level = is_inside(cell) ? values_[place_of(cell)].level : kUnknown;
      ++cells;
      unknown += level == kUnknown ? 1 : 0;
      occupied = occupied || level > 0;
    });
    return !occupied && kUnknownShare * unknown <= cells;
  };
  Column column{place.z(), place.z()};
  const int from = cell_of(middle).z();
  for (int z = from; z < from + kSize[2] && is_free(z); ++z) column.high = kCell * (z + 1);
  for (int z = from; z > from - kSize[2] && is_free(z); --z) column.low = kCell * z;
  return column;
}

// Marks that no cell has.
void Occupancy::begin_marks() {
  if (mark_ + 2 * kMarks > std::numeric_limits<std::uint8_t>::max()) {
    for (Value& value : values_) value.mark = 0;
    mark_ = 0;
  }
  mark_ = static_cast<std::uint8_t>(mark_ + kMarks);
}

void Occupancy::set_level(std::size_t place, int level) {
  std::int8_t& known = values_[place].level;
  std::uint16_t& row = occupied_[place >> kShift[1]];
  row = static_cast<std::uint16_t>(row + (level > 0 ? 1 : 0) - (known > 0 ? 1 : 0));
  known = static_cast<std::int8_t>(level);
}

// The planes of cells that come in are where those that go out were.
void Occupancy::slide_to(const Vec3& vehicle) {
  const Cell low = cell_of(vehicle / kCell) - Cell(kSize[0] / 2, kSize[1] / 2, kSize[2] / 2);
  for (int axis = 0; axis < 3; ++axis) {
    const int size = kSize[static_cast<std::size_t>(axis)];
    const int way = low[axis] - low_[axis];
    const int planes = std::min(std::abs(way), size);
    const int first = way > 0 ? low_[axis] : low_[axis] - planes;
    for (int i = 0; i < planes; ++i) clear_plane(axis, first + i);
    low_[axis] = low[axis];
  }
}

void Occupancy::clear_plane(int axis, int number) {
  const int u = axis == 0 ? 1 : 0;
  const int v = axis == 2 ? 1 : 2;
  Cell cell;
  cell[axis] = number;
  for (cell[v] = 0; cell[v] < kSize[static_cast<std::size_t>(v)]; ++cell[v]) {
    for (cell[u] = 0; cell[u] < kSize[static_cast<std::size_t>(u)]; ++cell[u]) {
      const std::size_t place = place_of(cell);
      if (values_[place].level != kUnknown) set_level(place, kUnknown);
    }
  }
}

// What is known is a little less so, until it is unknown: row by row, so that no cloud waits for all of them.
void Occupancy::age(double time) {
  if (time_ == -planner::base::kInfinity) begun_ = time;
  time_ = std::max(time_, time);
  const auto rows = static_cast<std::int64_t>(occupied_.size());
  const double due = (time_ - begun_) / settings_.forget * kMost * static_cast<double>(rows);
  if (due - static_cast<double>(aged_) > static_cast<double>(kMost * rows)) {
    forget();
    begun_ = time_;
    aged_ = 0;
    return;
  }
  for (const auto all = static_cast<std::int64_t>(due); aged_ < all; ++aged_)
    age_row(static_cast<std::size_t>(aged_ % rows), aged_ / rows % (kMost / -kLeast) == 0);
}

// What is free has fewer levels to lose, and loses them as much more slowly.
void Occupancy::age_row(std::size_t row, bool free_too) {
  const auto first = values_.begin() + static_cast<std::ptrdiff_t>(row << kShift[1]);
  std::uint16_t left = 0;
  std::for_each(first, first + kSize[0], [&left, free_too](Value& value) {
    if (value.level == kUnknown || (value.level <= 0 && !free_too)) return;
    const int less = value.level > 0 ? value.level - 1 : value.level + 1;
    value.level = less == 0 || value.level == 0 ? kUnknown : static_cast<std::int8_t>(less);
    if (value.level > 0) ++left;
  });
  occupied_[row] = left;
}

// From a place within to the window's edge at the most.
Vec3 Occupancy::clipped(const Vec3& from, const Vec3& to) const {
  double share = 1.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double low = low_[axis] + kEdge;
    const double high = low_[axis] + kSize[static_cast<std::size_t>(axis)] - kEdge;
    if (to[axis] < low) share = std::min(share, (low - from[axis]) / (to[axis] - from[axis]));
    if (to[axis] > high) share = std::min(share, (high - from[axis]) / (to[axis] - from[axis]));
  }
  return from + std::max(share, 0.0) * (to - from);
}

// One ray for each cell in which rays end.
void Occupancy::take_point(const CloudView& cloud, const Vec3& sensor, const Vec3& point, CloudCounts& counts) {
  const double length = (point - cloud.sensor).norm();
  Vec3 end = point / kCell;
  bool hit = length <= settings_.range && point.z() > cloud.floor;
  if (length > settings_.range) end = sensor + settings_.range / length * (end - sensor);
  if (!is_inside(cell_of(end))) {
    end = clipped(sensor, end);
    hit = false;
  }
  const Cell cell = cell_of(end);
  if (!is_inside(cell)) return;
  std::uint8_t& mark = values_[place_of(cell)].mark;
  if (mark == mark_ + kMarked || (mark == mark_ + kEnd && !hit)) {
    ++counts.repeated;
    return;
  }
  hit = hit && !(cloud.elsewhere && cloud.elsewhere(point));
  if (!hit && mark == mark_ + kEnd) {
    ++counts.repeated;
    return;
  }
  mark = static_cast<std::uint8_t>(mark_ + (hit ? kMarked : kEnd));
  ++(hit ? counts.hits : counts.clear);
  rays_.push_back({end, hit});
}

bool Occupancy::is_known(const Vec3& place, double radius, const Vec3& from) const {
  bool known = true;
  for_each_cell_within(place, radius, [&](const Cell& cell) {
    if (is_inside(cell) && values_[place_of(cell)].level != kUnknown) return;
    const Vec3 middle = kCell * (cell.cast<double>().array() + 0.5).matrix();
    known = known && (middle - place).squaredNorm() >= (middle - from).squaredNorm();
  });
  return known;
}

void Occupancy::free_around(const Vec3& place, double radius) {
  for_each_cell_within(place, radius, [&](const Cell& cell) {
    if (!is_inside(cell)) return;
    std::int8_t& level = values_[place_of(cell)].level;
    if (level == kUnknown) level = kLeast;
  });
}

CloudCounts Occupancy::insert(const CloudView& cloud) {
  CloudCounts counts;
  age(cloud.time);
  slide_to(cloud.vehicle);
  begin_marks();
  rays_.clear();
  rays_.reserve(cloud.points.size());
  const Vec3 sensor = cloud.sensor / kCell;
  if (!is_inside(cell_of(sensor))) return counts;
  const double own = cloud.own_radius + kOwnMore;
  for (const Eigen::Vector3f& given : cloud.points) {
    const Vec3 point = cloud.to_enu * given.cast<double>();
    if (!(point.array().abs() < kFarthest).all()) {
      ++counts.none;
    } else if ((point - cloud.vehicle).squaredNorm() < own * own) {
      ++counts.own;
    } else {
      take_point(cloud, sensor, point, counts);
    }
  }
  for (const Ray& ray : rays_) {
    const double length = (ray.end - sensor).norm();
    const double freed = ray.hit ? length - kBlurred : length;
    if (freed > 0.0) free_along(sensor, sensor + freed / length * (ray.end - sensor));
  }
  for (const Ray& ray : rays_) {
    if (!ray.hit) continue;
    const std::size_t place = place_of(cell_of(ray.end));
    const std::int8_t level = values_[place].level;
    set_level(place, std::min(kMost, (level == kUnknown ? 0 : level) + kHit));
  }
  return counts;
}

// Amanatides and Woo: from cell to cell across the nearest side. Both ends are in the window, so all of it is.
void Occupancy::free_along(const Vec3& from, const Vec3& to) {
  Cell cell = cell_of(from);
  const Cell last = cell_of(to);
  const Vec3 way = to - from;
  std::array<int, 3> left{};
  std::array<int, 3> step{};
  std::array<double, 3> next{};  // share of the way, at which it leaves the cell along an axis
  std::array<double, 3> across{};
  int count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    left[i] = std::abs(last[axis] - cell[axis]);
    step[i] = last[axis] < cell[axis] ? -1 : 1;
    count += left[i];
    next[i] = planner::base::kInfinity;
    if (left[i] == 0) continue;
    across[i] = 1.0 / std::abs(way[axis]);
    const double side = cell[axis] + (step[i] > 0 ? 1.0 : 0.0);
    next[i] = (side - from[axis]) / way[axis];
  }
  const auto marked = static_cast<std::uint8_t>(mark_ + kMarked);
  const auto passed = static_cast<std::uint8_t>(mark_ + kPassed);
  for (;; --count) {
    const std::size_t place = place_of(cell);
    if (Value& value = values_[place]; value.mark != marked && value.mark != passed) {
      value.mark = passed;
      const int level = std::max(kLeast, (value.level == kUnknown ? 0 : value.level) + kMiss);
      if (value.level > 0) {
        set_level(place, level);
      } else {
        value.level = static_cast<std::int8_t>(level);
      }
    }
    if (count == 0) return;
    const std::size_t i = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    cell[static_cast<Eigen::Index>(i)] += step[i];
    next[i] = --left[i] == 0 ? planner::base::kInfinity : next[i] + across[i];
  }
}

bool Occupancy::is_new(const Cell& cell) const {
  const Value& value = values_[place_of(cell)];
  return value.level > 0 && value.mark != mark_;
}

// Whether these cells may be a part of a box: none was seen to be free, and enough are occupied and in no box yet.
Occupancy::Slice Occupancy::slice_of(const CellBox& cells) const {
  if (!is_inside(cells.min) || !is_inside(cells.max - Cell::Ones())) return Slice::kNone;
  int fresh = 0;
  bool seen_free = false;
  for_each_cell(cells, [&](const Cell& cell) {
    const std::int8_t level = values_[place_of(cell)].level;
    seen_free = seen_free || (level <= 0 && level != kUnknown);
    fresh += is_new(cell) ? 1 : 0;
  });
  if (seen_free) return Slice::kNone;
  return kShare * fresh >= (cells.max - cells.min).prod() ? Slice::kSolid : Slice::kGap;
}

// As long as it goes along x, then as wide, then as high; across a gap too, between the lines of a lidar.
CellBox Occupancy::grown_box(const Cell& first) {
  CellBox box{first, first + Cell::Ones()};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (int step = 1; step <= kWidestGap + 1; ++step) {
        CellBox slice = box;
        slice.min[axis] = box.max[axis] + step - 1;
        slice.max[axis] = slice.min[axis] + 1;
        const Slice kind = slice_of(slice);
        if (kind == Slice::kNone) break;
        if (kind == Slice::kGap) continue;
        box.max[axis] = slice.max[axis];
        goes_on = true;
        break;
      }
    }
  }
  for_each_cell(box, [this](const Cell& cell) { values_[place_of(cell)].mark = mark_; });
  return box;
}

std::vector<CellBox> Occupancy::boxes() {
  begin_marks();
  std::vector<CellBox> found;
  const Cell high = low_ + Cell(kSize[0], kSize[1], kSize[2]);
  for (Cell cell = low_; cell.z() < high.z(); ++cell.z()) {
    for (cell.y() = low_.y(); cell.y() < high.y(); ++cell.y()) {
      cell.x() = low_.x();
      if (occupied_[place_of(cell) >> kShift[1]] == 0) continue;
      for (; cell.x() < high.x(); ++cell.x())
        if (is_new(cell)) found.push_back(grown_box(cell));
    }
  }
  return found;
}

}  // namespace jink::bridge::map
