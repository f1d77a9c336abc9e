// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/flight_data.hpp"

#include <algorithm>
#include <stdexcept>

#include "tools/report/log_lines.hpp"

namespace jink::tools {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument(what);
}

Triple triple_of(const Json& record, const char* key) {
  return numbers<3>(member(record, key), key);
}

Body body_of(const Json& record, bool moving) {
  const Json& id = member(record, "id");
  if (!id.is_number_integer()) refuse("\"id\" is not a whole number");
  Body body{id.get<std::uint64_t>(), triple_of(record, "p"), {}, number_of(record, "radius")};
  if (moving) body.velocity = triple_of(record, "v");
  return body;
}

/// Takes the records one by one. What it remembers is what makes several records one thing.
class Reader {
 public:
  explicit Reader(FlightData& flight) : data_(flight) {}

  void take(const Json& record) {
    const std::string type = text_of(record, "type");
    try {
      const double t = number_of(record, "t");
      if (!add(type, t, record)) {
        ++data_.unknown;
        return;
      }
      data_.first = any_ ? std::min(data_.first, t) : t;
      data_.last = any_ ? std::max(data_.last, t) : t;
      any_ = true;
    } catch (const NotFinite&) {
      ++data_.not_finite;
    } catch (const std::invalid_argument& error) {
      refuse(type + " " + error.what());
    }
  }

 private:
  bool add(const std::string& type, double t, const Json& record) {
    if (type == "truth") {
      // The report shows one flight: of several vehicles in a simulator's log, the first.
      if (const auto vehicle = record.find("vehicle"); vehicle != record.end() && *vehicle != 0) return true;
      data_.truth.push_back({t, triple_of(record, "p"), triple_of(record, "v")});
    } else if (type == "obstacles") {
      const Body body = body_of(record, false);
      if (data_.obstacles.empty() || data_.obstacles.back().t != t) data_.obstacles.push_back({t, {}});
      data_.obstacles.back().bodies.push_back(body);
    } else if (type == "state") {
      data_.states.push_back({t, triple_of(record, "p"), triple_of(record, "v")});
      note_mode(t, record);
    } else if (type == "tracks") {
      BodyFrame frame{t, {}};
      for (const Json& track : list_of(record, "tracks")) frame.bodies.push_back(body_of(track, true));
      data_.tracks.push_back(std::move(frame));
    } else if (type == "plan") {
      PlanRecord plan{
          t, number_of(record, "ms"), text_of(record, "status"), flag_of(record, "kept"), flag_of(record, "missed"),
          {}};
      for (const Json& point : list_of(record, "path")) plan.path.push_back(numbers<4>(point, "path"));
      data_.plans.push_back(std::move(plan));
    } else if (type == "setpoint") {
      data_.setpoints.push_back({t, triple_of(record, "p"), triple_of(record, "v")});
    } else if (type == "event") {
      data_.events.push_back({t, text_of(record, "name"), text_of(record, "detail")});
    } else {
      return false;
    }
    return true;
  }

  void note_mode(double t, const Json& record) {
    std::string mode = text_of(record, "mode") + (flag_of(record, "armed") ? ", armed" : ", disarmed");
    if (mode == mode_) return;
    data_.events.push_back({t, "mode", mode});
    mode_ = std::move(mode);
  }

  FlightData& data_;
  bool any_ = false;
  std::string mode_;
};

}  // namespace

FlightData read_flight(const std::filesystem::path& log) {
  LogLines lines(log);
  FlightData flight;
  flight.header = lines.header();
  Reader reader(flight);
  for (Json record; lines.next(record);) {
    try {
      reader.take(record);
    } catch (const std::invalid_argument& error) {
      lines.fail(error.what());
    }
  }
  flight.lines = lines.lines();
  flight.cut_off = lines.cut_off() ? 1 : 0;
  return flight;
}

}  // namespace jink::tools
