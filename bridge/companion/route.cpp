// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/route.hpp"

namespace jink::bridge::companion {

bool Route::pass(const Vec3& position) {
  if (next_ + 1 >= waypoints_.size() || (position - target()).norm() > kPassing) return false;
  ++next_;
  nearest_ = planner::base::kInfinity;
  return true;
}

bool Route::arrived(const Vec3& position, const Vec3& velocity) const {
  return next_ + 1 == waypoints_.size() && at(target(), position, velocity);
}

bool Route::stuck(double now, const Vec3& position) {
  const double left = (target() - position).norm();
  if (left < nearest_ - kGain) {
    nearest_ = left;
    gained_at_ = now;
  }
  return now - gained_at_ > kPatience;
}

}  // namespace jink::bridge::companion
