// SPDX-License-Identifier: BSD-3-Clause
// What each part of the optimizer is worth: the same problems solved with it and without it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/path_problem.hpp"
#include "planner/optimizer/indicators.hpp"
#include "planner/optimizer/pmomvo.hpp"
#include "sim/families/families.hpp"
#include "sim/world/world.hpp"
#include "tools/lab/bench/fronts.hpp"
#include "tools/lab/bench/measure.hpp"
#include "tools/lab/bench/missions.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr int kWorlds = 10;                     // of each family
constexpr double kPoints[] = {0.0, 0.25, 0.5};  // of the straight line, from which plans start
constexpr int kReferenceFactor = 10;            // generations of the reference over the default's
constexpr double kSteeringShare = 0.01;         // of f2 and f3 in the score
constexpr double kClearanceShare = 0.3;
constexpr double kSame = 1e-9;  // scores nearer than this count as equal

/// A way to search, for horizon plans.
struct Variant {
  std::string name;
  planner::base::OptimizerSettings optimizer;
  bool seeding = true;
};

/// A plan to be made.
struct Case {
  planner::horizon::PathRequest request;  ///< its tracks are set when it is used
  std::vector<planner::base::Track> tracks;
};

/// What a search found: the best of the solutions that violate nothing; infinite where there is none.
struct Found {
  double length = planner::base::kInfinity;
  double score = planner::base::kInfinity;
  [[nodiscard]] bool any() const { return std::isfinite(length); }
  void improve(const Found& other) {
    length = std::min(length, other.length);
    score = std::min(score, other.score);
  }
};

/// The searches of one variant, one for each case.
struct Results {
  std::vector<Found> found;
  std::vector<double> ms;      ///< on all cores
  std::vector<double> one_ms;  ///< on one thread
};

/// Whether the vehicle is nearer to an obstacle than `margin` where the plan starts.
bool nearer_than(double margin, const Case& c) {
  return std::any_of(c.tracks.begin(), c.tracks.end(), [&](const planner::base::Track& track) {
    return (track.position - c.request.position).norm() < track.radius + c.request.vehicle.radius + margin;
  });
}

/// A plan from a point of unobstructed flight, at the time when it is passed: from rest at the start, else at cruise.
Case case_at(const sim::world::World& world, double share, const planner::base::HorizonSettings& settings) {
  const config::Scenario& scenario = world.scenario();
  const planner::base::VehicleLimits& vehicle = scenario.vehicle;
  const Vec3 way = scenario.target - scenario.start;
  const Vec3 forward = way.normalized();
  const double climb = std::abs(forward.z());
  const double cruise =
      climb * vehicle.cruise_speed > vehicle.max_climb ? vehicle.max_climb / climb : vehicle.cruise_speed;
  const double t =
      share > 0.0 ? share * way.norm() / cruise + 0.5 * cruise / sim::families::kStraightAcceleration : 0.0;
  Case c;
  c.request = planner::horizon::PathRequest::with(settings);
  c.request.position = scenario.start + share * way;
  if (share > 0.0) c.request.velocity = cruise * forward;
  c.request.target = scenario.target;
  c.request.volume = world.volume();
  c.request.vehicle = vehicle;
  for (int i = 0; i < world.obstacle_count(); ++i) c.tracks.push_back(world.exact_track(i, t));
  return c;
}

std::vector<Case> make_cases(const Options& options, const planner::base::HorizonSettings& settings) {
  const int worlds = options.quick ? 1 : kWorlds;
  std::vector<Case> cases;
  for (const std::string_view family : measured_families(options)) {
    if (sim::families::has_map(family)) continue;  // the search is asked about tracks
    for (int seed = 1; seed <= worlds; ++seed) {
      const sim::world::World world(sim::families::make_world(family, static_cast<std::uint64_t>(seed)));
      for (const double share : kPoints) {
        Case c = case_at(world, share, settings);
        if (!nearer_than(0.0, c)) cases.push_back(std::move(c));
      }
    }
  }
  return cases;
}

/// The default first, the long reference last.
std::vector<Variant> horizon_variants(const planner::base::HorizonSettings& settings) {
  planner::base::OptimizerSettings base;
  base.slaves = settings.slaves;
  base.sharing = settings.sharing;
  base.population = settings.population;
  base.iterations = settings.generations;
  std::vector<Variant> variants;
  const auto add = [&](std::string name) -> planner::base::OptimizerSettings& {
    variants.push_back({std::move(name), base});
    return variants.back().optimizer;
  };
  add("default");
  add("operators printed").operators = planner::base::Operators::kPrinted;
  add("operators common").operators = planner::base::Operators::kCommon;
  add("operators corrected").operators = planner::base::Operators::kCorrected;
  add("focus 0").focus = 0.0;
  add("opposition").opposition = true;
  add("no seeding");
  variants.back().seeding = false;
  planner::base::OptimizerSettings& momvo = add("1 slave, no sharing");
  momvo.slaves = 1;
  momvo.sharing = 0;
  add("4 slaves").slaves = 4;
  add("8 slaves").slaves = 8;
  add("no sharing").sharing = 0;
  add("half the generations").iterations /= 2;
  add("twice the generations").iterations *= 2;
  add(fmt::format("{} times the generations", kReferenceFactor)).iterations *= kReferenceFactor;
  return variants;
}

Found best_of(const planner::optimizer::Front& front, double straight) {
  Found best;
  for (const planner::optimizer::Cost& cost : front.costs) {
    if (cost.violation > 0.0) continue;
    best.improve({cost.f[0], cost.f[0] / straight + kSteeringShare * cost.f[1] + kClearanceShare * cost.f[2]});
  }
  return best;
}

/// Every case with all variants in turn.
std::vector<Results> solve(const std::vector<Case>& cases, const std::vector<Variant>& variants,
                           const planner::base::HorizonSettings& settings, planner::base::WorkerPool& pool) {
  planner::base::WorkerPool one(1);
  planner::horizon::PathProblem problem(settings);
  std::vector<std::unique_ptr<planner::optimizer::Pmomvo>> optimizers;
  optimizers.reserve(variants.size());
  for (const Variant& variant : variants) {
    optimizers.push_back(
        std::make_unique<planner::optimizer::Pmomvo>(variant.optimizer, problem.dimension(), problem.objectives()));
  }
  std::vector<planner::base::HorizonSettings> seeded(variants.size(), settings);
  for (std::size_t v = 0; v < variants.size(); ++v) seeded[v].seeding = variants[v].seeding;
  std::vector<Results> results(variants.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    planner::horizon::PathRequest request = cases[i].request;
    request.tracks = cases[i].tracks;
    problem.prepare(request);
    const double straight = (request.target - request.position).norm();
    for (std::size_t v = 0; v < variants.size(); ++v) {
      const auto initial = planner::horizon::initial_solutions(problem, request, {}, seeded[v]);
      const planner::base::Budget budget{variants[v].optimizer.iterations};
      Found found;
      const auto search = [&](planner::base::WorkerPool& threads) {
        const planner::optimizer::Front* front = nullptr;
        const double ms =
            milliseconds([&] { front = &optimizers[v]->run(problem, initial, kSeed, i, budget, threads); });
        found = best_of(*front, straight);
        return ms;
      };
      results[v].one_ms.push_back(search(one));
      results[v].found.push_back(found);
      results[v].ms.push_back(search(pool));
      if (found.length != results[v].found.back().length)
        throw std::logic_error("PMOMVO's fronts depend on the number of threads");
    }
  }
  return results;
}

/// The cases that all variants solved, by number, and the best that is known of each case.
struct Known {
  std::vector<std::size_t> common;
  std::vector<Found> best;
  std::size_t solved = 0;  ///< by any
};

Known known_of(const std::vector<Results>& results) {
  Known known;
  known.best.resize(results.front().found.size());
  for (std::size_t i = 0; i < known.best.size(); ++i) {
    bool all = true;
    for (const Results& r : results) {
      known.best[i].improve(r.found[i]);
      all = all && r.found[i].any();
    }
    if (all) known.common.push_back(i);
    if (known.best[i].any()) ++known.solved;
  }
  return known;
}

std::vector<std::string> cells_of(const Variant& variant, const Results& own, const Results& base, const Known& known) {
  std::vector<double> length_gaps;
  std::vector<double> score_gaps;
  for (const std::size_t i : known.common) {
    length_gaps.push_back(100.0 * (own.found[i].length / known.best[i].length - 1.0));
    score_gaps.push_back(100.0 * (own.found[i].score - known.best[i].score));
  }
  int solved = 0;
  int better = 0;
  int worse = 0;
  for (std::size_t i = 0; i < known.best.size(); ++i) {
    if (own.found[i].any()) ++solved;
    if (own.found[i].score < base.found[i].score - kSame) ++better;
    if (own.found[i].score > base.found[i].score + kSame) ++worse;
  }
  if (length_gaps.empty()) length_gaps = score_gaps = {std::nan("")};
  return {variant.name,
          fmt::format("{}", solved),
          fmt::format("{:.3f}", jink::tools::lab::statistics::mean(length_gaps)),
          fmt::format("{:.3f}", quantile(length_gaps, 0.9)),
          fmt::format("{:.3f}", jink::tools::lab::statistics::mean(score_gaps)),
          fmt::format("{}", better),
          fmt::format("{}", worse),
          fmt::format("{:.2f}", median(own.one_ms)),
          fmt::format("{:.2f}", median(own.ms))};
}

void print_horizon(const Options& options, planner::base::WorkerPool& pool) {
  const planner::base::HorizonSettings settings;
  const std::vector<Case> cases = make_cases(options, settings);
  const std::vector<Variant> variants = horizon_variants(settings);
  const planner::base::OptimizerSettings& base = variants.front().optimizer;
  print_title("ablation: horizon mode",
              fmt::format("the optimizer alone, without a plan before, on {} plans from points of unobstructed flight "
                          "in the families of worlds; default: adaptive operators, focus {}, seeding, m {}, l {}, "
                          "n_pop {}, {} generations.\nsolved: a solution of the front violates nothing. "
                          "Gaps to the best that any row found, over the plans that all rows solved: of the shortest "
                          "such solution's f1, and of the least f1 / straight + {} f2 + {} f3, times 100. better, "
                          "worse: plans in which that differs from the default's; unsolved counts as worst. Times are "
                          "medians of the optimizer's run.",
                          cases.size(), base.focus, base.slaves, base.sharing, base.population, base.iterations,
                          kSteeringShare, kClearanceShare));
  const std::vector<Results> results = solve(cases, variants, settings, pool);
  const Known known = known_of(results);
  Table table({"variant", "solved", "mean gap, %", "p90 gap, %", "mean score gap", "better", "worse", "1 thread, ms",
               fmt::format("{} threads, ms", options.cores)});
  for (std::size_t v = 0; v < variants.size(); ++v)
    table.row(cells_of(variants[v], results[v], results.front(), known));
  table.print();
  const auto hopeless =
      std::count_if(cases.begin(), cases.end(), [&](const Case& c) { return nearer_than(settings.margin, c); });
  print_note(fmt::format("{} of {} plans were solved by any row, {} by all; {} start within the margin.", known.solved,
                         cases.size(), known.common.size(), hopeless));
}

/// A way to search, for the paper's steps.
struct PaperVariant {
  const char* name = "";
  planner::base::Operators operators = planner::base::Operators::kAdaptive;
  bool opposition = false;

  [[nodiscard]] planner::base::OptimizerSettings apply(planner::base::OptimizerSettings settings) const {
    settings.operators = operators;
    settings.opposition = opposition;
    return settings;
  }
};

constexpr PaperVariant kPaperVariants[] = {{"operators adaptive (default)", planner::base::Operators::kAdaptive},
                                           {"operators corrected", planner::base::Operators::kCorrected},
                                           {"operators common", planner::base::Operators::kCommon},
                                           {"operators printed", planner::base::Operators::kPrinted},
                                           {"opposition", planner::base::Operators::kAdaptive, true}};
constexpr std::size_t kPaperCount = std::size(kPaperVariants);

/// Of each step of a mission, and of each whole mission.
struct PaperScore {
  std::vector<double> relative, absolute, size;
  std::vector<double> slr;
  int free = 0;
};

/// One step with every variant. The last score is that of all fronts together.
void score_step(const std::vector<std::vector<planner::optimizer::Point2>>& fronts, std::vector<PaperScore>& scores) {
  std::vector<std::vector<planner::optimizer::Point2>> all = fronts;
  all.emplace_back();
  for (const auto& front : fronts) all.back().insert(all.back().end(), front.begin(), front.end());
  const planner::optimizer::FrontBounds bounds = planner::optimizer::front_bounds(all.back());
  const planner::optimizer::FrontBounds units{bounds.ideal, {bounds.ideal[0] + 1.0, bounds.ideal[1] + 1.0}};
  for (std::size_t v = 0; v < all.size(); ++v) {
    scores[v].relative.push_back(volume_of(all[v], bounds));
    scores[v].absolute.push_back(volume_of(all[v], units));
    scores[v].size.push_back(static_cast<double>(all[v].size()));
  }
}

void score_mission(const Mission& mission, std::uint64_t seed, planner::base::WorkerPool& pool,
                   std::vector<PaperScore>& scores) {
  const planner::paper::PaperRequest request = mission.request(seed);
  std::vector<planner::optimizer::Pmomvo> optimizers;
  for (std::size_t v = 0; v < kPaperCount; ++v) {
    planner::paper::PaperRequest changed = request;
    changed.optimizer = kPaperVariants[v].apply(request.optimizer);
    const planner::verify::Plan plan = planner::paper::plan_paper(changed, pool);
    scores[v].slr.push_back(mission.slr(plan));
    if (plan.status == planner::verify::PlanStatus::kReaches) ++scores[v].free;
    optimizers.emplace_back(changed.optimizer, 2, 2);
  }
  std::uint64_t stream = 0;
  for (const planner::paper::WaypointProblem& step : record_steps(mission, seed, pool)) {
    ++stream;
    std::vector<std::vector<planner::optimizer::Point2>> fronts;
    for (planner::optimizer::Pmomvo& optimizer : optimizers) {
      fronts.emplace_back();
      const planner::base::Budget budget{request.optimizer.iterations};
      for (const planner::optimizer::Cost& cost : optimizer.run(step, {}, seed, stream, budget, pool).costs)
        fronts.back().push_back({cost.f[0], cost.f[1]});
    }
    score_step(fronts, scores);
  }
}

void print_paper(const Options& options, planner::base::WorkerPool& pool) {
  print_title("ablation: paper mode",
              fmt::format("every step of the default's missions, {} seeds, solved by all rows, and the missions of "
                          "each row; reference (1.1, 1.1) above the ideal of all fronts together.\nHV: in units of "
                          "the extent of all fronts together; HV, m rad: in m and rad; behind: what is missing to "
                          "the hypervolume of all together, in 1e-6 m rad.",
                          options.seeds));
  Table table({"mission", "variant", "mean HV", "std", "mean HV, m rad", "mean behind", "p90 behind", "mean front size",
               "mean SLR", "std", "most", "free"});
  for (const char* name : {"table2-5", "crossing"}) {
    const Mission mission(name);
    std::vector<PaperScore> scores(kPaperCount + 1);
    for (int seed = 1; seed <= options.seeds; ++seed)
      score_mission(mission, static_cast<std::uint64_t>(seed), pool, scores);
    for (std::size_t v = 0; v < kPaperCount; ++v) {
      const PaperScore& s = scores[v];
      std::vector<double> behind;
      for (std::size_t i = 0; i < s.absolute.size(); ++i)
        behind.push_back(1e6 * (scores.back().absolute[i] - s.absolute[i]));
      table.row({name, kPaperVariants[v].name, fmt::format("{:.5f}", jink::tools::lab::statistics::mean(s.relative)),
                 fmt::format("{:.5f}", jink::tools::lab::statistics::standard_deviation(s.relative)),
                 fmt::format("{:.7f}", jink::tools::lab::statistics::mean(s.absolute)),
                 fmt::format("{:.2f}", jink::tools::lab::statistics::mean(behind)),
                 fmt::format("{:.2f}", quantile(behind, 0.9)),
                 fmt::format("{:.1f}", jink::tools::lab::statistics::mean(s.size)),
                 fmt::format("{:.6f}", jink::tools::lab::statistics::mean(s.slr)),
                 fmt::format("{:.6f}", jink::tools::lab::statistics::standard_deviation(s.slr)),
                 fmt::format("{:.6f}", quantile(s.slr, 1.0)), fmt::format("{}", s.free)});
    }
  }
  table.print();
}

}  // namespace

void bench_ablation(const Options& options) {
  planner::base::WorkerPool pool(options.cores);
  print_horizon(options, pool);
  print_paper(options, pool);
}

}  // namespace jink::tools::lab::bench
