// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/guide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "planner/geometry/static_map.hpp"
#include "planner/horizon/encounters.hpp"
#include "planner/horizon/path_check.hpp"

namespace jink::planner::horizon {
namespace {

constexpr double kAtRest = 0.1;          // m/s, and m/s², up to which something rests
constexpr double kSettled = 1.0;         // s, for which it has rested to stand
constexpr double kSettledInNoise = 3.0;  // s, the same where that is not known exactly
constexpr double kRemembered = 60.0;     // s, since it was seen
constexpr double kTheSame = 0.3;         // m, that it may move meanwhile
constexpr double kSureSigmas = 2.0;      // of its velocity and its position, that these may be off
constexpr double kSigmas = 1.0;          // of its position, that something counts as larger
constexpr double kFineGrid = 0.5;        // times the cell, where a coarse grid has no way
constexpr double kSearchAgain = 2.0;     // s, after a search that found none
constexpr double kNarrower = 0.05;       // m, by which a way may get narrower until another is looked for
constexpr double kCutOff = 0.3;          // m, of the way, that need not be in sight
constexpr double kRoom = 0.1;            // m, beside the middle of a narrow place, for the vehicle to pass it
constexpr double kOutOfTheWay = 50.0;    // m, farther away than the target, what stands does not matter
constexpr double kStrayed = 2.5;         // m, from the way, where it is looked for anew
constexpr double kTied = 1e-9;           // m: of two legs that are as near the later one counts
constexpr double kAhead = 5.0;           // m, along the way, that a vehicle may have gone since
constexpr double kSlowDownAhead = 4.0;   // m, of a narrow place
constexpr double kSample = 0.25;         // m, along a way
constexpr double kSlowestShare = 0.3;    // of the cruise speed, in the narrowest place
constexpr int kSides = 8;                // directions on the level, in which there may be more room
constexpr double kAside = 1.3;           // times what is lacking, so far that way
constexpr int kHalvings = 6;             // of a leg, to the farthest place in sight
constexpr int kMissed = 8;               // places out of sight, after which none farther is looked at

Vec3 nearest_on_line(const Vec3& place, const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double squared = way.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((place - from).dot(way) / squared, 0.0, 1.0) : 0.0;
  return from + share * way;
}

double length_of(std::span<const Vec3> way) {
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) length += (way[i] - way[i - 1]).norm();
  return length;
}

// What swings rests where it turns: there its acceleration tells. In noise that is no more than a guess.
bool rests(const base::Track& track) {
  return track.body.yaw_rate == 0.0 && track.velocity.norm() <= kAtRest + kSureSigmas * track.velocity_sigma &&
         (track.velocity_sigma > 0.0 || track.acceleration.norm() <= kAtRest);
}

}  // namespace

void Guide::lead(PathRequest& request, double now, const MapPlace& map) {
  narrow_ = false;
  if (!settings_.guide || !is_valid(request)) return;
  notice(request, now, map);
  if ((request.target - target_).squaredNorm() > 0.0) {
    target_ = request.target;
    way_.clear();
    search_ = {};
    search_again_ = now;
  }
  if (standing_.empty() ||
      standing_.is_clear(request.position, request.target, request.vehicle.radius + request.margin)) {
    way_.clear();
    search_ = {};
    return;
  }
  if (way_.empty() || !pass(request.position) || !is_open(way_, request)) look_for_way(request, now);
  if (way_.empty()) return;
  slow_down(request);
  const double left = (way_.front() - request.position).norm() + length_of(way_);
  request.stuck = request.stuck && progress_.stalls(now, left);
  const std::size_t leg = lead_ahead(request);
  request.visit = request.visit && request.target == target_;
  request.way.assign(way_.begin() + 1, way_.begin() + static_cast<std::ptrdiff_t>(leg));
  request.way.push_back(request.target);
}

void Guide::notice(const PathRequest& request, double now, const MapPlace& map) {
  std::vector<base::Track> standing;
  if (knowledge_ == Knowledge::kWhole) {
    std::copy_if(request.tracks.begin(), request.tracks.end(), std::back_inserter(standing), rests);
  } else {
    watch(request, now);
    for (const Seen& s : seen_) {
      if (now - s.since >= (s.track.velocity_sigma > 0.0 ? kSettledInNoise : kSettled)) standing.push_back(s.track);
    }
  }
  standing_.set(standing, map, kSigmas);
  sigma_ = map.sigma;
  standing_ids_.clear();
  for (const base::Track& track : standing) {
    sigma_ = std::max(sigma_, track.position_sigma);
    standing_ids_.push_back(track.id);
  }
}

// What is far off stands in no way, however much of it there is.
// What is out of sight, beyond all that is seen now, is where it was; what would be seen and is not, is gone.
void Guide::watch(const PathRequest& request, double now) {
  std::unordered_map<std::uint64_t, std::size_t> known;
  for (std::size_t i = 0; i < seen_.size(); ++i) known[seen_[i].track.id] = i;
  double sight = 0.0;
  const double far = (request.target - request.position).norm() + kOutOfTheWay;
  for (const base::Track& track : request.tracks) {
    const double distance = (track.position - request.position).norm();
    sight = std::max(sight, distance);
    if (distance - track.radius > far) continue;
    const auto found = known.find(track.id);
    if (found == known.end()) {
      seen_.push_back({track, track.position, now, now});
      continue;
    }
    Seen& seen = seen_[found->second];
    const bool moved = (seen.from - track.position).norm() > kTheSame + kSureSigmas * track.position_sigma;
    if (moved || !rests(track)) {
      seen.from = track.position;
      seen.since = now;
    }
    seen.track = track;
    seen.last = now;
  }
  std::erase_if(seen_, [&](const Seen& s) {
    return s.last < now &&
           (now - s.last > kRemembered || !rests(s.track) || (s.track.position - request.position).norm() < sight);
  });
}

// On a coarse grid, then on a fine one. What was found is still led along meanwhile.
void Guide::look_for_way(const PathRequest& request, double now) {
  if (now < search_again_) return;
  const double wanted = std::max(request.margin, settings_.guide_margin) + settings_.seed_clearance;
  const base::VehicleLimits& vehicle = request.vehicle;
  const GridQuery query{request.position,
                        request.target,
                        request.volume,
                        vehicle.radius,
                        settings_.guide_margin,
                        wanted,
                        vehicle.cruise_speed / vehicle.max_climb,
                        settings_.guide_cell};
  if (search_.state() != GridSearch::State::kSearching) search_.begin(query);
  const int places = knowledge_ == Knowledge::kWhole ? std::numeric_limits<int>::max() : settings_.guide_places;
  GridSearch::State state = search_.advance(standing_, places);
  if (state == GridSearch::State::kNone && search_.query().cell == settings_.guide_cell) {
    GridQuery fine = query;
    fine.cell *= kFineGrid;
    search_.begin(fine);
    state = search_.advance(standing_, places);
  }
  if (state == GridSearch::State::kSearching) return;
  if (state == GridSearch::State::kNone)
    search_again_ = knowledge_ == Knowledge::kWhole ? base::kInfinity : now + kSearchAgain;
  way_ = state == GridSearch::State::kFound ? pulled_tight(search_.way(), request) : std::vector<Vec3>();
  search_ = {};
  progress_.begin_anew();
  if (!way_.empty() && !is_open(way_, request)) way_.clear();  // what stands has changed since
}

// From each place to the farthest in sight that is no nearer to anything than the places between them are.
std::vector<Vec3> Guide::pulled_tight(const std::vector<Vec3>& way, const PathRequest& request) const {
  const double wanted = request.vehicle.radius + first_clearance(request, settings_);
  std::vector<double> clearance;
  for (const Vec3& place : way) clearance.push_back(standing_.distance(place, wanted));
  std::vector<Vec3> tight{way.front()};
  for (std::size_t i = 0; i + 1 < way.size();) {
    std::size_t farthest = i + 1;
    double kept = std::min(clearance[i], clearance[i + 1]);
    int missed = 0;
    for (std::size_t j = i + 2; j < way.size() && missed < kMissed; ++j) {
      kept = std::min(kept, clearance[j]);
      if (standing_.is_clear(way[i], way[j], kept)) {
        farthest = j;
        missed = 0;
      } else {
        ++missed;
      }
    }
    tight.push_back(way[farthest]);
    i = farthest;
  }
  return tight;
}

// The first leg begins where the vehicle is, wherever that is.
bool Guide::is_open(std::span<const Vec3> way, const PathRequest& request) const {
  const double kept = request.vehicle.radius + std::max(0.0, settings_.guide_margin - kNarrower);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double least = i == 1 ? std::min(kept, standing_.distance(way[0], kept)) : kept;
    if (!standing_.is_clear(way[i - 1], way[i], least)) return false;
  }
  return true;
}

// Takes off the part of the way that the vehicle has gone; false where it has left the way.
bool Guide::pass(const Vec3& position) {
  double least = base::kInfinity;
  double gone = 0.0;
  std::size_t leg = 1;
  Vec3 nearest = way_.front();
  for (std::size_t i = 1; i < way_.size() && gone <= kAhead; ++i) {
    const Vec3 place = nearest_on_line(position, way_[i - 1], way_[i]);
    if ((place - position).norm() <= least + kTied) {
      least = (place - position).norm();
      leg = i;
      nearest = place;
    }
    gone += (way_[i] - way_[i - 1]).norm();
  }
  way_.erase(way_.begin(), way_.begin() + static_cast<std::ptrdiff_t>(leg) - 1);
  way_.front() = nearest;
  return least <= kStrayed;
}

// How far what stands is from there, m, or from a place beside it where that is more: a way may pass near something
// without need.
double Guide::room_at(const Vec3& place, double enough, const base::Box& volume) const {
  const double there = standing_.distance(place, enough);
  double most = there;
  for (int k = 0; k < kSides && most < enough; ++k) {
    const double angle = k * 2.0 * std::numbers::pi / kSides;
    for (const Vec3& aside : {Vec3(std::cos(angle), std::sin(angle), 0.0), Vec3(0.0, 0.0, k % 2 == 0 ? 1.0 : -1.0)}) {
      const Vec3 beside = place + kAside * (enough - there) * aside;
      if (volume.contains(beside)) most = std::max(most, standing_.distance(beside, enough));
    }
  }
  return most;
}

void Guide::slow_down(PathRequest& request) {
  const double radius = request.vehicle.radius;
  const double enough = radius + request.margin + kRoom;
  double narrowest = enough;
  double looked = 0.0;
  for (std::size_t i = 1; i < way_.size() && looked < kSlowDownAhead; ++i) {
    const double length = (way_[i] - way_[i - 1]).norm();
    for (double at = 0.0; at <= length && looked + at < kSlowDownAhead; at += kSample) {
      const Vec3 place = way_[i - 1] + at / std::max(length, kSample) * (way_[i] - way_[i - 1]);
      if (standing_.distance(place, narrowest) < narrowest)
        narrowest = std::min(narrowest, room_at(place, enough, request.volume));
    }
    looked += length;
  }
  if (narrowest >= enough) return;
  const double margin =
      std::min(request.margin, std::max(settings_.guide_margin, narrowest - radius - kRoom) + kSigmas * sigma_);
  const double share = std::max(kSlowestShare, margin / request.margin);
  request.standing_margin = margin;
  narrow_ = true;
  request.vehicle.cruise_speed *= share;
}

// To the target, where the way goes hardly aside of the straight line; else to the farthest place on it in sight, or
// nearly. Returns the end of its leg.
std::size_t Guide::lead_ahead(PathRequest& request) const {
  const double kept = request.vehicle.radius + request.margin_beside_standing();
  const auto is_aside = [&](std::size_t leg, const Vec3& place, double most) {
    return std::any_of(way_.begin() + 1, way_.begin() + static_cast<std::ptrdiff_t>(leg), [&](const Vec3& corner) {
      return (corner - nearest_on_line(corner, request.position, place)).norm() > most;
    });
  };
  const auto is_near = [&](std::size_t leg, const Vec3& place) {
    return !is_aside(leg, place, kCutOff) || standing_.is_clear(request.position, place, kept);
  };
  std::size_t leg = way_.size() - 1;
  if (!is_aside(leg, way_[leg], settings_.guide_deviation)) return leg;
  while (leg > 1 && !is_near(leg, way_[leg])) --leg;
  if (leg + 1 == way_.size()) return leg;
  // Somewhere on the next leg.
  double near = 0.0;
  double far = 1.0;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = 0.5 * (near + far);
    (is_near(leg + 1, way_[leg] + middle * (way_[leg + 1] - way_[leg])) ? near : far) = middle;
  }
  request.target = way_[leg] + near * (way_[leg + 1] - way_[leg]);
  return leg + 1;
}

}  // namespace jink::planner::horizon
