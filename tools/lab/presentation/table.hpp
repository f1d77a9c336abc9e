// SPDX-License-Identifier: BSD-3-Clause
// A table of the study, and its forms: CSV to compute with, Markdown to read, LaTeX to print.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jink::tools::lab::presentation {

/// More are set closer, and smaller in print.
inline constexpr std::size_t kManyColumns = 7;

/// One place of a table.
struct Cell {
  std::string text;             ///< as shown
  std::optional<double> value;  ///< the number behind the text, in full; none: a label, or nothing measured
  std::string paper;            ///< what the paper prints there, as printed; empty: nothing
  bool marked = false;          ///< bold: a significant difference, or the best of a group
};

/// A label.
[[nodiscard]] Cell label(std::string text);
/// A number shown with `decimals` places behind the point, "-" for NaN and "inf" for infinity, with the paper's
/// beside it. Requires decimals >= 0.
[[nodiscard]] Cell number(double value, int decimals, std::string paper = {});
/// A place without a number of ours ("-"), which may have one of the paper's.
[[nodiscard]] Cell nothing(std::string paper = {});

struct Table {
  std::string id;                    ///< "table03": the files' name and the label to refer to
  std::string title;                 ///< plain text, a sentence without its full stop
  std::vector<std::string> columns;  ///< headings, units in them
  std::vector<std::vector<Cell>> rows;
  std::vector<std::string> notes;  ///< sentences below the table
  std::size_t label_columns = 1;   ///< so many columns at the left hold labels; an equal label below another is not
                                   ///< repeated where the form can show that the rows belong together
};

/// "Table 3" of the id "table03", "Table 3, blocked" of "table03-blocked"; another id as it is ("harder-table03").
[[nodiscard]] std::string table_name(const std::string& id);
/// The same for any stem: ("figure08", "figure", "Figure").
[[nodiscard]] std::string numbered_name(const std::string& id, std::string_view stem, std::string_view shown);

/// How many of a row's labels are those of the row above and need not be shown again; never all of them.
[[nodiscard]] std::size_t repeated_labels(const Table& table, std::size_t row);

/// A field of RFC 4180, in quotes where it needs them.
[[nodiscard]] std::string csv_field(const std::string& text);

/// RFC 4180 with "\n" as the line's end. A number is written in full (the shortest text that reads back as the same
/// double; "nan", "inf"), a label as its text, a place without a number as nothing. Behind each column of which the
/// paper prints a number comes "HEADING (paper)", and behind each with a mark "HEADING (marked)" with yes or no. Notes
/// are left out. Throws std::invalid_argument naming the table where a row has another length than the headings; so do
/// the others.
[[nodiscard]] std::string to_csv(const Table& table);

/// A GitHub table under its title as a heading of level 3, the paper's numbers in brackets behind ours, marks bold, the
/// notes as a list below.
[[nodiscard]] std::string to_markdown(const Table& table);

/// A `table` environment with caption and `\label{tab:ID}` for \input; needs the package booktabs alone. The paper's
/// numbers are in brackets and small, marks bold, the notes below in the same float. Text is escaped, not interpreted.
/// Written in UTF-8, which LaTeX reads by itself since 2018.
[[nodiscard]] std::string to_latex(const Table& table);

}  // namespace jink::tools::lab::presentation
