// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/companion.hpp"

#include <cmath>
#include <utility>

#include "bridge/base/text.hpp"
#include "bridge/supervisor/dangers.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kStall = 0.2;          // s between two turns of the loop, which is to be said
constexpr double kLongStall = 1.0;      // s: PX4's COM_OF_LOSS_T; whatever held that up, the autopilot has given us up
constexpr double kLow = 0.3;            // m, below min_height: less is noise
constexpr double kLookAgain = 0.2;      // s, at what a vehicle without plans is to avoid
constexpr double kLandingHeight = 1.0;  // m above the ground, down to which plans are flown
constexpr double kSettling = 1.0;       // s, after which a vehicle that sinks is at rest in HOLD
constexpr double kStays = 2.0;          // s, at one place, after which a vehicle with a camera looks around
constexpr double kRoundAbout = 4.5;     // s, for which it does: once round
constexpr double kAside = 10.0;         // m, to where it looks then
constexpr double kAsideAngle = 1.0;     // rad, to the left of where it looks
constexpr double kFlat = 0.05;          // m, likewise, between the ground and the local frame

supervisor::SupervisorSettings supervisor_settings(const config::CompanionSettings& s) {
  supervisor::SupervisorSettings result;
  result.stale_state = s.stale_state;
  result.stale_plan = s.stale_plan;
  return result;
}

// Why it may not take off there; empty: it may.
std::string outside_fence(const planner::base::Box& fence, const vehicle::VehicleState& state) {
  const Vec3& here = state.motion.value.position;
  const bool inside =
      here.x() >= fence.min.x() && here.x() <= fence.max.x() && here.y() >= fence.min.y() && here.y() <= fence.max.y();
  if (state.in_air || inside) return {};
  return "the vehicle stands outside the geofence, at east " + base::metres(here.x(), 1) + ", north " +
         base::metres(here.y(), 1);
}

}  // namespace

Companion::Companion(const config::Mission& mission, const config::Settings& settings, CompanionParts parts)
    : given_(mission),
      mission_(mission),
      settings_(settings),
      link_(parts.link),
      supervisor_(mission, supervisor_settings(settings.companion)),
      reporter_(mission_, settings.horizon.margin, std::move(parts.observers)),
      intake_(mission_, settings_, parts.link, parts.tracks, parts.intents),
      sight_(mission_, settings_, parts.clouds, parts.clock),
      motion_(mission_, settings_, parts.link, parts.clock, reporter_),
      planning_(mission_, settings_, parts.planner, sight_, reporter_),
      route_(mission_.waypoints, mission_.acceptance_radius) {}

bool Companion::step(double now) {
  const double dt = std::max(0.0, now - last_step_.value_or(now));
  notice_stall(now);
  take_state(now);
  take_tracks(now);
  take_clouds(now);
  intake_.listen_to_team(now);
  take_plan(now);
  const vehicle::VehicleState& state = intake_.state();
  if (const supervisor::Phase phase = supervisor_.phase();
      phase == supervisor::Phase::kFlying || phase == supervisor::Phase::kStopping) {
    if (!supervisor_.arrived()) reporter_.flown(now, state);
    motion_.observe(now, state);
  }
  const bool waited = supervisor_.phase() == supervisor::Phase::kWaiting;
  if (waited) place_mission();
  const supervisor::Decision decision = supervisor_.update(now, state, context(now));
  if (waited && supervisor_.phase() == supervisor::Phase::kEngaging) tell_beginning(now);
  reporter_.hazard_lasts(now, supervisor_.hazard());
  move(now, dt, decision);
  if (team::Team* team = intake_.team()) {
    const bool moves = decision.motion != supervisor::Decision::Motion::kNone;
    team->tell(now, state, moves ? &motion_.stream() : nullptr, planning_.plans());
  }
  if (decision.request) {
    reporter_.event(now, "request", std::string(vehicle::to_string(*decision.request)));
    link_.request(*decision.request);
  }
  reporter_.announce(now, supervisor_, intake_, motion_.margin(), motion_.offset().error().value_or(0.0));
  last_step_ = now;
  return !supervisor_.done();
}

// This process did not run for a while: what it followed is old, and after a second the autopilot's failsafe had the
// vehicle, which would give it back without a word.
void Companion::notice_stall(double now) {
  const double stall = now - last_step_.value_or(now);
  const supervisor::Phase phase = supervisor_.phase();
  if (stall <= kStall || (phase != supervisor::Phase::kClimbing && phase != supervisor::Phase::kFlying)) return;
  const std::string text = "this program did not run for " + base::seconds(stall);
  reporter_.stall(now, stall, text);
  if (stall > kLongStall) supervisor_.stop(now, supervisor::Outcome::kAborted, text, mission_.endings.planner);
}

// An estimate that jumps takes along what is to be followed: the vehicle did not move.
void Companion::take_state(double now) {
  const Intake::FrameChange& change = frame_change_ = intake_.take_state();
  reporter_.state(now, intake_.state());
  if (change.rebooted && supervisor_.phase() != supervisor::Phase::kWaiting) supervisor_.began_anew(now);
  if (!supervisor_.flight_began() || !change.shift) return;
  motion_.shift(*change.shift);
  planning_.shift(*change.shift);
  place_mission();
  reporter_.estimate_reset(now, *change.shift);
}

// Its heights are those of the local frame, in which the ground jumps with the estimate.
void Companion::place_mission() {
  const auto& origin = intake_.state().origin;
  mission_ = config::in_local_frame(given_, intake_.ground().value_or(0.0), origin ? origin->altitude_m : 0.0);
  raised_.clear();
  misplaced_ = outside_fence(mission_.geofence, intake_.state());
  for (Vec3& waypoint : mission_.waypoints) {
    const double height = waypoint.z() - mission_.ground;
    if (waypoint.z() >= mission_.min_height) continue;
    waypoint.z() = mission_.min_height;
    raised_.push_back("a waypoint at " + base::metres(height) + " is raised to min_height " +
                      base::metres(given_.min_height));
    if (given_.heights != config::Heights::kGround && height < 0.0) {
      misplaced_ = "a waypoint is " + base::metres(-height, 1) + " under the ground";
    } else if (waypoint.z() > mission_.geofence.max.z()) {
      misplaced_ = raised_.back() + ", above the geofence's top";
    }
  }
  route_.place(mission_.waypoints);
  motion_.place();
}

void Companion::tell_beginning(double now) {
  if (!intake_.ground()) {
    reporter_.event(now, "ground", "not known: the autopilot tells no home; heights count from its local origin");
  } else if (std::abs(mission_.ground) > kFlat) {
    reporter_.event(now, "ground", "at " + base::metres(mission_.ground) + " in the autopilot's local frame");
  }
  for (const std::string& text : raised_) reporter_.event(now, "raised", text);
  if (!supervisor::told(mission_, intake_.state().failsafe_parameters))
    reporter_.event(now, "parameters", "not told: what the autopilot does by itself is not known");
}

void Companion::take_tracks(double now) {
  if (!intake_.take_tracks(now)) return;
  planning_.tracks_came();
  reporter_.tracks(now, intake_.table().predict(now, settings_.horizon.acceleration_trust));
}

void Companion::take_clouds(double now) {
  sight_.take(now, intake_, frame_change_);
  if (mission_.cloud) reporter_.clouds(now, sight_.source_status(), sight_.unplaced(), sight_.counts());
}

// A plan for something else than what is flown now was begun before that changed.
void Companion::take_plan(double now) {
  std::optional<PlanResult> result = planning_.take(now, motion_, end());
  stop_without_planner(now);
  if (result && !result->plan.path.empty() && result->job.goal == goal_)
    motion_.follow(std::move(*result), intake_.estimate_shift());
}

// The vehicle is not left with the last setpoint because planning broke down: it brakes and gets HOLD.
void Companion::stop_without_planner(double now) {
  const auto failure = planning_.take_failure();
  // To land takes no plans any more.
  if (failure && supervisor_.phase() != supervisor::Phase::kLanding)
    supervisor_.stop(now, supervisor::Outcome::kAborted, "the planner failed: " + *failure, mission_.endings.planner);
}

supervisor::FlightContext Companion::context(double now) {
  const vehicle::VehicleState& state = intake_.state();
  supervisor::FlightContext context;
  context.newest_tracks = intake_.newest_tracks();
  context.silent_writer = intake_.silent_writer(now);
  context.blind = sight_.is_stale(now);
  context.newest_plan = planning_.newest_plan();
  context.lost_writers = intake_.lost_writers(now, supervisor_.flight_began());
  context.unsent_for = motion_.unsent_for(now);
  context.misplaced = misplaced_;
  if (!supervisor_.flight_began()) context.danger = supervisor::danger(mission_, state.failsafe_parameters);
  context.ground_known = intake_.ground() || given_.heights != config::Heights::kGround;
  context.low = state.motion.value.position.z() < mission_.min_height - kLow;
  const double height = state.motion.value.position.z() - mission_.ground;
  const double at_rest = height + kSettling * std::min(0.0, state.motion.value.velocity.z());
  context.nearly_down = at_rest < std::min(mission_.min_height - mission_.ground, kLandingHeight) - kLow &&
                        height > -kLandingHeight;  // else the ground is not where it was thought to be
  const bool may_take_off =
      supervisor_.phase() == supervisor::Phase::kWaiting || supervisor_.phase() == supervisor::Phase::kEngaging;
  context.overhead_free = !may_take_off || state.in_air || overhead_free(now);
  const Vec3& position = state.motion.value.position;
  const planner::base::Box& fence = mission_.geofence;
  was_inside_ = was_inside_ || (supervisor_.flight_began() && fence.contains(position));
  if (was_inside_) {
    const Vec3 beside = (fence.min - position).cwiseMax(position - fence.max);
    context.outside = std::max(beside.head<2>().maxCoeff(), fence.min.z() - position.z());
    context.above = position.z() - fence.max.z();
  }
  const std::optional<Intake::Approach> approach = intake_.approach(now);
  reporter_.aircraft(now, approach);
  context.aircraft_comes = approach.has_value();
  context.cannot_follow = motion_.cannot_follow(now);
  context.at_takeoff_height = motion_.at_takeoff_height(state);
  if (supervisor_.phase() == supervisor::Phase::kFlying && route_.pass(state.motion.value.position))
    reporter_.event(now, "waypoint",
                    std::to_string(route_.passed()) + " of " + std::to_string(route_.size()) + " passed");
  context.at_target = route_.arrived(state.motion.value.position, state.motion.value.velocity);
  context.at_end = Route::at(end(), state.motion.value.position, state.motion.value.velocity);
  context.leaves_end = !planning_.stays_at_end();
  context.at_rest = state.motion.value.velocity.norm() < Route::kArrivalSpeed;
  while (auto report = link_.next_report()) {
    reporter_.event(
        now, report->accepted ? "accepted" : "refused",
        std::string(vehicle::to_string(report->command)) + (report->detail.empty() ? "" : ": " + report->detail));
    context.report = std::move(report);
  }
  return context;
}

void Companion::move(double now, double dt, const supervisor::Decision& decision) {
  using Motion = supervisor::Decision::Motion;
  goal_.reset();
  if (decision.motion == Motion::kNone) return;
  const vehicle::VehicleState& state = intake_.state();
  // What is far from where it was to stop goes on from where it is.
  if (decision.motion != Motion::kBrake && motion_.stop_point() && motion_.lost(now, state)) stop(now);
  motion_.steer(now, decision.motion, supervisor_.phase(), state);
  if (decision.motion == Motion::kBrake) stop(now);
  goal_ = goal_kind(decision.motion);
  // On the ground the planner is to show that it plans; what is not flown to is not flown.
  const std::optional<Goal::Kind> planned = goal_ || state.in_air ? goal_ : Goal::Kind::kClimb;
  if (planned && planning_.due(now, *planned)) {
    planning_.start(now, intake_, motion_, goal(now, *planned));
    stop_without_planner(now);
  }
  const bool turns = supervisor_.phase() == supervisor::Phase::kFlying;
  if (!turns || sight_.is_stale(now)) goes_on_ = now;
  motion_.send(now, dt, state, turns ? std::optional(place_to_look_at(now)) : std::nullopt);
}

// Who sees ahead alone looks where he flies; where he stays, where he would go on at first, and then all round.
Vec3 Companion::place_to_look_at(double now) {
  const vehicle::VehicleState& state = intake_.state();
  if (!mission_.cloud || mission_.cloud->all_round) return route_.target();
  const Vec3& position = state.motion.value.position;
  if (const std::optional<Vec3> place = motion_.place_ahead(now, position)) {
    goes_on_ = now;
    return *place;
  }
  const double stays = now - goes_on_;
  if (stays < kStays || stays > kStays + kRoundAbout) return planning_.unseen().value_or(route_.target());
  return position + kAside * Vec3(std::cos(state.yaw + kAsideAngle), std::sin(state.yaw + kAsideAngle), 0.0);
}

// Plans to the stop's end take over from the stop, as long as they come; where they do not, it is looked at again.
void Companion::stop(double now) {
  const bool again = planning_.late(now) && now - stop_looked_at_ > kLookAgain;
  const auto start = motion_.stop_start(now, intake_.state(), again);
  if (!start) return;
  // Nothing is evaded from the ground.
  motion_.stop(intake_.state().in_air ? planning_.stop(now, intake_, motion_, *start)
                                      : motion_.stream().straight_stop(start->from));
  stop_looked_at_ = now;
}

// None: nothing is planned. What stops on the ground, or has not left it yet, stays there.
std::optional<Goal::Kind> Companion::goal_kind(supervisor::Decision::Motion motion) const {
  using Motion = supervisor::Decision::Motion;
  if (motion == Motion::kFollow) return Goal::Kind::kWaypoint;
  if (!intake_.state().in_air) return std::nullopt;
  if (motion == Motion::kBrake) return Goal::Kind::kStop;
  const bool climbs = motion == Motion::kTakeoffPoint && supervisor_.phase() == supervisor::Phase::kClimbing;
  return climbs ? std::optional(Goal::Kind::kClimb) : std::nullopt;
}

Goal Companion::goal(double now, Goal::Kind kind) {
  if (kind == Goal::Kind::kStop) {  // and back inside
    const planner::base::Box volume = flight_volume(mission_);
    return {.kind = kind, .target = motion_.stop_point()->cwiseMax(volume.min).cwiseMin(volume.max), .holds = true};
  }
  if (kind == Goal::Kind::kClimb)
    return {.kind = kind, .target = motion_.takeoff_point().value_or(climb_end(mission_, intake_.state()))};
  if (planning_.retreats()) route_.begin_anew();
  // Who has arrived stays.
  if (supervisor_.arrived())
    return {.kind = kind, .target = supervisor_.holds(now) ? route_.target() : end(), .holds = true};
  const bool stuck = route_.stuck(now, intake_.state().motion.value.position);
  return {.kind = kind, .target = route_.target(), .visit = true, .stuck = stuck};
}

// To land is to come down by plans as far as that goes: the autopilot's landing looks at no obstacles.
Vec3 Companion::end() const {
  Vec3 end = mission_.waypoints.back();
  if (mission_.arrival == config::Arrival::kLand)
    end.z() = std::min(end.z(), std::max(mission_.min_height, mission_.ground + kLandingHeight));
  return end;
}

// To be asked before a take-off.
bool Companion::overhead_free(double now) {
  if (now - overhead_looked_at_ > kLookAgain) {
    overhead_free_ = planning_.climbs_free(now, intake_);
    overhead_looked_at_ = now;
  }
  return overhead_free_;
}

FlightSummary Companion::summary() const {
  FlightSummary summary = reporter_.summary();
  summary.outcome = supervisor_.outcome();
  summary.reason = supervisor_.reason();
  summary.missing_peer = supervisor_.missing_peer();
  return summary;
}

}  // namespace jink::bridge::companion
