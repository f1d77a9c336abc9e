// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/companion/route.hpp"

namespace jink::bridge::companion {

bool Route::pass(const Vec3& position) {
  if (next_ + 1 >= waypoints_.size() || (position - target()).norm() > kPassing) return false;
  ++next_;
  progress_.begin_anew();
  return true;
}

bool Route::arrived(const Vec3& position, const Vec3& velocity) const {
  if (next_ + 1 != waypoints_.size()) return false;
  return (position - target()).norm() < acceptance_ || at(target(), position, velocity);
}

bool Route::stuck(double now, const Vec3& position) {
  return progress_.stalls(now, (target() - position).norm());
}

}  // namespace jink::bridge::companion
