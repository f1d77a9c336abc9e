// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/clouds.hpp"

#include <utility>

#include "bridge/base/text.hpp"

namespace jink::bridge::map {

void CloudInbox::put(Cloud cloud) {
  if (cloud.points.empty()) return refuse("a cloud without points");
  if (!(cloud.stamp_age <= CloudLimits::kOldest)) return refuse("a cloud " + base::seconds(cloud.stamp_age) + " old");
  if (!(cloud.stamp_age >= -CloudLimits::kAhead))
    return refuse("a cloud whose stamp is " + base::seconds(-cloud.stamp_age) + " ahead of this computer's time");
  const std::scoped_lock lock(mutex_);
  if (queue_.size() == CloudLimits::kQueued) queue_.pop_front();
  ++status_.clouds;
  queue_.push_back(std::move(cloud));
}

void CloudInbox::refuse(const std::string& why) {
  const std::scoped_lock lock(mutex_);
  ++status_.refused;
  status_.last_refusal = why;
}

void CloudInbox::malformed() {
  const std::scoped_lock lock(mutex_);
  ++status_.malformed;
}

bool CloudInbox::poll(Cloud& cloud) {
  const std::scoped_lock lock(mutex_);
  if (queue_.empty()) return false;
  cloud = std::move(queue_.front());
  queue_.pop_front();
  return true;
}

CloudSourceStatus CloudInbox::status() const {
  const std::scoped_lock lock(mutex_);
  return status_;
}

}  // namespace jink::bridge::map
