// SPDX-License-Identifier: BSD-3-Clause
#include "sim/recorded/recording.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "config/error.hpp"

namespace jink::sim::recorded {
namespace {

namespace fs = std::filesystem;

class RecordingFile : public ::testing::Test {
 protected:
  RecordingFile() : file_(fs::temp_directory_path() / ("recording-" + std::to_string(getpid()) + ".csv")) {}
  ~RecordingFile() override {
    std::error_code none;
    fs::remove(file_, none);
  }
  Recording read(const std::string& text) {
    std::ofstream(file_, std::ios::binary) << text;
    return load_recording(file_);
  }
  /// What is said of it, without the file's name.
  std::string refused(const std::string& text) {
    try {
      (void)read(text);
    } catch (const config::ConfigError& error) {
      return std::string(error.what()).substr(file_.string().size());
    }
    return "taken";
  }

  fs::path file_;
};

TEST_F(RecordingFile, CsvHasAMoverForEachIdInItsOwnTime) {
  const Recording r = read(
      "\xEF\xBB\xBF# a comment\n\nnote,ID,t,z,y,x\r\n"
      "a,bird,2.0,3,2,1\r\nb,17,0.5,0,0,0\n"
      "c,bird,1.5,3,2,0.5\n"  // earlier than the one before
      "d,\"17\",1,0,0,1\n");
  ASSERT_EQ(r.movers.size(), 2U);
  EXPECT_EQ(r.movers[0].id, "bird");
  EXPECT_EQ(r.movers[0].times, (std::vector<double>{1.5, 2.0}));
  EXPECT_EQ(r.movers[0].points, (std::vector<Vec3>{{0.5, 2, 3}, {1, 2, 3}}));
  EXPECT_EQ(r.movers[0].radius, kRadius);
  EXPECT_EQ(r.movers[0].height, 0.0);
  EXPECT_EQ(r.movers[1].id, "17");
  EXPECT_EQ(r.movers[1].times, (std::vector<double>{0.5, 1.0}));
}

TEST_F(RecordingFile, CsvTellsHowLargeMoversAre) {
  const Recording r = read("t,id,x,y,z,radius,height\n0,1,0,0,1,0.4,1.9\n1,1,1,0,1,0.5,1.9\n");
  EXPECT_EQ(r.movers.at(0).radius, 0.5);
  EXPECT_EQ(r.movers.at(0).height, 1.9);
}

TEST_F(RecordingFile, WhoIsSeenOnceIsLeftOutAndCounted) {
  const Recording r = read("t,id,x,y,z\n0,1,0,0,0\n0,2,5,5,5\n1,1,1,0,0\n");
  EXPECT_EQ(r.movers.size(), 1U);
  EXPECT_EQ(r.seen_once, 1U);
}

// One degree of latitude at the equator is 110.57 km, one of longitude 111.32 km (WGS 84).
TEST_F(RecordingFile, AdsbIsPutIntoTheTangentPlaneOfItsFirstPlace) {
  const Recording r = read(
      "time,icao24,lat,lon,velocity,baroaltitude,geoaltitude\n"
      "1600000000,abc123,0,10,50,800,900\n"
      "1600000010,abc123,,,50,800,\n"
      "1600000020,abc123,0.01,10.01,50,800,950\n");
  ASSERT_EQ(r.movers.size(), 1U);
  EXPECT_EQ(r.without_place, 1U);
  EXPECT_EQ(r.movers[0].radius, kAircraftRadius);
  const std::vector<Vec3>& points = r.movers[0].points;
  EXPECT_LT((points[0] - Vec3(0, 0, 900)).norm(), 1e-6);
  EXPECT_LT((points[1] - Vec3(1113.2, 1105.7, 950)).norm(), 1.0);
}

// The first lines of a file of each set look like these.
TEST_F(RecordingFile, FramesOfPedestriansAreFourTenthsOfASecondApart) {
  for (const auto& [text, shift] : {std::pair(std::string("780.0\t1.0\t8.46\t3.59\n"
                                                          "790.0\t1.0\t9.57\t3.79\n"
                                                          "810.0\t1.0\t10.67\t3.99\n"),
                                              10),
                                    {std::string("0\t1\t8.46\t3.59\t1.67\t0.17\n"
                                                 "10\t1\t9.57\t3.79\t1.66\t0.32\n"
                                                 "30\t1\t10.67\t3.99\t1.66\t0.32\n"),
                                     10},
                                    {std::string("7.8e+02 1.0e+00 8.46e+00 0.0 3.59e+00 1.67 0.0 0.4\n"
                                                 "  7.86e+02 1.0e+00 9.57e+00 0.0 3.79e+00 1.67 0.0 0.4\n"
                                                 "7.98e+02 1.0e+00 1.067e+01 0.0 3.99e+00 1.67 0.0 0.4\n"),
                                     6}}) {
    const Recording r = read(text);
    ASSERT_EQ(r.movers.size(), 1U) << shift;
    EXPECT_EQ(r.movers[0].id, "1");
    ASSERT_EQ(r.movers[0].times.size(), 3U);
    EXPECT_NEAR(r.movers[0].times[1], 0.4, 1e-9);
    EXPECT_NEAR(r.movers[0].times[2], 1.2, 1e-9);
    EXPECT_EQ(r.movers[0].points[2], Vec3(10.67, 3.99, 0.5 * kPersonHeight));
    EXPECT_EQ(r.movers[0].height, kPersonHeight);
  }
}

TEST_F(RecordingFile, ANameForEachContent) {
  const std::string text = "t,id,x,y,z\n0,1,0,0,0\n1,1,1,0,0\n";
  EXPECT_EQ(read(text).digest, read(text).digest);
  EXPECT_NE(read(text).digest, read(text + "2,1,2,0,0\n").digest);
}

TEST_F(RecordingFile, WhatIsWrongIsSaidWithItsLine) {
  const std::string head = "t,id,x,y,z\n", row = "0,1,0,0,0\n";
  for (const auto& [text, told] : std::vector<std::pair<std::string, std::string>>{
           {"", ": is empty or cannot be read"},
           {"# nothing\n", ": holds nothing"},
           {head, ": nobody in it is at two places"},
           {head + row, ": nobody in it is at two places"},
           {"t,id,x,y\n0,1,0,0\n",
            ":1: no column for z: of a header t, id, x, y, z are needed, or time, icao24, lat, lon, geoaltitude"},
           {head + "0,1,0,0\n", ":2: 4 columns where the header has 5"},
           {head + "0,1,0,0,0,\n", ":2: 6 columns where the header has 5"},
           {head + row + "1,1,east,0,0\n", ":3: x: 'east' is not a number"},
           {head + row + "1,1,nan,0,0\n", ":3: x: 'nan' is not in [-1000000, 1000000]"},
           {head + row + "1,1,2e6,0,0\n", ":3: x: '2e6' is not in [-1000000, 1000000]"},
           {head + row + "1,,0,0,0\n", ":3: id: is empty"},
           {head + row + row, ":3: '1' is there twice at this time"},
           {head + row + "1,1,5000,0,0\n", ":3: '1' comes here at 5000 m/s, above 1000 m/s"},
           {"t,id,x,y,z,radius\n0,1,0,0,0,0\n", ":2: radius: '0' is not in (0, 1000]"},
           {"time,icao24,lat,lon,alt\n0,a,91,0,0\n", ":2: lat: '91' is not in [-90, 90]"},
           {"time,icao24,lat,lon,alt\n0,a,0,0,0\n1,a,0,20,0\n", ":3: is more than 1000 km from the first place"},
           {"0 1 2\n",
            ":1: 3 numbers: a header is missing, or there are 4 and more (frame, id, x, y), or 8 (ETH's obsmat)"},
           {"0 1 2 3\n0 1 2 3 4 5 6 7\n", ":2: 8 numbers where the line before had 4"},
           {"0 1 2 3\n10 1 two 3\n", ":2: x: 'two' is not a number"}})
    EXPECT_EQ(refused(text), told) << text;
  EXPECT_THROW((void)load_recording("/nowhere/at.csv"), config::ConfigError);
  EXPECT_THROW((void)load_recording(fs::temp_directory_path()), config::ConfigError);
}

TEST(Recording, TheSampleIsReadWhole) {
  const Recording r = load_recording(fs::path(JINK_SOURCE_DIR) / "config/recordings/square.csv");
  EXPECT_EQ(r.movers.size(), 18U);
  EXPECT_EQ(r.seen_once + r.without_place, 0U);
}

}  // namespace
}  // namespace jink::sim::recorded
