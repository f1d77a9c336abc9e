// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/mavsdk_link.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "bridge/command_tracker.hpp"
#include "bridge/frames.hpp"
#include "bridge/mavsdk_handles.hpp"
#include "bridge/px4.hpp"

namespace jink::bridge {

namespace {

using nlohmann::json;

constexpr std::uint32_t kAutopilotComponent = 1;  // MAV_COMP_ID_AUTOPILOT1
constexpr std::uint32_t kMessageAttitude = 30;    // message ids of common.xml
constexpr std::uint32_t kMessageLocalPosition = 32;
constexpr int kFrameLocalNed = 1;       // MAV_FRAME_LOCAL_NED
constexpr int kIgnoreYawRate = 0x800;   // the only bit set in the setpoint's type_mask: all else is meant
constexpr double kRateTolerance = 0.8;  // of kTelemetryHz: slower than this is asked for again
constexpr double kWaitSlice_s = 0.1;
constexpr double kMaxMagnitude = 1e6;  // of a setpoint's components: far outside any flight, inside float

// NaN where the field is missing or not a number (a NaN on the wire comes as null).
double number(const json& fields, const char* key) {
  const auto field = fields.find(key);
  return field != fields.end() && field->is_number() ? field->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

Vec3 vector(const json& fields, const char* x, const char* y, const char* z) {
  return {number(fields, x), number(fields, y), number(fields, z)};
}

bool sane(const Vec3& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMaxMagnitude;
}

// An unsigned field of at most 32 bits; false when it is missing or out of range.
bool read(const json& fields, const char* key, std::uint32_t& value) {
  const double v = number(fields, key);
  if (!(v >= 0.0 && v <= 4294967295.0)) return false;
  value = static_cast<std::uint32_t>(v);
  return true;
}

}  // namespace

class MavsdkLink::Impl {
 public:
  Impl(const std::string& url, const Clock& clock);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  bool wait_for_autopilot(double timeout_s, const std::stop_token& stop);
  VehicleState state() const;
  bool send(const Setpoint& setpoint);
  void request(Command command);
  std::optional<CommandReport> next_report();
  LinkCounts counts() const;
  std::uint32_t autopilot_system_id() const { return ready_ ? system_id_ : 0; }

 private:
  using Handler = void (Impl::*)(const json& fields);
  struct Subscription {
    Impl* self = nullptr;
    Handler handler = nullptr;
    mavsdk_subscription_t handle = nullptr;
  };

  static void on_message(mavsdk_mavlink_message_t message, void* subscription) noexcept;  // NOLINT: see there
  void subscribe();
  bool transmit(const char* name, const json& fields) const;
  bool transmit(const px4::CommandLong& command) const;
  void request_rates() const;

  void on_heartbeat(const json& fields);
  void on_local_position(const json& fields);
  void on_attitude(const json& fields);
  void on_sys_status(const json& fields);
  void on_extended_sys_state(const json& fields);
  void on_estimator_status(const json& fields);
  void on_command_ack(const json& fields);

  const Clock& clock_;
  const double created_;
  std::uint32_t own_system_id_ = 0;
  std::uint32_t own_component_id_ = 0;

  mutable std::mutex mutex_;  // guards the next block
  VehicleState state_;
  bool sys_status_heard_ = false;
  std::string failed_health_;
  bool estimator_ok_ = true;  // until it says otherwise
  LinkCounts counts_;
  LinkCounts at_heartbeat_;  // counts_ at the heartbeat before
  CommandTracker commands_;

  std::mutex wait_mutex_;            // serialises wait_for_autopilot
  std::atomic<bool> ready_ = false;  // the handles below stand; set once
  std::uint32_t system_id_ = 0;

  // In the order of construction; MAVSDK aborts when they are destroyed in another than the reverse one.
  MavsdkHandle mavsdk_;
  SystemHandle system_;
  DirectHandle direct_;
  std::array<Subscription, 7> subscriptions_;
};

MavsdkLink::Impl::Impl(const std::string& url, const Clock& clock) : clock_(clock), created_(clock.now()) {
  capture_mavsdk_log();
  const ConfigurationHandle configuration(
      mavsdk_configuration_create_with_component_type(MAVSDK_COMPONENT_TYPE_COMPANION_COMPUTER));
  own_system_id_ = mavsdk_configuration_get_system_id(configuration.get());
  own_component_id_ = mavsdk_configuration_get_component_id(configuration.get());
  mavsdk_.reset(mavsdk_create(configuration.get()));
  (void)take_mavsdk_warning();
  const int result = mavsdk_add_any_connection(mavsdk_.get(), url.c_str());
  if (result == MAVSDK_CONNECTION_RESULT_SUCCESS) return;
  const std::string reason = take_mavsdk_warning();
  if (result == MAVSDK_CONNECTION_RESULT_URL_INVALID) {
    throw std::runtime_error("connection '" + url + "' is malformed; allowed: udpin://HOST:PORT, udpout://HOST:PORT, " +
                             "tcpout://HOST:PORT, tcpin://HOST:PORT, serial:///dev/NAME:BAUD");
  }
  throw std::runtime_error("connection '" + url + "' cannot be opened: " +
                           (reason.empty() ? "MAVSDK connection result " + std::to_string(result) : reason));
}

MavsdkLink::Impl::~Impl() {
  // Unlocked: unsubscribing waits for a running callback, and those take the mutex.
  for (const Subscription& s : subscriptions_) {
    if (s.handle != nullptr) mavsdk_mavlink_direct_unsubscribe_message(direct_.get(), s.handle);
  }
}

bool MavsdkLink::Impl::wait_for_autopilot(double timeout_s, const std::stop_token& stop) {
  const std::scoped_lock lock(wait_mutex_);
  const double deadline = clock_.now() + timeout_s;
  while (!ready_ && !stop.stop_requested()) {
    const double left = deadline - clock_.now();
    SystemHandle found(mavsdk_first_autopilot(mavsdk_.get(), std::max(0.0, std::min(left, kWaitSlice_s))));
    if (found) {
      system_id_ = mavsdk_system_get_system_id(found.get());
      system_ = std::move(found);
      direct_.reset(mavsdk_mavlink_direct_create(system_.get()));
      subscribe();
      ready_ = true;
      request_rates();
    } else if (left <= 0.0) {
      break;
    }
  }
  return ready_;
}

void MavsdkLink::Impl::subscribe() {
  constexpr std::array<std::pair<const char*, Handler>, 7> kHandlers{{
      {"HEARTBEAT", &Impl::on_heartbeat},
      {"LOCAL_POSITION_NED", &Impl::on_local_position},
      {"ATTITUDE", &Impl::on_attitude},
      {"SYS_STATUS", &Impl::on_sys_status},
      {"EXTENDED_SYS_STATE", &Impl::on_extended_sys_state},
      {"ESTIMATOR_STATUS", &Impl::on_estimator_status},
      {"COMMAND_ACK", &Impl::on_command_ack},
  }};
  for (std::size_t i = 0; i < kHandlers.size(); ++i) {
    Subscription& s = subscriptions_[i];
    s.self = this;
    s.handler = kHandlers[i].second;
    s.handle = mavsdk_mavlink_direct_subscribe_message(direct_.get(), kHandlers[i].first, on_message, &s);
  }
}

// On MAVSDK's callback thread. Nothing may be thrown through C: parsing and the handlers do not throw on any input, and
// running out of memory ends the process by noexcept.
void MavsdkLink::Impl::on_message(mavsdk_mavlink_message_t message, void* subscription) noexcept {  // NOLINT
  const Subscription& s = *static_cast<const Subscription*>(subscription);
  Impl& self = *s.self;
  if (message.system_id == self.system_id_ && message.component_id == kAutopilotComponent) {
    const json fields = json::parse(message.fields_json, nullptr, /*allow_exceptions=*/false);
    if (fields.is_object()) {
      (self.*s.handler)(fields);
    } else {
      const std::scoped_lock lock(self.mutex_);
      ++self.counts_.malformed;
    }
  }
  mavsdk_mavlink_direct_mavlink_message_destroy(&message);
}

bool MavsdkLink::Impl::transmit(const char* name, const json& fields) const {
  const std::string text = fields.dump();
  const mavsdk_mavlink_message_t message{name,       own_system_id_,      own_component_id_,
                                         system_id_, kAutopilotComponent, text.c_str()};
  return mavsdk_mavlink_direct_send_message(direct_.get(), message) == MAVSDK_MAVLINK_DIRECT_RESULT_SUCCESS;
}

bool MavsdkLink::Impl::transmit(const px4::CommandLong& command) const {
  json fields{{"target_system", system_id_},
              {"target_component", kAutopilotComponent},
              {"command", command.id},
              {"confirmation", 0}};
  for (std::size_t i = 0; i < command.params.size(); ++i) {
    fields["param" + std::to_string(i + 1)] = command.params[i];  // NaN becomes null, and MAVSDK reads null as NaN
  }
  return transmit("COMMAND_LONG", fields);
}

// A request that is lost, refused or not followed is made again at the next heartbeat.
void MavsdkLink::Impl::request_rates() const {
  (void)transmit(px4::message_interval(kMessageLocalPosition, kTelemetryHz));
  (void)transmit(px4::message_interval(kMessageAttitude, kTelemetryHz));
}

void MavsdkLink::Impl::on_heartbeat(const json& fields) {
  std::uint32_t autopilot = 0;
  std::uint32_t base_mode = 0;
  std::uint32_t custom_mode = 0;
  const bool whole = read(fields, "autopilot", autopilot) && read(fields, "base_mode", base_mode) &&
                     read(fields, "custom_mode", custom_mode);
  const double now = clock_.now();
  bool slow = false;
  {
    const std::scoped_lock lock(mutex_);
    if (!whole || autopilot == px4::kAutopilotInvalid) {
      ++counts_.malformed;
      return;
    }
    if (state_.heartbeat_stamp >= 0.0) {
      const double wanted = kRateTolerance * kTelemetryHz * (now - state_.heartbeat_stamp);
      slow = static_cast<double>(counts_.positions - at_heartbeat_.positions) < wanted ||
             static_cast<double>(counts_.attitudes - at_heartbeat_.attitudes) < wanted;
    }
    ++counts_.heartbeats;
    at_heartbeat_ = counts_;
    state_.heartbeat_stamp = now;
    state_.armed = (base_mode & px4::kArmedFlag) != 0U;
    state_.mode = px4::flight_mode(static_cast<std::uint8_t>(autopilot), custom_mode);
  }
  if (slow && ready_) request_rates();
}

void MavsdkLink::Impl::on_local_position(const json& fields) {
  const Vec3 position_ned = vector(fields, "x", "y", "z");
  const Vec3 velocity_ned = vector(fields, "vx", "vy", "vz");
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  if (!position_ned.allFinite() || !velocity_ned.allFinite()) {
    ++counts_.malformed;
    return;
  }
  ++counts_.positions;
  state_.position_stamp = now;
  state_.position = enu_from_ned(position_ned);
  state_.velocity = enu_from_ned(velocity_ned);
}

void MavsdkLink::Impl::on_attitude(const json& fields) {
  const double heading = number(fields, "yaw");
  const std::scoped_lock lock(mutex_);
  if (!std::isfinite(heading)) {
    ++counts_.malformed;
    return;
  }
  ++counts_.attitudes;
  state_.yaw = yaw_enu_from_heading(heading);
}

void MavsdkLink::Impl::on_sys_status(const json& fields) {
  std::uint32_t present = 0;
  std::uint32_t enabled = 0;
  std::uint32_t health = 0;
  const bool whole = read(fields, "onboard_control_sensors_present", present) &&
                     read(fields, "onboard_control_sensors_enabled", enabled) &&
                     read(fields, "onboard_control_sensors_health", health);
  const std::scoped_lock lock(mutex_);
  if (!whole) {
    ++counts_.malformed;
    return;
  }
  sys_status_heard_ = true;
  failed_health_ = px4::failed_health(present, enabled, health);
  state_.armable = (health & px4::kPrearmCheck) != 0U;
}

void MavsdkLink::Impl::on_extended_sys_state(const json& fields) {
  std::uint32_t landed_state = 0;
  const bool whole = read(fields, "landed_state", landed_state);
  const std::scoped_lock lock(mutex_);
  if (!whole) {
    ++counts_.malformed;
    return;
  }
  state_.in_air = px4::in_air(static_cast<int>(landed_state));
}

void MavsdkLink::Impl::on_estimator_status(const json& fields) {
  std::uint32_t flags = 0;
  const bool whole = read(fields, "flags", flags);
  const std::scoped_lock lock(mutex_);
  if (!whole) {
    ++counts_.malformed;
    return;
  }
  estimator_ok_ = px4::estimator_has_local_position(flags);
}

void MavsdkLink::Impl::on_command_ack(const json& fields) {
  std::uint32_t command = 0;
  std::uint32_t result = 0;
  std::uint32_t target_system = 0;
  std::uint32_t target_component = 0;
  const bool whole = read(fields, "command", command) && read(fields, "result", result);
  // Extension fields, 0 from autopilots that do not send them: then the answer is taken as ours.
  (void)read(fields, "target_system", target_system);
  (void)read(fields, "target_component", target_component);
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  if (!whole) {
    ++counts_.malformed;
    return;
  }
  const bool ours = (target_system == 0 || target_system == own_system_id_) &&
                    (target_component == 0 || target_component == own_component_id_);
  if (ours) commands_.acknowledge(static_cast<std::uint16_t>(command), static_cast<int>(result), now);
}

VehicleState MavsdkLink::Impl::state() const {
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  VehicleState state = state_;
  const bool fresh = state.position_stamp >= 0.0 && now - state.position_stamp <= kPositionMaxAge_s;
  state.local_position_ok = fresh && estimator_ok_;
  state.health = sys_status_heard_ ? failed_health_ : "no SYS_STATUS yet";
  if (!state.local_position_ok) state.health += state.health.empty() ? "local position" : ", local position";
  return state;
}

bool MavsdkLink::Impl::send(const Setpoint& setpoint) {
  const Vec3 p = ned_from_enu(setpoint.position);
  const Vec3 v = ned_from_enu(setpoint.velocity);
  const Vec3 a = ned_from_enu(setpoint.acceleration);
  const double heading = heading_from_yaw_enu(setpoint.yaw);
  if (!ready_ || !sane(p) || !sane(v) || !sane(a) || !std::isfinite(heading)) return false;
  // Wraps after 49 days, as the field does.
  const auto boot_ms = static_cast<std::uint32_t>(static_cast<std::uint64_t>((clock_.now() - created_) * 1e3));
  const json fields{{"time_boot_ms", boot_ms},
                    {"target_system", system_id_},
                    {"target_component", kAutopilotComponent},
                    {"coordinate_frame", kFrameLocalNed},
                    {"type_mask", kIgnoreYawRate},
                    {"x", p.x()},
                    {"y", p.y()},
                    {"z", p.z()},
                    {"vx", v.x()},
                    {"vy", v.y()},
                    {"vz", v.z()},
                    {"afx", a.x()},
                    {"afy", a.y()},
                    {"afz", a.z()},
                    {"yaw", heading},
                    {"yaw_rate", 0.0}};
  if (!transmit("SET_POSITION_TARGET_LOCAL_NED", fields)) return false;
  const std::scoped_lock lock(mutex_);
  ++counts_.setpoints_sent;
  return true;
}

void MavsdkLink::Impl::request(Command command) {
  if (!ready_) {
    const std::scoped_lock lock(mutex_);
    commands_.fail(command, "no autopilot");
    return;
  }
  const px4::CommandLong message = px4::command_long(command);
  {
    // Before sending: the answer may come while transmit() is still returning.
    const std::scoped_lock lock(mutex_);
    commands_.start(command, message.id, clock_.now());
  }
  // What could not be sent gets no answer, and is reported so in time.
  (void)transmit(message);
}

std::optional<CommandReport> MavsdkLink::Impl::next_report() {
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  return commands_.next(now);
}

LinkCounts MavsdkLink::Impl::counts() const {
  const std::scoped_lock lock(mutex_);
  return counts_;
}

MavsdkLink::MavsdkLink(const std::string& connection_url, const Clock& clock)
    : impl_(std::make_unique<Impl>(connection_url, clock)) {}
MavsdkLink::~MavsdkLink() = default;

bool MavsdkLink::wait_for_autopilot(double timeout_s, const std::stop_token& stop) {
  return impl_->wait_for_autopilot(timeout_s, stop);
}
VehicleState MavsdkLink::state() {
  return impl_->state();
}
bool MavsdkLink::send(const Setpoint& setpoint) {
  return impl_->send(setpoint);
}
void MavsdkLink::request(Command command) {
  impl_->request(command);
}
std::optional<CommandReport> MavsdkLink::next_report() {
  return impl_->next_report();
}
LinkCounts MavsdkLink::counts() const {
  return impl_->counts();
}
std::uint32_t MavsdkLink::autopilot_system_id() const {
  return impl_->autopilot_system_id();
}

std::string MavsdkLink::last_warning() {
  return mavsdk_last_warning();
}

}  // namespace jink::bridge
