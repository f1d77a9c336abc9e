// SPDX-License-Identifier: BSD-3-Clause
#include "config/faults.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "config/fault_reader.hpp"

namespace jink::config {
namespace {

constexpr std::size_t kMostFaults = 1000;
constexpr Range kTime = closed(0, 1e6);
constexpr Range kDuration = above(0, 1e6);
constexpr int kMostFlooded = 20000;

/// One kind: its name, what sets it apart, and the keys of its own.
struct Kind {
  std::string_view name;
  bool instantaneous = false;
  bool of_vehicle = false;
  std::array<std::string_view, 2> keys{};
};

/// In the order of FaultKind.
constexpr std::array<Kind, 19> kKinds = {{
    {"link_loss", false, true, {"direction"}},
    {"packet_loss", false, true, {"rate", "direction"}},
    {"delay", false, true, {"seconds", "direction"}},
    {"reorder", false, true, {"rate", "direction"}},
    {"gps_loss", false, true},
    {"estimate_jump", true, true, {"by"}},
    {"tracks_stop"},
    {"tracks_freeze"},
    {"track_noise", false, false, {"position", "velocity"}},
    {"id_swap"},
    {"tracks_garbage"},
    {"tracks_flood", false, false, {"count"}},
    {"tracks_self", false, true},
    {"tracks_clock", false, false, {"offset"}},
    {"reboot", true, true},
    {"pilot_mode", true, true, {"mode"}},
    {"low_battery", false, true, {"remaining"}},
    {"refuse_arming", false, true},
    {"refuse_offboard", false, true},
}};
constexpr std::array<std::string_view, 3> kDirections = {"both", "up", "down"};
constexpr std::array<std::string_view, 6> kModes = {"hold", "position", "altitude", "land", "return", "manual"};

const Kind& kind_of(FaultKind kind) {
  return kKinds.at(static_cast<std::size_t>(kind));
}

std::vector<std::string_view> names_of_kinds() {
  std::vector<std::string_view> names;
  names.reserve(kKinds.size());
  for (const Kind& kind : kKinds) names.push_back(kind.name);
  return names;
}

std::vector<std::string_view> keys_of(const Kind& kind) {
  std::vector<std::string_view> keys{"at", "kind"};
  if (!kind.instantaneous) keys.emplace_back("for");
  if (kind.of_vehicle) keys.emplace_back("vehicle");
  for (const std::string_view key : kind.keys) {
    if (!key.empty()) keys.push_back(key);
  }
  return keys;
}

/// Every key of every kind, to find a misspelled `kind` first.
std::vector<std::string_view> all_keys() {
  std::vector<std::string_view> keys{"at", "kind", "for", "vehicle"};
  for (const Kind& kind : kKinds) {
    for (const std::string_view key : kind.keys) {
      if (!key.empty() && std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

void read_track_noise(const Map& map, Fault& fault) {
  if (!map.has("position") && !map.has("velocity")) {
    map.value().fail("has no noise; expected position (m), velocity (m/s) or both");
  }
  fault.position = map.number_or("position", closed(0, 1000), 0.0);
  fault.velocity = map.number_or("velocity", closed(0, 1000), 0.0);
}

/// The keys that are the kind's own.
void read_own(const Map& map, Fault& fault) {
  if (const auto direction = map.find("direction"))
    fault.direction = static_cast<LinkDirection>(direction->choice(kDirections));
  switch (fault.kind) {
    case FaultKind::kPacketLoss:
    case FaultKind::kReorder:
      fault.rate = map.number("rate", closed(0, 1));
      break;
    case FaultKind::kDelay:
      fault.seconds = map.number("seconds", closed(0, 60));
      break;
    case FaultKind::kEstimateJump:
      fault.by = map.vec3("by", within(1e4));
      break;
    case FaultKind::kTrackNoise:
      read_track_noise(map, fault);
      break;
    case FaultKind::kTracksFlood:
      fault.count = map.integer("count", closed(1, kMostFlooded));
      break;
    case FaultKind::kTracksClock:
      fault.offset = map.number("offset", within(1e8));
      break;
    case FaultKind::kPilotMode:
      fault.mode = static_cast<PilotMode>(map.at("mode", "one of " + join(kModes)).choice(kModes));
      break;
    case FaultKind::kLowBattery:
      fault.remaining = map.number("remaining", closed(0, 1));
      break;
    default:
      break;
  }
}

Fault read_fault(const Value& value, int vehicles) {
  const std::vector<std::string_view> names = names_of_kinds();
  const Map any(value, all_keys());
  Fault fault;
  fault.kind = static_cast<FaultKind>(any.at("kind", "one of " + join(names)).choice(names));
  if (const auto duration = any.find("for"); duration && fault.instantaneous()) {
    duration->fail("stands at " + std::string(to_string(fault.kind)) + ", which happens at once; expected no 'for'");
  }
  const Map map(value, keys_of(kind_of(fault.kind)));
  fault.at = map.number("at", kTime);
  if (const auto duration = map.find("for")) fault.duration = duration->number(kDuration);
  if (const auto vehicle = map.find("vehicle")) fault.vehicle = vehicle->integer(closed(0, vehicles - 1));
  read_own(map, fault);
  return fault;
}

}  // namespace

std::string_view to_string(FaultKind kind) {
  return kind_of(kind).name;
}

bool Fault::instantaneous() const {
  return kind_of(kind).instantaneous;
}

bool Fault::of_vehicle() const {
  return kind_of(kind).of_vehicle;
}

std::string Fault::text() const {
  std::string text(to_string(kind));
  const auto say = [&](std::string_view key, double number) {
    text += ", " + std::string(key) + " " + number_text(number);
  };
  for (const std::string_view key : kind_of(kind).keys) {
    if (key == "rate") say(key, rate);
    if (key == "seconds") say(key, seconds);
    if (key == "position") say(key, position);
    if (key == "velocity") say(key, velocity);
    if (key == "count") say(key, count);
    if (key == "offset") say(key, offset);
    if (key == "remaining") say(key, remaining);
    if (key == "by") text += ", by " + vector_text(by);
    if (key == "mode") text += ", " + std::string(kModes.at(static_cast<std::size_t>(mode)));
    if (key == "direction" && direction != LinkDirection::kBoth)
      text += ", " + std::string(kDirections.at(static_cast<std::size_t>(direction)));
  }
  if (duration) text += ", for " + number_text(*duration) + " s";
  if (vehicle) text += ", vehicle " + std::to_string(*vehicle);
  return text;
}

std::string fault_text(const Fault& fault) {
  std::string text = "{at: " + number_text(fault.at) + ", kind: " + std::string(to_string(fault.kind));
  const auto add = [&](std::string_view key, const std::string& value) {
    text.append(", ").append(key).append(": ").append(value);
  };
  if (fault.duration) add("for", number_text(*fault.duration));
  if (fault.vehicle) add("vehicle", std::to_string(*fault.vehicle));
  for (const std::string_view key : kind_of(fault.kind).keys) {
    if (key == "direction") add(key, std::string(kDirections.at(static_cast<std::size_t>(fault.direction))));
    if (key == "rate") add(key, number_text(fault.rate));
    if (key == "seconds") add(key, number_text(fault.seconds));
    if (key == "by") add(key, vector_text(fault.by));
    if (key == "position") add(key, number_text(fault.position));
    if (key == "velocity") add(key, number_text(fault.velocity));
    if (key == "count") add(key, std::to_string(fault.count));
    if (key == "offset") add(key, number_text(fault.offset));
    if (key == "mode") add(key, std::string(kModes.at(static_cast<std::size_t>(fault.mode))));
    if (key == "remaining") add(key, number_text(fault.remaining));
  }
  return text + "}";
}

std::vector<Fault> read_faults(const Value& value, int vehicles) {
  std::vector<Fault> faults;
  for (const Value& item : value.list(0, kMostFaults)) faults.push_back(read_fault(item, vehicles));
  return faults;
}

}  // namespace jink::config
