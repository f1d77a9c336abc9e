// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/clouds.hpp"

#include <optional>
#include <utility>

#include "bridge/cdr/cloud_messages.hpp"
#include "bridge/dds/payload_io.hpp"

namespace jink::bridge::dds {

std::string cloud_topic(const std::string& name_space) {
  return name_space.empty() ? kCloudTopic : "rt/" + name_space + std::string(kCloudTopic).substr(2);
}

class DdsCloudReader::Impl {
 public:
  Impl(DdsParticipant& node, const base::Clock& clock, const CloudReaderOptions& options)
      : clock_(clock),
        frame_(options.frame),
        reader_(node, cloud_topic(options.name_space), kCloudType,
                [this](const Payload& payload, const SampleWriter& writer) { accept(payload, writer); }) {}

  bool poll(map::Cloud& cloud) { return inbox_.poll(cloud); }
  [[nodiscard]] map::CloudSourceStatus status() const {
    map::CloudSourceStatus status = inbox_.status();
    status.writers = reader_.writers();
    if (status.last_refusal.empty()) status.last_refusal = reader_.mismatch();
    return status;
  }

 private:
  // On Fast DDS's thread.
  void accept(const Payload& payload, const SampleWriter& writer) {
    const double received = clock_.now();
    std::optional<cdr::DecodedCloud> decoded = cdr::decode_cloud(payload);
    if (!decoded) return inbox_.malformed();
    const std::string& frame = decoded->frame_id;
    map::Cloud cloud;
    cloud.mounted = frame == frame_;
    if (!cloud.mounted && frame != "map" && frame != "ned")
      return inbox_.refuse("frame_id '" + cdr::printable(frame) + "' is neither '" + frame_ + "', 'map' nor 'ned'");
    if (!cloud.mounted && frame == "ned") {
      for (Eigen::Vector3f& point : decoded->points) point = Eigen::Vector3f(point.y(), point.x(), -point.z());
    }
    cloud.points = std::move(decoded->points);
    cloud.writer = writer.identity;
    cloud.received = received;
    cloud.stamp_age = system_time() - decoded->stamp_unix_s;
    inbox_.put(std::move(cloud));
  }

  const base::Clock& clock_;
  const std::string frame_;
  map::CloudInbox inbox_;
  PayloadReader reader_;  // last: its destruction ends the callbacks while all else still stands
};

DdsCloudReader::DdsCloudReader(DdsParticipant& node, const base::Clock& clock, const CloudReaderOptions& options)
    : impl_(std::make_unique<Impl>(node, clock, options)) {}
DdsCloudReader::~DdsCloudReader() = default;
bool DdsCloudReader::poll(map::Cloud& cloud) {
  return impl_->poll(cloud);
}
map::CloudSourceStatus DdsCloudReader::status() const {
  return impl_->status();
}

class DdsCloudWriter::Impl {
 public:
  // A cloud does not fit one datagram.
  Impl(DdsParticipant& node, const std::string& name_space)
      : writer_(node, cloud_topic(name_space), kCloudType, {.large = true}) {}

  bool publish(std::span<const Eigen::Vector3f> points, double stamp_unix_s, const std::string& frame_id) {
    if (!(stamp_unix_s >= 0.0 && stamp_unix_s < 2147483648.0)) return false;  // ROS 2's stamp ends in 2038
    return writer_.write(cdr::encode_cloud(points, stamp_unix_s, frame_id));
  }
  [[nodiscard]] int readers() const { return writer_.readers(); }

 private:
  PayloadWriter writer_;
};

DdsCloudWriter::DdsCloudWriter(DdsParticipant& node, const std::string& name_space)
    : impl_(std::make_unique<Impl>(node, name_space)) {}
DdsCloudWriter::~DdsCloudWriter() = default;
bool DdsCloudWriter::publish(std::span<const Eigen::Vector3f> points, double stamp_unix_s,
                             const std::string& frame_id) {
  return impl_->publish(points, stamp_unix_s, frame_id);
}
int DdsCloudWriter::readers() const {
  return impl_->readers();
}

}  // namespace jink::bridge::dds
