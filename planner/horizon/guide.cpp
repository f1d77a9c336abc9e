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
#include "planner/horizon/polyline.hpp"

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
constexpr double kBeforeClosed = 1.0;    // m, along a way before where it is closed, to wait there
constexpr double kStrayed = 2.5;         // m, from the way, where it is looked for anew
constexpr double kTied = 1e-9;           // m: of two legs that are as near the later one counts
constexpr double kAhead = 5.0;           // m, along the way, that a vehicle may have gone since
constexpr double kSlowDownAhead = 4.0;   // m, of a narrow place
constexpr double kSample = 0.25;         // m, along a way
constexpr double kSlowestShare = 0.3;    // of the cruise speed, in the narrowest place
constexpr int kSides = 8;                // directions on the level, in which there may be more room
constexpr double kAside = 1.3;           // times what is lacking, so far that way
constexpr int kHalvings = 6;             // of a leg, to the farthest place in sight
constexpr double kGateAhead = 10.0;      // m, along a way, within which it may be closed for a while
constexpr double kGateMore = 0.25;       // m, that a column is wider than the gate that it closes
constexpr double kDetour = 1.5;          // times as long as the way, that another may be
constexpr int kOthers = 10;              // times settings.guide_places, for them in a search that may take its time
constexpr int kMostTries = 6;            // to find others
constexpr std::size_t kMostOthers = 2;   // that are kept
constexpr int kMissed = 8;               // places out of sight, after which none farther is looked at

// Those of each leg that are not farther than `most` along the way.
template <typename Visit>
void for_each_place(std::span<const Vec3> way, double most, const Visit& visit) {
  double looked = 0.0;
  for (std::size_t i = 1; i < way.size() && looked < most; ++i) {
    const double length = (way[i] - way[i - 1]).norm();
    for (double at = 0.0; at <= length && looked + at < most; at += kSample)
      visit(Vec3(way[i - 1] + at / std::max(length, kSample) * (way[i] - way[i - 1])));
    looked += length;
  }
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
    begin_way({});
    search_ = {};
    search_again_ = now;
  }
  const bool known = !way_.empty() && pass(request.position);
  const bool holds = known && is_open(way_, request);
  if (!(holds && taken_) && (standing_.empty() || standing_.is_clear(request.position, request.target,
                                                                     request.vehicle.radius + request.margin))) {
    if (!way_.empty()) begin_way({});
    search_ = {};
    look_for_others(request);
    return;
  }
  closed_off_ = closed_off_ && known && !holds;
  if (!holds) look_for_way(request, now, known);
  if (way_.empty()) return;
  if (closed_off_) {
    lead_along(up_to_closed(request), request);
    return;
  }
  look_for_others(request);
  const double left = (way_.front() - request.position).norm() + length_of(way_);
  request.stuck = request.stuck && progress_.stalls(now, left);
  lead_along(way_, request);
}

void Guide::lead_along(std::size_t other, PathRequest& request) {
  request.stuck = false;
  lead_along(others_[other], request);
}

void Guide::lead_along(std::span<const Vec3> way, PathRequest& request) {
  narrow_ = false;
  slow_down(way, request);
  const std::size_t leg = lead_ahead(way, request);
  request.visit = request.visit && request.target == target_;
  request.way.assign(way.begin() + 1, way.begin() + static_cast<std::ptrdiff_t>(leg));
  request.way.push_back(request.target);
}

void Guide::take(std::size_t other) {
  begin_way(std::vector<Vec3>(others_[other]));
  taken_ = true;
}

void Guide::begin_way(std::vector<Vec3> way) {
  way_ = std::move(way);
  progress_.begin_anew();
  taken_ = closed_off_ = false;
  forget_others();
}

void Guide::forget_others() {
  wants_others_ = false;
  other_search_ = {};
  tries_ = 0;
  closed_.clear();
  others_.clear();
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

// A way that is `known` and closed now is kept where there is no other.
void Guide::look_for_way(const PathRequest& request, double now, bool known) {
  if (now < search_again_) return;
  const GridSearch::State state = advance(search_, request, {});
  if (state == GridSearch::State::kSearching) return;
  if (state == GridSearch::State::kNone)
    search_again_ = knowledge_ == Knowledge::kWhole ? base::kInfinity : now + kSearchAgain;
  if (state == GridSearch::State::kFound) {
    begin_way(pulled_tight(search_.way(), request, {}));
    if (!is_open(way_, request)) way_.clear();  // what stands has changed since
  } else if (known) {
    closed_off_ = true;
  } else {
    begin_way({});
  }
  search_ = {};
}

// On a coarse grid, then on a fine one. There a place may be half a cell nearer than the middle of what can be passed.
GridSearch::State Guide::advance(GridSearch& search, const PathRequest& request,
                                 std::span<const GridQuery::Column> closed) const {
  const base::VehicleLimits& vehicle = request.vehicle;
  const double wanted = std::max(request.margin, settings_.guide_margin) + settings_.seed_clearance;
  GridQuery query{request.position,
                  request.target,
                  request.volume,
                  vehicle.radius,
                  settings_.guide_margin,
                  wanted,
                  vehicle.cruise_speed / vehicle.max_climb,
                  settings_.guide_cell,
                  {closed.begin(), closed.end()}};
  if (search.state() != GridSearch::State::kSearching) search.begin(query);
  int places = settings_.guide_places;
  if (knowledge_ == Knowledge::kWhole) places = closed.empty() ? std::numeric_limits<int>::max() : kOthers * places;
  GridSearch::State state = search.advance(standing_, places);
  if (state == GridSearch::State::kNone && search.query().cell == settings_.guide_cell) {
    query.cell *= kFineGrid;
    query.least = std::max(0.0, settings_.guide_margin - 0.5 * query.cell);
    search.begin(query);
    state = search.advance(standing_, places);
  }
  return state;
}

// Ways through another gate: the gates of those that are known are closed, one after the other; a wide one with several
// columns.
void Guide::look_for_others(const PathRequest& request) {
  if (!wants_others_) return;
  std::erase_if(others_, [&](std::vector<Vec3>& other) {
    other.front() = request.position;
    return !is_open(other, request);
  });
  if (tries_ >= kMostTries || others_.size() >= kMostOthers) return;
  const std::vector<Vec3> way = way_.empty() ? std::vector{request.position, request.target} : way_;
  if (other_search_.state() != GridSearch::State::kSearching) {
    const double enough = request.vehicle.radius + request.margin + kRoom;
    const auto gate = gate_of(closed_.empty() ? way : last_, enough);
    if (!gate) {
      tries_ = kMostTries;
      return;
    }
    closed_.push_back(*gate);
  }
  const GridSearch::State state = advance(other_search_, request, closed_);
  if (state == GridSearch::State::kSearching) return;
  ++tries_;
  if (state == GridSearch::State::kFound) {
    last_ = pulled_tight(other_search_.way(), request, closed_);
    const bool is_other =
        !are_alike(last_, way) &&
        std::none_of(others_.begin(), others_.end(), [&](const auto& other) { return are_alike(last_, other); });
    if (is_other && is_open(last_, request) && length_of(last_) <= kDetour * length_of(way)) others_.push_back(last_);
  } else {
    tries_ = kMostTries;
  }
  other_search_ = {};
}

// A column that fills the narrowest place ahead, which is within `enough` of something: what is waited for is near.
// None that is so near to the vehicle or the target that it would shut it in.
std::optional<GridQuery::Column> Guide::gate_of(std::span<const Vec3> way, double enough) const {
  std::optional<GridQuery::Column> gate;
  double narrowest = enough;
  for_each_place(way, kGateAhead, [&](const Vec3& place) {
    const double room = standing_.distance(place, narrowest);
    const double apart = room + kGateMore + settings_.guide_cell;
    const auto is_near = [&](const Vec3& end) { return (place - end).head<2>().norm() < apart; };
    if (room >= narrowest || is_near(way.front()) || is_near(way.back())) return;
    narrowest = room;
    gate = {place, room + kGateMore};
  });
  return gate;
}

// Nothing stands between places that are as far along both: one can be drawn over to the other.
bool Guide::are_alike(std::span<const Vec3> a, std::span<const Vec3> b) const {
  const double length_a = length_of(a);
  const double length_b = length_of(b);
  const int places = 1 + static_cast<int>(std::max(length_a, length_b) / kSample);
  for (int n = 1; n < places; ++n) {
    const double share = static_cast<double>(n) / places;
    if (!standing_.is_clear(place_along(a, share * length_a), place_along(b, share * length_b), 0.0)) return false;
  }
  return true;
}

// Places of a fine grid that are nearer to something than a way may lead by, half a cell aside at most to where there
// is most room.
void Guide::centre(std::vector<Vec3>& way, double enough) const {
  const double aside = 0.5 * kFineGrid * settings_.guide_cell;
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    const Vec3 place = way[i];
    double most = standing_.distance(place, enough);
    if (most >= enough) continue;
    for (int n = 0; n < 2 * kSides; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / kSides;
      const Vec3 other = place + (n < kSides ? 0.5 : 1.0) * aside * Vec3(std::cos(angle), std::sin(angle), 0.0);
      const double room = standing_.distance(other, enough);
      if (room <= most) continue;
      most = room;
      way[i] = other;
    }
  }
}

// From each place to the farthest in sight that is no nearer to anything than the places between them are, past what is
// closed.
std::vector<Vec3> Guide::pulled_tight(std::vector<Vec3> way, const PathRequest& request,
                                      std::span<const GridQuery::Column> closed) const {
  centre(way, request.vehicle.radius + settings_.guide_margin);
  const double wanted = request.vehicle.radius + first_clearance(request, settings_);
  std::vector<double> clearance;
  clearance.reserve(way.size());
  for (const Vec3& place : way) clearance.push_back(standing_.distance(place, wanted));
  std::vector<Vec3> tight{way.front()};
  for (std::size_t i = 0; i + 1 < way.size();) {
    std::size_t farthest = i + 1;
    double kept = std::min(clearance[i], clearance[i + 1]);
    int missed = 0;
    for (std::size_t j = i + 2; j < way.size() && missed < kMissed; ++j) {
      kept = std::min(kept, clearance[j]);
      const bool is_closed = std::any_of(closed.begin(), closed.end(), [&](const GridQuery::Column& column) {
        Vec3 a = way[i], b = way[j], center = column.center;
        a.z() = b.z() = center.z() = 0.0;
        return (nearest_on_line(center, a, b) - center).norm() < column.radius;
      });
      if (!is_closed && standing_.is_clear(way[i], way[j], kept)) {
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

// Between its middle and what stands, where a way counts as open.
double Guide::kept_open(const PathRequest& request) const {
  return request.vehicle.radius + std::max(0.0, settings_.guide_margin - kNarrower);
}

// The first leg begins where the vehicle is, wherever that is.
bool Guide::is_open(std::span<const Vec3> way, const PathRequest& request) const {
  const double kept = kept_open(request);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double least = i == 1 ? std::min(kept, standing_.distance(way[0], kept)) : kept;
    if (!standing_.is_clear(way[i - 1], way[i], least)) return false;
  }
  return true;
}

// The way to where one waits for it to be opened.
std::vector<Vec3> Guide::up_to_closed(const PathRequest& request) const {
  const double kept = kept_open(request);
  const double length = length_of(way_);
  double open = 0.0;
  // The vehicle may be nearer to something where it is.
  while (open < length && (open <= kept || standing_.distance(place_along(way_, open), kept) >= kept)) open += kSample;
  open = std::max(0.0, open - kBeforeClosed);
  std::vector<Vec3> way{way_.front()};
  double along = 0.0;
  for (std::size_t i = 1; i < way_.size(); ++i) {
    along += (way_[i] - way_[i - 1]).norm();
    if (along >= open) break;
    way.push_back(way_[i]);
  }
  way.push_back(place_along(way_, open));
  return way;
}

// Takes off the part of the way that the vehicle has gone; false where it has left it, or something stands between.
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
  return least <= kStrayed && standing_.is_clear(position, nearest, 0.0);
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

void Guide::slow_down(std::span<const Vec3> way, PathRequest& request) {
  const double radius = request.vehicle.radius;
  const double enough = radius + request.margin + kRoom;
  double narrowest = enough;
  for_each_place(way, kSlowDownAhead, [&](const Vec3& place) {
    if (standing_.distance(place, narrowest) < narrowest)
      narrowest = std::min(narrowest, room_at(place, enough, request.volume));
  });
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
std::size_t Guide::lead_ahead(std::span<const Vec3> way, PathRequest& request) const {
  const double kept = request.vehicle.radius + request.margin_beside_standing();
  const auto is_aside = [&](std::size_t leg, const Vec3& place, double most) {
    return std::any_of(way.begin() + 1, way.begin() + static_cast<std::ptrdiff_t>(leg), [&](const Vec3& corner) {
      return (corner - nearest_on_line(corner, request.position, place)).norm() > most;
    });
  };
  const auto is_near = [&](std::size_t leg, const Vec3& place) {
    return !is_aside(leg, place, kCutOff) || standing_.is_clear(request.position, place, kept);
  };
  std::size_t leg = way.size() - 1;
  request.target = way[leg];
  if (!is_aside(leg, way[leg], settings_.guide_deviation)) return leg;
  while (leg > 1 && !is_near(leg, way[leg])) --leg;
  if (leg + 1 == way.size()) return leg;
  // Somewhere on the next leg.
  double near = 0.0;
  double far = 1.0;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = 0.5 * (near + far);
    (is_near(leg + 1, way[leg] + middle * (way[leg + 1] - way[leg])) ? near : far) = middle;
  }
  request.target = way[leg] + near * (way[leg + 1] - way[leg]);
  return leg + 1;
}

}  // namespace jink::planner::horizon
