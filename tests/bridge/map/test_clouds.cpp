// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/clouds.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace jink::bridge::map {
namespace {

Cloud cloud(double stamp_age, std::size_t points = 1) {
  Cloud made;
  made.stamp_age = stamp_age;
  made.points.resize(points, Eigen::Vector3f(1, 2, 3));
  return made;
}

TEST(CloudInbox, GivesWhatItWasGivenInOrder) {
  CloudInbox inbox;
  inbox.put(cloud(0.1, 1));
  inbox.put(cloud(0.1, 2));
  Cloud taken;
  ASSERT_TRUE(inbox.poll(taken));
  EXPECT_EQ(taken.points.size(), 1U);
  ASSERT_TRUE(inbox.poll(taken));
  EXPECT_EQ(taken.points.size(), 2U);
  EXPECT_FALSE(inbox.poll(taken));
  EXPECT_EQ(inbox.status().clouds, 2U);
}

TEST(CloudInbox, RefusesWhatIsOfNoUseAndSaysWhy) {
  struct Case {
    Cloud bad;
    std::string why;
  };
  const Case cases[] = {{cloud(0.0, 0), "a cloud without points"},
                        {cloud(2.0), "a cloud 2.0 s old"},
                        {cloud(std::numeric_limits<double>::quiet_NaN()), "a cloud nan s old"},
                        {cloud(-3600.0), "a cloud whose stamp is 3600.0 s ahead of this computer's time"}};
  CloudInbox inbox;
  std::uint64_t refused = 0;
  for (const Case& c : cases) {
    inbox.put(c.bad);
    EXPECT_EQ(inbox.status().refused, ++refused);
    EXPECT_EQ(inbox.status().last_refusal, c.why);
  }
  inbox.malformed();
  EXPECT_EQ(inbox.status().malformed, 1U);
  Cloud taken;
  EXPECT_FALSE(inbox.poll(taken));
}

TEST(CloudInbox, TheOldestGoWhereNobodyPolls) {
  CloudInbox inbox;
  for (std::size_t i = 1; i <= CloudLimits::kQueued + 2; ++i) inbox.put(cloud(0.0, i));
  Cloud taken;
  ASSERT_TRUE(inbox.poll(taken));
  EXPECT_EQ(taken.points.size(), 3U);
}

}  // namespace
}  // namespace jink::bridge::map
