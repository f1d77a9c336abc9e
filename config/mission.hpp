// SPDX-License-Identifier: BSD-3-Clause
// A mission for `jink fly` and `jink doctor`, as the file describes it: plain values, checked.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/sensed_from.hpp"
#include "config/unknown.hpp"
#include "planner/base/types.hpp"
#include "planner/geometry/static_map.hpp"

namespace jink::config {

enum class Arrival { kLand, kHold };

/// Where the vehicle's position comes from and where setpoints go: MAVLink, or DDS as PX4's uXRCE-DDS agent has it.
/// Arming, modes and health are MAVLink's in either case.
enum class Transport { kMavlink, kDds };

/// What waypoints, geofence, map and no_fly are above.
enum class Heights { kGround, kOrigin, kSea };

/// A source of tracks on DDS; whose index is that in TrackPolicy::origins.
enum class TrackTopic { kJink, kAutoware, kVision };
inline constexpr std::array<TrackTopic, 3> kTrackTopics = {TrackTopic::kJink, TrackTopic::kAutoware,
                                                           TrackTopic::kVision};

/// Who may tell of obstacles.
struct TrackSources {
  bool jink = true;      ///< jink_msgs/ObstacleTracks on DDS
  bool autoware = true;  ///< autoware_perception_msgs/TrackedObjects on DDS
  bool vision = true;    ///< vision_msgs/Detection3DArray on DDS
  bool adsb = true;      ///< ADSB_VEHICLE on the MAVLink connection

  [[nodiscard]] bool has(TrackTopic topic) const {
    return topic == TrackTopic::kJink ? jink : topic == TrackTopic::kAutoware ? autoware : vision;
  }
};

/// What a vehicle is left in when a flight is ended: each is a mode of the autopilot, in which it avoids nothing.
enum class EndsIn { kHold, kLand, kReturn };

/// By the cause for which a flight is ended; after a stop that is checked against all that is known.
struct Endings {
  EndsIn tracks =
      EndsIn::kHold;            ///< they are stale, a writer fell silent: where it stopped is what was seen to be free
  EndsIn link = EndsIn::kHold;  ///< position, heartbeat, setpoints: the autopilot's own failsafe acts before that
  EndsIn position = EndsIn::kHold;  ///< GPS or the local position is lost: never kReturn, which needs one
  EndsIn battery = EndsIn::kLand;   ///< critical: it is the one that does not wait
  EndsIn breach = EndsIn::kHold;    ///< out of the geofence, or of what the vehicle can follow
  EndsIn traffic = EndsIn::kLand;   ///< a crewed aircraft comes: on the ground it is clear of it, above it seldom is
  EndsIn planner = EndsIn::kHold;   ///< late, failed, or this program did not run

  // Dangers that the mission's author takes.
  bool motors_cut = false;          ///< the autopilot's own failsafe stops them in the air
  bool return_above_fence = false;  ///< RETURN climbs out of the geofence
  bool hover_until_empty = false;   ///< HOLD with a critical battery
};

/// A DDS participant whose tracks of a topic are taken, and needed.
struct TrackWriter {
  TrackTopic topic = TrackTopic::kJink;
  std::string participant;
};

/// WGS 84, as bridge::frames::Geodetic.
struct GeodeticOrigin {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;  ///< above the sea
};

struct TrackPolicy {
  bool required = true;    ///< no flight without a live track writer
  double timeout_s = 1.0;  ///< silence of the writers after which the tracks are stale
  double coast_s = 1.0;    ///< how long a track that is no longer reported is predicted on
  SensedFrom sensed_from = SensedFrom::kWorld;
  TrackSources sources;
  std::string name_space;            ///< before the topics: "uav_1" means rt/uav_1/jink/...
  std::vector<TrackWriter> writers;  ///< each is needed, and others are not heard; empty: any is
  /// Of the topics' frames; none: the autopilot's local origin.
  std::array<std::optional<GeodeticOrigin>, kTrackTopics.size()> origins;
};

/// A depth camera or lidar of the vehicle, whose clouds of points come over DDS.
struct CloudPolicy {
  std::string frame = "base_link";  ///< of the clouds, beside `map` and `ned`
  /// Where that frame is in the body's (x ahead, y left, z up), m.
  Vec3 position = Vec3::Zero();
  /// Yaw, pitch and roll of that frame's axes there, rad: Rz(yaw) Ry(pitch) Rx(roll).
  Vec3 orientation = Vec3::Zero();
  double range = 8.0;      ///< m, farther points say only that the way to there is free
  double timeout_s = 1.0;  ///< silence after which the clouds are stale
  double forget_s = 60.0;  ///< after which what was seen well, and is seen no more, is not known any more
  Unknown unknown = Unknown::kFree;
  /// It sees all round. Else the vehicle looks where it flies, and is slow where it cannot yet.
  bool all_round = false;
  bool operator==(const CloudPolicy&) const = default;
};

struct Mission {
  std::string name;
  std::string connection;    ///< a MAVSDK URL
  int system_id = 0;         ///< of the autopilot, MAVLink; 0: that of the only one there
  std::string vehicle_name;  ///< "inline" where the file gives a map
  planner::base::VehicleLimits vehicle;
  double takeoff_height = 1.5;  ///< above the ground at take-off
  double min_height = 1.0;      ///< above the ground; the plan never goes below
  Heights heights = Heights::kGround;
  std::vector<Vec3> waypoints;
  Arrival arrival = Arrival::kLand;
  planner::base::Box geofence;  ///< unbounded when the file has none
  /// Of `map` and `no_fly`, and the fence below once it is read; never null. Shared: missions are copied at each jump
  /// of the frame.
  std::shared_ptr<const planner::geometry::StaticMap> map = std::make_shared<const planner::geometry::StaticMap>();
  double map_up = 0.0;           ///< z of the local frame less the map's; no key of the file, see in_local_frame
  bool autopilot_fence = false;  ///< `fence: autopilot`: the one stored there counts, see bridge/map/fence.hpp
  int dds_domain = 0;
  std::string dds_namespace;           ///< before PX4's topics: "px4_1" means rt/px4_1/fmu/...; empty: rt/fmu/...
  std::filesystem::path dds_security;  ///< folder of keys as SROS 2 lays out an enclave's; empty: none
  Transport state = Transport::kMavlink;
  Transport setpoints = Transport::kMavlink;
  bool intents = true;                        ///< tells the team's other vehicles the committed path, and avoids theirs
  std::optional<std::uint32_t> icao_address;  ///< of the vehicle's own transponder
  TrackPolicy tracks;
  std::optional<CloudPolicy> cloud;  ///< none: nothing is seen but tracks
  Endings endings;
  double acceptance_radius = 0.0;  ///< m, about the last waypoint, in which it is reached at any speed; 0: at it, slow
  double hold_time = 0.0;          ///< s, that it stays about the last waypoint once it has been there, and evades
  double time_limit = 300.0;
  double ground = 0.0;  ///< its height; no key of the file, see in_local_frame
};

/// Reads and checks a jink-mission/1 file; throws ConfigError as load_scenario does, and finds vehicles as it does.
///
/// Required: format, name, connection, vehicle, waypoints (one or more). Optional, with the defaults of Mission:
/// system_id, icao_address (six hexadecimal digits), takeoff_height, min_height, heights (ground, origin or amsl),
/// arrival, geofence (unbounded; with both min and max when given), map and no_fly (config/map_reader.hpp), fence
/// (autopilot), dds and each of its keys (security: a folder, from
/// the file's on), tracks and each of its keys, cloud and each of its keys (mount: position and orientation; unknown:
/// free), endings and each of its keys, state and setpoints (mavlink or dds),
/// intents, time_limit.
///
/// `connection` is scheme://ADDRESS with udp, udpin, udpout, tcp, tcpin or tcpout and [HOST]:PORT (udpout, tcp and
/// tcpout need the host), or serial or serial_flowcontrol and /DEVICE[:BAUD]. With heights above the ground a waypoint
/// may be lower than min_height, as the flight raises it to that; so raised it must lie in the geofence, and
/// takeoff_height and min_height must be below the geofence's top. With others that shows where the vehicle stands.
Mission load_mission(const std::filesystem::path& file, const std::filesystem::path& vehicles = {});

/// Whether `text` may stand before topics: names of letters, digits and underscores, parted by slashes.
[[nodiscard]] bool is_namespace(std::string_view text);
/// The first file that a folder of DDS keys lacks, as SROS 2 makes them for an enclave; empty: none.
[[nodiscard]] std::string_view missing_security_file(const std::filesystem::path& folder);

/// `mission` with its heights as z of a local ENU frame, min_height too: `ground` is that of the ground, `origin_amsl`
/// the origin's height above the sea.
Mission in_local_frame(Mission mission, double ground, double origin_amsl);

}  // namespace jink::config
