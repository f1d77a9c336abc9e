// SPDX-License-Identifier: BSD-3-Clause
#include "planner/verify/sphere_contact.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace jink::planner::verify {
namespace {

double squared_distance(const RelativeMotion& m, double t) {
  return m.at(t).squaredNorm();
}

double slope(const RelativeMotion& m, double t) {
  return 2.0 * m.at(t).dot(m.velocity(t));
}

/// Sorted instants of [0, duration] between which the squared distance is monotone: the ends and every stationary
/// point. The slope is a cubic; the two zeros of its derivative split it in monotone pieces, each with at most one
/// root.
struct MonotonePieces {
  std::array<double, 5> t{};
  int count = 0;

  explicit MonotonePieces(const RelativeMotion& m) {
    std::array<double, 4> split{0.0, m.duration, m.duration, m.duration};
    std::size_t splits = 1;
    // slope(t)/2 = c0 + c1 t + c2 t² + c3 t³
    const double c1 = m.p1.squaredNorm() + 2.0 * m.p0.dot(m.p2);
    const double c2 = 3.0 * m.p1.dot(m.p2);
    const double c3 = 2.0 * m.p2.squaredNorm();
    const double discriminant = c2 * c2 - 3.0 * c3 * c1;
    if (c3 > 0.0 && discriminant > 0.0) {
      const double root = std::sqrt(discriminant);
      for (const double s : {(-c2 - root) / (3.0 * c3), (-c2 + root) / (3.0 * c3)}) {
        if (s > split[splits - 1] && s < m.duration) split[splits++] = s;
      }
    }
    split[splits] = m.duration;
    add(0.0);
    for (std::size_t i = 0; i < splits; ++i) add_root(m, split[i], split[i + 1]);
    add(m.duration);
  }

 private:
  void add(double value) { t[static_cast<std::size_t>(count++)] = value; }

  void add_root(const RelativeMotion& m, double low, double high) {
    double at_low = slope(m, low);
    const double at_high = slope(m, high);
    if (!(at_low * at_high < 0.0)) return;
    for (int i = 0; i < 80 && high - low > 1e-13; ++i) {
      const double middle = 0.5 * (low + high);
      const double value = slope(m, middle);
      if ((value < 0.0) == (at_low < 0.0)) {
        low = middle;
        at_low = value;
      } else {
        high = middle;
      }
    }
    if (count < 4) add(0.5 * (low + high));
  }
};

/// First instant of a monotonically falling piece at which the squared distance is below `limit`.
double crossing(const RelativeMotion& m, double low, double high, double limit) {
  for (int i = 0; i < 80 && high - low > 1e-13; ++i) {
    const double middle = 0.5 * (low + high);
    (squared_distance(m, middle) < limit ? high : low) = middle;
  }
  return high;
}

}  // namespace

void fold_sphere(const RelativeMotion& m, double t0, double radius, std::uint64_t id, Verification& result) {
  const MonotonePieces pieces(m);
  double previous = 0.0;
  for (int i = 0; i < pieces.count; ++i) {
    const double t = pieces.t[static_cast<std::size_t>(i)];
    const double squared = squared_distance(m, t);
    const double clearance = std::sqrt(squared) - radius;
    if (clearance < result.min_clearance) {
      result.min_clearance = clearance;
      result.t_min_clearance = t0 + t;
      result.nearest_id = id;
    }
    if (clearance < 0.0) {
      const double contact = i == 0 ? 0.0 : crossing(m, previous, t, radius * radius);
      if (!result.first_contact || t0 + contact < *result.first_contact) {
        result.first_contact = t0 + contact;
        result.contact_speed = m.velocity(contact).norm();
      }
    }
    previous = t;
  }
}

}  // namespace jink::planner::verify
