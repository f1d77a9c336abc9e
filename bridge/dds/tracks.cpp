// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/tracks.hpp"

#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "ObstacleTracks.h"
#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/payload_io.hpp"
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

class DdsTrackReader::Impl {
 public:
  Impl(DdsParticipant& node, const base::Clock& clock, TrackFormat format)
      : clock_(clock),
        topic_(topic_of(format)),
        reader_(node, topic_.name, topic_.type,
                [this](const Payload& payload, std::uint64_t writer) { accept(payload, writer); }) {}

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
  /// A topic and what its payloads are.
  struct Topic {
    const char* name;
    const char* type;
    /// Nothing where a payload is not of the type.
    std::optional<tracking::DecodedTracks> (*decode)(std::span<const std::uint8_t> payload);
    /// Why a message in this frame is refused; empty: it is taken.
    std::string (*refuse_frame)(const std::string& frame_id);
  };

  static Topic topic_of(TrackFormat format) {
    if (format == TrackFormat::kAutoware) {
      return {kAutowareTopic, kAutowareType, cdr::decode_tracked_objects, [](const std::string& frame_id) {
                if (frame_id == "map") return std::string();
                return "TrackedObjects: frame_id '" + cdr::printable(frame_id) + "' is not 'map'";
              }};
    }
    return {kTracksTopic, kTracksType, cdr::decode_obstacle_tracks, [](const std::string& frame_id) {
              if (frame_id == "map" || frame_id == "ned") return std::string();
              return "frame_id '" + cdr::printable(frame_id) + "' is neither 'map' nor 'ned'";
            }};
  }

  // On Fast DDS's thread: the payload as a message into the inbox, or refused.
  void accept(const Payload& payload, std::uint64_t writer) {
    const double received = clock_.now();
    std::optional<tracking::DecodedTracks> message = topic_.decode(payload);
    if (!message) {
      ++malformed_;
    } else if (const std::string why = topic_.refuse_frame(message->frame_id); !why.empty()) {
      inbox_.refuse_frame(why);
    } else {
      message->tracks.writer = writer;
      message->tracks.received = received;
      message->tracks.stamp_age = system_time() - message->stamp_unix_s;
      inbox_.put(std::move(message->tracks), message->why);
    }
  }

  const base::Clock& clock_;
  Topic topic_;
  std::atomic<std::uint64_t> malformed_ = 0;
  tracking::TrackInbox inbox_;
  PayloadReader reader_;  // last: its destruction ends the callbacks while all else still stands
};

DdsTrackReader::DdsTrackReader(DdsParticipant& node, const base::Clock& clock, TrackFormat format)
    : impl_(std::make_unique<Impl>(node, clock, format)) {}
DdsTrackReader::DdsTrackReader(int domain, const base::Clock& clock)
    : own_node_(std::make_unique<DdsParticipant>(domain, "jink track reader")),
      impl_(std::make_unique<Impl>(*own_node_, clock, TrackFormat::kJink)) {}
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
