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
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "bridge/command_tracker.hpp"
#include "bridge/estimate_resets.hpp"
#include "bridge/mavsdk_handles.hpp"
#include "bridge/mavsdk_link.hpp"
#include "bridge/status_text.hpp"

namespace jink::bridge {

class MavsdkLink::Impl {
 public:
  Impl(const std::string& url, const Clock& clock);
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl();

  bool wait_for_autopilot(double timeout_s, const std::stop_token& stop);
  VehicleState state() const;
  bool send(const Setpoint& setpoint);
  void request(Command command);
  std::optional<CommandReport> next_report();
  LinkCounts counts() const;
  LinkInfo info() const;
  std::optional<LinkNotice> next_notice();
  bool next_adsb(AdsbReport& report);
  void restart_rates();
  std::vector<StreamRate> rates() const;
  std::vector<std::optional<px4::Parameter>> read_parameters(std::span<const std::string> names, double timeout_s,
                                                             const std::stop_token& stop);
  std::uint32_t autopilot_system_id() const { return ready_ ? system_id_ : 0; }

 private:
  struct Message {
    std::uint32_t system;
    std::uint32_t component;
    const nlohmann::json& fields;
  };
  using Handler = void (Impl::*)(const Message& message);
  enum class From { kAutopilot, kAnyComponent };
  struct Interest {
    const char* name;
    Handler handler;
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

  // Streams that are asked for and measured.
  enum Stream : std::size_t { kHeartbeat, kLocalPosition, kAttitude, kOdometry, kStreams };
  struct Tally {
    std::uint64_t count = 0;
    double first = -1.0;
    double last = -1.0;
    double largest_gap = 0.0;
  };

  static std::vector<Interest> interests();
  void watch_other_systems(const std::stop_token& stop);
  bool transmit(const char* name, const nlohmann::json& fields) const;
  bool transmit(const px4::CommandLong& command) const;
  void request_streams(const std::array<bool, kStreams>& slow) const;

  // On MAVSDK's callback thread; each counts what it cannot read.
  void on_heartbeat(const Message& message);
  void on_other_heartbeat(const Message& message);
  void on_local_position(const Message& message);
  void on_attitude(const Message& message);
  void on_odometry(const Message& message);
  void on_sys_status(const Message& message);
  void on_extended_sys_state(const Message& message);
  void on_estimator_status(const Message& message);
  void on_battery_status(const Message& message);
  void on_origin(const Message& message);
  void on_command_ack(const Message& message);
  void on_version(const Message& message);
  void on_timesync(const Message& message);
  void on_parameter(const Message& message);
  void on_status_text(const Message& message);
  void on_adsb_vehicle(const Message& message);

  // With the mutex held.
  void notice(std::string name, std::string detail);
  void tally(Stream stream, double now);
  void boot_time(std::uint32_t boot_ms);
  void restarted();
  void malformed() { ++counts_.malformed; }

  const Clock& clock_;
  const double created_;
  std::uint32_t own_system_id_ = 0;
  std::uint32_t own_component_id_ = 0;

  mutable std::mutex mutex_;  // guards the next block
  VehicleState state_;
  LinkInfo info_;
  EstimateResets resets_;
  std::optional<std::uint32_t> boot_ms_;  // newest of LOCAL_POSITION_NED and ATTITUDE
  std::optional<std::uint32_t> position_boot_ms_;
  bool sys_status_heard_ = false;
  std::string failed_health_;
  bool estimator_ok_ = true;  // until it says otherwise
  std::map<std::uint32_t, BatteryState> batteries_;
  BatteryState remaining_ = BatteryState::kUnknown;  // by SYS_STATUS
  LinkCounts counts_;
  std::array<Tally, kStreams> tallies_;
  std::array<std::uint64_t, kStreams> heard_{};
  std::array<std::uint64_t, kStreams> at_heartbeat_{};  // heard_ at the heartbeat before
  int odometry_requests_ = 0;
  double rates_since_ = 0.0;
  std::set<std::uint32_t> other_autopilots_;
  StatusTexts texts_;
  std::deque<LinkNotice> notices_;
  std::deque<AdsbReport> adsb_;
  std::map<std::string, px4::Parameter> parameters_;  // answers to the request under way
  std::int64_t timesync_sent_ns_ = 0;
  CommandTracker commands_;
  std::condition_variable_any parameter_came_;

  std::mutex wait_mutex_;            // serialises wait_for_autopilot
  std::mutex parameter_mutex_;       // serialises read_parameters
  std::atomic<bool> ready_ = false;  // autopilot_ stands; set once
  std::uint32_t system_id_ = 0;

  // In the order of construction; MAVSDK aborts when they are destroyed in another than the reverse one.
  MavsdkHandle mavsdk_;
  std::unique_ptr<Listener> autopilot_;
  std::vector<std::unique_ptr<Listener>> others_;  // watcher_'s alone
  std::jthread watcher_;
};

}  // namespace jink::bridge
