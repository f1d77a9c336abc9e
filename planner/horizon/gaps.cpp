// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "planner/horizon/each_obstacle.hpp"

namespace jink::planner::horizon {
namespace {

constexpr int kRefinements = 3;   // halvings of the spacing
constexpr int kMostMoves = 1000;  // of a place, which out of what is larger than a world leads nowhere
constexpr int kStepsLater = 3;    // after which the place is looked for again

/// An obstacle at one time.
struct Blocker {
  Vec3 position;
  double distance = 0.0;  // between the centres, wanted
  PlacedSolid solid;
  double kept = 0.0;  // from the solid's surface, wanted
};

std::vector<Blocker> blockers(const PathRequest& request, const geometry::PathFrame& frame, const Vec3& centre,
                              double t, double clearance) {
  std::vector<Blocker> list;
  for_each_obstacle(request, clearance, [&](const auto& obstacle) {
    if (t > obstacle.until) return;
    const Vec3 position = obstacle.position(t);
    if (std::abs((position - centre).dot(frame.axis)) < obstacle.wanted)
      list.push_back({position, obstacle.wanted, obstacle.solid(t), obstacle.kept});
  });
  return list;
}

/// How much a place lacks of what is wanted from everything.
double lacking(const std::vector<Blocker>& blockers, const Vec3& place) {
  double most = 0.0;
  for (const Blocker& blocker : blockers) {
    const double squared = (place - blocker.position).squaredNorm();
    if (squared >= blocker.distance * blocker.distance) continue;
    most = std::max(most, blocker.solid.is_none() ? blocker.distance - std::sqrt(squared)
                                                  : blocker.kept - blocker.solid.distance(place));
  }
  return most;
}

/// Moves a place across the path to where it lacks least.
Gap refined(const std::vector<Blocker>& blockers, const geometry::PathFrame& frame, const base::Box& volume,
            double spacing, Gap place) {
  double step = 0.5 * spacing;
  int moves = 0;
  for (int n = 0; n < kRefinements && place.lacking > 0.0; step *= 0.5, ++n) {
    for (bool moved = true; moved && moves < kMostMoves; ++moves) {
      moved = false;
      for (const Vec3& side : {frame.left, Vec3(-frame.left), frame.up, Vec3(-frame.up)}) {
        const Vec3 to = place.position + step * side;
        if (!volume.contains(to)) continue;
        const double lacks = lacking(blockers, to);
        if (lacks >= place.lacking) continue;
        place.position = to;
        place.lacking = lacks;
        moved = true;
      }
    }
  }
  return place;
}

}  // namespace

std::vector<Gap> find_gaps(const PathRequest& request, const geometry::PathFrame& frame, const Vec3& centre, double t,
                           const base::HorizonSettings& settings, std::size_t most) {
  const double clearance = first_clearance(request, settings);
  const double spacing = settings.gap_spacing;
  const double soon = kStepsLater * settings.step;
  const std::vector<Blocker> now = blockers(request, frame, centre, t, clearance);
  const std::vector<Blocker> later = blockers(request, frame, centre, t + soon, clearance);
  const int aside = static_cast<int>(settings.lateral_range / spacing);
  std::vector<Gap> places;
  for (int left = -aside; left <= aside; ++left) {
    for (int up = -aside; up <= aside; ++up) {
      const Vec3 place = centre + spacing * (left * frame.left + up * frame.up);
      if (request.volume.contains(place)) places.push_back({place, Vec3::Zero(), lacking(now, place)});
    }
  }
  std::vector<Gap> chosen;
  const auto before = [&](const Gap& a, const Gap& b) {
    return std::tuple(a.lacking, (a.position - centre).squaredNorm()) <
           std::tuple(b.lacking, (b.position - centre).squaredNorm());
  };
  std::stable_sort(places.begin(), places.end(), before);
  const auto taken = [&](const Gap& place) {
    return std::any_of(chosen.begin(), chosen.end(),
                       [&](const Gap& other) { return (place.position - other.position).norm() < 2.0 * spacing; });
  };
  for (const Gap& place : places) {
    if (chosen.size() == most) break;
    if (taken(place)) continue;
    Gap opening = refined(now, frame, request.volume, spacing, place);
    if (taken(opening)) continue;
    Gap then = opening;
    then.lacking = lacking(later, then.position);
    then = refined(later, frame, request.volume, spacing, then);
    opening.velocity = (then.position - opening.position) / soon;
    chosen.push_back(opening);
  }
  return chosen;
}

Taken taken(const PathRequest& request, const Vec3& place, double clearance, const base::HorizonSettings& settings) {
  const geometry::PathFrame frame(request.position, place);
  const auto is_taken = [&](double t) { return lacking(blockers(request, frame, place, t, clearance), place) > 0.0; };
  const bool now = is_taken(0.0);
  for (int k = 1; k <= 2 * settings.waypoints; ++k) {
    if (is_taken(0.5 * k * settings.leg()) != now) return Taken::kAtTimes;
  }
  return now ? Taken::kThroughout : Taken::kNever;
}

Vec3 beside(const base::TimedPath& unobstructed, const geometry::PathFrame& frame, const Encounter& e) {
  return base::sample(unobstructed, e.t).position - e.from_face.dot(frame.axis) * frame.axis;
}

std::vector<double> passages(const base::HorizonSettings& settings, double t) {
  std::vector<double> times;
  const std::size_t most = static_cast<std::size_t>(settings.waypoints + 1) / 2;
  for (int k = 1; k <= settings.waypoints && times.size() < most; ++k) {
    const double time = k * settings.leg();
    if (time >= t) times.push_back(time);
  }
  return times;
}

}  // namespace jink::planner::horizon
