// SPDX-License-Identifier: BSD-3-Clause
#include "tools/log/flight_log.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "planner/base/solid.hpp"
#include "planner/base/version.hpp"
#include "tools/base/exit_code.hpp"

namespace jink::tools::log {

nlohmann::ordered_json vector_json(const Vec3& v) {
  return nlohmann::ordered_json::array({v.x(), v.y(), v.z()});
}

FlightLog::FlightLog(const std::filesystem::path& file, const nlohmann::ordered_json& header,
                     const FlightLogOptions& options)
    : file_(file), options_(options), out_(file) {
  if (!out_) throw base::UsageError("--log: '" + file.string() + "' cannot be written");
  nlohmann::ordered_json first{{"type", "header"}, {"format", "jink-log/1"}, {"version", JINK_VERSION}};
  first.update(header);
  out_ << first.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

FlightLog::~FlightLog() = default;  // the thread writes what is queued before it ends

void FlightLog::on_state(double t, const bridge::vehicle::VehicleState& state) {
  put(t, state);
}

void FlightLog::on_tracks(double t, const std::vector<planner::base::Track>& tracks) {
  put(t, tracks, tracks.size() * sizeof(planner::base::Track));
}

void FlightLog::on_plan(double t, const bridge::companion::PlanResult& result) {
  const std::size_t points = result.plan.path.size() + result.job.previous.size();
  put(t, result, result.job.tracks.size() * sizeof(planner::base::Track) + points * sizeof(planner::base::TimedPoint));
}

void FlightLog::on_setpoint(double t, const bridge::vehicle::Setpoint& setpoint) {
  put(t, setpoint);
}

void FlightLog::on_event(double t, std::string_view name, const std::string& detail) {
  put(t, Event{std::string(name), detail}, detail.size());
}

void FlightLog::on_truth(double t, std::span<const sim::world::VehicleTruth> vehicles, const sim::world::World& world) {
  Truth truth{{vehicles.begin(), vehicles.end()}, {}};
  truth.spheres.reserve(static_cast<std::size_t>(world.obstacle_count()));
  for (int i = 0; i < world.obstacle_count(); ++i) truth.spheres.push_back(world.sphere(i, t));
  const std::size_t bytes =
      truth.spheres.size() * sizeof(planner::geometry::Sphere) + vehicles.size() * sizeof(sim::world::VehicleTruth);
  put(t, std::move(truth), bytes);
}

void FlightLog::put(double t, Content content, std::size_t extra_bytes) {
  Record record{t, std::move(content), sizeof(Record) + extra_bytes};
  {
    std::unique_lock lock(mutex_);
    // A record larger than the whole queue goes in alone.
    const auto room = [&] { return queued_bytes_ == 0 || queued_bytes_ + record.bytes <= options_.queue_bytes; };
    if (options_.wait) emptied_.wait(lock, room);
    if (!room()) {
      ++dropped_;
      ++dropped_here_;
      dropped_at_ = t;
      return;
    }
    tell_of_dropped(t);
    queued_bytes_ += record.bytes;
    queue_.push_back(std::move(record));
  }
  filled_.notify_one();
}

// Precondition: mutex_ is held.
void FlightLog::tell_of_dropped(double t) {
  if (dropped_here_ == 0) return;
  queue_.push_back({t, dropped_event(std::exchange(dropped_here_, 0)), sizeof(Record)});
  queued_bytes_ += sizeof(Record);
}

FlightLog::Event FlightLog::dropped_event(std::uint64_t count) {
  return {"log_dropped", std::to_string(count) + " records are missing here: writing was too slow"};
}

void FlightLog::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (filled_.wait(lock, stop, [&] { return !queue_.empty(); })) {
    const Record record = std::move(queue_.front());
    queue_.pop_front();
    const bool last = queue_.empty();
    lock.unlock();
    std::exception_ptr failure;
    try {
      write(record);
      if (last) out_.flush();  // whoever is killed loses little
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && !failure_) failure_ = failure;
    queued_bytes_ -= record.bytes;
    emptied_.notify_one();
  }
}

std::uint64_t FlightLog::dropped() const {
  const std::scoped_lock lock(mutex_);
  return dropped_;
}

void FlightLog::close() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  const std::scoped_lock lock(mutex_);
  if (dropped_here_ > 0) write({dropped_at_, dropped_event(std::exchange(dropped_here_, 0)), 0});
  if (dropped_ > 0) {
    const std::string text = std::to_string(dropped_) + " records were left out, writing was too slow";
    std::fprintf(stderr, "jink: %s: %s\n", file_.string().c_str(), text.c_str());
  }
  out_.flush();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  if (!out_) throw std::runtime_error(file_.string() + ": the flight log could not be written to its end");
}

void FlightLog::write(const Record& record) {
  std::visit([&](const auto& content) { write_content(record.t, content); }, record.content);
}

base::JsonWriter& FlightLog::begin(std::string_view type, double t) {
  line_.clear();
  return line_.open('{').key("type").text(type).key("t").number(t);
}

void FlightLog::end_line() {
  line_.close('}');
  out_ << line_.str() << '\n';
}

void FlightLog::write_content(double t, const bridge::vehicle::VehicleState& state) {
  begin("state", t).key("p").vector(state.motion.value.position).key("v").vector(state.motion.value.velocity);
  line_.key("armed").flag(state.armed).key("mode").text(bridge::vehicle::to_string(state.mode));
  end_line();
}

void FlightLog::write_content(double t, const std::vector<planner::base::Track>& tracks) {
  begin("tracks", t).key("tracks").open('[');
  for (const planner::base::Track& track : tracks) {
    line_.open('{').key("id").integer(track.id).key("p").vector(track.position).key("v").vector(track.velocity);
    line_.key("a").vector(track.acceleration).key("radius").number(track.radius);
    line_.key("position_sigma").number(track.position_sigma).key("velocity_sigma").number(track.velocity_sigma);
    line_.key("age").number(track.age).close('}');
  }
  line_.close(']');
  end_line();
}

// What has changed since what the plan before saw: most of it stays as it is.
void FlightLog::write_seen(double t, const std::shared_ptr<const bridge::map::Seen>& seen) {
  if (seen == nullptr || (seen_ != nullptr && seen->number == seen_->number)) return;
  using Boxes = std::vector<bridge::map::CellBox>;
  const Boxes none;
  const Boxes& before = seen_ == nullptr ? none : seen_->boxes;
  const auto add = [this](std::string_view key, const Boxes& all, const Boxes& but) {
    line_.key(key).open('[');
    auto other = but.begin();
    for (const bridge::map::CellBox& box : all) {  // both are in order
      while (other != but.end() && bridge::map::comes_before(*other, box)) ++other;
      if (other != but.end() && *other == box) continue;
      line_.open('[');
      for (const bridge::map::Cell& corner : {box.min, box.max})
        for (const int number : corner) line_.number(number);
      line_.close(']');
    }
    line_.close(']');
  };
  begin("seen", t).key("number").integer(seen->number).key("origin").exact_vector(seen->origin);
  add("added", seen->boxes, before);
  add("removed", before, seen->boxes);
  end_line();
  seen_ = seen;
}

void FlightLog::write_content(double t, const bridge::companion::PlanResult& result) {
  write_seen(t, result.job.map.seen);
  const planner::verify::Plan& plan = result.plan;
  begin("plan", t).key("path").open('[');
  for (const planner::base::TimedPoint& point : plan.path) {
    line_.open('[').number(result.job.start + point.t).number(point.position.x());
    line_.number(point.position.y()).number(point.position.z()).close(']');
  }
  line_.close(']').key("ms").number(result.ms).key("status").text(planner::verify::to_string(plan.status));
  line_.key("kept").flag(plan.kept_previous).key("emergency").flag(plan.emergency);
  line_.key("number").integer(result.job.number).key("missed").flag(result.missed).key("searches").open('[');
  for (const planner::verify::SearchExtent& search : plan.searches) {
    line_.open('[').integer(static_cast<std::uint64_t>(search.schedule));
    line_.integer(static_cast<std::uint64_t>(search.generations)).close(']');
  }
  line_.close(']');
  add_job(result.job);
  end_line();
}

// All of it: the names in brackets are all that the types have, and one more would not compile here.
void FlightLog::add_job(const bridge::companion::PlanJob& job) {
  const auto& [position, velocity, target, volume, volume_clearance, vehicle, request_tracks, request_paths,
               request_standing, margin, standing_margin, track_acceleration, sudden_change, trust, time_price, stuck,
               holds, visit, way] = job.request;
  const auto& [radius, length, mass, max_speed, cruise_speed, max_acceleration, max_jerk, max_climb, drag, damping] =
      vehicle;  // plans do not depend on the last two
  line_.key("from").open('{').key("begun").number(job.begun).key("start").number(job.start);
  line_.key("p").exact_vector(position).key("v").exact_vector(velocity).key("target").exact_vector(target);
  line_.key("vehicle").open('[');
  for (const double limit : {radius, length, mass, max_speed, cruise_speed, max_acceleration, max_jerk, max_climb})
    line_.exact(limit);
  line_.close(']').key("volume").open('[').exact_vector(volume.min).exact_vector(volume.max).close(']');
  line_.key("volume_clearance")
      .exact(volume_clearance)
      .key("margin")
      .exact(margin)
      .key("standing_margin")
      .exact(standing_margin)
      .key("track_acceleration")
      .exact(track_acceleration)
      .key("sudden_change")
      .exact(sudden_change);
  line_.key("acceleration_trust")
      .exact(trust)
      .key("time_price")
      .exact(time_price)
      .key("stuck")
      .flag(stuck)
      .key("holds")
      .flag(holds)
      .key("visit")
      .flag(visit);
  line_.key("way").open('[');
  for (const Vec3& place : way) line_.exact_vector(place);
  line_.close(']');
  line_.key("tracks").open('[');
  for (const auto& [id, p, v, a, r, position_sigma, velocity_sigma, age, body, change] : job.tracks) {
    line_.open('[').integer(id);
    for (const Vec3& part : {p, v, a}) line_.exact(part.x()).exact(part.y()).exact(part.z());
    line_.exact(r).exact(position_sigma).exact(velocity_sigma).exact(age);
    if (body.solid) add_body(body);
    line_.exact(change).close(']');
  }
  line_.close(']').key("standing").open('[');
  for (const std::uint64_t id : job.standing) line_.integer(id);
  line_.close(']').key("forecasts").open('[');
  for (const bridge::prediction::Forecast& forecast : job.forecasts) add_forecast(forecast);
  line_.close(']').key("paths").open('[');
  for (const auto& [id, points, offset, r, off_path, position_sigma, velocity_sigma, age, until, body] : job.paths) {
    line_.open('{').key("id").integer(id).key("offset").exact(offset).key("radius").exact(r).key("margin").exact(
        off_path);
    line_.key("position_sigma").exact(position_sigma).key("velocity_sigma").exact(velocity_sigma);
    line_.key("age").exact(age).key("until").exact(until);
    add_points("points", points);
    if (body.solid) {
      line_.key("body");
      add_body(body);
    }
    line_.close('}');
  }
  line_.close(']');
  if (const auto& [map, seen, where, up, floor, sigma] = job.map; map != nullptr && !map->tracks().empty()) {
    line_.key("map").open('{');
    if (seen != nullptr) line_.key("seen").integer(seen->number);
    line_.key("where").open('[').exact_vector(where.min).exact_vector(where.max).close(']');
    line_.key("up").exact(up).key("floor").exact(floor).key("sigma").exact(sigma).close('}');
  }
  add_points("previous", job.previous);
  line_.close('}');
}

void FlightLog::add_forecast(const bridge::prediction::Forecast& forecast) {
  const auto& [track, motion, radius, position_sigma, velocity_sigma, plain_until] = forecast;
  line_.open('{').key("track").integer(track).key("radius").exact(radius).key("position_sigma").exact(position_sigma);
  line_.key("velocity_sigma").exact(velocity_sigma).key("plain_until").exact(plain_until);
  if (const auto* bouncing = std::get_if<bridge::prediction::BouncingMotion>(&motion)) {
    line_.key("bounces").open('[');
    for (const Vec3& part : {bouncing->begin, bouncing->velocity, bouncing->room.min, bouncing->room.max})
      line_.exact(part.x()).exact(part.y()).exact(part.z());
  } else {
    const auto& swinging = std::get<bridge::prediction::HarmonicMotion>(motion);
    line_.key("swings").open('[').exact(swinging.frequency);
    for (Eigen::Index row = 0; row < swinging.terms.rows(); ++row) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) line_.exact(swinging.terms(row, axis));
    }
  }
  line_.close(']').close('}');
}

void FlightLog::add_body(const planner::base::Body& body) {
  const auto exact = [this](const Vec3& v) { line_.exact(v.x()).exact(v.y()).exact(v.z()); };
  const planner::base::Solid& solid = *body.solid;
  line_.open('{').key("yaw").exact(body.yaw).key("yaw_rate").exact(body.yaw_rate);
  line_.key(solid.is_hull() ? "hull" : "prism").open('[');
  for (const Vec3& vertex : solid.vertices()) exact(vertex);
  if (!solid.is_hull()) {
    exact(solid.half());
    line_.exact(solid.corner()).exact(solid.rounding());
    exact(solid.pose().center);
    for (Eigen::Index axis = 0; axis < 3; ++axis) exact(solid.pose().axes.col(axis));
  }
  line_.close(']').close('}');
}

void FlightLog::add_points(std::string_view key, const planner::base::TimedPath& path) {
  line_.key(key).open('[');
  for (const planner::base::TimedPoint& point : path) {
    line_.open('[').exact(point.t).exact(point.position.x());
    line_.exact(point.position.y()).exact(point.position.z()).close(']');
  }
  line_.close(']');
}

void FlightLog::write_content(double t, const bridge::vehicle::Setpoint& setpoint) {
  begin("setpoint", t).key("p").vector(setpoint.position).key("v").vector(setpoint.velocity);
  line_.key("a").vector(setpoint.acceleration).key("yaw").number(setpoint.yaw);
  end_line();
}

void FlightLog::write_content(double t, const Event& event) {
  begin("event", t).key("name").text(event.name).key("detail").text(event.detail);
  end_line();
}

void FlightLog::write_content(double t, const Truth& truth) {
  for (std::size_t k = 0; k < truth.vehicles.size(); ++k) {
    begin("truth", t);
    if (truth.vehicles.size() > 1) line_.key("vehicle").integer(k);
    line_.key("p").vector(truth.vehicles[k].position).key("v").vector(truth.vehicles[k].velocity);
    end_line();
  }
  for (std::size_t i = 0; i < truth.spheres.size(); ++i) {
    begin("obstacles", t).key("id").integer(sim::world::World::id(static_cast<int>(i)));
    line_.key("p").vector(truth.spheres[i].center).key("radius").number(truth.spheres[i].radius);
    end_line();
  }
}

nlohmann::ordered_json map_json(const planner::geometry::StaticMap& map) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const planner::base::Track& track : map.tracks()) {
    const Vec3& p = track.position;
    nlohmann::ordered_json entry{p.x(), p.y(), p.z(), track.radius};
    if (const planner::base::Solid* solid = track.body.solid.get(); solid != nullptr) {
      nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
      const auto put_all = [&](const Vec3& v) {
        for (const double x : v) numbers.push_back(x);
      };
      for (const Vec3& vertex : solid->vertices()) put_all(vertex);
      if (!solid->is_hull()) {
        put_all(solid->half());
        numbers.push_back(solid->corner());
        numbers.push_back(solid->rounding());
        put_all(solid->pose().center);
        for (Eigen::Index axis = 0; axis < 3; ++axis) put_all(solid->pose().axes.col(axis));
      }
      entry.push_back({{solid->is_hull() ? "hull" : "prism", std::move(numbers)}});
    }
    all.push_back(std::move(entry));
  }
  return all;
}

nlohmann::ordered_json parameters_of(const config::Settings& settings) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  for (const config::SettingText& setting : config::list_settings(settings)) parameters[setting.key] = setting.value;
  return parameters;
}

}  // namespace jink::tools::log
