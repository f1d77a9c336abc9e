// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/presentation/markup.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace jink::tools::lab::presentation {
namespace {

using Replacement = std::pair<std::string_view, std::string_view>;

constexpr Replacement kHtml[]{
    {"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"},
};

constexpr Replacement kLatex[]{
    {"\\", "\\textbackslash{}"},
    {"{", "\\{"},
    {"}", "\\}"},
    {"$", "\\$"},
    {"&", "\\&"},
    {"#", "\\#"},
    {"%", "\\%"},
    {"_", "\\_"},
    {"^", "\\textasciicircum{}"},
    {"~", "\\textasciitilde{}"},
    {"<", "$<$"},
    {">", "$>$"},
    {"|", "\\textbar{}"},
    {"\"", "''"},
    {"[", "{[}"},  // behind \\ a bracket would be taken as a length
    {"]", "{]}"},
    {"α", "$\\alpha$"},
    {"β", "$\\beta$"},
    {"γ", "$\\gamma$"},
    {"δ", "$\\delta$"},
    {"λ", "$\\lambda$"},
    {"μ", "$\\mu$"},
    {"σ", "$\\sigma$"},
    {"φ", "$\\varphi$"},
    {"χ", "$\\chi$"},
    {"Δ", "$\\Delta$"},
    {"Σ", "$\\Sigma$"},
    {"≤", "$\\leq$"},
    {"≥", "$\\geq$"},
    {"≈", "$\\approx$"},
    {"±", "$\\pm$"},
    {"×", "$\\times$"},
    {"·", "$\\cdot$"},
    {"−", "$-$"},
    {"→", "$\\rightarrow$"},
    {"∞", "$\\infty$"},
    {"√", "$\\surd$"},
    {"²", "$^2$"},
    {"³", "$^3$"},
    {"°", "$^\\circ$"},
    {"…", "\\ldots{}"},
};

std::string replaced(std::string_view text, std::span<const Replacement> replacements) {
  std::string out;
  while (!text.empty()) {
    const Replacement* found = nullptr;
    for (const Replacement& r : replacements)
      if (text.starts_with(r.first)) found = &r;
    if (found != nullptr) {
      out += found->second;
      text.remove_prefix(found->first.size());
    } else {
      out += text.front() == '\n' ? ' ' : text.front();
      text.remove_prefix(1);
    }
  }
  return out;
}

}  // namespace

std::vector<Run> runs(std::string_view text) {
  std::vector<Run> result;
  const auto add = [&](Style style, std::string_view part) {
    if (part.empty()) return;
    if (style == Style::plain && !result.empty() && result.back().style == Style::plain)
      result.back().text += part;
    else
      result.push_back({style, std::string(part)});
  };
  while (!text.empty()) {
    const std::size_t at = std::min(text.find('`'), text.find("**"));
    add(Style::plain, text.substr(0, at));
    if (at == std::string_view::npos) break;
    const std::string_view mark = text[at] == '`' ? "`" : "**";
    const std::size_t begin = at + mark.size();
    const std::size_t end = text.find(mark, begin);
    if (end == std::string_view::npos || end == begin) {
      add(Style::plain, mark);
      text.remove_prefix(begin);
      continue;
    }
    add(mark == "`" ? Style::code : Style::bold, text.substr(begin, end - begin));
    text.remove_prefix(end + mark.size());
  }
  return result;
}

std::string html_escaped(std::string_view text) {
  return replaced(text, kHtml);
}

std::string latex_escaped(std::string_view text) {
  return replaced(text, kLatex);
}

std::string html_prose(std::string_view text) {
  std::string out;
  for (const Run& run : runs(text)) {
    const std::string inner = html_escaped(run.text);
    out += run.style == Style::code   ? "<code>" + inner + "</code>"
           : run.style == Style::bold ? "<strong>" + inner + "</strong>"
                                      : inner;
  }
  return out;
}

std::string latex_prose(std::string_view text) {
  std::string out;
  for (const Run& run : runs(text)) {
    const std::string inner = latex_escaped(run.text);
    out += run.style == Style::code   ? "\\texttt{" + inner + "}"
           : run.style == Style::bold ? "\\textbf{" + inner + "}"
                                      : inner;
  }
  return out;
}

}  // namespace jink::tools::lab::presentation
