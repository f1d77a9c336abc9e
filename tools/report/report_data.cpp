// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/report_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <variant>

#include "planner/verify/solid_contact.hpp"
#include "sim/world/shapes.hpp"
#include "tools/report/convex_hull.hpp"
#include "tools/report/event_severity.hpp"
#include "tools/report/shape_corners.hpp"

namespace jink::tools::report {
namespace {

using Json = nlohmann::json;

constexpr double kFinest = 0.05;             // s, between samples: what the eye can follow
constexpr double kMostSamples = 3000.0;      // of one series; a longer flight is shown coarser
constexpr std::size_t kMostPathPoints = 41;  // of one plan
constexpr double kOldestState = 0.2;         // s, age up to which an estimate is compared with tracks
constexpr double kSlack = 1e-6;              // s, for times that are sums of steps
constexpr double kShownMap = 15.0;           // m, about the flown way: what stands there is shown

Json rounded(double x, double digits) {
  return std::round(x * digits) / digits;
}
Json millimetres(double x) {
  return rounded(x, 1e3);
}
Json seconds(double t) {
  return rounded(t, 1e4);
}
Json centi(double x) {
  return rounded(x, 1e2);
}

Vec3 vec(const Triple& v) {
  return {v[0], v[1], v[2]};
}
double norm(const Triple& v) {
  return std::hypot(v[0], v[1], v[2]);
}
double distance(const Triple& a, const Triple& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

void append(Json& list, const Triple& v) {
  for (const double x : v) list.push_back(millimetres(x));
}

double interval_of(const FlightData& flight) {
  return std::max(kFinest, (flight.last - flight.first) / kMostSamples);
}

template <typename Sample>
std::vector<std::size_t> thin_samples(const std::vector<Sample>& samples, double interval) {
  std::vector<double> t;
  t.reserve(samples.size());
  for (const Sample& sample : samples) t.push_back(sample.t);
  return thin(t, interval);
}

Json motion_json(const std::vector<MotionSample>& samples, double interval) {
  Json t = Json::array(), p = Json::array(), speed = Json::array();
  for (const std::size_t i : thin_samples(samples, interval)) {
    t.push_back(seconds(samples[i].t));
    append(p, samples[i].position);
    speed.push_back(millimetres(norm(samples[i].velocity)));
  }
  return {{"t", std::move(t)}, {"p", std::move(p)}, {"speed", std::move(speed)}};
}

/// Per frame a flat list of id, x, y, z, radius, and of tracks vx, vy, vz, ax, ay, az, age.
Json frames_json(const std::vector<BodyFrame>& frames, double interval, bool tracks) {
  if (frames.empty()) return nullptr;
  Json t = Json::array(), lists = Json::array();
  for (const std::size_t i : thin_samples(frames, interval)) {
    Json list = Json::array();
    for (const Body& body : frames[i].bodies) {
      list.push_back(body.id);
      append(list, body.position);
      list.push_back(millimetres(body.radius));
      if (!tracks) continue;
      for (const Triple& v : {body.velocity, body.acceleration}) {
        for (const double x : v) list.push_back(centi(x));
      }
      list.push_back(centi(body.age));
    }
    t.push_back(seconds(frames[i].t));
    lists.push_back(std::move(list));
  }
  return {{"t", std::move(t)}, {"frames", std::move(lists)}, {"stride", tracks ? 12 : 5}};
}

Json path_json(const std::vector<std::array<double, 4>>& points) {
  Json path = Json::array();
  const std::size_t step = std::max<std::size_t>(1, (points.size() + kMostPathPoints - 2) / (kMostPathPoints - 1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % step != 0 && i + 1 != points.size()) continue;
    const auto& [t, x, y, z] = points[i];
    path.push_back(millimetres(t));
    append(path, {x, y, z});
  }
  return path;
}

Json plans_json(const std::vector<PlanRecord>& plans) {
  Json list = Json::array();
  for (const PlanRecord& plan : plans) {
    Json item{{"t", seconds(plan.t)}, {"ms", centi(plan.ms)},  {"status", plan.status},
              {"kept", plan.kept},    {"missed", plan.missed}, {"path", path_json(plan.path)}};
    if (std::isfinite(plan.acceleration_trust)) item["trust"] = centi(plan.acceleration_trust);
    for (const Triple& place : plan.way) append(item["way"], place);
    for (const KnownPathRecord& known : plan.known_paths) {
      item["known"].push_back(
          {{"id", known.id}, {"radius", millimetres(known.radius)}, {"path", path_json(known.points)}});
    }
    list.push_back(std::move(item));
  }
  return list;
}

/// {vertices: [x, y, z, ...], faces: [i, j, k, ...]} of the convex hull of corners.
Json hull_json(const std::vector<Vec3>& corners) {
  Json entry;
  for (const Vec3& v : corners) append(entry["vertices"], {v.x(), v.y(), v.z()});
  entry["faces"] = Json::array();
  for (const Triangle& face : convex_hull(corners)) {
    for (const std::size_t corner : face) entry["faces"].push_back(corner);
  }
  return entry;
}

/// Where what stands is shown, in the map's frame.
planner::base::Box shown_part(const std::vector<MotionSample>& vehicle, double map_up) {
  planner::base::Box flown{Vec3::Constant(planner::base::kInfinity), Vec3::Constant(-planner::base::kInfinity)};
  for (const MotionSample& sample : vehicle) {
    flown.min = flown.min.cwiseMin(vec(sample.position));
    flown.max = flown.max.cwiseMax(vec(sample.position));
  }
  flown = planner::geometry::grown(flown, kShownMap);
  flown.min.z() -= map_up;
  flown.max.z() -= map_up;
  return flown;
}

/// What stands: [{p, r, shape: null or as in shapes_json()}, ...].
Json map_json(const FlightData& flight, const planner::base::Box& part) {
  Json list = Json::array();
  if (flight.map == nullptr) return list;
  std::vector<planner::base::Track> shown;
  flight.map->near(part, flight.map_up, shown);
  for (const planner::base::Track& track : shown) {
    const planner::base::Solid* solid = track.body.solid.get();
    Json& entry = list.emplace_back(Json{{"p", Json::array()}, {"r", millimetres(track.radius)}, {"shape", nullptr}});
    append(entry["p"], {track.position.x(), track.position.y(), track.position.z()});
    if (solid != nullptr) entry["shape"] = hull_json(solid_corners(*solid));
  }
  return list;
}

/// What had been seen to stand, box by box: [{p, r, box: edges, from: s, until: s or null}, ...].
Json seen_json(const FlightData& flight, const planner::base::Box& part) {
  using Corners = std::array<double, 6>;
  Json list = Json::array();
  std::map<Corners, std::size_t> before;  // places in the list
  for (const SeenRecord& record : flight.seen) {
    std::map<Corners, std::size_t> now;
    for (std::size_t i = 0; i < record.map->tracks().size(); ++i) {
      const planner::base::Box& box = record.map->box(i);
      if (planner::geometry::distance(box, part) > 0.0) continue;
      const Corners corners{box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z()};
      if (const auto known = before.find(corners); known != before.end()) {
        now.insert(before.extract(known));
        continue;
      }
      now.emplace(corners, list.size());
      const Vec3 centre = 0.5 * (box.min + box.max) + Vec3(0.0, 0.0, flight.map_up), edges = box.max - box.min;
      Json& entry = list.emplace_back(
          Json{{"r", millimetres(0.5 * edges.norm())}, {"from", seconds(record.t)}, {"until", nullptr}});
      append(entry["p"], {centre.x(), centre.y(), centre.z()});
      append(entry["box"], {edges.x(), edges.y(), edges.z()});
    }
    for (const auto& [corners, place] : before) list[place]["until"] = seconds(record.t);
    before = std::move(now);
  }
  return list;
}

/// By id {box: edges} or {vertices: [x, y, z, ...], faces: [i, j, k, ...], yaw_rate?}, about the body's position.
Json shapes_json(const std::map<std::uint64_t, config::Obstacle>& shapes) {
  Json by_id = Json::object();
  for (const auto& [id, obstacle] : shapes) {
    Json& entry = by_id[std::to_string(id)];
    const auto* box = std::get_if<config::BoxShape>(&obstacle.shape);
    if (box != nullptr && obstacle.orientation.isZero(0.0) && obstacle.yaw_rate == 0.0) {
      entry["box"] = {millimetres(box->edges.x()), millimetres(box->edges.y()), millimetres(box->edges.z())};
      continue;
    }
    entry = hull_json(shape_corners(obstacle, 0.0));
    if (obstacle.yaw_rate != 0.0) entry["yaw_rate"] = obstacle.yaw_rate;
  }
  return by_id;
}

/// Thinned to the least clearance of each interval: what matters must not fall between two samples.
Json clearance_json(const std::vector<ClearanceSample>& samples, double interval, std::string_view from) {
  if (samples.empty()) return nullptr;
  Json t = Json::array(), d = Json::array();
  const ClearanceSample* least_of_all = &samples.front();
  for (std::size_t i = 0; i < samples.size();) {
    const double begin = samples[i].t;
    const ClearanceSample* least = &samples[i];
    for (; i < samples.size() && samples[i].t < begin + interval - kSlack; ++i) {
      if (samples[i].distance < least->distance) least = &samples[i];
    }
    if (least->distance < least_of_all->distance) least_of_all = least;
    t.push_back(seconds(least->t));
    d.push_back(millimetres(least->distance));
  }
  const Json lowest{{"t", seconds(least_of_all->t)}, {"d", millimetres(least_of_all->distance)}};
  return {{"from", from}, {"t", std::move(t)}, {"d", std::move(d)}, {"min", lowest}};
}

/// Of tracks `ahead` seconds after their time.
std::optional<double> nearest_track(const Triple& vehicle, const BodyFrame& frame, double ahead) {
  std::optional<double> least;
  for (const Body& body : frame.bodies) {
    Triple there = body.position;
    for (std::size_t k = 0; k < 3; ++k) there[k] += ahead * body.velocity[k];
    const double free = distance(vehicle, there) - body.radius;
    if (!least || free < *least) least = free;
  }
  return least;
}

/// From a point to the true surface at a time.
double surface_distance(const FlightData& flight, const Body& body, double t, const Triple& from) {
  const auto shape = flight.shapes.find(body.id);
  if (shape == flight.shapes.end()) return distance(from, body.position) - body.radius;
  const Eigen::Matrix3d axes = sim::world::axes_at(shape->second, t);
  return sim::world::distance(shape->second.shape, Vec3::Zero(), axes.transpose() * (vec(from) - vec(body.position)));
}

const std::vector<MotionSample>& truth_of(const FlightData& flight, std::size_t vehicle) {
  return vehicle == 0 ? flight.truth : flight.others[vehicle - 1].truth;
}

/// The number by which the log knows the vehicle.
std::uint64_t number_of(const FlightData& flight, std::size_t vehicle) {
  return vehicle == 0 ? 0 : flight.others[vehicle - 1].number;
}

/// To what stands by a map, if any.
void regard_map(const planner::geometry::StaticMap* map, double map_up, const MotionSample& sample,
                std::optional<double>& least) {
  if (map == nullptr) return;
  const Vec3 place = vec(sample.position) - Vec3(0.0, 0.0, map_up);
  map->visit({place, place}, least.value_or(planner::base::kInfinity), [&](std::size_t i) {
    const planner::base::Track& track = map->tracks()[i];
    const Vec3 from = place - track.position;
    const double free =
        track.body.solid == nullptr ? from.norm() - track.radius : planner::verify::solid_distance(track.body, from);
    if (!least || free < *least) least = free;
    return *least;
  });
}

/// To the nearest of the other vehicles at that very time.
void regard_vehicles(const FlightData& flight, std::size_t own, const MotionSample& sample,
                     std::optional<double>& least) {
  for (std::size_t k = 0; k <= flight.others.size(); ++k) {
    if (k == own) continue;
    const std::vector<MotionSample>& truth = truth_of(flight, k);
    const auto there =
        std::lower_bound(truth.begin(), truth.end(), sample.t, [](const MotionSample& m, double t) { return m.t < t; });
    if (there == truth.end() || there->t != sample.t) continue;
    const double free =
        distance(there->position, sample.position) - vehicle_radius(flight, number_of(flight, k)).value_or(0.0);
    if (!least || free < *least) least = free;
  }
}

/// The outcome as the log's own events tell it: `replay` names the outcome, `fly` ends with "phase" "done: OUTCOME,
/// ...".
Json outcome_of(const FlightData& flight) {
  static constexpr std::string_view kOutcomes[] = {"reached",    "collision",     "timeout",
                                                   "left_world", "start_blocked", "aborted"};
  static constexpr std::string_view kDone = "done: ";
  for (auto event = flight.events.rbegin(); event != flight.events.rend(); ++event) {
    for (const std::string_view outcome : kOutcomes) {
      if (event->name == outcome) return {{"outcome", outcome}, {"reason", event->detail}};
      if (event->name != "phase" || !event->detail.starts_with(kDone)) continue;
      const std::string rest = event->detail.substr(kDone.size());
      if (!rest.starts_with(outcome)) continue;
      const std::size_t comma = rest.find(", ");
      return {{"outcome", outcome}, {"reason", comma == std::string::npos ? "" : rest.substr(comma + 2)}};
    }
  }
  return Json::object();
}

/// The summary's figures as far as the log alone holds them, over the whole log.
Json derived_json(const FlightData& flight, const std::vector<MotionSample>& vehicle) {
  Json derived = outcome_of(flight);
  if (!vehicle.empty()) {
    double length = 0.0, fastest = 0.0;
    for (std::size_t i = 0; i < vehicle.size(); ++i) {
      if (i > 0) length += distance(vehicle[i - 1].position, vehicle[i].position);
      fastest = std::max(fastest, norm(vehicle[i].velocity));
    }
    derived["path_length"] = length;
    derived["max_speed"] = fastest;
  }
  derived["log_duration_s"] = flight.last - flight.first;
  if (flight.plans.empty()) return derived;
  std::vector<double> ms;
  for (const PlanRecord& plan : flight.plans) ms.push_back(plan.ms);
  std::sort(ms.begin(), ms.end());
  const auto rank = [&](double share) {  // nearest rank, as in the flight summary
    const double place = std::ceil(share * static_cast<double>(ms.size()));
    return ms[static_cast<std::size_t>(std::max(0.0, place - 1.0))];
  };
  derived["plans"] = ms.size();
  derived["deadline_misses"] =
      std::count_if(flight.plans.begin(), flight.plans.end(), [](const PlanRecord& p) { return p.missed; });
  derived["plan_ms"] = {{"p50", rank(0.5)}, {"p99", rank(0.99)}, {"max", ms.back()}};
  return derived;
}

}  // namespace

std::vector<std::size_t> thin(std::span<const double> t, double interval) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (kept.empty() || t[i] - t[kept.back()] >= interval - kSlack) kept.push_back(i);
  }
  if (!t.empty() && kept.back() != t.size() - 1) kept.push_back(t.size() - 1);
  return kept;
}

std::vector<ClearanceSample> true_clearance(const FlightData& flight, std::size_t vehicle) {
  const double radius = vehicle_radius(flight, number_of(flight, vehicle)).value_or(0.0);
  std::vector<ClearanceSample> result;
  auto frame = flight.obstacles.begin();
  for (const MotionSample& sample : truth_of(flight, vehicle)) {
    while (frame != flight.obstacles.end() && frame->t < sample.t) ++frame;
    std::optional<double> least;
    if (frame != flight.obstacles.end() && frame->t == sample.t) {
      for (const Body& body : frame->bodies) {
        const double free = surface_distance(flight, body, sample.t, sample.position);
        if (!least || free < *least) least = free;
      }
    }
    regard_map(flight.map.get(), flight.map_up, sample, least);
    regard_vehicles(flight, vehicle, sample, least);
    if (least) result.push_back({sample.t, *least - radius});
  }
  return result;
}

std::vector<ClearanceSample> tracked_clearance(const FlightData& flight) {
  const double radius = vehicle_radius(flight).value_or(0.0);
  std::vector<ClearanceSample> result;
  auto state = flight.states.begin();
  for (const BodyFrame& frame : flight.tracks) {
    while (state != flight.states.end() && state->t <= frame.t) ++state;
    if (state == flight.states.begin()) continue;
    const MotionSample& newest = *std::prev(state);
    if (frame.t - newest.t > kOldestState) continue;
    std::optional<double> least = nearest_track(newest.position, frame, newest.t - frame.t);
    for (const planner::geometry::StaticMap* map : {flight.map.get(), seen_at(flight, newest.t)})
      regard_map(map, flight.map_up, newest, least);
    if (least) result.push_back({newest.t, *least - radius});
  }
  return result;
}

Json report_data(const FlightData& flight, const Json* summary) {
  const double interval = interval_of(flight);
  const bool truth = !flight.truth.empty();
  const std::vector<MotionSample>& vehicle = truth ? flight.truth : flight.states;
  const std::vector<ClearanceSample> exact = true_clearance(flight);
  Json events = Json::array();
  constexpr std::array<const char*, 4> kTones{"", "good", "warn", "bad"};
  for (const EventRecord& event : flight.events)
    events.push_back({seconds(event.t), event.name, event.detail,
                      kTones.at(static_cast<std::size_t>(event_severity(event.name, event.detail)))});
  Json data;
  data["header"] = flight.header;
  data["header"].erase("shapes");
  data["header"].erase("map");
  data["header"].erase("stands");
  data["log"] = {{"lines", flight.lines},
                 {"cut_off", flight.cut_off},
                 {"not_finite", flight.not_finite},
                 {"unknown", flight.unknown},
                 {"interval", interval}};
  data["t"] = {seconds(flight.first), seconds(flight.last)};
  data["vehicle"] = motion_json(vehicle, interval);
  data["vehicle"]["from"] = truth ? "truth" : "state";
  const std::optional<double> radius = vehicle_radius(flight);
  data["vehicle"]["radius"] = radius ? Json(*radius) : Json();
  data["others"] = Json::array();
  for (std::size_t k = 1; k <= flight.others.size(); ++k) {
    Json other = motion_json(flight.others[k - 1].truth, interval);
    const std::optional<double> size = vehicle_radius(flight, flight.others[k - 1].number);
    other["number"] = flight.others[k - 1].number;
    other["radius"] = size ? Json(*size) : Json();
    other["clearance"] = clearance_json(true_clearance(flight, k), interval, "true");
    data["others"].push_back(std::move(other));
  }
  data["shapes"] = shapes_json(flight.shapes);
  const planner::base::Box part = shown_part(vehicle, flight.map_up);
  data["map"] = map_json(flight, part);
  data["seen"] = seen_json(flight, part);
  data["setpoints"] = motion_json(flight.setpoints, interval);
  data["obstacles"] = frames_json(flight.obstacles, interval, false);
  data["tracks"] = frames_json(flight.tracks, interval, true);
  data["plans"] = plans_json(flight.plans);
  data["events"] = std::move(events);
  data["clearance"] = exact.empty() ? clearance_json(tracked_clearance(flight), interval, "tracks")
                                    : clearance_json(exact, interval, "true");
  data["summary"] = summary != nullptr ? *summary : Json();
  data["derived"] = derived_json(flight, vehicle);
  return data;
}

}  // namespace jink::tools::report
