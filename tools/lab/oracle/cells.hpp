// SPDX-License-Identifier: BSD-3-Clause
// A set of the cells of a grid that can grow by its neighbours quickly: one bit each, 64 at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace jink::tools::lab::oracle {

using Index = Eigen::Array3i;  ///< of a cell

/// m, of the mission that is searched where the scenario has no world.
inline constexpr double kAround = 8.0;

/// Indices run from 0 to nx - 1 and so on; others are a programming error.
class Cells {
 public:
  Cells(int nx, int ny, int nz)
      : nx_(nx),
        ny_(ny),
        nz_(nz),
        words_((nx + kBits - 1) / kBits),
        bits_(static_cast<std::size_t>(words_) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), 0) {}

  [[nodiscard]] bool test(int x, int y, int z) const { return (bits_[word(x, y, z)] & bit(x)) != 0; }
  void add(int x, int y, int z) { bits_[word(x, y, z)] |= bit(x); }
  void remove(int x, int y, int z) { bits_[word(x, y, z)] &= ~bit(x); }

  /// Adds the cells on the six faces of the grid.
  void add_faces() {
    for (int z = 0; z < nz_; ++z) {
      for (int y = 0; y < ny_; ++y) {
        const bool face = z == 0 || z == nz_ - 1 || y == 0 || y == ny_ - 1;
        for (int x = 0; x < nx_; x += face ? 1 : nx_ - 1) add(x, y, z);
      }
    }
  }

  /// Adds every cell that touches one of the set, if only with a corner.
  void grow() {
    grow_along_x();
    const auto row = static_cast<std::size_t>(words_);
    add_neighbours(row, static_cast<std::size_t>(ny_));
    add_neighbours(row * static_cast<std::size_t>(ny_), static_cast<std::size_t>(nz_));
  }

 private:
  static constexpr int kBits = 64;

  [[nodiscard]] static std::uint64_t bit(int x) { return std::uint64_t{1} << (x % kBits); }
  [[nodiscard]] std::size_t word(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(ny_) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(words_) +
           static_cast<std::size_t>(x / kBits);
  }

  void grow_along_x() {
    const int tail = nx_ % kBits;
    const std::uint64_t last = tail == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << tail) - 1;
    const auto row = static_cast<std::size_t>(words_);
    for (std::size_t at = 0; at < bits_.size(); at += row) {
      std::uint64_t before = 0;
      for (std::size_t i = at; i < at + row; ++i) {
        const std::uint64_t here = bits_[i];
        const std::uint64_t after = i + 1 < at + row ? bits_[i + 1] : 0;
        bits_[i] = here | here << 1 | here >> 1 | before >> (kBits - 1) | after << (kBits - 1);
        before = here;
      }
      bits_[at + row - 1] &= last;
    }
  }

  /// Adds to each place of an axis, which is `stride` words, the places before and after; `count` places are a line.
  void add_neighbours(std::size_t stride, std::size_t count) {
    before_growth_ = bits_;
    for (std::size_t line = 0; line < bits_.size(); line += stride * count) {
      for (std::size_t i = line; i + stride < line + stride * count; ++i) {
        bits_[i] |= before_growth_[i + stride];
        bits_[i + stride] |= before_growth_[i];
      }
    }
  }

  int nx_;
  int ny_;
  int nz_;
  int words_;  ///< of a row along x
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint64_t> before_growth_;
};

}  // namespace jink::tools::lab::oracle
