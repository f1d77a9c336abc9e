// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/retreat.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "planner/horizon/path_check.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kEvading = 0.5;      // of the acceleration for emergencies, that evasions count with
constexpr double kLookedAhead = 1.5;  // s, along what is flown,
constexpr double kEntry = 2.0;        // s, and the way on,
constexpr double kStay = 2.5;         // s, and to a refuge
constexpr double kMeeting = 2.0;      // s, before it might be met, from which on a mover is approached slowly,
constexpr double kMeetingNew = 1.0;   // s, and one that is new
constexpr double kCalm = 0.4;         // s, for which the way on is to be safe enough
constexpr double kBetter = 0.8;       // times the risk of what is flown, at most, of a refuge
constexpr double kAlike = 1e-3;       // probabilities that do not differ
constexpr std::array kDistances = {1.5, 3.0, 5.0};  // m, of refuges from where the vehicle can stop
constexpr int kRound = 8;                           // directions on the level, and above and below it

std::vector<Vec3> places_about(const Vec3& middle) {
  std::vector<Vec3> places{middle};
  for (const double distance : kDistances) {
    for (const double up : {0.0, 1.0, -1.0}) {
      for (int k = 0; k < kRound; ++k) {
        const double angle = k * 2.0 * std::numbers::pi / kRound;
        places.emplace_back(middle + distance * Vec3(std::cos(angle), std::sin(angle), up).normalized());
      }
      if (up != 0.0) places.emplace_back(middle + up * distance * Vec3::UnitZ());
    }
  }
  return places;
}

/// Whether a vehicle that flies towards it might meet it soon.
bool may_be_met(const prediction::Prediction& prediction, const Vec3& place, double speed) {
  const double soon = prediction.watched ? kMeeting : kMeetingNew;
  const Vec3 now = prediction.position(0.0);
  return (now - place).norm() < soon * speed + (prediction.position(soon) - now).norm();
}

}  // namespace

planner::base::TimedPath Retreat::motion_to(const planner::horizon::PathRequest& request, const Vec3& target) {
  planner::horizon::PathRequest alone = request;
  alone.standing = {};
  alone.target = target;
  problem_.prepare(alone);
  return problem_.unobstructed_motion();
}

void Retreat::look_for_refuge(const planner::horizon::PathRequest& request, double least,
                              std::span<const prediction::Prediction> predictions, const prediction::LawsByKind& laws) {
  const double stopping = request.velocity.norm() / (2.0 * problem_.settings().braking);  // s, at half the speed
  for (const Vec3& place : places_about(request.position + stopping * request.velocity)) {
    if (!request.volume.contains(place)) continue;
    const planner::base::TimedPath path = motion_to(request, place);
    const double bar = least - kAlike;
    const double risk = prediction::contact_risk(path, predictions, laws, request.vehicle.radius, kStay, {}, bar);
    if (risk >= bar || !planner::horizon::verify_until(path, request, kStay).free()) continue;
    least = risk;
    refuge_ = place;
    chosen_ = true;
    if (risk < kLess) return;
  }
}

std::optional<Vec3> Retreat::choose(double now, const planner::horizon::PathRequest& request,
                                    const planner::base::TimedPath& flown,
                                    std::vector<prediction::Prediction> predictions,
                                    const prediction::LawsByKind& laws) {
  std::erase_if(predictions, [&](const prediction::Prediction& prediction) {
    return 0.5 * prediction.acceleration_sigma * kSeen * kSeen < request.margin;
  });
  std::sort(
      predictions.begin(), predictions.end(), [&](const prediction::Prediction& a, const prediction::Prediction& b) {
        return (a.position(0.0) - request.position).squaredNorm() < (b.position(0.0) - request.position).squaredNorm();
      });
  cautious_ = std::any_of(predictions.begin(), predictions.end(), [&](const prediction::Prediction& prediction) {
    return may_be_met(prediction, request.position, request.vehicle.cruise_speed);
  });
  const double radius = request.vehicle.radius;
  const auto risk_of = [&](const planner::base::TimedPath& path, double until, double evasion) {
    return prediction::contact_risk(path, predictions, laws, radius, until,
                                    {planner::base::HorizonSettings::kReaction, evasion});
  };
  const double evasion = kEvading * problem_.settings().emergency_acceleration(request.vehicle.max_acceleration);
  risk_ = risk_of(flown, kLookedAhead, evasion);
  entry_risk_ = 0.0;
  if (!begun_) {
    begun_ = true;
    refuge_ = request.position;
    since_ = now;
    entry_risky_at_ = -planner::base::kInfinity;
  }
  if (!refuge_) {
    const bool again = std::exchange(risky_, risk_ > kMost);
    if (risk_ <= (again ? kMost : kFar) || now < goes_on_until_) return std::nullopt;
    since_ = entry_risky_at_ = now;
    look_for_refuge(request, kBetter * risk_of(flown, kStay, 0.0), predictions, laws);
    return refuge_;
  }
  const bool too_long = now - since_ > kLongest;
  entry_risk_ = risk_of(motion_to(request, request.target), kEntry, 0.0);
  if (entry_risk_ > kLess) entry_risky_at_ = now;
  if (now - entry_risky_at_ > kCalm || too_long) {
    if (too_long) goes_on_until_ = now + kLongest;
    refuge_.reset();
  } else if (risk_ > kMost) {
    const double least = chosen_ ? kBetter * risk_of(motion_to(request, *refuge_), kStay, 0.0) : 1.0 + kAlike;
    look_for_refuge(request, least, predictions, laws);
  }
  return refuge_;
}

}  // namespace jink::bridge::companion
