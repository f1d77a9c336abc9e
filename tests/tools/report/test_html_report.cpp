// SPDX-License-Identifier: BSD-3-Clause
// The flight report: what is kept, what is refused, and that nothing in a log gets out of its place in the page.
// With JINK_REPORT_DIR set, TheKindsOfLogs leaves its pages there for check_report.py to look at with a browser.
#include "tools/report/html_report.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/base/solid.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/report/flight_data.hpp"
#include "tools/report/report_data.hpp"
#include "tools/report/shape_corners.hpp"

namespace jink::tools::report {
namespace {

using Json = nlohmann::json;

constexpr char kHeader[] =
    R"({"type":"header","format":"jink-log/1","version":"0.1.0","scenario":"crossing","seed":1,"start":[0,0,1.5],)"
    R"("target":[20,0,1.5],"vehicle":{"radius":0.25},"world":null,"parameters":{"horizon.step":"0.1"},)"
    R"("shapes":[{"id":3,"box":[1,2,3]},{"id":4,"vertices":[[-1,-1,-1],[1,-1,-1],[0,1,-1],[0,0,1]]},)"
    R"({"id":5,"cylinder":{"radius":0.5,"height":4},"orientation":[0,1.5707963267948966,0]},)"
    R"({"id":6,"capsule":{"radius":0.25,"a":[-2,0,0],"b":[2,0,0]},"yaw_rate":1.5707963267948966}]})"
    "\n";
constexpr char kDataBegin[] = "id=\"flight-data\">";

/// The data as the page's script gets them: the text up to the first "</script", parsed.
Json data_of(const std::string& page) {
  const std::size_t begin = page.find(kDataBegin);
  EXPECT_NE(begin, std::string::npos);
  const std::size_t from = begin + std::string(kDataBegin).size();
  return Json::parse(page.substr(from, page.find("</script", from) - from));
}

Json report_of(const std::string& log, const Json* summary = nullptr) {
  const support::Folder folder;
  write_report(folder.log(log), folder.html(), summary);
  return data_of(support::read(folder.html()))["flights"][0];
}

std::string error_of(const std::string& log) {
  const support::Folder folder;
  const std::filesystem::path file = folder.log(log);
  try {
    write_report(file, folder.html());
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(file.string() + ":")) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_FALSE(std::filesystem::exists(folder.html()));
    return text.substr(std::min(text.size(), file.string().size()));
  }
  ADD_FAILURE() << "accepted: " << log;
  return {};
}

std::string record(const Json& json) {
  return json.dump() + "\n";
}
std::string event(double t, const std::string& name, const std::string& detail) {
  return record({{"type", "event"}, {"t", t}, {"name", name}, {"detail", detail}});
}
std::string motion(const std::string& type, double t, const Triple& p, const Triple& v) {
  Json json{{"type", type}, {"t", t}, {"p", p}, {"v", v}};
  if (type == "state") json.update({{"armed", true}, {"mode", "offboard"}});
  return record(json);
}
std::string obstacle(double t, int id, const Triple& p, double radius) {
  return record({{"type", "obstacles"}, {"t", t}, {"id", id}, {"p", p}, {"radius", radius}});
}
std::string tracks(double t, const Triple& p, const Triple& v, double radius) {
  const Json track{{"id", 7}, {"p", p}, {"v", v}, {"a", {0, 0, 0}}, {"radius", radius}, {"age", 0.03}};
  return record({{"type", "tracks"}, {"t", t}, {"tracks", Json::array({track})}});
}
std::string plan(double t, double ms, const std::string& status, bool missed = false) {
  Json path = Json::array();
  for (int i = 0; i <= 60; ++i) path.push_back({t + 0.1 * i, 2.0 * (t + 0.1 * i), 0.3 * std::sin(0.2 * i), 1.5});
  return record({{"type", "plan"},
                 {"t", t},
                 {"path", path},
                 {"ms", ms},
                 {"status", status},
                 {"kept", false},
                 {"missed", missed}});
}

/// A flight of 10 s at 2 m/s eastwards, past an obstacle; as `replay` or, without truth, as `fly` writes it.
std::string flight(bool truth) {
  std::string log = kHeader + event(0.0, "phase", "flying");
  for (int i = 0; i <= 500; ++i) {
    const double t = 0.02 * i;
    const Triple p{2.0 * t, 0.0, 1.5}, there{10.0, 2.0 - 0.2 * t, 1.5};
    if (truth) {
      log += motion("truth", t, p, {2, 0, 0}) + obstacle(t, 1, there, 0.5) + obstacle(t, 2, {5, 4, 1}, 0.5);
      log += obstacle(t, 3, {13, -4, 1.5}, 1.871) + obstacle(t, 4, {16, 4, 1}, 1.732);
    }
    log += motion("state", t, p, {2, 0, 0});
    if (i % 2 == 0) log += tracks(t, there, {0, -0.2, 0}, 0.5);
    if (i % 5 == 0) log += plan(t, 10.0 + i % 7, i > 200 && i < 230 ? "blocked" : "progresses", i == 300);
    log += motion("setpoint", t, {p[0] + 0.4, 0, 1.5}, {2, 0, 0});
  }
  return log + (truth ? event(10.0, "reached", "at the target") : event(10.0, "phase", "done: reached, landed"));
}

/// Two vehicles of a simulator that fly towards each other, 1.5 m apart as they pass at t = 5.
std::string team() {
  std::string log =
      R"({"type":"header","format":"jink-log/1","version":"0.1.0","scenario":"swap","seed":1,"start":[0,0,1.5],)"
      R"("target":[20,0,1.5],"vehicle":{"radius":0.25},"vehicles":[{"radius":0.25,"start":[0,0,1.5],)"
      R"("target":[20,0,1.5]},{"radius":0.35,"start":[20,1.5,1.5],"target":[0,1.5,1.5]}]})"
      "\n";
  for (int i = 0; i <= 500; ++i) {
    const double t = 0.02 * i;
    const Triple a{2.0 * t, 0.0, 1.5}, b{20.0 - 2.0 * t, 1.5, 1.5};
    for (int k = 0; k < 2; ++k)
      log +=
          record({{"type", "truth"}, {"t", t}, {"vehicle", k}, {"p", k == 0 ? a : b}, {"v", {k == 0 ? 2 : -2, 0, 0}}});
  }
  return log;
}

// A wall beside the way, a ball, and something far away; 1 m higher in the log than the map has it.
TEST(FlightReport, ShowsTheKnownMapAndTheGuide) {
  Json header = Json::parse(kHeader);
  const Json box{{"prism", {4, 0.5, 2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  header["map"] =
      Json::array({Json::array({10, 3, 1, 4.5, box}), Json::array({2, -4, 1, 0.5}), Json::array({500, 0, 0, 1.0})});
  std::string log = record(header) + event(0.0, "phase", "flying");
  for (int i = 0; i <= 100; ++i)
    log +=
        motion("truth", 0.1 * i, {0.2 * i, 0, 1.5}, {2, 0, 0}) + motion("state", 0.1 * i, {0.2 * i, 0, 1.5}, {2, 0, 0});
  Json led = Json::parse(plan(1.0, 5.0, "progresses"));
  led["from"] = {{"start", 1.0}, {"way", {{4, 1, 1.5}, {9, 0, 1.5}}}, {"map", {{"up", 1.0}}}};
  const Json data = report_of(log + record(led));
  ASSERT_EQ(data["map"].size(), 2U);
  EXPECT_FALSE(data["header"].contains("map"));
  EXPECT_EQ(data["map"][0]["p"], (Json{10.0, 3.0, 2.0}));
  EXPECT_EQ(data["map"][0]["shape"]["vertices"].size(), 24U);
  EXPECT_EQ(data["map"][0]["shape"]["faces"].size(), 36U);
  EXPECT_EQ(data["map"][1]["shape"], Json());
  EXPECT_EQ(data["plans"][0]["way"], (Json{4.0, 1.0, 1.5, 9.0, 0.0, 1.5}));
  // Past the wall, whose face is at y = 2.5, at a distance of 2.5 − 0.25.
  EXPECT_EQ(data["clearance"]["from"], "true");
  EXPECT_NEAR(data["clearance"]["min"]["d"].get<double>(), 2.25, 1e-3);
  header["map"][0][4]["prism"].erase(16);
  EXPECT_NE(error_of(record(header)).find("prism"), std::string::npos);
}

// A box of cells comes, stays while another comes beside it, and goes.
TEST(FlightReport, ShowsWhatHadBeenSeenAndWhen) {
  const auto seen = [](double t, int number, const Json& added, const Json& removed) {
    return record({{"type", "seen"},
                   {"t", t},
                   {"number", number},
                   {"origin", {0, 0, 1}},
                   {"added", added},
                   {"removed", removed}});
  };
  const Json first = Json::array({10, 5, 0, 12, 6, 5}), second = Json::array({20, 5, 0, 21, 6, 1});
  std::string log = kHeader + seen(1.0, 1, Json::array({first}), Json::array());
  for (int i = 0; i <= 10; ++i) log += motion("state", i, {2.0 * i, 0, 1.5}, {2, 0, 0});
  log += tracks(2.0, {4, 9, 1.5}, {0, 0, 0}, 0.5) + seen(3.0, 2, Json::array({second}), Json::array());
  log += seen(4.0, 3, Json::array(), Json::array({second})) + seen(6.0, 4, Json::array(), Json::array({first}));
  log += seen(6.1, 5, Json::array({second}), Json::array()) + seen(6.2, 6, Json::array(), Json::array({second}));
  const Json data = report_of(log);
  ASSERT_EQ(data["seen"].size(), 2U);
  EXPECT_EQ(data["seen"][0]["p"], (Json{2.2, 1.1, 1.5}));
  EXPECT_EQ(data["seen"][0]["box"], (Json{0.4, 0.2, 1.0}));
  EXPECT_EQ(data["seen"][0]["from"], 1.0);
  EXPECT_EQ(data["seen"][0]["until"], 6.0);
  EXPECT_EQ(data["seen"][1]["from"], 3.0);
  EXPECT_EQ(data["seen"][1]["until"], 4.0);
  // Nearer than the track: from (4, 0, 1.5) to the box's corner at (2.4, 1.0).
  EXPECT_EQ(data["clearance"]["from"], "tracks");
  EXPECT_NEAR(data["clearance"]["min"]["d"].get<double>(), std::hypot(1.6, 1.0) - 0.25, 1e-3);
  EXPECT_NE(error_of(kHeader + seen(1.0, 1, Json::array(), Json::array({first}))).find("removed"), std::string::npos);
}

TEST(SolidCorners, ReachAsFarAsTheSolid) {
  using planner::base::Solid;
  Solid::Pose pose{{0.3, -0.2, 0.5}, {}};
  pose.axes = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const auto& solid :
       {Solid::box({1, 2, 3}, pose), Solid::cylinder(0.5, 4.0, pose), Solid::capsule(0.3, {0, 0, 0}, {1, 2, 0}),
        Solid::prism({1, 0.5, 0.2}, 0.3, 0.1, pose), Solid::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})}) {
    const std::vector<Vec3> corners = solid_corners(*solid);
    for (int i = 0; i < 40; ++i) {
      const Vec3 direction = Vec3(std::sin(1.0 + i), std::cos(3.0 * i), std::sin(7.0 * i)).normalized();
      double most = -planner::base::kInfinity;
      for (const Vec3& corner : corners) most = std::max(most, direction.dot(corner));
      EXPECT_LE(most, solid->extent(direction) + 1e-9);
      EXPECT_GE(most, solid->extent(direction) - 0.01);
    }
  }
}

TEST(Thin, KeepsFirstLastAndWhatIsFarEnoughApart) {
  const std::vector<double> t{0.0, 0.02, 0.04, 0.06, 0.08, 0.10, 0.12};
  EXPECT_EQ(thin(t, 0.05), (std::vector<std::size_t>{0, 3, 6}));
  EXPECT_EQ(thin(t, 0.04), (std::vector<std::size_t>{0, 2, 4, 6}));
  EXPECT_EQ(thin(t, 1.0), (std::vector<std::size_t>{0, 6}));
  EXPECT_EQ(thin(std::vector<double>{3.0}, 0.05), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(thin(std::vector<double>{}, 0.05).empty());
}

TEST(FlightReport, ThinsPositionsButKeepsBothEndsAndEveryPlan) {
  const Json data = report_of(flight(true));
  const Json& t = data["vehicle"]["t"];
  EXPECT_EQ(t.front(), 0.0);
  EXPECT_EQ(t.back(), 10.0);
  EXPECT_LE(t.size(), 202U);  // 20 Hz
  EXPECT_GE(t.size(), 150U);
  EXPECT_EQ(data["vehicle"]["p"].size(), 3 * t.size());
  EXPECT_EQ(data["vehicle"]["p"].back(), 1.5);
  EXPECT_EQ(data["plans"].size(), 101U);
  const Json& path = data["plans"][0]["path"];
  EXPECT_LE(path.size() / 4, 42U);
  EXPECT_EQ(path[path.size() - 4], 6.0);  // the path's own end
}

TEST(FlightReport, TakesTheClearanceFromTheTruthWhereThereIsOne) {
  // At t = 5 the vehicle is at (10, 0), the obstacle at (10, 1): 1 - 0.5 - 0.25 of free air; a little later there is
  // less.
  double least = 1e9;
  for (int i = 0; i <= 500; ++i) {
    const double t = 0.02 * i;
    least = std::min(least, std::hypot(2.0 * t - 10.0, 2.0 - 0.2 * t) - 0.75);
  }
  const Json data = report_of(flight(true));
  EXPECT_EQ(data["clearance"]["from"], "true");
  EXPECT_NEAR(data["clearance"]["min"]["d"].get<double>(), least, 5.1e-4);
  EXPECT_EQ(data["obstacles"]["frames"][0].size(), 4U * 5U);
}

TEST(FlightReport, ClearanceMinimumSurvivesThinning) {
  std::string log = kHeader;
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.02 * i;
    log += motion("truth", t, {0, 0, 0}, {0, 0, 0}) + obstacle(t, 1, {i == 51 ? 1.0 : 5.0, 0, 0}, 0.5);
  }
  const Json clearance = report_of(log)["clearance"];
  EXPECT_EQ(clearance["min"]["d"], 0.25);
  EXPECT_EQ(clearance["min"]["t"], 1.02);
  EXPECT_NE(std::find(clearance["d"].begin(), clearance["d"].end(), Json(0.25)), clearance["d"].end());
}

TEST(FlightReport, MeasuresToTheTrueShapeAndShowsIt) {
  // Beside the box's face at x = 0.5, where its sphere of radius 1.871 would be long reached.
  std::string log = kHeader + motion("truth", 0.0, {1.5, 0, 0}, {0, 0, 0}) + obstacle(0.0, 3, {0, 0, 0}, 1.871);
  EXPECT_EQ(report_of(log)["clearance"]["min"]["d"], 1.0 - 0.25);
  // Below the hull's base at z = -1.
  log = kHeader + motion("truth", 0.0, {0, 0, -3}, {0, 0, 0}) + obstacle(0.0, 4, {0, 0, 0}, 1.732);
  const Json data = report_of(log);
  EXPECT_EQ(data["clearance"]["min"]["d"], 2.0 - 0.25);
  EXPECT_EQ(data["shapes"]["3"], (Json{{"box", {1.0, 2.0, 3.0}}}));
  EXPECT_EQ(data["shapes"]["4"]["vertices"].size(), 12U);
  EXPECT_EQ(data["shapes"]["4"]["faces"].size(), 12U);  // a tetrahedron's four
  EXPECT_FALSE(data["header"].contains("shapes"));      // they are told once
}

TEST(FlightReport, MeasuresToShapesThatAreTurnedAndTurn) {
  // A cylinder that lies along east.
  std::string log = kHeader + motion("truth", 0.0, {0, 2, 0}, {0, 0, 0}) + obstacle(0.0, 5, {0, 0, 0}, 2.06);
  EXPECT_NEAR(report_of(log)["clearance"]["min"]["d"], 1.5 - 0.25, 1e-3);
  // A capsule that has turned north after a second.
  log = kHeader + motion("truth", 1.0, {3, 0, 0}, {0, 0, 0}) + obstacle(1.0, 6, {0, 0, 0}, 2.25);
  const Json data = report_of(log);
  EXPECT_NEAR(data["clearance"]["min"]["d"], 2.75 - 0.25, 1e-3);
  EXPECT_FALSE(data["shapes"]["5"].contains("yaw_rate"));
  EXPECT_GT(data["shapes"]["5"]["faces"].size(), 3U * 60U);
  EXPECT_NEAR(data["shapes"]["6"]["yaw_rate"], 1.570796, 1e-6);
}

TEST(FlightReport, MeasuresTheVehiclesOfATeamAgainstEachOther) {
  const Json data = report_of(team());
  ASSERT_EQ(data["others"].size(), 1U);
  const Json& other = data["others"][0];
  EXPECT_EQ(other["number"], 1);
  EXPECT_EQ(other["radius"], 0.35);
  for (const Json& clearance : {data["clearance"], other["clearance"]}) {
    EXPECT_EQ(clearance["min"]["t"], 5.0);
    EXPECT_EQ(clearance["min"]["d"], 1.5 - 0.25 - 0.35);
  }
}

TEST(FlightReport, TellsWhatAPlanKnewOfTheOthers) {
  Json json = Json::parse(plan(2.0, 5.0, "progresses"));
  json["from"] = {{"start", 2.5}, {"acceleration_trust", 0.8}};
  json["from"]["paths"] = {
      {{"id", 9}, {"offset", 100.0}, {"radius", 0.4}, {"points", {{100, 1, 2, 3}, {101, 2, 2, 3}}}}};
  const Json known = report_of(kHeader + record(json))["plans"][0];
  EXPECT_EQ(known["trust"], 0.8);
  EXPECT_EQ(known["known"][0]["path"], (Json{2.5, 1.0, 2.0, 3.0, 3.5, 2.0, 2.0, 3.0}));
  EXPECT_FALSE(report_of(kHeader + plan(2.0, 5.0, "reaches"))["plans"][0].contains("trust"));  // an older log
}

TEST(FlightReport, PutsSeveralFlightsIntoOnePage) {
  const support::Folder folder;
  const std::filesystem::path first = folder.path() / "first.jsonl";
  std::filesystem::copy_file(folder.log(flight(true)), first);
  const Json summary{{"outcome", "reached"}};
  const std::vector<ReportSource> sources{{first, std::nullopt}, {folder.log(flight(false)), summary}};
  const auto results = write_report(sources, folder.html());
  ASSERT_EQ(results.size(), 2U);
  EXPECT_GT(results[0].lines, results[1].lines);
  const Json flights = data_of(support::read(folder.html()))["flights"];
  ASSERT_EQ(flights.size(), 2U);
  EXPECT_EQ(flights[0]["file"], "first.jsonl");
  EXPECT_EQ(flights[0]["vehicle"]["from"], "truth");
  EXPECT_EQ(flights[1]["vehicle"]["from"], "state");
  EXPECT_EQ(flights[1]["summary"], summary);
}

TEST(FlightReport, MovesTracksToTheTimeOfTheEstimate) {
  // The track is 0.1 s younger than the estimate: at the estimate's time it was 0.2 m further away.
  const Json data =
      report_of(kHeader + motion("state", 1.0, {0, 0, 0}, {0, 0, 0}) + tracks(1.1, {3, 0, 0}, {-2, 0, 0}, 0.5));
  EXPECT_EQ(data["clearance"]["from"], "tracks");
  EXPECT_EQ(data["clearance"]["min"]["d"], 3.2 - 0.5 - 0.25);
}

TEST(FlightReport, ShowsALogOfFlyAlone) {
  const Json data = report_of(flight(false));
  EXPECT_EQ(data["vehicle"]["from"], "state");
  EXPECT_TRUE(data["obstacles"].is_null());
  EXPECT_EQ(data["clearance"]["from"], "tracks");
  EXPECT_EQ(data["derived"]["outcome"], "reached");
  EXPECT_EQ(data["derived"]["reason"], "landed");
  EXPECT_TRUE(data["summary"].is_null());
}

TEST(FlightReport, DerivesWhatTheLogHoldsAndNoMore) {
  const Json derived = report_of(flight(true))["derived"];
  EXPECT_NEAR(derived["path_length"].get<double>(), 20.0, 1e-9);
  EXPECT_EQ(derived["max_speed"], 2.0);
  EXPECT_EQ(derived["plans"], 101);
  EXPECT_EQ(derived["deadline_misses"], 1);
  EXPECT_EQ(derived["plan_ms"], (Json{{"p50", 13.0}, {"p99", 16.0}, {"max", 16.0}}));
  const Json nothing = report_of(kHeader)["derived"];
  EXPECT_EQ(nothing.dump(), R"({"log_duration_s":0.0})");
}

TEST(FlightReport, CarriesTheSummaryAsGiven) {
  const Json summary{{"format", "jink-flight/1"}, {"outcome", "collision"}, {"min_clearance", nullptr}};
  EXPECT_EQ(report_of(flight(false), &summary)["summary"], summary);
}

TEST(FlightReport, AddsAnEventForEachChangeOfMode) {
  const Json events = report_of(flight(false))["events"];
  EXPECT_EQ(events[1], (Json{0.0, "mode", "offboard, armed", ""}));
  EXPECT_EQ(events.size(), 3U);
}

TEST(FlightReport, HoldsTextInItsPlace) {
  const std::string evil = "</script><script>alert(1)</script><!-- & ]]> \" \\ \xE2\x80\xA8 https://example.org";
  const support::Folder folder;
  const Json summary{{"outcome", "aborted"}, {"reason", evil}};
  write_report(folder.log(kHeader + event(1.0, evil, evil)), folder.html(), &summary);
  const std::string page = support::read(folder.html());
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  const Json data = data_of(page)["flights"][0];  // and yet it reads back as it was
  EXPECT_EQ(data["events"][0], (Json{1.0, evil, evil, ""}));
  EXPECT_EQ(data["summary"]["reason"], evil);
}

TEST(FlightReport, IsSelfContained) {
  const support::Folder folder;
  write_report(folder.log(flight(true) + event(10.0, "note", "see http://example.org")), folder.html());
  const std::string page = support::read(folder.html());
  for (const char* outside : {"http://", "https://", " src=", "@import", "url(", "fetch("}) {
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  }
  EXPECT_EQ(page.find("{{"), std::string::npos) << "a part is missing";
}

TEST(FlightReport, LeavesNothingButThePage) {
  const support::Folder folder;
  write_report(folder.log(flight(true)), folder.html());
  write_report(folder.log(flight(false)), folder.html());  // over an existing one
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 2U);
}

TEST(FlightReport, SkipsAndCountsALastLineThatIsCutOff) {
  const support::Folder folder;
  const ReportResult result =
      write_report(folder.log(flight(false) + R"({"type":"state","t":10.02,"p":[1.0,2)"), folder.html());
  EXPECT_EQ(result.skipped, 1U);
  const Json data = data_of(support::read(folder.html()))["flights"][0];
  EXPECT_EQ(data["log"]["cut_off"], 1);
  EXPECT_EQ(data["log"]["lines"], result.lines);
  EXPECT_EQ(data["t"][1], 10.0);
}

TEST(FlightReport, SkipsAndCountsRecordsThatAreNotFiniteOrUnknown) {
  const support::Folder folder;
  const std::string odd = R"({"type":"state","t":1,"p":[null,0,0],"v":[0,0,0],"armed":true,"mode":"hold"})"
                          "\n"
                          R"({"type":"weather","t":1})"
                          "\n";
  const ReportResult result = write_report(folder.log(kHeader + odd + event(2.0, "a", "b")), folder.html());
  EXPECT_EQ(result.lines, 4U);
  EXPECT_EQ(result.skipped, 2U);
}

std::string with_shapes(const std::string& shapes) {
  return R"({"type":"header","format":"jink-log/1","shapes":)" + shapes + "}\n";
}

TEST(FlightReport, RefusesBadLogsWithTheirLine) {
  const std::string header = kHeader;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", ":1: the first line is not a jink-log/1 header: the file is empty"},
      {"hello\n", ":1: the first line is not a jink-log/1 header"},
      {"[1]\n", ":1: the first line is not a jink-log/1 header"},
      {event(0.0, "a", "b"), ":1: the first line is not a jink-log/1 header"},
      {"{\"type\":\"header\",\"format\":\"jink-log/2\"}\n", ":1: format: \"jink-log/2\" is not \"jink-log/1\""},
      {"{\"type\":\"header\"}\n", ":1: format: null is not \"jink-log/1\""},
      {with_shapes("7"), ":1: header \"shapes\" is not a list"},
      {with_shapes("[7]"), ":1: header \"shapes\" holds what is no object"},
      {with_shapes("[{\"box\":[1,1,1]}]"), ":1: header has no \"id\""},
      {with_shapes("[{\"id\":1,\"box\":[1,1]}]"), ":1: header \"box\" is not a list of 3 numbers"},
      {with_shapes("[{\"id\":1,\"box\":[1,1,-1]}]"), ":1: header \"box\" is out of range"},
      {with_shapes("[{\"id\":1,\"box\":[1,1,null]}]"), ":1: header \"shapes\" holds a number that is not finite"},
      {with_shapes("[{\"id\":1}]"), ":1: header has no \"vertices\""},
      {with_shapes("[{\"id\":1,\"vertices\":[]}]"), ":1: header \"vertices\" is not a list of 1 to 10000 points"},
      {header + "{\"type\":\n" + event(1.0, "a", "b"), ":2: is not JSON"},
      {header + "\n7\n", ":3: is not a JSON object"},
      {header + "{\"t\":1}\n", ":2: has no \"type\""},
      {header + "{\"type\":\"event\",\"name\":\"a\",\"detail\":\"\"}\n", ":2: event has no \"t\""},
      {header + "{\"type\":\"event\",\"t\":1,\"name\":3,\"detail\":\"\"}\n", ":2: event \"name\" is not text"},
      {header + "{\"type\":\"truth\",\"t\":1,\"p\":[1,2],\"v\":[0,0,0]}\n",
       ":2: truth \"p\" is not a list of 3 numbers"},
      {header + "{\"type\":\"truth\",\"t\":1,\"p\":[1,2,\"x\"],\"v\":[0,0,0]}\n", ":2: truth \"p\" is not a number"},
      {header + "{\"type\":\"tracks\",\"t\":1,\"tracks\":3}\n", ":2: tracks \"tracks\" is not a list"},
      {header + "{\"type\":\"plan\",\"t\":1,\"ms\":1,\"status\":\"reaches\",\"path\":[[1,2,3]]}\n",
       ":2: plan \"path\" is not a list of 4 numbers"},
  };
  for (const auto& [log, message] : cases) EXPECT_EQ(error_of(log), message);
}

TEST(FlightReport, NamesAFileThatCannotBeReadOrWritten) {
  const support::Folder folder;
  EXPECT_THROW(write_report(folder.path() / "none.jsonl", folder.html()), std::runtime_error);
  try {
    write_report(folder.log(kHeader), folder.path() / "none" / "flight.html");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("none/flight.html: cannot write"), std::string::npos) << error.what();
  }
}

TEST(FlightReport, StaysSmallForAMinuteAmongTwentyObstacles) {
  std::string log = kHeader;
  for (int i = 0; i <= 3000; ++i) {
    const double t = 0.02 * i;
    log += motion("truth", t, {0.123456 * t, 1.2345 * std::sin(t), 1.5}, {1, 0, 0});
    for (int k = 0; k < 20; ++k) log += obstacle(t, k, {0.98765 * k, 3.456789 * std::sin(t + k), 1.54321}, 0.5);
    if (i % 5 == 0) log += plan(t, 12.345, "progresses");
  }
  const support::Folder folder;
  write_report(folder.log(log), folder.html());
  EXPECT_LT(std::filesystem::file_size(folder.html()), 5U << 20U);
}

TEST(FlightReport, TheKindsOfLogs) {
  const char* keep = std::getenv("JINK_REPORT_DIR");
  const support::Folder folder;
  const std::filesystem::path out = keep != nullptr ? std::filesystem::path(keep) : folder.path();
  EXPECT_EQ(write_report(folder.log(flight(true)), out / "replay.html").skipped, 0U);
  EXPECT_EQ(write_report(folder.log(team()), out / "team.html").skipped, 0U);
  EXPECT_EQ(write_report(folder.log(kHeader), out / "empty.html").lines, 1U);
  const std::filesystem::path other = folder.path() / "other.jsonl";
  std::filesystem::copy_file(folder.log(flight(true)), other);
  EXPECT_EQ(write_report(folder.log(flight(false)), out / "fly.html").skipped, 0U);
  const std::vector<ReportSource> both{{other, std::nullopt}, {folder.path() / "flight.jsonl", std::nullopt}};
  EXPECT_EQ(write_report(both, out / "compare.html").size(), 2U);
}

}  // namespace
}  // namespace jink::tools::report
