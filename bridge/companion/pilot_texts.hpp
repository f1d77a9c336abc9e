// SPDX-License-Identifier: BSD-3-Clause
// What a pilot at a ground station is told of a flight, as STATUSTEXT: few words, and not too many of them.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/companion/report.hpp"
#include "bridge/vehicle/status_text.hpp"

namespace jink::bridge::companion {

/// Phases (info), hazards and the like (warning), what ended or ends the flight badly (critical). At most kPerSecond
/// texts in a second, the same text not again within kRepeat_s. Of the phases the newest one is always told, first and
/// late where it has to be; of what else waits for too long the oldest goes. Not thread-safe.
class PilotTexts final : public FlightObserver {
 public:
  static constexpr std::size_t kPerSecond = 2;
  static constexpr double kRepeat_s = 5.0;
  static constexpr std::size_t kWaiting = 8;  ///< texts

  void on_event(double now, std::string_view name, const std::string& detail) override;
  /// The next text to send at `now`, if any may be sent.
  [[nodiscard]] std::optional<vehicle::StatusText> next(double now);
  /// At the end of the flight: the phase that was not told yet, whatever the rate.
  [[nodiscard]] std::optional<vehicle::StatusText> last();

 private:
  [[nodiscard]] bool repeated(double now, const std::string& text) const;

  std::optional<vehicle::StatusText> phase_;
  std::deque<vehicle::StatusText> waiting_;
  std::map<std::string, double> told_;       // when, of the last kRepeat_s
  std::array<double, kPerSecond> newest_{};  // when the last ones went, the oldest first
};

}  // namespace jink::bridge::companion
