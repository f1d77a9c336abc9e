// SPDX-License-Identifier: BSD-3-Clause
// The numbers that options take, and how one is refused: the same on a command line and from Python.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace jink::tools::base {

/// Both ends included.
struct WholeRange {
  std::uint64_t least = 0;
  std::uint64_t most = 0;
};
struct NumberRange {
  double least = 0.0;
  double most = 0.0;
};

inline constexpr WholeRange kSeed{0, std::numeric_limits<std::uint64_t>::max()};
inline constexpr WholeRange kThreads{1, 256};
inline constexpr WholeRange kSlaves{1, 64};
inline constexpr WholeRange kSharing{0, 1000};
inline constexpr WholeRange kPopulation{1, 100000};
inline constexpr WholeRange kIterations{1, 1000000};
inline constexpr WholeRange kWaypoints{1, 1000};
inline constexpr NumberRange kDeadline_ms{0.001, 1e9};

/// Reads decimal digits, so that 010 is ten, or a number with a fraction; NaN is in no range. Empty, or what is wrong:
/// "Value 70 not in range 1 to 64".
[[nodiscard]] std::string read_whole(const std::string& text, const WholeRange& range, std::uint64_t& value);
[[nodiscard]] std::string read_number(const std::string& text, const NumberRange& range, double& value);

}  // namespace jink::tools::base
