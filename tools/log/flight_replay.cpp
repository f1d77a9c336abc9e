// SPDX-License-Identifier: BSD-3-Clause
#include "tools/log/flight_replay.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "planner/geometry/validity.hpp"
#include "tools/log/map_record.hpp"

namespace jink::tools::log {
namespace {

using planner::base::TimedPath;
using planner::verify::PlanStatus;

constexpr double kFastestSwing = 10.0;     // rad/s
constexpr int kMostGenerations = 1000000;  // horizon.generations' own bound
constexpr std::array<std::string_view, 8> kTypes = {"truth",    "obstacles", "state", "tracks",
                                                    "setpoint", "event",     "plan",  "header"};

Vec3 exact_vector(const Json& value, const char* key) {
  const auto v = exact_numbers<3>(value, key);
  return {v[0], v[1], v[2]};
}

Vec3 exact_vector_of(const Json& record, const char* key) {
  return exact_vector(member(record, key), key);
}

PlanStatus status_of(const Json& record) {
  const std::string text = text_of(record, "status");
  for (const PlanStatus status : {PlanStatus::kReaches, PlanStatus::kProgresses, PlanStatus::kBlocked,
                                  PlanStatus::kStartBlocked, PlanStatus::kInvalid}) {
    if (text == planner::verify::to_string(status)) return status;
  }
  refuse("\"status\" is not one of reaches, progresses, blocked, start_blocked, invalid");
}

std::array<planner::verify::SearchExtent, 2> searches_of(const Json& record) {
  const Json& list = member(record, "searches");
  check_list(list, "searches", 2);
  std::array<planner::verify::SearchExtent, 2> searches;
  for (std::size_t i = 0; i < 2; ++i) {
    check_list(list[i], "searches", 2);
    const bool whole = list[i][0].is_number_unsigned() && list[i][1].is_number_unsigned();
    const auto schedule = whole ? list[i][0].get<std::uint64_t>() : 0;
    const auto done = whole ? list[i][1].get<std::uint64_t>() : 0;
    const bool made = done >= 1 && done <= schedule && schedule <= kMostGenerations;
    if (!whole || (!made && schedule + done != 0)) refuse("\"searches\" holds no [scheduled, done] generations");
    searches[i] = {static_cast<int>(schedule), static_cast<int>(done)};
  }
  return searches;
}

/// Finite points, none before the one before it: two may share an instant, where adding the start rounded their
/// difference away.
TimedPath path_of(const Json& record, const char* key) {
  TimedPath path;
  for (const Json& item : list_of(record, key)) {
    const auto point = exact_numbers<4>(item, key);
    const bool finite = std::all_of(point.begin(), point.end(), [](double x) { return std::isfinite(x); });
    if (!finite || (!path.empty() && point[0] < path.back().t))
      refuse(std::string("\"") + key + "\" is not a path: finite points in the order of time");
    path.push_back({point[0], {point[1], point[2], point[3]}, Vec3::Zero(), Vec3::Zero()});
  }
  return path;
}

planner::base::VehicleLimits vehicle_of(const Json& from) {
  const auto v = exact_numbers<8>(member(from, "vehicle"), "vehicle");
  const bool sane = std::all_of(v.begin(), v.end(), [](double x) { return x > 0.0 && std::isfinite(x); });
  if (!sane) refuse("\"vehicle\" holds a limit that is not above 0");
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]};
}

planner::base::Body body_of(const Json& record, double radius) {
  if (!record.is_object()) refuse("\"tracks\" holds a body that is no object");
  planner::base::Body body{solid_of(record), exact(member(record, "yaw"), "yaw"),
                           exact(member(record, "yaw_rate"), "yaw_rate")};
  if (!planner::geometry::is_valid(body, radius)) refuse("\"tracks\" holds a body that is not in its sphere");
  return body;
}

planner::base::Track track_of(const Json& item) {
  constexpr std::size_t kNumbers = 14;  // then a body, where it has one, and one more, that older logs do not have
  const bool newer = item.is_array() && item.size() > kNumbers && !item.back().is_object();
  const std::size_t last = newer ? item.size() - 1 : item.size();
  if (!item.is_array() || last != kNumbers + 1) check_list(item, "tracks", newer ? kNumbers + 1 : kNumbers);
  if (!item[0].is_number_unsigned()) refuse("\"tracks\" holds an id that is not a whole number");
  std::array<double, 13> x{};
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = exact(item[i + 1], "tracks");
  return {item[0].get<std::uint64_t>(),
          {x[0], x[1], x[2]},
          {x[3], x[4], x[5]},
          {x[6], x[7], x[8]},
          x[9],
          x[10],
          x[11],
          x[12],
          last > kNumbers ? body_of(item[kNumbers], x[9]) : planner::base::Body(),
          newer ? exact(item[last], "tracks") : 0.0};
}

planner::geometry::KnownPath known_path_of(const Json& item) {
  planner::geometry::KnownPath path;
  path.id = count_of(item, "id");
  path.points = path_of(item, "points");
  path.offset = exact(member(item, "offset"), "offset");
  path.radius = exact(member(item, "radius"), "radius");
  path.margin = exact(member(item, "margin"), "margin");
  path.position_sigma = exact(member(item, "position_sigma"), "position_sigma");
  path.velocity_sigma = exact(member(item, "velocity_sigma"), "velocity_sigma");
  path.age = exact(member(item, "age"), "age");
  path.until = exact(member(item, "until"), "until");
  if (item.contains("body")) path.body = body_of(item["body"], path.radius);
  if (!planner::geometry::is_valid(path)) refuse("\"paths\" holds a path that none can fly");
  return path;
}

bridge::prediction::Forecast forecast_of(const Json& item, std::size_t tracks) {
  bridge::prediction::Forecast forecast;
  forecast.track = count_of(item, "track");
  if (forecast.track >= tracks) refuse("\"forecasts\" names a track that is not there");
  forecast.radius = exact(member(item, "radius"), "radius");
  forecast.position_sigma = exact(member(item, "position_sigma"), "position_sigma");
  forecast.velocity_sigma = exact(member(item, "velocity_sigma"), "velocity_sigma");
  forecast.plain_until = exact(member(item, "plain_until"), "plain_until");
  if (item.contains("bounces")) {
    const auto x = exact_numbers<12>(member(item, "bounces"), "bounces");
    forecast.motion = bridge::prediction::BouncingMotion{
        {x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {{x[6], x[7], x[8]}, {x[9], x[10], x[11]}}};
  } else {
    constexpr std::size_t kTerms = bridge::prediction::HarmonicMotion::kTerms;
    const auto x = exact_numbers<1 + 3 * kTerms>(member(item, "swings"), "swings");
    bridge::prediction::HarmonicMotion motion;
    motion.frequency = x[0];
    if (!(std::abs(motion.frequency) <= kFastestSwing)) refuse("\"swings\" faster than anything that was ever fitted");
    for (std::size_t i = 0; i < 3 * kTerms; ++i)
      motion.terms(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) = x[i + 1];
    forecast.motion = motion;
  }
  // What the planner is given must be a path.
  if (!planner::geometry::is_valid(bridge::prediction::to_path(forecast, 1.0, 0.5)))
    refuse("\"forecasts\" holds a motion that none can fly");
  return forecast;
}

bridge::companion::PlanJob job_of(const Json& record, const Json& from) {
  bridge::companion::PlanJob job;
  planner::horizon::PathRequest& request = job.request;
  job.number = count_of(record, "number");
  job.begun = number_of(from, "begun");
  job.start = number_of(from, "start");
  request.position = exact_vector_of(from, "p");
  request.velocity = exact_vector_of(from, "v");
  request.target = exact_vector_of(from, "target");
  request.vehicle = vehicle_of(from);
  const Json& volume = member(from, "volume");
  check_list(volume, "volume", 2);
  request.volume = {exact_vector(volume[0], "volume"), exact_vector(volume[1], "volume")};
  request.margin = exact(member(from, "margin"), "margin");
  if (from.contains("standing_margin")) request.standing_margin = exact(from["standing_margin"], "standing_margin");
  request.track_acceleration = exact(member(from, "track_acceleration"), "track_acceleration");
  request.acceleration_trust = exact(member(from, "acceleration_trust"), "acceleration_trust");
  // Older logs have no such key.
  if (from.contains("sudden_change")) request.sudden_change = exact(from["sudden_change"], "sudden_change");
  if (from.contains("time_price")) request.time_price = exact(from["time_price"], "time_price");
  if (from.contains("volume_clearance")) request.volume_clearance = exact(from["volume_clearance"], "volume_clearance");
  if (from.contains("stuck")) request.stuck = flag_of(from, "stuck");
  if (from.contains("holds")) request.holds = flag_of(from, "holds");
  if (from.contains("visit")) request.visit = flag_of(from, "visit");
  if (from.contains("way")) {
    for (const Json& place : list_of(from, "way")) request.way.push_back(exact_vector(place, "way"));
  }
  if (!(request.volume.min.array() <= request.volume.max.array()).all()) refuse("\"volume\" is not [min, max]");
  for (const auto& [key, amount] : {std::pair("volume_clearance", request.volume_clearance),
                                    {"margin", request.margin},
                                    {"standing_margin", request.standing_margin},
                                    {"track_acceleration", request.track_acceleration},
                                    {"sudden_change", request.sudden_change},
                                    {"time_price", request.time_price},
                                    {"acceleration_trust", request.acceleration_trust}})
    if (!(amount >= 0.0)) refuse("\"" + std::string(key) + "\" is below 0");
  for (const Json& item : list_of(from, "tracks")) job.tracks.push_back(track_of(item));
  if (from.contains("standing")) {
    for (const Json& id : list_of(from, "standing")) {
      if (!id.is_number_unsigned()) refuse("\"standing\" holds what is no id");
      job.standing.push_back(id.get<std::uint64_t>());
    }
  }
  for (const Json& item : list_of(from, "forecasts")) job.forecasts.push_back(forecast_of(item, job.tracks.size()));
  for (const Json& item : list_of(from, "paths")) job.paths.push_back(known_path_of(item));
  if (from.contains("map")) {
    const Json& view = member(from, "map");
    const Json& where = member(view, "where");
    check_list(where, "where", 2);
    job.map.where = {exact_vector(where[0], "where"), exact_vector(where[1], "where")};
    job.map.up = exact(member(view, "up"), "up");
    job.map.floor = exact(member(view, "floor"), "floor");
    job.map.sigma = exact(member(view, "sigma"), "sigma");
    if (!std::isfinite(job.map.up) || !planner::geometry::is_amount(job.map.sigma))
      refuse("\"map\" holds a height or a standard deviation that is none");
  }
  job.previous = path_of(from, "previous");
  return job;
}

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}

bool same_bits(const TimedPath& a, const TimedPath& b) {
  const auto same_point = [](const planner::base::TimedPoint& p, const planner::base::TimedPoint& q) {
    return bits(p.t) == bits(q.t) && bits(p.position.x()) == bits(q.position.x()) &&
           bits(p.position.y()) == bits(q.position.y()) && bits(p.position.z()) == bits(q.position.z());
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_point);
}

/// The largest distance at any instant; both are linear between their points, so it is at a point of one of them.
std::optional<double> max_distance(const TimedPath& a, const TimedPath& b) {
  if (a.empty() || b.empty()) return std::nullopt;
  double most = 0.0;
  for (const TimedPath* path : {&a, &b}) {
    for (const planner::base::TimedPoint& point : *path) {
      most = std::max(most,
                      (planner::base::sample(a, point.t).position - planner::base::sample(b, point.t).position).norm());
    }
  }
  return most;
}

/// What the companion takes from its parameters into each request. The margin holds more than the parameter's.
void change(planner::horizon::PathRequest& request, const ReplaySettings& settings) {
  const planner::base::HorizonSettings& recorded = settings.recorded.horizon;
  const planner::base::HorizonSettings& now = settings.settings.horizon;
  if (now.margin != recorded.margin) request.margin = std::max(0.0, request.margin + now.margin - recorded.margin);
  if (now.track_acceleration != recorded.track_acceleration) request.track_acceleration = now.track_acceleration;
  if (now.sudden_change != recorded.sudden_change) request.sudden_change = now.sudden_change;
  if (now.acceleration_trust != recorded.acceleration_trust) request.acceleration_trust = now.acceleration_trust;
}

}  // namespace

FlightRecording::FlightRecording(const std::filesystem::path& log) : lines_(log), source_(log.string() + ":1") {
  const Json& header = lines_.header();
  try {
    name_ = text_of(header, header.contains("scenario") ? "scenario" : "mission");
    version_ = text_of(header, "version");
    if (header.contains("pilot")) pilot_ = text_of(header, "pilot");
    seed_ = count_of(header, "seed");
    map_ = map_of(header);
    const Json& parameters = member(header, "parameters");
    if (!parameters.is_object()) refuse("\"parameters\" is not an object");
    for (const auto& [key, value] : parameters.items()) parameters_.push_back({key, text_of(parameters, key.c_str())});
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(source_ + ": header " + error.what());
  }
}

std::optional<RecordedPlan> FlightRecording::next() {
  for (Json record; lines_.next(record);) {
    try {
      const std::string type = text_of(record, "type");
      if (type == "seen") {
        seen_ = seen_of(record, seen_.get(), map_.get());
        continue;
      }
      if (type != "plan") {
        unknown_ += std::find(kTypes.begin(), kTypes.end(), type) == kTypes.end() ? 1 : 0;
        continue;
      }
      const auto from = record.find("from");
      if (from == record.end()) {
        ++without_inputs_;
        continue;
      }
      RecordedPlan plan;
      plan.line = lines_.line();
      plan.t = number_of(record, "t");
      plan.job = job_of(record, *from);
      plan.job.map.map = map_;
      if (from->contains("map") && (*from)["map"].contains("seen")) {
        if (seen_ == nullptr || count_of((*from)["map"], "seen") != seen_->number)
          refuse("\"map\" names what was seen by a number that is not that of the last \"seen\"");
        plan.job.map.seen = seen_;
        plan.job.map.map = seen_->map;
      }
      plan.searches = searches_of(record);
      plan.status = status_of(record);
      plan.path = path_of(record, "path");
      return plan;
    } catch (const std::invalid_argument& error) {
      lines_.fail(error.what());
    } catch (const NotFinite&) {
      lines_.fail("plan: a time is not finite");
    }
  }
  return std::nullopt;
}

FlightComparison compare_plans(FlightRecording& recording, const ReplaySettings& settings,
                               const std::function<void(std::size_t)>& progress) {
  planner::horizon::HorizonPlanner planner(settings.settings.horizon, settings.settings.optimizer);
  planner::base::WorkerPool pool(settings.threads);
  const planner::base::Budget whole{settings.settings.horizon.generations};
  FlightComparison result;
  while (std::optional<RecordedPlan> recorded = recording.next()) {
    bridge::companion::PlanJob& job = recorded->job;
    const bridge::prediction::Obstacles obstacles = bridge::companion::obstacles_of(job, settings.settings.horizon);
    bridge::companion::set_obstacles(job, obstacles);
    change(job.request, settings);
    // Searches go as far as the recorded ones did, unless their length is what was changed.
    const bool by_count = settings.settings.horizon.generations == settings.recorded.horizon.generations &&
                          recorded->searches[0].schedule > 0;
    planner::verify::Plan plan =
        by_count ? planner.repeat(job.request, job.previous, settings.seed, job.number, recorded->searches, pool)
                 : planner.plan(job.request, job.previous, settings.seed, job.number, whole, pool);
    for (planner::base::TimedPoint& point : plan.path) point.t += job.start;
    if (plan.status != recorded->status || !same_bits(plan.path, recorded->path)) {
      result.differences.push_back({recorded->line, recorded->t, job.number, recorded->status, plan.status,
                                    max_distance(recorded->path, plan.path)});
    }
    ++result.plans;
    if (progress) progress(result.plans);
  }
  return result;
}

}  // namespace jink::tools::log
