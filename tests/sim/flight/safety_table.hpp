// SPDX-License-Identifier: BSD-3-Clause
// The tables of docs/safety.md: their columns and variants, their lines, and the document as it stands.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/sim/flight/safety_happenings.hpp"

namespace jink::sim::flight::safety {

/// When it happens.
struct Column {
  std::string_view name;
  bridge::supervisor::Phase phase;
  double moment;  ///< s after the phase's beginning
};
inline constexpr std::size_t kColumns = 8;
inline constexpr std::size_t kOnGround = 3;  ///< the first so many, which are a table of their own
[[nodiscard]] const std::array<Column, kColumns>& columns();

/// For whom; the first is the one that the others are compared with.
struct Variant {
  std::string_view name;
  bool transmitter;
  int writers;
};
inline constexpr std::size_t kVariants = 4;
[[nodiscard]] const std::array<Variant, kVariants>& variants();

using Words = std::array<std::string, kColumns>;
/// What has become of a row's flights, by variant.
using Row = std::array<Words, kVariants>;

/// A row's lines in the table of the ground (`air` false) or of the air: that of the first variant, and those of the
/// others that have a word of their own, in which "=" stands for the first one's.
[[nodiscard]] std::vector<std::string> lines_of(const Happening& what, const Row& row, bool air);
/// The document's lines of that row.
[[nodiscard]] std::vector<std::string> lines_in(const std::string& document, const Group& group, const Happening& what,
                                                bool air);
/// All tables.
[[nodiscard]] std::string tables(const std::function<const Row&(const Happening&)>& row_of);
/// What stands where they belong. Throws std::runtime_error where the document has no place for them.
[[nodiscard]] std::string tables_in(const std::string& document);
/// The document with these tables in the place of its own. Throws likewise.
[[nodiscard]] std::string replaced(std::string document, const std::string& tables);
/// What stands in a line's cells, the first one included.
[[nodiscard]] std::vector<std::string> cells_of(const std::string& line);

}  // namespace jink::sim::flight::safety
