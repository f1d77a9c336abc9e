// SPDX-License-Identifier: BSD-3-Clause
// What stands for the intents' DDS topic in virtual time: each vehicle's committed path on its way to the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "bridge/team/intents.hpp"
#include "planner/base/random.hpp"

namespace jink::sim::flight {

struct TeamLinkOptions {
  std::uint64_t seed = 1;
  double delay = 0.02;  ///< s, of an intent on its way
  double jitter = 0.0;  ///< s, more at most, drawn for each message and reader
  double loss = 0.0;    ///< share of the messages that do not arrive
};

/// How one vehicle takes part.
struct TeamPortOptions {
  bool listens = true;                            ///< to the others
  double silent_from = planner::base::kInfinity;  ///< nothing it says after that gets through
  double clock_ahead = 0.0;                       ///< s, by which its system clock is ahead of the simulation's
};

/// Delivers every intent to every vehicle, the sender's own too, as DDS does. The same for the same arguments and
/// calls. Not thread-safe.
class TeamLink {
 public:
  explicit TeamLink(const TeamLinkOptions& options = {});
  ~TeamLink();
  TeamLink(const TeamLink&) = delete;
  TeamLink& operator=(const TeamLink&) = delete;

  /// The end of the next vehicle; what is sent before it joins does not reach it. Lives as long as the link.
  bridge::team::IntentTransport& join(const TeamPortOptions& options = {});

  /// Goes on to `now`.
  void advance(double now) { now_ = now; }

 private:
  struct Letter {
    double sent = 0.0, arrives = 0.0;
    std::uint64_t writer = 0;
    double clock_ahead = 0.0;  ///< the sender's
    bridge::team::Intent intent;
  };
  class Port;

  void send(std::size_t from, const bridge::team::Intent& intent, double clock_ahead);

  TeamLinkOptions options_;
  planner::base::RandomStream random_;
  double now_ = 0.0;
  std::vector<std::unique_ptr<Port>> ports_;
};

}  // namespace jink::sim::flight
