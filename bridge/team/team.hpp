// SPDX-License-Identifier: BSD-3-Clause
// The other vehicles of the team: where they say they will be, placed in this vehicle's frame; and what this one says.
// Pure logic: the transport and all times come in.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridge/frames/conversions.hpp"
#include "bridge/setpoints/setpoint_stream.hpp"
#include "bridge/team/intents.hpp"
#include "bridge/tracking/clock_offset.hpp"
#include "bridge/vehicle/vehicle_link.hpp"
#include "planner/geometry/known_path.hpp"

namespace jink::bridge::team {

/// Every vehicle avoids every other's committed path. That alone lets two that meet dodge each other without end, each
/// answering what the other did, so one of them has the right of way: the one with the lower id regards the other's
/// path for the next kRightOfWay seconds only, and the other, which regards all of it, has moved out of the way before.
/// Where it has not, both avoid each other. Not thread-safe.
class Team {
 public:
  static constexpr double kPeriod = 0.2;       ///< s, between two intents at most
  static constexpr double kTold = 8.0;         ///< s of the path ahead that are told
  static constexpr double kRightOfWay = 2.0;   ///< s
  static constexpr double kFresh = 1.0;        ///< s without a word, after which a path is doubted more and more
  static constexpr double kForgetPeer = 60.0;  ///< s without a word, after which a vehicle is taken to be gone
  static constexpr std::size_t kMostVehicles = 64;

  /// Something that people are to be told.
  struct Notice {
    std::string name, detail;
  };

  /// `radius` is that of this vehicle. A vehicle silent for kFresh + `coast_s` is reported and taken to hang where its
  /// path ended: whoever has handed over to HOLD and ended its program is still there. After kForgetPeer it is
  /// forgotten. The transport must outlive the team.
  Team(IntentTransport& transport, double radius, double coast_s);

  /// Takes in what has come. An intent counts from its stamp, as ClockOffsetEstimator believes it; where that knows the
  /// changes of the delay alone, the vehicle may be farther off its path by what it flies in a tenth of a second. One
  /// whose place is not known, because its sender or this vehicle does not know its origin, is dropped and reported,
  /// never guessed.
  void listen(double now, const vehicle::VehicleState& own);

  /// The others' paths for a plan that begins at `start`, of which they are valid at time 0: on its path each, with an
  /// uncertainty that grows with the time since it was told, and grows faster while nothing more is heard; after the
  /// last point told it stays there. Order: by writer.
  [[nodiscard]] std::vector<planner::geometry::KnownPath> paths(double now, double start) const;

  /// Says where this vehicle will be, where `plans` (of the flight so far) has changed and at least every kPeriod.
  /// `followed`: the stream that the vehicle is sent, null while it is sent none; then it is taken to go on as it moves
  /// for a second, in the air, and to stay.
  void tell(double now, const vehicle::VehicleState& own, const setpoints::SetpointStream* followed,
            std::uint64_t plans);

  /// What happened since the last call; what recurs, once a second.
  std::vector<Notice> take_notices(double now);

  /// Vehicles heard and placed now.
  [[nodiscard]] std::size_t vehicles() const;
  /// Intents left out so far because an origin was not known.
  [[nodiscard]] std::uint64_t unplaced() const { return unplaced_; }

 private:
  struct Peer {
    std::uint64_t vehicle = 0;
    tracking::ClockOffsetEstimator clock;
    double seen = 0.0;  // reception of the newest message
    // Of the newest that could be used; its times are our clock.
    std::optional<base::Stamped<planner::base::TimedPath, base::Frame::kLocal>> path;
    double radius = 0.0, margin = 0.0;
    bool announced_clock = false;
    bool announced_silent = false;
  };
  void take(const IntentMessage& message, const vehicle::VehicleState& own);
  void forget_the_silent(double now);
  void find_duplicate_systems(double now);
  [[nodiscard]] planner::base::TimedPath committed(double now, const vehicle::VehicleState& own,
                                                   const setpoints::SetpointStream* followed) const;
  void measure_deviation(double now, const vehicle::VehicleState& own, const setpoints::SetpointStream* followed);

  IntentTransport& transport_;
  double radius_;
  double coast_s_;
  std::uint64_t own_vehicle_ = 0;
  std::map<std::uint64_t, Peer> peers_;        // by writer
  std::set<std::uint32_t> duplicate_systems_;  // systems that two live vehicles have
  std::vector<Notice> notices_;
  std::uint64_t unplaced_ = 0, late_ = 0, crowded_ = 0, untold_ = 0;
  std::uint64_t said_unplaced_ = 0, said_late_ = 0, said_crowded_ = 0, said_untold_ = 0, said_refused_ = 0;
  std::string unplaced_why_;
  double last_news_ = base::kNever;
  double last_told_ = base::kNever;
  std::uint64_t told_plans_ = 0;
  double deviation_ = 0.0;  // of late
  double deviation_at_ = base::kNever;
};

}  // namespace jink::bridge::team
