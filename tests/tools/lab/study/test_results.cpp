// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"
#include "tests/tools/lab/study/small_study.hpp"

namespace jink::tools::lab::study {
namespace {

using support::Folder;
using support::has;
using support::refusal;
using support::write;

TEST(Record, ReadsBackToTheSameBits) {
  for (const Job& job : jobs_of(small_study())) {
    Record record = empty_record(job);
    record.values[key::kEvaluations] = 0.1 + 0.2;
    record.measured[key::kThreads] = 1.0 / 3.0;
    const Record back = record_from(nlohmann::ordered_json::parse(to_json(record).dump()));
    ASSERT_TRUE(same_result(record, back)) << job.name();
    ASSERT_EQ(record.measured, back.measured);
  }
}

TEST(StudyResults, ReadBackAndForgetALineThatWasCutOff) {
  const Folder folder;
  const Results results = empty_results(small_study());
  const std::string text = to_text(results);
  write(results_path(folder.path()), text);
  const Results back = read_results(results_path(folder.path()));
  EXPECT_EQ(to_text(back), text);
  EXPECT_FALSE(back.cut_off);
  write(results_path(folder.path()), text.substr(0, text.size() - 10));
  const Results cut = read_results(results_path(folder.path()));
  EXPECT_TRUE(cut.cut_off);
  EXPECT_EQ(cut.runs.size() + 1, results.runs.size());
}

TEST(StudyResults, RefuseWhatNoStudyWroteWithFileAndLine) {
  const Folder folder;
  const std::filesystem::path file = results_path(folder.path());
  const StudySettings settings = small_study();
  const std::string header = to_header(settings).dump() + "\n";
  const Job job = jobs_of(settings).front();
  const auto refused = [&](const std::string& text) {
    write(file, text);
    return refusal<ResultsError>([&] { static_cast<void>(read_results(file)); });
  };
  const auto line = [&](const std::function<void(nlohmann::ordered_json&)>& change) {
    nlohmann::ordered_json json = to_json(empty_record(job));
    change(json);
    return refused(header + json.dump() + "\n");
  };
  EXPECT_EQ(line([](auto&) {}), "");
  EXPECT_TRUE(has(refused(""), "holds no header"));
  EXPECT_TRUE(has(refused("{}\n"), "runs.jsonl:1: the first line is not"));
  EXPECT_TRUE(has(refused(header + "nonsense\n"), "runs.jsonl:2: is not JSON"));
  EXPECT_TRUE(has(refused(header + "[1]\n"), "runs.jsonl:2: neither a run nor a machine"));
  EXPECT_TRUE(has(line([](auto& j) { j["seed"] = 5; }), "runs.jsonl:2: run 0 should be front momvo"));
  EXPECT_TRUE(has(line([](auto& j) { j["job"] = 1000000; }), "run 1000000 is not of this study"));
  EXPECT_TRUE(has(line([](auto& j) { j["kind"] = "dance"; }), "'dance' is no kind of run"));
  EXPECT_TRUE(has(line([](auto& j) { j["values"].erase("hv"); }), "the run has no hv"));
  EXPECT_TRUE(has(line([](auto& j) { j["values"]["hv"] = "much"; }), "values.hv is no number"));
  EXPECT_TRUE(has(line([](auto& j) { j["series"]["f1"] = {1.0}; }), "f1 and f2 differ in length"));
  nlohmann::ordered_json other = to_header(settings);
  other["parameters"].erase("optimizer.population");
  EXPECT_TRUE(has(refused(other.dump() + "\n"), "runs.jsonl:1: the parameter optimizer.population is missing"));
}

TEST(StudyResults, OfShardsMergeToTheWholeAndOnesThatContradictAreRefused) {
  const Folder folder;
  StudySettings settings = small_study();
  const Results whole = empty_results(settings);
  for (settings.shard = {1, 2}; settings.shard.number <= 2; ++settings.shard.number)
    write(results_path(folder.path() / std::to_string(settings.shard.number)), to_text(empty_results(settings)));
  EXPECT_EQ(to_text(merge_results({folder.path() / "2", folder.path() / "1"})), to_text(whole));

  Results wrong = whole;
  wrong.runs.begin()->second.values[key::kHv] = 2.0;
  write(results_path(folder.path() / "wrong"), to_text(wrong));
  EXPECT_TRUE(has(refusal<ResultsError>([&] {
                    static_cast<void>(merge_results({folder.path() / "1", folder.path() / "wrong"}));
                  }),
                  "has two different results"));
  Results timed_again = whole;
  timed_again.runs.begin()->second.measured[key::kThreads] = 9.0;
  write(results_path(folder.path() / "again"), to_text(timed_again));
  EXPECT_EQ(merge_results({folder.path() / "1", folder.path() / "again"}).runs.size(), whole.runs.size());
  settings.shard = {};
  settings.seed = 2;
  write(results_path(folder.path() / "other"), to_text(empty_results(settings)));
  EXPECT_TRUE(has(refusal<ResultsError>([&] {
                    static_cast<void>(merge_results({folder.path() / "1", folder.path() / "other"}));
                  }),
                  "seed: 1 in "));
}

}  // namespace
}  // namespace jink::tools::lab::study
