// SPDX-License-Identifier: BSD-3-Clause
// A mission in flight, as PX4 flies one with a multicopter: which item is on, when it is reached, what it asks of the
// vehicle. No message, no clock, no vehicle: it is shown where the vehicle is, and says what is wanted.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "planner/base/types.hpp"

namespace jink::sim::vehicle {

struct MissionItem {
  enum class Kind { kTakeoff, kWaypoint, kLoiter, kLand, kReturn, kDelay, kSpeed, kJump, kNothing };
  Kind kind = Kind::kNothing;
  Vec3 position = Vec3::Zero();                           ///< ENU, in the simulation's frame
  bool above_home = false;                                ///< position.z() counts from home
  double yaw = std::numeric_limits<double>::quiet_NaN();  ///< counter-clockwise from east; NaN: towards the item
  double hold = 0.0;                                      ///< s, there; of kDelay, anywhere
  double radius = 0.0;                                    ///< m, horizontally; 0: NAV_ACC_RAD
  double speed = 0.0;                                     ///< m/s, of kSpeed; 0: MPC_XY_CRUISE
  std::size_t jump_to = 0;                                ///< of kJump
  int repeats = 0;                                        ///< of kJump; negative: for ever
  bool autocontinue = true;                               ///< false: stays once it is reached
};

/// What a mission is shown. Positions are local: the simulation's frame less `origin`.
struct MissionView {
  double time = 0.0;
  Vec3 position = Vec3::Zero();
  double yaw = 0.0;
  Vec3 home = Vec3::Zero();
  Vec3 origin = Vec3::Zero();
  bool landed = false;
  double acceptance_radius = 2.0;  ///< m, NAV_ACC_RAD
  double altitude_radius = 0.8;    ///< m, NAV_MC_ALT_RAD
  double yaw_error = 0.2;          ///< rad, MIS_YAW_ERR
};

/// What a mission wants.
struct MissionOrder {
  enum class Kind { kFly, kLand, kReturn, kEnd };
  Kind kind = Kind::kEnd;
  Vec3 position = Vec3::Zero();  ///< local; of kLand its ground plan
  double yaw = std::numeric_limits<double>::quiet_NaN();
  double speed = planner::base::kInfinity;  ///< m/s; infinite: MPC_XY_CRUISE
  bool takeoff = false;
};

class Mission {
 public:
  /// Begins at `current`, or, without one, where it is if that is in the list. A flight that is on goes on with it.
  void replace(std::vector<MissionItem> items, std::optional<std::size_t> current = std::nullopt);
  /// False: there is no such item.
  bool set_current(std::size_t item);
  /// The mode begins, or begins again. After a flight that ended with the last item it is the whole mission once more.
  void begin(const MissionView& view);
  /// Another mode flies.
  void pause();
  void note_disarmed() { disarmed_ = true; }
  /// The local frame moved by that much under the vehicle.
  void shift(const Vec3& by) { start_ += by; }
  /// Once a step while it flies. Complexity: constant; at most one item a step is finished.
  [[nodiscard]] MissionOrder update(const MissionView& view);

  [[nodiscard]] bool available() const { return !items_.empty(); }
  [[nodiscard]] std::size_t size() const { return items_.size(); }
  [[nodiscard]] std::size_t current() const { return current_; }
  /// The item last reached since the mode began.
  [[nodiscard]] std::optional<std::size_t> reached() const { return reached_; }
  [[nodiscard]] bool begun() const { return begun_; }
  [[nodiscard]] bool finished() const { return finished_; }

 private:
  void start_item(const MissionView& view);
  /// Whether the item that is on is done.
  [[nodiscard]] bool perform(const MissionView& view);
  [[nodiscard]] bool at_place(const MissionView& view, const Vec3& place, double radius) const;
  [[nodiscard]] bool stayed(const MissionView& view, double duration);
  void fly_to(const MissionView& view, const Vec3& place, double yaw);
  [[nodiscard]] bool land(const MissionView& view, const Vec3& place);
  [[nodiscard]] bool jump(const MissionItem& item);
  void advance();
  [[nodiscard]] Vec3 place(const MissionItem& item, const MissionView& view) const;

  std::vector<MissionItem> items_{};
  std::vector<int> repeats_left_{};  ///< by item
  std::size_t current_ = 0;
  std::optional<std::size_t> reached_{};
  MissionOrder order_{};
  Vec3 start_ = Vec3::Zero();         ///< local, where the item was begun
  std::optional<double> climb_to_{};  ///< local height, before anything else
  std::optional<double> there_since_{};
  double speed_ = planner::base::kInfinity;
  bool fresh_ = false;       ///< the item is yet to be started
  bool over_place_ = false;  ///< of a landing
  bool active_ = false;      ///< its mode flies
  bool begun_ = false;
  bool finished_ = false;
  bool disarmed_ = false;  ///< since it began
};

}  // namespace jink::sim::vehicle
