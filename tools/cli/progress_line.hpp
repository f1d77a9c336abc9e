// SPDX-License-Identifier: BSD-3-Clause
// The line that tells how a flight is getting on: rewritten on a terminal, one every few seconds elsewhere.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/companion/companion.hpp"
#include "config/mission.hpp"
#include "tools/cli/command_line.hpp"

namespace jink::tools::cli {

/// What the line tells. What is not known is left out.
struct ProgressStatus {
  double t = 0.0;                       ///< s
  std::string mode{};                   ///< of the autopilot
  std::optional<double> progress{};     ///< share of the way to the last waypoint, 0 to 1
  std::optional<double> to_go{};        ///< m, to the last waypoint
  std::optional<double> speed{};        ///< m/s
  std::optional<double> height{};       ///< m, z
  bool estimated = false;               ///< z is the autopilot's estimate, and no height above the ground
  std::optional<double> nearest{};      ///< m of free air to the nearest obstacle; infinite: there is none
  std::optional<std::size_t> tracks{};  ///< their number
  std::optional<double> plan_ms{};      ///< the newest plan's time
  std::vector<std::string> stale{};     ///< inputs that are missing or too old, in words
};

/// One line without its end: "[  12.3 s] offboard  ! tracks 1.4 s old  62 %  7.6 m to go  ...", what is stale near its
/// beginning, so that a narrow terminal does not cut it off.
[[nodiscard]] std::string progress_text(const ProgressStatus& status);

/// Says when a line is due, and shows it: five a second on a terminal, cut to its width, else one in a few seconds.
class ProgressLine {
 public:
  /// `plain_period`: s between lines where there is no terminal. The printer outlives this.
  ProgressLine(BackgroundPrinter& printer, double plain_period)
      : printer_(printer), period_(printer.terminal() ? kTerminalPeriod : plain_period) {}

  /// Whether one is due at `now`, s of any clock that does not go back; if so the next one is a period
  /// later. Where there is no terminal the first one is due a period after the first call.
  [[nodiscard]] bool due(double now);
  void show(const std::string& text);

 private:
  static constexpr double kTerminalPeriod = 0.2;  // s
  BackgroundPrinter& printer_;
  double period_;
  std::optional<double> last_;
};

/// The progress line of a companion's flight. Not thread safe: the flight's loop calls it, and it never waits.
class FlightProgress final : public bridge::companion::FlightObserver {
 public:
  /// `pace`: the clock by which lines are due; null: the flight's own time. Both outlive this.
  FlightProgress(const config::Mission& mission, double stale_state, BackgroundPrinter& printer,
                 const bridge::base::Clock* pace = nullptr);

  void on_state(double t, const bridge::vehicle::VehicleState& state) override;
  void on_tracks(double t, const std::vector<planner::base::Track>& tracks) override;
  void on_plan(double t, const bridge::companion::PlanResult& result) override;
  void on_event(double t, std::string_view name, const std::string& detail) override;

  /// As of the newest on_state().
  [[nodiscard]] const ProgressStatus& status() const { return status_; }

 private:
  static constexpr double kPlainPeriod = 2.0;   // s
  static constexpr double kOldHeartbeat = 2.5;  // s; it comes once a second
  void find_progress(const Vec3& position);
  void find_stale(double t, const bridge::vehicle::VehicleState& state);

  const config::Mission& mission_;
  double stale_state_;
  ProgressLine line_;
  const bridge::base::Clock* pace_;
  ProgressStatus status_;
  Vec3 position_ = Vec3::Zero();
  std::optional<double> last_tracks_;
  std::size_t waypoint_ = 0;  // the next one
  double whole_ = 0.0;        // m, from where flying began by all waypoints
  bool flying_ = false;       // it has begun
  bool flown_ = false;        // and is over
};

}  // namespace jink::tools::cli
