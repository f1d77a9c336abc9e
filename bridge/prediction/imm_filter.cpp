// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/imm_filter.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace jink::bridge::prediction {
namespace {

using Matrix3 = Eigen::Matrix3d;

constexpr std::size_t kTurning = 3;                       // the model; those before it have no acceleration
constexpr std::array kSteadyNoise = {0.002, 0.1, 10.0};   // m²/s³, of their acceleration
constexpr double kTurningNoise = 6.0;                     // m²/s⁵, of the turning model's jerk
constexpr double kTurningSpread = 1.0;                    // m/s², of the acceleration that a turn may begin with
constexpr std::array kSojourn = {5.0, 5.0, 0.1, 5.0};     // s, time constants with which one model turns into all
constexpr std::array kAtFirst = {0.44, 0.44, 0.02, 0.1};  // probabilities: noise of a new track looks like a turn
constexpr double kGate = 45.0;               // squared Mahalanobis distance that noise has once in ten million
constexpr double kLeastProbability = 0.002;  // of a model
constexpr double kLeastSigma = 0.01;         // m, m/s
constexpr double kAxesAcross = 2.0;          // of an acceleration across the velocity
constexpr double kLongest = 1.0;             // s, between measurements, after which the estimate begins anew

Matrix3 transition(double dt, std::size_t model) {
  Matrix3 f = Matrix3::Identity();
  f(0, 1) = dt;
  f(0, 2) = model == kTurning ? 0.5 * dt * dt : 0.0;
  f(1, 2) = model == kTurning ? dt : 0.0;
  f(2, 2) = model == kTurning ? 1.0 : 0.0;
  return f;
}

/// Of continuous white noise: in the acceleration of the steady models, in the jerk of the turning one.
Matrix3 process_noise(double dt, std::size_t model) {
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  Matrix3 q = Matrix3::Zero();
  if (model == kTurning) {
    q << dt3 * dt2 / 20.0, dt2 * dt2 / 8.0, dt3 / 6.0,  //
        dt2 * dt2 / 8.0, dt3 / 3.0, dt2 / 2.0,          //
        dt3 / 6.0, dt2 / 2.0, dt;
    return kTurningNoise * q;
  }
  q(0, 0) = dt3 / 3.0;
  q(0, 1) = q(1, 0) = dt2 / 2.0;
  q(1, 1) = dt;
  return kSteadyNoise[model] * q;
}

/// The part across the velocity.
Vec3 turning_part(const Vec3& acceleration, const Vec3& velocity) {
  const double square = velocity.squaredNorm();
  return square > 0.0 ? Vec3(acceleration - acceleration.dot(velocity) / square * velocity) : acceleration;
}

}  // namespace

void ImmFilter::begin(const planner::base::Track& measured, const Noise& noise) {
  for (Model& model : models_) {
    model = {};
    model.state.row(0) = measured.position;
    model.state.row(1) = measured.velocity;
    model.covariance(0, 0) = noise.position_variance;
    model.covariance(1, 1) = noise.velocity_variance;
  }
  models_[kTurning].covariance(2, 2) = kTurningSpread * kTurningSpread;
  for (std::size_t i = 0; i < kModels; ++i) models_[i].probability = kAtFirst[i];
  begun_ = true;
}

// Each model goes on from a mixture of all, as likely as they turn into one another.
void ImmFilter::mix(double dt) {
  std::array<double, kModels> other{};
  for (std::size_t i = 0; i < kModels; ++i) other[i] = (1.0 - std::exp(-dt / kSojourn[i])) / kModels;
  const std::array<Model, kModels> before = models_;
  for (std::size_t j = 0; j < kModels; ++j) {
    Model& model = models_[j];
    model = {};
    std::array<double, kModels> share{};
    for (std::size_t i = 0; i < kModels; ++i) {
      share[i] = (i == j ? 1.0 - (kModels - 1) * other[i] : other[i]) * before[i].probability;
      model.probability += share[i];
      model.state += share[i] * before[i].state;
    }
    model.state /= model.probability;
    for (std::size_t i = 0; i < kModels; ++i) {
      const Matrix3 off = before[i].state - model.state;
      Matrix3 covariance = before[i].covariance + off * off.transpose() / 3.0;  // the axes' mean
      // The steady models say nothing of the acceleration that a turn begins with.
      if (i != kTurning && j == kTurning) covariance(2, 2) += kTurningSpread * kTurningSpread;
      model.covariance += share[i] / model.probability * covariance;
    }
  }
}

ImmFilter::Fit ImmFilter::correct(Model& model, const planner::base::Track& measured, const Noise& noise) const {
  Eigen::Matrix<double, 2, 3> residual;
  residual.row(0) = measured.position.transpose() - model.state.row(0);
  residual.row(1) = measured.velocity.transpose() - model.state.row(1);
  Eigen::Matrix2d innovation = model.covariance.topLeftCorner<2, 2>();
  innovation(0, 0) += noise.position_variance;
  innovation(1, 1) += noise.velocity_variance;
  const Eigen::Matrix2d inverse = innovation.inverse();
  const Eigen::Matrix<double, 3, 2> gain = model.covariance.leftCols<2>() * inverse;
  Fit fit;
  fit.distance = residual.cwiseProduct(inverse * residual).sum();
  fit.log_likelihood = -0.5 * fit.distance - 1.5 * std::log(innovation.determinant());
  model.state += gain * residual;
  model.covariance -= gain * model.covariance.topRows<2>();
  model.covariance = (0.5 * (model.covariance + model.covariance.transpose())).eval();
  return fit;
}

void ImmFilter::update(double dt, const planner::base::Track& measured) {
  const double position_sigma = std::max(kLeastSigma, measured.position_sigma);
  const double velocity_sigma = std::max(kLeastSigma, measured.velocity_sigma);
  const Noise noise{position_sigma * position_sigma, velocity_sigma * velocity_sigma};
  if (!begun_ || !(dt >= 0.0 && dt <= kLongest)) {
    begin(measured, noise);
    return;
  }
  mix(dt);
  std::array<Fit, kModels> fits;
  Fit best{-planner::base::kInfinity, planner::base::kInfinity};
  for (std::size_t i = 0; i < kModels; ++i) {
    Model& model = models_[i];
    const Matrix3 f = transition(dt, i);
    model.state = (f * model.state).eval();
    model.covariance = (f * model.covariance * f.transpose() + process_noise(dt, i)).eval();
    fits[i] = correct(model, measured, noise);
    best.log_likelihood = std::max(best.log_likelihood, fits[i].log_likelihood);
    best.distance = std::min(best.distance, fits[i].distance);
  }
  if (best.distance > kGate) {
    begin(measured, noise);
    return;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < kModels; ++i) {
    models_[i].probability *= std::exp(fits[i].log_likelihood - best.log_likelihood);
    sum += models_[i].probability;
  }
  double total = 0.0;
  for (Model& model : models_) {
    model.probability = std::max(kLeastProbability, model.probability / sum);
    total += model.probability;
  }
  for (Model& model : models_) model.probability /= total;
}

void ImmFilter::apply(planner::base::Track& track) const {
  Matrix3 state = Matrix3::Zero();
  for (const Model& model : models_) state += model.probability * model.state;
  Matrix3 covariance = Matrix3::Zero();
  for (const Model& model : models_) {
    const Matrix3 off = model.state - state;
    covariance += model.probability * (model.covariance + off * off.transpose() / 3.0);
  }
  track.position = state.row(0);
  track.velocity = state.row(1);
  track.acceleration = turning_part(state.row(2), track.velocity);
  const double believed = track.acceleration.squaredNorm();
  if (believed > 0.0) track.acceleration *= believed / (believed + kAxesAcross * covariance(2, 2));
  track.position_sigma = std::max(kLeastShare * track.position_sigma, std::sqrt(covariance(0, 0)));
  track.velocity_sigma = std::max(kLeastShare * track.velocity_sigma, std::sqrt(covariance(1, 1)));
}

}  // namespace jink::bridge::prediction
