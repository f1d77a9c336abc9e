// SPDX-License-Identifier: BSD-3-Clause
// Numbers that a fuzzer makes its case of: two bytes of the input each, and where it ends, numbers that follow from it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "planner/base/random.hpp"
#include "planner/base/types.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace jink::fuzz {

/// Numbers from the input, and from its hash where it ends.
class Numbers {
 public:
  Numbers(const std::uint8_t* data, std::size_t size) : input_(data, size), hash_(hash(data, size)), rest_(hash_) {}

  /// Others, all from the hash: to draw them changes none of these.
  [[nodiscard]] Numbers others() const {
    Numbers n(nullptr, 0);
    n.rest_ = planner::base::RandomStream(hash_, 1);
    return n;
  }

  /// In [0, 1).
  double unit() {
    if (input_.empty()) return rest_.uniform();
    const unsigned high = input_.byte();
    return (256U * high + input_.byte()) / 65536.0;
  }
  double in(double low, double high) { return low + (high - low) * unit(); }
  /// Evenly by its logarithm.
  double scale(double low, double high) { return low * std::pow(high / low, unit()); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(unit() * static_cast<double>(n)); }
  bool one_in(std::size_t n) { return below(n) == 0; }
  Vec3 vec(double range) {
    const double x = in(-range, range);
    const double y = in(-range, range);
    return {x, y, in(-range, range)};
  }
  /// A unit vector.
  Vec3 direction() {
    const Vec3 v = vec(1.0);
    return v.norm() > 1e-3 ? v.normalized() : Vec3::UnitZ();
  }

 private:
  static std::uint64_t hash(const std::uint8_t* data, std::size_t size) {
    std::uint64_t h = 14695981039346656037U;  // FNV-1a
    for (std::size_t i = 0; i < size; ++i) h = (h ^ data[i]) * 1099511628211U;
    return h;
  }

  Input input_;
  std::uint64_t hash_;
  planner::base::RandomStream rest_;
};

}  // namespace jink::fuzz
