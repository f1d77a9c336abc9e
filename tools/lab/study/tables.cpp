// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/tables.hpp"

#include <utility>

namespace jink::tools::lab::study {

std::vector<presentation::Table> all_tables(const Selection& selection, const StudyWorlds& scenes) {
  std::vector<presentation::Table> tables;
  const auto add = [&](std::vector<presentation::Table> more) {
    for (presentation::Table& table : more) tables.push_back(std::move(table));
  };
  for (const bool blocked : {false, true}) {
    add(front_tables(selection, blocked));
    add(path_tables(selection, blocked));
    add(rank_tables(selection, blocked));
    tables.push_back(picture_table(selection, scenes, blocked));
    add(sensitivity_tables(selection, blocked));
    tables.push_back(comparison_table(selection, blocked));
    tables.push_back(anytime_table(selection, blocked));
  }
  tables.push_back(success_table(selection));
  return tables;
}

}  // namespace jink::tools::lab::study
