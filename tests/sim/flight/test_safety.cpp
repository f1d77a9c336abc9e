// SPDX-License-Identifier: BSD-3-Clause
// What happens × when × for whom: each cell of the tables of docs/safety.md is flown, held to what must never be, and
// compared with what the document says. JINK_REWRITE=1 writes the tables instead.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "bridge/supervisor/hazards.hpp"
#include "tests/sim/flight/safety_table.hpp"
#include "tests/sim/flight/safety_words.hpp"
#include "tests/support/repetitions.hpp"
#include "tests/support/temporary_folder.hpp"

namespace jink::sim::flight::safety {
namespace {

using bridge::supervisor::Phase;

const std::filesystem::path kDocument = std::filesystem::path(JINK_SOURCE_DIR) / "docs" / "safety.md";

bool rewrites() {
  const char* rewrite = std::getenv("JINK_REWRITE");
  return rewrite != nullptr && std::string_view(rewrite) == "1";
}

struct Place {
  const Group* group;
  const Happening* what;
};

std::vector<Place> places() {
  std::vector<Place> all;
  for (const Group& group : groups()) {
    for (const Happening& what : group.happenings) all.push_back({&group, &what});
  }
  return all;
}

std::string name_of(const testing::TestParamInfo<Place>& info) {
  std::string name(info.param.what->name);
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

void PrintTo(const Place& place, std::ostream* out) {
  *out << place.what->name;
}

std::string text_of(const Cell& cell) {
  return std::string(bridge::supervisor::to_string(cell.phase)) + " + " + std::to_string(cell.moment) + " s" +
         (cell.transmitter ? ", with a transmitter" : "") + (cell.writers > 1 ? ", two writers" : "") +
         (cell.tells_modes ? "" : ", without CURRENT_MODE");
}

std::string all_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

class Safety : public testing::TestWithParam<Place> {
 protected:
  /// In one process all of them, so that the tables can be written.
  static std::map<std::string, Row>& flown() {
    static std::map<std::string, Row> all;
    return all;
  }

  static void TearDownTestSuite() {
    if (!rewrites()) return;
    if (flown().size() != places().size()) {
      std::printf("not all rows were flown: docs/safety.md stays\n");
      return;
    }
    const auto row_of = [](const Happening& what) -> const Row& { return flown().at(std::string(what.name)); };
    support::write(kDocument, replaced(support::read(kDocument), tables(row_of)));
  }

  [[nodiscard]] const Happening& what() const { return *GetParam().what; }

  /// Its word, where nothing happened that must never be.
  [[nodiscard]] std::string fly(const Cell& cell) const {
    SCOPED_TRACE(text_of(cell));
    Flight flight(what(), cell);
    flight.run();
    EXPECT_TRUE(flight.faults().empty()) << all_of(flight.faults())
                                         << "\n  it says: " << flight.companion().supervisor().reason();
    if (cell.phase == Phase::kFlying && (cell.writers > 1) == what().takes_two && !what().hazard.empty())
      expect_hazard(flight);
    return std::string(word_of(flight, what(), cell));
  }

  void expect_hazard(const Flight& flight) const {
    const auto tells = [&](const Flight::Event& event) {
      return event.detail.find(what().hazard) != std::string::npos;  // the hazard, or the reason
    };
    EXPECT_TRUE(std::any_of(flight.events().begin(), flight.events().end(), tells)) << what().hazard;
  }
};

TEST_P(Safety, WhatTheDocumentSaysIsWhatHappens) {
  Row row;
  for (std::size_t v = 0; v < (support::kSanitized ? 1 : kVariants); ++v) {
    for (std::size_t i = 0; i < kColumns; ++i) {
      if (support::kSanitized && i % 4 != 0) continue;
      const auto& [name, phase, moment] = columns()[i];
      row[v][i] = fly({phase, moment, variants()[v].transmitter, variants()[v].writers});
    }
  }
  flown()[std::string(what().name)] = row;
  if (rewrites()) return;
  for (const bool air : {false, true}) {
    const std::vector<std::string> said = lines_in(support::read(kDocument), *GetParam().group, what(), air);
    ASSERT_FALSE(said.empty()) << "docs/safety.md has no row '" << what().name << "': see CONTRIBUTING.md";
    const std::vector<std::string> cells = cells_of(said.front());
    ASSERT_EQ(cells.size(), 1 + (air ? kColumns - kOnGround : kOnGround));
    for (std::size_t i = 1; i < cells.size(); ++i) {
      const std::size_t column = (air ? kOnGround : 0) + i - 1;
      EXPECT_FALSE(cells[i].empty()) << columns()[column].name;
      if (!row[0][column].empty()) {
        EXPECT_EQ(cells[i], row[0][column]) << columns()[column].name;
      }
    }
    if (!support::kSanitized) {
      EXPECT_EQ(all_of(said), all_of(lines_of(what(), row, air)));
    }
  }
}

// At other moments of the phases, with a transmitter and without, with CURRENT_MODE and without; what the table says of
// such a moment may be another word.
TEST_P(Safety, WhatMustNeverBeIsNotAtOtherMomentsEither) {
  constexpr std::array kMoments = {0.0, 0.06, 0.2, 0.5, 1.1, 2.0, 3.5};  // s
  for (int p = 0; p < static_cast<int>(Phase::kDone); p += support::kSanitized ? 3 : 1) {
    const auto phase = static_cast<Phase>(p);
    for (std::size_t m = 0; m < kMoments.size(); m += support::kSanitized ? kMoments.size() : 1) {
      const std::size_t variant = static_cast<std::size_t>(p) + m;
      const Cell cell{phase, kMoments[m], variant % 2 != 0, 1 + static_cast<int>(variant / 4 % 2),
                      variant / 2 % 2 == 0};
      SCOPED_TRACE(text_of(cell));
      Flight flight(what(), cell);
      flight.run();
      if (!flight.began()) break;  // the phase was over by then
      EXPECT_TRUE(flight.faults().empty())
          << all_of(flight.faults()) << "\n  it says: " << flight.companion().supervisor().reason();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, Safety, testing::ValuesIn(places()), name_of);

TEST(SafetyTables, EachHazardOfTheSupervisorIsMade) {
  for (const bridge::supervisor::Hazard& hazard : bridge::supervisor::hazards()) {
    const std::vector<Place> all = places();
    const auto makes = [&](const Place& place) { return place.what->hazard == hazard.what; };
    EXPECT_EQ(std::count_if(all.begin(), all.end(), makes), 1) << hazard.what;
  }
}

TEST(SafetyTables, TheDocumentHasTheseRowsAndNoOthers) {
  const std::string document = support::read(kDocument);
  std::size_t lines = 2 * 2 * groups().size();  // two tables a group, each with two lines above its rows
  for (const Place& place : places()) {
    for (const bool air : {false, true}) {
      const std::size_t said = lines_in(document, *place.group, *place.what, air).size();
      EXPECT_GT(said, 0U) << place.what->name;
      lines += said;
    }
  }
  const std::string all = tables_in(document);
  std::size_t bars = 0;
  for (std::size_t at = 0; (at = all.find("\n|", at)) != std::string::npos; ++at) ++bars;
  EXPECT_EQ(bars, lines);
}

}  // namespace
}  // namespace jink::sim::flight::safety
