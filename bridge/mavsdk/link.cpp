// SPDX-License-Identifier: BSD-3-Clause
// The connection, what goes out, and requests with their answers.
#include "bridge/mavsdk/link.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "bridge/frames/conversions.hpp"
#include "bridge/mavsdk/link_impl.hpp"

namespace jink::bridge::mavsdk {

namespace {

using nlohmann::json;

constexpr std::uint32_t kAutopilotComponent = 1;  // MAV_COMP_ID_AUTOPILOT1
constexpr int kFrameLocalNed = 1;                 // MAV_FRAME_LOCAL_NED
constexpr int kIgnoreYawRate = 0x800;             // the only bit set in the setpoint's type_mask: all else is meant
constexpr double kWaitSlice_s = 0.1;
constexpr double kMaxMagnitude = 1e6;  // of a setpoint's components: far outside any flight, inside float
constexpr auto kLookForSystems = std::chrono::milliseconds(200);
constexpr int kParameterTries = 3;
constexpr std::size_t kLongestParameterName = 16;

bool sane(const Vec3& v) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() <= kMaxMagnitude;
}

bool is_parameter_name(const std::string& name) {
  const auto usual = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= kLongestParameterName && std::all_of(name.begin(), name.end(), usual);
}

}  // namespace

MavsdkLink::Impl::Listener::Listener(Impl& link, SystemHandle system)
    : link_(link),
      system_id_(mavsdk_system_get_system_id(system.get())),
      system_(std::move(system)),
      direct_(mavsdk_mavlink_direct_create(system_.get())) {}

MavsdkLink::Impl::Listener::~Listener() {
  close();
}

void MavsdkLink::Impl::Listener::close() {
  for (Subscription& s : subscriptions_) {
    if (s.handle != nullptr) mavsdk_mavlink_direct_unsubscribe_message(direct_.get(), std::exchange(s.handle, nullptr));
  }
}

void MavsdkLink::Impl::Listener::subscribe(std::span<const Interest> interests) {
  for (const Interest& interest : interests) {
    Subscription& s = subscriptions_.emplace_back(Subscription{this, interest, nullptr});
    s.handle = mavsdk_mavlink_direct_subscribe_message(direct_.get(), interest.name, on_message, &s);
  }
}

// On MAVSDK's callback thread. Nothing may be thrown through C: decoding and the handlers do not throw on any input,
// and running out of memory ends the process by noexcept.
void MavsdkLink::Impl::Listener::on_message(mavsdk_mavlink_message_t message, void* subscription) noexcept {  // NOLINT
  const Subscription& s = *static_cast<const Subscription*>(subscription);
  Impl& link = s.self->link_;
  const bool wanted = message.system_id == s.self->system_id_ &&
                      (s.interest.from == From::kAnyComponent || message.component_id == kAutopilotComponent);
  if (wanted) {
    if (const auto decoded = mavlink::decode(s.interest.name, message.fields_json)) {
      link.take({message.system_id, message.component_id}, *decoded);
    } else {
      link.malformed();
    }
  }
  mavsdk_mavlink_direct_mavlink_message_destroy(&message);
}

MavsdkLink::Impl::Impl(const std::string& url, std::uint32_t wanted_system, const base::Clock& clock)
    : clock_(clock), created_(clock.now()), wanted_system_(wanted_system) {
  capture_mavsdk_log();
  configuration_.reset(mavsdk_configuration_create_with_component_type(MAVSDK_COMPONENT_TYPE_COMPANION_COMPUTER));
  mavsdk_configuration_set_component_id(configuration_.get(), kOwnComponent);
  own_system_id_ = mavsdk_configuration_get_system_id(configuration_.get());
  mavsdk_.reset(mavsdk_create(configuration_.get()));
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
  watcher_.request_stop();
  if (watcher_.joinable()) watcher_.join();
  // Unlocked, and while all that a running callback uses still stands.
  if (autopilot_) autopilot_->close();
}

bool MavsdkLink::Impl::wait_for_autopilot(double timeout_s, const std::stop_token& stop) {
  const std::scoped_lock lock(wait_mutex_);
  const double deadline = clock_.now() + timeout_s;
  while (!ready_ && !stop.stop_requested()) {
    const double left = deadline - clock_.now();
    if (SystemHandle found = find_autopilot(std::max(0.0, std::min(left, kWaitSlice_s)))) {
      autopilot_ = std::make_unique<Listener>(*this, std::move(found));
      system_id_ = autopilot_->system_id();
      join_system();
      static constexpr std::array<Interest, 19> kInterests{{{"HEARTBEAT"},
                                                            {"CURRENT_MODE"},
                                                            {"LOCAL_POSITION_NED"},
                                                            {"ATTITUDE"},
                                                            {"ODOMETRY"},
                                                            {"SYS_STATUS"},
                                                            {"EXTENDED_SYS_STATE"},
                                                            {"ESTIMATOR_STATUS"},
                                                            {"BATTERY_STATUS"},
                                                            {"GPS_GLOBAL_ORIGIN"},
                                                            {"HOME_POSITION"},
                                                            {"COMMAND_ACK"},
                                                            {"AUTOPILOT_VERSION"},
                                                            {"PING"},
                                                            {"PARAM_VALUE"},
                                                            {"MISSION_COUNT"},
                                                            {"MISSION_ITEM_INT"},
                                                            {"STATUSTEXT"},
                                                            {"ADSB_VEHICLE", From::kAnyComponent}}};
      autopilot_->subscribe(kInterests);
      ready_ = true;
      request_streams({false, true, true, true, true});
      watcher_ = std::jthread([this](const std::stop_token& end) { watch_other_systems(end); });
    } else if (left <= 0.0) {
      break;
    }
  }
  return ready_;
}

// The one that is wanted, or else the first; null: not within that time.
SystemHandle MavsdkLink::Impl::find_autopilot(double timeout_s) {
  if (wanted_system_ == 0) return SystemHandle(mavsdk_first_autopilot(mavsdk_.get(), timeout_s));
  for (SystemHandle& system : systems()) {
    if (mavsdk_system_get_system_id(system.get()) == wanted_system_ && mavsdk_system_has_autopilot(system.get()))
      return std::move(system);
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
  return {};
}

std::vector<SystemHandle> MavsdkLink::Impl::systems() const {
  std::size_t count = 0;
  mavsdk_system_t* const found = mavsdk_get_systems(mavsdk_.get(), &count);
  std::vector<SystemHandle> systems;
  for (std::size_t i = 0; found != nullptr && i < count; ++i) systems.emplace_back(found[i]);
  if (found != nullptr) mavsdk_free_systems_array(found);
  return systems;
}

// As a component of the vehicle's own system: ground stations show what is said in that one.
void MavsdkLink::Impl::join_system() {
  mavsdk_configuration_set_system_id(configuration_.get(), system_id_);
  mavsdk_set_configuration(mavsdk_.get(), configuration_.get());
  own_system_id_ = system_id_;
}

// MAVSDK's mavlink_direct hears one system; whoever else speaks on the connection gets a listener of its own.
void MavsdkLink::Impl::watch_other_systems(const std::stop_token& stop) {
  static constexpr std::array<Interest, 2> kInterests{{{"HEARTBEAT"}, {"ADSB_VEHICLE", From::kAnyComponent}}};
  std::set<std::uint32_t> known{system_id_};
  std::mutex nobody_elses;
  std::condition_variable_any never;
  std::unique_lock lock(nobody_elses);
  while (!stop.stop_requested()) {
    for (SystemHandle& system : systems()) {
      if (!known.insert(mavsdk_system_get_system_id(system.get())).second) continue;
      others_.push_back(std::make_unique<Listener>(*this, std::move(system)));
      others_.back()->subscribe(kInterests);
    }
    (void)never.wait_for(lock, stop, kLookForSystems, [] { return false; });
  }
}

bool MavsdkLink::Impl::transmit(const char* name, const json& fields) const {
  const std::string text = fields.dump();
  const mavsdk_mavlink_message_t message{name, own_system_id_, kOwnComponent, 0, 0, text.c_str()};
  return mavsdk_mavlink_direct_send_message(autopilot_->direct(), message) == MAVSDK_MAVLINK_DIRECT_RESULT_SUCCESS;
}

bool MavsdkLink::Impl::transmit(const vehicle::px4::CommandLong& command) const {
  json fields{{"target_system", system_id_},
              {"target_component", kAutopilotComponent},
              {"command", command.id},
              {"confirmation", 0}};
  for (std::size_t i = 0; i < command.params.size(); ++i) {
    fields["param" + std::to_string(i + 1)] = command.params[i];  // NaN becomes null, and MAVSDK reads null as NaN
  }
  return transmit("COMMAND_LONG", fields);
}

bool MavsdkLink::Impl::send(const vehicle::Setpoint& setpoint) {
  const Vec3 p = frames::ned_from_enu(setpoint.position);
  const Vec3 v = frames::ned_from_enu(setpoint.velocity);
  const Vec3 a = frames::ned_from_enu(setpoint.acceleration);
  const double heading = frames::heading_from_yaw_enu(setpoint.yaw);
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
  ++setpoints_sent_;
  return true;
}

bool MavsdkLink::Impl::tell(const vehicle::StatusText& text) {
  if (!ready_) return false;
  const std::vector<std::string> chunks = vehicle::status_text_chunks(text.text);
  std::uint16_t id = 0;  // one chunk has none
  if (chunks.size() > 1) {
    const std::scoped_lock lock(mutex_);
    if (++text_id_ == 0) ++text_id_;
    id = text_id_;
  }
  bool sent = true;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    sent =
        transmit("STATUSTEXT",
                 {{"severity", static_cast<int>(text.severity)}, {"text", chunks[i]}, {"id", id}, {"chunk_seq", i}}) &&
        sent;
  }
  return sent;
}

void MavsdkLink::Impl::request(vehicle::Command command) {
  if (!ready_) {
    const std::scoped_lock lock(mutex_);
    commands_.fail(command, "no autopilot");
    return;
  }
  const vehicle::px4::CommandLong message = vehicle::px4::command_long(command);
  {
    // Before sending: the answer may come while transmit() is still returning.
    const std::scoped_lock lock(mutex_);
    commands_.start(command, message.id, clock_.now());
  }
  // What could not be sent gets no answer, and is reported so in time.
  (void)transmit(message);
}

std::optional<vehicle::CommandReport> MavsdkLink::Impl::next_report() {
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  std::optional<vehicle::CommandReport> report = commands_.next(now);
  if (report && report->detail == vehicle::CommandTracker::kNoAnswer && answers_ == 0)
    report->detail += ", as to all else: does the autopilot take signed messages alone (jink doctor)?";
  return report;
}

void MavsdkLink::Impl::request_parameter(const std::string& name) const {
  (void)transmit("PARAM_REQUEST_READ", {{"target_system", system_id_},
                                        {"target_component", kAutopilotComponent},
                                        {"param_id", name},
                                        {"param_index", -1}});
}

std::vector<std::optional<vehicle::px4::Parameter>> MavsdkLink::Impl::read_parameters(
    std::span<const std::string> names, double timeout_s, const std::stop_token& stop) {
  std::vector<std::optional<vehicle::px4::Parameter>> result(names.size());
  if (!ready_) return result;
  const std::scoped_lock one_at_a_time(parameter_mutex_);
  std::unique_lock lock(mutex_);
  const auto missing = [&](const std::string& name) { return is_parameter_name(name) && !parameters_.contains(name); };
  const auto complete = [&] { return std::none_of(names.begin(), names.end(), missing); };
  parameters_.clear();
  for (int i = 0; i < kParameterTries && !complete() && !stop.stop_requested(); ++i) {
    std::vector<std::string> asked;
    std::copy_if(names.begin(), names.end(), std::back_inserter(asked), missing);
    lock.unlock();  // answers come while requests go out
    for (const std::string& name : asked) request_parameter(name);
    lock.lock();
    (void)parameter_came_.wait_for(lock, stop, std::chrono::duration<double>(timeout_s / kParameterTries), complete);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = parameters_.find(names[i]);
    if (found != parameters_.end()) result[i] = found->second;
  }
  return result;
}

void MavsdkLink::Impl::malformed() {
  const std::scoped_lock lock(mutex_);
  telemetry_.malformed();
}

std::optional<mavlink::LinkNotice> MavsdkLink::Impl::next_notice() {
  const std::scoped_lock lock(mutex_);
  return telemetry_.next_notice();
}

bool MavsdkLink::Impl::next_adsb(mavlink::AdsbReport& report) {
  const std::scoped_lock lock(mutex_);
  if (adsb_.empty()) return false;
  report = adsb_.front();
  adsb_.pop_front();
  return true;
}

MavsdkLink::MavsdkLink(const std::string& connection_url, const base::Clock& clock, std::uint32_t wanted_system)
    : impl_(std::make_unique<Impl>(connection_url, wanted_system, clock)) {}
MavsdkLink::~MavsdkLink() = default;

bool MavsdkLink::wait_for_autopilot(double timeout_s, const std::stop_token& stop) {
  return impl_->wait_for_autopilot(timeout_s, stop);
}
vehicle::VehicleState MavsdkLink::state() {
  return impl_->state();
}
bool MavsdkLink::send(const vehicle::Setpoint& setpoint) {
  return impl_->send(setpoint);
}
bool MavsdkLink::tell(const vehicle::StatusText& text) {
  return impl_->tell(text);
}
void MavsdkLink::request(vehicle::Command command) {
  impl_->request(command);
}
std::optional<vehicle::CommandReport> MavsdkLink::next_report() {
  return impl_->next_report();
}
std::optional<mavlink::LinkNotice> MavsdkLink::next_notice() {
  return impl_->next_notice();
}
bool MavsdkLink::next_adsb(mavlink::AdsbReport& report) {
  return impl_->next_adsb(report);
}
std::vector<std::optional<vehicle::px4::Parameter>> MavsdkLink::read_parameters(std::span<const std::string> names,
                                                                                double timeout_s,
                                                                                const std::stop_token& stop) {
  return impl_->read_parameters(names, timeout_s, stop);
}
void MavsdkLink::restart_rates() {
  impl_->restart_rates();
}
std::vector<StreamRate> MavsdkLink::rates() const {
  return impl_->rates();
}
mavlink::LinkInfo MavsdkLink::info() const {
  return impl_->info();
}
mavlink::LinkCounts MavsdkLink::counts() const {
  return impl_->counts();
}
std::uint32_t MavsdkLink::autopilot_system_id() const {
  return impl_->autopilot_system_id();
}

std::string MavsdkLink::last_warning() {
  return mavsdk_last_warning();
}

}  // namespace jink::bridge::mavsdk
