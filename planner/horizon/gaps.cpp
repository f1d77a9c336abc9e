// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "planner/geometry/obstacle_motion.hpp"

namespace jink::planner::horizon {
namespace {

constexpr int kAside = 9, kAbove = 9;  // places looked at on either side
constexpr double kSpacing = 0.5;       // m, between two of them
constexpr int kRefinements = 3;        // halvings of it
constexpr double kLater = 0.3;         // s, after which the place is looked for again

/// An obstacle at one time.
struct Blocker {
  Vec3 position;
  double distance = 0.0;  // between the centres, wanted
};

std::vector<Blocker> blockers(const PathRequest& request, const geometry::PathFrame& frame, const Vec3& centre,
                              double t, double clearance) {
  std::vector<Blocker> list;
  const double wanted = request.vehicle.radius + clearance;
  const auto add = [&](const Vec3& position, double radius) {
    const double distance = radius + wanted;
    if (std::abs((position - centre).dot(frame.axis)) < distance) list.push_back({position, distance});
  };
  for (const base::Track& track : request.tracks) {
    add(geometry::predict_position(track, t, request.acceleration_trust), track.radius);
  }
  for (const geometry::KnownPath& path : request.paths) {
    if (t <= path.until) add(path.position(t), path.radius + path.margin);
  }
  return list;
}

/// How much a place lacks of what is wanted from everything.
double lacking(const std::vector<Blocker>& blockers, const Vec3& place) {
  double most = 0.0;
  for (const Blocker& blocker : blockers) {
    const double squared = (place - blocker.position).squaredNorm();
    if (squared < blocker.distance * blocker.distance) most = std::max(most, blocker.distance - std::sqrt(squared));
  }
  return most;
}

/// Moves a place across the path to where it lacks least.
Gap refined(const std::vector<Blocker>& blockers, const geometry::PathFrame& frame, const base::Box& volume,
            Gap place) {
  double step = 0.5 * kSpacing;
  for (int n = 0; n < kRefinements && place.lacking > 0.0; step *= 0.5, ++n) {
    for (bool moved = true; moved;) {
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
                           double clearance, std::size_t most) {
  const std::vector<Blocker> now = blockers(request, frame, centre, t, clearance);
  const std::vector<Blocker> later = blockers(request, frame, centre, t + kLater, clearance);
  std::vector<Gap> places;
  for (int aside = -kAside; aside <= kAside; ++aside) {
    for (int above = -kAbove; above <= kAbove; ++above) {
      const Vec3 place = centre + kSpacing * (aside * frame.left + above * frame.up);
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
                       [&](const Gap& other) { return (place.position - other.position).norm() < kGapSpacing; });
  };
  for (const Gap& place : places) {
    if (chosen.size() == most) break;
    if (taken(place)) continue;
    Gap opening = refined(now, frame, request.volume, place);
    if (taken(opening)) continue;
    Gap then = opening;
    then.lacking = lacking(later, then.position);
    then = refined(later, frame, request.volume, then);
    opening.velocity = (then.position - opening.position) / kLater;
    chosen.push_back(opening);
  }
  return chosen;
}

}  // namespace jink::planner::horizon
