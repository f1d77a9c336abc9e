// SPDX-License-Identifier: BSD-3-Clause
// The team's intents over DDS, by Fast DDS. The type on the wire is ROS 2's (bridge/dds/idl), so that a ROS node, or
// any other DDS program, can be a vehicle of the team.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "bridge/base/clock.hpp"
#include "bridge/dds/participant.hpp"
#include "bridge/team/intents.hpp"

namespace jink::bridge::dds {

inline constexpr const char* kIntentsTopic = "rt/jink/intents";  ///< ROS 2: /jink/intents
inline constexpr const char* kIntentsType = "jink_msgs::msg::dds_::Intent_";

/// Reads and writes the topic best effort, volatile. Messages are checked on Fast DDS's thread, and of each writer the
/// newest waits to be polled. Refused and counted are a payload that is no Intent, by its size before anything is
/// allocated for it; a frame_id other than `map`; values beyond IntentLimits; and more than kWriters writers that wait.
/// All functions are safe from any thread, but publish() is not to be called by two at once; none blocks.
class DdsIntents final : public team::IntentTransport {
 public:
  static constexpr std::size_t kWriters = 256;

  /// Returns at once; discovery goes on in the background. `node` and `clock` must outlive it.
  /// @throws std::runtime_error, one line, when Fast DDS cannot make reader or writer.
  DdsIntents(DdsParticipant& node, const base::Clock& clock);
  ~DdsIntents() override;
  DdsIntents(const DdsIntents&) = delete;
  DdsIntents& operator=(const DdsIntents&) = delete;

  bool poll(team::IntentMessage& message) override;
  [[nodiscard]] bool publish(const team::Intent& intent) override;
  [[nodiscard]] std::uint64_t identity() const override;
  [[nodiscard]] team::IntentStatus status() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge::dds
