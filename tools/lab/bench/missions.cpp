// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/bench/missions.hpp"

#include "config/settings.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/optimizer/pmomvo.hpp"

namespace jink::tools::lab::bench {
namespace {

/// PMOMVO, which keeps a copy of every problem that it is given.
class Recorder final : public planner::optimizer::Optimizer {
 public:
  explicit Recorder(const planner::base::OptimizerSettings& settings) : optimizer_(settings, 2, 2) {}
  const planner::optimizer::Front& run(const planner::optimizer::Problem& problem, std::span<const double> initial,
                                       std::uint64_t seed, std::uint64_t stream, const planner::base::Budget& budget,
                                       planner::base::WorkerPool& pool) override {
    steps_.push_back(dynamic_cast<const planner::paper::WaypointProblem&>(problem));
    return optimizer_.run(problem, initial, seed, stream, budget, pool);
  }
  [[nodiscard]] const planner::optimizer::RunReport& report() const override { return optimizer_.report(); }
  [[nodiscard]] const std::vector<planner::paper::WaypointProblem>& steps() const { return steps_; }

 private:
  planner::optimizer::Pmomvo optimizer_;
  std::vector<planner::paper::WaypointProblem> steps_;
};

}  // namespace

Mission::Mission(const std::string& name)
    : scenario_(config::load_scenario(config::config_folder() / "scenarios" / (name + ".yaml"))), world_(scenario_) {}

planner::paper::PaperRequest Mission::request(std::uint64_t seed) const {
  planner::paper::PaperRequest request;
  request.start = scenario_.start;
  request.target = scenario_.target;
  request.volume = world_.volume;
  request.vehicle = scenario_.vehicle;
  request.tracks = world_.tracks;
  request.seed = seed;
  return request;
}

double Mission::slr(const planner::verify::Plan& plan) const {
  return planner::optimizer::straight_line_rate(planner::base::path_length(plan.path),
                                                (scenario_.target - scenario_.start).norm());
}

std::vector<planner::paper::WaypointProblem> record_steps(const Mission& mission, std::uint64_t seed,
                                                          planner::base::WorkerPool& pool) {
  const planner::paper::PaperRequest request = mission.request(seed);
  Recorder recorder(request.optimizer);
  planner::paper::plan_paper(request, recorder, pool);
  return recorder.steps();
}

const planner::paper::WaypointProblem& middle_step() {
  static const planner::paper::WaypointProblem step = [] {
    const Mission mission("table2-5");
    planner::base::WorkerPool pool(1);
    const auto steps = record_steps(mission, 1, pool);
    return steps[steps.size() / 2];
  }();
  return step;
}

}  // namespace jink::tools::lab::bench
