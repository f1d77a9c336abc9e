// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/team/team.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <vector>

#include "bridge/companion/companion.hpp"
#include "tests/support/bridge_fakes.hpp"

namespace jink::bridge::team {
namespace {

using planner::base::TimedPath;

const frames::Geodetic kHere{47.4, 8.5, 490.0};
constexpr std::uint64_t kWriter = 7;

class FakeIntents final : public IntentTransport {
 public:
  bool poll(IntentMessage& message) override {
    if (inbox.empty()) return false;
    message = std::move(inbox.front());
    inbox.pop_front();
    return true;
  }
  bool publish(const Intent& intent) override {
    if (works) sent.push_back(intent);
    return works;
  }
  [[nodiscard]] std::uint64_t identity() const override { return kWriter; }
  [[nodiscard]] IntentStatus status() const override { return told; }

  std::deque<IntentMessage> inbox;
  std::vector<Intent> sent;
  IntentStatus told;
  bool works = true;
};

TimedPath line(const Vec3& from, const Vec3& to, double time) {
  return {{0.0, from, Vec3::Zero(), Vec3::Zero()}, {time, to, Vec3::Zero(), Vec3::Zero()}};
}

Intent intent(std::uint32_t system = 2, const TimedPath& path = line({10, 0, 5}, {0, 0, 5}, 5.0)) {
  return {vehicle_id(system, 100), kHere, 0.4, 0.2, path};
}

IntentMessage message(double received, double age, const Intent& said, std::uint64_t writer = 100) {
  return {{writer, received, age}, said};
}

vehicle::VehicleState own(double t = 10.0) {
  vehicle::VehicleState state;
  state.motion.stamp = state.motion.received = t;
  state.motion.value.position = {1, 2, 3};
  state.origin = kHere;
  state.system_id = 1;
  state.in_air = true;
  return state;
}

struct Hearing {
  FakeIntents transport;
  Team team{transport, 0.3, 1.0};

  std::vector<planner::geometry::KnownPath> hear(double now, const IntentMessage& heard,
                                                 const vehicle::VehicleState& state = own()) {
    transport.inbox.push_back(heard);
    team.listen(now, state);
    return team.paths(now, now);
  }
  bool take_notices(double now, const std::string& name) {
    const auto all = team.take_notices(now);
    return std::any_of(all.begin(), all.end(), [&](const Team::Notice& n) { return n.name == name; });
  }
};

TEST(Intents, AreRefusedWhereTheyAreAbsurd) {
  ASSERT_EQ(refusal(intent()), nullptr);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Intent> bad(13, intent());
  bad[0].path.clear();
  bad[1].path.resize(IntentLimits::kPoints + 1);
  for (std::size_t i = 0; i < bad[1].path.size(); ++i) bad[1].path[i].t = static_cast<double>(i);
  bad[2].radius = nan;
  bad[3].radius = 0.0;
  bad[4].margin = -0.1;
  bad[5].margin = nan;
  bad[6].path[1].t = 0.0;
  bad[7].path[1].t = nan;
  bad[8].path[0].t = -1e9;
  bad[9].path[1].position.z() = nan;
  bad[10].path[0].position.x() = 1e300;
  bad[11].origin->latitude_deg = 91.0;
  bad[12].origin->altitude_m = nan;
  for (std::size_t i = 0; i < bad.size(); ++i) EXPECT_NE(refusal(bad[i]), nullptr) << i;
}

TEST(Intents, AVehicleIsNamedByItsSystemAndItsProcess) {
  EXPECT_EQ(system_of(vehicle_id(3, 0xdeadbeefcafef00dU)), 3U);
  EXPECT_NE(vehicle_id(3, 1), vehicle_id(3, 2));
  EXPECT_LT(vehicle_id(2, ~std::uint64_t{0}), vehicle_id(3, 0));  // the system has precedence
}

TEST(Team, CountsAPathFromItsStamp) {
  Hearing h;
  const auto paths = h.hear(10.0, message(10.0, 0.3, intent()));
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_NEAR((paths[0].position(0.0) - Vec3(9.4, 0, 5)).norm(), 0.0, 1e-9);  // 0.3 s at 2 m/s
  EXPECT_NEAR(paths[0].age, 0.3, 1e-12);
  EXPECT_EQ(paths[0].radius, 0.4);
  EXPECT_EQ(paths[0].margin, 0.2);
  EXPECT_TRUE(h.take_notices(10.0, "team_vehicle"));
  // A plan that begins 0.2 s later.
  EXPECT_NEAR((h.team.paths(10.0, 10.2)[0].position(1.0) - Vec3(7.0, 0, 5)).norm(), 0.0, 1e-9);
}

TEST(Team, LearnsAClockThatIsAnHourOff) {
  Hearing h;
  for (int i = 0; i < 5; ++i) {
    const double t = 10.0 + 0.2 * i;
    const auto paths = h.hear(t, message(t, 3600.0 + (i == 3 ? 0.15 : 0.0), intent()));
    ASSERT_EQ(paths.size(), 1U);
    EXPECT_NEAR(paths[0].age, i == 3 ? 0.15 : 0.0, 1e-9);  // only what exceeds the smallest is delay
    EXPECT_NEAR(paths[0].margin, 0.2 + 0.1 * 2.0, 1e-9);   // the rest, at 2 m/s, is not known
  }
  EXPECT_TRUE(h.take_notices(11.0, "team_clock"));
}

TEST(Team, LeavesOutWhatWasOvertakenAndWhatIsTooOld) {
  Hearing h;
  h.hear(10.0, message(10.0, 0.0, intent()));
  h.hear(10.2, message(10.2, 0.0, intent(2, line({8, 1, 5}, {8, 1, 5.1}, 1.0))));
  const auto overtaken = h.hear(10.25, message(10.25, 0.3, intent()));
  EXPECT_NEAR(overtaken[0].position(0.0).y(), 1.0, 1e-9);
  h.hear(10.3, message(10.3, 5.0, intent()));
  EXPECT_TRUE(h.take_notices(10.3, "team_late"));
  EXPECT_NEAR(h.team.paths(10.3, 10.3)[0].position(0.0).y(), 1.0, 1e-9);
}

TEST(Team, PlacesAPathOfAnotherOrigin) {
  Hearing h;
  const frames::LocalFrame ours(kHere);
  Intent far = intent();
  far.origin = ours.to_geodetic({400, -300, 20});
  const auto paths = h.hear(10.0, message(10.0, 0.0, far));
  ASSERT_EQ(paths.size(), 1U);
  const Vec3 expected = ours.to_enu(frames::LocalFrame(*far.origin).to_geodetic({10, 0, 5}));
  EXPECT_NEAR((paths[0].position(0.0) - expected).norm(), 0.0, 1e-9);
  EXPECT_NEAR((expected - Vec3(410, -300, 25)).norm(), 0.0, 0.1);  // the earth's curvature is a few centimetres
}

TEST(Team, DropsAndReportsWhatCannotBePlaced) {
  Hearing h;
  Intent lost = intent();
  lost.origin.reset();
  EXPECT_TRUE(h.hear(10.0, message(10.0, 0.0, lost)).empty());
  EXPECT_TRUE(h.take_notices(10.0, "team_unplaced"));
  h.hear(10.3, message(10.3, 0.0, lost));
  EXPECT_FALSE(h.take_notices(10.3, "team_unplaced"));  // once a second
  vehicle::VehicleState blind = own();
  blind.origin.reset();
  EXPECT_TRUE(h.hear(11.0, message(11.0, 0.0, intent()), blind).empty());
  EXPECT_TRUE(h.take_notices(11.0, "team_unplaced"));
  EXPECT_EQ(h.team.unplaced(), 3U);
}

TEST(Team, DoesNotHearItself) {
  Hearing h;
  EXPECT_TRUE(h.hear(10.0, message(10.0, 0.0, intent(1), kWriter)).empty());
  EXPECT_FALSE(h.take_notices(10.0, "team_same_id"));
}

TEST(Team, NoticesTwoOfTheSameSystem) {
  Hearing h;
  h.hear(10.0, message(10.0, 0.0, intent(2), 100));
  EXPECT_FALSE(h.take_notices(10.0, "team_same_id"));
  EXPECT_EQ(h.hear(10.1, message(10.1, 0.0, intent(2), 101)).size(), 2U);  // both are avoided
  EXPECT_TRUE(h.take_notices(10.1, "team_same_id"));
  Hearing mine;
  mine.hear(10.0, message(10.0, 0.0, intent(1), 100));
  EXPECT_TRUE(mine.take_notices(10.0, "team_same_id"));
}

TEST(Team, TakesASilentOneToHangWhereItsPathEndedAndForgetsItLater) {
  Hearing h;
  h.hear(10.0, message(10.0, 0.0, intent()));
  EXPECT_EQ(h.team.paths(10.9, 10.9)[0].position_sigma, 0.0);
  const double after = h.team.paths(11.5, 11.5)[0].position_sigma;
  EXPECT_GT(after, 0.0);
  EXPECT_GT(h.team.paths(11.9, 11.9)[0].position_sigma, after);
  h.team.listen(11.9, own(11.9));
  EXPECT_EQ(h.team.vehicles(), 1U);
  EXPECT_FALSE(h.take_notices(11.9, "team_lost"));
  h.team.listen(12.1, own(12.1));
  EXPECT_TRUE(h.take_notices(12.1, "team_lost"));
  EXPECT_FALSE(h.take_notices(13.5, "team_lost"));
  ASSERT_EQ(h.team.paths(30.0, 30.0).size(), 1U);
  EXPECT_EQ(h.team.paths(30.0, 30.0)[0].until, planner::base::kInfinity);  // it gives no way
  h.team.listen(10.1 + Team::kForgetPeer, own(10.1 + Team::kForgetPeer));
  EXPECT_EQ(h.team.vehicles(), 0U);
  EXPECT_TRUE(h.team.paths(71.0, 71.0).empty());
}

TEST(Team, ASilentOneThatBeganAnewIsNotAvoidedTwice) {
  Hearing h;
  h.hear(10.0, message(10.0, 0.0, intent(2), 100));
  h.team.listen(13.0, own(13.0));
  EXPECT_EQ(h.team.paths(13.0, 13.0).size(), 1U);
  h.hear(13.1, message(13.1, 0.0, intent(2), 200));
  h.team.listen(13.2, own(13.2));
  EXPECT_EQ(h.team.paths(13.2, 13.2).size(), 1U);
}

TEST(Team, GivesTheLowerIdTheRightOfWay) {
  Hearing h;
  EXPECT_EQ(h.hear(10.0, message(10.0, 0.0, intent(2)))[0].until, Team::kRightOfWay);
  vehicle::VehicleState last = own();
  last.system_id = 3;
  EXPECT_EQ(h.hear(10.1, message(10.1, 0.0, intent(2)), last)[0].until, planner::base::kInfinity);
}

TEST(Team, ListensToSoManyAndReportsTheRest) {
  Hearing h;
  for (std::uint64_t writer = 100; writer < 200; ++writer) {
    h.hear(10.0, message(10.0, 0.0, intent(static_cast<std::uint32_t>(writer)), writer));
  }
  EXPECT_EQ(h.team.vehicles(), Team::kMostVehicles);
  EXPECT_TRUE(h.take_notices(10.0, "team_crowded"));
}

setpoints::SetpointStream stream_on(const TimedPath& path) {
  setpoints::SetpointStream stream({0.04, 0.3, 1.0, 2.0});
  stream.follow(path);
  return stream;
}

TEST(Team, TellsEachNewPlanAndAtLeastFiveTimesASecond) {
  Hearing h;
  const setpoints::SetpointStream stream =
      stream_on({{10.0, {1, 2, 3}, Vec3::Zero(), Vec3::Zero()}, {13.0, {7, 2, 3}, Vec3::Zero(), Vec3::Zero()}});
  h.team.listen(10.0, own());
  for (int i = 0; i <= 50; ++i) h.team.tell(10.0 + 0.02 * i, own(10.0 + 0.02 * i), &stream, 0);
  EXPECT_EQ(h.transport.sent.size(), 6U);
  for (std::uint64_t plan = 1; plan <= 10; ++plan) h.team.tell(11.0, own(11.0), &stream, plan);
  EXPECT_EQ(h.transport.sent.size(), 16U);
  const Intent& said = h.transport.sent.back();
  EXPECT_EQ(system_of(said.vehicle), 1U);
  EXPECT_EQ(said.origin, kHere);
  EXPECT_EQ(said.radius, 0.3);
  ASSERT_EQ(said.path.size(), 2U);
  EXPECT_EQ(said.path[0].t, 0.0);
  EXPECT_NEAR((said.path[0].position - Vec3(3, 2, 3)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(said.path[1].t, 2.0, 1e-9);
  // It is at (1, 2, 3), two metres behind: that is what others are told to keep.
  EXPECT_NEAR(said.margin, 2.0, 1e-9);
}

TEST(Team, TellsThePathThatWaitsForItsStartWithoutPointsTooClose) {
  Hearing h;
  setpoints::SetpointStream stream =
      stream_on({{9.0, {0, 2, 3}, Vec3::Zero(), Vec3::Zero()}, {30.0, {21, 2, 3}, Vec3::Zero(), Vec3::Zero()}});
  for (const double plan : {0.0, 1.0, 2.0, 3.0}) {
    const double start = 10.2 + 0.1 * plan;
    stream.follow({{start, {start - 9.0, 2, 3}, Vec3::Zero(), Vec3::Zero()},
                   {start + 20.0, {start + 11.0, 2.0 + plan, 3}, Vec3::Zero(), Vec3::Zero()}});
  }
  h.team.tell(10.0, own(), &stream, 4);
  const Intent& said = h.transport.sent.back();
  ASSERT_EQ(refusal(said), nullptr);
  EXPECT_NEAR(said.path.back().t, Team::kTold, 1e-9);
  for (std::size_t i = 1; i < said.path.size(); ++i) EXPECT_GE(said.path[i].t - said.path[i - 1].t, 0.0099);
  for (double t = 0.0; t < Team::kTold; t += 0.05) {
    EXPECT_NEAR((planner::base::sample(said.path, t).position - stream.reference(10.0 + t).position).norm(), 0.0, 0.02)
        << t;
  }
}

// Its path is one of its estimate, and others' places are known as well as its own.
TEST(Team, TellsHowFarItsPositionIsOff) {
  Hearing h;
  vehicle::VehicleState state = own();
  state.position_sigma = 0.6;
  const setpoints::SetpointStream stream =
      stream_on({{10.0, {1, 2, 3}, Vec3::Zero(), Vec3::Zero()}, {13.0, {7, 2, 3}, Vec3::Zero(), Vec3::Zero()}});
  h.team.listen(10.0, state);
  h.team.tell(10.0, state, &stream, 1);
  EXPECT_NEAR(h.transport.sent.back().margin, 1.2, 1e-9);
}

TEST(Team, TellsAStopAStayAndWhereItDriftsWhenItFollowsNothing) {
  Hearing h;
  setpoints::SetpointStream stream =
      stream_on({{10.0, {1, 2, 3}, {2, 0, 0}, Vec3::Zero()}, {20.0, {21, 2, 3}, {2, 0, 0}, Vec3::Zero()}});
  stream.brake(stream.straight_stop(stream.reference(10.0)));
  h.team.tell(10.0, own(), &stream, 1);
  EXPECT_NEAR(h.transport.sent.back().path.back().position.x(), 2.0, 0.05);  // v² / 2a
  stream.hold({1, 2, 3.2}, 10.0);
  h.team.tell(10.0, own(), &stream, 2);
  ASSERT_EQ(h.transport.sent.back().path.size(), 1U);
  EXPECT_EQ(h.transport.sent.back().path[0].position, Vec3(1, 2, 3.2));
  stream.hold({1, 2, 5}, 10.0);  // take-off: the whole way up
  h.team.tell(10.0, own(), &stream, 3);
  ASSERT_EQ(h.transport.sent.back().path.size(), 2U);
  EXPECT_EQ(h.transport.sent.back().path[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(h.transport.sent.back().path[1].position, Vec3(1, 2, 5));
  vehicle::VehicleState landing = own();
  landing.motion.value.velocity = {0, 0, -0.7};
  h.team.tell(10.0, landing, nullptr, 4);
  EXPECT_NEAR(h.transport.sent.back().path.back().position.z(), 2.3, 1e-9);
  landing.in_air = false;
  h.team.tell(10.0, landing, nullptr, 5);
  EXPECT_EQ(h.transport.sent.back().path.size(), 1U);
}

TEST(Team, SaysNothingBeforeItKnowsItsPlaceAndReportsWhatCannotBeSent) {
  Hearing h;
  h.team.tell(10.0, vehicle::VehicleState{}, nullptr, 1);
  EXPECT_TRUE(h.transport.sent.empty());
  h.transport.works = false;
  h.team.tell(10.0, own(), nullptr, 2);
  EXPECT_TRUE(h.take_notices(10.0, "team_untold"));
  h.transport.told = {3, "a payload that is no jink_msgs/Intent"};
  EXPECT_TRUE(h.take_notices(11.0, "team_refused"));
}

/// A companion in the air, engaged, with a team.
struct TeamCompanion {
  config::Mission mission;
  testing::FakeLink link;
  testing::FakeTracks tracks;
  testing::FakePlanner planner;
  testing::Recorder recorder;
  FakeIntents intents;
  double sigma = 0.0;
  std::optional<companion::Companion> companion;

  explicit TeamCompanion(bool on, config::SensedFrom sensed_from = config::SensedFrom::kWorld) {
    mission.tracks.sensed_from = sensed_from;
    mission.waypoints = {{20, 0, 5}};
    mission.tracks.required = false;
    mission.intents = on;
    companion.emplace(mission, config::Settings{},
                      companion::CompanionParts{link, tracks, planner, {&recorder}, nullptr, &intents});
  }
  void run(double from, double to) {
    for (double t = from; t < to; t += 0.02) {
      vehicle::VehicleState& state = link.telemetry;
      state = own(t);
      state.position_sigma = sigma;
      state.motion.value.position = {0, 0, 5};
      state.heartbeat_stamp = t;
      state.armed = state.armable = state.local_position_ok = true;
      state.home_height = 0.0;
      state.failsafe_parameters.offboard_loss = 0.0;
      state.mode = t > from + 0.1 ? vehicle::FlightMode::kOffboard : vehicle::FlightMode::kHold;
      companion->step(t);
    }
  }
};

// With onboard perception too: what the others tell is placed by satellites.
TEST(CompanionOfATeam, KeepsWhatItsOwnPositionIsOffByFromTheOthers) {
  TeamCompanion c(true, config::SensedFrom::kVehicle);
  c.sigma = 0.7;
  c.intents.inbox.push_back(message(10.0, 0.0, intent()));
  c.run(10.0, 11.0);
  ASSERT_FALSE(c.planner.jobs.empty());
  ASSERT_EQ(c.planner.jobs.front().paths.size(), 1U);
  EXPECT_GE(c.planner.jobs.front().paths[0].position_sigma, 0.7);
  EXPECT_EQ(c.planner.jobs.front().request.margin, planner::base::HorizonSettings{}.margin);
}

TEST(CompanionOfATeam, PlansAroundTheOthersAndTellsItsPath) {
  TeamCompanion c(true);
  c.intents.inbox.push_back(message(10.0, 0.0, intent()));
  c.run(10.0, 11.0);
  ASSERT_FALSE(c.planner.jobs.empty());
  ASSERT_EQ(c.planner.jobs.front().paths.size(), 1U);
  const planner::geometry::KnownPath& path = c.planner.jobs.front().paths[0];
  EXPECT_NEAR((path.position(0.0) - Vec3(10.0 - 2.0 * (c.planner.jobs.front().start - 10.0), 0, 5)).norm(), 0.0, 1e-9);
  EXPECT_EQ(c.recorder.count("team_vehicle"), 1);
  ASSERT_GT(c.intents.sent.size(), 8U);  // 10 plans a second
  EXPECT_GT(c.intents.sent.back().path.size(), 2U);
}

TEST(CompanionOfATeam, KeepsOutOfItWhereTheMissionSaysSo) {
  TeamCompanion c(false);
  c.intents.inbox.push_back(message(10.0, 0.0, intent()));
  c.run(10.0, 11.0);
  ASSERT_FALSE(c.planner.jobs.empty());
  EXPECT_TRUE(c.planner.jobs.front().paths.empty());
  EXPECT_TRUE(c.intents.sent.empty());
}

TEST(SetpointStreamAhead, IsTheReferenceAsAPath) {
  setpoints::SetpointStream stream = stream_on({{10.0, {0, 0, 5}, Vec3::Zero(), Vec3::Zero()},
                                                {11.0, {2, 0, 5}, Vec3::Zero(), Vec3::Zero()},
                                                {14.0, {8, 3, 5}, Vec3::Zero(), Vec3::Zero()}});
  stream.follow({{11.5, {3, 0.5, 5}, Vec3::Zero(), Vec3::Zero()}, {13.0, {6, 0, 5}, Vec3::Zero(), Vec3::Zero()}});
  for (const double from : {10.0, 10.7, 11.2, 11.5, 12.3, 15.0}) {
    const TimedPath path = stream.ahead(from);
    EXPECT_EQ(path.front().t, from);
    for (std::size_t i = 1; i < path.size(); ++i) ASSERT_GT(path[i].t, path[i - 1].t);
    for (double t = from; t < 16.0; t += 0.03) {
      EXPECT_NEAR((planner::base::sample(path, t).position - stream.reference(t).position).norm(), 0.0, 1e-4)
          << from << " " << t;
    }
  }
}

}  // namespace
}  // namespace jink::bridge::team
