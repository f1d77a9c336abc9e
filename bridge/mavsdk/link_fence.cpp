// SPDX-License-Identifier: BSD-3-Clause
// The fence comes down from the autopilot item by item: https://mavlink.io/en/services/mission.html
#include <chrono>
#include <nlohmann/json.hpp>

#include "bridge/mavsdk/link.hpp"
#include "bridge/mavsdk/link_impl.hpp"

namespace jink::bridge::mavsdk {
namespace {

constexpr std::uint32_t kFenceList = 1;        // MAV_MISSION_TYPE_FENCE
constexpr std::uint32_t kFenceKeeper = 1;      // MAV_COMP_ID_AUTOPILOT1
constexpr std::uint32_t kMissionAccepted = 0;  // MAV_MISSION_ACCEPTED
constexpr double kAskAgain = 0.25;             // s, as PX4 and MAVSDK do

}  // namespace

std::optional<std::vector<mavlink::MissionItem>> MavsdkLink::Impl::read_fence(double timeout_s,
                                                                              const std::stop_token& stop) {
  if (!ready_) return std::nullopt;
  const std::scoped_lock one_at_a_time(fence_mutex_);
  const double until = clock_.now() + timeout_s;
  std::unique_lock lock(mutex_);
  fence_asked_ = true;
  fence_count_.reset();
  fence_.clear();
  const auto complete = [&] { return fence_count_ && fence_.size() == *fence_count_; };
  while (!complete() && clock_.now() < until && !stop.stop_requested()) {
    const bool counted = fence_count_.has_value();
    const std::size_t before = fence_.size();
    nlohmann::json fields{
        {"target_system", system_id_}, {"target_component", kFenceKeeper}, {"mission_type", kFenceList}};
    if (counted) fields["seq"] = before;
    lock.unlock();  // the answer may come while this goes out
    (void)transmit(counted ? "MISSION_REQUEST_INT" : "MISSION_REQUEST_LIST", fields);
    lock.lock();
    (void)fence_came_.wait_for(lock, stop, std::chrono::duration<double>(kAskAgain),
                               [&] { return fence_count_.has_value() != counted || fence_.size() != before; });
  }
  fence_asked_ = false;
  if (!complete()) return std::nullopt;
  std::vector<mavlink::MissionItem> items = std::move(fence_);
  lock.unlock();
  (void)transmit("MISSION_ACK", {{"target_system", system_id_},
                                 {"target_component", kFenceKeeper},
                                 {"type", kMissionAccepted},
                                 {"mission_type", kFenceList}});
  return items;
}

void MavsdkLink::Impl::on(double /*now*/, const Sender& /*sender*/, const mavlink::MissionCount& message) {
  {
    const std::scoped_lock lock(mutex_);
    const bool ours = message.target_component == kOwnComponent && message.mission_type == kFenceList;
    if (!ours || !fence_asked_ || fence_count_) return;
    ++answers_;
    fence_count_ = message.count;
  }
  fence_came_.notify_all();
}

void MavsdkLink::Impl::on(double /*now*/, const Sender& /*sender*/, const mavlink::MissionItem& message) {
  {
    const std::scoped_lock lock(mutex_);
    const bool ours = message.target_component == kOwnComponent && message.mission_type == kFenceList;
    const bool next = fence_count_ && fence_.size() < *fence_count_ && message.seq == fence_.size();
    if (!ours || !fence_asked_ || !next) return;
    fence_.push_back(message);
  }
  fence_came_.notify_all();
}

std::optional<std::vector<mavlink::MissionItem>> MavsdkLink::read_fence(double timeout_s, const std::stop_token& stop) {
  return impl_->read_fence(timeout_s, stop);
}

}  // namespace jink::bridge::mavsdk
