// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/campaign.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <mutex>
#include <optional>
#include <vector>

#include "tools/lab/arena/flight_runner.hpp"
#include "tools/lab/campaign/workers.hpp"

namespace jink::tools::lab::arena {
namespace {

/// The workers and what they share.
class Campaign {
 public:
  Campaign(Results& results, ResultsFile& file, const CampaignOptions& options)
      : results_(results),
        file_(file),
        options_(options),
        stop_([this] { return workers_.failed() || options_.interrupted(); }) {
    std::vector<Job> jobs = jobs_of(results.settings);
    progress_.total = jobs.size();
    for (Job& job : jobs) add(std::move(job));
  }

  bool run() {
    workers_.run(
        options_.threads, [this] { return work(); }, [this] { options_.on_progress(progress()); });
    return complete();
  }

 private:
  /// What a worker takes at a time: a flight, or a world's judgement once its flights have ended.
  struct Task {
    World world;
    std::vector<Job> jobs;  // still to be flown
  };
  struct Place {
    std::size_t task = 0;
    std::optional<Job> job;  // none: judge
  };

  void add(Job job) {
    if (tasks_.empty() || tasks_.back().world.number != job.world.number) {
      tasks_.push_back({job.world, {}});
      open_.push_back(0);
      reached_.push_back(false);
    }
    const auto found = results_.flights.find(job.number);
    if (found == results_.flights.end()) {
      tasks_.back().jobs.push_back(std::move(job));
      ++open_.back();
    } else {
      reached_.back() = reached_.back() || found->second.reached();
      count(found->second);
    }
  }

  /// After the workers.
  [[nodiscard]] bool complete() const {
    for (std::size_t task = 0; task < tasks_.size(); ++task)
      if (open_[task] > 0 || to_judge(task)) return false;
    return true;
  }

  void count(const FlightRecord& record) {
    ++progress_.done;
    if (record.reached()) return;
    ++progress_.failed;
    if (record.outcome == "collision") ++progress_.hit;
  }

  [[nodiscard]] Progress progress() const {
    const std::scoped_lock lock(mutex_);
    return progress_;
  }

  /// False: nothing is left, or it was given up.
  bool work() {
    if (stop_()) return false;
    const std::optional<Place> place = take();
    if (!place) return false;
    try {
      if (place->job)
        fly_one(place->task, *place->job);
      else
        judge(place->task);
    } catch (const Cancelled&) {
      return false;  // what is not done is to be seen in the results
    }
    return true;
  }

  /// The next thing to do: the flights of the worlds in their order. A world without open flights is judged at once if
  /// an earlier run did not come to it.
  std::optional<Place> take() {
    const std::scoped_lock lock(mutex_);
    while (next_ < tasks_.size()) {
      Task& task = tasks_[next_];
      if (next_job_ < task.jobs.size()) return Place{next_, task.jobs[next_job_++]};
      const std::size_t at = next_++;
      next_job_ = 0;
      if (task.jobs.empty() && to_judge(at)) return Place{at, std::nullopt};
    }
    return std::nullopt;
  }

  /// Guarded by mutex_.
  [[nodiscard]] bool to_judge(std::size_t task) const {
    return results_.settings.oracle && open_[task] == 0 && !reached_[task] &&
           results_.worlds.count(tasks_[task].world.number) == 0;
  }

  void fly_one(std::size_t task, const Job& job) {
    bool judge_now = false;
    try {
      const config::Scenario scenario = scenario_of(job.world, job.tier, recording());
      FlightRecord record = fly(job, scenario, options_.settings, stop_);
      if (!record.reached())
        save_failure({options_.out, options_.settings, options_.logs}, job, scenario, record, stop_);
      const std::scoped_lock lock(mutex_);
      file_.append(to_json(record));
      count(record);
      ++progress_.flown;
      reached_[task] = reached_[task] || record.reached();
      --open_[task];
      judge_now = to_judge(task);
      results_.add(std::move(record));
    } catch (const Cancelled&) {
      throw;
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("flight {}: {}", job.name(), error.what()));
    }
    if (judge_now) judge(task);
  }

  void judge(std::size_t task) {
    if (stop_()) throw Cancelled();
    const World& world = tasks_[task].world;
    const WorldRecord record{world.number, world.family, world.seed, judge_world(world, recording())};
    const std::scoped_lock lock(mutex_);
    file_.append(to_json(record));
    results_.add(record);
  }

  [[nodiscard]] const Recording* recording() const { return options_.recording.get(); }

  mutable std::mutex mutex_;  // guards results_, file_, progress_, next_, next_job_, open_, reached_
  Results& results_;
  ResultsFile& file_;
  const CampaignOptions& options_;
  std::vector<Task> tasks_;  // fixed before the workers begin
  std::vector<std::size_t> open_;
  std::vector<bool> reached_;
  std::size_t next_ = 0, next_job_ = 0;
  Progress progress_;
  campaign::Workers workers_;
  Stop stop_;
};

}  // namespace

bool fly_campaign(Results& results, ResultsFile& file, const CampaignOptions& options) {
  return Campaign(results, file, options).run();
}

}  // namespace jink::tools::lab::arena
