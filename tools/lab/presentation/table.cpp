// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/presentation/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "tools/lab/presentation/markup.hpp"

namespace jink::tools::lab::presentation {
namespace {

constexpr const char* kNothing = "-";

void check(const Table& table) {
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    if (table.rows[i].size() != table.columns.size())
      throw std::invalid_argument(fmt::format("table {}: row {} has {} cells, the headings are {}", table.id, i + 1,
                                              table.rows[i].size(), table.columns.size()));
}

template <typename Predicate>
bool any_in_column(const Table& table, std::size_t column, Predicate predicate) {
  return std::any_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return predicate(row[column]); });
}

std::string csv_cell(const Cell& cell) {
  if (cell.value) return fmt::format("{}", *cell.value);
  return cell.text == kNothing ? std::string() : csv_field(cell.text);
}

std::string markdown_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '_' || c == '`' || c == '\\') out += '\\';
    if (c == '<')
      out += "&lt;";
    else
      out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string markdown_cell(const Cell& cell) {
  std::string out = markdown_escaped(cell.text);
  if (cell.marked && !out.empty()) out = "**" + out + "**";
  if (!cell.paper.empty()) out += (out.empty() ? "[" : " [") + markdown_escaped(cell.paper) + "]";
  return out;
}

std::string latex_cell(const Cell& cell) {
  std::string out = latex_escaped(cell.text);
  if (cell.marked && !out.empty()) out = "\\textbf{" + out + "}";
  if (!cell.paper.empty()) out += (out.empty() ? "" : " ") + ("{\\tiny[" + latex_escaped(cell.paper) + "]}");
  return out;
}

bool has_paper(const Table& table) {
  return std::any_of(table.rows.begin(), table.rows.end(), [](const auto& row) {
    return std::any_of(row.begin(), row.end(), [](const Cell& cell) { return !cell.paper.empty(); });
  });
}

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

Cell label(std::string text) {
  return {std::move(text), std::nullopt, {}, false};
}

Cell number(double value, int decimals, std::string paper) {
  assert(decimals >= 0);
  std::string text = std::isnan(value)   ? std::string(kNothing)
                     : std::isinf(value) ? std::string(value > 0 ? "inf" : "-inf")
                                         : fmt::format("{:.{}f}", value, decimals);
  // A small negative number is not shown as "-0.00".
  if (text.front() == '-' && text.find_first_of("123456789i") == std::string::npos && text != kNothing)
    text.erase(0, 1);
  return {std::move(text), value, std::move(paper), false};
}

Cell nothing(std::string paper) {
  return {kNothing, std::nullopt, std::move(paper), false};
}

std::size_t repeated_labels(const Table& table, std::size_t row) {
  if (row == 0) return 0;
  const auto& above = table.rows[row - 1];
  const auto& here = table.rows[row];
  std::size_t count = 0;
  // The last label tells rows apart and always stays.
  while (count + 1 < table.label_columns && here[count].text == above[count].text) ++count;
  return count;
}

std::string to_csv(const Table& table) {
  check(table);
  std::vector<bool> paper, marks;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    paper.push_back(any_in_column(table, c, [](const Cell& cell) { return !cell.paper.empty(); }));
    marks.push_back(any_in_column(table, c, [](const Cell& cell) { return cell.marked; }));
  }
  std::string out;
  const auto line = [&](auto&& own, auto&& papers, auto&& marked) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (c > 0) out += ',';
      out += own(c);
      if (paper[c]) out += ',' + papers(c);
      if (marks[c]) out += ',' + marked(c);
    }
    out += '\n';
  };
  line([&](std::size_t c) { return csv_field(table.columns[c]); },
       [&](std::size_t c) { return csv_field(table.columns[c] + " (paper)"); },
       [&](std::size_t c) { return csv_field(table.columns[c] + " (marked)"); });
  for (const auto& row : table.rows)
    line([&](std::size_t c) { return csv_cell(row[c]); }, [&](std::size_t c) { return csv_field(row[c].paper); },
         [&](std::size_t c) { return std::string(row[c].marked ? "yes" : "no"); });
  return out;
}

std::string to_markdown(const Table& table) {
  check(table);
  std::string out = fmt::format("### {}: {}\n\n|", table_name(table.id), markdown_escaped(table.title));
  for (const std::string& column : table.columns) out += ' ' + markdown_escaped(column) + " |";
  out += "\n|";
  for (std::size_t c = 0; c < table.columns.size(); ++c) out += c < table.label_columns ? " --- |" : " ---: |";
  out += '\n';
  for (const auto& row : table.rows) {
    out += '|';
    for (const Cell& cell : row) out += ' ' + markdown_cell(cell) + " |";
    out += '\n';
  }
  if (has_paper(table) || !table.notes.empty()) out += '\n';
  if (has_paper(table)) out += "- In brackets: the paper's numbers, as printed.\n";
  for (const std::string& note : table.notes) out += "- " + note + '\n';
  return out;
}

std::string to_latex(const Table& table) {
  check(table);
  const char* const size = table.columns.size() > kManyColumns ? "\\scriptsize\n\\setlength{\\tabcolsep}{2.5pt}"
                                                               : "\\small\n\\setlength{\\tabcolsep}{4pt}";
  std::string out = "% Needs \\usepackage{booktabs}.\n\\begin{table}[htbp]\n\\centering\n\\caption{" +
                    latex_escaped(table.title) + "}\n\\label{tab:" + table.id + "}\n" + size + "\n\\begin{tabular}{";
  for (std::size_t c = 0; c < table.columns.size(); ++c) out += c < table.label_columns ? 'l' : 'r';
  out += "}\n\\toprule\n";
  for (std::size_t c = 0; c < table.columns.size(); ++c) out += (c > 0 ? " & " : "") + latex_escaped(table.columns[c]);
  out += " \\\\\n\\midrule\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const std::size_t repeated = repeated_labels(table, r);
    if (r > 0 && table.label_columns > 1 && repeated == 0) out += "\\addlinespace\n";
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (c > 0) out += " & ";
      if (c >= repeated) out += latex_cell(table.rows[r][c]);
    }
    out += " \\\\\n";
  }
  out += "\\bottomrule\n\\end{tabular}\n";
  if (has_paper(table)) out += "\\par\\smallskip\\footnotesize In brackets: the paper's numbers, as printed.\n";
  for (const std::string& note : table.notes) out += "\\par\\smallskip\\footnotesize " + latex_prose(note) + "\n";
  return out + "\\end{table}\n";
}

std::string numbered_name(const std::string& id, std::string_view stem, std::string_view shown) {
  const std::size_t end = id.starts_with(stem) ? id.find_first_not_of("0123456789", stem.size()) : stem.size();
  if (end == stem.size() || id.size() == stem.size() || (end != std::string::npos && id[end] != '-')) return id;
  const std::string number = id.substr(stem.size(), end == std::string::npos ? end : end - stem.size());
  const std::size_t digits = std::min(number.find_first_not_of('0'), number.size() - 1);
  std::string name = fmt::format("{} {}", shown, number.substr(digits));
  if (end == std::string::npos) return name;
  name += ", " + id.substr(end + 1);
  std::replace(name.begin(), name.end(), '-', ' ');
  return name;
}

std::string table_name(const std::string& id) {
  return numbered_name(id, "table", "Table");
}

}  // namespace jink::tools::lab::presentation
