// SPDX-License-Identifier: BSD-3-Clause
// Jumps of the estimate: cases worked by hand, and random flights with losses against the jumps that were put in.
#include "bridge/vehicle/estimate_resets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bridge/vehicle/status_text.hpp"

namespace jink::bridge::vehicle {
namespace {

using Sample = EstimateResets::Sample;

constexpr double kStep = 0.02;

// A vehicle that flies 5 m/s east; both messages of each instant, until a jump is ordered.
struct Flight {
  EstimateResets resets;
  double t = 100.0;
  Vec3 jump = Vec3::Zero();
  std::uint8_t counter = 254;

  [[nodiscard]] Sample sample() const { return {t, Vec3(5.0 * t, 0.0, 10.0) + jump, {5.0, 0.0, 0.0}}; }
  void position() { resets.on_position(sample()); }
  void odometry() { resets.on_odometry(sample(), counter); }
  void steps(int n, bool with_odometry = true) {
    for (int i = 0; i < n; ++i) {
      t += kStep;
      position();
      if (with_odometry) odometry();
    }
  }
};

TEST(EstimateResets, AreNoneInAFlight) {
  Flight f;
  f.steps(500);
  EXPECT_EQ(f.resets.count(), 0U);
  EXPECT_EQ(f.resets.shift(), Vec3::Zero());
}

TEST(EstimateResets, ADeclaredJumpCountsOnceWhicheverMessageComesFirst) {
  for (const bool position_first : {true, false}) {
    Flight f;
    f.steps(5);
    f.jump = {3.0, -1.0, 0.5};
    ++f.counter;
    f.t += kStep;
    position_first ? f.position() : f.odometry();
    // A jump this long shows with the position that has it, and not before.
    EXPECT_EQ(f.resets.count(), position_first ? 1U : 0U);
    position_first ? f.odometry() : f.position();
    EXPECT_EQ(f.resets.count(), 1U);
    f.steps(50);
    EXPECT_EQ(f.resets.count(), 1U);
    EXPECT_NEAR((f.resets.shift() - f.jump).norm(), 0.0, 1e-9);
  }
}

TEST(EstimateResets, ASmallJumpNeedsTheCounter) {
  Flight f;
  f.steps(5);
  f.jump = {0.0, 0.3, 0.0};
  ++f.counter;
  f.steps(5);
  EXPECT_EQ(f.resets.count(), 1U);
  EXPECT_NEAR((f.resets.shift() - f.jump).norm(), 0.0, 1e-9);
  f.jump = {0.0, 0.6, 0.0};
  f.steps(5);
  EXPECT_EQ(f.resets.count(), 1U);  // indistinguishable from flying
}

TEST(EstimateResets, TheCounterWraps) {
  Flight f;
  f.steps(5);
  for (int i = 1; i <= 4; ++i) {  // 254 -> 255 -> 0 -> 1 -> 2
    f.jump.x() += 0.5;
    ++f.counter;
    f.steps(5);
    EXPECT_EQ(f.resets.count(), static_cast<std::uint32_t>(i));
  }
  EXPECT_NEAR((f.resets.shift() - f.jump).norm(), 0.0, 1e-9);
}

TEST(EstimateResets, BehindLostMessagesTheCounterTellsHowManyAndAShortGapHowFar) {
  for (const double gap : {0.3, 2.0}) {
    Flight f;
    f.steps(5);
    f.t += gap;
    f.jump = {4.0, 0.0, 0.0};
    f.counter = static_cast<std::uint8_t>(f.counter + 2);
    f.steps(5);
    EXPECT_EQ(f.resets.count(), 2U) << gap;
    const Vec3 expected = gap <= EstimateResets::kLongestGap ? f.jump : Vec3(Vec3::Zero());
    EXPECT_NEAR((f.resets.shift() - expected).norm(), 0.0, 1e-9) << gap;
  }
}

TEST(EstimateResets, WithoutOdometryAJumpThatNoMotionExplainsCounts) {
  Flight f;
  f.steps(5, false);
  f.jump = {0.0, 1.5, 0.0};
  f.steps(5, false);
  EXPECT_EQ(f.resets.count(), 1U);
  EXPECT_NEAR((f.resets.shift() - f.jump).norm(), 0.0, 1e-9);
  f.jump.y() = 2.4;  // less than kUnexplained more
  f.steps(5, false);
  EXPECT_EQ(f.resets.count(), 1U);
  f.t += 0.5;  // a gap in which anything may have been flown
  f.jump.y() = 9.0;
  f.steps(5, false);
  EXPECT_EQ(f.resets.count(), 1U);
}

TEST(EstimateResets, HardManoeuvresAreNoJumps) {
  EstimateResets resets;
  Vec3 p = Vec3::Zero();
  Vec3 v(10.0, 0.0, 0.0);
  double t = 100.0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 a(i / 50 % 2 == 0 ? -20.0 : 20.0, 5.0 * std::sin(i * 0.3), 0.0);
    p += v * kStep + a * kStep * kStep / 2.0;
    v += a * kStep;
    t += kStep;
    if (i % 10 == 0 || i % 100 < 30) resets.on_position({t, p, v});  // the others are lost
  }
  EXPECT_EQ(resets.count(), 0U);
}

TEST(EstimateResets, AfterARebootTheJumpToTheNewOriginIsNone) {
  Flight f;
  f.steps(5);
  f.resets.restart();
  f.t = 1.0;
  f.jump = {-500.0, 3.0, 0.0};
  f.counter = 0;
  f.steps(5);
  EXPECT_EQ(f.resets.count(), 0U);
}

TEST(EstimateResets, OdometryOfAnotherClockIsNotUsed) {
  Flight f;
  f.steps(5, false);
  f.resets.on_odometry({1.7e9, Vec3::Zero(), Vec3::Zero()}, 1);
  f.resets.on_odometry({1.7e9 + kStep, {9.0, 0.0, 0.0}, Vec3::Zero()}, 2);
  f.steps(5, false);
  EXPECT_EQ(f.resets.count(), 0U);
}

// 300 flights with a fifth of the messages lost, and a jump now and then: the sum is right and each counts once.
TEST(EstimateResets, ManyFlightsWithLosses) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int flight = 0; flight < 300; ++flight) {
    Flight f;
    std::uint32_t jumps = 0;
    f.steps(3);
    for (int i = 0; i < 500; ++i) {
      if (i % 60 == 30) {
        f.jump += Vec3(6.0 * uniform(random) - 3.0, 2.0 * uniform(random) - 1.0, uniform(random));
        ++f.counter;
        ++jumps;
      }
      f.t += kStep;
      const bool swap = uniform(random) < 0.5;
      for (const bool odometry : {swap, !swap}) {
        if (uniform(random) >= 0.2) odometry ? f.odometry() : f.position();
      }
    }
    f.steps(3);
    ASSERT_EQ(f.resets.count(), jumps) << flight;
    ASSERT_NEAR((f.resets.shift() - f.jump).norm(), 0.0, 1e-6) << flight;
  }
}

using Lines = std::vector<std::string>;

TEST(StatusTexts, PutsChunksTogether) {
  StatusTexts texts;
  EXPECT_EQ(texts.add(4, 0, 0, "Low battery\t"), Lines{"warning: Low battery"});
  const std::string fifty(50, 'x');
  EXPECT_EQ(texts.add(2, 7, 0, fifty), Lines{});
  EXPECT_EQ(texts.add(2, 7, 1, fifty), Lines{});
  EXPECT_EQ(texts.add(2, 7, 2, "end"), Lines{"critical: " + fifty + fifty + "end"});
  EXPECT_EQ(texts.add(6, 8, 0, "a\nb\x07"), Lines{"info: a?b?"});
}

TEST(StatusTexts, PutsTogetherWhatWasCut) {
  for (const std::size_t size : {0U, 1U, 49U, 50U, 51U, 99U, 100U, 101U, 250U}) {
    const std::string text(size, 'x');
    const Lines chunks = jink::bridge::vehicle::status_text_chunks(text);
    EXPECT_EQ(chunks.size(), size <= 50 ? 1 : size / 50 + 1) << size;
    StatusTexts texts;
    Lines whole;
    for (std::uint32_t i = 0; i < chunks.size(); ++i) {
      EXPECT_TRUE(whole.empty());
      EXPECT_LE(chunks[i].size(), 50U);
      whole = texts.add(6, chunks.size() > 1 ? 9 : 0, i, chunks[i]);
    }
    EXPECT_EQ(whole, Lines{"info: " + text}) << size;
  }
}

TEST(StatusTexts, SaysWhereAChunkWasLost) {
  StatusTexts texts;
  const std::string fifty(50, 'x');
  EXPECT_EQ(texts.add(3, 1, 1, "tail"), Lines{"error: ...tail"});
  EXPECT_EQ(texts.add(3, 2, 0, fifty), Lines{});
  EXPECT_EQ(texts.add(6, 3, 0, "next"), (Lines{"error: " + fifty + "...", "info: next"}));
  EXPECT_EQ(texts.add(9, 0, 0, "odd"), Lines{"text: odd"});
  for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(texts.add(6, 4, i, fifty), Lines{});
}

}  // namespace
}  // namespace jink::bridge::vehicle
