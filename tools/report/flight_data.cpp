// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/flight_data.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/log/log_reader.hpp"
#include "tools/log/map_record.hpp"

namespace jink::tools::report {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument(what);
}

Triple triple_of(const Json& record, const char* key) {
  return log::numbers<3>(log::member(record, key), key);
}

Body body_of(const Json& record, bool moving) {
  const Json& id = log::member(record, "id");
  if (!id.is_number_integer()) refuse("\"id\" is not a whole number");
  Body body{id.get<std::uint64_t>(), triple_of(record, "p"), {}, log::number_of(record, "radius")};
  if (!moving) return body;
  body.velocity = triple_of(record, "v");
  if (record.contains("a")) body.acceleration = triple_of(record, "a");
  if (record.contains("age")) body.age = log::number_of(record, "age");
  return body;
}

// As config::load_scenario bounds them.
constexpr double kLargest = 1e3;   // m, edge
constexpr double kFarthest = 2e5;  // m, vertex from the centre
constexpr double kTurned = 1e3;    // rad
constexpr double kTurnRate = 100;  // rad/s
constexpr std::size_t kMostVertices = 10000;
constexpr std::size_t kMostVehicles = 100;
constexpr double kSeenInterval = 0.5;  // s

Triple bounded(const Json& value, const char* key, double low, double high) {
  const Triple v = log::numbers<3>(value, key);
  for (const double x : v) {
    if (!(x >= low && x <= high)) refuse("\"" + std::string(key) + "\" is out of range");
  }
  return v;
}

double bounded_number(const Json& record, const char* key, double low, double high) {
  const double x = log::number_of(record, key);
  if (!(x >= low && x <= high)) refuse("\"" + std::string(key) + "\" is out of range");
  return x;
}

config::Shape shape_of(const Json& record) {
  if (const auto box = record.find("box"); box != record.end()) {
    const Triple e = bounded(*box, "box", 0.0, kLargest);
    return config::BoxShape{{e[0], e[1], e[2]}};
  }
  if (const auto cylinder = record.find("cylinder"); cylinder != record.end()) {
    return config::CylinderShape{bounded_number(*cylinder, "radius", 0.0, kLargest),
                                 bounded_number(*cylinder, "height", 0.0, kLargest)};
  }
  if (const auto capsule = record.find("capsule"); capsule != record.end()) {
    const Triple a = bounded(log::member(*capsule, "a"), "a", -kFarthest, kFarthest);
    const Triple b = bounded(log::member(*capsule, "b"), "b", -kFarthest, kFarthest);
    return config::CapsuleShape{
        bounded_number(*capsule, "radius", 0.0, kLargest), {a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
  }
  config::VertexShape hull;
  const Json& list = log::list_of(record, "vertices");
  if (list.empty() || list.size() > kMostVertices) refuse("\"vertices\" is not a list of 1 to 10000 points");
  for (const Json& vertex : list) {
    const Triple v = bounded(vertex, "vertices", -kFarthest, kFarthest);
    hull.vertices.emplace_back(v[0], v[1], v[2]);
  }
  return hull;
}

std::map<std::uint64_t, config::Obstacle> shapes_of(const Json& header) {
  std::map<std::uint64_t, config::Obstacle> shapes;
  if (!header.contains("shapes")) return shapes;
  for (const Json& record : log::list_of(header, "shapes")) {
    if (!record.is_object()) refuse("\"shapes\" holds what is no object");
    config::Obstacle& obstacle = shapes[log::count_of(record, "id")];
    obstacle.shape = shape_of(record);
    if (const auto turned = record.find("orientation"); turned != record.end()) {
      const Triple angles = bounded(*turned, "orientation", -kTurned, kTurned);
      obstacle.orientation = {angles[0], angles[1], angles[2]};
    }
    if (record.contains("yaw_rate")) obstacle.yaw_rate = bounded_number(record, "yaw_rate", -kTurnRate, kTurnRate);
  }
  return shapes;
}

/// What the plan was made from, as far as it can be shown. Older logs have none of it.
void add_inputs(PlanRecord& plan, const Json& record) {
  const auto from = record.find("from");
  if (from == record.end() || !from->is_object()) return;
  if (from->contains("acceleration_trust"))
    plan.acceleration_trust = log::exact(log::member(*from, "acceleration_trust"), "acceleration_trust");
  if (from->contains("way")) {
    for (const Json& place : log::list_of(*from, "way")) plan.way.push_back(log::numbers<3>(place, "way"));
  }
  if (const auto map = from->find("map"); map != from->end()) plan.map_up = log::number_of(*map, "up");
  if (!from->contains("paths")) return;
  const double start = log::number_of(*from, "start");
  for (const Json& path : log::list_of(*from, "paths")) {
    KnownPathRecord known{log::count_of(path, "id"), log::exact(log::member(path, "radius"), "radius"), {}};
    const double offset = log::exact(log::member(path, "offset"), "offset");
    bool finite = std::isfinite(known.radius);
    for (const Json& item : log::list_of(path, "points")) {
      auto point = log::exact_numbers<4>(item, "points");
      point[0] += start - offset;
      finite = finite && std::all_of(point.begin(), point.end(), [](double x) { return std::isfinite(x); });
      known.points.push_back(point);
    }
    if (finite) plan.known_paths.push_back(std::move(known));
  }
}

/// Takes the records one by one. What it remembers is what makes several records one thing.
class Reader {
 public:
  explicit Reader(FlightData& flight) : data_(flight) {}

  void take(const Json& record) {
    const std::string type = log::text_of(record, "type");
    try {
      const double t = log::number_of(record, "t");
      if (!add(type, t, record)) {
        ++data_.unknown;
        return;
      }
      data_.first = any_ ? std::min(data_.first, t) : t;
      data_.last = any_ ? std::max(data_.last, t) : t;
      any_ = true;
    } catch (const log::NotFinite&) {
      ++data_.not_finite;
    } catch (const std::invalid_argument& error) {
      refuse(type + " " + error.what());
    }
  }

 private:
  bool add(const std::string& type, double t, const Json& record) {
    if (type == "truth") {
      const MotionSample sample{t, triple_of(record, "p"), triple_of(record, "v")};
      const std::uint64_t number = record.contains("vehicle") ? log::count_of(record, "vehicle") : 0;
      (number == 0 ? data_.truth : other(number)).push_back(sample);
    } else if (type == "obstacles") {
      const Body body = body_of(record, false);
      if (data_.obstacles.empty() || data_.obstacles.back().t != t) data_.obstacles.push_back({t, {}});
      data_.obstacles.back().bodies.push_back(body);
    } else if (type == "state") {
      data_.states.push_back({t, triple_of(record, "p"), triple_of(record, "v")});
      note_mode(t, record);
    } else if (type == "tracks") {
      BodyFrame frame{t, {}};
      for (const Json& track : log::list_of(record, "tracks")) frame.bodies.push_back(body_of(track, true));
      data_.tracks.push_back(std::move(frame));
    } else if (type == "plan") {
      PlanRecord plan;
      plan.t = t;
      plan.ms = log::number_of(record, "ms");
      plan.status = log::text_of(record, "status");
      plan.kept = log::flag_of(record, "kept");
      plan.missed = log::flag_of(record, "missed");
      for (const Json& point : log::list_of(record, "path")) plan.path.push_back(log::numbers<4>(point, "path"));
      add_inputs(plan, record);
      data_.plans.push_back(std::move(plan));
    } else if (type == "seen") {
      seen_ = log::seen_of(record, seen_.get(), nullptr);
      if (data_.seen.empty() || t - data_.seen.back().t >= kSeenInterval) data_.seen.push_back({t, nullptr});
      data_.seen.back().map = seen_->map;
    } else if (type == "setpoint") {
      data_.setpoints.push_back({t, triple_of(record, "p"), triple_of(record, "v")});
    } else if (type == "event") {
      data_.events.push_back({t, log::text_of(record, "name"), log::text_of(record, "detail")});
    } else {
      return false;
    }
    return true;
  }

  std::vector<MotionSample>& other(std::uint64_t number) {
    const auto place = std::find_if(data_.others.begin(), data_.others.end(),
                                    [number](const OtherVehicle& v) { return v.number >= number; });
    if (place != data_.others.end() && place->number == number) return place->truth;
    if (data_.others.size() >= kMostVehicles) refuse("\"vehicle\" is the number of more than 100 vehicles");
    return data_.others.insert(place, {number, {}})->truth;
  }

  void note_mode(double t, const Json& record) {
    std::string mode = log::text_of(record, "mode") + (log::flag_of(record, "armed") ? ", armed" : ", disarmed");
    if (mode == mode_) return;
    data_.events.push_back({t, "mode", mode});
    mode_ = std::move(mode);
  }

  FlightData& data_;
  bool any_ = false;
  std::string mode_;
  std::shared_ptr<const bridge::map::Seen> seen_;
};

}  // namespace

std::optional<double> vehicle_radius(const FlightData& flight, std::uint64_t number) {
  const Json* vehicle = nullptr;
  if (const auto several = flight.header.find("vehicles"); several != flight.header.end() && several->is_array()) {
    if (number < several->size()) vehicle = &(*several)[number];
  } else if (const auto one = flight.header.find("vehicle"); one != flight.header.end()) {
    vehicle = &*one;
  }
  if (vehicle == nullptr || !vehicle->is_object()) return std::nullopt;
  const auto radius = vehicle->find("radius");
  if (radius == vehicle->end() || !radius->is_number()) return std::nullopt;
  return radius->get<double>();
}

const planner::geometry::StaticMap* seen_at(const FlightData& flight, double t) {
  const auto next = std::upper_bound(flight.seen.begin(), flight.seen.end(), t,
                                     [](double time, const SeenRecord& record) { return time < record.t; });
  return next == flight.seen.begin() ? nullptr : std::prev(next)->map.get();
}

FlightData read_flight(const std::filesystem::path& log) {
  log::LogReader lines(log);
  FlightData flight;
  flight.header = lines.header();
  try {
    flight.map = log::map_of(flight.header, flight.header.contains("stands") ? "stands" : "map");
    flight.shapes = shapes_of(flight.header);
  } catch (const log::NotFinite&) {
    lines.fail("header \"shapes\" holds a number that is not finite");
  } catch (const std::invalid_argument& error) {
    lines.fail(std::string("header ") + error.what());
  }
  Reader reader(flight);
  for (Json record; lines.next(record);) {
    try {
      reader.take(record);
    } catch (const std::invalid_argument& error) {
      lines.fail(error.what());
    }
  }
  for (auto plan = flight.plans.rbegin(); plan != flight.plans.rend(); ++plan)
    flight.map_up = plan->map_up.value_or(flight.map_up);
  flight.lines = lines.lines();
  flight.cut_off = lines.cut_off() ? 1 : 0;
  return flight;
}

}  // namespace jink::tools::report
