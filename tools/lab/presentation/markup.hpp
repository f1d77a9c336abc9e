// SPDX-License-Identifier: BSD-3-Clause
// The two marks that the study's prose has: `code` and **bold**. Internal to the presentation.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace jink::tools::lab::presentation {

enum class Style { plain, code, bold };

/// A stretch of text in one style.
struct Run {
  Style style = Style::plain;
  std::string text;
};

/// The text cut at its marks. A mark without its end is text.
[[nodiscard]] std::vector<Run> runs(std::string_view text);

/// For HTML, in elements and in quoted attributes.
[[nodiscard]] std::string html_escaped(std::string_view text);
/// For LaTeX's text mode; the Greek letters and signs that LaTeX's fonts lack by default become mathematics.
[[nodiscard]] std::string latex_escaped(std::string_view text);

/// Marked text in HTML (code, strong) and in LaTeX (texttt, textbf), escaped.
[[nodiscard]] std::string html_prose(std::string_view text);
[[nodiscard]] std::string latex_prose(std::string_view text);

}  // namespace jink::tools::lab::presentation
