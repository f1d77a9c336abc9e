// SPDX-License-Identifier: BSD-3-Clause
#include "planner/geometry/polygon.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace jink::planner::geometry {
namespace {

/// Above 0 where c is left of the line from a to b; twice the triangle's area.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a;
  const Vec2 v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

/// Of a point on the line through a and b.
bool is_between(const Vec2& a, const Vec2& b, const Vec2& p) {
  return ((p - a).array() * (p - b).array() <= 0.0).all();
}

bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double at_a = turn(c, d, a);
  const double at_b = turn(c, d, b);
  const double at_c = turn(a, b, c);
  const double at_d = turn(a, b, d);
  if (at_a * at_b < 0.0 && at_c * at_d < 0.0) return true;
  return (at_a == 0.0 && is_between(c, d, a)) || (at_b == 0.0 && is_between(c, d, b)) ||
         (at_c == 0.0 && is_between(a, b, c)) || (at_d == 0.0 && is_between(a, b, d));
}

double twice_area(std::span<const Vec2> corners) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) sum += turn(corners[0], corners[i], corners[i + 1]);
  return sum;
}

/// The corners around one of them.
struct Corner {
  const Vec2& before;
  const Vec2& here;
  const Vec2& after;

  Corner(const std::vector<Vec2>& all, std::size_t i)
      : before(all[(i + all.size() - 1) % all.size()]), here(all[i]), after(all[(i + 1) % all.size()]) {}
  [[nodiscard]] double turned() const { return turn(before, here, after); }
  [[nodiscard]] bool is_own(const Vec2& p) const { return p == before || p == here || p == after; }
  [[nodiscard]] bool holds(const Vec2& p) const {
    return turn(before, here, p) >= 0.0 && turn(here, after, p) >= 0.0 && turn(after, before, p) >= 0.0;
  }
};

bool is_ear(const std::vector<Vec2>& corners, std::size_t i) {
  const Corner corner(corners, i);
  if (!(corner.turned() > 0.0)) return false;
  return std::none_of(corners.begin(), corners.end(),
                      [&](const Vec2& p) { return !corner.is_own(p) && corner.holds(p); });
}

bool is_convex(const std::vector<Vec2>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!(Corner(corners, i).turned() > 0.0)) return false;
  }
  return true;
}

/// Takes out the corners at which nothing turns.
void drop_straight(std::vector<Vec2>& corners) {
  for (std::size_t i = corners.size(); i-- > 0 && corners.size() > 3;) {
    if (Corner(corners, i).turned() == 0.0) corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace

bool is_simple(std::span<const Vec2> corners) {
  const std::size_t n = corners.size();
  if (n < 3 || !std::all_of(corners.begin(), corners.end(), [](const Vec2& p) { return p.allFinite(); })) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& a = corners[i];
    const Vec2& b = corners[(i + 1) % n];
    const Vec2& c = corners[(i + 2) % n];
    if (a == b || (turn(a, b, c) == 0.0 && (b - a).dot(c - b) < 0.0)) return false;  // none, or there and back
    for (std::size_t k = i + 2; k < n; ++k) {
      const bool neighbours = i == 0 && k == n - 1;
      if (!neighbours && meet(a, b, corners[k], corners[(k + 1) % n])) return false;
    }
  }
  return true;
}

std::vector<Vec2> counter_clockwise(std::vector<Vec2> corners) {
  if (twice_area(corners) < 0.0) std::reverse(corners.begin(), corners.end());
  return corners;
}

std::vector<std::vector<Vec2>> convex_pieces(std::span<const Vec2> corners) {
  std::vector<Vec2> left = counter_clockwise({corners.begin(), corners.end()});
  drop_straight(left);
  std::vector<std::vector<Vec2>> pieces;
  while (!is_convex(left)) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(left, ear)) ++ear;
    if (ear == left.size()) break;
    const Corner corner(left, ear);
    pieces.push_back({corner.before, corner.here, corner.after});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    drop_straight(left);
  }
  pieces.push_back(std::move(left));
  return pieces;
}

}  // namespace jink::planner::geometry
