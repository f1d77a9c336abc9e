// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/space_time_search.hpp"

#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "planner/base/random.hpp"
#include "planner/geometry/geometry.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "tools/lab/baselines/baseline.hpp"

namespace jink::tools::lab::baselines {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kPiece = 0.5;      // s, in which a sphere counts as moving evenly
constexpr double kRounding = 1e-9;  // m, s
constexpr double kGoalShare = 0.1;  // of the samples, that are the goal
constexpr double kTubeShare = 0.5;  // of the others, that lie around the straight line
constexpr double kTube = 2.0;       // m, deviation per axis of these

using State = ob::RealVectorStateSpace::StateType;

SpaceTime place(const ob::State* state) {
  const double* v = state->as<State>()->values;
  return {v[3], {v[0], v[1], v[2]}};
}

void assign(const SpaceTime& from, ob::State* to) {
  double* v = to->as<State>()->values;
  for (int k = 0; k < 3; ++k) v[k] = from.position[k];
  v[3] = from.t;
}

/// Whether speed and climb allow to get from one to the other in the time between them.
bool in_time(const SpaceTimeProblem& problem, const SpaceTime& from, const SpaceTime& to) {
  const double t = to.t - from.t;
  const Vec3 way = to.position - from.position;
  return t > kRounding && way.norm() <= problem.speed * t + kRounding &&
         std::abs(way.z()) <= problem.climb * t + kRounding;
}

/// Of the straight way past a body that moves evenly: where it is at a time, and how far the vehicle is from it.
struct Passage {
  SpaceTime from, to;  ///< of the vehicle
  Vec3 begin, end;     ///< of the body's centre
  const planner::base::Track& body;

  [[nodiscard]] double distance(double share) const {
    const Vec3 place = from.position + share * (to.position - from.position);
    return body_distance(body, begin + share * (end - begin), from.t + share * (to.t - from.t), place);
  }
  /// The most that the distance changes from one share of the way to another.
  [[nodiscard]] double change(double shares) const {
    const double turning = std::abs(body.body.yaw_rate) * (to.t - from.t) * body.radius;
    return shares * ((to.position - from.position - end + begin).norm() + turning);
  }
};

/// Whether it keeps the body's gap between two shares of the way: nowhere is it less than falling from both ends until
/// they meet gives.
bool keeps_gap(const Passage& passage, double gap, double low, double at_low, double high, double at_high) {
  constexpr double kFinest = 0.01;  // m
  if (std::min(at_low, at_high) < gap) return false;
  const double change = passage.change(high - low);
  if (0.5 * (at_low + at_high - change) >= gap || change < kFinest) return true;
  const double middle = 0.5 * (low + high);
  const double there = passage.distance(middle);
  return keeps_gap(passage, gap, low, at_low, middle, there) && keeps_gap(passage, gap, middle, there, high, at_high);
}

/// The shortest time for a way, s.
double least_time(const SpaceTimeProblem& problem, const Vec3& from, const Vec3& to) {
  return std::max((to - from).norm() / problem.speed, std::abs(to.z() - from.z()) / problem.climb);
}

/// Distance in space; farther where neither can be reached from the other in time.
class SpaceTimeSpace final : public ob::RealVectorStateSpace {
 public:
  explicit SpaceTimeSpace(const SpaceTimeProblem& problem) : ob::RealVectorStateSpace(4), problem_(problem) {}

  double distance(const ob::State* a, const ob::State* b) const override {
    constexpr double kUnreachable = 100.0;  // per metre that is missing
    const SpaceTime from = place(a);
    const SpaceTime to = place(b);
    const double missing =
        problem_.speed * (least_time(problem_, from.position, to.position) - std::abs(to.t - from.t));
    return (to.position - from.position).norm() + kUnreachable * std::max(0.0, missing);
  }

 private:
  const SpaceTimeProblem& problem_;
};

/// Hints first, then places in the region at times at which they can be reached.
class Sampler final : public ob::StateSampler {
 public:
  Sampler(const ob::StateSpace* space, const SpaceTimeProblem& problem, std::span<const SpaceTime> hints,
          std::uint64_t seed, std::uint64_t stream)
      : ob::StateSampler(space), problem_(problem), hints_(hints), random_(seed, stream) {}

  void sampleUniform(ob::State* state) override {
    if (next_hint_ < hints_.size()) {
      assign(hints_[next_hint_++], state);
      return;
    }
    SpaceTime sample;
    if (random_.uniform() < kGoalShare) {
      sample.position = problem_.goal;
    } else if (random_.uniform() < kTubeShare) {
      sample.position = problem_.start + random_.uniform() * (problem_.goal - problem_.start);
      for (int k = 0; k < 3; ++k) sample.position[k] += kTube * random_.normal();
      sample.position = sample.position.cwiseMax(problem_.region.min).cwiseMin(problem_.region.max);
    } else {
      for (int k = 0; k < 3; ++k) sample.position[k] = random_.uniform(problem_.region.min[k], problem_.region.max[k]);
    }
    sample.t = least_time(problem_, problem_.start, sample.position) + problem_.slack * random_.uniform();
    assign(sample, state);
  }
  // RRT* asks for neither.
  void sampleUniformNear(ob::State* state, const ob::State* /*near*/, double /*distance*/) override {
    sampleUniform(state);
  }
  void sampleGaussian(ob::State* state, const ob::State* /*mean*/, double /*deviation*/) override {
    sampleUniform(state);
  }

 private:
  const SpaceTimeProblem& problem_;
  std::span<const SpaceTime> hints_;
  std::size_t next_hint_ = 0;
  planner::base::RandomStream random_;
};

class Edges final : public ob::MotionValidator {
 public:
  Edges(const ob::SpaceInformationPtr& information, const SpaceTimeProblem& problem)
      : ob::MotionValidator(information), problem_(problem) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return is_free(problem_, place(a), place(b));
  }
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& /*last*/) const override {
    return checkMotion(a, b);
  }

 private:
  const SpaceTimeProblem& problem_;
};

class LengthAndTime final : public ob::OptimizationObjective {
 public:
  LengthAndTime(const ob::SpaceInformationPtr& information, const SpaceTimeProblem& problem, double hurry)
      : ob::OptimizationObjective(information), problem_(problem), hurry_(hurry) {}
  ob::Cost stateCost(const ob::State* /*state*/) const override { return ob::Cost(0.0); }
  ob::Cost motionCost(const ob::State* a, const ob::State* b) const override {
    const SpaceTime from = place(a);
    const SpaceTime to = place(b);
    if (!in_time(problem_, from, to)) return infiniteCost();
    return ob::Cost((to.position - from.position).norm() + hurry_ * problem_.speed * (to.t - from.t));
  }
  bool isSymmetric() const override { return false; }

 private:
  const SpaceTimeProblem& problem_;
  double hurry_;
};

class NearGoal final : public ob::Goal {
 public:
  NearGoal(const ob::SpaceInformationPtr& information, const SpaceTimeProblem& problem)
      : ob::Goal(information), problem_(problem) {}
  bool isSatisfied(const ob::State* state) const override { return isSatisfied(state, nullptr); }
  bool isSatisfied(const ob::State* state, double* distance) const override {
    const double left = (place(state).position - problem_.goal).norm();
    if (distance != nullptr) *distance = left;
    return left <= problem_.tolerance;
  }

 private:
  const SpaceTimeProblem& problem_;
};

/// Moves all places from `first` on to the times at which they are reached at full speed.
void hasten(const SpaceTimeProblem& problem, std::vector<SpaceTime>& way, std::size_t first) {
  for (std::size_t i = first; i < way.size(); ++i)
    way[i].t = way[i - 1].t + least_time(problem, way[i - 1].position, way[i].position) + kRounding;
}

bool all_free(const SpaceTimeProblem& problem, const std::vector<SpaceTime>& way, std::size_t first) {
  for (std::size_t i = std::max<std::size_t>(first, 1); i < way.size(); ++i) {
    if (!is_free(problem, way[i - 1], way[i])) return false;
  }
  return true;
}

}  // namespace

bool is_free(const SpaceTimeProblem& problem, const SpaceTime& from, const SpaceTime& to) {
  if (!in_time(problem, from, to) || !problem.region.contains(to.position, kRounding)) return false;
  const int pieces = std::max(1, static_cast<int>(std::ceil((to.t - from.t) / kPiece)));
  const auto at = [&](int piece) {
    const double share = static_cast<double>(piece) / pieces;
    return SpaceTime{from.t + share * (to.t - from.t), from.position + share * (to.position - from.position)};
  };
  for (int piece = 0; piece < pieces; ++piece) {
    const SpaceTime a = at(piece);
    const SpaceTime b = at(piece + 1);
    for (const planner::base::Track& sphere : problem.spheres) {
      const Vec3 c = planner::geometry::predict_position(sphere, a.t, problem.acceleration_trust);
      const Vec3 d = planner::geometry::predict_position(sphere, b.t, problem.acceleration_trust);
      if (planner::geometry::swept_distance_squared(a.position, b.position, c, d) >= sphere.radius * sphere.radius)
        continue;
      if (!sphere.body.solid) return false;
      const Passage passage{a, b, c, d, sphere};
      if (!keeps_gap(passage, body_gap(sphere), 0.0, passage.distance(0.0), 1.0, passage.distance(1.0))) return false;
    }
  }
  return true;
}

void shorten(const SpaceTimeProblem& problem, std::vector<SpaceTime>& way) {
  // From each place straight to the farthest that can be reached so at the time given.
  for (std::size_t i = 0; i + 2 < way.size(); ++i) {
    std::size_t next = way.size() - 1;
    while (next > i + 1 && !is_free(problem, way[i], way[next])) --next;
    way.erase(way.begin() + static_cast<std::ptrdiff_t>(i) + 1, way.begin() + static_cast<std::ptrdiff_t>(next));
  }
  for (std::size_t i = 1; i < way.size(); ++i) {
    std::vector<SpaceTime> sooner = way;
    hasten(problem, sooner, i);
    if (all_free(problem, sooner, i)) {
      way = std::move(sooner);
      return;
    }
  }
}

std::vector<SpaceTime> search_space_time(const SpaceTimeProblem& problem, const SpaceTimeSettings& settings,
                                         std::span<const SpaceTime> hints, std::uint64_t seed, std::uint64_t stream) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  const auto space = std::make_shared<SpaceTimeSpace>(problem);
  ob::RealVectorBounds bounds(4);
  for (unsigned k = 0; k < 3; ++k) {
    bounds.setLow(k, problem.region.min[k] - 1.0);
    bounds.setHigh(k, problem.region.max[k] + 1.0);
  }
  const double diagonal = (problem.region.max - problem.region.min).norm();
  bounds.setLow(3, 0.0);
  bounds.setHigh(3, diagonal / std::min(problem.speed, problem.climb) + problem.slack + 1.0);
  space->setBounds(bounds);
  space->setStateSamplerAllocator(
      [&](const ob::StateSpace* of) { return std::make_shared<Sampler>(of, problem, hints, seed, stream); });
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([](const ob::State*) { return true; });  // edges are checked, with their ends
  information->setMotionValidator(std::make_shared<Edges>(information, problem));
  information->setup();

  const auto definition = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<ob::RealVectorStateSpace> start(space);
  assign({0.0, problem.start}, start.get());
  definition->addStartState(start);
  definition->setGoal(std::make_shared<NearGoal>(information, problem));
  definition->setOptimizationObjective(std::make_shared<LengthAndTime>(information, problem, settings.hurry));

  og::RRTstar planner(information);
  planner.setRange(settings.range);
  planner.setKNearest(false);  // looking at all for the k nearest would sort all
  planner.setProblemDefinition(definition);
  planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();
  ob::IterationTerminationCondition iterations(static_cast<unsigned>(settings.iterations));
  planner.solve(iterations);

  std::vector<SpaceTime> way{{0.0, problem.start}};
  if (const ob::PathPtr path = definition->getSolutionPath()) {
    const auto& states = path->as<og::PathGeometric>()->getStates();
    for (std::size_t i = 1; i < states.size(); ++i) way.push_back(place(states[i]));
  }
  shorten(problem, way);
  return way;
}

}  // namespace jink::tools::lab::baselines
