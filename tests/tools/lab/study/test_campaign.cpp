// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <atomic>

#include "planner/paper/waypoint_problem.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tools/lab/study/small_study.hpp"
#include "tools/lab/study/campaign.hpp"

namespace jink::tools::lab::study {
namespace {

using support::Folder;

/// One run of everything, whose times are taken out.
class StudyCampaign : public ::testing::Test {
 protected:
  static Results made(const std::filesystem::path& folder, int threads, Results results,
                      const std::function<bool()>& interrupted, bool& complete) {
    const Setting setting(results.settings, small_planner());
    std::filesystem::create_directories(folder);
    campaign::JsonLinesFile file(results_path(folder), to_header(results.settings));
    const std::size_t had = results.runs.size();
    std::size_t told = had;
    complete =
        run_campaign(results, file, setting, {threads, interrupted, [&](const Progress& p) {
                                                EXPECT_GE(p.done, told);
                                                EXPECT_EQ(p.seconds_in_this_call > 0.0, p.done > had);
                                                EXPECT_EQ(p.seconds_left > 1e-12, p.done > had && p.done < p.total);
                                                told = p.done;
                                              }});
    return results;
  }
  static Results begun() {
    Results results;
    results.settings = small_study(1);
    return results;
  }
  static bool same(const Results& a, const Results& b) {
    return std::equal(a.runs.begin(), a.runs.end(), b.runs.begin(), b.runs.end(),
                      [](const auto& x, const auto& y) { return same_result(x.second, y.second); });
  }
};

TEST_F(StudyCampaign, GivesTheSameForAnyNumberOfThreadsAndAfterAnInterruption) {
  const auto never = [] { return false; };
  const Folder folder;
  const std::filesystem::path one = folder.path() / "one", three = folder.path() / "three", cut = folder.path() / "cut";
  bool complete = false;
  const Results whole = made(one, 1, begun(), never, complete);
  EXPECT_TRUE(complete);
  EXPECT_EQ(whole.runs.size(), jobs_of(whole.settings).size());
  EXPECT_TRUE(same(read_results(results_path(one)), whole)) << "the file holds what was made";
  EXPECT_TRUE(same(made(three, 3, begun(), never, complete), whole));

  std::atomic<int> asked{0};
  const Results part = made(
      cut, 2, begun(), [&] { return ++asked > 100; }, complete);
  EXPECT_FALSE(complete);
  EXPECT_GT(part.runs.size(), 0U);
  EXPECT_LT(part.runs.size(), whole.runs.size());
  EXPECT_TRUE(same(made(cut, 2, read_results(results_path(cut)), never, complete), whole));
  EXPECT_TRUE(complete);
}

TEST(Runs, SpendWhatTheyAreAllowedAndSayHowTheFrontGrew) {
  const StudySettings settings = small_study(1);
  const Setting setting(settings, small_planner());
  planner::base::WorkerPool pool(1);
  for (const Job& job : jobs_of(settings)) {
    const Record r = make_run(job, setting, pool);
    const double search = job.variant.population * job.variant.iterations;
    switch (job.variant.kind) {
      case RunKind::kFront:
        EXPECT_EQ(r.value(key::kEvaluations), search * kFrontSteps) << job.name();
        break;
      case RunKind::kPath:
        EXPECT_EQ(r.value(key::kEvaluations), search * (setting.planner.paper.waypoints - 2)) << job.name();
        break;
      case RunKind::kAnytime:
        EXPECT_EQ(r.series.at(key::kEvaluationsAt).front(), job.variant.population) << job.name();
        EXPECT_EQ(r.series.at(key::kEvaluationsAt).back(), search) << job.name();
        EXPECT_GE(r.series.at(key::kHvAt).back(), 0.0) << job.name();
        break;
    }
    EXPECT_TRUE(same_result(r, record_from(to_json(r)))) << job.name();
  }
}

}  // namespace
}  // namespace jink::tools::lab::study
