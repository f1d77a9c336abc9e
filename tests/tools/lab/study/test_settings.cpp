// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>

#include "tests/tools/lab/study/small_study.hpp"
#include "tools/lab/algorithms/registry.hpp"

namespace jink::tools::lab::study {
namespace {

TEST(Variants, AreNoneTwiceAndHaveEveryAlgorithmWhereThePaperCompares) {
  const std::vector<Variant> variants = variants_of(small_study());
  EXPECT_EQ(std::set<Variant>(variants.begin(), variants.end()).size(), variants.size());
  for (const bool blocked : {false, true}) {
    for (const algorithms::Algorithm& a : algorithms::algorithms()) {
      const auto has = [&](RunKind kind) {
        return std::any_of(variants.begin(), variants.end(), [&](const Variant& v) {
          return v.kind == kind && v.algorithm == a.name && v.world == hardest_world(blocked) && v.population == 12;
        });
      };
      EXPECT_TRUE(has(RunKind::kPath)) << a.name;
      EXPECT_TRUE(has(RunKind::kAnytime)) << a.name;
      EXPECT_EQ(has(RunKind::kFront), is_own(a.name)) << a.name;
    }
  }
}

TEST(Variants, SweepTheSharingRatesOfThoseThatShare) {
  std::set<int> of_momvo, of_six;
  for (const Variant& v : variants_of(small_study())) {
    if (v.kind == RunKind::kFront && v.algorithm == "momvo") of_momvo.insert(v.sharing);
    if (v.kind == RunKind::kFront && v.algorithm == "pmomvo-6") of_six.insert(v.sharing);
  }
  EXPECT_EQ(of_momvo, (std::set<int>{0}));
  EXPECT_EQ(of_six, (std::set<int>{0, 1, 3, 4, 7, 9}));
}

TEST(Variants, OfAQuickStudyLeaveOutTheLargestCells) {
  StudySettings settings = small_study();
  const auto largest = [&] {
    int most = 0;
    for (const Variant& v : variants_of(settings)) most = std::max(most, v.population * v.iterations);
    return most;
  };
  EXPECT_EQ(largest(), 2 * 12 * 2 * 2);
  settings.quick = false;
  EXPECT_EQ(largest(), 4 * 12 * 3 * 2);
}

TEST(StudyJobs, OfTheShardsAreThoseOfTheWholeOnceEachAndTimedOnesComeLast) {
  StudySettings settings = small_study(3);
  const std::size_t whole = jobs_of(settings).size();
  std::set<std::size_t> found;
  for (settings.shard = {1, 3}; settings.shard.number <= 3; ++settings.shard.number) {
    bool timed = false;
    for (const Job& job : jobs_of(settings)) {
      EXPECT_TRUE(found.insert(job.number).second) << job.name();
      EXPECT_FALSE(timed && !job.variant.timed()) << job.name();
      timed = job.variant.timed();
      EXPECT_EQ(job.seed, run_seed(settings.seed, job.run));
    }
  }
  EXPECT_EQ(found.size(), whole);
}

TEST(StudySettings, ReadBackFromTheirHeader) {
  StudySettings settings = small_study();
  settings.seed = 18446744073709551615ULL;
  settings.shard = {2, 3};
  const StudySettings back = from_header(nlohmann::ordered_json::parse(to_header(settings).dump()));
  EXPECT_TRUE(differences(settings, "a", back, "b").empty());
  EXPECT_EQ(jobs_of(back).size(), jobs_of(settings).size());
  StudySettings other = settings;
  other.runs = 7;
  EXPECT_EQ(differences(settings, "a", other, "b"), (std::vector<std::string>{"runs: 2 in a, 7 in b"}));
}

}  // namespace
}  // namespace jink::tools::lab::study
