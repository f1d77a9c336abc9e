// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/benchmark_problems.hpp"

#include <Eigen/Geometry>  // cross products
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "planner/geometry/geometry.hpp"
#include "planner/geometry/obstacle_motion.hpp"
#include "planner/optimizer/pareto.hpp"

namespace jink::tools::lab::study {
namespace {

using planner::optimizer::Cost;
using planner::optimizer::Point2;

constexpr int kGrid = 257;  // points along each variable of the first search
constexpr int kRefinements = 3;
constexpr int kFiner = 4;                // how much finer each is
constexpr double kMargin = 0.05;         // of the front's extent, by which what is searched about may be worse at first
constexpr std::size_t kSearched = 3000;  // points that are searched about
constexpr std::size_t kKept = 400;       // points of the front
constexpr Point2 kReferencePoint{1.1, 1.1};
constexpr int kFirstBlocked =
    2;  // station that may be a step of a blocked world; the last is the one before the target
constexpr int kLeastWaypoints = kFirstBlocked + static_cast<int>(kFrontSteps) + 1;
constexpr int kRoomGrid = 65;
constexpr double kLeastExtent = 0.01;  // m and rad, of a front in each objective
constexpr double kBeside = 0.8;        // m, where the vehicle is
constexpr double kAbove = 0.4;
constexpr double kTurned = 35.0 * std::numbers::pi / 180.0;

struct Sample {
  std::array<double, 2> x{};
  Point2 f{};
};

void sort_by_first(std::vector<Sample>& samples) {
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.f < b.f; });
}

/// Every so-manieth, with both ends.
std::vector<Sample> thinned(std::vector<Sample> samples, std::size_t most) {
  if (samples.size() <= most) return samples;
  std::vector<Sample> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(samples[i * (samples.size() - 1) / (most - 1)]);
  return kept;
}

/// The non-dominated ones of sorted samples, each f once.
std::vector<Sample> non_dominated(const std::vector<Sample>& sorted) {
  std::vector<Sample> front;
  for (const Sample& s : sorted)
    if (front.empty() || s.f[1] < front.back().f[1]) front.push_back(s);
  return front;
}

/// Those of sorted samples that none beats by more than `share` of the front's extent in both objectives. The front
/// alone would not do: one lucky point of a coarse grid dominates others whose neighbourhood has better ones.
std::vector<Sample> nearly_non_dominated(const std::vector<Sample>& sorted, double share) {
  const std::vector<Sample> front = non_dominated(sorted);
  const Point2 margin{share * (front.back().f[0] - front.front().f[0]),
                      share * (front.front().f[1] - front.back().f[1])};
  std::vector<Sample> kept;
  std::size_t before = 0;  // of the front, those better in the first objective by the margin
  for (const Sample& s : sorted) {
    while (before < front.size() && front[before].f[0] < s.f[0] - margin[0]) ++before;
    if (before == 0 || front[before - 1].f[1] >= s.f[1] - margin[1]) kept.push_back(s);
  }
  return kept;
}

/// Adds the costs of the points `x`, one after the other.
void evaluate(const planner::optimizer::Problem& problem, const std::vector<double>& x, std::vector<Sample>& samples) {
  std::vector<Cost> costs(x.size() / 2);
  problem.evaluate(x, costs);
  for (std::size_t i = 0; i < costs.size(); ++i) {
    planner::optimizer::make_rankable(costs[i]);
    samples.push_back({{x[2 * i], x[2 * i + 1]}, {costs[i].f[0], costs[i].f[1]}});
  }
}

Point2 normal(const Point2& point, const ReferenceFront& reference) {
  return planner::optimizer::normalise(point, reference.bounds);
}

/// Where the vehicle comes from and how it flew, at the step to `station`.
struct Situation {
  planner::paper::WaypointProblem::Step step;
  std::vector<planner::base::Track> tracks;
  std::array<double, 2> shortest{};  // offsets of the waypoint on the way straight to the target
};

Situation situation(const World& world, const planner::base::PaperSettings& settings, int station, double side) {
  const int segments = settings.waypoints - 1;
  const Vec3 mission = world.target - world.start;
  const planner::geometry::PathFrame frame(world.start, world.target);
  Situation s;
  s.step.target = world.target;
  s.step.base = world.start + mission * (static_cast<double>(station) / segments);
  s.step.from = world.start + mission * (static_cast<double>(station - 1) / segments) + side * kBeside * frame.left +
                kAbove * frame.up;
  const Vec3 ahead = (world.target - s.step.from).normalized();
  s.step.direction = std::cos(kTurned) * ahead + std::sin(kTurned) * side * frame.left;
  const bool along_x = settings.axis == planner::base::Axis::kWorldX;
  s.step.lateral1 = along_x ? Vec3::UnitY() : frame.left;
  s.step.lateral2 = along_x ? Vec3::UnitZ() : frame.up;
  s.step.volume = world.volume;
  const double floor = std::max(world.volume.min.z(), -settings.lateral_range) - s.step.base.z();
  s.step.lower = {-settings.lateral_range, std::max(-settings.lateral_range, floor)};
  s.step.upper = {settings.lateral_range, settings.lateral_range};
  const Vec3 normal = s.step.lateral1.cross(s.step.lateral2);
  const double share = (s.step.base - s.step.from).dot(normal) / (world.target - s.step.from).dot(normal);
  const Vec3 crossing = s.step.from + share * (world.target - s.step.from) - s.step.base;
  s.shortest = {crossing.dot(s.step.lateral1), crossing.dot(s.step.lateral2)};
  const double t = mission.norm() * static_cast<double>(station - 1) / segments / world.vehicle.cruise_speed;
  for (const planner::base::Track& track : world.tracks) s.tracks.push_back(planner::geometry::predict(track, t));
  return s;
}

FrontStep prepared(const World& world, const planner::base::PaperSettings& settings, int station, double side,
                   double& violation) {
  const Situation s = situation(world, settings, station, side);
  FrontStep step{station, false, planner::paper::WaypointProblem(settings, world.vehicle), {}};
  step.problem.prepare(s.step, s.tracks);
  violation = step.problem.violation(step.problem.waypoint(s.shortest[0], s.shortest[1]));
  step.hit = violation > 0.0;
  return step;
}

double side_of(int station) {
  return station % 2 == 0 ? 1.0 : -1.0;
}

/// Whether some waypoint of the box holds the constraints: where none does, the front is the penalties'.
bool has_room(const planner::paper::WaypointProblem& problem) {
  const auto low = problem.lower(), high = problem.upper();
  for (int i = 0; i < kRoomGrid; ++i)
    for (int j = 0; j < kRoomGrid; ++j)
      if (problem.violation(problem.waypoint(low[0] + (high[0] - low[0]) * i / (kRoomGrid - 1),
                                             low[1] + (high[1] - low[1]) * j / (kRoomGrid - 1))) == 0.0)
        return true;
  return false;
}

/// Searches the step's reference front. False where there is none to compare others with: no room, or hardly more than
/// a point.
bool find_reference(FrontStep& step) {
  if (!has_room(step.problem)) return false;
  step.reference = search_reference(step.problem);
  const planner::optimizer::FrontBounds& b = step.reference.bounds;
  return std::min(b.nadir[0] - b.ideal[0], b.nadir[1] - b.ideal[1]) > kLeastExtent;
}

/// The steps whose shortest way is blocked most, if at all, of those that have a front; in flight order.
std::vector<FrontStep> most_blocked_steps(const World& world, const planner::base::PaperSettings& settings) {
  std::vector<std::pair<double, FrontStep>> found;
  for (int station = kFirstBlocked; station < settings.waypoints - 1; ++station) {
    double violation = 0.0;
    FrontStep step = prepared(world, settings, station, side_of(station), violation);
    found.emplace_back(violation, std::move(step));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<FrontStep> steps;
  for (auto& [violation, step] : found) {
    if (steps.size() == kFrontSteps) break;
    if (find_reference(step)) steps.push_back(std::move(step));
  }
  if (steps.size() < kFrontSteps)
    throw std::invalid_argument("the blocked world has fronts to compare at " + std::to_string(steps.size()) +
                                " waypoints, and " + std::to_string(kFrontSteps) +
                                " are needed: another --seed or other parameters of the section paper");
  std::sort(steps.begin(), steps.end(), [](const FrontStep& a, const FrontStep& b) { return a.station < b.station; });
  return steps;
}

}  // namespace

ReferenceFront search_reference(const planner::optimizer::Problem& problem) {
  const std::array<double, 2> low{problem.lower()[0], problem.lower()[1]};
  const std::array<double, 2> high{problem.upper()[0], problem.upper()[1]};
  std::array<double, 2> spacing{(high[0] - low[0]) / (kGrid - 1), (high[1] - low[1]) / (kGrid - 1)};
  std::vector<double> x;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) x.insert(x.end(), {low[0] + spacing[0] * i, low[1] + spacing[1] * j});
  std::vector<Sample> samples;
  evaluate(problem, x, samples);
  sort_by_first(samples);
  double margin = kMargin;
  for (int round = 0; round < kRefinements; ++round) {
    samples = thinned(nearly_non_dominated(samples, margin), kSearched);
    margin /= kFiner;
    for (double& h : spacing) h /= kFiner;
    x.clear();
    for (const Sample& centre : samples)
      for (int i = -kFiner / 2; i <= kFiner / 2; ++i)
        for (int j = -kFiner / 2; j <= kFiner / 2; ++j)
          x.insert(x.end(), {std::clamp(centre.x[0] + spacing[0] * i, low[0], high[0]),
                             std::clamp(centre.x[1] + spacing[1] * j, low[1], high[1])});
    evaluate(problem, x, samples);
    sort_by_first(samples);
  }
  ReferenceFront reference;
  const std::vector<Sample> front = non_dominated(samples);
  std::vector<Point2> all;
  all.reserve(front.size());
  for (const Sample& s : front) all.push_back(s.f);
  reference.bounds = planner::optimizer::front_bounds(all);
  for (Point2& p : all) p = normal(p, reference);
  reference.hypervolume = planner::optimizer::hypervolume(all, kReferencePoint);
  for (const Sample& s : thinned(front, kKept)) reference.points.push_back(s.f);
  return reference;
}

Indicators indicators(const std::vector<Point2>& front, const ReferenceFront& reference) {
  std::vector<Point2> scaled;
  scaled.reserve(front.size());
  for (const Point2& p : front) scaled.push_back(normal(p, reference));
  return {planner::optimizer::hypervolume(scaled, kReferencePoint),
          planner::optimizer::maximum_spread(front, reference.points), planner::optimizer::hole_relative_size(scaled)};
}

std::vector<FrontStep> front_steps(const World& world, const planner::base::PaperSettings& settings, bool blocked) {
  if (settings.waypoints < kLeastWaypoints)
    throw std::invalid_argument("paper.waypoints: the study needs " + std::to_string(kLeastWaypoints) + " or more");
  if (blocked) return most_blocked_steps(world, settings);
  std::vector<FrontStep> steps;
  for (std::size_t i = 1; i <= kFrontSteps; ++i) {
    const int station = static_cast<int>(i) * settings.waypoints / static_cast<int>(kFrontSteps + 1);
    double violation = 0.0;
    steps.push_back(prepared(world, settings, station, side_of(station), violation));
    if (!find_reference(steps.back()))
      throw std::invalid_argument("scenario 5 has no front to compare at waypoint " + std::to_string(station + 1) +
                                  ": other parameters of the section paper are needed");
  }
  return steps;
}

}  // namespace jink::tools::lab::study
