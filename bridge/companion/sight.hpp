// SPDX-License-Identifier: BSD-3-Clause
// What the companion makes of clouds of points: each is placed by where the vehicle was then, and goes to the mapper.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "bridge/companion/intake.hpp"
#include "bridge/map/clouds.hpp"
#include "bridge/map/mapper.hpp"
#include "config/mission.hpp"
#include "config/settings.hpp"
#include "planner/base/trajectory.hpp"

namespace jink::bridge::companion {

/// Where the vehicle was, and how it was turned, in the last seconds. Local ENU, m; times in the companion's clock.
class PoseHistory {
 public:
  static constexpr double kKept = 2.0;     ///< s
  static constexpr double kBeyond = 0.15;  ///< s, after the newest or before the oldest, for which a pose still counts

  /// What the state tells; one that is no newer than the last one is left out.
  void add(const vehicle::VehicleState& state);
  /// The local frame has jumped.
  void shift(const Vec3& by);
  void forget();
  /// From the body's frame (x ahead, y left, z up), between those before and after; none: not known then.
  [[nodiscard]] std::optional<Eigen::Isometry3d> at(double t) const;

 private:
  struct Place {
    double t = 0.0;
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
  };
  struct Turn {
    double t = 0.0;
    Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
  };
  std::deque<Place> places_;
  std::deque<Turn> turns_;
};

/// Sees where the mission has a `cloud` and there is a source. The mission and the source outlive it. Not thread-safe.
class Sight {
 public:
  /// `clock`: as Mapper's.
  Sight(const config::Mission& mission, const config::Settings& settings, map::CloudSource* source,
        const base::Clock* clock);

  /// Takes what has come, after the state and the tracks of this turn.
  void take(double now, Intake& intake, const Intake::FrameChange& change);

  /// The newest map; null: none yet. Throws what the mapper threw.
  [[nodiscard]] std::shared_ptr<const map::Seen> seen() const { return mapper_ ? mapper_->seen() : nullptr; }
  /// Mapper::column().
  [[nodiscard]] std::optional<map::Occupancy::Column> column() const {
    return mapper_ ? mapper_->column() : std::nullopt;
  }
  /// When a path of the vehicle, local ENU, first leads to where it was not seen to be free, s of the path's time;
  /// infinity: nowhere, or the mission takes for free what was not seen.
  [[nodiscard]] double leaves_seen(const planner::base::TimedPath& path) const;
  /// The mission wants to see, and nothing came for too long.
  [[nodiscard]] bool is_stale(double now) const;
  [[nodiscard]] map::CloudSourceStatus source_status() const;
  [[nodiscard]] map::MapperCounts counts() const { return mapper_ ? mapper_->counts() : map::MapperCounts(); }
  /// Clouds of a time at which it is not known where the vehicle was.
  [[nodiscard]] std::uint64_t unplaced() const { return unplaced_; }

 private:
  void place(double now, map::Cloud cloud, Intake& intake);

  const config::Mission& mission_;
  const config::Settings& settings_;
  map::CloudSource* source_;
  Eigen::Isometry3d mount_ = Eigen::Isometry3d::Identity();
  std::unique_ptr<map::Mapper> mapper_;  // none: nothing is to be seen
  PoseHistory poses_;
  std::optional<double> newest_;  // reception of the newest cloud that was placed
  bool anew_ = false;             // the autopilot has begun anew since the last cloud
  std::uint64_t unplaced_ = 0;
};

}  // namespace jink::bridge::companion
