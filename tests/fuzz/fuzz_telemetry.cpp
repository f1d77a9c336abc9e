// SPDX-License-Identifier: BSD-3-Clause
// MAVLink messages as MAVSDK hands them over, one after another, into the state of the autopilot and the table of
// aircraft: what these say then is finite and bounded, whatever came in. The input is a text; each line is the time
// since the last one (ms), a message's name and its fields as JSON.
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "bridge/map/fence.hpp"
#include "bridge/mavlink/adsb_tracks.hpp"
#include "bridge/mavlink/autopilot_telemetry.hpp"
#include "bridge/mavlink/messages.hpp"
#include "bridge/tracking/track_inbox.hpp"
#include "bridge/vehicle/command_tracker.hpp"
#include "config/solids.hpp"
#include "planner/geometry/validity.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

namespace mavlink = jink::bridge::mavlink;
using jink::bridge::mavlink::AdsbReport;
using jink::fuzz::require;

constexpr double kLongestWait_ms = 1e7;
constexpr std::size_t kLongestNotice = 600;
constexpr std::size_t kMostItems = 24;

class TheClock final : public jink::bridge::base::Clock {
 public:
  [[nodiscard]] double now() const override { return now_; }
  void wait(double seconds) { now_ += seconds; }

 private:
  double now_ = 10.0;
};

bool printable(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

class Companion {
 public:
  void take(double wait_ms, std::string_view name, std::string_view json) {
    clock_.wait(1e-3 * wait_ms);
    if (const auto message = jink::bridge::mavlink::decode(name, json)) {
      std::visit([this](const auto& decoded) { on(decoded); }, *message);
    } else {
      telemetry_.malformed();
    }
    check_state();
    check_aircraft();
  }

 private:
  void on(const jink::bridge::mavlink::Heartbeat& message) { (void)telemetry_.on(clock_.now(), message); }
  void on(const jink::bridge::mavlink::LocalPosition& message) { (void)telemetry_.on(clock_.now(), message); }
  void on(const jink::bridge::mavlink::CommandAck& message) {
    commands_.start(jink::bridge::vehicle::Command::kHold, message.command, clock_.now());
    commands_.acknowledge(message.command, message.result, clock_.now());
    const auto report = commands_.next(clock_.now() + 10.0);
    require(report.has_value() && printable(report->detail), "an answer that is none");
  }
  void on(const jink::bridge::mavlink::ParamValue& message) {
    for (const bool bytewise : {true, false}) {
      const auto value =
          jink::bridge::vehicle::px4::parameter(message.name, message.type, message.field, bytewise).value;
      require(!std::isinf(value), "a parameter is infinite");
    }
  }
  void on(const jink::bridge::mavlink::CurrentMode& message) { telemetry_.on(clock_.now(), message); }
  void on(const jink::bridge::mavlink::Attitude& message) { telemetry_.on(clock_.now(), message); }
  void on(const jink::bridge::mavlink::Ping& message) { telemetry_.on(clock_.now(), message); }
  void on(const AdsbReport& message) {
    report_ = message;
    report_->received = clock_.now();
  }
  void on(const mavlink::MissionCount& /*message*/) { fence_.clear(); }
  void on(const mavlink::MissionItem& message) {
    if (fence_.size() < kMostItems) fence_.push_back(message);
    check_fence();
  }
  template <typename Other>
  void on(const Other& message) {
    telemetry_.on(message);
  }

  void check_state() {
    const jink::bridge::vehicle::VehicleState state = telemetry_.state(clock_.now());
    const bool finite = state.motion.value.position.allFinite() && state.motion.value.velocity.allFinite() &&
                        std::isfinite(state.yaw) && state.estimate_shift.allFinite();
    require(finite, "a state that is not finite");
    // A reset moves the estimate between two believable positions, and a flight has not many.
    const double most = 2.1 * jink::bridge::mavlink::Limits::kPosition * (1.0 + state.estimate_resets);
    require(state.estimate_shift.norm() <= most, "an absurd shift of the estimate");
    require(!state.local_position_ok || state.motion.stamp >= 0.0, "a position that never came");
    require(!state.origin || std::abs(state.origin->latitude_deg) <= 90.0, "an absurd origin");
    const auto percent = telemetry_.info().battery_percent;
    require(!percent || (*percent >= 0.0 && *percent <= 100.0), "an absurd battery");
    while (const auto notice = telemetry_.next_notice()) {
      require(printable(notice->detail), "a notice that is not printable");
      require(notice->detail.size() <= kLongestNotice, "an endless notice");
    }
  }

  // A fence is solids to plan among, or none.
  void check_fence() const {
    try {
      for (const auto& solid : jink::bridge::map::fence_of(fence_, {47.4, 8.5, 488.0}, -10.0, 100.0).solids)
        require(jink::planner::geometry::is_valid(jink::config::track_at_rest(solid)), "a wall that is none");
    } catch (const std::runtime_error& refused) {
      require(printable(refused.what()), "a refusal that is not printable");
    }
  }

  void check_aircraft() {
    jink::bridge::tracking::TrackMessage message;
    while (aircraft_.poll(message)) {
      for (const jink::planner::base::Track& track : message.tracks) {
        require(jink::bridge::tracking::refusal(track) == nullptr, "an absurd aircraft");
      }
    }
  }

  TheClock clock_;
  jink::bridge::mavlink::AutopilotTelemetry telemetry_;
  jink::bridge::vehicle::CommandTracker commands_;
  std::optional<AdsbReport> report_;
  std::vector<mavlink::MissionItem> fence_;
  jink::bridge::mavlink::AdsbTracks aircraft_{[this](AdsbReport& report) {
                                                if (!report_) return false;
                                                report = *report_;
                                                report_.reset();
                                                return true;
                                              },
                                              [this] { return telemetry_.state(clock_.now()).origin; }, clock_};
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);  // NOLINT: bytes as text
  Companion companion;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    double wait_ms = 0.0;
    const auto number = std::from_chars(line.data(), line.data() + line.size(), wait_ms);
    if (number.ec != std::errc() || !(wait_ms >= 0.0 && wait_ms <= kLongestWait_ms)) continue;
    const std::string_view message(number.ptr, static_cast<std::size_t>(line.data() + line.size() - number.ptr));
    const std::size_t begin = std::min(message.find_first_not_of(' '), message.size());
    const std::size_t end = std::min(message.find(' ', begin), message.size());
    companion.take(wait_ms, message.substr(begin, end - begin), message.substr(end));
  }
  return 0;
}
