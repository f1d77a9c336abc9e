// SPDX-License-Identifier: BSD-3-Clause
// Over real DDS transports on this machine: each test is alone in a domain of its own, and waits for discovery.
#include "bridge/dds/intents.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "Intents.h"
#include "bridge/cdr/intent_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::dds {
namespace {

using testing::eventually;
using testing::own_domain;
using Wire = jink_msgs::msg::dds_::Intent_;

team::Intent intent() {
  team::Intent said;
  said.vehicle = team::vehicle_id(3, 99);
  said.origin = frames::Geodetic{47.4, 8.5, 490.25};
  said.radius = 0.3;
  said.margin = 0.15;
  said.path = {{0.0, {1, 2, 3}, Vec3::Zero(), Vec3::Zero()}, {0.5, {2, 2, 3.5}, Vec3::Zero(), Vec3::Zero()}};
  return said;
}

/// One that another program might send.
Wire wire() {
  Wire message;
  message.header().frame_id("map");
  message.header().stamp().sec(1000);
  message.vehicle(5);
  message.origin_latitude(47.0);
  message.origin_longitude(8.0);
  message.origin_altitude(400.0);
  message.radius(0.4);
  message.margin(0.0);
  message.points().resize(2);
  message.points()[1].time(1.0);
  message.points()[1].position().x(3.0);
  return message;
}

class DdsIntentsTest : public ::testing::Test {
 protected:
  team::IntentMessage next(DdsIntents& ear, std::uint64_t writer) {
    team::IntentMessage message;
    EXPECT_TRUE(eventually([&] {
      while (ear.poll(message)) {
        if (message.writer == writer) return true;
      }
      return false;
    })) << ear.status().last_refusal;
    return message;
  }
  /// Writes until the other side has something to say of it: what goes out before discovery goes nowhere.
  bool until(const std::function<bool()>& holds, const std::function<void()>& write) {
    return eventually([&] {
      write();
      return holds();
    });
  }

  base::SteadyClock clock_;
  int domain_ = own_domain();
  DdsParticipant here_{domain_}, there_{domain_};
  DdsIntents ear_{here_, clock_};
};

TEST_F(DdsIntentsTest, CarriesEveryField) {
  DdsIntents mouth(there_, clock_);
  team::IntentMessage heard;
  ASSERT_TRUE(until(
      [&] {
        while (ear_.poll(heard)) {
          if (heard.writer == mouth.identity()) return true;
        }
        return false;
      },
      [&] { EXPECT_TRUE(mouth.publish(intent())); }));
  const team::Intent expected = intent();
  EXPECT_EQ(heard.intent.vehicle, expected.vehicle);
  EXPECT_EQ(heard.intent.origin, expected.origin);
  EXPECT_EQ(heard.intent.radius, expected.radius);
  EXPECT_EQ(heard.intent.margin, expected.margin);
  ASSERT_EQ(heard.intent.path.size(), 2U);
  EXPECT_EQ(heard.intent.path[1].t, 0.5);
  EXPECT_EQ(heard.intent.path[1].position, expected.path[1].position);
  EXPECT_GE(heard.stamp_age, 0.0);
  EXPECT_LT(heard.stamp_age, 10.0);
  EXPECT_NE(ear_.identity(), mouth.identity());
  EXPECT_EQ(ear_.status().refused, 0U);
}

TEST_F(DdsIntentsTest, KnowsItsOwnByItsIdentity) {
  team::IntentMessage heard;
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { EXPECT_TRUE(ear_.publish(intent())); }));
  EXPECT_EQ(heard.writer, ear_.identity());
}

TEST_F(DdsIntentsTest, KeepsTheNewestOfAWriter) {
  DdsIntents mouth(there_, clock_);
  team::IntentMessage heard;
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { EXPECT_TRUE(mouth.publish(intent())); }));
  // Of two in a row the newer is the first to be taken, once both are there; either may come while they are.
  team::Intent next = intent();
  EXPECT_TRUE(until(
      [&] {
        const bool newest = ear_.poll(heard) && heard.intent.margin == next.margin;
        while (ear_.poll(heard)) {
        }
        return newest;
      },
      [&] {
        for (int n = 0; n < 2; ++n) {
          next.margin += 0.01;
          EXPECT_TRUE(mouth.publish(next));
        }
      }));
}

TEST_F(DdsIntentsTest, AnUnknownOriginStaysUnknown) {
  DdsIntents mouth(there_, clock_);
  team::Intent lost = intent();
  lost.origin.reset();
  team::IntentMessage heard;
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { EXPECT_TRUE(mouth.publish(lost)); }));
  EXPECT_FALSE(heard.intent.origin.has_value());
}

Payload payload_of(const Wire& message) {
  Payload payload;
  encode(message, payload);
  return payload;
}

TEST(IntentMessages, AreDecodedFieldByField) {
  const auto message = cdr::decode_intent(payload_of(wire()));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->why, "");
  EXPECT_EQ(message->stamp_unix_s, 1000.0);
  EXPECT_EQ(message->intent.vehicle, 5U);
  EXPECT_EQ(message->intent.origin, (frames::Geodetic{47.0, 8.0, 400.0}));
  EXPECT_EQ(message->intent.radius, 0.4);
  ASSERT_EQ(message->intent.path.size(), 2U);
  EXPECT_EQ(message->intent.path[1].t, 1.0);
  EXPECT_EQ(message->intent.path[1].position, Vec3(3, 0, 0));
}

TEST(IntentMessages, WhatIsNoneOrAbsurdIsRefusedWithItsReason) {
  const Payload good = payload_of(wire());
  Payload endless = good;                                 // says that it has four billion points
  const std::size_t count_at = good.size() - 2 * 32 - 8;  // and 4 bytes of padding
  for (std::size_t i = 0; i < 4; ++i) endless[count_at + i] = 0xff;
  EXPECT_FALSE(cdr::decode_intent(endless));
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(cdr::decode_intent(std::span(good).first(size))) << size;
  }
  Wire ned = wire();
  ned.header().frame_id("ned\x07");
  EXPECT_EQ(cdr::decode_intent(payload_of(ned))->why, "frame_id 'ned?' is not 'map'");
  Wire bad = wire();
  bad.points()[1].position().y(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(cdr::decode_intent(payload_of(bad))->why, "vehicle 0: a position is not finite or out of range");
  Wire half = wire();
  half.origin_latitude(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(cdr::decode_intent(payload_of(half))->why, "vehicle 0: the origin is out of range");
  Wire long_one = wire();
  long_one.points().resize(team::IntentLimits::kPoints + 1);
  EXPECT_EQ(cdr::decode_intent(payload_of(long_one))->why, "a path of more than 1024 points");
}

TEST_F(DdsIntentsTest, RefusesAndCountsWhatIsNoIntent) {
  PayloadWriter mouth(there_, kIntentsTopic, kIntentsType);
  const Payload good = payload_of(wire());
  const Payload cut(good.begin(), good.begin() + 40);
  Wire ned = wire();
  ned.header().frame_id("ned");
  for (const Payload& payload : {cut, payload_of(ned)}) {
    const std::uint64_t before = ear_.status().refused;
    EXPECT_TRUE(until([&] { return ear_.status().refused > before; }, [&] { (void)mouth.write(payload); }));
    EXPECT_FALSE(ear_.status().last_refusal.empty());
  }
  team::IntentMessage heard;
  EXPECT_FALSE(ear_.poll(heard));
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { (void)mouth.write(good); }));
  EXPECT_EQ(heard.intent.vehicle, 5U);
}

}  // namespace
}  // namespace jink::bridge::dds
