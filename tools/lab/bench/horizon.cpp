// SPDX-License-Identifier: BSD-3-Clause
// Replanning as in flight, from the state that the last plan prescribes, ten times a second, in moving worlds.
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "planner/horizon/guided_planner.hpp"
#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/reach.hpp"
#include "tools/lab/bench/measure.hpp"
#include "tools/lab/bench/moving_world.hpp"

namespace jink::tools::lab::bench {
namespace {

constexpr double kPeriod = 0.1;   // s, between plans
constexpr double kArrived = 0.5;  // m, from a target: now back to the other

constexpr int kFarEvery = 20;        // rounds; the plans with far targets take long
constexpr double kFarShare = 0.975;  // of the volume's length

/// One vehicle that flies up and down in one world.
class Flight {
 public:
  explicit Flight(const MovingWorldShape& world_shape)
      : shape(world_shape),
        world_(shape, kSeed),
        planner_(planner::base::HorizonSettings{}),
        guided_(planner_, planner::horizon::Guide::Knowledge::kSensed),
        request_(world_.request(planner_.settings())) {
    other_target_ = request_.position;
  }

  /// `deadline_ms`: of the plan; 0: none.
  void replan(double deadline_ms, planner::base::WorkerPool& pool) {
    const std::vector<planner::base::Track> tracks = world_.tracks(t_);
    std::vector<planner::base::Track> standing;
    planner::horizon::PathRequest request = request_;
    request.tracks = tracks;
    if (world_.contact(request_.position, t_)) ++contacts;
    planner::verify::Plan plan;
    planner::base::Budget budget{planner_.settings().generations};
    if (deadline_ms > 0.0)
      budget.deadline = std::chrono::steady_clock::now() + std::chrono::round<std::chrono::nanoseconds>(
                                                               std::chrono::duration<double, std::milli>(deadline_ms));
    ms.push_back(milliseconds([&] {
      if (shape.standing == 0) {
        plan = planner_.plan(request, previous_, kSeed, number_, budget, pool);
        return;
      }
      world_.map().near(planner::horizon::reach_of(request, planner_.settings()), 0.0, standing);
      request.standing = standing;
      plan = guided_.plan(request, t_, {&world_.map()}, previous_, kSeed, number_, budget, pool);
    }));
    if (plan.path.empty()) throw std::logic_error("a request of the benchmark was refused");
    if (plan.verification.free()) ++free;
    if (plan.status == planner::verify::PlanStatus::kBlocked) ++blocked;
    if (plan.kept_previous) ++kept;
    advance(plan.path);
  }

  MovingWorldShape shape;
  std::vector<double> ms;
  int free = 0, kept = 0, blocked = 0, contacts = 0, targets = 0;

 private:
  void advance(const planner::base::TimedPath& path) {
    ++number_;
    t_ = kPeriod * static_cast<double>(number_);
    const planner::base::TimedPoint next = planner::base::sample(path, kPeriod);
    request_.position = next.position;
    request_.velocity = next.velocity;
    previous_ = planner::base::later(path, kPeriod);
    if ((request_.position - request_.target).norm() > kArrived) return;
    ++targets;
    std::swap(request_.target, other_target_);
    previous_.clear();  // a plan to another target is no plan to keep
  }

  MovingWorld world_;
  planner::horizon::HorizonPlanner planner_;
  planner::horizon::GuidedPlanner guided_;
  planner::horizon::PathRequest request_;
  Vec3 other_target_;
  planner::base::TimedPath previous_;
  std::uint64_t number_ = 0;
  double t_ = 0.0;
};

void print(const std::vector<std::unique_ptr<Flight>>& flights) {
  Table table({"obstacles", "volume, m", "mission, m", "replans", "p50, ms", "p99, ms", "max, ms", "p50 : 20's",
               "p99 : 20's", "free", "kept", "blocked", "begun in contact", "targets reached"});
  const std::vector<double>& first = flights.front()->ms;
  for (const auto& flight : flights) {
    const Flight& f = *flight;
    const double p50 = median(f.ms);
    const double p99 = quantile(f.ms, 0.99);
    table.row({fmt::format("{}{}{}", f.shape.obstacles, f.shape.boxes ? " boxes" : "",
                           f.shape.standing > 0 ? fmt::format(", {} stand", f.shape.standing) : ""),
               fmt::format("{:.0f} x {:.0f} x {:.0f}", f.shape.size.x(), f.shape.size.y(), f.shape.size.z()),
               fmt::format("{:.0f}", f.shape.mission), fmt::format("{}", f.ms.size()), fmt::format("{:.2f}", p50),
               fmt::format("{:.2f}", p99), fmt::format("{:.2f}", quantile(f.ms, 1.0)),
               fmt::format("{:.2f}", p50 / median(first)), fmt::format("{:.2f}", p99 / quantile(first, 0.99)),
               fmt::format("{}", f.free), fmt::format("{}", f.kept), fmt::format("{}", f.blocked),
               fmt::format("{}", f.contacts), fmt::format("{}", f.targets)});
  }
  table.print();
}

}  // namespace

void bench_horizon(const Options& options) {
  const planner::base::HorizonSettings s;
  print_title(
      "horizon mode: warm replanning",
      fmt::format(
          "K {}, horizon {} s, n_pop {}, {} generations, m {}, l {}, {}, {} threads; a plan every {} s, the "
          "worlds in turn (the last, with far targets, in every {}th round).\nTracks are exact; bounces are not "
          "foreseen, so an obstacle can turn into the vehicle.",
          s.waypoints, s.time, s.population, s.generations, s.slaves, s.sharing,
          options.deadline_ms > 0.0 ? fmt::format("a deadline of {} ms", options.deadline_ms) : "no deadline",
          options.cores, kPeriod, kFarEvery));
  planner::base::WorkerPool pool(options.cores);
  std::vector<std::unique_ptr<Flight>> flights;
  for (const int obstacles : {20, 200, 2000}) flights.push_back(std::make_unique<Flight>(world_of(obstacles)));
  MovingWorldShape boxes = world_of(20);
  boxes.boxes = true;
  flights.push_back(std::make_unique<Flight>(boxes));
  const MovingWorldShape mapped{2000, {400.0, 200.0, 12.0}, 36.0, false, 10000};
  flights.push_back(std::make_unique<Flight>(mapped));
  MovingWorldShape far = world_of(2000);
  far.mission = kFarShare * far.size.x();
  flights.push_back(std::make_unique<Flight>(far));
  for (int i = 0; i < options.replans; ++i) {
    for (const auto& flight : flights) {
      if (flight != flights.back() || i % kFarEvery == 0) flight->replan(options.deadline_ms, pool);
    }
  }
  print(flights);
}

}  // namespace jink::tools::lab::bench
