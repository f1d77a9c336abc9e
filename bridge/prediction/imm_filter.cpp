// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/imm_filter.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace jink::bridge::prediction {
namespace {

using Matrix3 = Eigen::Matrix3d;

constexpr double kSteadyNoise = 0.02;       // m²/s³, of the steady model's acceleration
constexpr double kTurningNoise = 12.0;      // m²/s⁵, of the turning model's jerk
constexpr double kTurningSpread = 2.0;      // m/s², of the acceleration that a turn may begin with
constexpr double kSojourn = 1.5;            // s, that an obstacle stays with a model on average
constexpr double kSteadyAtFirst = 0.9;      // probability that a new track does not turn: noise looks like a turn then
constexpr double kGate = 45.0;              // squared Mahalanobis distance that noise has once in ten million
constexpr double kLeastProbability = 0.02;  // of a model
constexpr double kLeastSigma = 0.01;        // m, m/s
constexpr double kLongest = 1.0;            // s, between measurements, after which the estimate begins anew

Matrix3 transition(double dt, bool turning) {
  Matrix3 f = Matrix3::Identity();
  f(0, 1) = dt;
  f(0, 2) = turning ? 0.5 * dt * dt : 0.0;
  f(1, 2) = turning ? dt : 0.0;
  f(2, 2) = turning ? 1.0 : 0.0;
  return f;
}

/// Of continuous white noise: in the acceleration of the steady model, in the jerk of the turning one.
Matrix3 process_noise(double dt, bool turning) {
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  Matrix3 q = Matrix3::Zero();
  if (turning) {
    q << dt3 * dt2 / 20.0, dt2 * dt2 / 8.0, dt3 / 6.0,  //
        dt2 * dt2 / 8.0, dt3 / 3.0, dt2 / 2.0,          //
        dt3 / 6.0, dt2 / 2.0, dt;
    return kTurningNoise * q;
  }
  q(0, 0) = dt3 / 3.0;
  q(0, 1) = q(1, 0) = dt2 / 2.0;
  q(1, 1) = dt;
  return kSteadyNoise * q;
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
  models_[1].covariance(2, 2) = kTurningSpread * kTurningSpread;
  models_[0].probability = kSteadyAtFirst;
  models_[1].probability = 1.0 - kSteadyAtFirst;
  begun_ = true;
}

// Each model goes on from a mixture of both, as likely as they turn into one another.
void ImmFilter::mix(double dt) {
  const double stay = 0.5 + 0.5 * std::exp(-dt / kSojourn);
  const std::array<Model, 2> before = models_;
  for (std::size_t j = 0; j < 2; ++j) {
    Model& model = models_[j];
    std::array<double, 2> share{};
    for (std::size_t i = 0; i < 2; ++i) share[i] = (i == j ? stay : 1.0 - stay) * before[i].probability;
    model.probability = share[0] + share[1];
    model.state = (share[0] * before[0].state + share[1] * before[1].state) / model.probability;
    model.covariance.setZero();
    for (std::size_t i = 0; i < 2; ++i) {
      const Matrix3 off = before[i].state - model.state;
      Matrix3 covariance = before[i].covariance + off * off.transpose() / 3.0;  // the axes' mean
      // The steady model says nothing of the acceleration that a turn begins with.
      if (i == 0 && j == 1) covariance(2, 2) += kTurningSpread * kTurningSpread;
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
  std::array<Fit, 2> fits;
  for (std::size_t i = 0; i < 2; ++i) {
    Model& model = models_[i];
    const Matrix3 f = transition(dt, i == 1);
    model.state = (f * model.state).eval();
    model.covariance = (f * model.covariance * f.transpose() + process_noise(dt, i == 1)).eval();
    fits[i] = correct(model, measured, noise);
  }
  if (std::min(fits[0].distance, fits[1].distance) > kGate) {
    begin(measured, noise);
    return;
  }
  const double most = std::max(fits[0].log_likelihood, fits[1].log_likelihood);
  double sum = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    models_[i].probability *= std::exp(fits[i].log_likelihood - most);
    sum += models_[i].probability;
  }
  for (Model& model : models_) model.probability = std::max(kLeastProbability, model.probability / sum);
  const double total = models_[0].probability + models_[1].probability;
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
  track.acceleration = state.row(2);
  track.position_sigma = std::max(kLeastShare * track.position_sigma, std::sqrt(covariance(0, 0)));
  track.velocity_sigma = std::max(kLeastShare * track.velocity_sigma, std::sqrt(covariance(1, 1)));
}

}  // namespace jink::bridge::prediction
