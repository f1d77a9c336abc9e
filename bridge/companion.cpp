// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace jink::bridge {
namespace {

constexpr double kArrival = 0.3;           // m, to the last waypoint
constexpr double kArrivalSpeed = 0.5;      // m/s
constexpr double kPassing = 0.7;           // m, to a waypoint on the way
constexpr double kTakeoffTolerance = 0.3;  // m
constexpr double kLostReference = 1.2;     // m from the reference, beyond which plans start at the vehicle instead
constexpr double kYawRate = 1.5;           // rad/s, at which the heading turns to the next waypoint
constexpr double kYawDistance = 1.0;       // m, a nearer waypoint does not turn it
constexpr double kForgetting = 5.0;        // s, in which a tracking error fades to a third
constexpr int kMostMessages = 64;          // of tracks, in a turn
constexpr double kStall = 0.2;             // s between two turns of the loop, which is to be said
constexpr double kLongStall = 1.0;    // s: PX4's COM_OF_LOSS_T; whatever held that up, the autopilot has given us up
constexpr double kMarginStep = 0.05;  // m, of a grown margin that is worth saying
constexpr double kSlack = 0.9;        // of a setpoint's period, after which the next may go

SupervisorSettings supervisor_settings(const config::CompanionSettings& s) {
  SupervisorSettings result;
  result.stale_state = s.stale_state;
  result.stale_plan = s.stale_plan;
  return result;
}

// Where a path may lead.
planner::Box flight_volume(const config::Mission& mission) {
  planner::Box box = mission.geofence;
  box.min.z() = std::max(box.min.z(), mission.min_height);
  return box;
}

std::string metres(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f m", value);
  return text.data();
}

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

}  // namespace

std::optional<Percentiles> percentiles(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    const auto n = static_cast<double>(values.size());
    return values[static_cast<std::size_t>(std::max(0.0, std::ceil(share * n) - 1.0))];
  };
  return Percentiles{rank(0.5), rank(0.99), values.back()};
}

Companion::Companion(const config::Mission& mission, const config::Settings& settings, CompanionParts parts)
    : mission_(mission),
      settings_(settings),
      parts_(std::move(parts)),
      supervisor_(mission, supervisor_settings(settings.companion)),
      table_(mission.tracks.coast_s),
      stream_({settings.companion.setpoint_lead, settings.companion.acceleration_lead, settings.companion.drag,
               settings.horizon.braking, mission.vehicle.max_acceleration, flight_volume(mission)}) {
  if (mission.intents && parts_.intents != nullptr) {
    team_.emplace(*parts_.intents, mission.vehicle.radius, mission.tracks.coast_s);
  }
}

void Companion::event(double now, std::string_view name, const std::string& detail) {
  for (FlightObserver* observer : parts_.observers) observer->on_event(now, name, detail);
}

bool Companion::step(double now) {
  if (last_step_ < 0.0) {
    for (Vec3& waypoint : mission_.waypoints) {
      if (waypoint.z() >= mission_.min_height) continue;
      event(now, "raised",
            "a waypoint at " + metres(waypoint.z()) + " is raised to min_height " + metres(mission_.min_height));
      waypoint.z() = mission_.min_height;
    }
  }
  notice_stall(now);
  take_state(now);
  take_tracks(now);
  if (team_) team_->listen(now, state_);
  take_plan(now);
  measure(now);
  const Decision decision = supervisor_.update(now, state_, picture(now));
  record_hazard(now);
  move(now, decision);
  if (team_) team_->tell(now, state_, decision.motion == Decision::Motion::kNone ? nullptr : &stream_, summary_.plans);
  if (decision.request) {
    event(now, "request", std::string(to_string(*decision.request)));
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
  const Phase phase = supervisor_.phase();
  if (stall <= kStall || (phase != Phase::kClimbing && phase != Phase::kFlying)) return;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "this program did not run for %.1f s", stall);
  event(now, "stalled", text.data());
  summary_.hazards.push_back({text.data(), now - stall, stall});
  if (stall > kLongStall) supervisor_.stop(now, Outcome::kAborted, text.data());
}

// An estimate that jumps takes along what is to be followed: the vehicle did not move.
void Companion::take_state(double now) {
  state_ = parts_.link.state();
  for (FlightObserver* observer : parts_.observers) observer->on_state(now, state_);
  if (state_.reboots != reboots_) {
    reboots_ = state_.reboots;
    if (supervisor_.flight_began() >= 0.0)
      supervisor_.stop(now, Outcome::kAborted, "the autopilot began anew: its local frame may be another");
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
        "the autopilot's position estimate jumped by " + metres(shift.norm()) + ": the plan is shifted along");
}

void Companion::take_tracks(double now) {
  TrackMessage message;
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
  if (result->plan.status == planner::PlanStatus::kBlocked) ++summary_.blocked_plans;
  for (FlightObserver* observer : parts_.observers) observer->on_plan(now, *result);
  if (result->plan.status != announced_status_) {
    announced_status_ = result->plan.status;
    event(now, "plan_status", std::string(planner::to_string(announced_status_)));
  }
  const bool wanted = supervisor_.phase() == Phase::kFlying && supervisor_.hazard().empty();
  const bool usable = !result->plan.path.empty();
  // A plan made under a hazard still ends it: the planner is alive.
  if (usable) newest_plan_ = result->job.begun;
  if (!usable || !wanted) return;
  planner::TimedPath path = std::move(result->plan.path);
  const Vec3 shift = estimate_shift_ - result->job.estimate_shift;  // of the time that the plan took
  for (planner::TimedPoint& point : path) {
    point.t += result->job.start;
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
  supervisor_.stop(now, Outcome::kAborted, reason);
}

planner::Box Companion::volume(const Vec3& start) const {
  planner::Box box = flight_volume(mission_);
  // Where the vehicle is already, a path may begin.
  box.min = box.min.cwiseMin(start);
  box.max = box.max.cwiseMax(start);
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
  job.tracks = table_.predict(job.start, settings_.horizon.acceleration_trust);
  if (team_) job.paths = team_->paths(now, job.start);

  const planner::TimedPoint reference = stream_.reference(job.start);
  const double error = (stream_.reference(state_.position_stamp).position - state_.position).norm();
  const bool lost = error > kLostReference;
  planner::PathRequest& request = job.request;
  request.position =
      lost ? Vec3(state_.position + (job.start - state_.position_stamp) * state_.velocity) : reference.position;
  request.velocity = lost ? state_.velocity : reference.velocity;
  if (lost && !announced_lost_)
    event(now, "reference_lost", "tracking error " + metres(error) + ": planning from the vehicle's position");
  announced_lost_ = lost;
  request.target = mission_.waypoints[waypoint_];
  request.vehicle = mission_.vehicle;
  request.volume = volume(request.position);
  request.margin = margin();
  summary_.largest_margin = std::max(summary_.largest_margin, request.margin);
  request.track_acceleration = settings_.horizon.track_acceleration;
  request.acceleration_trust = settings_.horizon.acceleration_trust;
  if (!lost) {
    job.previous = stream_.plan(job.start);
    for (planner::TimedPoint& point : job.previous) point.t -= job.start;
    // A plan to another waypoint is no plan to keep.
    if (!job.previous.empty() && (job.previous.back().position - request.target).norm() > 1e-6) job.previous.clear();
  }
  try {
    parts_.planner.start(std::move(job));
  } catch (const std::exception& failure) {
    planner_failed(now, failure);
  }
}

void Companion::move(double now, const Decision& decision) {
  using Motion = Decision::Motion;
  switch (decision.motion) {
    case Motion::kNone:
      return;
    case Motion::kTakeoffPoint:
      if (!stream_.active() || supervisor_.phase() == Phase::kEngaging) {
        takeoff_point_ = state_.position;
        takeoff_point_.z() = std::max(state_.position.z() + mission_.takeoff_height, mission_.min_height);
        takeoff_point_.z() = std::min(takeoff_point_.z(), std::max(mission_.geofence.max.z(), state_.position.z()));
        stream_.hold(takeoff_point_, now);
      } else if (stream_.braking()) {  // a hazard of the climb has passed
        stream_.hold(takeoff_point_, now);
      }
      break;
    case Motion::kStay:
      // Until OFFBOARD is confirmed the vehicle may be moving: it is to stop where it is then, not to come back.
      stream_.hold(state_.position, now);
      break;
    case Motion::kFollow:
      if (supervisor_.phase() == Phase::kFlying) start_plan(now);
      break;
    case Motion::kBrake:
      brake(now);
      // While a hazard lasts the planner goes on: when it has passed there is a plan to follow.
      if (supervisor_.phase() == Phase::kFlying) start_plan(now);
      break;
  }
  if (!stream_.active()) stream_.hold(state_.position, now);
  const bool due = now - last_sent_ + 1e-6 >= kSlack / settings_.companion.setpoint_rate_hz;
  if (!due && !new_plan_) return;
  last_sent_ = now;
  new_plan_ = false;
  const Setpoint setpoint = stream_.setpoint(now, heading(now));
  if (!parts_.link.send(setpoint)) {
    if (unsent_since_ < 0.0) {
      unsent_since_ = now;
      event(now, "send_failed", "setpoints cannot be sent");
    }
    return;
  }
  if (unsent_since_ >= 0.0) event(now, "send_works", "setpoints can be sent again");
  unsent_since_ = -1.0;
  for (FlightObserver* observer : parts_.observers) observer->on_setpoint(now, setpoint);
  const double lead = std::max(settings_.companion.setpoint_lead, settings_.companion.acceleration_lead);
  if (unsent_track_ && now + lead >= unsent_from_) {
    const double sent = parts_.clock != nullptr ? parts_.clock->now() : now;
    summary_.track_to_setpoint_ms.push_back(1e3 * (sent - *unsent_track_));
    unsent_track_.reset();
  }
}

// Along the reference; but from the vehicle where the reference says nothing of its motion, in take-off and where it
// was lost, and the vehicle's position is known.
void Companion::brake(double now) {
  if (stream_.braking()) return;
  const bool known = state_.position_stamp >= 0.0 && now - state_.position_stamp <= settings_.companion.stale_state;
  const bool says_nothing =
      !stream_.active() || stream_.plan(now).empty() ||
      (stream_.reference(state_.position_stamp).position - state_.position).norm() > kLostReference;
  if (!known || !says_nothing) {
    stream_.brake(now);
    return;
  }
  stream_.brake(now, planner::TimedPoint{now, state_.position, state_.velocity, Vec3::Zero()});
}

// Towards the waypoint, turning at a bounded rate from where the vehicle looks now.
double Companion::heading(double now) {
  if (!yaw_known_) {
    yaw_ = state_.yaw;
    yaw_known_ = true;
  }
  const Vec3 ahead = mission_.waypoints[waypoint_] - state_.position;
  if (supervisor_.phase() == Phase::kFlying && ahead.head<2>().norm() > kYawDistance) {
    const double most = kYawRate * std::max(0.0, now - last_step_);
    yaw_ = wrapped(yaw_ + std::clamp(wrapped(std::atan2(ahead.y(), ahead.x()) - yaw_), -most, most));
  }
  return yaw_;
}

// Whoever watched in this flight is to go on watching, or somebody else in its place.
int Companion::lost_writers(double now) {
  const int live = table_.live_writers(now, mission_.tracks.timeout_s);
  if (supervisor_.flight_began() >= 0.0) most_writers_ = std::max(most_writers_, live);
  return std::max(0, most_writers_ - live);
}

FlightPicture Companion::picture(double now) {
  FlightPicture picture;
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
          std::string(to_string(report->command)) + (report->detail.empty() ? "" : ": " + report->detail));
    picture.report = std::move(report);
  }
  return picture;
}

void Companion::next_waypoint(double now) {
  if (supervisor_.phase() != Phase::kFlying || waypoint_ + 1 >= mission_.waypoints.size()) return;
  if ((state_.position - mission_.waypoints[waypoint_]).norm() > kPassing) return;
  event(now, "waypoint",
        std::to_string(waypoint_ + 1) + " of " + std::to_string(mission_.waypoints.size()) + " passed");
  ++waypoint_;
}

void Companion::measure(double now) {
  const Phase phase = supervisor_.phase();
  if (phase != Phase::kFlying && phase != Phase::kStopping) return;
  if (flight_began_ < 0.0) {
    flight_began_ = now;
    Vec3 from = state_.position;
    for (const Vec3& waypoint : mission_.waypoints) {
      summary_.straight_length += (waypoint - from).norm();
      from = waypoint;
    }
  }
  summary_.flight_time = now - flight_began_;
  summary_.max_speed = std::max(summary_.max_speed, state_.velocity.norm());
  if (last_position_) summary_.path_length += (state_.position - *last_position_).norm();
  last_position_ = state_.position;
  if (stream_.active() && now - state_.position_stamp <= settings_.companion.stale_state) {
    stream_.learn(state_.position_stamp, state_.position, std::max(0.0, now - last_step_));
    const double error = (stream_.reference(state_.position_stamp).position - state_.position).norm();
    summary_.largest_tracking_error = std::max(summary_.largest_tracking_error, error);
    tracking_error_ = std::max(error, tracking_error_ * std::exp(-std::max(0.0, now - last_step_) / kForgetting));
  }
}

void Companion::record_hazard(double now) {
  const std::string& hazard = supervisor_.hazard();
  if (hazard.empty()) return;
  const bool goes_on =
      hazard == announced_hazard_ && !summary_.hazards.empty() && summary_.hazards.back().what == hazard;
  if (!goes_on) summary_.hazards.push_back({hazard, now, 0.0});
  summary_.hazards.back().duration = now - summary_.hazards.back().t;
}

// Events for what changed: nothing happens silently, and nothing is said fifty times a second.
void Companion::announce(double now) {
  if (team_) {
    for (const Team::News& news : team_->news(now)) event(now, news.name, news.detail);
  }
  if (supervisor_.phase() != announced_phase_) {
    announced_phase_ = supervisor_.phase();
    event(now, "phase",
          std::string(to_string(announced_phase_)) +
              (supervisor_.done() ? ": " + std::string(to_string(supervisor_.outcome())) + ", " + supervisor_.reason()
                                  : ""));
  }
  if (supervisor_.waiting_for() != announced_waiting_) {
    announced_waiting_ = supervisor_.waiting_for();
    if (!announced_waiting_.empty()) event(now, "waiting", announced_waiting_);
  }
  if (supervisor_.hazard() != announced_hazard_) {
    announced_hazard_ = supervisor_.hazard();
    event(now, announced_hazard_.empty() ? "hazard_over" : "hazard", announced_hazard_);
  }
  announce_vehicle(now);
  announce_tracks(now);
}

void Companion::announce_vehicle(double now) {
  if (state_.battery != announced_battery_) {
    announced_battery_ = state_.battery;
    event(now, "battery", std::string(to_string(announced_battery_)));
  }
  const double step = announced_margin_ ? 0.0 : kMarginStep;
  const bool grown = margin() > settings_.horizon.margin + step;
  if (grown != announced_margin_ && supervisor_.phase() == Phase::kFlying) {
    announced_margin_ = grown;
    event(now, "margin",
          grown ? "tracking is off by " + metres(tracking_error_) + ": plans keep so much more from obstacles"
                : "back to " + metres(settings_.horizon.margin));
  }
}

// What was refused or put right, at most once a second.
void Companion::announce_tracks(double now) {
  const TrackSourceStatus tracks = parts_.tracks.status();
  const TrackTableCounts& table = table_.counts();
  summary_.dropped_tracks = tracks.dropped_tracks + table.invalid_tracks + table.surplus_tracks;
  if (std::floor(now) == std::floor(last_step_)) return;
  if (tracks.bad_frames != announced_tracks_.bad_frames || tracks.dropped_tracks != announced_tracks_.dropped_tracks)
    event(now, "tracks_refused", tracks.last_refusal);
  announced_tracks_ = tracks;
  if (table.clock_offsets > 0 && announced_table_.clock_offsets == 0)
    event(now, "tracks_clock",
          "a track writer's stamps are not this computer's time: only changes of its delay are known");
  if (table.late_messages != announced_table_.late_messages)
    event(now, "tracks_late", std::to_string(table.late_messages) + " track messages came too late to be used");
  if (table.frozen_messages != announced_table_.frozen_messages)
    event(now, "tracks_frozen",
          std::to_string(table.frozen_messages) +
              " track messages left out: what should move had not moved since the one before");
  if (table.invalid_tracks != announced_table_.invalid_tracks)
    event(now, "tracks_refused", std::to_string(table.invalid_tracks) + " tracks that are none were left out");
  if (table.surplus_tracks != announced_table_.surplus_tracks)
    event(now, "tracks_refused",
          std::to_string(table.surplus_tracks) + " tracks beyond " + std::to_string(TrackTable::kMost) +
              " were left out");
  announced_table_ = table;
  if (table_.own_tracks() != announced_own_)
    event(now, "tracks_self", std::to_string(table_.own_tracks()) + " tracks are taken for this vehicle itself");
  announced_own_ = table_.own_tracks();
  if (tracks.malformed != announced_malformed_)
    event(now, "tracks_malformed", std::to_string(tracks.malformed) + " track messages could not be decoded");
  announced_malformed_ = tracks.malformed;
}

FlightSummary Companion::summary() const {
  FlightSummary summary = summary_;
  summary.outcome = supervisor_.outcome();
  summary.reason = supervisor_.reason();
  summary.missing_peer = supervisor_.missing_peer();
  return summary;
}

}  // namespace jink::bridge
