// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/mavlink/adsb_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "bridge/tracking/track_inbox.hpp"
#include "planner/base/portable_math.hpp"

namespace jink::bridge::mavlink {

using planner::base::Track;

namespace {

// ADSB_FLAGS.
constexpr std::uint32_t kValidCoordinates = 1;
constexpr std::uint32_t kValidAltitude = 2;
constexpr std::uint32_t kValidHeading = 4;
constexpr std::uint32_t kValidVelocity = 8;
constexpr std::uint32_t kValidVerticalVelocity = 128;
constexpr std::uint32_t kGeometricAltitude = 1;  // ADSB_ALTITUDE_TYPE

constexpr double kFastest = 1000.0;  // m/s

bool has(const AdsbReport& report, std::uint32_t flag) {
  return (report.flags & flag) != 0U;
}

bool within(double value, double limit) {
  return std::abs(value) <= limit;  // false for NaN
}

// The velocity and its standard deviation, from what is valid in the report; returns that of the climb.
double set_velocity(const AdsbReport& report, Track& track) {
  const bool speed_told = has(report, kValidVelocity) && within(report.horizontal_velocity, kFastest);
  const bool course_told = has(report, kValidHeading) && within(report.heading_deg, 360.0);
  const bool climb_told = has(report, kValidVerticalVelocity) && within(report.vertical_velocity, kFastest);
  track.velocity_sigma = AdsbTracks::kVelocitySigma;
  if (speed_told && course_told) {
    const double yaw = frames::yaw_enu_from_heading(report.heading_deg * std::numbers::pi / 180.0);
    track.velocity = report.horizontal_velocity * Vec3(std::cos(yaw), std::sin(yaw), 0.0);
  } else {
    const double speed = speed_told ? report.horizontal_velocity : emitter_model(report.emitter_type).speed;
    track.velocity_sigma = planner::base::hypotenuse(track.velocity_sigma, speed);
  }
  if (climb_told) {
    track.velocity.z() = report.vertical_velocity;
    return 0.0;
  }
  track.velocity_sigma = planner::base::hypotenuse(track.velocity_sigma, AdsbTracks::kClimbSigma);
  return AdsbTracks::kClimbSigma;
}

}  // namespace

EmitterModel emitter_model(std::uint32_t emitter_type) {
  switch (emitter_type) {
    case 1:
      return {10.0, 80.0};
    case 2:
      return {16.0, 150.0};
    case 3:
      return {25.0, 200.0};
    case 4:
      return {25.0, 250.0};
    case 6:
      return {10.0, 300.0};
    case 7:
      return {15.0, 80.0};
    case 9:
      return {15.0, 60.0};
    case 10:
      return {40.0, 30.0};
    case 11:
      return {5.0, 20.0};
    case 12:
      return {8.0, 40.0};
    case 14:
      return {5.0, 50.0, /*crewed=*/false};
    case 17:
    case 18:
      return {8.0, 30.0, /*crewed=*/false};
    case 19:
      return {15.0, 0.0, /*crewed=*/false};
    default:
      return {40.0, 250.0};
  }
}

AdsbTracks::AdsbTracks(Reports reports, Origin origin, const base::Clock& clock,
                       std::optional<std::uint32_t> own_address)
    : reports_(std::move(reports)), origin_(std::move(origin)), clock_(clock), own_address_(own_address) {}

bool AdsbTracks::refuse(std::uint32_t icao_address, const char* why) {
  ++dropped_;
  ++status_.dropped_tracks;
  status_.last_refusal = "ADS-B aircraft " + std::to_string(icao_address) + ": " + why;
  return false;
}

bool AdsbTracks::take(const AdsbReport& report) {
  senders_[(std::uint64_t{report.system} << 32U) | report.component] = report.received;
  const std::uint32_t id = report.icao_address;
  if (own_address_ == id) return false;
  if (!has(report, kValidCoordinates) || !within(report.latitude_deg, 90.0) || !within(report.longitude_deg, 180.0)) {
    return refuse(id, "no valid coordinates");
  }
  if (!has(report, kValidAltitude) || !within(report.altitude_m, AdsbTracks::kRange)) {
    return refuse(id, "no valid altitude");
  }
  if (!(report.since_contact <= kKeep_s)) return refuse(id, "not heard by its receiver for too long");
  const std::optional<frames::Geodetic> origin = origin_();
  if (!origin) return refuse(id, "the autopilot's local origin is not known yet");
  Track track;
  track.id = id;
  track.position = frames::LocalFrame(*origin).to_enu({report.latitude_deg, report.longitude_deg, report.altitude_m});
  if (!(track.position.norm() <= kRange)) return refuse(id, "too far away");
  if (aircraft_.size() >= kMostAircraft && !aircraft_.contains(id)) return refuse(id, "too many aircraft");
  const EmitterModel model = emitter_model(report.emitter_type);
  const double vertical_sigma = report.altitude_type == kGeometricAltitude ? kGeometricSigma : kBarometricSigma;
  track.position_sigma = planner::base::hypotenuse(kHorizontalSigma, vertical_sigma);
  track.radius = model.radius + kSigmas * track.position_sigma;
  const double climb_sigma = set_velocity(report, track);
  if (const char* bad = tracking::refusal(track); bad != nullptr) return refuse(id, bad);
  const double measured = report.received - std::max(0.0, report.since_contact);
  const tracking::Aircraft crewed{
      id,         measured, track.position, track.velocity, kHorizontalSigma, vertical_sigma, track.velocity_sigma,
      climb_sigma};
  aircraft_[id] = {track, crewed, model.crewed, measured};
  return true;
}

bool AdsbTracks::poll(tracking::TrackMessage& message) {
  AdsbReport report;
  bool fresh = false;
  while (reports_(report)) fresh = take(report) || fresh;
  const double now = clock_.now();
  std::erase_if(aircraft_, [&](const auto& entry) { return now - entry.second.measured > kKeep_s; });
  std::erase_if(senders_, [&](const auto& entry) { return now - entry.second > kSender_s; });
  status_.writers = static_cast<int>(senders_.size());
  const bool due = !aircraft_.empty() && now - last_message_ >= kRepeat_s;
  if (!fresh && !due) return false;
  message = tracking::TrackMessage{{kWriter, now, 0.0}, {}, std::exchange(dropped_, 0)};
  message.placed = true;
  message.sends_when_empty = false;
  for (const auto& [id, aircraft] : aircraft_) {
    const double age = std::max(0.0, now - aircraft.measured);
    Track track = aircraft.track;
    track.position += track.velocity * age;
    const double position_sigma =
        std::hypot(track.position_sigma, track.velocity_sigma * age, kManoeuvre * age * age / 2.0);
    // Beyond the limit a track is refused, and one that hardly anything is known of must not vanish.
    track.position_sigma = std::min(position_sigma, tracking::TrackLimits::kSigma);
    track.velocity_sigma =
        std::min(planner::base::hypotenuse(track.velocity_sigma, kManoeuvre * age), tracking::TrackLimits::kSigma);
    track.age = age;
    message.tracks.push_back(track);
    if (aircraft.is_crewed) message.aircraft.push_back(aircraft.crewed);
  }
  last_message_ = now;
  ++status_.messages;
  return true;
}

tracking::TrackSourceStatus AdsbTracks::status() const {
  return status_;
}

}  // namespace jink::bridge::mavlink
