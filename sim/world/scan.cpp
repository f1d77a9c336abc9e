// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world/scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

#include "planner/base/random.hpp"
#include "sim/world/shapes.hpp"

namespace jink::sim::world {
namespace {

constexpr std::uint64_t kScanStream = 0x7363616eULL;  // apart from others of the same seed: "scan" in ASCII
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kOnSurface = 1e-3;  // m
constexpr double kDue = 1e-9;        // s: k / rate and a sum of steps differ by rounding

double to_box(const Vec3& half, const Vec3& from, const Vec3& direction) {
  double enters = 0.0;
  double leaves = planner::base::kInfinity;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (std::abs(from[axis]) > half[axis]) return planner::base::kInfinity;
      continue;
    }
    const double a = (-half[axis] - from[axis]) / direction[axis];
    const double b = (half[axis] - from[axis]) / direction[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters <= leaves ? enters : planner::base::kInfinity;
}

double to_sphere(const Vec3& center, double radius, const Vec3& from, const Vec3& direction) {
  const Vec3 way = center - from;
  const double along = way.dot(direction);
  const double beyond = radius * radius - (way - along * direction).squaredNorm();
  if (way.squaredNorm() <= radius * radius) return 0.0;
  return beyond < 0.0 || along < 0.0 ? planner::base::kInfinity : along - std::sqrt(beyond);
}

/// An obstacle or a solid of the map, as it is at the time of a scan.
struct Target {
  const config::Shape* shape;
  Sphere bound;
  Eigen::Matrix3d to_own;
  Vec3 from;  // the sensor, along its own axes
};

std::vector<Target> targets_within(const World& world, double range, double t, const Vec3& from) {
  std::vector<int> near;
  for (int i = 0; i < world.obstacle_count(); ++i) near.push_back(i);
  world.map()->visit({from, from}, range, [&](std::size_t solid) {
    near.push_back(world.obstacle_count() + static_cast<int>(solid));
    return range;
  });
  std::sort(near.begin(), near.end());
  std::vector<Target> targets;
  for (const int i : near) {
    const Sphere bound = world.sphere(i, t);
    if ((bound.center - from).norm() - bound.radius > range) continue;
    const config::Obstacle& obstacle = world.spec(i);
    const Eigen::Matrix3d to_own = axes_at(obstacle, t).transpose();
    targets.push_back({&obstacle.shape, bound, to_own, to_own * (from - world.obstacle(i, t).position)});
  }
  return targets;
}

double length_of(const std::vector<Target>& targets, const Vec3& from, const Vec3& direction, double range,
                 double ground) {
  double length = range;
  if (direction.z() < 0.0 && from.z() > ground) length = std::min(length, (ground - from.z()) / direction.z());
  for (const Target& target : targets) {
    if (!(to_sphere(target.bound.center, target.bound.radius, from, direction) < length)) continue;
    length = std::min(length, ray_length(*target.shape, target.from, target.to_own * direction, length));
  }
  return length < range ? length : planner::base::kInfinity;
}

}  // namespace

double ray_length(const config::Shape& shape, const Vec3& from, const Vec3& direction, double range) {
  double length = 0.0;
  if (const auto* box = std::get_if<config::BoxShape>(&shape)) {
    length = to_box(0.5 * box->edges, from, direction);
  } else if (const auto* sphere = std::get_if<config::SphereShape>(&shape)) {
    length = to_sphere(Vec3::Zero(), sphere->radius, from, direction);
  } else {
    // A convex shape is no nearer than its distance.
    for (double left = kOnSurface; left >= kOnSurface && length <= range; length += std::max(left, 0.0))
      left = distance(shape, Vec3::Zero(), from + length * direction);
  }
  return length <= range ? length : planner::base::kInfinity;
}

std::vector<Eigen::Vector3f> scan(const World& world, const config::Scan& sensor, std::uint64_t seed,
                                  std::uint64_t sequence, double t, double ground, const Eigen::Isometry3d& body) {
  const Vec3 from = body.translation();
  const std::vector<Target> targets = targets_within(world, sensor.range, t, from);
  std::vector<Eigen::Vector3f> points;
  points.reserve(static_cast<std::size_t>(sensor.columns) * static_cast<std::size_t>(sensor.rows));
  for (int row = 0; row < sensor.rows; ++row) {
    const double up = ((row + 0.5) / sensor.rows - 0.5) * sensor.vertical_deg * kDegree;
    for (int column = 0; column < sensor.columns; ++column) {
      const double left = ((column + 0.5) / sensor.columns - 0.5) * sensor.horizontal_deg * kDegree;
      const Vec3 ahead(std::cos(up) * std::cos(left), std::cos(up) * std::sin(left), std::sin(up));
      double length = length_of(targets, from, body.linear() * ahead, sensor.range, ground);
      if (sensor.noise > 0.0)
        length += sensor.noise * planner::base::RandomStream(seed ^ kScanStream, sequence, points.size()).normal();
      points.emplace_back(std::isfinite(length)
                              ? (std::max(0.0, length) * ahead).cast<float>().eval()
                              : Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()).eval());
    }
  }
  return points;
}

ScanPipeline::ScanPipeline(const World& world, std::uint64_t seed, std::uint64_t vehicle)
    : world_(world),
      seed_(seed + vehicle),
      ground_(std::min({0.0, world.scenario().start.z(), world.scenario().target.z()})) {}

void ScanPipeline::step(double t, const Eigen::Isometry3d& body, double clock_start) {
  const config::Sensing& sensing = world_.scenario().sensing;
  for (;; ++next_) {
    const double due = static_cast<double>(next_) / sensing.scan->rate;
    if (!(due <= t + kDue)) return;
    pending_.push_back(
        {due, due + sensing.delay, scan(world_, *sensing.scan, seed_, next_, due - clock_start, ground_, body)});
  }
}

bool ScanPipeline::poll(double t, ScanMessage& message) {
  if (pending_.empty() || !(pending_.front().publication <= t + kDue)) return false;
  message = std::move(pending_.front());
  pending_.pop_front();
  return true;
}

}  // namespace jink::sim::world
