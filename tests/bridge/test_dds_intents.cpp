// SPDX-License-Identifier: BSD-3-Clause
// Over real DDS transports on this machine: each test is alone in a domain of its own, and waits for discovery.
#include "bridge/dds_intents.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <functional>
#include <limits>
#include <string>

#include "Intents.h"
#include "bridge/dds_support.hpp"
#include "tests/bridge/child_process.hpp"

namespace jink::bridge {
namespace {

using planner::Vec3;
using testing::eventually;
using Wire = jink_msgs::msg::dds_::Intent_;

int own_domain() {
  static int tests = 0;
  return 1 + (static_cast<int>(getpid()) + 11 * tests++) % 100;
}

Intent intent() {
  Intent said;
  said.vehicle = vehicle_id(3, 99);
  said.origin = Geodetic{47.4, 8.5, 490.25};
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
  IntentMessage next(DdsIntents& ear, std::uint64_t writer) {
    IntentMessage message;
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

  SteadyClock clock_;
  int domain_ = own_domain();
  DdsNode here_{domain_}, there_{domain_};
  DdsIntents ear_{here_, clock_};
};

TEST_F(DdsIntentsTest, CarriesEveryField) {
  DdsIntents mouth(there_, clock_);
  IntentMessage heard;
  ASSERT_TRUE(until(
      [&] {
        while (ear_.poll(heard)) {
          if (heard.writer == mouth.identity()) return true;
        }
        return false;
      },
      [&] { EXPECT_TRUE(mouth.publish(intent())); }));
  const Intent expected = intent();
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
  IntentMessage heard;
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { EXPECT_TRUE(ear_.publish(intent())); }));
  EXPECT_EQ(heard.writer, ear_.identity());
}

TEST_F(DdsIntentsTest, KeepsTheNewestOfAWriter) {
  DdsIntents mouth(there_, clock_);
  IntentMessage heard;
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { EXPECT_TRUE(mouth.publish(intent())); }));
  Intent last = intent();
  last.margin = 0.9;
  ASSERT_TRUE(until(
      [&] {
        bool any = false;
        int polled = 0;
        while (ear_.poll(heard)) {
          ++polled;
          any = heard.intent.margin == 0.9;
        }
        EXPECT_LE(polled, 1);
        return any;
      },
      [&] {
        EXPECT_TRUE(mouth.publish(intent()));
        EXPECT_TRUE(mouth.publish(last));
      }));
}

TEST_F(DdsIntentsTest, AnUnknownOriginStaysUnknown) {
  DdsIntents mouth(there_, clock_);
  Intent lost = intent();
  lost.origin.reset();
  IntentMessage heard;
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { EXPECT_TRUE(mouth.publish(lost)); }));
  EXPECT_FALSE(heard.intent.origin.has_value());
}

TEST_F(DdsIntentsTest, RefusesAndCountsWhatIsNoIntent) {
  PayloadWriter mouth(there_, kIntentsTopic, kIntentsType);
  Payload good;
  encode(wire(), good);
  Payload endless = good;                                 // says that it has four billion points
  const std::size_t count_at = good.size() - 2 * 32 - 8;  // and 4 bytes of padding
  for (std::size_t i = 0; i < 4; ++i) endless[count_at + i] = 0xff;
  Payload cut(good.begin(), good.begin() + 40);
  Wire ned = wire();
  ned.header().frame_id("ned");
  Wire bad = wire();
  bad.points()[1].position().y(std::numeric_limits<double>::quiet_NaN());
  Wire half = wire();
  half.origin_latitude(std::numeric_limits<double>::quiet_NaN());
  Wire long_one = wire();
  long_one.points().resize(IntentLimits::kPoints + 1);
  Payload of_ned, of_bad, of_half, of_long;
  encode(ned, of_ned);
  encode(bad, of_bad);
  encode(half, of_half);
  encode(long_one, of_long);
  for (const Payload& payload : {endless, cut, of_ned, of_bad, of_half, of_long}) {
    const std::uint64_t before = ear_.status().refused;
    EXPECT_TRUE(until([&] { return ear_.status().refused > before; }, [&] { (void)mouth.write(payload); }));
    EXPECT_FALSE(ear_.status().last_refusal.empty());
  }
  IntentMessage heard;
  EXPECT_FALSE(ear_.poll(heard));
  ASSERT_TRUE(until([&] { return ear_.poll(heard); }, [&] { (void)mouth.write(good); }));
  EXPECT_EQ(heard.intent.vehicle, 5U);
  EXPECT_EQ(heard.intent.path[1].position, Vec3(3, 0, 0));
}

}  // namespace
}  // namespace jink::bridge
