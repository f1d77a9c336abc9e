// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/px4_link.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <string_view>

#include "Px4.h"
#include "bridge/cdr/px4_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/frames/conversions.hpp"
#include "bridge/vehicle/link_delay.hpp"

namespace jink::bridge::dds {

namespace {

constexpr double kMaxValue = 1e6;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

bool sane(const Vec3& v) {
  return v.cwiseAbs().maxCoeff() <= kMaxValue && v.allFinite();
}

std::array<float, 3> to_wire(const Vec3& enu) {
  const Vec3 ned = frames::ned_from_enu(enu);
  return {static_cast<float>(ned.x()), static_cast<float>(ned.y()), static_cast<float>(ned.z())};
}

// What the link underneath says of its own position means nothing where the position comes from here.
void forget_local_position(std::string& health) {
  constexpr std::string_view kOwn = "local position";
  constexpr std::string_view kSeparator = ", ";
  if (!std::string_view(health).ends_with(kOwn)) return;
  health.erase(health.size() - kOwn.size());
  if (std::string_view(health).ends_with(kSeparator)) health.erase(health.size() - kSeparator.size());
}

}  // namespace

std::string px4_topic(const std::string& name_space, const std::string& name) {
  std::string topic = "rt/";
  const std::size_t begin = name_space.find_first_not_of('/');
  if (begin != std::string::npos) {
    topic += name_space.substr(begin, name_space.find_last_not_of('/') + 1 - begin) + "/";
  }
  return topic + "fmu/" + name;
}

class DdsVehicleLink::Impl {
 public:
  Impl(vehicle::VehicleLink& under, DdsParticipant& node, const base::Clock& clock, const DdsVehicleOptions& options)
      : under_(under), clock_(clock) {
    const auto name = [&](const char* topic) { return px4_topic(options.name_space, topic); };
    if (options.setpoints) {
      mode_writer_.emplace(node, name(kOffboardControlModeTopic), kOffboardControlModeType);
      setpoint_writer_.emplace(node, name(kTrajectorySetpointTopic), kTrajectorySetpointType);
    }
    if (options.state) {
      const auto take = [this](const Payload& payload, const SampleWriter& writer) {
        accept(payload, writer.identity);
      };
      reader_.emplace(node, name(kLocalPositionTopic), kLocalPositionType, take);
      reader_v1_.emplace(node, name(kLocalPositionTopicV1), kLocalPositionType, take);
    }
  }

  vehicle::VehicleState state() {
    vehicle::VehicleState state = under_.state();
    if (setpoint_writer_) state.link_delay = 0.0;  // another way than the one that was measured
    if (!reader_) return state;
    forget_local_position(state.health);
    const std::scoped_lock lock(mutex_);
    filter_.apply(state, clock_.now());
    return state;
  }

  bool send(const vehicle::Setpoint& setpoint) {
    if (!setpoint_writer_) return under_.send(setpoint);
    const double heading = frames::heading_from_yaw_enu(setpoint.yaw);
    if (!sane(setpoint.position) || !sane(setpoint.velocity) || !sane(setpoint.acceleration)) return false;
    if (!std::isfinite(heading) || setpoint_readers() == 0) return false;
    // PX4 takes a stamp of 0 as the time of reception. The system's clock may be set in flight, and OFFBOARD ends where
    // setpoints seem older than COM_OF_LOSS_T.
    constexpr std::uint64_t kNow = 0;
    px4_msgs::msg::dds_::OffboardControlMode_ mode;  // all false
    mode.timestamp(kNow);
    mode.position(true);
    px4_msgs::msg::dds_::TrajectorySetpoint_ wire;
    wire.timestamp(kNow);
    wire.position(to_wire(setpoint.position));
    wire.velocity(to_wire(setpoint.velocity));
    wire.acceleration(to_wire(setpoint.acceleration));
    wire.jerk({kNaN, kNaN, kNaN});
    wire.yaw(static_cast<float>(heading));
    wire.yawspeed(kNaN);
    const std::scoped_lock lock(send_mutex_);
    if (!mode_writer_->write_message(mode) || !setpoint_writer_->write_message(wire)) return false;
    ++setpoints_sent_;
    return true;
  }

  vehicle::VehicleLink& under() { return under_; }

  DdsVehicleCounts counts() const {
    DdsVehicleCounts counts;
    {
      const std::scoped_lock lock(mutex_);
      counts = counts_;
    }
    if (reader_) counts.position_writers = reader_->writers() + reader_v1_->writers();
    counts.setpoint_readers = setpoint_readers();
    counts.setpoints_sent = setpoints_sent_;
    return counts;
  }

 private:
  int setpoint_readers() const {
    return setpoint_writer_ ? std::min(setpoint_writer_->readers(), mode_writer_->readers()) : 0;
  }

  // On Fast DDS's threads.
  void accept(const Payload& payload, std::uint64_t writer) {
    const std::optional<cdr::px4::LocalPosition> message = cdr::px4::decode_local_position(payload);
    const double now = clock_.now();
    const double system_now = system_time();
    const std::scoped_lock lock(mutex_);
    if (!message) {
      ++counts_.malformed;
      return;
    }
    if (writer != writer_) {
      if (heard_ >= 0.0 && now - heard_ < kWriterSilence_s) {
        ++counts_.other_writers;
        return;
      }
      delay_ = {};
    }
    const auto late = delay_.of(now, system_now - static_cast<double>(message->timestamp_us) * 1e-6);
    if (!late) {
      ++counts_.late;
    } else if (!filter_.update(*message, now - *late, now)) {
      ++counts_.dropped;
    } else {
      ++counts_.positions;
      writer_ = writer;
      heard_ = now;
    }
  }

  vehicle::VehicleLink& under_;
  const base::Clock& clock_;

  mutable std::mutex mutex_;  // guards the next block
  cdr::px4::LocalPositionFilter filter_;
  vehicle::StampDelay delay_;  // of that writer
  DdsVehicleCounts counts_;
  std::uint64_t writer_ = 0;
  double heard_ = -1.0;  // when that writer was

  std::mutex send_mutex_;  // guards writing, which Fast DDS's buffers here do not allow twice at once
  std::atomic<std::uint64_t> setpoints_sent_ = 0;
  std::optional<PayloadWriter> mode_writer_;
  std::optional<PayloadWriter> setpoint_writer_;
  std::optional<PayloadReader> reader_;  // the readers last: their destruction ends the callbacks
  std::optional<PayloadReader> reader_v1_;
};

DdsVehicleLink::DdsVehicleLink(vehicle::VehicleLink& under, DdsParticipant& node, const base::Clock& clock,
                               const DdsVehicleOptions& options)
    : impl_(std::make_unique<Impl>(under, node, clock, options)) {}
DdsVehicleLink::~DdsVehicleLink() = default;
vehicle::VehicleState DdsVehicleLink::state() {
  return impl_->state();
}
bool DdsVehicleLink::send(const vehicle::Setpoint& setpoint) {
  return impl_->send(setpoint);
}
void DdsVehicleLink::request(vehicle::Command command) {
  impl_->under().request(command);
}
std::optional<vehicle::CommandReport> DdsVehicleLink::next_report() {
  return impl_->under().next_report();
}
DdsVehicleCounts DdsVehicleLink::counts() const {
  return impl_->counts();
}

}  // namespace jink::bridge::dds
