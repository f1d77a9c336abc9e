// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <stdexcept>

#include "tools/figures/figure.hpp"
#include "tools/lab/presentation/markup.hpp"
#include "tools/lab/presentation/report.hpp"

namespace jink::tools::lab::presentation {
namespace {

TEST(Markup, CutsTextAtItsMarks) {
  const auto cut = [](std::string_view text) {
    std::string all;
    for (const auto& run : runs(text))
      all += (run.style == Style::code ? "C" : run.style == Style::bold ? "B" : "P") + ("(" + run.text + ")");
    return all;
  };
  EXPECT_EQ(cut("run `jink study` **now**."), "P(run )C(jink study)P( )B(now)P(.)");
  EXPECT_EQ(cut("an `open end, **2 * 3"), "P(an `open end, **2 * 3)");
  EXPECT_EQ(cut("`**`"), "C(**)");
  EXPECT_EQ(cut("``"), "P(``)");
  EXPECT_EQ(cut(""), "");
}

TEST(Markup, IsEscapedInBothForms) {
  EXPECT_EQ(html_prose("a < b & `x > \"y\"`"), "a &lt; b &amp; <code>x &gt; &quot;y&quot;</code>");
  EXPECT_EQ(latex_prose("50 % of **a_b** `--runs`"), "50 \\% of \\textbf{a\\_b} \\texttt{--runs}");
}

Report sample_report() {
  jink::tools::figures::Figure figure;
  figure.id = "figure13";
  figure.panels.emplace_back();
  figure.panels[0].series.emplace_back();
  figure.panels[0].series[0].x = figure.panels[0].series[0].y = {1, 2};
  figure.panels[0].series[0].label = "Curve";
  const std::string first = jink::tools::figures::svg_of(figure);
  figure.id = "anytime";
  const std::string second = jink::tools::figures::svg_of(figure);

  Table table;
  table.id = "table06";
  table.title = "SLR < 1.1";
  table.columns = {"Algorithm", "", "Scenario 1"};
  table.label_columns = 2;
  Cell best = number(1.0, 4, "1.0204");
  best.marked = true;
  table.rows = {{label("A&B"), label("Best"), best}, {label("A&B"), label("Mean"), number(1.5, 4)}};
  table.notes = {"Note with `code`."};
  return {"The <study>",
          "by `jink`",
          {"What was found."},
          {{"Means", {"A paragraph.", table, FigureFile{"figure13", "A caption.", first}}, 1},
           {"More", {List{{"one", "two"}, "Folded"}, Facts{{{"CPU", "2 cores"}}}}, 2},
           {"Time", {FigureFile{"anytime", "Another.", second}}, 1}}};
}

TEST(ReportPage, HoldsAllPartsInTheirOrder) {
  const std::string html = report_html(sample_report());
  std::size_t at = 0;
  for (const char* part : {"<title>The &lt;study&gt;</title>",
                           "<h1>The &lt;study&gt;</h1>",
                           "by <code>jink</code>",
                           "<p>What was found.</p>",
                           "<a href=\"#section-1\">Means</a>",
                           "<a href=\"#section-2\">Time</a>",
                           "<h2 id=\"section-1\">1. Means</h2>",
                           "<p>A paragraph.</p>",
                           "<strong>Table 6.</strong> SLR &lt; 1.1",
                           "<th class=\"n\">Scenario 1</th>",
                           R"(<td>A&amp;B</td><td>Best</td>)",
                           R"(<td class="n"><strong>1.0000</strong>)",
                           R"(<span class="paper">[1.0204]</span></td>)",
                           "<td></td><td>Mean</td><td class=\"n\">1.5000</td>",
                           "<p>Note with <code>code</code>.</p>",
                           "<svg",
                           ">Curve<",
                           "</svg>",
                           "<strong>Figure 13.</strong> A caption.",
                           "<h3 id=\"section-1.1\">1.1 More</h3>",
                           "<details><summary>Folded</summary>",
                           "<li>two</li>",
                           "<tr><th>CPU</th><td>2 cores</td></tr>",
                           "<h2 id=\"section-2\">2. Time</h2>",
                           "<strong>anytime.</strong> Another."}) {
    const std::size_t found = html.find(part, at);
    ASSERT_NE(found, std::string::npos) << part;
    at = found;
  }
}

TEST(ReportPage, NeedsNothingElse) {
  const std::string html = report_html(sample_report());
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_EQ(html.find("<?xml"), std::string::npos);
  // The only addresses are the names of SVG's and XLink's own namespaces.
  const std::regex address("https?://[^\"' <]*");
  for (std::sregex_iterator found(html.begin(), html.end(), address), end; found != end; ++found)
    EXPECT_TRUE(found->str().starts_with("http://www.w3.org/")) << found->str();
}

TEST(ReportPage, IdsAreThePagesOwnAndReferencesFindThem) {
  const std::string html = report_html(sample_report());
  std::set<std::string> ids;
  const std::regex id(" id=['\"]([^'\"]*)['\"]"), reference("(?:href=['\"]|url\\()#([^'\")]*)");
  for (std::sregex_iterator found(html.begin(), html.end(), id), end; found != end; ++found)
    EXPECT_TRUE(ids.insert((*found)[1]).second) << (*found)[1];
  EXPECT_GT(ids.size(), 20U);
  for (std::sregex_iterator found(html.begin(), html.end(), reference), end; found != end; ++found)
    EXPECT_TRUE(ids.contains((*found)[1])) << (*found)[1];
}

TEST(ReportPage, RefusesATableWhoseRowsDoNotFit) {
  Table table;
  table.id = "table03";
  table.columns = {"a", "b"};
  table.rows = {{label("x")}};
  EXPECT_THROW((void)report_html({"t", "", {}, {{"h", {table}, 1}}}), std::invalid_argument);
}

}  // namespace
}  // namespace jink::tools::lab::presentation
