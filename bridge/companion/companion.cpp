// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/companion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "bridge/base/text.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kArrival = 0.3;           // m, to the last waypoint
constexpr double kArrivalSpeed = 0.5;      // m/s
constexpr double kPassing = 0.7;           // m, to a waypoint on the way
constexpr double kTakeoffTolerance = 0.3;  // m
constexpr double kInset = 0.05;            // of the flight volume, at most, that paths keep away from its bounds
constexpr double kInsetMargin = 0.3;       // of the margin, likewise
constexpr double kPatience = 4.0;          // s, without coming nearer to the waypoint
constexpr double kGain = 0.5;              // m, that count as nearer
constexpr double kCautious = 0.3;          // of the cruise speed, while what moves nearby is unexplained
constexpr int kMostMessages = 64;          // of tracks, in a turn
constexpr double kStall = 0.2;             // s between two turns of the loop, which is to be said
constexpr double kLongStall = 1.0;  // s: PX4's COM_OF_LOSS_T; whatever held that up, the autopilot has given us up

supervisor::SupervisorSettings supervisor_settings(const config::CompanionSettings& s) {
  supervisor::SupervisorSettings result;
  result.stale_state = s.stale_state;
  result.stale_plan = s.stale_plan;
  return result;
}

// Where a path may lead.
planner::base::Box flight_volume(const config::Mission& mission) {
  planner::base::Box box = mission.geofence;
  box.min.z() = std::max(box.min.z(), mission.min_height);
  return box;
}

}  // namespace

Companion::Companion(const config::Mission& mission, const config::Settings& settings, CompanionParts parts)
    : mission_(mission),
      settings_(settings),
      parts_(std::move(parts)),
      supervisor_(mission, supervisor_settings(settings.companion)),
      table_(mission.tracks.coast_s),
      stream_({settings.companion.setpoint_lead, settings.companion.committed_acceleration_lead(),
               settings.companion.drag, settings.companion.acceleration_damping, settings.horizon.braking,
               mission.vehicle.max_acceleration, flight_volume(mission), mission.vehicle.max_speed}) {
  if (mission.intents && parts_.intents != nullptr) {
    team_.emplace(*parts_.intents, mission.vehicle.radius, mission.tracks.coast_s);
  }
}

bool Companion::step(double now) {
  if (last_step_ < 0.0) {
    for (Vec3& waypoint : mission_.waypoints) {
      if (waypoint.z() >= mission_.min_height) continue;
      event(now, "raised",
            "a waypoint at " + base::metres(waypoint.z()) + " is raised to min_height " +
                base::metres(mission_.min_height));
      waypoint.z() = mission_.min_height;
    }
  }
  notice_stall(now);
  take_state(now);
  take_tracks(now);
  if (team_) team_->listen(now, state_);
  take_plan(now);
  measure(now);
  const supervisor::Decision decision = supervisor_.update(now, state_, picture(now));
  record_hazard(now);
  move(now, decision);
  if (team_)
    team_->tell(now, state_, decision.motion == supervisor::Decision::Motion::kNone ? nullptr : &stream_,
                summary_.plans);
  if (decision.request) {
    event(now, "request", std::string(vehicle::to_string(*decision.request)));
    parts_.link.request(*decision.request);
  }
  announce(now);
  last_step_ = now;
  return !supervisor_.done();
}

// This process did not run for a while: what it followed is old, and after a second the autopilot's failsafe had the
// vehicle, which would give it back without a word.
void Companion::notice_stall(double now) {
  const double stall = last_step_ < 0.0 ? 0.0 : now - last_step_;
  const supervisor::Phase phase = supervisor_.phase();
  if (stall <= kStall || (phase != supervisor::Phase::kClimbing && phase != supervisor::Phase::kFlying)) return;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "this program did not run for %.1f s", stall);
  event(now, "stalled", text.data());
  summary_.hazards.push_back({text.data(), now - stall, stall});
  if (stall > kLongStall) supervisor_.stop(now, supervisor::Outcome::kAborted, text.data());
}

// An estimate that jumps takes along what is to be followed: the vehicle did not move.
void Companion::take_state(double now) {
  state_ = parts_.link.state();
  for (FlightObserver* observer : parts_.observers) observer->on_state(now, state_);
  if (state_.reboots != reboots_) {
    reboots_ = state_.reboots;
    if (supervisor_.flight_began() >= 0.0)
      supervisor_.stop(now, supervisor::Outcome::kAborted, "the autopilot began anew: its local frame may be another");
  }
  if (state_.estimate_resets == estimate_resets_) return;
  estimate_resets_ = state_.estimate_resets;
  const Vec3 shift = state_.estimate_shift - estimate_shift_;
  estimate_shift_ = state_.estimate_shift;
  if (supervisor_.flight_began() < 0.0) return;
  ++summary_.estimate_resets;
  stream_.shift(shift);
  takeoff_point_ += shift;
  if (last_position_) *last_position_ += shift;
  event(now, "estimate_reset",
        "the autopilot's position estimate jumped by " + base::metres(shift.norm()) + ": the plan is shifted along");
}

void Companion::take_tracks(double now) {
  tracking::TrackMessage message;
  bool any = false;
  // A turn takes no more than so many: a writer at full speed must not keep the setpoints waiting.
  for (int taken = 0; taken < kMostMessages && parts_.tracks.poll(message); ++taken) {
    table_.ingest(message);
    any = true;
  }
  if (!any) return;
  new_tracks_ = true;
  if (now - state_.position_stamp <= settings_.companion.stale_state)
    table_.find_self(now, state_.position + (now - state_.position_stamp) * state_.velocity, state_.velocity,
                     mission_.vehicle.radius);
  const auto tracks = table_.predict(now, settings_.horizon.acceleration_trust);
  for (FlightObserver* observer : parts_.observers) observer->on_tracks(now, tracks);
}

void Companion::take_plan(double now) {
  std::optional<PlanResult> result;
  try {
    if (!planner_failed_) result = parts_.planner.poll(now);
  } catch (const std::exception& failure) {
    planner_failed(now, failure);
  }
  if (!result) return;
  ++summary_.plans;
  summary_.plan_ms.push_back(result->ms);
  if (result->missed) ++summary_.deadline_misses;
  if (result->plan.status == planner::verify::PlanStatus::kBlocked) ++summary_.blocked_plans;
  for (FlightObserver* observer : parts_.observers) observer->on_plan(now, *result);
  if (result->plan.status != announced_status_) {
    announced_status_ = result->plan.status;
    event(now, "plan_status", std::string(planner::verify::to_string(announced_status_)));
  }
  const bool wanted = supervisor_.phase() == supervisor::Phase::kFlying && supervisor_.hazard().empty();
  const bool usable = !result->plan.path.empty();
  // A plan made under a hazard still ends it: the planner is alive.
  if (usable) newest_plan_ = result->job.begun;
  if (!usable || !wanted) return;
  planner::base::TimedPath path = std::move(result->plan.path);
  // Of the time that the plan took.
  const Vec3 shift = estimate_shift_ - result->job.estimate_shift;
  const double waited = stream_.waited() - result->job.waited;
  for (planner::base::TimedPoint& point : path) {
    point.t += result->job.start + waited;
    point.position += shift;
  }
  stream_.follow(std::move(path));
  new_plan_ = true;
  if (result->job.newest_track >= 0.0) {
    unsent_track_ = result->job.newest_track;
    unsent_from_ = result->job.start;
  }
}

// The vehicle is not left with the last setpoint because planning broke down: it brakes and gets HOLD.
void Companion::planner_failed(double now, const std::exception& failure) {
  planner_failed_ = true;
  const std::string reason = std::string("the planner failed: ") + failure.what();
  event(now, "planner_failed", failure.what());
  supervisor_.stop(now, supervisor::Outcome::kAborted, reason);
}

planner::base::Box Companion::volume(const Vec3& start, const Vec3& target) const {
  planner::base::Box box = flight_volume(mission_);
  // The vehicle is off its path at times. Not by all of the margin: in a narrow corridor the room is needed to dodge.
  const Vec3 inset = (kInset * (box.max - box.min)).cwiseMin(kInsetMargin * margin());
  box.min += inset;
  box.max -= inset;
  // Where the vehicle is already, a path may begin, and it may end where it is sent.
  box.min = box.min.cwiseMin(start).cwiseMin(target);
  box.max = box.max.cwiseMax(start).cwiseMax(target);
  return box;
}

// The margin of the settings, or what tracking has been off by of late where that is more.
double Companion::margin() const {
  const double least = settings_.horizon.margin;
  return std::clamp(tracking_error_, least, std::max(least, settings_.companion.margin_limit));
}

void Companion::start_plan(double now) {
  const config::CompanionSettings& companion = settings_.companion;
  if (planner_failed_ || parts_.planner.busy()) return;
  const double period = 1.0 / (new_tracks_ ? companion.largest_replan_rate_hz : companion.replan_rate_hz);
  if (last_plan_begun_ >= 0.0 && now - last_plan_begun_ + 1e-6 < period) return;
  last_plan_begun_ = now;
  new_tracks_ = false;
  PlanJob job;
  job.number = summary_.plans;
  job.begun = now;
  job.start = now + std::max(parts_.planner.latency(), companion.commitment);
  job.newest_track = table_.newest_message();
  job.estimate_shift = estimate_shift_;
  job.waited = stream_.waited();
  job.tracks = table_.predict(job.start, settings_.horizon.acceleration_trust, &job.forecasts);
  if (team_) job.paths = team_->paths(now, job.start);

  const planner::base::TimedPoint reference = stream_.reference(job.start);
  const double error = (stream_.reference(state_.position_stamp).position - state_.position).norm();
  const bool lost = error > kLostReference;
  planner::horizon::PathRequest& request = job.request;
  request.position =
      lost ? Vec3(state_.position + (job.start - state_.position_stamp) * state_.velocity) : reference.position;
  request.velocity = lost ? state_.velocity : reference.velocity;
  if (lost && !announced_lost_)
    event(now, "reference_lost", "tracking error " + base::metres(error) + ": planning from the vehicle's position");
  announced_lost_ = lost;
  request.target = mission_.waypoints[waypoint_];
  request.vehicle = mission_.vehicle;
  // Where something near moves in a way not understood yet, it is watched before it is passed.
  const bool cautious = table_.has_unexplained(mission_.vehicle.cruise_speed);
  if (cautious) request.vehicle.cruise_speed *= kCautious;
  if (cautious != announced_cautious_)
    event(now, "caution", cautious ? "a new track nearby moves in a way not understood yet: slower" : "over");
  announced_cautious_ = cautious;
  request.stuck = stuck(now);
  request.volume = volume(request.position, request.target);
  request.margin = margin();
  summary_.largest_margin = std::max(summary_.largest_margin, request.margin);
  request.track_acceleration = settings_.horizon.track_acceleration;
  request.acceleration_trust = settings_.horizon.acceleration_trust;
  if (!lost) {
    job.previous = stream_.plan(job.start);
    for (planner::base::TimedPoint& point : job.previous) point.t -= job.start;
    // A plan to another waypoint is no plan to keep.
    if (!job.previous.empty() && (job.previous.back().position - request.target).norm() > 1e-6) job.previous.clear();
  }
  try {
    parts_.planner.start(std::move(job));
  } catch (const std::exception& failure) {
    planner_failed(now, failure);
  }
}

// Whether the vehicle has long come no nearer to where it goes.
bool Companion::stuck(double now) {
  const double left = (mission_.waypoints[waypoint_] - state_.position).norm();
  if (left < nearest_ - kGain) {
    nearest_ = left;
    gained_at_ = now;
  }
  const bool stuck = now - gained_at_ > kPatience;
  if (stuck != announced_stuck_)
    event(now, "stuck", stuck ? "no nearer to the target for 4 s: looking for a way round" : "over");
  announced_stuck_ = stuck;
  return stuck;
}

// Whoever watched in this flight is to go on watching, or somebody else in its place.
int Companion::lost_writers(double now) {
  const int live = table_.live_writers(now, mission_.tracks.timeout_s);
  if (supervisor_.flight_began() >= 0.0) most_writers_ = std::max(most_writers_, live);
  return std::max(0, most_writers_ - live);
}

supervisor::FlightPicture Companion::picture(double now) {
  supervisor::FlightPicture picture;
  picture.newest_tracks = table_.newest_message();
  picture.newest_plan = newest_plan_;
  picture.lost_writers = lost_writers(now);
  picture.unsent_for = unsent_since_ < 0.0 ? 0.0 : now - unsent_since_;
  picture.at_takeoff_height = takeoff_point_.z() - state_.position.z() < kTakeoffTolerance;
  next_waypoint(now);
  picture.at_target = waypoint_ + 1 == mission_.waypoints.size() &&
                      (state_.position - mission_.waypoints.back()).norm() < kArrival &&
                      state_.velocity.norm() < kArrivalSpeed;
  picture.at_rest = state_.velocity.norm() < kArrivalSpeed;
  while (auto report = parts_.link.next_report()) {
    event(now, report->accepted ? "accepted" : "refused",
          std::string(vehicle::to_string(report->command)) + (report->detail.empty() ? "" : ": " + report->detail));
    picture.report = std::move(report);
  }
  return picture;
}

void Companion::next_waypoint(double now) {
  if (supervisor_.phase() != supervisor::Phase::kFlying || waypoint_ + 1 >= mission_.waypoints.size()) return;
  if ((state_.position - mission_.waypoints[waypoint_]).norm() > kPassing) return;
  event(now, "waypoint",
        std::to_string(waypoint_ + 1) + " of " + std::to_string(mission_.waypoints.size()) + " passed");
  ++waypoint_;
  nearest_ = planner::base::kInfinity;
}

}  // namespace jink::bridge::companion
