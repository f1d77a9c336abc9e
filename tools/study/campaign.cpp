// SPDX-License-Identifier: BSD-3-Clause
#include "tools/study/campaign.hpp"

#include <fmt/format.h>

#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

#include "tools/campaign/workers.hpp"

namespace jink::study {
namespace {

/// Evaluations that a run takes.
double work_of(const Variant& v, const planner::PaperSettings& paper) {
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

/// The runs that are still to be made, and what the workers share.
class Campaign {
 public:
  Campaign(Results& results, campaign::LineFile& file, const Setting& setting, const CampaignOptions& options)
      : results_(results), file_(file), setting_(setting), options_(options) {
    for (Job& job : jobs_of(results.settings)) {
      const double work = work_of(job);
      progress_.work_total += work;
      ++progress_.total;
      if (results.runs.count(job.number) > 0) {
        progress_.work_done += work;
        ++progress_.done;
      } else {
        (job.variant.timed() ? timed_ : shared_).push_back(std::move(job));
      }
    }
  }

  bool run() {
    work_through(shared_, options_.threads, nullptr);
    progress_.timing = true;
    planner::WorkerPool pool(options_.threads);
    work_through(timed_, 1, &pool);
    return progress_.done == progress_.total;
  }

 private:
  [[nodiscard]] double work_of(const Job& job) const {
    const double work = study::work_of(job.variant, setting_.planner.paper);
    return job.variant.timed() ? work : work / options_.threads;
  }

  /// `pool` is the planner's; none: each run has one thread.
  void work_through(const std::vector<Job>& jobs, int workers, planner::WorkerPool* pool) {
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
            planner::WorkerPool alone(1);
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

  void make(const Job& job, planner::WorkerPool& pool) {
    try {
      Record record = make_run(job, setting_, pool);
      const std::scoped_lock lock(mutex_);
      file_.append(to_json(record));
      const double work = work_of(job);
      progress_.work_done += work;
      progress_.work_in_this_call += work;
      ++progress_.done;
      results_.add(std::move(record));
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("run {}: {}", job.name(), error.what()));
    }
  }

  [[nodiscard]] Progress progress() const {
    const std::scoped_lock lock(mutex_);
    return progress_;
  }

  mutable std::mutex mutex_;  // guards results_, file_, progress_, next_
  Results& results_;
  campaign::LineFile& file_;
  const Setting& setting_;
  const CampaignOptions& options_;
  std::vector<Job> shared_, timed_;  // fixed before the workers begin
  std::size_t next_ = 0;
  Progress progress_;
  campaign::Workers workers_;
};

}  // namespace

bool run_campaign(Results& results, campaign::LineFile& file, const Setting& setting, const CampaignOptions& options) {
  return Campaign(results, file, setting, options).run();
}

}  // namespace jink::study
