// SPDX-License-Identifier: BSD-3-Clause
// What comes in over MavsdkLink: who said it, what is asked for anew, how fast it comes. The handlers run on MAVSDK's
// callback thread.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "bridge/mavsdk/link_impl.hpp"

namespace jink::bridge::mavsdk {

namespace {

constexpr std::uint32_t kMessageAttitude = 30;  // message ids of common.xml
constexpr std::uint32_t kMessageLocalPosition = 32;
constexpr std::uint32_t kMessageOrigin = 49;
constexpr std::uint32_t kMessageHome = 242;
constexpr std::uint32_t kMessageVersion = 148;
constexpr std::uint32_t kMessageOdometry = 331;
constexpr std::uint32_t kMessageCurrentMode = 436;
constexpr double kRateTolerance = 0.8;  // of the rate expected: slower than this is asked for again
constexpr double kModeNewsHz = 2.0;     // PX4 sends the mode when its vehicle_status is new: then, or changed
constexpr int kRequests = 5;            // of what an autopilot has never sent, and may not know
constexpr std::size_t kAdsbReports = 1024;
constexpr std::size_t kParameters = 4096;  // more than any autopilot has

struct StreamSpec {
  const char* message;
  std::uint32_t id;  // 0: not asked for
  double asked_hz;
  double expected_hz;
};
constexpr std::array<StreamSpec, 5> kStreamSpecs{
    {{"HEARTBEAT", 0, 0.0, 1.0},
     {"LOCAL_POSITION_NED", kMessageLocalPosition, MavsdkLink::kTelemetryHz, MavsdkLink::kTelemetryHz},
     {"ATTITUDE", kMessageAttitude, MavsdkLink::kTelemetryHz, MavsdkLink::kTelemetryHz},
     {"ODOMETRY", kMessageOdometry, MavsdkLink::kOdometryHz, MavsdkLink::kOdometryHz},
     {"CURRENT_MODE", kMessageCurrentMode, MavsdkLink::kModeHz, kModeNewsHz}}};

}  // namespace

void MavsdkLink::Impl::take(const Sender& sender, const mavlink::Message& message) {
  const double now = clock_.now();
  std::visit([&](const auto& decoded) { on(now, sender, decoded); }, message);
}

// A request that is lost, refused or not followed is made again at the next heartbeat.
void MavsdkLink::Impl::request_streams(const std::array<bool, kStreams>& slow) const {
  for (std::size_t i = 0; i < kStreams; ++i) {
    if (slow[i]) (void)transmit(vehicle::px4::message_interval(kStreamSpecs[i].id, kStreamSpecs[i].asked_hz));
  }
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
    StreamRate rate{kStreamSpecs[i].message, kStreamSpecs[i].expected_hz, 0.0, t.largest_gap, t.count};
    if (t.count > 1) rate.measured_hz = static_cast<double>(t.count - 1) / (t.last - t.first);
    rate.largest_gap_s = std::max(rate.largest_gap_s, now - (t.count > 0 ? t.last : rates_since_));
    rates.push_back(rate);
  }
  return rates;
}

void MavsdkLink::Impl::on(double now, const Sender& sender, const mavlink::Heartbeat& message) {
  if (sender.system != system_id_) return on_other_heartbeat(sender, message);
  std::array<bool, kStreams> slow{};
  bool want_origin = false;
  bool want_home = false;
  bool want_version = false;
  std::vector<std::string> want_parameters;
  {
    const std::scoped_lock lock(mutex_);
    const double before = telemetry_.heartbeat_stamp();
    if (!telemetry_.on(now, message)) return;
    for (std::size_t i = kLocalPosition; i < kStreams && before >= 0.0; ++i) {
      const double wanted = kRateTolerance * kStreamSpecs[i].expected_hz * (now - before);
      slow[i] = static_cast<double>(heard_[i] - at_heartbeat_[i]) < wanted;
    }
    for (const Stream stream : {kOdometry, kCurrentMode}) {
      if (heard_[stream] == 0 && slow[stream]) slow[stream] = ++requests_[stream] <= kRequests;
    }
    tally(kHeartbeat, now);
    at_heartbeat_ = heard_;
    want_origin = !telemetry_.origin_known();
    want_home = !telemetry_.home_known();
    want_version = !telemetry_.info().version;
    if (ready_) want_parameters = telemetry_.parameters_to_ask();
  }
  if (!ready_) return;
  request_streams(slow);
  if (want_origin) (void)transmit(vehicle::px4::request_message(kMessageOrigin));
  if (want_home) (void)transmit(vehicle::px4::request_message(kMessageHome));
  if (want_version) (void)transmit(vehicle::px4::request_message(kMessageVersion));
  for (const std::string& name : want_parameters) request_parameter(name);
  ping(now);
}

// Not by TIMESYNC: PX4 leaves the target of its answers to chance, and MAVSDK keeps what is meant for others to itself.
void MavsdkLink::Impl::ping(double now) {
  {
    const std::scoped_lock lock(mutex_);
    if (now < ping_due_) return;
    ping_due_ = now + vehicle::LinkDelay::kPeriod;
  }
  const auto time_us = static_cast<std::int64_t>(now * 1e6);
  (void)transmit("PING", {{"time_usec", time_us}, {"seq", 0}, {"target_system", 0}, {"target_component", 0}});
}

void MavsdkLink::Impl::on_other_heartbeat(const Sender& sender, const mavlink::Heartbeat& message) {
  if (message.autopilot == vehicle::px4::kAutopilotInvalid) return;
  const std::scoped_lock lock(mutex_);
  if (!other_autopilots_.insert(sender.system).second) return;
  telemetry_.notice("second_autopilot", "system " + std::to_string(sender.system) +
                                            " is an autopilot on this connection too; this flight is with system " +
                                            std::to_string(system_id_) + " alone");
}

void MavsdkLink::Impl::on(double now, const Sender& /*sender*/, const mavlink::LocalPosition& message) {
  {
    const std::scoped_lock lock(mutex_);
    if (telemetry_.on(now, message)) tally(kLocalPosition, now);
  }
  if (ready_) ping(now);
}

void MavsdkLink::Impl::on(double now, const Sender& /*sender*/, const mavlink::CurrentMode& message) {
  const std::scoped_lock lock(mutex_);
  telemetry_.on(now, message);
  tally(kCurrentMode, now);
}

void MavsdkLink::Impl::on(double now, const Sender& /*sender*/, const mavlink::Attitude& message) {
  const std::scoped_lock lock(mutex_);
  telemetry_.on(now, message);
  tally(kAttitude, now);
}

void MavsdkLink::Impl::on(double now, const Sender& /*sender*/, const mavlink::Odometry& message) {
  const std::scoped_lock lock(mutex_);
  telemetry_.on(message);
  tally(kOdometry, now);
}

void MavsdkLink::Impl::on(double now, const Sender& /*sender*/, const mavlink::CommandAck& message) {
  const std::scoped_lock lock(mutex_);
  // Without the extension fields the answer is taken as ours.
  const bool ours = (message.target_system == 0 || message.target_system == own_system_id_) &&
                    (message.target_component == 0 || message.target_component == kOwnComponent);
  if (!ours) return;
  ++answers_;
  commands_.acknowledge(message.command, message.result, now);
}

void MavsdkLink::Impl::on(double now, const Sender& /*sender*/, const mavlink::Ping& message) {
  const std::scoped_lock lock(mutex_);
  if (message.target_system != own_system_id_ || message.target_component != kOwnComponent) return;
  ++answers_;
  telemetry_.on(now, message);
}

void MavsdkLink::Impl::on(double /*now*/, const Sender& /*sender*/, const mavlink::ParamValue& message) {
  {
    const std::scoped_lock lock(mutex_);
    const bool bytewise =
        telemetry_.info().autopilot.value_or(vehicle::px4::kAutopilotPx4) == vehicle::px4::kAutopilotPx4;
    vehicle::px4::Parameter parameter = vehicle::px4::parameter(message.name, message.type, message.field, bytewise);
    telemetry_.on(parameter);
    ++answers_;
    if (parameters_.size() >= kParameters && !parameters_.contains(message.name)) return;
    parameters_[message.name] = std::move(parameter);
  }
  parameter_came_.notify_all();
}

void MavsdkLink::Impl::on(double now, const Sender& sender, const mavlink::AdsbReport& message) {
  const std::scoped_lock lock(mutex_);
  if (adsb_.size() == kAdsbReports) {
    adsb_.pop_front();
    ++dropped_adsb_;
  }
  adsb_.push_back(message);
  adsb_.back().received = now;
  adsb_.back().system = sender.system;
  adsb_.back().component = sender.component;
}

vehicle::VehicleState MavsdkLink::Impl::state() const {
  const double now = clock_.now();
  const std::scoped_lock lock(mutex_);
  vehicle::VehicleState state = telemetry_.state(now);
  state.system_id = autopilot_system_id();
  if (!other_autopilots_.empty()) state.other_system_id = *other_autopilots_.begin();
  return state;
}

mavlink::LinkInfo MavsdkLink::Impl::info() const {
  const std::scoped_lock lock(mutex_);
  mavlink::LinkInfo info = telemetry_.info();
  info.other_systems.assign(other_autopilots_.begin(), other_autopilots_.end());
  return info;
}

mavlink::LinkCounts MavsdkLink::Impl::counts() const {
  const std::scoped_lock lock(mutex_);
  mavlink::LinkCounts counts = telemetry_.counts();
  counts.setpoints_sent = setpoints_sent_;
  counts.other_autopilots = static_cast<std::uint32_t>(other_autopilots_.size());
  counts.dropped_adsb = dropped_adsb_;
  counts.answers = answers_;
  return counts;
}

}  // namespace jink::bridge::mavsdk
