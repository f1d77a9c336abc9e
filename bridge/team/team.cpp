// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/team/team.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/base/portable_math.hpp"

namespace jink::bridge::team {
namespace {

using planner::base::TimedPath;
using planner::base::TimedPoint;

constexpr double kDoubt = 0.03;        // m/s, how a path is doubted from the start: it may be planned anew
constexpr double kSilentDoubt = 0.4;   // m/s, and while nothing more is heard
constexpr double kAlive = 0.5;         // s, since its last message, within which a vehicle is surely there
constexpr double kUnknownDelay = 0.1;  // s, that a message may have taken where only changes of its delay are known
constexpr double kLeastMargin = 0.1;   // m
constexpr double kSigmas = 2.0;        // standard deviations of a vehicle's position that count as its margin
constexpr double kUnledMargin = 0.5;   // m, of a vehicle that follows nothing of ours
constexpr double kMostMargin = 2.0;    // m
constexpr double kForget = 3.0;        // s, in which a deviation fades
constexpr double kOnTheWay = 0.7;      // m from a place to hold, beyond which the way there is told
constexpr double kWaySpeed = 1.0;      // m/s, taken for it: take-off is about that fast
constexpr double kLeastStep = 0.01;    // s, between points told
constexpr double kDrift = 1.0;         // s

std::string name_of(std::uint64_t vehicle) {
  return "vehicle " + std::to_string(system_of(vehicle));
}

/// The largest speed on a path.
double fastest(const TimedPath& path) {
  planner::geometry::KnownPath known;
  known.points = path;
  return known.fastest();
}

/// The path up to `until`, without points that follow another at once, as they do where one plan takes over from
/// another.
TimedPath shortened(const TimedPath& path, double until) {
  TimedPath result;
  for (const TimedPoint& point : path) {
    if (result.empty() || (point.t <= until && point.t - result.back().t >= kLeastStep)) result.push_back(point);
  }
  const TimedPoint end = planner::base::sample(path, std::min(until, path.back().t));
  if (result.size() > 1 && end.t - result.back().t < kLeastStep) result.pop_back();
  if (end.t - result.back().t >= kLeastStep) result.push_back(end);
  return result;
}

/// The message's path in our frame and clock.
base::Stamped<TimedPath, base::Frame::kLocal> placed(const IntentMessage& message, double stamp,
                                                     const frames::Geodetic& ours) {
  base::Stamped<TimedPath, base::Frame::kLocal> path{message.intent.path, stamp, message.received};
  for (TimedPoint& point : path.value) point.t += stamp;
  const Eigen::Isometry3d to_ours = frames::between(*message.intent.origin, ours);
  for (TimedPoint& point : path.value) point.position = to_ours * point.position;
  return path;
}

}  // namespace

Team::Team(IntentTransport& transport, double radius, double coast_s)
    : transport_(transport), radius_(radius), coast_s_(coast_s) {}

void Team::listen(double now, const vehicle::VehicleState& own) {
  own_vehicle_ = vehicle_id(own.system_id, transport_.identity());
  IntentMessage message;
  while (transport_.poll(message)) {
    if (message.writer != transport_.identity()) take(message, own);
  }
  forget_the_silent(now);
  find_duplicate_systems(now);
}

void Team::take(const IntentMessage& message, const vehicle::VehicleState& own) {
  const auto known = peers_.find(message.writer);
  if (known == peers_.end() && peers_.size() >= kMostVehicles) {
    ++crowded_;
    return;
  }
  Peer& peer = known == peers_.end() ? peers_[message.writer] : known->second;
  peer.vehicle = message.intent.vehicle;
  peer.seen = message.received;
  const std::optional<double> told = peer.clock.stamp(message);
  if (peer.clock.off() && !std::exchange(peer.announced_clock, true)) {
    notices_.push_back(
        {"team_clock",
         name_of(peer.vehicle) + ": its stamps are not this computer's time; only changes of its delay are known"});
  }
  if (!told) {
    ++late_;
    return;
  }
  if (!message.intent.origin || !own.origin) {
    ++unplaced_;
    unplaced_why_ = name_of(peer.vehicle) + ": where its path is cannot be told, " +
                    (own.origin ? "it does not know its origin" : "this vehicle's origin is not known");
    return;
  }
  if (peer.path && *told < peer.path->stamp) return;  // overtaken on the way
  if (!peer.path) notices_.push_back({"team_vehicle", name_of(peer.vehicle) + " tells where it will be"});
  peer.path = placed(message, *told, *own.origin);
  peer.radius = message.intent.radius;
  peer.margin = message.intent.margin;
  if (peer.clock.off()) peer.margin += kUnknownDelay * fastest(peer.path->value);
}

void Team::forget_the_silent(double now) {
  const double limit = kFresh + coast_s_;
  for (auto& [writer, peer] : peers_) {
    const bool silent = peer.path && now - peer.path->received > limit;
    if (silent && !peer.announced_silent) {
      notices_.push_back({"team_lost", name_of(peer.vehicle) + ": nothing usable heard for " + std::to_string(limit) +
                                           " s, it is taken to hang where its path ended"});
    }
    peer.announced_silent = silent;
    if (silent && now - peer.path->received > kForgetPeer) peer.path.reset();
  }
  // Who began anew speaks for itself again.
  const auto replaced = [&](const Peer& old) {
    return old.announced_silent && std::any_of(peers_.begin(), peers_.end(), [&](const auto& other) {
             return !other.second.announced_silent && system_of(other.second.vehicle) == system_of(old.vehicle);
           });
  };
  std::erase_if(peers_,
                [&](const auto& item) { return now - item.second.seen > kForgetPeer || replaced(item.second); });
}

void Team::find_duplicate_systems(double now) {
  std::map<std::uint32_t, int> bearers;
  ++bearers[system_of(own_vehicle_)];
  for (const auto& [writer, peer] : peers_) {
    if (now - peer.seen <= kAlive) ++bearers[system_of(peer.vehicle)];
  }
  for (const auto& [system, count] : bearers) {
    if (system == 0 || count < 2) {
      duplicate_systems_.erase(system);
    } else if (duplicate_systems_.insert(system).second) {
      notices_.push_back({"team_same_id", std::to_string(count) + " vehicles of the team are MAVLink system " +
                                              std::to_string(system) +
                                              (system == system_of(own_vehicle_) ? ", as this one" : "") +
                                              ": each is avoided, but each needs a MAV_SYS_ID of its own"});
    }
  }
}

std::vector<planner::geometry::KnownPath> Team::paths(double now, double start) const {
  std::vector<planner::geometry::KnownPath> paths;
  for (const auto& [writer, peer] : peers_) {
    if (!peer.path) continue;
    planner::geometry::KnownPath path;
    path.id = peer.vehicle;
    path.points = peer.path->value;
    path.offset = start;
    path.radius = peer.radius;
    path.margin = peer.margin;
    path.position_sigma = kSilentDoubt * std::max(0.0, now - peer.path->received - kFresh);
    path.velocity_sigma = kDoubt;
    path.age = std::max(0.0, peer.path->age(start));
    if (own_vehicle_ < peer.vehicle && !peer.announced_silent) path.until = kRightOfWay;  // who is silent gives no way
    paths.push_back(std::move(path));
  }
  return paths;
}

void Team::tell(double now, const vehicle::VehicleState& own, const setpoints::SetpointStream* followed,
                std::uint64_t plans) {
  if (!own.motion.heard()) return;
  if (followed != nullptr && !followed->active()) followed = nullptr;
  measure_deviation(now, own, followed);
  if (plans == told_plans_ && now - last_told_ + 1e-6 < kPeriod) return;
  last_told_ = now;
  told_plans_ = plans;
  Intent intent;
  intent.vehicle = own_vehicle_;
  intent.origin = own.origin;
  intent.radius = radius_;
  // Its path is one of its estimate, which is off in the frame that is shared.
  const double off = planner::base::hypotenuse(deviation_, kSigmas * own.position_sigma);
  intent.margin = std::clamp(off, followed == nullptr ? kUnledMargin : kLeastMargin, kMostMargin);
  intent.path = shortened(committed(now, own, followed), now + kTold);
  for (TimedPoint& point : intent.path) point.t -= now;
  // What is not finite is not for others.
  if (refusal(intent) != nullptr || !transport_.publish(intent)) ++untold_;
}

TimedPath Team::committed(double now, const vehicle::VehicleState& own,
                          const setpoints::SetpointStream* followed) const {
  const TimedPoint here{now, own.motion.value.position, own.motion.value.velocity, Vec3::Zero()};
  if (followed == nullptr) {
    if (!own.in_air) return {here};
    return {here,
            {now + kDrift, own.motion.value.position + kDrift * own.motion.value.velocity, Vec3::Zero(), Vec3::Zero()}};
  }
  // In take-off the place to hold is a step away.
  TimedPath path = followed->ahead(now);
  const double way = (path.front().position - own.motion.value.position).norm();
  if (path.size() > 1 || way <= kOnTheWay) return path;
  return {here, {now + way / kWaySpeed, path.front().position, Vec3::Zero(), Vec3::Zero()}};
}

void Team::measure_deviation(double now, const vehicle::VehicleState& own, const setpoints::SetpointStream* followed) {
  const double error =
      followed == nullptr ? 0.0 : (followed->reference(own.motion.stamp).position - own.motion.value.position).norm();
  const double faded = deviation_ * std::exp((deviation_at_ - now) / kForget);
  deviation_ = std::max(error, faded);
  deviation_at_ = now;
}

std::vector<Team::Notice> Team::take_notices(double now) {
  if (std::floor(now) != std::floor(last_news_)) {
    const auto recurs = [&](std::uint64_t count, std::uint64_t& said, const char* name, const std::string& detail) {
      if (count != std::exchange(said, count))
        notices_.push_back({name, detail + " (" + std::to_string(count) + " so far)"});
    };
    const IntentStatus status = transport_.status();
    recurs(unplaced_, said_unplaced_, "team_unplaced", unplaced_why_);
    recurs(late_, said_late_, "team_late", "intents came too late to be used");
    recurs(crowded_, said_crowded_, "team_crowded",
           "more than " + std::to_string(kMostVehicles) + " vehicles: the paths of the last are not regarded");
    recurs(untold_, said_untold_, "team_untold", "where this vehicle will be could not be told");
    recurs(status.refused, said_refused_, "team_refused", status.last_refusal);
  }
  last_news_ = now;
  return std::exchange(notices_, {});
}

std::size_t Team::vehicles() const {
  return static_cast<std::size_t>(
      std::count_if(peers_.begin(), peers_.end(), [](const auto& item) { return item.second.path.has_value(); }));
}

}  // namespace jink::bridge::team
