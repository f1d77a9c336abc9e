// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/vehicle/estimate_resets.hpp"

#include <cmath>

namespace jink::bridge::vehicle {

namespace {

constexpr double kTimeStep = 0.001;  // s: local positions have their time in whole milliseconds, cut off

}  // namespace

Vec3 EstimateResets::jump_between(const Sample& before, const Sample& after) {
  const double dt = after.time - before.time;
  // Half-way between the velocities, unless they differ by more than flying explains: then the velocity was reset too.
  const bool flown = (after.velocity - before.velocity).norm() <= kUnexplained + kMaxAcceleration * dt;
  const Vec3 velocity = flown ? Vec3((before.velocity + after.velocity) / 2.0) : before.velocity;
  return after.position - before.position - velocity * dt;
}

void EstimateResets::apply(const Jump& jump) {
  count_ += jump.resets;
  shift_ += jump.shift;
}

void EstimateResets::on_odometry(const Sample& sample, std::uint8_t counter) {
  if (position_ && std::abs(sample.time - position_->time) > kSameClock) return;
  if (!odometry_) {
    odometry_ = sample;
    counter_ = counter;
    return;
  }
  const double dt = sample.time - odometry_->time;
  if (dt <= 0.0) return;
  const auto resets = static_cast<std::uint8_t>(counter - counter_);
  if (resets != 0U) {
    Jump jump{odometry_->time, sample.time, resets, Vec3::Zero()};
    if (dt <= kLongestGap) jump.shift = jump_between(*odometry_, sample);
    const bool known = seen_ && seen_->begin < jump.end && jump.begin < seen_->end + kTimeStep;
    if (known) {
      count_ += jump.resets - 1;
      seen_.reset();
    } else {
      if (declared_) apply(*declared_);
      declared_ = jump;
      if (!position_ || position_->time >= jump.end - kTimeStep) {
        apply(jump);
        declared_.reset();
      }
    }
  }
  odometry_ = sample;
  counter_ = counter;
}

void EstimateResets::on_position(const Sample& sample) {
  if (!position_) {
    position_ = sample;
    return;
  }
  const double dt = sample.time - position_->time;
  if (dt <= 0.0) return;
  Vec3 jump = jump_between(*position_, sample);
  if (declared_ && sample.time > declared_->begin) {
    const bool after = sample.time >= declared_->end - kTimeStep;
    // Between the two samples of ODOMETRY either may be true: the nearer one is.
    if (after || (jump - declared_->shift).norm() < jump.norm()) {
      apply(*declared_);
      jump -= declared_->shift;
      declared_.reset();
    }
  }
  if (dt <= kJumpGap && jump.norm() > kUnexplained + kMaxAcceleration * dt * dt / 2.0) {
    seen_ = Jump{position_->time, sample.time, 1, jump};
    apply(*seen_);
  }
  position_ = sample;
}

void EstimateResets::restart() {
  odometry_.reset();
  position_.reset();
  declared_.reset();
  seen_.reset();
}

}  // namespace jink::bridge::vehicle
