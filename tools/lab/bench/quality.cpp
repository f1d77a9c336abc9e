// SPDX-License-Identifier: BSD-3-Clause
// Quality of the fronts and paths in paper mode, PMOMVO and pagmo2's NSGA-II on the same problems.
#include <fmt/format.h>

#include "planner/optimizer/indicators.hpp"
#include "planner/optimizer/pmomvo.hpp"
#include "tools/lab/algorithms/comparators.hpp"
#include "tools/lab/bench/fronts.hpp"
#include "tools/lab/bench/measure.hpp"
#include "tools/lab/bench/missions.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr double kTiny = 1e-3;  // m and rad; nobody flies more exactly

std::vector<planner::optimizer::Point2> points_of(const planner::optimizer::Front& front) {
  std::vector<planner::optimizer::Point2> points;
  for (const planner::optimizer::Cost& cost : front.costs) points.push_back({cost.f[0], cost.f[1]});
  return points;
}

/// Hypervolumes of both optimizers on the same steps.
struct Score {
  std::vector<double> pmomvo, pagmo;
  int pmomvo_better = 0, pagmo_better = 0;
  void add(const std::vector<planner::optimizer::Point2>& ours, const std::vector<planner::optimizer::Point2>& theirs,
           const planner::optimizer::FrontBounds& bounds) {
    pmomvo.push_back(volume_of(ours, bounds));
    pagmo.push_back(volume_of(theirs, bounds));
    if (pmomvo.back() > pagmo.back()) ++pmomvo_better;
    if (pagmo.back() > pmomvo.back()) ++pagmo_better;
  }
};

struct Duel {
  Score relative;  ///< in units of the union's extent
  Score absolute;  ///< in m and rad above the union's ideal
  std::vector<double> pmomvo_size, pagmo_size;
  int tiny = 0;  ///< steps in which the union's front has less than kTiny of both objectives
};

void fight(const Mission& mission, std::uint64_t seed, planner::base::WorkerPool& pool, Duel& duel) {
  const planner::base::OptimizerSettings settings = mission.request(seed).optimizer;
  planner::optimizer::Pmomvo pmomvo(settings, 2, 2);
  const auto pagmo = algorithms::make_nsga2(settings, 2, 2);
  const planner::base::Budget budget{settings.iterations};
  std::uint64_t stream = 0;
  for (const planner::paper::WaypointProblem& step : record_steps(mission, seed, pool)) {
    ++stream;
    const auto ours = points_of(pmomvo.run(step, {}, seed, stream, budget, pool));
    const auto theirs = points_of(pagmo->run(step, {}, seed, stream, budget, pool));
    std::vector<planner::optimizer::Point2> both = ours;
    both.insert(both.end(), theirs.begin(), theirs.end());
    const planner::optimizer::FrontBounds bounds = planner::optimizer::front_bounds(both);
    duel.relative.add(ours, theirs, bounds);
    duel.absolute.add(ours, theirs, {bounds.ideal, {bounds.ideal[0] + 1.0, bounds.ideal[1] + 1.0}});
    duel.pmomvo_size.push_back(static_cast<double>(ours.size()));
    duel.pagmo_size.push_back(static_cast<double>(theirs.size()));
    if (bounds.nadir[0] - bounds.ideal[0] < kTiny && bounds.nadir[1] - bounds.ideal[1] < kTiny) ++duel.tiny;
  }
}

void print_hypervolume(const Options& options, planner::base::WorkerPool& pool) {
  print_title(
      "paper mission: hypervolume",
      fmt::format("every step of PMOMVO's missions, {} seeds, solved by both; reference (1.1, 1.1) above the ideal "
                  "of both fronts together.\nHV: in units of the extent from ideal to nadir of both fronts. HV, m "
                  "rad: in m and rad. Equal values count for neither, as in HV where one point dominates all else.",
                  options.seeds));
  Table table({"mission", "optimizer", "mean HV", "std", "better in", "mean HV, m rad", "std", "better in", "steps",
               "mean front size"});
  std::vector<std::string> notes;
  for (const char* name : {"table2-5", "crossing"}) {
    const Mission mission(name);
    Duel duel;
    for (int seed = 1; seed <= options.seeds; ++seed) fight(mission, static_cast<std::uint64_t>(seed), pool, duel);
    const auto row = [&](const char* optimizer, const std::vector<double>& relative, int relative_better,
                         const std::vector<double>& absolute, int absolute_better, const std::vector<double>& sizes) {
      table.row({name, optimizer, fmt::format("{:.5f}", jink::tools::lab::statistics::mean(relative)),
                 fmt::format("{:.5f}", jink::tools::lab::statistics::standard_deviation(relative)),
                 fmt::format("{}", relative_better),
                 fmt::format("{:.7f}", jink::tools::lab::statistics::mean(absolute)),
                 fmt::format("{:.7f}", jink::tools::lab::statistics::standard_deviation(absolute)),
                 fmt::format("{}", absolute_better), fmt::format("{}", sizes.size()),
                 fmt::format("{:.1f}", jink::tools::lab::statistics::mean(sizes))});
    };
    row("PMOMVO", duel.relative.pmomvo, duel.relative.pmomvo_better, duel.absolute.pmomvo, duel.absolute.pmomvo_better,
        duel.pmomvo_size);
    row("pagmo2 NSGA-II", duel.relative.pagmo, duel.relative.pagmo_better, duel.absolute.pagmo,
        duel.absolute.pagmo_better, duel.pagmo_size);
    notes.push_back(
        fmt::format("{}: in {} of {} steps the front of both together is shorter than {} m and rad: a point.", name,
                    duel.tiny, duel.pmomvo_size.size(), kTiny));
  }
  table.print();
  for (const std::string& note : notes) print_note(note);
}

/// SLR of one optimizer in one mission over the seeds, and how many paths were verified free.
struct Outcomes {
  std::vector<double> slr;
  int free = 0;
  void add(const Mission& mission, const planner::verify::Plan& plan) {
    slr.push_back(mission.slr(plan));
    if (plan.status == planner::verify::PlanStatus::kReaches) ++free;
  }
};

void print_slr(const Options& options, planner::base::WorkerPool& pool) {
  print_title("SLR, paper mode and horizon mode",
              fmt::format("{} seeds each; free: the path was verified free in continuous time.", options.seeds));
  Table table({"mission", "PMOMVO: mean", "std", "most", "free", "NSGA-II: mean", "std", "most", "free",
               "horizon mode: mean", "std", "most", "free"});
  for (int number = 1; number <= 5; ++number) {
    const std::string name = fmt::format("table2-{}", number);
    const Mission mission(name);
    const planner::base::OptimizerSettings settings = mission.request(1).optimizer;
    const auto pagmo = algorithms::make_nsga2(settings, 2, 2);
    Outcomes ours;
    Outcomes theirs;
    Outcomes horizon;
    const planner::base::HorizonSettings flight;
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(options.seeds); ++seed) {
      const planner::paper::PaperRequest request = mission.request(seed);
      ours.add(mission, planner::paper::plan_paper(request, pool));
      theirs.add(mission, planner::paper::plan_paper(request, *pagmo, pool));
      horizon.add(mission,
                  planner::horizon::plan_open_loop(flight, {}, mission.open_loop(), seed, {flight.generations}, pool));
    }
    std::vector<std::string> cells{name};
    for (const Outcomes& outcomes : {ours, theirs, horizon}) {
      cells.push_back(fmt::format("{:.6f}", jink::tools::lab::statistics::mean(outcomes.slr)));
      cells.push_back(fmt::format("{:.6f}", jink::tools::lab::statistics::standard_deviation(outcomes.slr)));
      cells.push_back(fmt::format("{:.6f}", quantile(outcomes.slr, 1.0)));
      cells.push_back(fmt::format("{}", outcomes.free));
    }
    table.row(std::move(cells));
  }
  table.print();
}

}  // namespace

void bench_quality(const Options& options) {
  planner::base::WorkerPool pool(options.cores);
  print_hypervolume(options, pool);
  print_slr(options, pool);
}

}  // namespace jink::tools::lab::bench
