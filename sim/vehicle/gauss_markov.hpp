// SPDX-License-Identifier: BSD-3-Clause
// A first-order Gauss-Markov process on three axes: gusts, and the errors of an estimate. The same bits on every
// machine.
#pragma once

#include <algorithm>
#include <cmath>

#include "planner/base/random.hpp"
#include "planner/base/types.hpp"

namespace jink::sim::vehicle {

/// Each axis has mean 0, standard deviation `deviation` and autocorrelation (1 - dt / time)^n after n steps, about
/// exp(-t / time); a `time` of less than a step is white noise. It starts anywhere within its deviation. With a
/// deviation of 0 it is zero and draws nothing.
class GaussMarkov {
 public:
  /// `deviation` and `time` (s) finite, not negative; `step` (s) positive.
  GaussMarkov(double deviation, double time, double step, planner::base::RandomStream stream)
      : stream_(stream), deviation_(deviation), keep_(time > step ? 1.0 - step / time : 0.0) {
    if (deviation_ > 0.0) value_ = deviation_ * draw();
  }

  void step() {
    if (deviation_ > 0.0) value_ = keep_ * value_ + deviation_ * std::sqrt(1.0 - keep_ * keep_) * draw();
  }
  [[nodiscard]] const Vec3& value() const { return value_; }

 private:
  Vec3 draw() {
    const double x = stream_.normal();
    const double y = stream_.normal();
    return {x, y, stream_.normal()};
  }

  planner::base::RandomStream stream_;
  double deviation_;
  double keep_;
  Vec3 value_ = Vec3::Zero();
};

}  // namespace jink::sim::vehicle
