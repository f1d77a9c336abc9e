// SPDX-License-Identifier: BSD-3-Clause
// What the companion takes in: the vehicle's state, the obstacle tracks, what the team's other vehicles tell.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridge/team/team.hpp"
#include "bridge/tracking/track_source.hpp"
#include "bridge/tracking/track_table.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"

namespace jink::bridge::companion {

/// The newest of all inputs. The parts outlive it. Not thread-safe.
class Intake {
 public:
  /// `intents`: to and from the team's other vehicles; null: there are none.
  Intake(const config::Mission& mission, const config::Settings& settings, vehicle::VehicleLink& link,
         tracking::TrackSource& tracks, team::IntentTransport* intents);

  /// What has happened to the autopilot's local frame since the last call.
  struct FrameChange {
    bool rebooted = false;      ///< it may be another frame
    std::optional<Vec3> shift;  ///< jump of the position estimate: the vehicle did not move
  };
  FrameChange take_state();
  /// True: there was a message.
  bool take_tracks(double now);
  void listen_to_team(double now);

  [[nodiscard]] const vehicle::VehicleState& state() const { return state_; }
  /// Height of the ground in the local frame: where the vehicle stood last, or else its home's; none: not known.
  [[nodiscard]] std::optional<double> ground() const { return ground_; }
  /// Sum of the jumps so far.
  [[nodiscard]] const Vec3& estimate_shift() const { return estimate_shift_; }
  [[nodiscard]] tracking::TrackTable& table() { return table_; }
  [[nodiscard]] const tracking::TrackTable& table() const { return table_; }
  [[nodiscard]] tracking::TrackSourceStatus source_status() const { return tracks_.status(); }
  /// Null: there is none.
  [[nodiscard]] team::Team* team() { return team_ ? &*team_ : nullptr; }
  /// Reception of the newest tracks; where the mission names writers, of that one's which is silent for longest. None:
  /// none yet, or none of one of these.
  [[nodiscard]] std::optional<double> newest_tracks() const;
  /// The first that the mission names and that is silent; empty: there is none.
  [[nodiscard]] std::string silent_writer(double now) const;
  /// Writers that watched in this flight, or when all was there for it last, and watch no more, nor anybody in their
  /// place. `flight_began`: none: it has not.
  [[nodiscard]] int lost_writers(double now, std::optional<double> flight_began);
  /// The crewed aircraft that is the first to come to less than well clear, and in how many seconds.
  struct Approach {
    std::uint32_t icao_address = 0;
    double seconds = 0.0;
  };
  [[nodiscard]] std::optional<Approach> approach(double now) const;
  /// Messages refused as `tracking::elsewhere`: before the flight, of writers that told of nothing near.
  [[nodiscard]] std::uint64_t elsewhere() const { return elsewhere_; }

 private:
  const config::Mission& mission_;
  const config::Settings& settings_;
  vehicle::VehicleLink& link_;
  tracking::TrackSource& tracks_;
  tracking::TrackTable table_;
  std::optional<team::Team> team_;  // where the mission wants it and there is a transport
  vehicle::VehicleState state_;
  std::uint32_t estimate_resets_ = 0;  // that have been told
  std::uint32_t reboots_ = 0;          // likewise
  Vec3 estimate_shift_ = Vec3::Zero();
  std::optional<double> ground_;
  double flight_began_ = planner::base::kInfinity;
  double watched_since_ = -planner::base::kInfinity;  // whose last word was before that was not there for this flight
  std::uint64_t elsewhere_ = 0;
  std::set<std::uint64_t> at_home_;           // writers that told of something near
  std::vector<tracking::Aircraft> aircraft_;  // of the newest message that had some
};

}  // namespace jink::bridge::companion
