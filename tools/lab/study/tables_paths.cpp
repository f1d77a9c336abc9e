// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tools/lab/study/tables.hpp"

namespace jink::tools::lab::study {
namespace {

std::string worlds_text(bool blocked) {
  return blocked ? "blocked worlds of the five sizes" : "the five scenarios";
}

/// Rows of four statistics for each algorithm, a column for each world. `sample` gives a cell's values.
void add_statistics(presentation::Table& table, const char* number_of_table, int decimals, bool blocked,
                    const std::function<std::vector<double>(const std::string&, const std::string&)>& sample) {
  for (const std::string& algorithm : own_algorithms()) {
    const std::string name = label_of(algorithm);
    for (const std::string& which : statistics_of_rows()) {
      std::vector<presentation::Cell> row{presentation::label(name), presentation::label(which)};
      for (const std::string& world : numbered_worlds(blocked)) {
        const std::string printed = paper_text(blocked, number_of_table, name, world_number(world), which);
        const std::vector<double> values = sample(algorithm, world);
        row.push_back(values.empty() ? presentation::nothing(printed)
                                     : presentation::number(statistic(values, which, Direction::kSmallerIsBetter),
                                                            decimals, printed));
      }
      table.rows.push_back(std::move(row));
    }
  }
}

presentation::Table world_table(const char* id, bool blocked, std::string title) {
  presentation::Table table;
  table.id = table_id(id, blocked);
  table.title = std::move(title);
  table.label_columns = 2;
  table.columns = {"Algorithm", "Statistic"};
  for (const std::string& world : numbered_worlds(blocked))
    table.columns.push_back((blocked ? "Blocked " : "Scenario ") + world_number(world));
  return table;
}

/// A row for each algorithm: how many paths reach the target.
void add_reached(presentation::Table& table, const Selection& selection, bool blocked) {
  for (const std::string& algorithm : own_algorithms()) {
    std::vector<presentation::Cell> row{presentation::label(label_of(algorithm)), presentation::label("Reached")};
    for (const std::string& world : numbered_worlds(blocked)) {
      const Records all = selection.paths(algorithm, world);
      const std::size_t count = reached(all).size();
      presentation::Cell cell = presentation::label(fmt::format("{}/{}", count, all.size()));
      if (!all.empty()) cell.value = static_cast<double>(count) / static_cast<double>(all.size());
      row.push_back(std::move(cell));
    }
    table.rows.push_back(std::move(row));
  }
}

presentation::Table slr_table(const Selection& selection, bool blocked) {
  presentation::Table table =
      world_table("table06", blocked, "Straight-line rate (SLR) of planned paths in " + worlds_text(blocked));
  add_statistics(table, "table06", blocked ? 4 : 8, blocked,
                 [&](const std::string& algorithm, const std::string& world) {
                   return values(reached(selection.paths(algorithm, world)), key::kSlr);
                 });
  add_reached(table, selection, blocked);
  table.notes.push_back("SLR of the paths that are free, checked in continuous time, and end at the target.");
  if (!blocked) {
    table.notes.push_back(
        "The straight flight is free in all five scenarios, so that an SLR of 1 is the optimum. The paper's STD is too "
        "large for its SLR; for PMOMVO-6 in scenario 5 its Table 15 has the same number beside the length in m.");
  } else {
    table.notes.push_back("Each run has another world, the same for all algorithms: STD is of worlds and seeds.");
  }
  return table;
}

presentation::Table planning_table(const Selection& selection, bool blocked) {
  presentation::Table table = world_table("table07", blocked, "Planning time (ms) in " + worlds_text(blocked));
  add_statistics(table, "table07", 3, blocked, [&](const std::string& algorithm, const std::string& world) {
    return scaled(measured(selection.paths(algorithm, world), key::kPlanning), 1000.0);
  });
  table.notes.push_back(timing_note(selection));
  if (!blocked) {
    table.notes.push_back(
        "The paper's FT, in s, is not only flight: paths of 12 to 22 m would take seconds. It is taken for planning "
        "time, of a MATLAB program, and stands beside ours as such.");
  }
  return table;
}

presentation::Table flight_table(const Selection& selection, bool blocked) {
  presentation::Table table =
      world_table("table07-flight", blocked, "Flight time (s) of the planned paths in " + worlds_text(blocked));
  add_statistics(table, "", 4, blocked, [&](const std::string& algorithm, const std::string& world) {
    return values(reached(selection.paths(algorithm, world)), key::kFlight);
  });
  table.notes.push_back("At cruise speed, slower where the climb limit asks for it; of the paths that reach.");
  return table;
}

presentation::Table rank_table(const statistics::Scores& scores, const char* id, const char* what, bool blocked) {
  presentation::Table table;
  table.id = table_id(id, blocked);
  table.title = fmt::format("Friedman ranks of the algorithms by {} in {}", what, worlds_text(blocked));
  table.columns = {"Algorithm"};
  for (const std::string& world : numbered_worlds(blocked)) table.columns.push_back(world_number(world));
  table.columns.emplace_back("Sum of ranks");
  const statistics::Scores ranks = statistics::friedman_ranks(scores);
  const std::vector<double> sums = statistics::rank_sums(ranks);
  const auto rank = [](double value, std::string printed) {
    return presentation::number(value, value == std::round(value) ? 0 : 1, std::move(printed));
  };
  for (std::size_t a = 0; a < ranks.size(); ++a) {
    const std::string name = label_of(own_algorithms()[a]);
    std::vector<presentation::Cell> row{presentation::label(name)};
    for (std::size_t s = 0; s < ranks[a].size(); ++s)
      row.push_back(rank(ranks[a][s], paper_text(blocked, id, name, std::to_string(s + 1), "rank")));
    row.push_back(rank(sums[a], paper_text(blocked, id, name, "sum", "rank")));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string p_text(double p) {
  return p < 1e-4 ? "p < 0.0001" : fmt::format("p = {:.4f}", p);
}

void add_friedman(presentation::Table& table, const statistics::Friedman& f, const char* id, bool blocked) {
  const std::string printed = paper_text(blocked, id, "all", "all", "Iman-Davenport F");
  table.notes.push_back(fmt::format(
      "Friedman: chi-square {:.3f}, {}; Iman and Davenport: F = {:.3f}{}, {}, critical {:.4f} at 5 %: the algorithms "
      "{}.",
      f.chi_square, p_text(f.p), f.iman_davenport, printed.empty() ? "" : fmt::format(" (the paper: {})", printed),
      p_text(f.iman_p), f.critical_f, f.rejected ? "differ" : "are not shown to differ"));
}

constexpr const char* kUnprotected =
    "LSD marks nothing here: it is for when the test by ranks finds that the algorithms differ, which it does not.";

/// Differences of rank sums, as Tables 10 and 11 have them. `differ`: Friedman's test found that the algorithms do.
presentation::Table matrix_table(const statistics::Lsd& lsd, bool differ, const char* id, const char* what,
                                 bool blocked) {
  const std::vector<std::string> own = own_algorithms();
  presentation::Table table;
  table.id = table_id(id, blocked);
  table.title = fmt::format("Paired comparison of the algorithms by {} in {}: differences of rank sums", what,
                            worlds_text(blocked));
  table.columns = {""};
  for (std::size_t b = 1; b < own.size(); ++b) table.columns.push_back(label_of(own[b]));
  for (std::size_t a = 0; a + 1 < own.size(); ++a) table.rows.emplace_back(1, presentation::label(label_of(own[a])));
  for (auto& row : table.rows) row.resize(own.size(), presentation::label(""));
  for (const statistics::Comparison& pair : lsd.pairs) {
    const auto a = static_cast<std::size_t>(pair.a);
    const auto b = static_cast<std::size_t>(pair.b);
    const double difference = std::abs(pair.difference);
    presentation::Cell cell =
        presentation::number(difference, difference == std::round(difference) ? 0 : 1,
                             paper_text(blocked, id, label_of(own[a]), label_of(own[b]), "difference"));
    cell.marked = differ && pair.lsd;
    table.rows[a][b] = std::move(cell);
  }
  const std::string printed = paper_text(blocked, id, "all", "all", "critical difference");
  const auto kept =
      std::count_if(lsd.pairs.begin(), lsd.pairs.end(), [](const statistics::Comparison& c) { return c.holm; });
  const auto found =
      std::count_if(lsd.pairs.begin(), lsd.pairs.end(), [](const statistics::Comparison& c) { return c.lsd; });
  table.notes.push_back(fmt::format(
      "{} the least significant difference {:.4f}{}, as the paper has it, one-sided; two-sided it is {:.4f}.",
      differ ? "Bold: more than" : "Not used:", lsd.critical,
      printed.empty() ? "" : fmt::format(" (the paper: {})", printed), lsd.critical_two_sided));
  table.notes.push_back(fmt::format("{} of {} pairs differ {}; with Holm's correction {} do.", found, lsd.pairs.size(),
                                    differ ? "so" : "by more", kept));
  if (!differ) table.notes.emplace_back(kUnprotected);
  return table;
}

presentation::Table pairs_table(const statistics::Lsd& lsd, bool differ, const char* id, const char* what,
                                bool blocked) {
  const std::vector<std::string> own = own_algorithms();
  presentation::Table table;
  table.id = table_id(id, blocked);
  table.title =
      fmt::format("Paired comparison by {} in {}: p-values and Holm's correction", what, worlds_text(blocked));
  table.columns = {"Algorithm", "Against", "Difference of rank sums", "p", "p (Holm)"};
  table.label_columns = 2;
  for (const statistics::Comparison& pair : lsd.pairs) {
    presentation::Cell difference =
        presentation::number(pair.difference, pair.difference == std::round(pair.difference) ? 0 : 1);
    difference.marked = differ && pair.lsd;
    presentation::Cell corrected = presentation::number(pair.p_holm, 5);
    corrected.marked = pair.holm;
    table.rows.push_back({presentation::label(label_of(own[static_cast<std::size_t>(pair.a)])),
                          presentation::label(label_of(own[static_cast<std::size_t>(pair.b)])), difference,
                          presentation::number(pair.p, 5), corrected});
  }
  table.notes.push_back(
      "Positive: the second is the better one. Bold: significant, by LSD as the paper has it, one-sided at 5 %, and by "
      "Holm. p is two-sided.");
  if (!differ) table.notes.emplace_back(kUnprotected);
  return table;
}

}  // namespace

std::vector<presentation::Table> path_tables(const Selection& selection, bool blocked) {
  return {slr_table(selection, blocked), planning_table(selection, blocked), flight_table(selection, blocked)};
}

std::optional<statistics::Scores> scores(const Selection& selection, Criterion criterion, bool blocked) {
  constexpr double kFailureWeight = 1000.0;  // any share of failures outweighs any length
  statistics::Scores result;
  for (const std::string& algorithm : own_algorithms()) {
    std::vector<double> row;
    for (const std::string& world : numbered_worlds(blocked)) {
      const Records all = selection.paths(algorithm, world);
      if (all.empty()) return std::nullopt;
      if (criterion == Criterion::kTime) {
        row.push_back(statistics::mean(measured(all, key::kPlanning)));
        continue;
      }
      const Records free = reached(all);
      const double failed = 1.0 - static_cast<double>(free.size()) / static_cast<double>(all.size());
      const double slr = free.empty() ? kFailureWeight : statistics::mean(values(free, key::kSlr));
      row.push_back(kFailureWeight * failed + std::round(slr / kSameSlr) * kSameSlr);
    }
    result.push_back(std::move(row));
  }
  return result;
}

std::vector<presentation::Table> rank_tables(const Selection& selection, bool blocked) {
  std::vector<presentation::Table> ranks, comparisons;
  struct Ids {
    Criterion criterion;
    const char *ranks, *matrix, *pairs, *what;
  };
  for (const Ids& ids : {Ids{Criterion::kLength, "table08", "table10", "table10-pairs", "mean SLR"},
                         Ids{Criterion::kTime, "table09", "table11", "table11-pairs", "mean planning time"}}) {
    const std::optional<statistics::Scores> found = scores(selection, ids.criterion, blocked);
    if (!found) continue;
    const statistics::Scores by_world = statistics::friedman_ranks(*found);
    const statistics::Friedman test = statistics::friedman(by_world);
    presentation::Table table = rank_table(*found, ids.ranks, ids.what, blocked);
    add_friedman(table, test, ids.ranks, blocked);
    if (ids.criterion == Criterion::kLength && blocked)
      table.notes.push_back("Who fails less often ranks first, by mean SLR where that is equal.");
    if (ids.criterion == Criterion::kLength)
      table.notes.push_back(fmt::format("Means are ranked in steps of {:g}.", kSameSlr));
    if (ids.criterion == Criterion::kTime) table.notes.push_back(timing_note(selection));
    ranks.push_back(std::move(table));
    const statistics::Lsd lsd = statistics::fisher_lsd(by_world);
    comparisons.push_back(matrix_table(lsd, test.rejected, ids.matrix, ids.what, blocked));
    comparisons.push_back(pairs_table(lsd, test.rejected, ids.pairs, ids.what, blocked));
  }
  ranks.insert(ranks.end(), comparisons.begin(), comparisons.end());
  return ranks;
}

}  // namespace jink::tools::lab::study
