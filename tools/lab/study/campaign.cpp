// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/campaign.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "tools/lab/campaign/workers.hpp"

namespace jink::tools::lab::study {
namespace {

using Clock = std::chrono::steady_clock;

/// Evaluations that a run takes.
double evaluations_of(const Variant& v, const planner::base::PaperSettings& paper) {
  const double search = static_cast<double>(v.population) * v.iterations;
  switch (v.kind) {
    case RunKind::kPath:
      return search * (paper.waypoints - 2);
    case RunKind::kFront:
      return search * kFrontSteps;
    case RunKind::kAnytime:
      break;
  }
  double shares = 0.0;
  for (const double share : checkpoints()) shares += share;
  return search * kFrontSteps * shares;
}

/// How long runs take, from those of this call: by algorithm, since some take twenty times as long for an evaluation
/// as others.
class Speeds {
 public:
  void add(const Variant& v, double evaluations, double seconds) {
    for (Spent* spent : {&by_kind_[{v.algorithm, v.kind}], &by_algorithm_[v.algorithm], &all_}) {
      spent->evaluations += evaluations;
      spent->seconds += seconds;
    }
  }
  /// Of the same kind of run, else of the same algorithm, else of all; 0 before the first run.
  [[nodiscard]] double seconds(const std::string& algorithm, RunKind kind, double evaluations) const {
    const auto same = by_kind_.find({algorithm, kind});
    if (same != by_kind_.end()) return evaluations * same->second.rate();
    const auto near = by_algorithm_.find(algorithm);
    return evaluations * (near != by_algorithm_.end() ? near->second.rate() : all_.rate());
  }

 private:
  struct Spent {
    double evaluations = 0.0, seconds = 0.0;
    [[nodiscard]] double rate() const { return evaluations > 0.0 ? seconds / evaluations : 0.0; }
  };
  std::map<std::pair<std::string, RunKind>, Spent> by_kind_;
  std::map<std::string, Spent> by_algorithm_;
  Spent all_;
};

/// The runs that are still to be made, and what the workers share.
class Campaign {
 public:
  Campaign(Results& results, campaign::JsonLinesFile& file, const Setting& setting, const CampaignOptions& options)
      : results_(results), file_(file), setting_(setting), options_(options) {
    for (Job& job : jobs_of(results.settings)) {
      ++progress_.total;
      if (results.runs.count(job.number) > 0) {
        ++progress_.done;
        earlier_[key_of(job)] += evaluations(job);
      } else {
        left_[key_of(job)] += evaluations(job);
        (job.variant.timed() ? timed_ : shared_).push_back(std::move(job));
      }
    }
  }

  bool run() {
    work_through(shared_, options_.threads, nullptr);
    progress_.timing = true;
    planner::base::WorkerPool pool(options_.threads);
    work_through(timed_, 1, &pool);
    return progress_.done == progress_.total;
  }

 private:
  /// What runs take the same time by: algorithm, kind, whether others run beside it.
  using Key = std::pair<std::pair<std::string, RunKind>, bool>;
  static Key key_of(const Job& job) { return {{job.variant.algorithm, job.variant.kind}, job.variant.timed()}; }
  [[nodiscard]] double evaluations(const Job& job) const { return evaluations_of(job.variant, setting_.planner.paper); }

  /// `pool` is the planner's; none: each run has one thread.
  void work_through(const std::vector<Job>& jobs, int workers, planner::base::WorkerPool* pool) {
    next_ = 0;
    workers_.run(
        workers,
        [&] {
          if (options_.interrupted()) return false;
          const Job* const job = take(jobs);
          if (job == nullptr) return false;
          if (pool != nullptr) {
            make(*job, *pool);
          } else {
            planner::base::WorkerPool alone(1);
            make(*job, alone);
          }
          return true;
        },
        [this] { options_.on_progress(progress()); });
  }

  const Job* take(const std::vector<Job>& jobs) {
    const std::scoped_lock lock(mutex_);
    return next_ < jobs.size() ? &jobs[next_++] : nullptr;
  }

  void make(const Job& job, planner::base::WorkerPool& pool) {
    try {
      const auto begun = Clock::now();
      Record record = make_run(job, setting_, pool);
      const double seconds = std::chrono::duration<double>(Clock::now() - begun).count();
      const std::scoped_lock lock(mutex_);
      file_.append(to_json(record));
      results_.add(std::move(record));
      ++progress_.done;
      left_[key_of(job)] -= evaluations(job);
      speeds_.add(job.variant, evaluations(job), seconds);
      progress_.seconds_in_this_call += job.variant.timed() ? seconds : seconds / options_.threads;
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("run {}: {}", job.name(), error.what()));
    }
  }

  /// Guarded by mutex_.
  [[nodiscard]] double seconds_for(const std::map<Key, double>& work) const {
    double seconds = 0.0;
    for (const auto& [key, evaluations] : work)
      seconds += speeds_.seconds(key.first.first, key.first.second, evaluations) / (key.second ? 1 : options_.threads);
    return seconds;
  }

  [[nodiscard]] Progress progress() const {
    const std::scoped_lock lock(mutex_);
    Progress now = progress_;
    now.seconds_left = seconds_for(left_);
    now.seconds_before = seconds_for(earlier_);
    return now;
  }

  mutable std::mutex mutex_;  // guards results_, file_, progress_, next_, left_, speeds_
  Results& results_;
  campaign::JsonLinesFile& file_;
  const Setting& setting_;
  const CampaignOptions& options_;
  std::vector<Job> shared_, timed_;  // fixed before the workers begin
  std::map<Key, double> earlier_;    // evaluations, likewise
  std::map<Key, double> left_;
  Speeds speeds_;
  std::size_t next_ = 0;
  Progress progress_;
  campaign::Workers workers_;
};

}  // namespace

bool run_campaign(Results& results, campaign::JsonLinesFile& file, const Setting& setting,
                  const CampaignOptions& options) {
  return Campaign(results, file, setting, options).run();
}

}  // namespace jink::tools::lab::study
