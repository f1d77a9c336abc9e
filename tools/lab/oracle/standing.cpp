// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/oracle/standing.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "planner/base/portable_math.hpp"
#include "sim/world/obstacle_models.hpp"

namespace jink::tools::lab::oracle {
namespace {

constexpr double kSpacing = 0.25;   // m, between nodes
constexpr double kMostNodes = 7e5;  // more are spaced wider
constexpr double kFurther = 8.0;    // s, by which a way may be longer than the best
constexpr double kShortest = 0.01;  // m, pieces that are cut no more

bool stands(const config::Obstacle& obstacle, double time_limit) {
  return obstacle.yaw_rate == 0.0 && sim::world::speed_bound(obstacle.motion, 0.0, time_limit) == 0.0;
}

/// How wide the nodes of that box are spaced.
double spacing_in(const planner::base::Box& box) {
  const Vec3 size = box.max - box.min;
  double spacing = kSpacing;
  while (size.prod() / std::pow(spacing, 3) > kMostNodes) spacing *= 2.0;
  return spacing;
}

}  // namespace

config::Scenario with_map_as_obstacles(const config::Scenario& scenario) {
  config::Scenario result = scenario;
  result.obstacles.insert(result.obstacles.end(), scenario.map.begin(), scenario.map.end());
  result.map.clear();
  return result;
}

config::Scenario with_standing_as_map(const config::Scenario& scenario, bool with_movers) {
  config::Scenario result = scenario;
  result.obstacles.clear();
  for (const config::Obstacle& obstacle : scenario.obstacles) {
    if (stands(obstacle, scenario.time_limit)) {
      const Vec3 place = sim::world::state_at(obstacle.motion, 0.0).position;
      result.map.push_back({obstacle.shape, config::LinearMotion{place}, obstacle.orientation});
    } else if (with_movers) {
      result.obstacles.push_back(obstacle);
    }
  }
  return result;
}

Standing::Standing(const config::Scenario& scenario, const planner::base::Box& box, double keep_off)
    : world_(with_standing_as_map(scenario, false)),
      keep_off_(keep_off),
      max_speed_(scenario.vehicle.max_speed),
      max_climb_(scenario.vehicle.max_climb),
      start_(scenario.start),
      target_(scenario.target),
      spacing_(spacing_in(box)),
      origin_(start_ + spacing_ * ((box.min - start_) / spacing_).array().ceil().matrix()),
      count_(((box.max - origin_) / spacing_).array().floor().cast<int>() + 1) {
  if (empty()) return;
  const auto nodes = static_cast<std::size_t>(count_.prod());
  distances_.assign(nodes, -1.0);
  times_.assign(nodes, planner::base::kInfinity);
  next_.assign(nodes, -1);
  find_ways();
}

Index Standing::node_of(std::size_t number) const {
  const auto n = static_cast<int>(number);
  return {n % count_.x(), n / count_.x() % count_.y(), n / (count_.x() * count_.y())};
}

double Standing::duration(const Vec3& way) const {
  return planner::base::hypotenuse(way.head<2>().norm() / max_speed_, way.z() / max_climb_);
}

double Standing::distance(const Index& node) {
  double& known = distances_[number(node)];
  if (known < 0.0) known = std::max(0.0, world_.clearance(place_of(node), 0.0, 0.0));
  return known;
}

// A*, from the nodes about the target to the start, and on while ways from there to the start are not much longer: what
// is left out is not worth a visit.
void Standing::find_ways() {
  using Open = std::pair<double, std::int32_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const auto over = [&](const Index& node) { return times_[number(node)] + duration(place_of(node) - start_); };
  const auto reach = [&](const Index& node, double time, std::size_t next) {
    if (!contains(node)) return;
    const std::size_t at = number(node);
    if (time >= times_[at] || distance(node) < keep_off_) return;
    times_[at] = time;
    next_[at] = static_cast<std::int32_t>(next);
    open.emplace(over(node), static_cast<std::int32_t>(at));
  };
  const auto for_neighbours = [](const auto& visit) {
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) visit(Index(x, y, z));
      }
    }
  };
  const Index last = nearest(target_);
  for_neighbours([&](const Index& step) {
    const Index node = last + step;
    if (contains(node)) reach(node, duration(target_ - place_of(node)), number(node));
  });
  double until = planner::base::kInfinity;
  while (!open.empty()) {
    const double whole = open.top().first;
    const auto here = static_cast<std::size_t>(open.top().second);
    open.pop();
    const Index node = node_of(here);
    if (whole > over(node)) continue;
    if ((node == nearest(start_)).all()) until = whole + kFurther;
    if (whole > until) break;
    for_neighbours([&](const Index& step) {
      reach(node + step, times_[here] + duration(spacing_ * step.cast<double>().matrix()), here);
    });
  }
}

double Standing::least_distance(const Vec3& place) {
  const Index node = nearest(place).max(0).min(count_ - 1);
  return distance(node) - (place - place_of(node)).norm();
}

// What lies between two places is no nearer than falling from both until they meet gives.
bool Standing::clear(const Vec3& from, const Vec3& to) {
  const double half = 0.5 * (to - from).norm();
  const Vec3 middle = 0.5 * (from + to);
  if (least_distance(middle) - half >= keep_off_) return true;
  const double there = world_.clearance(middle, 0.0, 0.0);
  if (there < keep_off_) return false;
  if (there - half >= keep_off_ || half < kShortest) return true;
  return clear(from, middle) && clear(middle, to);
}

std::int64_t Standing::best_node(const Vec3& place, double& time) const {
  time = planner::base::kInfinity;
  std::int64_t best = -1;
  const auto consider = [&](const Index& node) {
    if (!contains(node)) return;
    const double there = times_[number(node)] + duration(place_of(node) - place);
    if (!(there < time)) return;
    time = there;
    best = static_cast<std::int64_t>(number(node));
  };
  const Index node = nearest(place);
  consider(node);
  if (best >= 0 && (place_of(node) - place).norm() < 1e-6) return best;
  const Index low = ((place - origin_) / spacing_).array().floor().cast<int>();
  for (unsigned corner = 0; corner < 8; ++corner)
    consider(low +
             Index(static_cast<int>(corner & 1U), static_cast<int>(corner >> 1U & 1U), static_cast<int>(corner >> 2U)));
  return best;
}

double Standing::time_to_go(const Vec3& place) const {
  double time = 0.0;
  (void)best_node(place, time);
  return time;
}

Vec3 Standing::ahead(const Vec3& place, double far) const {
  double time = 0.0;
  std::int64_t at = best_node(place, time);
  if (at < 0) return target_;
  while (true) {
    const Vec3 here = place_of(node_of(static_cast<std::size_t>(at)));
    const auto next = static_cast<std::int64_t>(next_[static_cast<std::size_t>(at)]);
    if ((here - place).norm() >= far) return here;
    if (next == at) return target_;
    at = next;
  }
}

}  // namespace jink::tools::lab::oracle
