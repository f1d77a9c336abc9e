// SPDX-License-Identifier: BSD-3-Clause
// Other aircraft as obstacle tracks: what an ADS-B receiver on the MAVLink connection tells (ADSB_VEHICLE), placed with
// the autopilot's local origin.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>

#include "bridge/base/clock.hpp"
#include "bridge/frames/conversions.hpp"
#include "bridge/tracking/track_source.hpp"

namespace jink::bridge::mavlink {

/// ADSB_VEHICLE as it came; units as named. NaN: not in the message.
struct AdsbReport {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  double received = 0.0;     ///< companion's clock
  std::uint32_t system = 0;  ///< who sent it
  std::uint32_t component = 0;
  std::uint32_t icao_address = 0;
  double latitude_deg = kNone;
  double longitude_deg = kNone;
  double altitude_m = kNone;
  std::uint32_t altitude_type = 0;     ///< ADSB_ALTITUDE_TYPE: 0 barometric (QNH), 1 geometric
  double heading_deg = kNone;          ///< course over ground, clockwise from north
  double horizontal_velocity = kNone;  ///< m/s
  double vertical_velocity = kNone;    ///< m/s, up
  std::uint32_t emitter_type = 0;      ///< ADSB_EMITTER_TYPE
  double since_contact = 0.0;          ///< tslc: seconds since the aircraft was last heard
  std::uint32_t flags = 0;             ///< ADSB_FLAGS
};

/// What ADSB_EMITTER_TYPE says of an aircraft.
struct EmitterModel {
  double radius = 0.0;  ///< m, half the greatest extent of the largest common one of the class
  double speed = 0.0;   ///< m/s, what it may do where nothing is known of its speed
  bool crewed = true;   ///< in the air with people on board: all but 14 and 17 to 19
};
/// | type | class | radius m | speed m/s |
/// |---|---|---|---|
/// | 1 light, 2 small, 3 large | up to 7, 34, 136 t | 10, 16, 25 | 80, 150, 200 |
/// | 4 high vortex, 5 heavy | B757; above 136 t | 25, 40 | 250 |
/// | 6 highly manoeuvrable | fighters | 10 | 300 |
/// | 7 rotorcraft | | 15 | 80 |
/// | 9 glider, 10 lighter than air | span 30 m; airship 75 m long | 15, 40 | 60, 30 |
/// | 11 parachute, 12 ultralight | | 5, 8 | 20, 40 |
/// | 14 UAV | | 5 | 50 |
/// | 17, 18 surface vehicles, 19 obstacle | | 8, 8, 15 | 30, 30, 0 |
/// | any other, 0 not told | the largest | 40 | 250 |
[[nodiscard]] EmitterModel emitter_model(std::uint32_t emitter_type);

/// The aircraft in view as tracks. A message of this source holds all of them, each predicted to the instant of the
/// message with its velocity; it comes with each report, and every kRepeat_s while any is in view. An aircraft stays in
/// view for kKeep_s after it was last heard (by the receiver's own account, tslc). The id is the ICAO address.
///
/// Where: latitude, longitude and altitude less those of the autopilot's local origin (never its home). Altitudes are
/// taken as above mean sea level, as the origin's is. A barometric one (QNH) is off by the weather and the temperature;
/// a geometric one stands, with many senders, above the ellipsoid, which lies up to 100 m off the sea level. That error
/// is in position_sigma: the root of the squares of kHorizontalSigma, of the altitude's (kBarometricSigma or
/// kGeometricSigma), and of the velocity's times the age with what an aircraft turns in it (kManoeuvre); never
/// more than TrackLimits::kSigma.
///
/// Velocity: what the flags call valid. Where the speed is not told, the track's horizontal velocity is 0 and
/// velocity_sigma the speed of its class (EmitterModel); where the course is not, 0 and the speed told; where the
/// climb is not, 0 and kClimbSigma. All told: kVelocitySigma.
///
/// A track's radius is that of its class and kSigmas times the position's sigma as measured: the planner's own margin
/// for what is uncertain ends at decimetres. Crewed aircraft are told as such too (TrackMessage::aircraft, WellClear).
///
/// Left out: the vehicle's own transponder (`own_address`). Left out, counted and said why: no coordinates or no
/// altitude, by flag or value; no origin yet; farther away than kRange; not heard for kKeep_s.
///
/// A receiver with an empty sky sends nothing, so silence says nothing: status().writers counts the senders heard
/// within kSender_s, and an ADS-B receiver alone is no proof of a live source. Not thread-safe.
class AdsbTracks final : public tracking::TrackSource {
 public:
  static constexpr double kKeep_s = 6.0;
  static constexpr double kRepeat_s = 0.5;
  static constexpr double kSender_s = 10.0;
  static constexpr double kRange = 5e4;             ///< m
  static constexpr double kHorizontalSigma = 15.0;  ///< m: NACp 9, 30 m in 95 % of the time
  static constexpr double kBarometricSigma = 20.0;  ///< m
  static constexpr double kGeometricSigma = 40.0;   ///< m
  static constexpr double kVelocitySigma = 2.0;     ///< m/s
  static constexpr double kClimbSigma = 5.0;        ///< m/s
  static constexpr double kManoeuvre = 2.0;         ///< m/s^2
  static constexpr double kSigmas = 2.0;
  static constexpr std::uint64_t kWriter = 0x4a494e4b41445342U;  ///< "JINKADSB": no DDS writer's hash but by accident
  static constexpr std::size_t kMostAircraft = 1024;

  /// Where reports come from: gives the oldest one not yet taken; false when there is none. MavsdkLink::next_adsb.
  using Reports = std::function<bool(AdsbReport&)>;
  /// The autopilot's local origin as it stands; MavsdkLink::state().origin.
  using Origin = std::function<std::optional<frames::Geodetic>()>;

  /// `own_address`: the vehicle's ICAO address; none: it has no transponder, or it is not known.
  AdsbTracks(Reports reports, Origin origin, const base::Clock& clock,
             std::optional<std::uint32_t> own_address = std::nullopt);

  bool poll(tracking::TrackMessage& message) override;
  [[nodiscard]] tracking::TrackSourceStatus status() const override;

 private:
  struct Aircraft {
    planner::base::Track track;  // as told
    tracking::Aircraft crewed;
    bool is_crewed = true;
    double measured = 0.0;  // companion's clock
  };
  bool take(const AdsbReport& report);
  bool refuse(std::uint32_t icao_address, const char* why);

  Reports reports_;
  Origin origin_;
  const base::Clock& clock_;
  const std::optional<std::uint32_t> own_address_;
  std::map<std::uint32_t, Aircraft> aircraft_;  // by ICAO address
  std::map<std::uint64_t, double> senders_;     // newest report of each
  double last_message_ = -1.0;
  std::uint32_t dropped_ = 0;  // since the last message
  tracking::TrackSourceStatus status_;
};

}  // namespace jink::bridge::mavlink
