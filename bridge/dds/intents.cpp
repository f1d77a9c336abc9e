// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/intents.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "Intents.h"
#include "bridge/cdr/intent_messages.hpp"
#include "bridge/dds/payload_io.hpp"

namespace jink::bridge::dds {

class DdsIntents::Impl {
 public:
  Impl(DdsParticipant& node, const base::Clock& clock)
      : clock_(clock),
        writer_(node, kIntentsTopic, kIntentsType),
        reader_(node, kIntentsTopic, kIntentsType,
                [this](const Payload& payload, const SampleWriter& writer) { accept(payload, writer.identity); }) {}

  bool poll(team::IntentMessage& message) {
    const std::scoped_lock lock(mutex_);
    if (newest_.empty()) return false;
    message = std::move(newest_.begin()->second);
    newest_.erase(newest_.begin());
    return true;
  }

  bool publish(const team::Intent& intent) {
    const double now = system_time();
    const double sec = std::floor(now);
    if (!(sec >= 0.0 && sec < 2147483648.0)) return false;  // ROS 2's stamp ends in 2038
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const frames::Geodetic origin = intent.origin.value_or(frames::Geodetic{kNan, kNan, kNan});
    wire_.header().stamp().sec(static_cast<std::int32_t>(sec));
    wire_.header().stamp().nanosec(static_cast<std::uint32_t>((now - sec) * 1e9));
    wire_.header().frame_id("map");
    wire_.vehicle(intent.vehicle);
    wire_.origin_latitude(origin.latitude_deg);
    wire_.origin_longitude(origin.longitude_deg);
    wire_.origin_altitude(origin.altitude_m);
    wire_.radius(intent.radius);
    wire_.margin(intent.margin);
    wire_.points().resize(intent.path.size());
    for (std::size_t i = 0; i < intent.path.size(); ++i) {
      const Vec3& position = intent.path[i].position;
      wire_.points()[i].time(intent.path[i].t);
      wire_.points()[i].position().x(position.x());
      wire_.points()[i].position().y(position.y());
      wire_.points()[i].position().z(position.z());
    }
    return writer_.write_message(wire_);
  }

  std::uint64_t identity() const { return writer_.identity(); }

  team::IntentStatus status() const {
    const std::scoped_lock lock(mutex_);
    team::IntentStatus status = status_;
    if (status.last_refusal.empty()) status.last_refusal = reader_.mismatch();
    return status;
  }

 private:
  // The payload as its writer's newest message, or refused. On Fast DDS's thread.
  void accept(const Payload& payload, std::uint64_t writer) {
    team::IntentMessage message;
    message.writer = writer;
    message.received = clock_.now();
    std::string why = "a payload that is no jink_msgs/Intent";
    if (auto decoded = cdr::decode_intent(payload)) {
      message.stamp_age = system_time() - decoded->stamp_unix_s;
      message.intent = std::move(decoded->intent);
      why = std::move(decoded->why);
    }
    const std::scoped_lock lock(mutex_);
    if (why.empty() && newest_.size() >= kWriters && !newest_.contains(writer)) why = "too many writers at once";
    if (why.empty()) {
      newest_[writer] = std::move(message);
    } else {
      ++status_.refused;
      status_.last_refusal = why;
    }
  }

  const base::Clock& clock_;
  mutable std::mutex mutex_;  // guards newest_ and status_
  std::map<std::uint64_t, team::IntentMessage> newest_;
  team::IntentStatus status_;
  jink_msgs::msg::dds_::Intent_ wire_;  // of publish(); reused
  PayloadWriter writer_;
  PayloadReader reader_;  // last: its destruction ends the callbacks while all else still stands
};

DdsIntents::DdsIntents(DdsParticipant& node, const base::Clock& clock) : impl_(std::make_unique<Impl>(node, clock)) {}
DdsIntents::~DdsIntents() = default;
bool DdsIntents::poll(team::IntentMessage& message) {
  return impl_->poll(message);
}
bool DdsIntents::publish(const team::Intent& intent) {
  return impl_->publish(intent);
}
std::uint64_t DdsIntents::identity() const {
  return impl_->identity();
}
team::IntentStatus DdsIntents::status() const {
  return impl_->status();
}

}  // namespace jink::bridge::dds
