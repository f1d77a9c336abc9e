// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/flight_runner.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "config/scenario_writer.hpp"
#include "sim/families/families.hpp"
#include "sim/families/recorded.hpp"
#include "tools/lab/arena/results.hpp"
#include "tools/lab/arena/tiers.hpp"
#include "tools/lab/baselines/registry.hpp"
#include "tools/lab/oracle/feasibility.hpp"
#include "tools/log/flight_log.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::lab::arena {
namespace {

using WallClock = std::chrono::steady_clock;

double milliseconds_since(WallClock::time_point begun) {
  return std::chrono::duration<double, std::milli>(WallClock::now() - begun).count();
}

/// A planner with a stop-watch. Whether a planner works when a plan is asked for or when it is fetched is its own
/// affair: both count.
class TimedPlanner final : public bridge::companion::PlannerTask {
 public:
  TimedPlanner(std::unique_ptr<bridge::companion::PlannerTask> planner, DurationHistogram& times)
      : planner_(std::move(planner)), times_(times) {}
  void start(bridge::companion::PlanJob job) override {
    const auto begun = WallClock::now();
    planner_->start(std::move(job));
    ms_ = milliseconds_since(begun);
  }
  [[nodiscard]] bool busy() const override { return planner_->busy(); }
  [[nodiscard]] double latency() const override { return planner_->latency(); }
  [[nodiscard]] std::optional<bridge::companion::PlanResult> poll(double now) override {
    const auto begun = WallClock::now();
    std::optional<bridge::companion::PlanResult> result = planner_->poll(now);
    if (planner_->busy() || result) ms_ += milliseconds_since(begun);
    if (result) times_.add(std::exchange(ms_, 0.0));
    return result;
  }

 private:
  std::unique_ptr<bridge::companion::PlannerTask> planner_;
  DurationHistogram& times_;
  double ms_ = 0.0;  // of the present plan so far
};

/// Ends a flight from within: the closed loop has no other way out.
class Stopper final : public sim::world::TruthObserver {
 public:
  explicit Stopper(const Stop& stop) : stop_(stop) {}
  void on_truth(double, std::span<const sim::world::VehicleTruth>, const sim::world::World&) override {
    if (stop_()) throw Cancelled();
  }

 private:
  const Stop& stop_;
};

FlightRecord record_of(const Job& job, const config::Scenario& scenario, const sim::flight::ClosedLoopResult& result) {
  FlightRecord record;
  record.job = job.number;
  record.family = job.world.family;
  record.seed = job.world.seed;
  record.tier = job.tier;
  record.pilot = job.pilot;
  record.outcome = bridge::supervisor::to_string(result.flight.outcome);
  record.reason = result.flight.reason;
  record.flight_time = result.flight.flight_time;
  record.path_length = result.flight.path_length;
  record.straight_length = result.flight.straight_length;
  record.min_clearance = result.min_clearance;
  record.max_speed = result.flight.max_speed;
  record.cruise_speed = scenario.vehicle.cruise_speed;
  record.speed_limit = scenario.vehicle.max_speed;
  record.tracking_error = result.flight.largest_tracking_error;
  record.plans = static_cast<std::int64_t>(result.flight.plans);
  record.blocked_plans = static_cast<std::int64_t>(result.flight.blocked_plans);
  record.deadline_misses = static_cast<std::int64_t>(result.flight.deadline_misses);
  return record;
}

/// Plans that took longer than `limit`, to the width of a bin.
std::int64_t longer_than(const DurationHistogram& times, double limit) {
  DurationHistogram at_limit;
  at_limit.add(limit);
  std::int64_t count = 0;
  for (const auto& [bin, n] : times.bins()) count += bin > at_limit.bins().begin()->first ? n : 0;
  return count;
}

/// For a POSIX shell.
std::string quoted(const std::string& text) {
  const char* const plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:+@";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string result = "'";
  for (const char c : text) c == '\'' ? result += "'\\''" : result += c;
  return result + "'";
}

config::Scenario true_world(const World& world, const Recording* recording) {
  if (recording != nullptr && world.family == sim::families::kRecorded)
    return sim::families::make_recorded_world(*recording, world.seed);
  return sim::families::make_world(world.family, world.seed);
}

}  // namespace

config::Scenario scenario_of(const World& world, std::string_view tier, const Recording* recording) {
  config::Scenario scenario = true_world(world, recording);
  sim::families::set_tier(scenario, tier_of(tier), world.seed);
  return scenario;
}

sim::flight::ClosedLoopOptions flight_options(const std::string& pilot, std::uint64_t seed,
                                              const config::Settings& settings, DurationHistogram* times) {
  sim::flight::ClosedLoopOptions options;
  options.seed = seed;
  options.threads = 1;
  options.planner = [pilot, times, paper = settings.paper](
                        const bridge::companion::PlannerTaskSettings& planning,
                        double latency) -> std::unique_ptr<bridge::companion::PlannerTask> {
    std::unique_ptr<bridge::companion::PlannerTask> planner = baselines::make_pilot(pilot, planning, latency, paper);
    if (times == nullptr) return planner;
    return std::make_unique<TimedPlanner>(std::move(planner), *times);
  };
  return options;
}

FlightRecord fly(const Job& job, const config::Scenario& scenario, const config::Settings& settings, const Stop& stop) {
  const auto begun = WallClock::now();
  Measured measured;
  sim::flight::ClosedLoopOptions options = flight_options(job.pilot, job.world.seed, settings, &measured.plan_ms);
  Stopper stopper(stop);
  options.truth_observers.push_back(&stopper);
  FlightRecord record = record_of(job, scenario, sim::flight::fly_closed_loop(scenario, settings, options));
  measured.wall_s = 1e-3 * milliseconds_since(begun);
  measured.late_plans = longer_than(measured.plan_ms, settings.horizon.deadline_ms);
  record.measured = std::move(measured);
  return record;
}

std::filesystem::path failure_folder(const std::filesystem::path& out, const std::string& name) {
  return out / "failed" / name;
}

void save_failure(const FailureOptions& failure, const Job& job, const config::Scenario& flown,
                  const FlightRecord& record, const Stop& stop) {
  const std::filesystem::path folder = failure_folder(failure.out, job.name());
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw ResultsError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  const std::filesystem::path file = folder / "scenario.yaml";
  campaign::write_atomically(file, config::to_yaml(flown));
  if (!failure.log) return;

  const config::Scenario scenario = config::load_scenario(file);
  sim::flight::ClosedLoopOptions options = flight_options(job.pilot, job.world.seed, failure.settings);
  Stopper stopper(stop);
  log::FlightLogOptions in_virtual_time;
  in_virtual_time.wait = true;
  nlohmann::ordered_json header = runs::scenario_header(scenario, job.world.seed, failure.settings);
  header["pilot"] = job.pilot;
  log::FlightLog log(folder / "flight.jsonl", std::move(header), in_virtual_time);
  options.truth_observers = {&stopper, &log};
  options.flight_observers = {&log};
  const FlightRecord again =
      record_of(job, scenario, sim::flight::fly_closed_loop(scenario, failure.settings, options));
  log.close();
  if (!same_result(record, again)) {
    throw std::runtime_error(fmt::format("flown again from {} it is another flight: {} ({}) first, then {} ({})",
                                         file.string(), record.outcome, record.reason, again.outcome, again.reason));
  }
}

std::string replay_command(const std::filesystem::path& out, const FlightRecord& record) {
  const std::filesystem::path folder =
      failure_folder(out, flight_name(record.family, record.seed, record.tier, record.pilot));
  return fmt::format("jink replay {} --pilot {} --seed {} --config {} --log {} --report {}",
                     quoted((folder / "scenario.yaml").string()), record.pilot, record.seed,
                     quoted((out / "planner.yaml").string()), quoted((folder / "flight.jsonl").string()),
                     quoted((folder / "flight.html").string()));
}

Verdict judge_world(const World& world, const Recording* recording) {
  switch (oracle::judge(true_world(world, recording)).verdict) {
    case oracle::Verdict::kSolvable:
      return Verdict::kSolvable;
    case oracle::Verdict::kImpossible:
      return Verdict::kImpossible;
    case oracle::Verdict::kUnknown:
      break;
  }
  return Verdict::kUnknown;
}

}  // namespace jink::tools::lab::arena
