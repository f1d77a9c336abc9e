// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds_tracks.hpp"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ObstacleTracksPubSubTypes.h"
#include "bridge/frames.hpp"

#if defined(__SANITIZE_ADDRESS__)
// Debian's Fast DDS 2.9.1 deletes its own statistics object through a base without a virtual destructor whenever a
// writer goes. Only that check of AddressSanitizer is switched off, and only in its builds.
extern "C" const char* __asan_default_options();  // NOLINT: the sanitizer's name
extern "C" const char* __asan_default_options() {
  return "new_delete_type_mismatch=0";
}  // NOLINT
#endif

namespace jink::bridge {

namespace {

namespace dds = eprosima::fastdds::dds;
using WireMessage = jink_msgs::msg::dds_::ObstacleTracks_;
using WireTrack = jink_msgs::msg::dds_::ObstacleTrack_;
using GeneratedType = jink_msgs::msg::dds_::ObstacleTracks_PubSubType;
using planner::Track;
using planner::Vec3;

constexpr int kHistoryDepth = 64;  // samples of several writers that may wait for the listener
constexpr std::uint32_t kSocketBuffer_bytes = 1
                                              << 20;  // a burst of fragments; Linux gives what net.core.*mem_max allows
constexpr std::size_t kWireTrack_bytes = 8 + 9 * 8 + 3 * 8;

// The generated type, with a look at the payload before it is decoded: the generated code resizes its sequence to
// whatever length the payload states, up to 4 billion, and lets the exceptions of that go through Fast DDS.
class CheckedType final : public GeneratedType {
 public:
  explicit CheckedType(std::atomic<std::uint64_t>* malformed = nullptr) : malformed_(malformed) {}

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    if (plausible(*payload) && GeneratedType::deserialize(payload, data)) return true;
    if (malformed_ != nullptr) ++*malformed_;
    return false;
  }

 private:
  static bool plausible(const eprosima::fastrtps::rtps::SerializedPayload_t& payload) {
    namespace cdr = eprosima::fastcdr;
    try {
      // FastBuffer takes a mutable pointer, for writing; nothing is written here.
      cdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data), payload.length);  // NOLINT: the library's interface
      cdr::Cdr reader(buffer, cdr::Cdr::DEFAULT_ENDIAN, cdr::Cdr::DDS_CDR);
      std::int32_t sec = 0;
      std::uint32_t nanosec = 0;
      std::string frame_id;
      std::uint32_t count = 0;
      reader.read_encapsulation();
      reader >> sec >> nanosec >> frame_id >> count;
      return static_cast<std::size_t>(count) * kWireTrack_bytes <= payload.length;
    } catch (const cdr::exception::Exception&) {
      return false;
    }
  }

  std::atomic<std::uint64_t>* malformed_;
};

template <typename Wire>
Vec3 from_wire(const Wire& wire) {
  return {wire.x(), wire.y(), wire.z()};
}

template <typename Wire>
void to_wire(const Vec3& v, Wire& wire) {
  wire.x(v.x());
  wire.y(v.y());
  wire.z(v.z());
}

Track from_wire_track(const WireTrack& wire, bool ned) {
  Track track;
  track.id = wire.id();
  track.position = from_wire(wire.position());
  track.velocity = from_wire(wire.velocity());
  track.acceleration = from_wire(wire.acceleration());
  if (ned) {
    track.position = enu_from_ned(track.position);
    track.velocity = enu_from_ned(track.velocity);
    track.acceleration = enu_from_ned(track.acceleration);
  }
  track.radius = wire.radius();
  track.position_sigma = wire.position_sigma();
  track.velocity_sigma = wire.velocity_sigma();
  return track;
}

// Null when the track is usable, else what is wrong with it. Each comparison is false for NaN.
const char* refusal(const Track& t) {
  using L = TrackLimits;
  if (!(t.position.norm() <= L::kPosition)) return "position";
  if (!(t.velocity.norm() <= L::kVelocity)) return "velocity";
  if (!(t.acceleration.norm() <= L::kAcceleration)) return "acceleration";
  if (!(t.radius > 0.0 && t.radius <= L::kRadius)) return "radius";
  if (!(t.position_sigma >= 0.0 && t.position_sigma <= L::kSigma)) return "position_sigma";
  if (!(t.velocity_sigma >= 0.0 && t.velocity_sigma <= L::kSigma)) return "velocity_sigma";
  return nullptr;
}

// FNV-1a over the writer's GUID: the same for as long as the writer lives, and on every reader.
std::uint64_t writer_hash(const eprosima::fastrtps::rtps::GUID_t& guid) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto mix = [&hash](std::uint8_t byte) { hash = (hash ^ byte) * 0x100000001b3U; };
  for (const auto byte : guid.guidPrefix.value) mix(byte);
  for (const auto byte : guid.entityId.value) mix(byte);
  return hash;
}

// A message's stamp is system time, so its age needs the system's clock and not the companion's.
double system_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// A text of a stranger, short and printable, for the terminal and the log.
std::string printable(const std::string& text) {
  constexpr std::size_t kMax = 40;
  std::string shown = text.substr(0, kMax);
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text.size() > kMax ? shown + "..." : shown;
}

// A participant with the topic: what reader and writer have in common. Destroys all that was made in it.
class Participant {
 public:
  Participant(int domain, const char* name, const dds::TypeSupport& type) {
    if (domain < 0 || domain > kMaxDdsDomain) {
      throw std::runtime_error("dds.domain " + std::to_string(domain) + " is outside [0, 232]");
    }
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    qos.name(name);
    qos.transport().listen_socket_buffer_size = kSocketBuffer_bytes;
    qos.transport().send_socket_buffer_size = kSocketBuffer_bytes;
    participant_ =
        dds::DomainParticipantFactory::get_instance()->create_participant(static_cast<dds::DomainId_t>(domain), qos);
    if (participant_ == nullptr) {
      throw std::runtime_error("DDS domain " + std::to_string(domain) + ": Fast DDS cannot open its transports");
    }
    type.register_type(participant_);
    topic_ = participant_->create_topic(kTracksTopic, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
    if (topic_ == nullptr) {
      destroy();
      throw std::runtime_error(std::string("DDS topic ") + kTracksTopic + " cannot be made");
    }
  }
  ~Participant() { destroy(); }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds::DomainParticipant* operator->() const { return participant_; }
  [[nodiscard]] dds::Topic* topic() const { return topic_; }

 private:
  void destroy() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  dds::DomainParticipant* participant_ = nullptr;
  dds::Topic* topic_ = nullptr;
};

}  // namespace

class DdsTrackReader::Impl final : public dds::DataReaderListener {
 public:
  Impl(int domain, const Clock& clock)
      : clock_(clock), participant_(domain, "jink track reader", dds::TypeSupport(new CheckedType(&malformed_))) {
    dds::Subscriber* subscriber = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = kHistoryDepth;
    // Unbounded type: the payload grows with the message.
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    if (subscriber == nullptr || subscriber->create_datareader(participant_.topic(), qos, this) == nullptr) {
      throw std::runtime_error(std::string("DDS reader of ") + kTracksTopic + " cannot be made");
    }
  }

  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    // A payload that cannot be decoded ends a take like an empty queue does, so what stands behind it is looked for.
    while (reader->get_unread_count() > 0) {
      if (reader->take_next_sample(&sample_, &info) != ReturnCode_t::RETCODE_OK) continue;
      if (info.valid_data) accept(writer_hash(info.sample_identity.writer_guid()));
    }
  }

  void on_subscription_matched(dds::DataReader* /*reader*/, const dds::SubscriptionMatchedStatus& matched) override {
    const std::scoped_lock lock(mutex_);
    status_.writers = matched.current_count;
  }

  void on_requested_incompatible_qos(dds::DataReader* /*reader*/,
                                     const dds::RequestedIncompatibleQosStatus& status) override {
    const std::scoped_lock lock(mutex_);
    status_.last_refusal = "a writer with an incompatible QoS (policy " + std::to_string(status.last_policy_id) + ")";
  }

  bool poll(TrackMessage& message) {
    const std::scoped_lock lock(mutex_);
    if (queue_.empty()) return false;
    message = std::move(queue_.front());
    queue_.pop_front();
    return true;
  }

  TrackSourceStatus status() const {
    const std::scoped_lock lock(mutex_);
    return status_;
  }

  std::uint64_t overruns() const {
    const std::scoped_lock lock(mutex_);
    return overruns_;
  }

  std::uint64_t malformed() const { return malformed_; }

 private:
  // sample_ as a message into the queue, or refused. On the listener's thread.
  void accept(std::uint64_t writer) {
    const double received = clock_.now();
    const std::string& frame_id = sample_.header().frame_id();
    const bool ned = frame_id == "ned";
    if (!ned && frame_id != "map") {
      const std::scoped_lock lock(mutex_);
      ++status_.bad_frames;
      status_.last_refusal = "frame_id '" + printable(frame_id) + "' is neither 'map' nor 'ned'";
      return;
    }
    TrackMessage message;
    message.writer = writer;
    message.received = received;
    message.stamp_age = system_time() - (sample_.header().stamp().sec() + 1e-9 * sample_.header().stamp().nanosec());
    const std::string why = take_tracks(ned, message);

    const std::scoped_lock lock(mutex_);
    if (queue_.size() == TrackLimits::kQueuedMessages) {
      queue_.pop_front();
      ++overruns_;
    }
    ++status_.messages;
    status_.dropped_tracks += message.dropped;
    if (!why.empty()) status_.last_refusal = why;
    queue_.push_back(std::move(message));
  }

  // The usable tracks of sample_; returns why the last of the others was left out, empty when none was.
  std::string take_tracks(bool ned, TrackMessage& message) const {
    const std::vector<WireTrack>& wire = sample_.tracks();
    const std::size_t count = std::min(wire.size(), TrackLimits::kTracksPerMessage);
    message.tracks.reserve(count);
    const char* what = nullptr;
    std::uint64_t id = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Track track = from_wire_track(wire[i], ned);
      if (const char* bad = refusal(track); bad != nullptr) {
        what = bad;
        id = track.id;
      } else {
        message.tracks.push_back(track);
      }
    }
    message.dropped = static_cast<std::uint32_t>(wire.size() - message.tracks.size());
    if (wire.size() > count) {
      return "a message of " + std::to_string(wire.size()) + " tracks; at most " + std::to_string(count) + " are taken";
    }
    if (what == nullptr) return {};
    return "track " + std::to_string(id) + ": " + what + " is not finite or out of range";
  }

  const Clock& clock_;
  std::atomic<std::uint64_t> malformed_ = 0;
  WireMessage sample_;        // the listener's own; reused, so that decoding does not allocate
  mutable std::mutex mutex_;  // guards queue_, status_ and overruns_
  std::deque<TrackMessage> queue_;
  TrackSourceStatus status_;
  std::uint64_t overruns_ = 0;
  Participant participant_;  // last: its destruction ends the callbacks while all else still stands
};

DdsTrackReader::DdsTrackReader(int domain, const Clock& clock) : impl_(std::make_unique<Impl>(domain, clock)) {}
DdsTrackReader::~DdsTrackReader() = default;
bool DdsTrackReader::poll(TrackMessage& message) {
  return impl_->poll(message);
}
TrackSourceStatus DdsTrackReader::status() const {
  return impl_->status();
}
std::uint64_t DdsTrackReader::overruns() const {
  return impl_->overruns();
}
std::uint64_t DdsTrackReader::malformed() const {
  return impl_->malformed();
}

class DdsTrackWriter::Impl final : public dds::DataWriterListener {
 public:
  explicit Impl(int domain) : participant_(domain, "jink track writer", dds::TypeSupport(new CheckedType)) {
    dds::Publisher* publisher = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 1;
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    // A message of more than 64 KiB (some 430 tracks) goes out in fragments, which Fast DDS sends asynchronously only.
    qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
    if (publisher != nullptr) writer_ = publisher->create_datawriter(participant_.topic(), qos, this);
    if (writer_ == nullptr) throw std::runtime_error(std::string("DDS writer of ") + kTracksTopic + " cannot be made");
  }

  void on_publication_matched(dds::DataWriter* /*writer*/, const dds::PublicationMatchedStatus& matched) override {
    readers_ = matched.current_count;
  }

  bool publish(std::span<const Track> tracks, double stamp_unix_s, const std::string& frame_id) {
    const double sec = std::floor(stamp_unix_s);
    if (!(sec >= 0.0 && sec < 2147483648.0)) return false;  // ROS 2's stamp ends in 2038
    message_.header().stamp().sec(static_cast<std::int32_t>(sec));
    message_.header().stamp().nanosec(static_cast<std::uint32_t>((stamp_unix_s - sec) * 1e9));
    message_.header().frame_id(frame_id);
    message_.tracks().resize(tracks.size());
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      WireTrack& wire = message_.tracks()[i];
      wire.id(tracks[i].id);
      to_wire(tracks[i].position, wire.position());
      to_wire(tracks[i].velocity, wire.velocity());
      to_wire(tracks[i].acceleration, wire.acceleration());
      wire.radius(tracks[i].radius);
      wire.position_sigma(tracks[i].position_sigma);
      wire.velocity_sigma(tracks[i].velocity_sigma);
    }
    return writer_->write(&message_);
  }

  int readers() const { return readers_; }

 private:
  std::atomic<int> readers_ = 0;
  WireMessage message_;  // reused, so that a steady number of tracks does not allocate
  dds::DataWriter* writer_ = nullptr;
  Participant participant_;  // last: its destruction ends the callbacks while all else still stands
};

DdsTrackWriter::DdsTrackWriter(int domain) : impl_(std::make_unique<Impl>(domain)) {}
DdsTrackWriter::~DdsTrackWriter() = default;
bool DdsTrackWriter::publish(std::span<const Track> tracks, double stamp_unix_s, const std::string& frame_id) {
  return impl_->publish(tracks, stamp_unix_s, frame_id);
}
int DdsTrackWriter::readers() const {
  return impl_->readers();
}

}  // namespace jink::bridge
