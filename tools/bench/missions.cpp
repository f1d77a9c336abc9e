// SPDX-License-Identifier: BSD-3-Clause
#include "tools/bench/missions.hpp"

#include "config/settings.hpp"
#include "planner/indicators.hpp"
#include "planner/pmomvo.hpp"

namespace jink::bench {
namespace {

/// PMOMVO, which keeps a copy of every problem that it is given.
class Recorder final : public planner::Optimizer {
 public:
  explicit Recorder(const planner::OptimizerSettings& settings) : optimizer_(settings, 2, 2) {}
  const planner::Front& run(const planner::Problem& problem, std::span<const double> initial, std::uint64_t seed,
                            std::uint64_t stream, const planner::Budget& budget, planner::WorkerPool& pool) override {
    steps_.push_back(dynamic_cast<const planner::WaypointProblem&>(problem));
    return optimizer_.run(problem, initial, seed, stream, budget, pool);
  }
  [[nodiscard]] const planner::RunReport& report() const override { return optimizer_.report(); }
  [[nodiscard]] const std::vector<planner::WaypointProblem>& steps() const { return steps_; }

 private:
  planner::Pmomvo optimizer_;
  std::vector<planner::WaypointProblem> steps_;
};

}  // namespace

Mission::Mission(const std::string& name)
    : scenario_(config::load_scenario(config::config_folder() / "scenarios" / (name + ".yaml"))), world_(scenario_) {}

planner::PaperRequest Mission::request(std::uint64_t seed) const {
  planner::PaperRequest request;
  request.start = scenario_.start;
  request.target = scenario_.target;
  request.volume = world_.volume;
  request.vehicle = scenario_.vehicle;
  request.tracks = world_.tracks;
  request.seed = seed;
  return request;
}

double Mission::slr(const planner::Plan& plan) const {
  return planner::straight_line_rate(planner::path_length(plan.path), (scenario_.target - scenario_.start).norm());
}

std::vector<planner::WaypointProblem> record_steps(const Mission& mission, std::uint64_t seed,
                                                   planner::WorkerPool& pool) {
  const planner::PaperRequest request = mission.request(seed);
  Recorder recorder(request.optimizer);
  plan_paper(request, recorder, pool);
  return recorder.steps();
}

const planner::WaypointProblem& middle_step() {
  static const planner::WaypointProblem step = [] {
    const Mission mission("table2-5");
    planner::WorkerPool pool(1);
    const auto steps = record_steps(mission, 1, pool);
    return steps[steps.size() / 2];
  }();
  return step;
}

}  // namespace jink::bench
