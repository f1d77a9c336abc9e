// SPDX-License-Identifier: BSD-3-Clause
// What `jink doctor` says of DDS, with real peers that are right, absent or wrong in one way each.
#include "bridge/doctor/dds_checks.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/clouds.hpp"
#include "bridge/dds/discovery.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/px4_link.hpp"
#include "bridge/dds/tracks.hpp"
#include "bridge/doctor/vehicle_checks.hpp"
#include "tests/bridge/dds/dds_testing.hpp"
#include "tests/support/child_process.hpp"

namespace jink::bridge::doctor {
namespace {

using config::Mission;
using config::Transport;
using dds::DdsEndpoint;
using dds::DdsParticipant;
using dds::DdsTrackWriter;
using dds::Payload;
using dds::PayloadWriter;
using testing::ChildProcess;
using testing::own_domain;
using testing::python;
using testing::script;

constexpr double kWindow_s = 2.0;  // long enough for discovery on this machine

Mission tracks_mission(int domain) {
  Mission mission;
  mission.dds_domain = domain;
  mission.tracks.sources.autoware = mission.tracks.sources.vision = false;
  return mission;
}

// The check of `name` after kWindow_s, while `act` runs every 20 ms.
std::vector<Check> inspect(
    const Mission& mission, const std::function<void()>& act = [] {}, double seconds = kWindow_s) {
  std::jthread peer([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      act();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  return inspect_dds(mission, seconds);
}

Check find(const std::vector<Check>& checks, const std::string& name) {
  const auto found = std::find_if(checks.begin(), checks.end(), [&](const Check& c) { return c.name == name; });
  EXPECT_NE(found, checks.end()) << name;
  return found == checks.end() ? Check{} : *found;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The check of a topic with a writer; again where that was not found within the window, as on a busy machine.
Check inspect_written(
    const Mission& mission, const std::string& topic, const std::function<void()>& act = [] {}) {
  constexpr int kMost = 5;
  Check check;
  for (int n = 0; n < kMost && (n == 0 || check.finding == "no writer"); ++n)
    check = find(inspect(mission, act), topic);
  return check;
}

TEST(DdsInspect, IsPleasedWithAWriterWhoseDataArrive) {
  const Mission mission = tracks_mission(own_domain());
  DdsTrackWriter writer(mission.dds_domain);
  planner::base::Track obstacle;
  obstacle.radius = 0.5;
  const auto checks = inspect(mission, [&] { (void)writer.publish(std::vector{obstacle}, dds::system_time() - 0.25); });
  const Check check = find(checks, dds::kTracksTopic);
  EXPECT_EQ(check.level, Check::Level::kOk) << check.finding;
  EXPECT_TRUE(has(check.finding, "1 writer,") && has(check.finding, " Hz, stamps 0.2")) << check.finding;
  EXPECT_EQ(check.remedy, "");
  const Check domain = find(checks, "DDS domain " + std::to_string(mission.dds_domain));
  EXPECT_EQ(domain.level, Check::Level::kOk);
  EXPECT_TRUE(has(domain.finding, "jink track writer")) << domain.finding;
}

TEST(DdsInspect, MissesWhoIsNeeded) {
  Mission mission = tracks_mission(own_domain());
  mission.state = mission.setpoints = Transport::kDds;
  const auto checks = inspect_dds(mission, 0.3);
  ASSERT_EQ(checks.size(), 6U);
  for (const Check& check : checks) EXPECT_EQ(check.level, Check::Level::kMissing) << check.name;
  EXPECT_TRUE(has(checks[0].remedy, "ROS_DOMAIN_ID=" + std::to_string(mission.dds_domain)));
  EXPECT_TRUE(has(checks[0].remedy, "multicast"));
  mission.state = mission.setpoints = Transport::kMavlink;
  mission.tracks.required = false;
  for (const Check& check : inspect_dds(mission, 0.3)) EXPECT_EQ(check.level, Check::Level::kWarning) << check.name;
}

TEST(DdsInspect, NamesTheProgramThatHoldsTheDiscoveryPort) {
  const Mission mission = tracks_mission(own_domain());
  EXPECT_EQ(dds::discovery_trouble(mission.dds_domain), "");
  const int thief = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * mission.dds_domain));
  ASSERT_EQ(bind(thief, reinterpret_cast<const sockaddr*>(&where), sizeof where), 0);
  const DdsTrackWriter unheard(mission.dds_domain);
  for (const Check& check : inspect_dds(mission, 0.3)) {
    EXPECT_EQ(check.level, Check::Level::kMissing) << check.name;
    EXPECT_TRUE(has(check.remedy, "UDP port " + std::to_string(ntohs(where.sin_port)))) << check.remedy;
    EXPECT_TRUE(has(check.remedy, "0 to 101")) << check.remedy;
  }
  close(thief);
  EXPECT_EQ(dds::discovery_trouble(mission.dds_domain), "");
}

TEST(DdsInspect, LooksForCloudsWhereTheMissionNeedsThem) {
  Mission mission = tracks_mission(own_domain());
  mission.tracks.required = false;
  mission.cloud.emplace();
  mission.cloud->frame = "camera_link";
  EXPECT_EQ(find(inspect_dds(mission, 0.3), dds::kCloudTopic).level, Check::Level::kMissing);
  dds::DdsParticipant node(mission.dds_domain, "camera");
  dds::DdsCloudWriter writer(node);
  const std::vector<Eigen::Vector3f> points{{4.0F, 0.0F, 1.0F}};
  struct Case {
    std::vector<Eigen::Vector3f> points;
    std::string frame;
    double age = 0.0;
    std::string finding;
  };
  for (const auto& [given, frame, age, finding] :
       {Case{points, "camera_link", 0.1, "1 writer,"}, Case{points, "odom", 0.1, "frame_id 'odom'"},
        Case{{}, "camera_link", 0.1, "no point in it"}, Case{points, "camera_link", 2.0, "stamp 2.0"}}) {
    const Check check = inspect_written(mission, dds::kCloudTopic, [&, &given = given, &frame = frame, &age = age] {
      (void)writer.publish(given, dds::system_time() - age, frame);
    });
    EXPECT_TRUE(has(check.finding, finding)) << check.finding;
    EXPECT_EQ(check.level,
              frame == "camera_link" && age < 1.0 && !given.empty() ? Check::Level::kOk : Check::Level::kFault);
    EXPECT_EQ(has(check.remedy, "cloud.frame"), check.level == Check::Level::kFault) << check.remedy;
  }
}

TEST(DdsInspect, NamesTheOffsetOfAClock) {
  const Mission mission = tracks_mission(own_domain());
  DdsTrackWriter writer(mission.dds_domain);
  const Check check =
      inspect_written(mission, dds::kTracksTopic, [&] { (void)writer.publish({}, dds::system_time() + 3600.0); });
  EXPECT_EQ(check.level, Check::Level::kWarning);
  EXPECT_TRUE(has(check.finding, "stamps -3")) << check.finding;
  EXPECT_TRUE(has(check.remedy, "clock"));
}

TEST(DdsInspect, NamesFramesAndPayloadsThatCannotBeUsed) {
  const Mission mission = tracks_mission(own_domain());
  DdsTrackWriter writer(mission.dds_domain);
  Check check = inspect_written(mission, dds::kTracksTopic, [&] { (void)writer.publish({}, 1.0, "base_link"); });
  EXPECT_EQ(check.level, Check::Level::kFault);
  EXPECT_TRUE(has(check.finding, "base_link")) << check.finding;
  const Mission other = tracks_mission(own_domain());
  DdsParticipant peer(other.dds_domain);
  PayloadWriter broken(peer, dds::kTracksTopic, dds::kTracksType);
  check = inspect_written(other, dds::kTracksTopic, [&] { (void)broken.write(Payload{0, 1, 0, 0, 7}); });
  EXPECT_EQ(check.level, Check::Level::kFault);
  EXPECT_TRUE(has(check.finding, "layout")) << check.finding;
}

TEST(DdsInspect, SeesAMatchWithoutData) {
  const Mission mission = tracks_mission(own_domain());
  DdsTrackWriter silent(mission.dds_domain);
  const Check check = inspect_written(mission, dds::kTracksTopic);
  EXPECT_EQ(check.level, Check::Level::kFault);
  EXPECT_EQ(check.finding, "1 writer matched, but no data");
  EXPECT_TRUE(has(check.remedy, "UDP") && has(check.remedy, "--ipc=host"));
}

std::string near_match(const std::string& topic, const std::string& type) {
  return "no writer, but perception has " + topic + " of type " + type;
}

TEST(DdsInspect, NamesNearMatches) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"jink/obstacle_tracks", dds::kTracksType},                                       // no rt/
      {"/jink/obstacle_tracks", "other::Type_"},   {"rt/obstacles", dds::kTracksType},  // the type elsewhere
      {"rt/jink/obstacle_trakcs", "other::Type_"}, {"rt/drone1/jink/obstacle_tracks", "other::Type_"},
  };
  for (const auto& [topic, type] : cases) {
    const Mission mission = tracks_mission(own_domain());
    DdsParticipant peer(mission.dds_domain, "perception");
    PayloadWriter writer(peer, topic, type);
    const Check check = find(inspect(mission), dds::kTracksTopic);
    EXPECT_EQ(check.level, Check::Level::kMissing) << topic;
    EXPECT_EQ(check.finding, near_match(topic, type));
    EXPECT_TRUE(has(check.remedy, "ROS 2: /jink/obstacle_tracks")) << check.remedy;
    EXPECT_EQ(has(check.remedy, "rt/ in front"), !topic.starts_with("rt/"));
  }
}

TEST(DdsInspect, DoesNotTakeStrangersForNearMatches) {
  const Mission mission = tracks_mission(own_domain());
  DdsParticipant peer(mission.dds_domain);
  PayloadWriter writer(peer, "rt/rosout", "rcl_interfaces::msg::dds_::Log_");
  const Check check = find(inspect(mission), dds::kTracksTopic);
  EXPECT_EQ(check.finding, "no writer");
}

TEST(DdsInspect, NamesAnotherTypeOnTheTopic) {
  const Mission mission = tracks_mission(own_domain());
  DdsParticipant peer(mission.dds_domain, "perception");
  PayloadWriter writer(peer, dds::kTracksTopic, "jink_msgs::msg::ObstacleTracks");
  const Check check = find(inspect(mission), dds::kTracksTopic);
  EXPECT_EQ(check.level, Check::Level::kFault);
  EXPECT_EQ(check.finding, "a writer (perception) with type jink_msgs::msg::ObstacleTracks");
  EXPECT_TRUE(has(check.remedy, dds::kTracksType));
}

TEST(DdsInspect, NamesThePolicyThatDoesNotMatch) {
  Mission mission = tracks_mission(own_domain());
  mission.setpoints = Transport::kDds;
  mission.dds_namespace = "px4_1";
  ChildProcess peer({python(), script("cyclone_mismatch.py"), "--domain", std::to_string(mission.dds_domain)});
  ASSERT_TRUE(peer.wait_line([](const std::string& line) { return line == "ready"; }, 0, std::chrono::seconds(60)));
  const auto checks = inspect(mission);
  const Check tracks = find(checks, dds::kTracksTopic);
  EXPECT_EQ(tracks.level, Check::Level::kFault);
  EXPECT_TRUE(has(tracks.finding, "OWNERSHIP, PARTITION")) << tracks.finding;
  const Check setpoint = find(checks, "rt/px4_1/fmu/in/trajectory_setpoint");
  EXPECT_EQ(setpoint.level, Check::Level::kFault);
  EXPECT_TRUE(has(setpoint.finding, "RELIABILITY, DURABILITY, DEADLINE, LIVELINESS")) << setpoint.finding;
}

TEST(DdsInspect, SeesPx4sAgentInEitherVersion) {
  for (const char* version : {"0", "1"}) {
    Mission mission = tracks_mission(own_domain());
    mission.tracks.required = false;
    mission.state = mission.setpoints = Transport::kDds;
    mission.dds_namespace = "px4_1";
    ChildProcess peer({python(), script("cyclone_px4.py"), "--domain", std::to_string(mission.dds_domain),
                       "--namespace", "px4_1", "--version", version});
    ASSERT_TRUE(peer.wait_line([](const std::string& line) { return line == "ready"; }, 0, std::chrono::seconds(60)));
    const auto checks = inspect(mission);
    const std::string topic = "rt/px4_1/fmu/out/vehicle_local_position";
    const bool v1 = std::string(version) == "1";
    const Check live = find(checks, v1 ? topic + "_v1" : topic);
    EXPECT_EQ(live.level, Check::Level::kOk) << live.finding;
    EXPECT_TRUE(has(live.finding, " Hz, stamps ")) << live.finding;
    const Check idle = find(checks, v1 ? topic : topic + "_v1");
    EXPECT_EQ(idle.level, Check::Level::kOk) << idle.finding;
    for (const char* in : {"rt/px4_1/fmu/in/trajectory_setpoint", "rt/px4_1/fmu/in/offboard_control_mode"}) {
      EXPECT_EQ(find(checks, in).level, Check::Level::kOk);
      EXPECT_EQ(find(checks, in).finding, "1 reader");
    }
  }
}

TEST(DdsInspect, SeesADetectorAndLooksForTheOthersInVain) {
  Mission mission;
  mission.dds_domain = own_domain();
  ChildProcess peer({python(), script("cyclone_detections.py"), "--domain", std::to_string(mission.dds_domain)});
  const auto checks = inspect(
      mission, [] {}, 2.0 * kWindow_s);
  const Check live = find(checks, dds::kVisionTopic);
  EXPECT_EQ(live.level, Check::Level::kOk) << live.finding;
  EXPECT_TRUE(has(live.finding, "1 writer,")) << live.finding;
  EXPECT_EQ(find(checks, dds::kTracksTopic).finding, "no writer; another source speaks");
  EXPECT_EQ(find(checks, dds::kAutowareTopic).finding, "no writer; another source speaks");
}

TEST(QosMismatches, AreThoseOfReadersThatAskForMoreThanIsOffered) {
  DdsEndpoint theirs;
  theirs.writes = theirs.reliable = theirs.beyond_volatile = theirs.deadline = true;
  EXPECT_TRUE(dds::qos_mismatches(theirs).empty());
  theirs.writes = false;
  EXPECT_EQ(dds::qos_mismatches(theirs), (std::vector<std::string>{"RELIABILITY", "DURABILITY", "DEADLINE"}));
  theirs = DdsEndpoint{};
  theirs.partitions = {"a", ""};
  EXPECT_TRUE(dds::qos_mismatches(theirs).empty());
}

TEST(DdsDoctor, SaysWhomTheMissionMissesAndWhoElseWrites) {
  Mission mission = tracks_mission(own_domain());
  mission.tracks.writers = {{config::TrackTopic::kJink, "front"}, {config::TrackTopic::kJink, "rear"}};
  DdsParticipant front(mission.dds_domain, "front");
  DdsParticipant other(mission.dds_domain, "other");
  DdsTrackWriter first(front);
  DdsTrackWriter second(other);
  std::string all;
  for (const Check& check : inspect(
           mission, [&] { (void)(first.publish({}, dds::system_time()) && second.publish({}, dds::system_time())); },
           2.0 * kWindow_s))
    all += std::string(to_string(check.level)) + ": " + check.finding + "\n";
  EXPECT_NE(all.find("missing: nothing from 'rear'"), std::string::npos) << all;
  EXPECT_NE(all.find("warning: also from 'other', which is not heard"), std::string::npos) << all;
  EXPECT_EQ(all.find("nothing from 'front'"), std::string::npos) << all;
  EXPECT_NE(all.find("no obstacle in them"), std::string::npos) << all;
}

TEST(DdsDoctor, SaysThatObstaclesAreGivenInAnotherFrame) {
  Mission mission = tracks_mission(own_domain());
  mission.geofence = {{-50, -50, 0}, {50, 50, 20}};
  DdsTrackWriter writer(mission.dds_domain);
  planner::base::Track track;
  track.radius = 0.5;
  track.position = {65'000, 50'000, 3};
  const auto act = [&] { (void)writer.publish(std::vector{track}, dds::system_time()); };
  const Check check = find(inspect(mission, act), dds::kTracksTopic);
  EXPECT_EQ(check.level, Check::Level::kFault);
  EXPECT_NE(check.finding.find("farther beside the geofence"), std::string::npos) << check.finding;
  mission.tracks.origins[0] = config::GeodeticOrigin{};
  const std::string placed = find(inspect(mission, act), dds::kTracksTopic).finding;
  EXPECT_EQ(placed.find("farther beside"), std::string::npos) << placed;
}

}  // namespace
}  // namespace jink::bridge::doctor
