// SPDX-License-Identifier: BSD-3-Clause
// What the progress line says of a flight, and when.
#include "tools/cli/progress_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace jink::tools::cli {
namespace {

TEST(LiveText, TellsWhatIsKnownAndNoMore) {
  ProgressStatus status;
  status.t = 12.34;
  EXPECT_EQ(progress_text(status), "[  12.3 s]");
  status.mode = "offboard";
  status.progress = 0.617;
  status.to_go = 7.66;
  status.nearest = planner::base::kInfinity;
  EXPECT_EQ(progress_text(status), "[  12.3 s] offboard  62 %  7.7 m to go  nothing near");
  status.nearest = 2.06;
  status.plan_ms = 12.4;
  status.speed = 3.0;
  status.height = 1.5;
  EXPECT_TRUE(progress_text(status).ends_with("z 1.5 m"));
  status.estimated = true;
  status.tracks = 1;
  status.stale = {"tracks 1.4 s old", "position 0.6 s old"};
  EXPECT_EQ(progress_text(status),
            "[  12.3 s] offboard  ! tracks 1.4 s old, position 0.6 s old  62 %  7.7 m to go  nearest 2.1 m  plan 12 ms"
            "  3.0 m/s  z 1.5 m estimated  1 track");
}

/// A flight over two waypoints, 10 m to the first and 5 m on from there; what is printed goes to standard output.
class LiveFlightTest : public ::testing::Test {
 protected:
  LiveFlightTest() {
    mission_.waypoints = {{10, 0, 2}, {10, 5, 2}};
    mission_.vehicle.radius = 0.5;
    mission_.tracks.timeout_s = 1.0;
    ::testing::internal::CaptureStdout();
  }
  ~LiveFlightTest() override { (void)printed(); }

  std::string printed() {
    if (!capturing_) return {};
    background_.reset();
    capturing_ = false;
    return ::testing::internal::GetCapturedStdout();
  }

  /// The state at `t`, with telemetry that is `age` old.
  void at(double t, const Vec3& position, double age = 0.0) {
    bridge::vehicle::VehicleState state;
    state.heartbeat_stamp = t - age;
    state.motion.stamp = state.motion.received = t - age;
    state.mode = bridge::vehicle::FlightMode::kOffboard;
    state.motion.value.position = position;
    state.motion.value.velocity = {3, 0, 0};
    live_.on_state(t, state);
  }

  config::Mission mission_;
  const Printer printer_{false};
  std::optional<BackgroundPrinter> background_{printer_};
  FlightProgress live_{mission_, 0.3, *background_};
  bool capturing_ = true;
};

TEST_F(LiveFlightTest, MeasuresTheWayAlongTheWaypoints) {
  at(0.0, {0, 0, 2});
  at(2.0, {0, 0, 2});
  EXPECT_EQ(live_.status().to_go, 15.0);
  EXPECT_FALSE(live_.status().progress) << "it does not fly yet";
  live_.on_event(2.1, "phase", "flying");
  at(4.0, {0, 0, 2});
  EXPECT_EQ(live_.status().progress, 0.0);
  at(6.0, {10, 0, 2});
  EXPECT_NEAR(*live_.status().progress, 10.0 / 15.0, 1e-12);
  live_.on_event(6.1, "waypoint", "1 of 2 passed");
  at(8.0, {10, 3, 2});
  EXPECT_NEAR(*live_.status().to_go, 2.0, 1e-12);
  EXPECT_NEAR(*live_.status().progress, 13.0 / 15.0, 1e-12);
  live_.on_event(8.1, "phase", "landing");
  at(12.0, {10, 3, 0});
  EXPECT_FALSE(live_.status().progress) << "a landing is no way to the target";
  EXPECT_FALSE(live_.status().to_go);
}

TEST_F(LiveFlightTest, NamesEveryInputThatIsMissingOrOld) {
  using List = std::vector<std::string>;
  live_.on_state(0.0, bridge::vehicle::VehicleState());
  live_.on_state(2.0, bridge::vehicle::VehicleState());
  EXPECT_EQ(live_.status().stale, (List{"no autopilot yet", "no tracks yet"}));
  live_.on_tracks(3.9, {});
  at(4.0, {0, 0, 2});
  EXPECT_EQ(live_.status().stale, List{});
  EXPECT_EQ(live_.status().nearest, planner::base::kInfinity);
  at(6.0, {0, 0, 2}, 0.4);
  EXPECT_EQ(live_.status().stale, (List{"position 0.4 s old", "tracks 2.1 s old"}));
  at(8.0, {0, 0, 2}, 3.0);
  EXPECT_EQ(live_.status().stale.front(), "heartbeat 3.0 s old");
}

TEST_F(LiveFlightTest, MeasuresTheFreeAirToTheNearestTrack) {
  at(0.0, {1, 0, 2});
  planner::base::Track near, far;
  near.position = {4, 0, 2};
  near.radius = 1.0;
  far.position = {40, 0, 2};
  live_.on_tracks(0.1, {far, near});
  EXPECT_EQ(live_.status().nearest, 3.0 - 1.0 - 0.5);
  EXPECT_EQ(live_.status().tracks, 2U);
}

TEST_F(LiveFlightTest, PrintsALineEveryTwoSecondsWhereThereIsNoTerminal) {
  for (int i = 0; i <= 500; ++i) at(0.02 * i + 1.0, {0.02 * i, 0, 2});
  const std::string text = printed();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5) << text;
  EXPECT_TRUE(text.starts_with("[   3.0 s] offboard  ! no tracks yet  13.0 m to go  3.0 m/s")) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

}  // namespace
}  // namespace jink::tools::cli
