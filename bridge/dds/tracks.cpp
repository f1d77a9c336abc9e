// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/tracks.hpp"

#include <atomic>
#include <cmath>
#include <string>
#include <utility>

#include "ObstacleTracks.h"
#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/track_feed.hpp"
#include "bridge/tracking/track_inbox.hpp"

namespace jink::bridge::dds {

namespace {

using planner::base::Track;

template <typename Wire>
void to_wire(const Vec3& v, Wire& wire) {
  wire.x(v.x());
  wire.y(v.y());
  wire.z(v.z());
}

}  // namespace

class DdsTrackReader::Impl : public DdsTrackFeed {
 public:
  Impl(DdsParticipant& node, const base::Clock& clock)
      : DdsTrackFeed(node, clock, {kTracksTopic, kTracksType, cdr::decode_obstacle_tracks, refuse_frame}) {}

 private:
  static std::string refuse_frame(const std::string& frame_id) {
    if (frame_id == "map" || frame_id == "ned") return {};
    return "frame_id '" + cdr::printable(frame_id) + "' is neither 'map' nor 'ned'";
  }
};

DdsTrackReader::DdsTrackReader(DdsParticipant& node, const base::Clock& clock)
    : impl_(std::make_unique<Impl>(node, clock)) {}
DdsTrackReader::DdsTrackReader(int domain, const base::Clock& clock)
    : own_node_(std::make_unique<DdsParticipant>(domain, "jink track reader")),
      impl_(std::make_unique<Impl>(*own_node_, clock)) {}
DdsTrackReader::~DdsTrackReader() = default;
bool DdsTrackReader::poll(tracking::TrackMessage& message) {
  return impl_->poll(message);
}
void DdsTrackReader::notify(base::Notifier& notifier) {
  impl_->notify(notifier);
}
tracking::TrackSourceStatus DdsTrackReader::status() const {
  return impl_->status();
}
std::uint64_t DdsTrackReader::overruns() const {
  return impl_->overruns();
}
std::uint64_t DdsTrackReader::malformed() const {
  return impl_->malformed();
}

class DdsTrackWriter::Impl {
 public:
  // A message of some 430 tracks and more does not fit one datagram.
  explicit Impl(DdsParticipant& node) : writer_(node, kTracksTopic, kTracksType, {.large = true}) {}

  bool publish(std::span<const Track> tracks, double stamp_unix_s, const std::string& frame_id) {
    const double sec = std::floor(stamp_unix_s);
    if (!(sec >= 0.0 && sec < 2147483648.0)) return false;  // ROS 2's stamp ends in 2038
    message_.header().stamp().sec(static_cast<std::int32_t>(sec));
    message_.header().stamp().nanosec(static_cast<std::uint32_t>((stamp_unix_s - sec) * 1e9));
    message_.header().frame_id(frame_id);
    message_.tracks().resize(tracks.size());
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      auto& wire = message_.tracks()[i];
      wire.id(tracks[i].id);
      to_wire(tracks[i].position, wire.position());
      to_wire(tracks[i].velocity, wire.velocity());
      to_wire(tracks[i].acceleration, wire.acceleration());
      wire.radius(tracks[i].radius);
      wire.position_sigma(tracks[i].position_sigma);
      wire.velocity_sigma(tracks[i].velocity_sigma);
    }
    return writer_.write_message(message_);
  }

  int readers() const { return writer_.readers(); }

 private:
  jink_msgs::msg::dds_::ObstacleTracks_ message_;  // reused, so that a steady number of tracks does not allocate
  PayloadWriter writer_;
};

DdsTrackWriter::DdsTrackWriter(DdsParticipant& node) : impl_(std::make_unique<Impl>(node)) {}
DdsTrackWriter::DdsTrackWriter(int domain)
    : own_node_(std::make_unique<DdsParticipant>(domain, "jink track writer")),
      impl_(std::make_unique<Impl>(*own_node_)) {}
DdsTrackWriter::~DdsTrackWriter() = default;
bool DdsTrackWriter::publish(std::span<const Track> tracks, double stamp_unix_s, const std::string& frame_id) {
  return impl_->publish(tracks, stamp_unix_s, frame_id);
}
int DdsTrackWriter::readers() const {
  return impl_->readers();
}

}  // namespace jink::bridge::dds
