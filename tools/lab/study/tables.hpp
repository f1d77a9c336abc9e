// SPDX-License-Identifier: BSD-3-Clause
// The tables of [Paper] section 5 from the study's records, and those that go beyond it. What was not run is "-".
#pragma once

#include <optional>
#include <vector>

#include "tools/lab/presentation/table.hpp"
#include "tools/lab/study/selection.hpp"
#include "tools/lab/study/worlds.hpp"

namespace jink::tools::lab::study {

/// What a table's rows say of a sample.
enum class Direction { kSmallerIsBetter, kLargerIsBetter };

/// Best, Mean, Worst or STD of a sample; NaN of nothing.
[[nodiscard]] double statistic(const std::vector<double>& sample, std::string_view which, Direction direction);
[[nodiscard]] std::vector<std::string> statistics_of_rows();

/// Tables 3, 4 and 5: HV, MS and HRS of fronts over slaves and sharing rates.
[[nodiscard]] std::vector<presentation::Table> front_tables(const Selection& selection, bool blocked);

/// Tables 6 and 7: SLR; planning time, and "table07-flight", the flown time.
[[nodiscard]] std::vector<presentation::Table> path_tables(const Selection& selection, bool blocked);

/// Steps in which mean SLRs are ranked: 22 µm of 22 m, which no flight shows. Ranks would otherwise order the last bits
/// of numbers.
inline constexpr double kSameSlr = 1e-6;

/// How the algorithms do in the five worlds, smaller is better. By length: first by the share of paths that failed,
/// then by the mean SLR of the others in steps of kSameSlr; by time: the mean planning time. None where runs are
/// missing.
enum class Criterion { kLength, kTime };
[[nodiscard]] std::optional<Scores> scores(const Selection& selection, Criterion criterion, bool blocked);

/// Tables 8 to 11, with "table10-pairs" and "table11-pairs": p-values and Holm's correction. LSD marks pairs only where
/// Friedman's test, by F, found that the algorithms differ. Empty where runs are missing.
[[nodiscard]] std::vector<presentation::Table> rank_tables(const Selection& selection, bool blocked);

/// Table 12: the pictured worlds, and how PMOMVO-6 does in them.
[[nodiscard]] presentation::Table picture_table(const Selection& selection, const StudyWorlds& scenes, bool blocked);

/// Tables 13 and 14: mean length and mean planning time over population and iterations.
[[nodiscard]] std::vector<presentation::Table> sensitivity_tables(const Selection& selection, bool blocked);

/// Table 15: PMOMVO-6, MOMVO and all others in the fifth world.
[[nodiscard]] presentation::Table comparison_table(const Selection& selection, bool blocked);

/// "success": how many paths of every algorithm reach in the blocked worlds.
[[nodiscard]] presentation::Table success_table(const Selection& selection);

/// "anytime": hypervolume at each checkpoint, of every algorithm. A note names those that had more before the end, by
/// the 95 % interval of paired differences.
[[nodiscard]] presentation::Table anytime_table(const Selection& selection, bool blocked);

/// All of them, the harder versions behind.
[[nodiscard]] std::vector<presentation::Table> all_tables(const Selection& selection, const StudyWorlds& scenes);

/// "table06" or "table06-blocked".
[[nodiscard]] std::string table_id(const char* number, bool blocked);
/// What the paper prints there; empty: nothing, or the world is a blocked one.
[[nodiscard]] std::string paper_text(bool blocked, const std::string& table, const std::string& row,
                                     const std::string& column, const std::string& statistic);
/// The sentence on threads and machines that each table of times carries.
[[nodiscard]] std::string timing_note(const Selection& selection);

}  // namespace jink::tools::lab::study
