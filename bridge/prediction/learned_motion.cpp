// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/learned_motion.hpp"

#include <algorithm>
#include <cmath>

#include "planner/base/portable_math.hpp"
#include "planner/base/settings.hpp"
#include "planner/geometry/obstacle_motion.hpp"

namespace jink::bridge::prediction {

namespace {

constexpr double kMoves = 0.3;       // m/s, from which on a track may stop
constexpr double kSureSigmas = 2.0;  // of its velocity
constexpr double kStopping = 4.0;    // m/s², at which it does: a walking person's
constexpr int kStopPoints = 4;       // of the path to the stop

/// One axis of bouncing: folded back into the room as often as needed.
double fold(double x, double least, double most) {
  const bool low = std::isfinite(least);
  const bool high = std::isfinite(most);
  if (low && high) {
    const double width = most - least;
    if (!(width > 0.0)) return least;
    const double phase = std::fmod(x - least, 2.0 * width);
    const double positive = phase < 0.0 ? phase + 2.0 * width : phase;
    return least + (positive > width ? 2.0 * width - positive : positive);
  }
  if (low && x < least) return 2.0 * least - x;
  if (high && x > most) return 2.0 * most - x;
  return x;
}

/// A track's, without points.
planner::geometry::KnownPath path_of(const planner::base::Track& track, double until) {
  planner::geometry::KnownPath path;
  path.id = track.id;
  path.radius = track.radius;
  path.body = track.body;
  path.position_sigma = track.position_sigma;
  path.velocity_sigma = track.velocity_sigma;
  path.age = track.age;
  path.until = until;
  return path;
}

/// The track's plain prediction up to then. What its acceleration may be off by is left out: a forecast that is relied
/// on has shown how the obstacle moves.
planner::geometry::KnownPath plain_path(const planner::base::Track& track, double until, double step, double trust) {
  planner::geometry::KnownPath path = path_of(track, until);
  const int points = std::max(1, static_cast<int>(std::ceil(until / step))) + 1;
  path.points.reserve(static_cast<std::size_t>(points));
  for (int n = 0; n < points; ++n) {
    const double t = n * step;
    path.points.push_back({t, planner::geometry::predict_position(track, t, trust), Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

}  // namespace

Vec3 HarmonicMotion::position(double t) const {
  Vec3 result = terms.row(0);
  for (int k = 1; k <= kHarmonics; ++k) {
    const auto [sine, cosine] = planner::base::sine_cosine(k * frequency * t);
    result += cosine * terms.row(2 * k - 1).transpose() + sine * terms.row(2 * k).transpose();
  }
  return result;
}

HarmonicMotion HarmonicMotion::later(double t) const {
  HarmonicMotion result = *this;
  for (int k = 1; k <= kHarmonics; ++k) {
    const auto [sine, cosine] = planner::base::sine_cosine(k * frequency * t);
    result.terms.row(2 * k - 1) = cosine * terms.row(2 * k - 1) + sine * terms.row(2 * k);
    result.terms.row(2 * k) = cosine * terms.row(2 * k) - sine * terms.row(2 * k - 1);
  }
  return result;
}

Vec3 BouncingMotion::position(double t) const {
  Vec3 result = begin + t * velocity;
  for (int axis = 0; axis < 3; ++axis) result[axis] = fold(result[axis], room.min[axis], room.max[axis]);
  return result;
}

BouncingMotion::Turn BouncingMotion::first_turn() const {
  Turn first;
  for (int axis = 0; axis < 3; ++axis) {
    const double v = velocity[axis];
    if (v == 0.0) continue;
    const double bound = v > 0.0 ? room.max[axis] : room.min[axis];
    const double t = std::max(0.0, (bound - begin[axis]) / v);
    if (t < first.t) first = {t, axis, v > 0.0};
  }
  return first;
}

planner::geometry::KnownPath to_path(const Forecast& forecast, double horizon, double step) {
  planner::geometry::KnownPath path;
  path.radius = forecast.radius;
  path.position_sigma = forecast.position_sigma;
  path.velocity_sigma = forecast.velocity_sigma;
  const int points = std::max(1, static_cast<int>(std::ceil(horizon / step))) + 1;
  path.points.reserve(static_cast<std::size_t>(points));
  for (int n = 0; n < points; ++n) {
    const double t = n * step;
    const Vec3 position = std::visit([t](const auto& motion) { return motion.position(t); }, forecast.motion);
    path.points.push_back({t, position, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

Obstacles obstacles_of(std::span<const planner::base::Track> tracks, std::span<const Forecast> forecasts,
                       std::span<const planner::geometry::KnownPath> paths, double horizon, double step, double trust) {
  Obstacles result;
  result.paths.assign(paths.begin(), paths.end());
  std::vector<bool> replaced(tracks.size(), false);
  for (const Forecast& forecast : forecasts) {
    if (forecast.track >= tracks.size()) continue;
    result.paths.push_back(to_path(forecast, horizon, step));
    result.paths.back().body = tracks[forecast.track].body;
    const planner::base::Track& track = tracks[forecast.track];
    result.paths.back().id = track.id;
    if (!(forecast.plain_until < horizon)) continue;
    replaced[forecast.track] = true;
    if (forecast.plain_until > 0.0) result.paths.push_back(plain_path(track, forecast.plain_until, step, trust));
  }
  result.tracks.reserve(tracks.size());
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!replaced[i]) result.tracks.push_back(tracks[i]);
  }
  return result;
}

void add_stops(std::span<const planner::base::Track> tracks, const Vec3& place, double reach,
               std::vector<planner::geometry::KnownPath>& paths) {
  for (const planner::base::Track& track : tracks) {
    const double speed = track.velocity.norm();
    if (speed < kMoves + kSureSigmas * track.velocity_sigma) continue;
    if ((track.position - place).norm() - track.radius > reach) continue;
    // By the end a vehicle as fast has reacted and can have stopped too: one that follows may be no nearer than that.
    const double time = speed / kStopping;
    planner::geometry::KnownPath& path =
        paths.emplace_back(path_of(track, planner::base::HorizonSettings::kReaction + time));
    for (int n = 0; n <= kStopPoints; ++n) {
      const double t = time * n / kStopPoints;
      path.points.push_back(
          {t, track.position + (t - 0.5 * t * t / time) * track.velocity, Vec3::Zero(), Vec3::Zero()});
    }
  }
}

}  // namespace jink::bridge::prediction
