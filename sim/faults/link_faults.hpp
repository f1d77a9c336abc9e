// SPDX-License-Identifier: BSD-3-Clause
// A bad link: packets that are lost, late or out of order. In simulated time, for datagrams (sim/mavlink/link) and for
// what stands for them in virtual time (sim/flight/closed_loop).
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "planner/base/random.hpp"

namespace jink::sim::faults {

/// What befalls the packets of one direction.
struct Impairment {
  double loss = 0.0;     ///< probability that a packet is lost, 0 to 1
  double delay = 0.0;    ///< s, for every packet
  double reorder = 0.0;  ///< probability that a packet is held back by kReorderHold, so that others overtake it

  [[nodiscard]] bool none() const { return loss == 0.0 && delay == 0.0 && reorder == 0.0; }
  bool operator==(const Impairment&) const = default;
};

struct LinkImpairment {
  Impairment up{};    ///< to the autopilot
  Impairment down{};  ///< from it
  bool operator==(const LinkImpairment&) const = default;
};

/// The stream of random numbers of one link and direction: (system, 0) up, (system, 1) down.
[[nodiscard]] constexpr std::uint64_t link_stream(int system, int direction) {
  constexpr std::uint64_t kName = 0x6c696e6b00ULL;  // a name of its own among the streams of a seed
  return kName + 2 * static_cast<std::uint64_t>(system) + static_cast<std::uint64_t>(direction);
}

/// One direction of a link. Packets that are not reordered keep their order also where the delay shrinks; what is on
/// its way when the link is lost still arrives. The random numbers depend on (seed, stream, count of packets) alone.
template <class Packet>
class ImpairedChannel {
 public:
  static constexpr double kReorderHold = 0.05;  ///< s: two or three packets of a 50 Hz stream overtake
  /// Sums of steps and of delays differ by rounding; what is due is not put off a step.
  static constexpr double kDueTolerance = 1e-9;

  ImpairedChannel(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}

  /// For the packets from now on.
  void set(const Impairment& impairment) { impairment_ = impairment; }

  /// A packet enters at `now`, which never decreases.
  void push(double now, Packet packet) {
    planner::base::RandomStream random(seed_, stream_, count_++);
    const double lost = random.uniform();
    const double reordered = random.uniform();
    if (lost < impairment_.loss) return;
    in_order_ = std::max(in_order_, now + impairment_.delay);
    const double due = reordered < impairment_.reorder ? in_order_ + kReorderHold : in_order_;
    // Behind those that are due as early: ties keep their order.
    const auto place = std::upper_bound(queue_.begin(), queue_.end(), due,
                                        [](double time, const Entry& entry) { return time < entry.due; });
    queue_.insert(place, {due, std::move(packet)});
  }

  /// Moves the next packet that has come through at `now` into `packet`; false: there is none.
  [[nodiscard]] bool pop(double now, Packet& packet) {
    if (queue_.empty() || queue_.front().due > now + kDueTolerance) return false;
    packet = std::move(queue_.front().packet);
    queue_.erase(queue_.begin());
    return true;
  }

  /// Nothing is done to packets and none is on its way: they may as well bypass the channel.
  [[nodiscard]] bool clear() const { return impairment_.none() && queue_.empty(); }

 private:
  struct Entry {
    double due;
    Packet packet;
  };
  std::uint64_t seed_;
  std::uint64_t stream_;
  Impairment impairment_;
  std::uint64_t count_ = 0;
  double in_order_ = 0.0;
  std::vector<Entry> queue_;  ///< by due time
};

}  // namespace jink::sim::faults
