// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/planning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "bridge/companion/route.hpp"
#include "config/solids.hpp"
#include "planner/base/portable_math.hpp"
#include "planner/horizon/path_check.hpp"
#include "planner/horizon/reach.hpp"

namespace jink::bridge::companion {
namespace {

constexpr double kInset = 0.2;               // of the flight volume, at most, that paths keep away from its bounds
constexpr double kInsetMargin = 0.3;         // of the margin, likewise
constexpr double kInsetSigmas = 2.0;         // of the estimate's position, likewise
constexpr double kClearSigmas = 1.5;         // of the estimate's position: kept on top of that where it can be
constexpr double kSinking = 0.7;             // m/s, of a landing: PX4's MPC_LAND_SPEED by default
constexpr double kRejoining = 1.0;           // m/s², at most, of the way back to a plan that is kept
constexpr double kRejoiningStep = 0.1;       // s
constexpr double kFadeCurvature = 5.8;       // the largest of an OffsetForecast's, of an offset of 1 in a time of 1
constexpr double kStopPeriod = 0.5;          // s, between the times at which the plan might be left for a stop
constexpr double kLatestStop = 2.0;          // s, the last of them
constexpr std::array kLiftOff = {1.0, 3.0};  // s, after which a vehicle that is armed leaves the ground
constexpr double kClimbing = 1.0;            // m/s, of a take-off
constexpr double kCautious = 0.3;            // of the cruise speed, while what moves nearby is unexplained
constexpr double kSeeing = 0.2;              // s, from what a sensor sees to a map of it
constexpr double kInView = 0.82;             // cosine of the angle from where the vehicle looks, 35 degrees
constexpr double kBeside = 0.5;              // m, no farther off no direction tells where to look
constexpr double kFarther = 1.0;             // s, along a plan from where it was not seen, to look there
constexpr double kLeavingStep = 0.1;         // s, between the times at which such a plan might be left for a stop
constexpr double kWaits = 0.5;               // m, that such a stop is from where the vehicle is, so that it waits
constexpr double kSlowest = 0.3;             // m/s, at which a vehicle flies that does not see where to

// The path as it will be flown from where the vehicle is beside it, at another velocity: back to it smoothly.
planner::base::TimedPath rejoined(planner::base::TimedPath path, const Vec3& position, const Vec3& velocity) {
  const planner::base::TimedPoint first = path.front();
  setpoints::OffsetForecast beside{first.t, position - first.position, setpoints::OffsetForecast::kFade,
                                   velocity - first.velocity};
  const double way = beside.offset.norm() + setpoints::OffsetForecast::kRateFade * beside.rate.norm();
  beside.fade = std::min(beside.fade, std::sqrt(kFadeCurvature * way / kRejoining));
  // What ends before that stays at its end meanwhile: a metre is not made good in the last tenth of a second.
  planner::base::TimedPoint last{path.back().t, path.back().position, Vec3::Zero(), Vec3::Zero()};
  while (last.t < first.t + beside.fade) {
    last.t += kRejoiningStep;
    path.push_back(last);
  }
  return beside.added_to(std::move(path));
}

// Along a path up to a time, and to a stop straight on.
planner::base::TimedPath left_at(const planner::base::TimedPath& path, double t,
                                 const setpoints::SetpointStream& stream) {
  planner::base::TimedPath left;
  std::copy_if(path.begin(), path.end(), std::back_inserter(left),
               [t](const planner::base::TimedPoint& point) { return point.t < t; });
  const planner::base::TimedPath stop = stream.straight_stop(planner::base::sample(path, t));
  left.insert(left.end(), stop.begin(), stop.end());
  return left;
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
template <typename All>
void blur(All& all, double sigma) {
  for (auto& one : all) one.position_sigma = planner::base::hypotenuse(one.position_sigma, sigma);
}

}  // namespace

std::optional<PlanResult> Planning::take(double now, const MotionControl& motion, const Vec3& end) {
  std::optional<PlanResult> result;
  try {
    if (!failed_) result = planner_.poll(now);
  } catch (const std::exception& failure) {
    failed(now, failure);
  }
  if (!result) return result;
  ++plans_;
  stay_in_seen(now, motion, *result);
  stays_at_end_ = stays_at(end, result->plan) && (mission_.arrival == config::Arrival::kHold || lands_free(*result));
  reporter_.plan(now, *result);
  if (result->plan.path.empty()) return result;
  newest_plan_ = result->job.begun;
  planned_for_ = result->job.target;
  planned_to_ = result->plan.path.back().position;
  return result;
}

void Planning::stay_in_seen(double now, const MotionControl& motion, PlanResult& result) {
  planner::base::TimedPath& path = result.plan.path;
  const bool visits = result.job.goal == Goal::Kind::kWaypoint && result.job.visit && !path.empty();
  const double leaves = visits ? sight_.leaves_seen(path) : planner::base::kInfinity;
  if (leaves < planner::base::kInfinity) {
    unseen_ = planner::base::sample(path, leaves + kFarther).position;
    std::vector<planner::base::TimedPath> stops;
    for (double at = leaves; at > 0.0; at -= kLeavingStep) {
      planner::base::TimedPath stop = left_at(path, at, motion.stream());
      if (is_seen(stop)) stops.push_back(std::move(stop));
    }
    stops.push_back(motion.stream().straight_stop(path.front()));
    const prediction::Obstacles obstacles = obstacles_of(result.job, settings_.horizon);
    set_obstacles(result.job, obstacles);
    planner::horizon::Stop stop = contingency_.choose(
        result.job.request, stops, [this](const planner::base::TimedPath& other) { return is_seen(other); });
    forget_obstacles(result.job);
    path = std::move(stop.path);
    result.plan.verification = stop.verification;
    result.plan.status =
        stop.verification.free() ? planner::verify::PlanStatus::kProgresses : planner::verify::PlanStatus::kBlocked;
  }
  // A stop that was flown before may be kept.
  const bool stays = visits && (path.back().position - path.front().position).norm() < kWaits;
  if (leaves == planner::base::kInfinity && !stays) unseen_.reset();
  reporter_.unseen(now, unseen_ && stays);
}

bool Planning::is_seen(const planner::base::TimedPath& path) const {
  return sight_.leaves_seen(path) == planner::base::kInfinity;
}

// From where the path ends straight down to the ground, as far ahead as plans look: from now on, since who stays there
// is there already and sinks at once, however long the path is.
bool Planning::lands_free(const PlanResult& result) const {
  const planner::base::HorizonSettings& horizon = settings_.horizon;
  const prediction::Obstacles obstacles = obstacles_of(result.job, horizon);
  const Vec3& above = result.plan.path.back().position;
  const double sinking = std::max(0.1, (above.z() - mission_.ground) / kSinking);
  const Vec3 below = above - Vec3(0.0, 0.0, kSinking * sinking);
  const planner::base::TimedPath path{
      {0.0, above, Vec3::Zero(), Vec3::Zero()},
      {sinking, below, Vec3::Zero(), Vec3::Zero()},
      {std::max(horizon.time, sinking) + horizon.step, below, Vec3::Zero(), Vec3::Zero()}};
  return planner::verify::verify({path,
                                  obstacles.tracks,
                                  0.0,
                                  mission_.vehicle.radius,
                                  {},
                                  horizon.acceleration_trust,
                                  horizon.time,
                                  obstacles.paths,
                                  {},
                                  obstacles.standing})
      .free();
}

bool Planning::due(double now, Goal::Kind goal) const {
  if (failed_ || planner_.busy()) return false;
  if (!last_begun_ || goal != last_goal_) return true;
  const config::CompanionSettings& companion = settings_.companion;
  // One may come a period early: a message that comes late is followed by one that does not.
  const double period = 1.0 / companion.largest_replan_rate_hz;
  return now + 1e-6 >= (new_tracks_ ? rate_kept_ - period : *last_begun_ + 1.0 / companion.replan_rate_hz);
}

void Planning::start(double now, Intake& intake, const MotionControl& motion, const Goal& goal) {
  rate_kept_ = std::max(rate_kept_, now) + 1.0 / settings_.companion.largest_replan_rate_hz;
  PlanJob next = job(now, intake, motion, goal);
  // What came before the first plan waited for the flight to begin.
  if (new_tracks_ && last_begun_) next.newest_track = intake.table().newest_message();
  last_begun_ = now;
  last_goal_ = goal.kind;
  new_tracks_ = false;
  try {
    planner_.start(std::move(next));
  } catch (const std::exception& failure) {
    failed(now, failure);
  }
}

// All that is known to move, at the job's start.
void Planning::look_around(double now, Intake& intake, PlanJob& job) const {
  job.tracks = intake.table().predict(job.start, settings_.horizon.acceleration_trust, &job.forecasts);
  if (const team::Team* team = intake.team()) job.paths = team->paths(now, job.start);
  const double sigma = intake.state().position_sigma;
  blur(job.paths, sigma);  // others tell theirs in the world
  if (mission_.tracks.sensed_from != config::SensedFrom::kWorld) return;
  blur(job.tracks, sigma);
  blur(job.forecasts, sigma);
}

// All of the map that a path of the job's request can come near to, and what it may land on.
void Planning::look_at_map(const vehicle::VehicleState& state, PlanJob& job) const {
  job.map.map = mission_.map;
  job.map.where = planner::horizon::reach_of(job.request, settings_.horizon);
  job.map.where.min.z() = std::min(job.map.where.min.z(), mission_.ground);
  job.map.up = mission_.map_up;
  job.map.floor = std::min(mission_.ground, mission_.min_height) + config::kRelief;
  job.map.sigma = state.position_sigma;
  const std::shared_ptr<const map::Seen> seen = sight_.seen();
  if (seen == nullptr) return;
  job.map.map = seen->map;
  job.map.seen = seen;
  job.map.up = seen->up;
  // What was seen from the vehicle is off by what the vehicle's own place is.
  if (mission_.map->tracks().empty()) job.map.sigma = 0.0;
}

void Planning::keep_in_sight(const vehicle::VehicleState& state, const Vec3& ahead,
                             planner::horizon::PathRequest& request) const {
  if (!mission_.cloud) return;
  const double braking = settings_.horizon.braking;
  const double reaction = kSeeing + 1.0 / settings_.companion.replan_rate_hz + settings_.companion.commitment;
  const double room = mission_.cloud->range - request.vehicle.radius - request.margin - map::Occupancy::kCell;
  const double fastest = braking * (std::sqrt(reaction * reaction + 2.0 * std::max(0.0, room) / braking) - reaction);
  const double aside = std::atan2(ahead.y(), ahead.x()) - state.yaw;
  const bool blind = !mission_.cloud->all_round && ahead.head<2>().norm() > kBeside && std::cos(aside) < kInView;
  double& cruise = request.vehicle.cruise_speed;
  request.vehicle.max_speed = std::min(request.vehicle.max_speed, std::max(kSlowest, fastest));
  cruise = std::min(cruise, request.vehicle.max_speed);
  // It is slow for a moment: were its time worth less for that, it would wait there rather than go round.
  request.time_price = cruise;
  if (blind) cruise = std::min(cruise, kSlowest);
}

void Planning::keep_in_column(planner::horizon::PathRequest& request) const {
  const std::optional<map::Occupancy::Column> column = sight_.column();
  if (!column) return;
  const double radius = request.vehicle.radius;
  const double rate = request.velocity.z();
  const double stop = request.position.z() + rate * std::abs(rate) / (2.0 * settings_.horizon.braking);
  const auto [low, high] = std::minmax({request.position.z(), stop, request.target.z()});
  request.volume.min.z() = std::max(request.volume.min.z(), std::min(column->low + radius, low));
  request.volume.max.z() = std::min(request.volume.max.z(), std::max(column->high - radius, high));
}

// What is asked of any path of the vehicle; the request says where it begins and leads to.
// Of what the largest tilt gives, the drag takes what no plan can speed up or brake with any more.
double Planning::attainable_speed(double drag) const {
  const planner::base::VehicleLimits& vehicle = mission_.vehicle;
  const double most = settings_.horizon.acceleration_limit;
  const double left = most - settings_.horizon.planned_acceleration(vehicle.max_acceleration);
  return drag > 0.0 ? std::min(vehicle.max_speed, std::max(vehicle.cruise_speed, left / drag)) : vehicle.max_speed;
}

void Planning::demand(const vehicle::VehicleState& state, double margin, planner::horizon::PathRequest& request) const {
  const bool in_world = mission_.tracks.sensed_from == config::SensedFrom::kWorld;
  request.vehicle = mission_.vehicle;
  request.margin = in_world ? planner::base::hypotenuse(margin, state.position_sigma) : margin;
  const planner::base::Box inside = volume(request.margin, state.position_sigma);
  // Where the vehicle is already, a path may begin, and it may end where it is sent.
  const Vec3& start = request.position;
  request.volume = {inside.min.cwiseMin(start).cwiseMin(request.target),
                    inside.max.cwiseMax(start).cwiseMax(request.target)};
  // Who has got out by so much comes back in.
  const double beyond = (inside.min - start).cwiseMax(start - inside.max).maxCoeff();
  request.volume_clearance = std::max(kClearSigmas * state.position_sigma, beyond);
  request.track_acceleration = settings_.horizon.track_acceleration;
  request.sudden_change = settings_.horizon.sudden_change;
  request.acceleration_trust = settings_.horizon.acceleration_trust;
}

void Planning::retreat(double now, Intake& intake, const MotionControl& motion, PlanJob& job) {
  planner::horizon::PathRequest& request = job.request;
  std::vector<prediction::Prediction> predictions =
      intake.table().predictions(job.start, settings_.horizon.acceleration_trust, request.position, Retreat::kRange);
  planner::base::TimedPath flown = motion.stream().ahead(job.start);
  const Vec3 beside = request.position - flown.front().position;
  for (planner::base::TimedPoint& point : flown) {
    point.t -= job.start;
    point.position += beside;
  }
  std::vector<planner::base::Track> standing;
  job.map.append_to(standing);
  request.standing = standing;
  const std::optional<Vec3> refuge =
      retreat_.choose(now, request, flown, std::move(predictions), intake.table().error_laws());
  request.standing = {};
  reporter_.retreats(now, refuge, retreat_.risk());
  if (!refuge) return;
  request.target = *refuge;
  request.visit = request.stuck = request.holds = false;
  // Who sees ahead alone does not hurry to where he does not look.
  if (!mission_.cloud) request.vehicle.cruise_speed = motion.share(now) * request.vehicle.max_speed;
}

PlanJob Planning::job(double now, Intake& intake, const MotionControl& motion, const Goal& goal) {
  const vehicle::VehicleState& state = intake.state();
  const setpoints::SetpointStream& stream = motion.stream();
  PlanJob job;
  job.goal = goal.kind;
  job.visit = goal.visit;
  job.target = goal.target;
  job.number = plans_;
  job.begun = now;
  job.start = now + std::max(planner_.latency(), settings_.companion.commitment + state.link_delay);
  job.estimate_shift = intake.estimate_shift();
  look_around(now, intake, job);

  // In take-off the reference says nothing of the vehicle's motion until a plan is followed.
  const bool climbs = goal.kind == Goal::Kind::kClimb;
  const bool lost = motion.lost(now, state);
  const bool from_vehicle = lost || (climbs && stream.plan(now).empty());
  const double share = motion.share(now);
  reporter_.reference_lost(now, lost && !climbs, motion.error(state), share);
  // The plan begins where the vehicle will be, which is beside its reference.
  if (!from_vehicle) job.offset = motion.offset().forecast();
  const planner::base::TimedPoint reference = stream.reference(job.start);
  const planner::base::TimedPoint offset = job.offset.at(job.start);
  planner::horizon::PathRequest& request = job.request;
  request.position =
      from_vehicle ? base::position_at(state.motion, job.start) : Vec3(reference.position + offset.position);
  request.velocity = from_vehicle ? state.motion.value.velocity : Vec3(reference.velocity + offset.velocity);
  request.target = goal.target;
  request.visit = goal.visit;
  request.stuck = goal.stuck;
  request.holds = goal.holds;
  reporter_.stuck(now, request.stuck);
  // Gaps are as wide as they are: who has waited in vain for one does not ask for more than is asked for at the start.
  demand(state, request.stuck ? settings_.horizon.margin : motion.margin(), request);
  double& largest_margin = reporter_.summary().largest_margin;
  largest_margin = std::max(largest_margin, request.margin);
  look_at_map(state, job);
  request.vehicle.max_speed = attainable_speed(stream.drag());
  request.vehicle.max_acceleration *= share;
  request.vehicle.cruise_speed *= share;
  // Where something near moves in a way not understood yet, it is watched before it is passed.
  const bool cautious = retreat_.cautious() || intake.table().has_unexplained(mission_.vehicle.cruise_speed);
  reporter_.cautious(now, cautious);
  if (cautious) request.vehicle.cruise_speed *= kCautious;
  keep_in_sight(state, motion.place_ahead(now, request.position).value_or(goal.target) - request.position, request);
  if (goal.kind == Goal::Kind::kWaypoint) keep_in_column(request);
  if (goal.kind == Goal::Kind::kWaypoint && !from_vehicle) retreat(now, intake, motion, job);
  if (!from_vehicle) {
    job.previous = stream.plan(job.start);
    // A plan to another waypoint is no plan to keep; one to a place on the way there is.
    const Vec3& leads_to = planned_for_ == request.target ? planned_to_ : request.target;
    if (!job.previous.empty() && (job.previous.back().position - leads_to).norm() > 1e-6) job.previous.clear();
    if (!job.previous.empty()) job.previous = rejoined(std::move(job.previous), request.position, request.velocity);
    for (planner::base::TimedPoint& point : job.previous) point.t -= job.start;
  }
  return job;
}

// Straight on braking; or a while along the plan, which may be past what comes by then.
std::vector<planner::base::TimedPath> Planning::stops(double now, const MotionControl& motion,
                                                      const MotionControl::StopStart& start) {
  const setpoints::SetpointStream& stream = motion.stream();
  std::vector<planner::base::TimedPath> stops;
  if (start.on_reference && motion.stop_point()) stops.push_back(stream.ahead(now));
  stops.push_back(stream.straight_stop(start.from));
  if (!start.on_reference || stream.plan(now).empty()) return stops;
  const planner::base::TimedPath ahead = stream.ahead(now);
  for (double later = kStopPeriod; later <= kLatestStop && now + later < ahead.back().t; later += kStopPeriod)
    stops.push_back(left_at(ahead, now + later, stream));
  return stops;
}

planner::base::TimedPath Planning::stop(double now, Intake& intake, const MotionControl& motion,
                                        const MotionControl::StopStart& start) {
  setpoints::OffsetForecast offset;
  if (start.on_reference) offset = motion.offset().forecast();
  std::vector<planner::base::TimedPath> flown = stops(now, motion, start);
  for (planner::base::TimedPath& stop : flown) {
    stop = offset.added_to(std::move(stop));
    for (planner::base::TimedPoint& point : stop) point.t -= now;
  }
  PlanJob job;
  job.start = now;
  look_around(now, intake, job);
  job.request.position = flown.front().front().position;
  job.request.velocity = flown.front().front().velocity;
  job.request.target = flown.front().back().position;
  demand(intake.state(), motion.margin(), job.request);
  look_at_map(intake.state(), job);
  const prediction::Obstacles obstacles = obstacles_of(job, settings_.horizon);
  set_obstacles(job, obstacles);
  planner::horizon::Stop chosen =
      contingency_.choose(job.request, flown, [this](const planner::base::TimedPath& other) { return is_seen(other); });
  reporter_.stops(now, chosen);
  for (planner::base::TimedPoint& point : chosen.path) point.t += now;
  return offset.taken_off(std::move(chosen.path));
}

// Whether it leaves the ground at once or late. What seems to be where the vehicle stands is the vehicle.
bool Planning::climbs_free(double now, Intake& intake) const {
  const Vec3& ground = intake.state().motion.value.position;
  const Vec3 top = climb_end(mission_, intake.state());
  PlanJob job;
  job.start = now;
  look_around(now, intake, job);
  const double radius = mission_.vehicle.radius;
  std::erase_if(job.tracks,
                [&](const planner::base::Track& t) { return (t.position - ground).norm() < t.radius + radius; });
  job.forecasts.clear();  // they number the tracks; for so short a time the tracks do
  job.request.position = job.request.target = ground;
  demand(intake.state(), settings_.horizon.margin, job.request);
  look_at_map(intake.state(), job);
  const prediction::Obstacles obstacles = obstacles_of(job, settings_.horizon);
  set_obstacles(job, obstacles);
  job.request.volume = {};
  return std::all_of(kLiftOff.begin(), kLiftOff.end(), [&](double lift_off) {
    const double up = lift_off + (top - ground).norm() / kClimbing;
    const planner::base::TimedPath path{{0.0, ground, Vec3::Zero(), Vec3::Zero()},
                                        {lift_off, ground, Vec3::Zero(), Vec3::Zero()},
                                        {std::max(up, lift_off + 1e-3), top, Vec3::Zero(), Vec3::Zero()}};
    const planner::verify::Verification seen =
        planner::horizon::verify_until(path, job.request, std::max(up, settings_.horizon.time));
    return seen.free() && seen.min_clearance >= job.request.margin;
  });
}

planner::base::Box Planning::volume(double margin, double sigma) const {
  planner::base::Box box = flight_volume(mission_);
  // The vehicle is off its path at times, and its estimate is off. Not by all of the margin: in a narrow corridor the
  // room is needed to dodge.
  const Vec3 inset = (kInset * (box.max - box.min)).cwiseMin(kInsetMargin * margin + kInsetSigmas * sigma);
  box.min += inset;
  box.max -= inset;
  return box;
}

void Planning::failed(double now, const std::exception& failure) {
  failed_ = true;
  failure_ = failure.what();
  reporter_.event(now, "planner_failed", *failure_);
}

}  // namespace jink::bridge::companion
