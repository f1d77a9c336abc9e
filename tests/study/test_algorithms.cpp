// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/algorithms/algorithms.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string_view>

namespace jink::study {
namespace {

TEST(Algorithms, AreFoundByTheirNames) {
  std::set<std::string_view> names;
  for (const Algorithm& algorithm : algorithms()) {
    EXPECT_EQ(find_algorithm(algorithm.name), &algorithm);
    EXPECT_TRUE(names.insert(algorithm.name).second) << algorithm.name;
    EXPECT_FALSE(algorithm.label.empty());
    EXPECT_FALSE(algorithm.source.empty());
  }
  EXPECT_EQ(find_algorithm("magic"), nullptr);
  EXPECT_EQ(find_algorithm(""), nullptr);
}

}  // namespace
}  // namespace jink::study
