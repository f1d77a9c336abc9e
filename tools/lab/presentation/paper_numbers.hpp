// SPDX-License-Identifier: BSD-3-Clause
// The numbers that the paper prints, as data: tools/lab/study/paper_numbers.csv, compiled in.
#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace jink::tools::lab::presentation {

/// One printed number. Rows and columns are named in one way for all tables:
///
///   table            row                        column                  statistic
///   table03..05      algorithm ("PMOMVO-6")     sharing rate "0".."9"   Best, Mean, Worst, STD
///   table06, table07 algorithm                  scenario "1".."5"       Best, Mean, Worst, STD
///   table08, table09 algorithm                  scenario, or "sum"      rank
///   table08, table09 all                        all                     Iman-Davenport F, critical F
///   table10, table11 algorithm                  algorithm               difference, underlined ("yes", "no")
///   table10, table11 all                        all                     critical difference
///   table13, table14 "ITERATIONS/POPULATION"    algorithm               length (in m) or time (in s)
///   table15          algorithm                  SLR, FT                 Best, Mean, Worst, STD
struct PaperNumber {
  std::string_view table;
  std::string_view row;
  std::string_view column;
  std::string_view statistic;
  std::string_view printed;  ///< as printed, misprints too
  std::string_view where;    ///< "Table 3, MOMVO (m = 0), Best, l = 0"
  std::string_view note;     ///< what contradicts it, in the paper or by arithmetic; empty for most
};

/// All of them, in the paper's order. Valid for the program's life.
[[nodiscard]] std::span<const PaperNumber> paper_numbers();

/// What is printed there; none where the paper prints nothing ("-" in its tables, l = 7, MOEA/D).
[[nodiscard]] std::optional<std::string_view> paper_number(std::string_view table, std::string_view row,
                                                           std::string_view column, std::string_view statistic);

}  // namespace jink::tools::lab::presentation
