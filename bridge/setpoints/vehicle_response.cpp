// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/setpoints/vehicle_response.hpp"

#include <algorithm>
#include <cmath>

namespace jink::bridge::setpoints {
namespace {

// PX4's parameters by default (MPC_XY_P, MPC_Z_P, MPC_XY_VEL_*_ACC, MPC_Z_VEL_*_ACC), and lags as its SITL shows them.
const Vec3 kPositionGains(0.95, 0.95, 0.95);  // 1/s
const Vec3 kVelocityGains(1.8, 1.8, 4.0);     // 1/s
const Vec3 kIntegralGains(0.4, 0.4, 2.0);     // 1/s²
const Vec3 kFirstLags(0.14, 0.14, 0.08);      // s
const Vec3 kSecondLags(0.14, 0.14, 0.02);     // s
constexpr double kTransport = 0.03;           // s, from what is heard to the cascade
constexpr double kStep = 0.02;                // s
constexpr double kSlack = 1e-6;               // s
constexpr double kLongestSilence = 0.2;       // s, between two measurements; after more it begins anew
constexpr double kFarthest = 1.0;             // s, that is looked ahead
constexpr double kMemory = 0.5;               // s, in which what is unexplained is learned and forgotten
constexpr double kLearning = 2.0;             // 1/s, of drag and damping
constexpr double kLearningSpeed = 1.0;        // m/s, below which an acceleration says little about drag
constexpr double kMostLacking = 5.0;          // m/s²; more is a measurement that jumped
constexpr double kMostDrag = 2.0;             // 1/s
constexpr double kMostDamping = 0.5;          // of the acceleration

// The part of the way to its input that a first-order lag covers.
Vec3 covered(double dt, const Vec3& lags) {
  return lags.unaryExpr([dt](double lag) { return -std::expm1(-dt / lag); });
}

Vec3 level(const Vec3& v) {
  return {v.x(), v.y(), 0.0};
}

}  // namespace

void VehicleResponse::Lagged::follow(const Vec3& input, double dt) {
  first += covered(dt, kFirstLags).cwiseProduct(input - first);
  value += covered(dt, kSecondLags).cwiseProduct(first - value);
}

void VehicleResponse::sent(double t, const vehicle::Setpoint& setpoint) {
  sent_[sent_count_++ % sent_.size()] = {t, setpoint};
}

// The newest by then, or the oldest that is kept; none was sent: null.
const VehicleResponse::Sent* VehicleResponse::heard_at(double t) const {
  const Sent* heard = nullptr;
  const std::size_t kept = std::min(sent_count_, sent_.size());
  for (std::size_t i = 1; i <= kept && (heard == nullptr || heard->t > t + kSlack); ++i)
    heard = &sent_[(sent_count_ - i) % sent_.size()];
  return heard;
}

void VehicleResponse::advance(double dt, const vehicle::Setpoint& setpoint, State& state) const {
  Vec3 wish = setpoint.velocity + kPositionGains.cwiseProduct(setpoint.position - state.position);
  wish.head<2>() *= std::min(1.0, max_speed_ / wish.head<2>().norm());
  const Vec3 error = wish - state.velocity;
  state.thrust.follow(setpoint.acceleration + kVelocityGains.cwiseProduct(error) + state.integral, dt);
  state.integral += dt * kIntegralGains.cwiseProduct(error);
  state.acceleration_fed_back.follow(level(state.acceleration), dt);
  state.acceleration =
      state.thrust.value - damping_ * state.acceleration_fed_back.value - drag_ * state.velocity + unexplained_;
  state.position += dt * state.velocity + 0.5 * dt * dt * state.acceleration;
  state.velocity += dt * state.acceleration;
  state.t += dt;
}

void VehicleResponse::learn(double dt, const Vec3& lacking) {
  const Vec3 velocity = level(state_->velocity);
  if (velocity.norm() < kLearningSpeed) return;
  const Vec3& fed_back = state_->acceleration_fed_back.value;
  const Vec3 believed = std::min(1.0, kMostLacking / lacking.norm()) * lacking;
  const double step = kLearning * dt / (1.0 + velocity.squaredNorm() + fed_back.squaredNorm());
  drag_ = std::clamp(drag_ - step * believed.dot(velocity), 0.0, kMostDrag);
  damping_ = std::clamp(damping_ - step * believed.dot(fed_back), 0.0, kMostDamping);
}

void VehicleResponse::observe(double t, const Vec3& position, const Vec3& velocity, bool learns) {
  if (state_ && t <= state_->t) return;
  if (!state_ || t > state_->t + kLongestSilence || sent_count_ == 0) {
    state_ = State{};
    state_->thrust = {drag_ * velocity, drag_ * velocity};
    unexplained_.setZero();
  } else {
    const double dt = t - state_->t;
    while (state_->t < t - kSlack)
      advance(std::min(kStep, t - state_->t), heard_at(state_->t - kTransport)->setpoint, *state_);
    const Vec3 lacking = (velocity - state_->velocity) / dt;
    if (learns) {
      learn(dt, lacking + unexplained_);
      unexplained_ += std::min(1.0, dt / kMemory) * lacking;
      unexplained_ *= std::min(1.0, kMostLacking / unexplained_.norm());
    } else {
      unexplained_.setZero();
    }
  }
  state_->t = t;
  state_->position = position;
  state_->velocity = velocity;
}

void VehicleResponse::forget() {
  state_.reset();
  sent_count_ = 0;
}

std::optional<planner::base::TimedPoint> VehicleResponse::at(
    double t, const std::function<vehicle::Setpoint(double t)>& later) const {
  if (!state_ || sent_count_ == 0 || t < state_->t || t > state_->t + kFarthest) return std::nullopt;
  State state = *state_;
  const double newest = sent_[(sent_count_ - 1) % sent_.size()].t;
  while (state.t < t - kSlack) {
    const double heard = state.t - kTransport;
    advance(std::min(kStep, t - state.t), heard < newest + kStep ? heard_at(heard)->setpoint : later(heard), state);
  }
  return planner::base::TimedPoint{t, state.position, state.velocity, state.acceleration};
}

}  // namespace jink::bridge::setpoints
