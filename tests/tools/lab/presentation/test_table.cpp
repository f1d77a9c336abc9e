// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/presentation/table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace jink::tools::lab::presentation {
namespace {

/// Two algorithms with two statistics each; a name that every form has to escape.
Table sample_table() {
  Table table;
  table.id = "table06";
  table.title = "SLR & more: 100 % of a_b";
  table.columns = {"Algorithm", "", "Scenario 1", "Scenario 2, \"hard\""};
  table.label_columns = 2;
  Cell best = number(1.00012345, 4, "1.0204");
  best.marked = true;
  table.rows = {{label("A|B_1"), label("Best"), best, number(2.0, 1)},
                {label("A|B_1"), label("Mean"), number(1.5, 4, "1.0321"), nothing()},
                {label("NSGA-II"), label("Best"), number(1.25, 4), nothing()}};
  table.notes = {"With `--runs 20`, see **below**."};
  return table;
}

TEST(Cell, ShowsNumbersWithTheirDecimals) {
  EXPECT_EQ(number(1.23456, 3).text, "1.235");
  EXPECT_EQ(number(1.23456, 3).value, 1.23456);
  EXPECT_EQ(number(12.0, 0).text, "12");
  EXPECT_EQ(number(-0.0001, 2).text, "0.00");
  EXPECT_EQ(number(-0.01, 2).text, "-0.01");
  EXPECT_EQ(number(std::nan(""), 2).text, "-");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity(), 2).text, "inf");
  EXPECT_EQ(number(-std::numeric_limits<double>::infinity(), 2).text, "-inf");
  EXPECT_FALSE(nothing("5").value.has_value());
}

TEST(TableCsv, PutsThePapersNumbersAndMarksInColumnsOfTheirOwn) {
  EXPECT_EQ(to_csv(sample_table()),
            "Algorithm,,Scenario 1,Scenario 1 (paper),Scenario 1 (marked),\"Scenario 2, \"\"hard\"\"\"\n"
            "A|B_1,Best,1.00012345,1.0204,yes,2\n"
            "A|B_1,Mean,1.5,1.0321,no,\n"
            "NSGA-II,Best,1.25,,no,\n");
}

TEST(TableCsv, WritesNumbersInFull) {
  Table table;
  table.columns = {"x"};
  table.rows = {{number(1.0 / 3.0, 1)}, {number(std::nan(""), 1)}};
  EXPECT_EQ(to_csv(table), "x\n0.3333333333333333\nnan\n");
}

TEST(TableMarkdown, HasThePapersNumbersInBrackets) {
  EXPECT_EQ(to_markdown(sample_table()),
            "### Table 6: SLR & more: 100 % of a\\_b\n\n"
            "| Algorithm |  | Scenario 1 | Scenario 2, \"hard\" |\n"
            "| --- | --- | ---: | ---: |\n"
            "| A\\|B\\_1 | Best | **1.0001** [1.0204] | 2.0 |\n"
            "| A\\|B\\_1 | Mean | 1.5000 [1.0321] | - |\n"
            "| NSGA-II | Best | 1.2500 | - |\n"
            "\n- In brackets: the paper's numbers, as printed.\n"
            "- With `--runs 20`, see **below**.\n");
}

TEST(TableLatex, GroupsRowsAndEscapes) {
  EXPECT_EQ(to_latex(sample_table()),
            "% Needs \\usepackage{booktabs}.\n"
            "\\begin{table}[htbp]\n\\centering\n"
            "\\caption{SLR \\& more: 100 \\% of a\\_b}\n\\label{tab:table06}\n"
            "\\small\n\\setlength{\\tabcolsep}{4pt}\n"
            "\\begin{tabular}{llrr}\n\\toprule\n"
            "Algorithm &  & Scenario 1 & Scenario 2, ''hard'' \\\\\n\\midrule\n"
            "A\\textbar{}B\\_1 & Best & \\textbf{1.0001} {\\tiny[1.0204]} & 2.0 \\\\\n"
            " & Mean & 1.5000 {\\tiny[1.0321]} & - \\\\\n"
            "\\addlinespace\n"
            "NSGA-II & Best & 1.2500 & - \\\\\n"
            "\\bottomrule\n\\end{tabular}\n"
            "\\par\\smallskip\\footnotesize In brackets: the paper's numbers, as printed.\n"
            "\\par\\smallskip\\footnotesize With \\texttt{--runs 20}, see \\textbf{below}.\n"
            "\\end{table}\n");
}

TEST(TableLatex, WritesSignsThatItsFontsLackAsMathematics) {
  Table table;
  table.title = "μ ≤ 5 × σ², [±1] \\ {x} #1 a^b ~ <";
  table.columns = {"x"};
  EXPECT_NE(to_latex(table).find("\\caption{$\\mu$ $\\leq$ 5 $\\times$ $\\sigma$$^2$, {[}$\\pm$1{]} \\textbackslash{} "
                                 "\\{x\\} \\#1 a\\textasciicircum{}b \\textasciitilde{} $<$}"),
            std::string::npos)
      << to_latex(table);
}

TEST(Table, WithoutPapersNumbersSaysNothingOfThem) {
  Table table;
  table.id = "x";
  table.columns = {"a", "b"};
  table.rows = {{label("r"), number(1.0, 1)}};
  EXPECT_EQ(to_csv(table), "a,b\nr,1\n");
  EXPECT_EQ(to_markdown(table).find("bracket"), std::string::npos);
  EXPECT_EQ(to_latex(table).find("bracket"), std::string::npos);
}

TEST(Table, RefusesARowOfAnotherLength) {
  Table table = sample_table();
  table.rows[1].pop_back();
  for (const auto& form : {to_csv, to_markdown, to_latex}) {
    try {
      (void)form(table);
      FAIL() << "accepted";
    } catch (const std::invalid_argument& e) {
      EXPECT_STREQ(e.what(), "table table06: row 2 has 3 cells, the headings are 4");
    }
  }
}

TEST(TableName, IsThePapers) {
  EXPECT_EQ(table_name("table03"), "Table 3");
  EXPECT_EQ(table_name("table15"), "Table 15");
  EXPECT_EQ(table_name("table00"), "Table 0");
  EXPECT_EQ(table_name("table"), "table");
  EXPECT_EQ(table_name("harder-table03"), "harder-table03");
  EXPECT_EQ(table_name("table3b"), "table3b");
  EXPECT_EQ(table_name("table07-flight-blocked"), "Table 7, flight blocked");
  EXPECT_EQ(table_name("table-blocked"), "table-blocked");
}

TEST(RepeatedLabels, NeverHidesTheLastLabel) {
  Table table = sample_table();
  EXPECT_EQ(repeated_labels(table, 0), 0U);
  EXPECT_EQ(repeated_labels(table, 1), 1U);
  EXPECT_EQ(repeated_labels(table, 2), 0U);
  table.rows[1][1] = label("Best");
  EXPECT_EQ(repeated_labels(table, 1), 1U);
  table.label_columns = 1;
  EXPECT_EQ(repeated_labels(table, 1), 0U);
}

}  // namespace
}  // namespace jink::tools::lab::presentation
