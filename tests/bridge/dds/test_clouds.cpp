// SPDX-License-Identifier: BSD-3-Clause
// Clouds of points: out of bytes, whatever they are, and over real DDS transports.
#include "bridge/dds/clouds.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "bridge/cdr/cloud_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::dds {
namespace {

using testing::eventually;
using testing::own_domain;

const std::vector<Eigen::Vector3f> kPoints{{1.5F, -2.0F, 0.25F}, {3.0F, 4.0F, 5.0F}, {-1.0F, 0.0F, 7.5F}};

struct Field {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t type = 7;
};

/// A PointCloud2 as any driver may make it; its data are the caller's.
struct CloudOnWire {
  std::string frame = "base_link";
  std::uint32_t height = 1, width = 3;
  std::vector<Field> fields{{"x", 0, 7}, {"y", 4, 7}, {"z", 8, 7}};
  bool big_endian = false;
  std::uint32_t point_step = 12, row_step = 36;
  std::vector<std::uint8_t> data = std::vector<std::uint8_t>(36);

  template <typename Number>
  void put(std::size_t place, Number number) {
    std::array<std::uint8_t, sizeof number> bytes{};
    std::memcpy(bytes.data(), &number, sizeof number);
    for (std::size_t i = 0; i < bytes.size(); ++i) data.at(place + i) = bytes.at(big_endian ? bytes.size() - 1 - i : i);
  }
  [[nodiscard]] Payload payload() const {
    Payload bytes(1000 + data.size());
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());  // NOLINT
    eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
    cdr.serialize_encapsulation();
    cdr << std::int32_t{100} << std::uint32_t{500'000'000} << frame << height << width;
    cdr << static_cast<std::uint32_t>(fields.size());
    for (const Field& field : fields) cdr << field.name << field.offset << field.type << std::uint32_t{1};
    cdr << static_cast<std::uint8_t>(big_endian ? 1 : 0) << point_step << row_step << data << std::uint8_t{1};
    bytes.resize(cdr.getSerializedDataLength());
    return bytes;
  }
};

void expect_points(const Payload& payload) {
  const auto cloud = cdr::decode_cloud(payload);
  ASSERT_TRUE(cloud.has_value());
  EXPECT_EQ(cloud->frame_id, "base_link");
  EXPECT_DOUBLE_EQ(cloud->stamp_unix_s, 100.5);
  EXPECT_EQ(cloud->points, kPoints);
}

TEST(DecodeCloud, ReadsWhatEncodeWrites) {
  expect_points(cdr::encode_cloud(kPoints, 100.5, "base_link"));
}

// Doubles and floats at any place, in rows with room at their ends, of either byte order.
TEST(DecodeCloud, ReadsAnyLayout) {
  for (const bool big_endian : {false, true}) {
    for (const bool doubles : {false, true}) {
      CloudOnWire message;
      message.big_endian = big_endian;
      const std::uint8_t type = doubles ? 8 : 7;
      message.fields = {{"intensity", 0, 2}, {"z", 1, type}, {"x", 9, type}, {"y", 17, type}, {"ring", 25, 4}};
      message.height = 3;
      message.width = 1;
      message.point_step = 27;
      message.row_step = 31;
      message.data.assign(2 * 31 + 27, 0);
      for (std::size_t row = 0; row < 3; ++row) {
        const auto put = [&](std::size_t offset, float value) {
          doubles ? message.put(row * 31 + offset, static_cast<double>(value)) : message.put(row * 31 + offset, value);
        };
        put(1, kPoints[row].z());
        put(9, kPoints[row].x());
        put(17, kPoints[row].y());
      }
      expect_points(message.payload());
    }
  }
}

TEST(DecodeCloud, KeepsPointsThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> points{{nan, nan, nan}, {1.0F, 2.0F, 3.0F}};
  const auto cloud = cdr::decode_cloud(cdr::encode_cloud(points, 0.0, "map"));
  ASSERT_TRUE(cloud.has_value());
  EXPECT_TRUE(std::isnan(cloud->points[0].x()));
  EXPECT_EQ(cloud->points[1], points[1]);
}

TEST(DecodeCloud, RefusesWhatDoesNotFit) {
  const auto refused = [](const auto& change) {
    CloudOnWire message;
    change(message);
    return !cdr::decode_cloud(message.payload());
  };
  EXPECT_FALSE(refused([](CloudOnWire&) {}));
  EXPECT_FALSE(refused([](CloudOnWire& m) { m.width = 0; })) << "empty, which is the inbox's to refuse";
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.width = 4; }));
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.height = 2; }));
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.height = m.width = 0xFFFFFFFFU; }));
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.point_step = 11; }));
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.point_step = 0; }));
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.fields[2].offset = 9; }));
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.fields[2].offset = 0xFFFFFFFFU; }));
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.fields[0].type = 5; })) << "integers";
  EXPECT_TRUE(refused([](CloudOnWire& m) { m.fields.pop_back(); }));
  EXPECT_TRUE(refused([](CloudOnWire& m) {
    m.height = 3;
    m.width = 1;
    m.row_step = 11;
  }));
  EXPECT_TRUE(refused([](CloudOnWire& m) {
    m.width = 600'000;
    m.data.resize(600'000 * 12);
  })) << "more points than are taken";
}

// Every cut and every flipped byte: it is a cloud or none, and nothing else happens (the sanitizers' tests see more).
TEST(DecodeCloud, SurvivesBytesThatAreWrong) {
  const Payload whole = CloudOnWire().payload();
  for (std::size_t size = 0; size + 1 < whole.size(); ++size)  // the last byte, is_dense, is not read
    EXPECT_FALSE(cdr::decode_cloud({whole.data(), size}).has_value()) << size;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      Payload bytes = whole;
      bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ flip);
      const auto cloud = cdr::decode_cloud(bytes);
      EXPECT_LE(cloud ? cloud->points.size() : 0U, 36U);
    }
  }
}

class DdsClouds : public ::testing::Test {
 protected:
  void match() {
    ASSERT_TRUE(eventually([&] { return reader_.status().writers == 1 && writer_.readers() == 1; }));
  }
  map::Cloud next() {
    map::Cloud cloud;
    EXPECT_TRUE(eventually([&] { return reader_.poll(cloud); })) << reader_.status().last_refusal;
    return cloud;
  }

  base::SteadyClock clock_;
  DdsParticipant node_{own_domain(), "test"};
  DdsCloudReader reader_{node_, clock_, {"", "camera"}};
  DdsCloudWriter writer_{node_};
};

TEST_F(DdsClouds, ComeAcrossInTheirFrames) {
  match();
  ASSERT_TRUE(writer_.publish(kPoints, system_time() - 0.1, "camera"));
  map::Cloud cloud = next();
  EXPECT_TRUE(cloud.mounted);
  EXPECT_EQ(cloud.points, kPoints);
  EXPECT_NEAR(cloud.stamp_age, 0.1, 0.09);
  ASSERT_TRUE(writer_.publish(kPoints, system_time(), "map"));
  cloud = next();
  EXPECT_FALSE(cloud.mounted);
  EXPECT_EQ(cloud.points, kPoints);
  ASSERT_TRUE(writer_.publish(kPoints, system_time(), "ned"));
  EXPECT_EQ(next().points[0], Eigen::Vector3f(-2.0F, 1.5F, -0.25F));
}

TEST_F(DdsClouds, OfTwentyThousandPointsComeAcross) {
  match();
  const std::vector<Eigen::Vector3f> many(20'000, {1.0F, 2.0F, 3.0F});
  ASSERT_TRUE(writer_.publish(many, system_time(), "camera"));
  EXPECT_EQ(next().points.size(), 20'000U);
}

TEST_F(DdsClouds, ThatAreOfNoUseAreCounted) {
  match();
  const auto expect_refused = [&](std::uint64_t count, const std::string& why) {
    EXPECT_TRUE(eventually([&] { return reader_.status().refused == count; }));
    EXPECT_NE(reader_.status().last_refusal.find(why), std::string::npos) << reader_.status().last_refusal;
  };
  ASSERT_TRUE(writer_.publish(kPoints, system_time(), "odom"));
  expect_refused(1, "frame_id 'odom' is neither 'camera', 'map' nor 'ned'");
  ASSERT_TRUE(writer_.publish(kPoints, system_time() - 2.0, "camera"));
  expect_refused(2, "2.0 s old");
  ASSERT_TRUE(writer_.publish({}, system_time(), "camera"));
  expect_refused(3, "without points");
  PayloadWriter bytes(node_, kCloudTopic, kCloudType);
  ASSERT_TRUE(eventually([&] { return bytes.readers() == 1; }));
  ASSERT_TRUE(bytes.write(Payload{0, 1, 0, 0, 1, 2, 3}));
  EXPECT_TRUE(eventually([&] { return reader_.status().malformed == 1; }));
  map::Cloud cloud;
  EXPECT_FALSE(reader_.poll(cloud));
}

}  // namespace
}  // namespace jink::bridge::dds
