// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/tracking/track_sources.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace jink::bridge::tracking {
namespace {

// Has `left` messages of one writer.
class FakeSource final : public TrackSource {
 public:
  FakeSource(std::uint64_t writer, int left) : writer_(writer), left_(left) {}
  bool poll(TrackMessage& message) override {
    if (left_ == 0) return false;
    --left_;
    message.writer = writer_;
    return true;
  }
  [[nodiscard]] TrackSourceStatus status() const override { return status_now; }

  TrackSourceStatus status_now;

 private:
  std::uint64_t writer_;
  int left_;
};

TEST(TrackSources, HasNothingWithoutSources) {
  TrackSources sources;
  TrackMessage message;
  EXPECT_FALSE(sources.poll(message));
  EXPECT_EQ(sources.status().writers, 0);
}

TEST(TrackSources, StarvesNoSourceForABusyOne) {
  FakeSource busy(1, 100);
  FakeSource quiet(2, 2);
  FakeSource empty(3, 0);
  TrackSources sources;
  sources.add(busy);
  sources.add(empty);
  sources.add(quiet);
  std::vector<std::uint64_t> order;
  TrackMessage message;
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(sources.poll(message));
    order.push_back(message.writer);
  }
  EXPECT_EQ(order, (std::vector<std::uint64_t>{1, 2, 1, 2, 1, 1}));
}

TEST(TrackSources, GivesEveryMessageOnce) {
  FakeSource first(1, 3);
  FakeSource second(2, 5);
  TrackSources sources;
  sources.add(first);
  sources.add(second);
  TrackMessage message;
  int taken = 0;
  while (sources.poll(message)) ++taken;
  EXPECT_EQ(taken, 8);
}

TEST(TrackSources, SumsTheStatusAndTellsTheNewestRefusal) {
  FakeSource first(1, 0);
  FakeSource second(2, 0);
  TrackSources sources;
  sources.add(first);
  sources.add(second);
  first.status_now = {.writers = 1, .messages = 10, .refused = 2, .dropped_tracks = 3, .last_refusal = "a"};
  second.status_now = {.writers = 2, .messages = 20, .refused = 4, .dropped_tracks = 6, .last_refusal = ""};
  TrackSourceStatus status = sources.status();
  EXPECT_EQ(status.writers, 3);
  EXPECT_EQ(status.messages, 30U);
  EXPECT_EQ(status.refused, 6U);
  EXPECT_EQ(status.dropped_tracks, 9U);
  EXPECT_EQ(status.last_refusal, "a");
  second.status_now.last_refusal = "b";
  EXPECT_EQ(sources.status().last_refusal, "b");
  EXPECT_EQ(sources.status().last_refusal, "b");
  first.status_now.last_refusal = "c";
  EXPECT_EQ(sources.status().last_refusal, "c");
}

}  // namespace
}  // namespace jink::bridge::tracking
