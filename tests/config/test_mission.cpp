// SPDX-License-Identifier: BSD-3-Clause
#include "config/mission.hpp"

#include <gtest/gtest.h>

#include "tests/config/yaml_case.hpp"

namespace jink::config {
namespace {

const std::string kValidMission =
    "format: jink-mission/1\n"                                   // line 1
    "name: survey\n"                                             // 2
    "connection: udpin://127.0.0.1:14541\n"                      // 3
    "vehicle: ardrone2\n"                                        // 4
    "takeoff_height: 2.5\n"                                      // 5
    "min_height: 1.2\n"                                          // 6
    "waypoints: [[5, 5, 2], [20, 0, 0]]\n"                       // 7
    "arrival: hold\n"                                            // 8
    "geofence: {min: [-50, -40, 0.5], max: [50, 40, 20]}\n"      // 9
    "dds: {domain: 7}\n"                                         // 10
    "tracks: {required: false, timeout_s: 1.5, coast_s: 0.5}\n"  // 11
    "time_limit: 120\n";                                         // 12

void try_mission(const std::filesystem::path& file) {
  static_cast<void>(load_mission(file));
}

TEST(LoadMission, ReadsEveryKey) {
  const Folder folder;
  const Mission m = load_mission(folder.write("m.yaml", kValidMission));
  EXPECT_EQ(m.name, "survey");
  EXPECT_EQ(m.connection, "udpin://127.0.0.1:14541");
  EXPECT_EQ(m.vehicle_name, "ardrone2");
  EXPECT_EQ(m.vehicle.length, 0.52);
  EXPECT_EQ(m.takeoff_height, 2.5);
  EXPECT_EQ(m.min_height, 1.2);
  ASSERT_EQ(m.waypoints.size(), 2U);
  EXPECT_EQ(m.waypoints[0], Vec3(5, 5, 2));
  EXPECT_EQ(m.waypoints[1], Vec3(20, 0, 0));  // lower than min_height: left as it is, raised in flight
  EXPECT_EQ(m.arrival, Arrival::kHold);
  EXPECT_EQ(m.geofence.min, Vec3(-50, -40, 0.5));
  EXPECT_EQ(m.geofence.max, Vec3(50, 40, 20));
  EXPECT_EQ(m.dds_domain, 7);
  EXPECT_FALSE(m.tracks.required);
  EXPECT_EQ(m.tracks.timeout_s, 1.5);
  EXPECT_EQ(m.tracks.coast_s, 0.5);
  EXPECT_EQ(m.time_limit, 120.0);
}

TEST(LoadMission, WhatSeesIsMountedOnTheVehicle) {
  const Folder folder;
  EXPECT_FALSE(load_mission(folder.write("m.yaml", kValidMission)).cloud.has_value());
  EXPECT_EQ(load_mission(folder.write("m.yaml", kValidMission + "cloud: {}\n")).cloud, CloudPolicy());
  const std::string cloud =
      "cloud: {frame: camera, mount: {position: [0.1, 0, 0.05], orientation: [0.2, 0.3, 0.4]}, range: 6, "
      "unknown: free, timeout_s: 2, forget_s: 30, all_round: true}\n";
  CloudPolicy expected;
  expected.frame = "camera";
  expected.position = {0.1, 0, 0.05};
  expected.orientation = {0.2, 0.3, 0.4};
  expected.range = 6;
  expected.timeout_s = 2;
  expected.forget_s = 30;
  expected.all_round = true;
  EXPECT_EQ(load_mission(folder.write("m.yaml", kValidMission + cloud)).cloud, expected);
}

TEST(LoadMission, HeightsAreAboveWhatItSays) {
  const Folder folder;
  const std::string head =
      "format: jink-mission/1\nname: m\nconnection: udpin://:14540\nvehicle: px4\nwaypoints: [[1, 2, 488.5]]\n";
  EXPECT_EQ(load_mission(folder.write("m.yaml", head)).heights, Heights::kGround);
  EXPECT_EQ(load_mission(folder.write("m.yaml", head + "heights: origin\n")).heights, Heights::kOrigin);
  // What is above the sea says nothing of min_height here.
  const Mission m = load_mission(folder.write(
      "m.yaml", head + "heights: amsl\nmin_height: 900\ngeofence: {min: [-9, -9, 480], max: [9, 9, 500]}\n"));
  EXPECT_EQ(m.heights, Heights::kSea);
  EXPECT_EQ(m.waypoints[0].z(), 488.5);
}

TEST(LoadMission, NamesTheAutopilotOrTakesTheOnlyOne) {
  const Folder folder;
  const std::string head =
      "format: jink-mission/1\nname: m\nconnection: udpin://:14540\nvehicle: px4\nwaypoints: [[1, 2, 3]]\n";
  EXPECT_EQ(load_mission(folder.write("m.yaml", head)).system_id, 0);
  EXPECT_EQ(load_mission(folder.write("m.yaml", head + "system_id: 255\n")).system_id, 255);
}

TEST(LoadMission, ALocalFrameHasHeightsOfItsOwn) {
  Mission given;
  given.waypoints = {{1, 2, 5}};
  given.geofence = {{-9, -9, 0}, {9, 9, 20}};
  const auto heights = [&](Heights above) {
    given.heights = above;
    const Mission m = in_local_frame(given, 3.0, 488.0);
    EXPECT_EQ(m.min_height, 4.0);
    EXPECT_EQ(m.ground, 3.0);
    EXPECT_EQ(m.geofence.max.z() - m.waypoints[0].z(), 15.0);
    return m.waypoints[0].z();
  };
  EXPECT_EQ(heights(Heights::kGround), 8.0);
  EXPECT_EQ(heights(Heights::kOrigin), 5.0);
  EXPECT_EQ(heights(Heights::kSea), -483.0);
}

TEST(LoadMission, FillsInWhatIsOptional) {
  const Folder folder;
  const Mission m =
      load_mission(folder.write("m.yaml",
                                "format: jink-mission/1\nname: short\nconnection: serial:///dev/ttyACM0:921600\n"
                                "vehicle: px4\nwaypoints: [[1, 2, 3]]\ntracks: {coast_s: 0}\n"));
  const Mission defaults;
  EXPECT_EQ(m.takeoff_height, defaults.takeoff_height);
  EXPECT_EQ(m.min_height, defaults.min_height);
  EXPECT_EQ(m.arrival, Arrival::kLand);
  EXPECT_EQ(m.geofence.max, planner::base::Box{}.max);
  EXPECT_EQ(m.dds_domain, 0);
  EXPECT_TRUE(m.tracks.required);
  EXPECT_EQ(m.tracks.timeout_s, 1.0);
  EXPECT_EQ(m.tracks.coast_s, 0.0);
  EXPECT_EQ(m.tracks.sensed_from, SensedFrom::kWorld);
  EXPECT_EQ(m.time_limit, 300.0);
  EXPECT_EQ(m.dds_namespace, "");
  EXPECT_EQ(m.state, Transport::kMavlink);
  EXPECT_EQ(m.setpoints, Transport::kMavlink);
  EXPECT_TRUE(m.intents);
  EXPECT_TRUE(m.tracks.sources.jink && m.tracks.sources.autoware && m.tracks.sources.vision && m.tracks.sources.adsb);
}

TEST(LoadMission, ReadsWhereStateComesFromAndWhoTellsOfObstacles) {
  std::string text = kValidMission;
  text += "state: dds\nsetpoints: dds\nintents: false\n";
  text.replace(text.find("domain: 7"), 9, "domain: 7, namespace: px4_1/team");
  text.replace(text.find("coast_s: 0.5"), 12, "sensed_from: vehicle, sources: [adsb]");
  const Folder folder;
  const Mission m = load_mission(folder.write("m.yaml", text));
  EXPECT_EQ(m.dds_namespace, "px4_1/team");
  EXPECT_EQ(m.state, Transport::kDds);
  EXPECT_EQ(m.setpoints, Transport::kDds);
  EXPECT_FALSE(m.intents);
  EXPECT_FALSE(m.tracks.sources.jink || m.tracks.sources.autoware || m.tracks.sources.vision);
  EXPECT_TRUE(m.tracks.sources.adsb);
  EXPECT_EQ(m.tracks.sensed_from, SensedFrom::kVehicle);
}

TEST(LoadMission, ReadsWhoseTracksAreHeardAndWhereTheirFrameIs) {
  const Folder folder;
  const auto load = [&](const std::string& tracks) {
    std::string text = kValidMission;
    text.replace(text.find("required: false"), 15, tracks);
    return load_mission(folder.write("m.yaml", text)).tracks;
  };
  TrackPolicy tracks = load("namespace: uav_1/sense, writers: {jink: [front, rear], autoware: [/perception]}");
  EXPECT_EQ(tracks.name_space, "uav_1/sense");
  ASSERT_EQ(tracks.writers.size(), 3U);
  EXPECT_EQ(tracks.writers[1].participant, "rear");
  EXPECT_EQ(tracks.writers[1].topic, TrackTopic::kJink);
  EXPECT_EQ(tracks.writers[2].participant, "/perception");
  EXPECT_EQ(tracks.writers[2].topic, TrackTopic::kAutoware);
  tracks = load("sources: [vision], writers: {vision: [camera]}, origins: {vision: [47.4, 8.5, 488]}");
  EXPECT_TRUE(tracks.sources.vision);
  EXPECT_FALSE(tracks.sources.adsb);
  EXPECT_EQ(tracks.writers.at(0).topic, TrackTopic::kVision);
  EXPECT_TRUE(tracks.origins[2]);
  tracks = load("writers: {jink: [front]}, origins: {jink: [47.4, 8.5, 488]}");
  EXPECT_FALSE(tracks.sources.autoware || tracks.sources.vision);  // names nobody, so nobody's are read
  EXPECT_TRUE(tracks.sources.jink && tracks.sources.adsb);
  EXPECT_FALSE(tracks.origins[1]);
  ASSERT_TRUE(tracks.origins[0]);
  EXPECT_EQ(tracks.origins[0]->latitude_deg, 47.4);
  EXPECT_EQ(tracks.origins[0]->longitude_deg, 8.5);
  EXPECT_EQ(tracks.origins[0]->altitude_m, 488.0);
}

TEST(LoadMission, FindsTheFolderOfKeysBesideTheMission) {
  const Folder folder;
  std::string text = kValidMission;
  text.replace(text.find("domain: 7"), 9, "domain: 7, security: keys");
  std::filesystem::create_directory(folder.path() / "keys");
  for (const char* name : {"identity_ca.cert.pem", "cert.pem", "key.pem", "permissions_ca.cert.pem", "governance.p7s",
                           "permissions.p7s"}) {
    try {
      static_cast<void>(load_mission(folder.write("m.yaml", text)));
      ADD_FAILURE() << "without " << name;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find("key 'dds.security': value 'keys' holds no file " + std::string(name)),
                std::string::npos)
          << error.what();
    }
    folder.write("keys/" + std::string(name), "x");
  }
  EXPECT_TRUE(
      std::filesystem::equivalent(load_mission(folder.write("m.yaml", text)).dds_security, folder.path() / "keys"));
}

TEST(LoadMission, ReadsTheTranspondersAddress) {
  const Folder folder;
  EXPECT_FALSE(load_mission(folder.write("d.yaml", kValidMission)).icao_address);
  EXPECT_EQ(load_mission(folder.write("m.yaml", kValidMission + "icao_address: 3c6666\n")).icao_address, 0x3C6666U);
  EXPECT_EQ(load_mission(folder.write("m.yaml", kValidMission + "icao_address: 400123\n")).icao_address, 0x400123U);
}

TEST(LoadMission, ReadsHowFlightsEndByCause) {
  const Folder folder;
  const Endings defaults = load_mission(folder.write("d.yaml", kValidMission)).endings;
  for (const auto member : {&Endings::tracks, &Endings::link, &Endings::position, &Endings::breach, &Endings::planner})
    EXPECT_EQ(defaults.*member, EndsIn::kHold);
  EXPECT_EQ(defaults.battery, EndsIn::kLand);
  EXPECT_EQ(defaults.traffic, EndsIn::kLand);
  EXPECT_FALSE(defaults.motors_cut || defaults.return_above_fence || defaults.hover_until_empty);
  const Endings e =
      load_mission(folder.write("m.yaml", kValidMission +
                                              "endings: {tracks: land, link: return, "
                                              "position: land, battery: hold, breach: return, planner: land, "
                                              "accept: [hover_until_empty, motors_cut]}\n"))
          .endings;
  EXPECT_EQ(e.tracks, EndsIn::kLand);
  EXPECT_EQ(e.link, EndsIn::kReturn);
  EXPECT_EQ(e.position, EndsIn::kLand);
  EXPECT_EQ(e.battery, EndsIn::kHold);
  EXPECT_EQ(e.breach, EndsIn::kReturn);
  EXPECT_EQ(e.planner, EndsIn::kLand);
  EXPECT_TRUE(e.motors_cut && e.hover_until_empty);
  EXPECT_FALSE(e.return_above_fence);
}

TEST(LoadMission, AcceptsTheUrlsOfMavsdk) {
  for (const std::string url :
       {"udp://:14540", "udpin://0.0.0.0:14540", "udpout://192.168.1.12:14550", "tcp://localhost:5760", "tcpin://:5760",
        "tcpout://10.0.0.2:5760", "udpin://[::1]:14540", "serial:///dev/ttyACM0", "serial:///dev/ttyUSB0:57600",
        "serial_flowcontrol:///dev/ttyS1:921600"}) {
    std::string text = kValidMission;
    text.replace(text.find("udpin://127.0.0.1:14541"), 23, url);
    const Folder folder;
    const auto file = folder.write("m.yaml", text);
    EXPECT_NO_THROW(EXPECT_EQ(load_mission(file).connection, url)) << url;
  }
}

TEST(LoadMission, RefusesBadConnections) {
  const std::string url = "udpin://127.0.0.1:14541";
  const std::vector<BadCase> cases = {
      {url, "127.0.0.1:14540", 3, "connection", "127.0.0.1:14540", "is not a MAVSDK URL; expected SCHEME://ADDRESS"},
      {url, "udpinn://127.0.0.1:1", 3, "connection", "udpinn://127.0.0.1:1", "did you mean 'udpin'?"},
      {url, "http://x:80", 3, "connection", "http://x:80",
       "a scheme of udp, udpin, udpout, tcp, tcpin, tcpout, serial"},
      {url, "udpin://127.0.0.1", 3, "connection", "udpin://127.0.0.1", "has no valid port; expected [HOST]:PORT"},
      {url, "\"udpin://127.0.0.1:\"", 3, "connection", "udpin://127.0.0.1:", "the port in [1, 65535]"},
      {url, "udpin://127.0.0.1:0", 3, "connection", "udpin://127.0.0.1:0", "[1, 65535]"},
      {url, "udpin://127.0.0.1:65536", 3, "connection", "udpin://127.0.0.1:65536", "[1, 65535]"},
      {url, "udpin://127.0.0.1:99999999999999999999", 3, "connection", "", "[1, 65535]"},
      {url, "udpout://:14540", 3, "connection", "udpout://:14540", "has no host"},
      {url, "\"udpin://a b:14540\"", 3, "connection", "udpin://a b:14540", "holds a space"},
      {url, "serial://ttyACM0:57600", 3, "connection", "serial://ttyACM0:57600", "expected /DEVICE[:BAUD]"},
      {url, "serial:///dev/ttyACM0:fast", 3, "connection", "serial:///dev/ttyACM0:fast", "has no valid baud rate"},
      {url, "", 3, "connection", "null", "is empty; expected text"},
      {"connection: " + url + "\n", "", 1, "connection", "", "missing; expected a MAVSDK URL"},
      {"connection: " + url, "connection: " + url + "\nicao_address: 3C666", 4, "icao_address", "3C666", "six hex"},
      {"connection: " + url, "connection: " + url + "\nicao_address: 3C666G", 4, "icao_address", "3C666G", "six hex"},
      {"connection: " + url, "connection: " + url + "\nsystem_id: 0", 4, "system_id", "0", "[1, 255]"},
      {"connection: " + url, "connection: " + url + "\nsystem_id: 256", 4, "system_id", "256", "[1, 255]"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidMission, bad, try_mission);
}

TEST(LoadMission, RefusesBadValues) {
  const std::vector<BadCase> cases = {
      {"jink-mission/1", "jink-scenario/1", 1, "format", "jink-scenario/1", "is not 'jink-mission/1'"},
      {"vehicle: ardrone2", "vehicle: dragonfly", 4, "vehicle", "dragonfly", "ardrone2, px4"},
      {"takeoff_height: 2.5", "takeoff_height: 0", 5, "takeoff_height", "0", "is not in (0, 100]"},
      {"takeoff_height: 2.5", "takeoff_height: 25", 5, "takeoff_height", "25", "geofence's top; not in (0, 20]"},
      {"min_height: 1.2", "min_height: -1", 6, "min_height", "-1", "is not in [0, 1000]"},
      {"min_height: 1.2", "min_height: 20", 6, "min_height", "20", "geofence's top; not in [0, 20)"},
      {"[[5, 5, 2], [20, 0, 0]]", "[]", 7, "waypoints", "[]", "a list with a number of elements in [1, 10000]"},
      {"[20, 0, 0]", "[20, 0]", 7, "waypoints[1]", "[20, 0]", "expected [x, y, z]"},
      {"[20, 0, 0]", "[51, 0, 0]", 7, "waypoints[1][0]", "51", "is outside the geofence; not in [-50, 50]"},
      {"[20, 0, 0]", "[20, -40.5, 0]", 7, "waypoints[1][1]", "-40.5", "is outside the geofence; not in [-40, 40]"},
      {"[20, 0, 0]", "[20, 0, 20.5]", 7, "waypoints[1][2]", "20.5", "is outside the geofence; not in [0.5, 20]"},
      {"[-50, -40, 0.5]", "[-50, -40, 1.5]", 7, "waypoints[1][2]", "0", "raised to min_height, 1.2, is outside"},
      {"arrival: hold", "arrival: hover", 8, "arrival", "hover", "is not one of land, hold"},
      {"max: [50, 40, 20]", "max: [50, 40, 0.5]", 9, "geofence.max[2]", "0.5", "is not above min, 0.5"},
      {"domain: 7", "domain: 233", 10, "dds.domain", "233", "is not in [0, 232]"},
      {"domain: 7", "domain: 1.5", 10, "dds.domain", "1.5", "is not an integer; expected an integer in [0, 232]"},
      {"domain: 7", "domain: 99999999999999999999", 10, "dds.domain", "99999999999999999999", "is not in [0, 232]"},
      {"domain: 7", "domain: 7, namespace: /px4", 10, "dds.namespace", "/px4", "is not a namespace"},
      {"domain: 7", "domain: 7, namespace: \"px 4\"", 10, "dds.namespace", "px 4", "is not a namespace"},
      {"coast_s: 0.5", "sensed_from: mars", 11, "tracks.sensed_from", "mars", "is not one of world, vehicle"},
      {"coast_s: 0.5", "sources: []", 11, "tracks.sources", "[]", "a list with a number of elements in [1, 4]"},
      {"coast_s: 0.5", "sources: [radar]", 11, "tracks.sources[0]", "radar",
       "is not one of jink, autoware, vision, adsb"},
      {"time_limit: 120", "cloud: {range: 1}", 12, "cloud.range", "1", "is not in [2, 25]"},
      {"time_limit: 120", "cloud: {ranges: 8}", 12, "cloud.ranges", "", "did you mean 'range'?"},
      {"time_limit: 120", "cloud: {frame: map}", 12, "cloud.frame", "map", "is known without"},
      {"time_limit: 120", "cloud: {unknown: solid}", 12, "cloud.unknown", "solid", "is not one of free, occupied"},
      {"time_limit: 120", "cloud: {mount: {position: [0, 0]}}", 12, "cloud.mount.position", "", ""},
      {"time_limit: 120", "cloud: {mount: {place: [0, 0, 0]}}", 12, "cloud.mount.place", "", "position"},
      {"time_limit: 120", "cloud: {timeout_s: 0}", 12, "cloud.timeout_s", "0", "is not in (0, 60]"},
      {"time_limit: 120", "endings: {tracks: loiter}", 12, "endings.tracks", "loiter", "not one of hold, land, return"},
      {"time_limit: 120", "endings: {position: return}", 12, "endings.position", "return", "expected hold or land"},
      {"time_limit: 120", "endings: {battery: hold}", 12, "endings.battery", "hold", "accept: [hover_until_empty]"},
      {"time_limit: 120", "endings: {batery: land}", 12, "endings.batery", "", "did you mean 'battery'?"},
      {"time_limit: 120", "endings: {accept: [all]}", 12, "endings.accept[0]", "all", "is not one of motors_cut"},
      {"coast_s: 0.5", "namespace: /uav", 11, "tracks.namespace", "/uav", "is not a namespace"},
      {"coast_s: 0.5", "writers: {jink: []}", 11, "tracks.writers.jink", "[]", "elements in [1, 100]"},
      {"required: false, timeout_s: 1.5, coast_s: 0.5", "writers: {jink: [a, a]}", 11, "tracks.writers.jink[1]", "a",
       "is named twice"},
      {"coast_s: 0.5", "writers: {jink: [a]}", 11, "tracks.required", "false", "is at odds with writers"},
      {"coast_s: 0.5", "writers: {adsb: [a]}", 11, "tracks.writers.adsb", "", "jink, autoware, vision"},
      {"coast_s: 0.5", "sources: [jink, autoware], writers: {jink: [a]}", 11, "tracks.writers", "", "have 'autoware'"},
      {"coast_s: 0.5", "sources: [jink], writers: {autoware: [a]}", 11, "tracks.writers", "", "have 'jink'"},
      {"coast_s: 0.5", "origins: {jink: [91, 0, 0]}", 11, "tracks.origins.jink[0]", "91", "is not in [-90, 90]"},
      {"domain: 7", "domain: 7, security: nowhere", 10, "dds.security", "nowhere", "holds no file identity_ca"},
      {"time_limit: 120", "state: ros", 12, "state", "ros", "is not one of mavlink, dds"},
      {"required: false", "required: maybe", 11, "tracks.required", "maybe", "is not true or false"},
      {"timeout_s: 1.5", "timeout_s: 0", 11, "tracks.timeout_s", "0", "is not in (0, 60]"},
      {"coast_s: 0.5", "coast_s: -1", 11, "tracks.coast_s", "-1", "is not in [0, 60]"},
      {"coast_s: 0.5", "coasts: 1", 11, "tracks.coasts", "1", "did you mean 'coast_s'?"},
      {"time_limit: 120", "acceptance_radius: 0", 12, "acceptance_radius", "0", "is not in (0, 100]"},
      {"time_limit: 120", "acceptance_radius: near", 12, "acceptance_radius", "near", "expected a number in (0, 100]"},
      {"time_limit: 120", "hold_time: -1", 12, "hold_time", "-1", "is not in (0, 86400]"},
      {"time_limit: 120", "hold_time: 120\ntime_limit: 120", 13, "time_limit", "120", "is not in (120, 86400]"},
      {"time_limit: 120", "time_limit: .inf", 12, "time_limit", ".inf", "not a finite number"},
      {"time_limit: 120", "time_limits: 120", 12, "time_limits", "120", "did you mean 'time_limit'?"},
      {"waypoints: [[5, 5, 2], [20, 0, 0]]\n", "", 1, "waypoints", "", "missing; expected a list of [x, y, z]"},
  };
  for (const BadCase& bad : cases) expect_refused(kValidMission, bad, try_mission);
}

}  // namespace
}  // namespace jink::config
