// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/flight_data.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>

namespace jink::tools {
namespace {

using Json = nlohmann::json;

/// A record that holds null where a number belongs: the log's way to write one that is not finite.
struct NotFinite {};

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument(what);
}

const Json& member(const Json& record, const char* key) {
  const auto found = record.find(key);
  if (found == record.end()) refuse(std::string("has no \"") + key + "\"");
  return *found;
}

double number(const Json& value, const char* key) {
  if (value.is_null()) throw NotFinite{};
  if (!value.is_number()) refuse(std::string("\"") + key + "\" is not a number");
  const double x = value.get<double>();
  if (!std::isfinite(x)) throw NotFinite{};
  return x;
}

double number_of(const Json& record, const char* key) {
  return number(member(record, key), key);
}

template <std::size_t N>
std::array<double, N> numbers(const Json& value, const char* key) {
  if (!value.is_array() || value.size() != N) {
    refuse(std::string("\"") + key + "\" is not a list of " + std::to_string(N) + " numbers");
  }
  std::array<double, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = number(value[i], key);
  return result;
}

Triple triple_of(const Json& record, const char* key) {
  return numbers<3>(member(record, key), key);
}

std::string text_of(const Json& record, const char* key) {
  const Json& value = member(record, key);
  if (!value.is_string()) refuse(std::string("\"") + key + "\" is not text");
  return value.get<std::string>();
}

bool flag_of(const Json& record, const char* key) {
  const auto found = record.find(key);
  if (found == record.end()) return false;
  if (!found->is_boolean()) refuse(std::string("\"") + key + "\" is not true or false");
  return found->get<bool>();
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

  void header(const Json& record) {
    if (!record.is_object() || record.value("type", Json()) != "header")
      refuse("the first line is not a jink-log/1 header");
    const Json format = record.value("format", Json());
    if (format != "jink-log/1") refuse("format: " + format.dump() + " is not \"jink-log/1\"");
    data_.header = record;
  }

  void take(const Json& record) {
    if (!record.is_object()) refuse("is not a JSON object");
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
      const Json& tracks = member(record, "tracks");
      if (!tracks.is_array()) refuse("\"tracks\" is not a list");
      for (const Json& track : tracks) frame.bodies.push_back(body_of(track, true));
      data_.tracks.push_back(std::move(frame));
    } else if (type == "plan") {
      PlanRecord plan{
          t, number_of(record, "ms"), text_of(record, "status"), flag_of(record, "kept"), flag_of(record, "missed"),
          {}};
      const Json& path = member(record, "path");
      if (!path.is_array()) refuse("\"path\" is not a list");
      for (const Json& point : path) plan.path.push_back(numbers<4>(point, "path"));
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
  std::ifstream in(log, std::ios::binary);
  if (!in) throw std::runtime_error(log.string() + ": cannot read the flight log");
  FlightData flight;
  Reader reader(flight);
  std::size_t line_number = 0;
  std::size_t broken = 0;  // the line that is no JSON; an error only once another follows it
  const auto fail = [&](std::size_t line, const std::string& what) {
    throw std::runtime_error(log.string() + ":" + std::to_string(line) + ": " + what);
  };
  for (std::string line; std::getline(in, line);) {
    ++line_number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (broken != 0) fail(broken, "is not JSON");
    ++flight.lines;
    const Json record = Json::parse(line, nullptr, false);
    if (record.is_discarded()) {
      broken = line_number;
      if (flight.header.is_null()) fail(line_number, "the first line is not a jink-log/1 header");
      continue;
    }
    try {
      if (flight.header.is_null()) {
        reader.header(record);
      } else {
        reader.take(record);
      }
    } catch (const std::invalid_argument& error) {
      fail(line_number, error.what());
    }
  }
  if (in.bad()) throw std::runtime_error(log.string() + ": cannot be read to its end");
  if (flight.header.is_null()) fail(1, "the first line is not a jink-log/1 header: the file is empty");
  flight.cut_off = broken != 0 ? 1 : 0;
  return flight;
}

}  // namespace jink::tools
