// SPDX-License-Identifier: BSD-3-Clause
// The study as one page: prose, tables and figures in one HTML file that needs no other file, no network and no script.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tools/lab/presentation/table.hpp"

namespace jink::tools::lab::presentation {

/// A figure that was drawn, and its caption.
struct FigureFile {
  std::string id;       ///< "figure13": shown as "Figure 13"; another id is shown as it is
  std::string caption;  ///< sentences
  std::string svg;      ///< the element, figures::svg_element(); its ids are no other figure's
};

/// Points, one line or sentence each.
struct List {
  std::vector<std::string> points;
  std::string folded{};  ///< not empty: only this is shown until it is clicked
};

/// Facts with their names, set as a narrow table: what machine, what settings.
struct Facts {
  std::vector<std::pair<std::string, std::string>> facts;
};

/// A part of a section; a string is a paragraph. In prose, facts, notes and captions `code` between backquotes is set
/// as code and **text** between double stars as bold; all else is taken as it is.
using Part = std::variant<std::string, Table, FigureFile, List, Facts>;

struct Section {
  std::string heading;
  std::vector<Part> parts;
  int level = 1;  ///< 1: numbered, in the contents; 2: a part of the section before
};

struct Report {
  std::string title;
  std::string byline;                 ///< when, where, by which version; one line
  std::vector<std::string> abstract;  ///< paragraphs
  std::vector<Section> sections;
};

/// The page, in UTF-8. Throws as to_csv() does for a table.
[[nodiscard]] std::string report_html(const Report& report);

}  // namespace jink::tools::lab::presentation
