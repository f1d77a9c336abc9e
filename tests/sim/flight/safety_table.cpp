// SPDX-License-Identifier: BSD-3-Clause
#include "tests/sim/flight/safety_table.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace jink::sim::flight::safety {
namespace {

using bridge::supervisor::Phase;

constexpr std::string_view kBegins = "<!-- The tables are the test's: see CONTRIBUTING.md. -->\n";
constexpr std::string_view kEnds = "<!-- End of the tables. -->\n";

std::string heading(const Group& group) {
  return "### " + std::string(group.name);
}

std::string header(bool air) {
  std::string line = air ? "| in the air |" : "| on the ground |";
  const auto& all = columns();
  for (std::size_t i = air ? kOnGround : 0; i < (air ? kColumns : kOnGround); ++i)
    line += " " + std::string(all[i].name) + " |";
  return line;
}

std::string line(std::string_view label, const Words& words, bool air) {
  std::string text = "| " + std::string(label) + " |";
  for (std::size_t i = air ? kOnGround : 0; i < (air ? kColumns : kOnGround); ++i) text += " " + words[i] + " |";
  return text;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string one; std::getline(in, one);) lines.push_back(one);
  return lines;
}

// From where on, and how long.
std::pair<std::size_t, std::size_t> place_of(const std::string& document) {
  const std::size_t begins = document.find(kBegins);
  const std::size_t ends = document.find(kEnds);
  if (begins == std::string::npos || ends == std::string::npos || ends < begins)
    throw std::runtime_error("docs/safety.md has no place for the tables");
  const std::size_t from = begins + kBegins.size();
  return {from, ends - from};
}

bool of_variant(const std::string& line) {
  return line.rfind("| …", 0) == 0;
}

}  // namespace

const std::array<Column, kColumns>& columns() {
  static constexpr std::array<Column, kColumns> kAll{{
      {"waiting", Phase::kWaiting, 2.0},
      {"engaging", Phase::kEngaging, 0.3},
      {"armed", Phase::kClimbing, 0.0},
      {"climbing", Phase::kClimbing, 2.0},
      {"flying", Phase::kFlying, 1.0},
      {"stopping", Phase::kStopping, 0.1},
      {"handover", Phase::kHandover, 0.0},
      {"landing", Phase::kLanding, 0.5},
  }};
  return kAll;
}

const std::array<Variant, kVariants>& variants() {
  static constexpr std::array<Variant, kVariants> kAll{{
      {"", false, 1},
      {"… with a transmitter", true, 1},
      {"… of two writers", false, 2},
      {"… of two, with a transmitter", true, 2},
  }};
  return kAll;
}

std::vector<std::string> lines_of(const Happening& what, const Row& row, bool air) {
  std::vector<std::string> lines = {line(what.name, row[0], air)};
  for (std::size_t v = 1; v < kVariants; ++v) {
    Words words = row[v];
    bool differs = false;
    for (std::size_t i = air ? kOnGround : 0; i < (air ? kColumns : kOnGround); ++i) {
      // Of both together it is told only what neither alone tells.
      const bool told = v == 3 && (row[3][i] == row[1][i] || row[3][i] == row[2][i]);
      if (words[i] == row[0][i] || told) words[i] = "=";
      differs = differs || words[i] != "=";
    }
    if (differs) lines.push_back(line(variants()[v].name, words, air));
  }
  return lines;
}

std::vector<std::string> lines_in(const std::string& document, const Group& group, const Happening& what, bool air) {
  const std::vector<std::string> all = split(document);
  std::vector<std::string> lines;
  auto at = std::find(all.begin(), all.end(), heading(group));
  at = std::find(at, all.end(), header(air));
  const std::string begins = "| " + std::string(what.name) + " |";
  at = std::find_if(at, all.end(), [&](const std::string& l) { return l.empty() || l.rfind(begins, 0) == 0; });
  if (at == all.end() || at->empty()) return lines;
  do lines.push_back(*at);
  while (++at != all.end() && of_variant(*at));
  return lines;
}

std::string tables(const std::function<const Row&(const Happening&)>& row_of) {
  std::string text;
  for (const Group& group : groups()) {
    text += "\n" + heading(group) + "\n";
    for (const bool air : {false, true}) {
      text += "\n" + header(air) + "\n|";
      for (std::size_t i = 0; i <= (air ? kColumns - kOnGround : kOnGround); ++i) text += "---|";
      text += "\n";
      for (const Happening& what : group.happenings) {
        for (const std::string& one : lines_of(what, row_of(what), air)) text += one + "\n";
      }
    }
  }
  return text + "\n";
}

std::string tables_in(const std::string& document) {
  const auto [from, size] = place_of(document);
  return document.substr(from, size);
}

std::string replaced(std::string document, const std::string& tables) {
  const auto [from, size] = place_of(document);
  return document.replace(from, size, tables);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  std::string cell;
  std::getline(in, cell, '|');  // before the first bar
  while (std::getline(in, cell, '|')) {
    const std::size_t first = cell.find_first_not_of(' ');
    const std::size_t last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

}  // namespace jink::sim::flight::safety
