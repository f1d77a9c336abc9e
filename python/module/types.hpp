// SPDX-License-Identifier: BSD-3-Clause
// What the parts of the module _jink share: its lists of points and tracks, views of them as NumPy arrays, arguments.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/base/budget.hpp"
#include "planner/base/trajectory.hpp"
#include "planner/base/types.hpp"

namespace jink::python {

using Tracks = std::vector<planner::base::Track>;

}  // namespace jink::python

// Lists stay what they are: Python sees them, and no copies.
NB_MAKE_OPAQUE(jink::planner::base::TimedPath)
NB_MAKE_OPAQUE(jink::python::Tracks)

namespace jink::python {

namespace nb = nanobind;

using Vector = std::array<double, 3>;
using Corners = std::array<Vector, 2>;  // smallest and largest coordinates

inline Vec3 vec3(const Vector& v) {
  return {v[0], v[1], v[2]};
}
inline Vector vector(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
inline planner::base::Box box(const std::optional<Corners>& corners) {
  return corners ? planner::base::Box{vec3((*corners)[0]), vec3((*corners)[1])} : planner::base::Box{};
}

/// Throws std::invalid_argument for less than one generation, and for a time that is not in (0, 1e9] ms.
planner::base::Budget budget_of(int generations, std::optional<double> deadline_ms);

/// n numbers, and n x m of them, somewhere in C++. Whoever returns one sees to it that what is seen lives as long.
template <class Number>
using Column = nb::ndarray<nb::numpy, Number, nb::ndim<1>>;
template <class Number>
using Table = nb::ndarray<nb::numpy, Number, nb::ndim<2>>;

/// One number of each item of a list.
template <class Item, class Number>
Column<Number> column(std::vector<Item>& items, Number Item::*member) {
  static_assert(sizeof(Item) % sizeof(Number) == 0);
  return {items.empty() ? nullptr : &(items.data()->*member), {items.size()}, {}, {sizeof(Item) / sizeof(Number)}};
}
/// One vector of each item of a list: n x 3.
template <class Item>
Table<double> table(std::vector<Item>& items, Vec3 Item::*member) {
  static_assert(sizeof(Item) % sizeof(double) == 0 && sizeof(Vec3) == 3 * sizeof(double));
  return {items.empty() ? nullptr : (items.data()->*member).data(),
          {items.size(), std::size_t{3}},
          {},
          {static_cast<std::int64_t>(sizeof(Item) / sizeof(double)), std::int64_t{1}}};
}

/// A thing that does one piece of work at a time, though the interpreter lets others run meanwhile.
class AtWork {
 public:
  explicit AtWork(std::atomic<bool>& flag) : flag_(flag) {
    if (flag_.exchange(true))
      throw std::runtime_error(
          "at work already, in another thread or in its own callback: one piece of work at a time");
  }
  ~AtWork() { flag_ = false; }
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;

 private:
  std::atomic<bool>& flag_;
};

// The parts of the module; `module` is _jink.
void add_values(nb::module_& module);
void add_planner(nb::module_& module);
void add_optimizer(nb::module_& module);
void add_runs(nb::module_& module);

}  // namespace jink::python
