// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/tracks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "ObstacleTracks.h"
#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/frames/conversions.hpp"
#include "bridge/tracking/track_inbox.hpp"
#include "planner/base/solid.hpp"

namespace jink::bridge::dds {

namespace {

using planner::base::Track;

template <typename Wire>
void to_wire(const Vec3& v, Wire& wire) {
  wire.x(v.x());
  wire.y(v.y());
  wire.z(v.z());
}

/// A solid as it is turned now. A hull of too many vertices, and a prism that is neither box, cylinder nor capsule, go
/// as their spheres.
void to_wire(const planner::base::Body& body, jink_msgs::msg::dds_::ObstacleShape_& wire) {
  wire = {};
  if (body.solid == nullptr || body.solid->vertices().size() > cdr::kMostVertices) return;
  const planner::base::Solid& solid = *body.solid;
  const Eigen::Matrix3d yaw = Eigen::AngleAxisd(body.yaw, Vec3::UnitZ()).toRotationMatrix();
  const Eigen::Quaterniond orientation(Eigen::Matrix3d(solid.is_hull() ? yaw : yaw * solid.pose().axes));
  const bool is_round = solid.half().head<2>().isZero(0.0);
  Vec3 size = 2.0 * solid.half();
  cdr::ShapeOnWire type = cdr::ShapeOnWire::kSphere;
  if (solid.is_hull()) {
    type = cdr::ShapeOnWire::kHull;
    for (const Vec3& vertex : solid.vertices()) {
      wire.vertices().emplace_back();
      to_wire(vertex, wire.vertices().back());
    }
  } else if (solid.corner() == 0.0 && solid.rounding() == 0.0) {
    type = cdr::ShapeOnWire::kBox;
  } else if (is_round && solid.rounding() == 0.0) {
    type = cdr::ShapeOnWire::kCylinder;
    size.x() = size.y() = 2.0 * solid.corner();
  } else if (is_round && solid.corner() == 0.0) {
    type = cdr::ShapeOnWire::kCapsule;
    size += Vec3::Constant(2.0 * solid.rounding());
  }
  wire.type(static_cast<std::uint8_t>(type));
  to_wire(yaw * solid.pose().center, wire.center());
  wire.orientation().x(orientation.x());
  wire.orientation().y(orientation.y());
  wire.orientation().z(orientation.z());
  wire.orientation().w(orientation.w());
  wire.yaw_rate(body.yaw_rate);
  to_wire(size, wire.size());
}

}  // namespace

class DdsTrackReader::Impl {
 public:
  Impl(DdsParticipant& node, const base::Clock& clock, const TrackReaderOptions& options)
      : clock_(clock),
        options_(options),
        names_(node.impl().names()),
        topic_(track_topic_info(options.format)),
        reader_(node, track_topic(options.format, options.name_space), topic_.type,
                [this](const Payload& payload, const SampleWriter& writer) { accept(payload, writer); }) {}

  bool poll(tracking::TrackMessage& message) { return inbox_.poll(message); }
  void notify(base::Notifier& notifier) { inbox_.notify(notifier); }
  [[nodiscard]] tracking::TrackSourceStatus status() const {
    tracking::TrackSourceStatus status = inbox_.status();
    status.writers = reader_.writers();
    status.malformed = malformed_;
    if (status.last_refusal.empty()) status.last_refusal = reader_.mismatch();
    return status;
  }
  [[nodiscard]] std::uint64_t overruns() const { return inbox_.overruns(); }
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }

 private:
  // On Fast DDS's thread: the payload as a message into the inbox, or refused.
  void accept(const Payload& payload, const SampleWriter& writer) {
    const double received = clock_.now();
    std::size_t named = 0;
    if (!options_.writers.empty()) {
      const std::string name = names_.name_of(writer.participant);
      const auto allowed = options_.writers.find(name);
      if (allowed == options_.writers.end())
        return inbox_.refuse("tracks of '" + cdr::printable(name) + "', whom the mission does not name");
      named = allowed->second;
    }
    std::optional<tracking::DecodedTracks> message = topic_.decode(payload);
    if (!message) {
      ++malformed_;
      return;
    }
    if (const std::string& frame = message->frame_id; frame != "map" && !(topic_.ned && frame == "ned")) {
      const std::string found = "frame_id '" + cdr::printable(frame) + "' is ";
      return inbox_.refuse(topic_.ned ? found + "neither 'map' nor 'ned'" : topic_.name + (": " + found) + "not 'map'");
    }
    if (options_.origin && !place(message->tracks))
      return inbox_.refuse("tracks with an origin of their own: the autopilot's is not known yet");
    message->tracks.named = named;
    message->tracks.writer = writer.identity;
    message->tracks.received = received;
    message->tracks.stamp_age = system_time() - message->stamp_unix_s;
    inbox_.put(std::move(message->tracks), message->why);
  }

  // From the source's frame into the autopilot's; false where that is not known.
  bool place(tracking::TrackMessage& message) {
    const std::optional<frames::Geodetic> local = options_.local_origin();
    if (!local) return false;
    if (local != local_origin_) {
      local_origin_ = local;
      to_local_ = frames::between(*options_.origin, *local);
    }
    for (Track& track : message.tracks) {
      track.position = to_local_ * track.position;
      track.velocity = to_local_.linear() * track.velocity;
      track.acceleration = to_local_.linear() * track.acceleration;
      track.body.yaw += std::atan2(to_local_.linear()(1, 0), to_local_.linear()(0, 0));
    }
    message.placed = true;
    return true;
  }

  const base::Clock& clock_;
  const TrackReaderOptions options_;
  const ParticipantNames& names_;
  const TrackTopicInfo& topic_;
  std::optional<frames::Geodetic> local_origin_;
  Eigen::Isometry3d to_local_ = Eigen::Isometry3d::Identity();
  std::atomic<std::uint64_t> malformed_ = 0;
  tracking::TrackInbox inbox_;
  PayloadReader reader_;  // last: its destruction ends the callbacks while all else still stands
};

const TrackTopicInfo& track_topic_info(TrackFormat format) {
  static constexpr std::array<TrackTopicInfo, 3> kTopics{
      {{kTracksTopic, kTracksType, "", true, cdr::decode_obstacle_tracks},
       {kAutowareTopic, kAutowareType, "TrackedObjects", false, cdr::decode_tracked_objects},
       {kVisionTopic, kVisionType, "Detection3DArray", false, cdr::decode_detections}}};
  return kTopics.at(static_cast<std::size_t>(format));
}

std::string track_topic(TrackFormat format, const std::string& name_space) {
  const std::string topic = track_topic_info(format).topic;
  return name_space.empty() ? topic : "rt/" + name_space + topic.substr(2);
}

DdsTrackReader::DdsTrackReader(DdsParticipant& node, const base::Clock& clock, const TrackReaderOptions& options)
    : impl_(std::make_unique<Impl>(node, clock, options)) {}
DdsTrackReader::DdsTrackReader(int domain, const base::Clock& clock)
    : own_node_(std::make_unique<DdsParticipant>(domain, "jink track reader")),
      impl_(std::make_unique<Impl>(*own_node_, clock, TrackReaderOptions{})) {}
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
  Impl(DdsParticipant& node, const std::string& name_space)
      : writer_(node, track_topic(TrackFormat::kJink, name_space), kTracksType, {.large = true}) {}

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
    const bool shapes =
        std::any_of(tracks.begin(), tracks.end(), [](const Track& track) { return track.body.solid != nullptr; });
    message_.shapes().resize(shapes ? tracks.size() : 0);
    for (std::size_t i = 0; i < message_.shapes().size(); ++i) to_wire(tracks[i].body, message_.shapes()[i]);
    return writer_.write_message(message_);
  }

  int readers() const { return writer_.readers(); }

 private:
  jink_msgs::msg::dds_::ObstacleTracks_ message_;  // reused, so that a steady number of tracks does not allocate
  PayloadWriter writer_;
};

DdsTrackWriter::DdsTrackWriter(DdsParticipant& node, const std::string& name_space)
    : impl_(std::make_unique<Impl>(node, name_space)) {}
DdsTrackWriter::DdsTrackWriter(int domain, const std::string& name_space, const std::filesystem::path& security)
    : own_node_(std::make_unique<DdsParticipant>(domain, "jink track writer", security)),
      impl_(std::make_unique<Impl>(*own_node_, name_space)) {}
DdsTrackWriter::~DdsTrackWriter() = default;
bool DdsTrackWriter::publish(std::span<const Track> tracks, double stamp_unix_s, const std::string& frame_id) {
  return impl_->publish(tracks, stamp_unix_s, frame_id);
}
int DdsTrackWriter::readers() const {
  return impl_->readers();
}

}  // namespace jink::bridge::dds
