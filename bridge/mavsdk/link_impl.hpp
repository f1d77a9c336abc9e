// SPDX-License-Identifier: BSD-3-Clause
// What stands behind MavsdkLink; for mavsdk_link.cpp (connection, sending, requests) and mavsdk_telemetry.cpp (what
// comes in) alone.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bridge/mavlink/autopilot_telemetry.hpp"
#include "bridge/mavlink/messages.hpp"
#include "bridge/mavsdk/handles.hpp"
#include "bridge/mavsdk/link.hpp"
#include "bridge/vehicle/command_tracker.hpp"

namespace jink::bridge::mavsdk {

class MavsdkLink::Impl {
 public:
  Impl(const std::string& url, std::uint32_t wanted_system, const base::Clock& clock);
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl();

  bool wait_for_autopilot(double timeout_s, const std::stop_token& stop);
  vehicle::VehicleState state() const;
  bool send(const vehicle::Setpoint& setpoint);
  bool tell(const vehicle::StatusText& text);
  void request(vehicle::Command command);
  std::optional<vehicle::CommandReport> next_report();
  mavlink::LinkCounts counts() const;
  mavlink::LinkInfo info() const;
  std::optional<mavlink::LinkNotice> next_notice();
  bool next_adsb(mavlink::AdsbReport& report);
  void restart_rates();
  std::vector<StreamRate> rates() const;
  std::vector<std::optional<vehicle::px4::Parameter>> read_parameters(std::span<const std::string> names,
                                                                      double timeout_s, const std::stop_token& stop);
  std::optional<std::vector<mavlink::MissionItem>> read_fence(double timeout_s, const std::stop_token& stop);
  std::uint32_t autopilot_system_id() const { return ready_ ? system_id_ : 0; }

 private:
  struct Sender {
    std::uint32_t system;
    std::uint32_t component;
  };
  enum class From { kAutopilot, kAnyComponent };
  struct Interest {
    const char* name = nullptr;
    From from = From::kAutopilot;
  };

  // Hears one system. The callbacks stop, and its handles go in the order that MAVSDK needs, when it is destroyed;
  // never under the mutex, which the callbacks take.
  class Listener {
   public:
    Listener(Impl& link, SystemHandle system);
    ~Listener();
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    void subscribe(std::span<const Interest> interests);
    /// Ends the subscriptions: no callback runs after it.
    void close();
    [[nodiscard]] mavsdk_mavlink_direct_t direct() const { return direct_.get(); }
    [[nodiscard]] std::uint32_t system_id() const { return system_id_; }

   private:
    struct Subscription {
      Listener* self = nullptr;
      Interest interest;
      mavsdk_subscription_t handle = nullptr;
    };
    static void on_message(mavsdk_mavlink_message_t message, void* subscription) noexcept;  // NOLINT: see there

    Impl& link_;
    std::uint32_t system_id_;
    SystemHandle system_;
    DirectHandle direct_;
    std::deque<Subscription> subscriptions_;  // stays where it is when it grows
  };

  static constexpr std::uint8_t kOwnComponent = 191;  // MAV_COMP_ID_ONBOARD_COMPUTER

  // Streams that are asked for and measured.
  enum Stream : std::size_t { kHeartbeat, kLocalPosition, kAttitude, kOdometry, kCurrentMode, kStreams };
  struct Tally {
    std::uint64_t count = 0;
    double first = -1.0;
    double last = -1.0;
    double largest_gap = 0.0;
  };

  SystemHandle find_autopilot(double timeout_s);
  [[nodiscard]] std::vector<SystemHandle> systems() const;
  void join_system();
  void watch_other_systems(const std::stop_token& stop);
  bool transmit(const char* name, const nlohmann::json& fields) const;
  bool transmit(const vehicle::px4::CommandLong& command) const;
  void request_parameter(const std::string& name) const;
  void ping(double now);
  void request_streams(const std::array<bool, kStreams>& slow) const;

  // On MAVSDK's callback thread, `now` by the companion's clock.
  void take(const Sender& sender, const mavlink::Message& message);
  void malformed();
  void on(double now, const Sender& sender, const mavlink::Heartbeat& message);
  void on(double now, const Sender& sender, const mavlink::CurrentMode& message);
  void on(double now, const Sender& sender, const mavlink::LocalPosition& message);
  void on(double now, const Sender& sender, const mavlink::Attitude& message);
  void on(double now, const Sender& sender, const mavlink::Odometry& message);
  void on(double now, const Sender& sender, const mavlink::CommandAck& message);
  void on(double now, const Sender& sender, const mavlink::Ping& message);
  void on(double now, const Sender& sender, const mavlink::ParamValue& message);
  void on(double now, const Sender& sender, const mavlink::MissionCount& message);
  void on(double now, const Sender& sender, const mavlink::MissionItem& message);
  void on(double now, const Sender& sender, const mavlink::AdsbReport& message);
  template <typename Other>  // what the state of the autopilot alone takes in
  void on(double /*now*/, const Sender& /*sender*/, const Other& message) {
    const std::scoped_lock lock(mutex_);
    telemetry_.on(message);
  }
  void on_other_heartbeat(const Sender& sender, const mavlink::Heartbeat& message);

  // With the mutex held.
  void tally(Stream stream, double now);

  const base::Clock& clock_;
  const double created_;
  std::atomic<std::uint32_t> own_system_id_ = 0;

  mutable std::mutex mutex_;  // guards the next block
  mavlink::AutopilotTelemetry telemetry_;
  std::uint64_t setpoints_sent_ = 0;
  std::uint16_t text_id_ = 0;  // of the newest text in several chunks
  std::array<Tally, kStreams> tallies_;
  std::array<std::uint64_t, kStreams> heard_{};
  std::array<std::uint64_t, kStreams> at_heartbeat_{};  // heard_ at the heartbeat before
  std::array<int, kStreams> requests_{};                // of what was never heard
  double rates_since_ = 0.0;
  std::set<std::uint32_t> other_autopilots_;
  std::deque<mavlink::AdsbReport> adsb_;
  std::uint64_t dropped_adsb_ = 0;
  std::uint64_t answers_ = 0;
  std::map<std::string, vehicle::px4::Parameter> parameters_;  // answers to the request under way
  bool fence_asked_ = false;
  std::optional<std::uint32_t> fence_count_;  // of the fence under way
  std::vector<mavlink::MissionItem> fence_;   // in order, as far as they came
  double ping_due_ = 0.0;
  vehicle::CommandTracker commands_;
  std::condition_variable_any parameter_came_, fence_came_;

  std::mutex wait_mutex_;            // serialises wait_for_autopilot
  std::mutex parameter_mutex_;       // serialises read_parameters
  std::mutex fence_mutex_;           // serialises read_fence
  std::atomic<bool> ready_ = false;  // autopilot_ stands; set once
  const std::uint32_t wanted_system_;
  std::uint32_t system_id_ = 0;

  // In the order of construction; MAVSDK aborts when they are destroyed in another than the reverse one.
  ConfigurationHandle configuration_;
  MavsdkHandle mavsdk_;
  std::unique_ptr<Listener> autopilot_;
  std::vector<std::unique_ptr<Listener>> others_;  // watcher_'s alone
  std::jthread watcher_;
};

}  // namespace jink::bridge::mavsdk
