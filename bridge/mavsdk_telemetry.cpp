// SPDX-License-Identifier: BSD-3-Clause
// What comes in over MavsdkLink, message by message. The handlers run on MAVSDK's callback thread.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bridge/frames.hpp"
#include "bridge/mavsdk_link_impl.hpp"

namespace jink::bridge {

namespace {

using nlohmann::json;

constexpr std::uint32_t kMessageAttitude = 30;  // message ids of common.xml
constexpr std::uint32_t kMessageLocalPosition = 32;
constexpr std::uint32_t kMessageOrigin = 49;
constexpr std::uint32_t kMessageVersion = 148;
constexpr std::uint32_t kMessageOdometry = 331;
constexpr double kRateTolerance = 0.8;  // of the rate asked for: slower than this is asked for again
constexpr int kOdometryRequests = 5;    // to an autopilot that has never sent any
constexpr std::size_t kNotices = 64;
constexpr std::size_t kAdsbReports = 1024;
constexpr std::size_t kParameters = 4096;       // more than any autopilot has
constexpr std::uint32_t kRcReceiver = 0x10000;  // MAV_SYS_STATUS_SENSOR_RC_RECEIVER
constexpr double kMostMetres = 1e5;             // of a local position: beyond it an estimator has lost its mind
constexpr double kMostSpeed = 1e3;              // m/s
constexpr double kDegreesE7 = 1e7;
constexpr double kPerMetre_mm = 1e3;
constexpr double kPerMetre_cm = 1e2;

struct StreamSpec {
  const char* message;
  std::uint32_t id;  // 0: not asked for
  double hz;
};
constexpr std::array<StreamSpec, 4> kStreamSpecs{
    {{"HEARTBEAT", 0, 1.0},
     {"LOCAL_POSITION_NED", kMessageLocalPosition, MavsdkLink::kTelemetryHz},
     {"ATTITUDE", kMessageAttitude, MavsdkLink::kTelemetryHz},
     {"ODOMETRY", kMessageOdometry, MavsdkLink::kOdometryHz}}};

// NaN where the field is missing or not a number (a NaN on the wire comes as null).
double number(const json& fields, const char* key) {
  const auto field = fields.find(key);
  return field != fields.end() && field->is_number() ? field->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Vec3 vector(const json& fields, const char* x, const char* y, const char* z) {
  return {number(fields, x), number(fields, y), number(fields, z)};
}

// An unsigned field of at most 32 bits; false when it is missing or out of range.
bool read(const json& fields, const char* key, std::uint32_t& value) {
  const double v = number(fields, key);
  if (!(v >= 0.0 && v <= 4294967295.0)) return false;
  value = static_cast<std::uint32_t>(v);
  return true;
}

bool read(const json& fields, const char* key, std::int64_t& value) {
  const auto field = fields.find(key);
  if (field == fields.end() || !field->is_number_integer()) return false;
  value = field->get<std::int64_t>();
  return true;
}

std::string text(const json& fields, const char* key) {
  const auto field = fields.find(key);
  return field != fields.end() && field->is_string() ? field->get<std::string>() : std::string();
}

// ODOMETRY's velocity in NED: as it stands (child frame LOCAL_NED, as PX4 has it) or turned from the body's axes; NaN
// for any other frame.
Vec3 odometry_velocity_ned(const json& fields) {
  const Vec3 velocity = vector(fields, "vx", "vy", "vz");
  std::uint32_t child_frame = 0;
  (void)read(fields, "child_frame_id", child_frame);
  constexpr std::uint32_t kLocalNed = 1;
  constexpr std::uint32_t kBodyNed = 8;
  constexpr std::uint32_t kBodyFrd = 12;
  if (child_frame == kLocalNed) return velocity;
  const auto q = fields.find("q");
  const bool turned = (child_frame == kBodyNed || child_frame == kBodyFrd) && q != fields.end() && q->is_array() &&
                      q->size() == 4 && std::all_of(q->begin(), q->end(), [](const json& c) { return c.is_number(); });
  if (!turned) return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Eigen::Quaterniond attitude((*q)[0].get<double>(), (*q)[1].get<double>(), (*q)[2].get<double>(),
                                    (*q)[3].get<double>());
  return attitude.normalized() * velocity;
}

}  // namespace

std::vector<MavsdkLink::Impl::Interest> MavsdkLink::Impl::interests() {
  return {
      {"HEARTBEAT", &Impl::on_heartbeat},
      {"LOCAL_POSITION_NED", &Impl::on_local_position},
      {"ATTITUDE", &Impl::on_attitude},
      {"ODOMETRY", &Impl::on_odometry},
      {"SYS_STATUS", &Impl::on_sys_status},
      {"EXTENDED_SYS_STATE", &Impl::on_extended_sys_state},
      {"ESTIMATOR_STATUS", &Impl::on_estimator_status},
      {"BATTERY_STATUS", &Impl::on_battery_status},
      {"GPS_GLOBAL_ORIGIN", &Impl::on_origin},
      {"COMMAND_ACK", &Impl::on_command_ack},
      {"AUTOPILOT_VERSION", &Impl::on_version},
      {"TIMESYNC", &Impl::on_timesync},
      {"PARAM_VALUE", &Impl::on_parameter},
      {"STATUSTEXT", &Impl::on_status_text},
      {"ADSB_VEHICLE", &Impl::on_adsb_vehicle, From::kAnyComponent},
  };
}

// A request that is lost, refused or not followed is made again at the next heartbeat.
void MavsdkLink::Impl::request_streams(const std::array<bool, kStreams>& slow) const {
  for (std::size_t i = 0; i < kStreams; ++i) {
    if (slow[i]) (void)transmit(px4::message_interval(kStreamSpecs[i].id, kStreamSpecs[i].hz));
  }
}

void MavsdkLink::Impl::notice(std::string name, std::string detail) {
  if (notices_.size() == kNotices) notices_.pop_front();
  notices_.push_back({std::move(name), std::move(detail)});
}

void MavsdkLink::Impl::tally(Stream stream, double now) {
  ++heard_[stream];
  Tally& tally = tallies_[stream];
  if (tally.count == 0) tally.first = now;
  tally.largest_gap = std::max(tally.largest_gap, now - (tally.count == 0 ? rates_since_ : tally.last));
  tally.last = now;
  ++tally.count;
}

void MavsdkLink::Impl::restart_rates() {
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  tallies_.fill({});
  rates_since_ = now;
}

std::vector<StreamRate> MavsdkLink::Impl::rates() const {
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  std::vector<StreamRate> rates;
  for (std::size_t i = 0; i < kStreams; ++i) {
    const Tally& t = tallies_[i];
    StreamRate rate{kStreamSpecs[i].message, kStreamSpecs[i].hz, 0.0, t.largest_gap, t.count};
    if (t.count > 1) rate.measured_hz = static_cast<double>(t.count - 1) / (t.last - t.first);
    rate.largest_gap_s = std::max(rate.largest_gap_s, now - (t.count > 0 ? t.last : rates_since_));
    rates.push_back(rate);
  }
  return rates;
}

void MavsdkLink::Impl::restarted() {
  ++state_.reboots;
  notice("autopilot_rebooted", "its time began anew; its local origin may be another");
  resets_.restart();
  position_boot_ms_.reset();
  state_.origin.reset();
  state_.armable = false;
  state_.landed_state_known = false;
  sys_status_heard_ = false;
  failed_health_.clear();
  batteries_.clear();
  remaining_ = BatteryState::kUnknown;
  info_.version.reset();
  info_.battery_percent.reset();
}

// The autopilot's time, by which a reboot shows.
void MavsdkLink::Impl::boot_time(std::uint32_t boot_ms) {
  if (boot_ms_) {
    // The counter wraps after 49 days, and so does this difference.
    const auto later_ms = static_cast<std::int32_t>(boot_ms - *boot_ms_);
    if (later_ms < -static_cast<std::int32_t>(kReboot_s * 1e3)) {
      restarted();
    } else if (later_ms <= 0) {
      return;
    } else if (boot_ms < *boot_ms_) {
      resets_.restart();
    }
  }
  boot_ms_ = boot_ms;
}

void MavsdkLink::Impl::on_heartbeat(const Message& message) {
  std::uint32_t autopilot = 0;
  std::uint32_t base_mode = 0;
  std::uint32_t custom_mode = 0;
  std::uint32_t status = 0;
  const bool whole = read(message.fields, "autopilot", autopilot) && read(message.fields, "base_mode", base_mode) &&
                     read(message.fields, "custom_mode", custom_mode) && read(message.fields, "system_status", status);
  const double now = clock_.now();
  std::array<bool, kStreams> slow{};
  bool want_origin = false;
  bool want_version = false;
  {
    const std::scoped_lock lock(mutex_);
    if (!whole || autopilot == px4::kAutopilotInvalid) return malformed();
    for (std::size_t i = kLocalPosition; i < kStreams && state_.heartbeat_stamp >= 0.0; ++i) {
      const double wanted = kRateTolerance * kStreamSpecs[i].hz * (now - state_.heartbeat_stamp);
      slow[i] = static_cast<double>(heard_[i] - at_heartbeat_[i]) < wanted;
    }
    if (heard_[kOdometry] == 0 && slow[kOdometry]) slow[kOdometry] = ++odometry_requests_ <= kOdometryRequests;
    ++counts_.heartbeats;
    tally(kHeartbeat, now);
    at_heartbeat_ = heard_;
    state_.heartbeat_stamp = now;
    state_.armed = (base_mode & px4::kArmedFlag) != 0U;
    state_.mode = px4::flight_mode(static_cast<std::uint8_t>(autopilot), custom_mode);
    state_.failsafe = status >= px4::kStateCritical;
    info_.autopilot = autopilot;
    want_origin = !state_.origin;
    want_version = !info_.version;
    timesync_sent_ns_ = static_cast<std::int64_t>(now * 1e9);
  }
  if (!ready_) return;
  request_streams(slow);
  if (want_origin) (void)transmit(px4::request_message(kMessageOrigin));
  if (want_version) (void)transmit(px4::request_message(kMessageVersion));
  (void)transmit("TIMESYNC", {{"tc1", 0},
                              {"ts1", static_cast<std::int64_t>(now * 1e9)},
                              {"target_system", system_id_},
                              {"target_component", message.component}});
}

void MavsdkLink::Impl::on_other_heartbeat(const Message& message) {
  std::uint32_t autopilot = 0;
  if (!read(message.fields, "autopilot", autopilot) || autopilot == px4::kAutopilotInvalid) return;
  const std::scoped_lock lock(mutex_);
  if (!other_autopilots_.insert(message.system).second) return;
  counts_.other_autopilots = static_cast<std::uint32_t>(other_autopilots_.size());
  notice("second_autopilot", "system " + std::to_string(message.system) + " is an autopilot on this connection too; " +
                                 "this flight is with system " + std::to_string(system_id_) + " alone");
}

void MavsdkLink::Impl::on_local_position(const Message& message) {
  const Vec3 position_ned = vector(message.fields, "x", "y", "z");
  const Vec3 velocity_ned = vector(message.fields, "vx", "vy", "vz");
  std::uint32_t boot_ms = 0;
  const bool whole = position_ned.norm() <= kMostMetres && velocity_ned.norm() <= kMostSpeed &&
                     read(message.fields, "time_boot_ms", boot_ms);
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  boot_time(boot_ms);
  if (position_boot_ms_ && static_cast<std::int32_t>(boot_ms - *position_boot_ms_) < 0) {
    ++counts_.late;
    return;
  }
  position_boot_ms_ = boot_ms;
  ++counts_.positions;
  tally(kLocalPosition, now);
  state_.position_stamp = now;
  state_.position = enu_from_ned(position_ned);
  state_.velocity = enu_from_ned(velocity_ned);
  resets_.on_position({boot_ms * 1e-3, state_.position, state_.velocity});
}

void MavsdkLink::Impl::on_attitude(const Message& message) {
  const double heading = number(message.fields, "yaw");
  std::uint32_t boot_ms = 0;
  const bool whole = std::isfinite(heading) && read(message.fields, "time_boot_ms", boot_ms);
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  boot_time(boot_ms);
  ++counts_.attitudes;
  tally(kAttitude, now);
  state_.yaw = yaw_enu_from_heading(heading);
}

void MavsdkLink::Impl::on_odometry(const Message& message) {
  constexpr std::uint32_t kLocalNed = 1;
  const Vec3 position_ned = vector(message.fields, "x", "y", "z");
  const Vec3 velocity_ned = odometry_velocity_ned(message.fields);
  const double time_us = number(message.fields, "time_usec");
  std::uint32_t frame = 0;
  std::uint32_t counter = 0;
  const bool whole = read(message.fields, "frame_id", frame) && read(message.fields, "reset_counter", counter) &&
                     position_ned.allFinite() && velocity_ned.allFinite() && std::isfinite(time_us);
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  tally(kOdometry, now);
  if (frame != kLocalNed) return;  // of another frame: its counter is not this position's
  ++counts_.odometries;
  resets_.on_odometry({time_us * 1e-6, enu_from_ned(position_ned), enu_from_ned(velocity_ned)},
                      static_cast<std::uint8_t>(counter));
}

void MavsdkLink::Impl::on_sys_status(const Message& message) {
  std::uint32_t present = 0;
  std::uint32_t enabled = 0;
  std::uint32_t health = 0;
  const bool whole = read(message.fields, "onboard_control_sensors_present", present) &&
                     read(message.fields, "onboard_control_sensors_enabled", enabled) &&
                     read(message.fields, "onboard_control_sensors_health", health);
  const double remaining = number(message.fields, "battery_remaining");
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  sys_status_heard_ = true;
  failed_health_ = px4::failed_health(present, enabled, health);
  state_.armable = (health & px4::kPrearmCheck) != 0U;
  state_.gps_lost = (present & enabled & ~health & px4::kGps) != 0U;
  remaining_ = px4::battery_state_from_remaining(remaining);
  info_.battery_percent.reset();
  if (remaining_ != BatteryState::kUnknown) info_.battery_percent = remaining;
  info_.rc_receiver = (present & enabled & health & kRcReceiver) != 0U;
}

void MavsdkLink::Impl::on_extended_sys_state(const Message& message) {
  std::uint32_t landed_state = 0;
  const bool whole = read(message.fields, "landed_state", landed_state);
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  state_.in_air = px4::in_air(static_cast<int>(landed_state));
  state_.landed_state_known = true;
}

void MavsdkLink::Impl::on_estimator_status(const Message& message) {
  std::uint32_t flags = 0;
  const bool whole = read(message.fields, "flags", flags);
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  estimator_ok_ = px4::estimator_has_local_position(flags);
  info_.estimator = flags;
}

void MavsdkLink::Impl::on_battery_status(const Message& message) {
  std::uint32_t id = 0;
  std::uint32_t charge_state = 0;  // an extension field: absent from older autopilots
  const bool whole = read(message.fields, "id", id);
  (void)read(message.fields, "charge_state", charge_state);
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  batteries_[id] = px4::battery_state(charge_state);
}

void MavsdkLink::Impl::on_origin(const Message& message) {
  const Geodetic origin{number(message.fields, "latitude") / kDegreesE7,
                        number(message.fields, "longitude") / kDegreesE7,
                        number(message.fields, "altitude") / kPerMetre_mm};
  const bool whole = std::abs(origin.latitude_deg) <= 90.0 && std::abs(origin.longitude_deg) <= 180.0 &&
                     std::isfinite(origin.altitude_m);
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  state_.origin = origin;
}

void MavsdkLink::Impl::on_command_ack(const Message& message) {
  std::uint32_t command = 0;
  std::uint32_t result = 0;
  std::uint32_t target_system = 0;
  std::uint32_t target_component = 0;
  const bool whole = read(message.fields, "command", command) && read(message.fields, "result", result);
  // Extension fields, 0 from autopilots that do not send them: then the answer is taken as ours.
  (void)read(message.fields, "target_system", target_system);
  (void)read(message.fields, "target_component", target_component);
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  const bool ours = (target_system == 0 || target_system == own_system_id_) &&
                    (target_component == 0 || target_component == own_component_id_);
  if (ours) commands_.acknowledge(static_cast<std::uint16_t>(command), static_cast<int>(result), now);
}

void MavsdkLink::Impl::on_version(const Message& message) {
  std::uint32_t version = 0;
  const bool whole = read(message.fields, "flight_sw_version", version);
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  info_.version = px4::version(version);
}

// tc1 is the autopilot's time, ts1 ours as we sent it; its own requests have tc1 = 0.
void MavsdkLink::Impl::on_timesync(const Message& message) {
  std::int64_t answered_ns = 0;
  std::int64_t sent_ns = 0;
  const bool whole = read(message.fields, "tc1", answered_ns) && read(message.fields, "ts1", sent_ns);
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  if (answered_ns == 0 || sent_ns != timesync_sent_ns_) return;
  const double round_trip_s = std::max(0.0, now - static_cast<double>(sent_ns) * 1e-9);
  info_.round_trip_s = std::min(info_.round_trip_s.value_or(round_trip_s), round_trip_s);
}

void MavsdkLink::Impl::on_parameter(const Message& message) {
  std::uint32_t type = 0;
  const std::string name = text(message.fields, "param_id");
  const bool whole = !name.empty() && read(message.fields, "param_type", type);
  {
    const std::scoped_lock lock(mutex_);
    if (!whole) return malformed();
    if (parameters_.size() >= kParameters && !parameters_.contains(name)) return;
    const bool bytewise = info_.autopilot.value_or(px4::kAutopilotPx4) == px4::kAutopilotPx4;
    parameters_[name] = px4::parameter(name, type, number(message.fields, "param_value"), bytewise);
  }
  parameter_came_.notify_all();
}

void MavsdkLink::Impl::on_status_text(const Message& message) {
  std::uint32_t severity = 0;
  std::uint32_t id = 0;
  std::uint32_t chunk = 0;
  const bool whole = read(message.fields, "severity", severity);
  (void)read(message.fields, "id", id);  // extension fields
  (void)read(message.fields, "chunk_seq", chunk);
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  for (std::string& line : texts_.add(severity, id, chunk, text(message.fields, "text"))) {
    notice("autopilot_text", std::move(line));
  }
}

void MavsdkLink::Impl::on_adsb_vehicle(const Message& message) {
  const json& fields = message.fields;
  AdsbReport report;
  report.received = clock_.now();
  report.system = message.system;
  report.component = message.component;
  report.latitude_deg = number(fields, "lat") / kDegreesE7;
  report.longitude_deg = number(fields, "lon") / kDegreesE7;
  report.altitude_m = number(fields, "altitude") / kPerMetre_mm;
  report.heading_deg = number(fields, "heading") / 100.0;
  report.horizontal_velocity = number(fields, "hor_velocity") / kPerMetre_cm;
  report.vertical_velocity = number(fields, "ver_velocity") / kPerMetre_cm;
  report.since_contact = number(fields, "tslc");
  const bool whole = read(fields, "ICAO_address", report.icao_address) && read(fields, "flags", report.flags) &&
                     read(fields, "altitude_type", report.altitude_type) &&
                     read(fields, "emitter_type", report.emitter_type);
  const std::scoped_lock lock(mutex_);
  if (!whole) return malformed();
  if (adsb_.size() == kAdsbReports) {
    adsb_.pop_front();
    ++counts_.dropped_adsb;
  }
  adsb_.push_back(report);
}

VehicleState MavsdkLink::Impl::state() const {
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  VehicleState state = state_;
  const bool fresh = state.position_stamp >= 0.0 && now - state.position_stamp <= kPositionMaxAge_s;
  state.local_position_ok = fresh && estimator_ok_;
  state.health = sys_status_heard_ ? failed_health_ : "no SYS_STATUS yet";
  if (!state.local_position_ok) state.health += state.health.empty() ? "local position" : ", local position";
  state.estimate_resets = resets_.count();
  state.estimate_shift = resets_.shift();
  for (const auto& [id, battery] : batteries_) state.battery = std::max(state.battery, battery);
  if (state.battery == BatteryState::kUnknown) state.battery = remaining_;
  state.system_id = autopilot_system_id();
  return state;
}

}  // namespace jink::bridge
