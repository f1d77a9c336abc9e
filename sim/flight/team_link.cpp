// SPDX-License-Identifier: BSD-3-Clause
#include "sim/flight/team_link.hpp"

#include <algorithm>

namespace jink::sim::flight {
namespace {

constexpr std::uint64_t kIntentStream = 77;  // apart from the seed's other streams
constexpr double kDueTolerance = 1e-9;       // s, that a sum of steps may be short of a time by

}  // namespace

class TeamLink::Port final : public bridge::team::IntentTransport {
 public:
  Port(TeamLink& link, std::size_t number, const TeamPortOptions& options)
      : link_(link), number_(number), options_(options) {}

  bool poll(bridge::team::IntentMessage& message) override {
    const auto letter = std::find_if(box_.begin(), box_.end(),
                                     [&](const Letter& l) { return l.arrives <= link_.now_ + kDueTolerance; });
    if (letter == box_.end() || !options_.listens) return false;
    // Stamped with the sender's system time, read against this one's.
    const double age = link_.now_ - letter->sent + options_.clock_ahead - letter->clock_ahead;
    message = {{letter->writer, link_.now_, age}, letter->intent};
    box_.erase(letter);
    return true;
  }
  bool publish(const bridge::team::Intent& intent) override {
    if (link_.now_ < options_.silent_from) link_.send(number_, intent, options_.clock_ahead);
    return true;
  }
  [[nodiscard]] std::uint64_t identity() const override { return number_ + 1; }
  [[nodiscard]] bridge::team::IntentStatus status() const override { return {}; }

  void take(Letter letter) { box_.push_back(std::move(letter)); }

 private:
  TeamLink& link_;
  std::size_t number_;
  TeamPortOptions options_;
  std::deque<Letter> box_;
};

TeamLink::TeamLink(const TeamLinkOptions& options) : options_(options), random_(options.seed, kIntentStream) {}

TeamLink::~TeamLink() = default;

bridge::team::IntentTransport& TeamLink::join(const TeamPortOptions& options) {
  ports_.push_back(std::make_unique<Port>(*this, ports_.size(), options));
  return *ports_.back();
}

void TeamLink::send(std::size_t from, const bridge::team::Intent& intent, double clock_ahead) {
  for (std::size_t to = 0; to < ports_.size(); ++to) {
    const double lost = random_.uniform(0.0, 1.0);
    const double late = random_.uniform(0.0, 1.0);
    if (to != from && lost < options_.loss) continue;
    ports_[to]->take(
        {now_, now_ + options_.delay + late * options_.jitter, ports_[from]->identity(), clock_ahead, intent});
  }
}

}  // namespace jink::sim::flight
