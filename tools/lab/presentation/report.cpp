// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/presentation/report.hpp"

#include <fmt/format.h>

#include "tools/lab/presentation/embedded.hpp"
#include "tools/lab/presentation/markup.hpp"

namespace jink::tools::lab::presentation {
namespace {

std::string figure_name(const std::string& id) {
  return numbered_name(id, "figure", "Figure");
}

std::string cell_html(const Cell& cell, const char* element, bool number) {
  std::string inner = html_escaped(cell.text);
  if (cell.marked && !inner.empty()) inner = "<strong>" + inner + "</strong>";
  if (!cell.paper.empty()) inner += "<span class=\"paper\">[" + html_escaped(cell.paper) + "]</span>";
  return fmt::format("<{0}{1}>{2}</{0}>", element, number ? " class=\"n\"" : "", inner);
}

std::string part_html(const Table& table) {
  (void)to_csv(table);  // throws where rows and headings do not fit
  std::string html = fmt::format(
      "<div class=\"wide\" id=\"{}\">\n<table class=\"data{}\">\n<caption><strong>{}.</strong> "
      "{}</caption>\n<thead><tr>",
      html_escaped(table.id), table.columns.size() > kManyColumns ? " many" : "", html_escaped(table_name(table.id)),
      html_prose(table.title));
  for (std::size_t c = 0; c < table.columns.size(); ++c)
    html += cell_html(label(table.columns[c]), "th", c >= table.label_columns);
  html += "</tr></thead>\n<tbody>\n";
  bool paper = false;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const std::size_t repeated = repeated_labels(table, r);
    html += r > 0 && table.label_columns > 1 && repeated == 0 ? "<tr class=\"group\">" : "<tr>";
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Cell& cell = table.rows[r][c];
      html += cell_html(c < repeated ? Cell{} : cell, "td", c >= table.label_columns);
      paper = paper || !cell.paper.empty();
    }
    html += "</tr>\n";
  }
  html += "</tbody>\n</table>\n";
  if (paper || !table.notes.empty()) {
    html += "<div class=\"notes\">";
    if (paper) html += "<p>In brackets: the paper's numbers, as printed.</p>";
    for (const std::string& note : table.notes) html += "<p>" + html_prose(note) + "</p>";
    html += "</div>\n";
  }
  return html + "</div>\n";
}

std::string part_html(const std::string& paragraph) {
  return "<p>" + html_prose(paragraph) + "</p>\n";
}

std::string part_html(const FigureFile& figure) {
  return fmt::format("<figure id=\"{0}\">\n{1}\n<figcaption><strong>{2}.</strong> {3}</figcaption>\n</figure>\n",
                     html_escaped(figure.id), figure.svg, html_escaped(figure_name(figure.id)),
                     html_prose(figure.caption));
}

std::string part_html(const List& list) {
  std::string html = "<ul>\n";
  for (const std::string& point : list.points) html += "<li>" + html_prose(point) + "</li>\n";
  html += "</ul>\n";
  if (list.folded.empty()) return html;
  return "<details><summary>" + html_prose(list.folded) + "</summary>\n" + html + "</details>\n";
}

std::string part_html(const Facts& facts) {
  std::string html = "<table class=\"facts\">\n";
  for (const auto& [name, fact] : facts.facts)
    html += "<tr><th>" + html_prose(name) + "</th><td>" + html_prose(fact) + "</td></tr>\n";
  return html + "</table>\n";
}

/// The sections' numbers: "3" and "3.2".
std::vector<std::string> numbers_of(const std::vector<Section>& sections) {
  std::vector<std::string> numbers;
  int first = 0, second = 0;
  for (const Section& section : sections) {
    if (section.level == 1) {
      ++first;
      second = 0;
      numbers.push_back(std::to_string(first));
    } else {
      numbers.push_back(fmt::format("{}.{}", first, ++second));
    }
  }
  return numbers;
}

}  // namespace

std::string report_html(const Report& report) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, "
      "initial-scale=1\">\n<title>{}</title>\n<style>\n{}</style>\n"
      "</head>\n<body>\n<h1>{}</h1>\n",
      html_escaped(report.title), report_css(), html_escaped(report.title));
  if (!report.byline.empty()) html += "<p class=\"byline\">" + html_prose(report.byline) + "</p>\n";
  if (!report.abstract.empty()) {
    html += "<div class=\"abstract\">\n";
    for (const std::string& paragraph : report.abstract) html += part_html(paragraph);
    html += "</div>\n";
  }
  const std::vector<std::string> numbers = numbers_of(report.sections);
  html += "<nav><ol>\n";
  for (std::size_t i = 0; i < report.sections.size(); ++i)
    if (report.sections[i].level == 1)
      html +=
          fmt::format("<li><a href=\"#section-{}\">{}</a></li>\n", numbers[i], html_prose(report.sections[i].heading));
  html += "</ol></nav>\n";
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    const Section& section = report.sections[i];
    html += fmt::format("<h{0} id=\"section-{1}\">{1}{2} {3}</h{0}>\n", section.level == 1 ? 2 : 3, numbers[i],
                        section.level == 1 ? "." : "", html_prose(section.heading));
    for (const Part& part : section.parts) html += std::visit([](const auto& p) { return part_html(p); }, part);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace jink::tools::lab::presentation
