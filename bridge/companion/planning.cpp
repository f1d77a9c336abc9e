// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/planning.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace jink::bridge::companion {
namespace {

constexpr double kInset = 0.2;          // of the flight volume, at most, that paths keep away from its bounds
constexpr double kInsetMargin = 0.3;    // of the margin, likewise
constexpr double kInsetSigmas = 2.0;    // of the estimate's position, likewise
constexpr double kSinking = 0.7;        // m/s, of a landing: PX4's MPC_LAND_SPEED by default
constexpr double kRejoining = 1.0;      // m/s², at most, of the way back to a plan that is kept
constexpr double kFadeCurvature = 5.8;  // the largest of an OffsetForecast's, of an offset of 1 in a time of 1
constexpr double kCautious = 0.3;       // of the cruise speed, while what moves nearby is unexplained

// The path as it will be flown from where the vehicle is beside it, at another velocity: back to it smoothly.
planner::base::TimedPath rejoined(planner::base::TimedPath path, const Vec3& position, const Vec3& velocity) {
  const planner::base::TimedPoint first = path.front();
  setpoints::OffsetForecast beside{first.t, position - first.position, path.back().t - first.t,
                                   velocity - first.velocity};
  const double way = beside.offset.norm() + setpoints::OffsetForecast::kRateFade * beside.rate.norm();
  beside.fade = std::min(beside.fade, std::sqrt(kFadeCurvature * way / kRejoining));
  return beside.added_to(std::move(path));
}

// Free, verified, and never farther away than where it begins, which is there or nearly.
bool stays_at(const Vec3& place, const planner::verify::Plan& plan) {
  if (plan.status != planner::verify::PlanStatus::kReaches) return false;
  const double begins = (plan.path.front().position - place).norm();
  if (begins > Route::kPassing) return false;  // nobody asks yet, and the way down need not be looked at
  return std::all_of(plan.path.begin(), plan.path.end(), [&](const planner::base::TimedPoint& point) {
    return (point.position - place).norm() <= std::max(Route::kArrival, begins);
  });
}

// What is placed in the world's frame is off, for the vehicle, by what the vehicle's own place is.
void blur(PlanJob& job, double sigma) {
  const auto add = [sigma](auto& all) {
    for (auto& one : all) one.position_sigma = std::hypot(one.position_sigma, sigma);
  };
  add(job.tracks);
  add(job.forecasts);
  add(job.paths);
}

}  // namespace

std::optional<PlanResult> Planning::take(double now) {
  std::optional<PlanResult> result;
  try {
    if (!failed_) result = planner_.poll(now);
  } catch (const std::exception& failure) {
    failed(now, failure);
  }
  if (!result) return result;
  ++plans_;
  stays_at_target_ = stays_at(mission_.waypoints.back(), result->plan) &&
                     (mission_.arrival == config::Arrival::kHold || lands_free(*result));
  reporter_.plan(now, *result);
  if (!result->plan.path.empty()) newest_plan_ = result->job.begun;
  return result;
}

// From where the path ends straight down to the ground, as far ahead as plans look.
bool Planning::lands_free(const PlanResult& result) const {
  const planner::base::HorizonSettings& horizon = settings_.horizon;
  const prediction::Obstacles obstacles = obstacles_of(result.job, horizon);
  planner::base::TimedPath path = result.plan.path;
  const planner::base::TimedPoint above = path.back();
  const double sinking = std::max(0.1, (above.position.z() - mission_.ground) / kSinking);
  const Vec3 below = above.position - Vec3(0.0, 0.0, kSinking * sinking);
  path.push_back({above.t + sinking, below, Vec3::Zero(), Vec3::Zero()});
  path.push_back({std::max(horizon.time, above.t + sinking) + horizon.step, below, Vec3::Zero(), Vec3::Zero()});
  return planner::verify::verify({path,
                                  obstacles.tracks,
                                  0.0,
                                  mission_.vehicle.radius,
                                  {},
                                  horizon.acceleration_trust,
                                  horizon.time,
                                  obstacles.paths})
      .free();
}

void Planning::start(double now, Intake& intake, const MotionControl& motion, Route& route, bool visit) {
  const config::CompanionSettings& companion = settings_.companion;
  if (failed_ || planner_.busy()) return;
  // One may come a period early: a message that comes late is followed by one that does not.
  const double period = 1.0 / companion.largest_replan_rate_hz;
  const double due = new_tracks_ ? rate_kept_ - period : last_begun_.value_or(0.0) + 1.0 / companion.replan_rate_hz;
  if (last_begun_ && now + 1e-6 < due) return;
  rate_kept_ = std::max(rate_kept_, now) + period;
  PlanJob next = job(now, intake, motion, route, visit);
  // What came before the first plan waited for the flight to begin.
  if (new_tracks_ && last_begun_) next.newest_track = intake.table().newest_message();
  last_begun_ = now;
  new_tracks_ = false;
  try {
    planner_.start(std::move(next));
  } catch (const std::exception& failure) {
    failed(now, failure);
  }
}

PlanJob Planning::job(double now, Intake& intake, const MotionControl& motion, Route& route, bool visit) {
  const vehicle::VehicleState& state = intake.state();
  const setpoints::SetpointStream& stream = motion.stream();
  PlanJob job;
  job.number = plans_;
  job.begun = now;
  job.start = now + std::max(planner_.latency(), settings_.companion.commitment + state.link_delay);
  job.estimate_shift = intake.estimate_shift();
  job.tracks = intake.table().predict(job.start, settings_.horizon.acceleration_trust, &job.forecasts);
  if (const team::Team* team = intake.team()) job.paths = team->paths(now, job.start);
  const bool in_world = mission_.tracks.sensed_from == config::SensedFrom::kWorld;
  if (in_world) blur(job, state.position_sigma);

  const bool lost = motion.lost(state);
  const double share = motion.share(now);
  reporter_.reference_lost(now, lost, motion.error(state), share);
  // The plan begins where the vehicle will be, which is beside its reference.
  if (!lost) job.offset = motion.offset().forecast();
  const planner::base::TimedPoint reference = stream.reference(job.start);
  const planner::base::TimedPoint offset = job.offset.at(job.start);
  planner::horizon::PathRequest& request = job.request;
  request.position = lost ? base::position_at(state.motion, job.start) : Vec3(reference.position + offset.position);
  request.velocity = lost ? state.motion.value.velocity : Vec3(reference.velocity + offset.velocity);
  request.target = route.target();
  request.vehicle = mission_.vehicle;
  request.vehicle.max_acceleration *= share;
  request.vehicle.cruise_speed *= share;
  // Where something near moves in a way not understood yet, it is watched before it is passed.
  const bool cautious = intake.table().has_unexplained(mission_.vehicle.cruise_speed);
  reporter_.cautious(now, cautious);
  if (cautious) request.vehicle.cruise_speed *= kCautious;
  request.visit = visit;
  request.stuck = visit && route.stuck(now, state.motion.value.position);
  reporter_.stuck(now, request.stuck);
  // Gaps are as wide as they are: who has waited in vain for one does not ask for more than is asked for at the start.
  request.margin = request.stuck ? settings_.horizon.margin : motion.margin();
  if (in_world) request.margin = std::hypot(request.margin, state.position_sigma);
  double& largest_margin = reporter_.summary().largest_margin;
  largest_margin = std::max(largest_margin, request.margin);
  request.volume = volume(request.position, request.target, request.margin, state.position_sigma);
  request.track_acceleration = settings_.horizon.track_acceleration;
  request.acceleration_trust = settings_.horizon.acceleration_trust;
  if (!lost) {
    job.previous = stream.plan(job.start);
    // A plan to another waypoint is no plan to keep.
    if (!job.previous.empty() && (job.previous.back().position - request.target).norm() > 1e-6) job.previous.clear();
    if (!job.previous.empty()) job.previous = rejoined(std::move(job.previous), request.position, request.velocity);
    for (planner::base::TimedPoint& point : job.previous) point.t -= job.start;
  }
  return job;
}

planner::base::Box Planning::volume(const Vec3& start, const Vec3& target, double margin, double sigma) const {
  planner::base::Box box = flight_volume(mission_);
  // The vehicle is off its path at times, and its estimate is off. Not by all of the margin: in a narrow corridor the
  // room is needed to dodge.
  const Vec3 inset = (kInset * (box.max - box.min)).cwiseMin(kInsetMargin * margin + kInsetSigmas * sigma);
  box.min += inset;
  box.max -= inset;
  // Where the vehicle is already, a path may begin, and it may end where it is sent.
  box.min = box.min.cwiseMin(start).cwiseMin(target);
  box.max = box.max.cwiseMax(start).cwiseMax(target);
  return box;
}

void Planning::failed(double now, const std::exception& failure) {
  failed_ = true;
  failure_ = failure.what();
  reporter_.event(now, "planner_failed", *failure_);
}

}  // namespace jink::bridge::companion
