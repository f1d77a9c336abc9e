// SPDX-License-Identifier: BSD-3-Clause
// What the planner reaches in the families of worlds whose straight line is blocked, open loop and flown in virtual
// time.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "planner/optimizer/indicators.hpp"
#include "sim/families/families.hpp"
#include "sim/flight/closed_loop.hpp"
#include "sim/world/known_world.hpp"
#include "tools/lab/bench/measure.hpp"

namespace jink::tools::lab::bench {
namespace {

/// Results of one family.
struct Tally {
  int reached = 0, collided = 0;
  std::vector<double> slr, time;  ///< of those reached; time in units of straight flight at cruise speed
  double min_clearance = planner::base::kInfinity;

  void add(const config::Scenario& scenario, bool arrived, double length, double duration, double clearance) {
    min_clearance = std::min(min_clearance, clearance);
    if (!arrived) return;
    ++reached;
    const double straight = (scenario.target - scenario.start).norm();
    slr.push_back(planner::optimizer::straight_line_rate(length, straight));
    time.push_back(duration * scenario.vehicle.cruise_speed / straight);
  }
  [[nodiscard]] std::vector<std::string> cells() const {
    if (slr.empty()) return {"-", "-", fmt::format("{:.2f}", min_clearance)};
    return {fmt::format("{:.3f}", mean(slr)), fmt::format("{:.2f}", mean(time)), fmt::format("{:.2f}", min_clearance)};
  }
};

Tally plan_family(std::string_view family, int seeds, planner::base::WorkerPool& pool) {
  const planner::base::HorizonSettings settings;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds); ++seed) {
    const config::Scenario scenario = sim::families::make_world(family, seed);
    const sim::world::KnownWorld world(scenario);
    const planner::verify::Plan plan =
        planner::horizon::plan_open_loop(settings, {}, world.open_loop, seed, {settings.generations}, pool);
    tally.add(scenario, plan.status == planner::verify::PlanStatus::kReaches, planner::base::path_length(plan.path),
              plan.path.back().t, plan.verification.min_clearance);
  }
  return tally;
}

Tally fly_family(std::string_view family, int seeds, int threads) {
  Tally tally;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(seeds); ++seed) {
    const config::Scenario scenario = sim::families::make_world(family, seed);
    sim::flight::ClosedLoopOptions options;
    options.seed = seed;
    options.threads = threads;
    const sim::flight::ClosedLoopResult result = sim::flight::fly_closed_loop(scenario, {}, options);
    if (result.flight.outcome == bridge::supervisor::Outcome::kCollision) ++tally.collided;
    tally.add(scenario, result.flight.outcome == bridge::supervisor::Outcome::kReached, result.flight.path_length,
              result.flight.flight_time, result.min_clearance);
  }
  return tally;
}

}  // namespace

void bench_worlds(const Options& options) {
  const int flights = options.quick ? 1 : options.seeds;
  print_title(
      "worlds whose straight line is blocked",
      fmt::format("{} seeds of each family planned open loop, as `jink plan` (movers that turn are extrapolated "
                  "from t = 0), {} flown closed loop, as `jink replay`.\ntime: of straight flight at cruise "
                  "speed, 1 = as fast; means over those reached. clearance: the smallest of all, m.",
                  options.seeds, flights));
  Table table({"family", "planned", "SLR", "time", "clearance", "flown", "collided", "SLR", "time", "clearance"});
  planner::base::WorkerPool pool(options.cores);
  for (const std::string_view family : measured_families(options)) {
    // Those of the literature, the known places and the teams belong to the arena.
    if (!sim::families::blocks_straight_line(family) || sim::families::has_map(family) ||
        sim::families::make_world(family, 1).obstacles.empty())
      continue;
    const Tally planned = plan_family(family, options.seeds, pool);
    const Tally flown = fly_family(family, flights, options.cores);
    std::vector<std::string> row{std::string(family), fmt::format("{}", planned.reached)};
    for (std::string& cell : planned.cells()) row.push_back(std::move(cell));
    row.push_back(fmt::format("{}", flown.reached));
    row.push_back(fmt::format("{}", flown.collided));
    for (std::string& cell : flown.cells()) row.push_back(std::move(cell));
    table.row(std::move(row));
  }
  table.print();
}

}  // namespace jink::tools::lab::bench
