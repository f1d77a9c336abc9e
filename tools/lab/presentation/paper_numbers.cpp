// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/presentation/paper_numbers.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/lab/presentation/embedded.hpp"

namespace jink::tools::lab::presentation {
namespace {

constexpr std::string_view kHeader = "table,row,column,statistic,printed,where,note";

[[noreturn]] void refuse(std::size_t line, const char* reason) {
  throw std::logic_error("paper_numbers.csv:" + std::to_string(line) + ": " + reason);
}

/// Takes a field off the line's front. In quotes where it has a comma; a quote itself is in none.
std::string_view field(std::string_view& line, std::size_t number) {
  const bool quoted = line.starts_with('"');
  if (quoted) line.remove_prefix(1);
  const std::size_t end = std::min(line.find(quoted ? '"' : ','), line.size());
  if (quoted && end == line.size()) refuse(number, "a quote is not closed");
  const std::string_view text = line.substr(0, end);
  line.remove_prefix(std::min(line.size(), end + (quoted ? 1 : 0)));
  if (line.starts_with(','))
    line.remove_prefix(1);
  else if (!line.empty())
    refuse(number, "a comma is missing");
  return text;
}

std::vector<PaperNumber> parsed(std::string_view text) {
  std::vector<PaperNumber> numbers;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    if (number == 1) {
      if (line != kHeader) refuse(number, "the headings are others");
      continue;
    }
    std::array<std::string_view, 7> fields;
    for (std::string_view& f : fields) f = field(line, number);
    if (!line.empty()) refuse(number, "there are more than 7 fields");
    if (fields[4].empty()) refuse(number, "nothing is printed");
    numbers.push_back({fields[0], fields[1], fields[2], fields[3], fields[4], fields[5], fields[6]});
  }
  return numbers;
}

// Read once at the program's start: the text is compiled in, and a test reads it too.
const std::vector<PaperNumber> kNumbers = parsed(paper_numbers_csv());

}  // namespace

std::span<const PaperNumber> paper_numbers() {
  return kNumbers;
}

std::optional<std::string_view> paper_number(std::string_view table, std::string_view row, std::string_view column,
                                             std::string_view statistic) {
  const auto found = std::find_if(kNumbers.begin(), kNumbers.end(), [&](const PaperNumber& n) {
    return n.table == table && n.row == row && n.column == column && n.statistic == statistic;
  });
  if (found == kNumbers.end()) return std::nullopt;
  return found->printed;
}

}  // namespace jink::tools::lab::presentation
