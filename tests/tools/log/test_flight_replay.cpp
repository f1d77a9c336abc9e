// SPDX-License-Identifier: BSD-3-Clause
// A recorded flight planned again: the same decisions from its log alone, and every way in which a log can be wrong.
#include "tools/log/flight_replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>

#include "config/error.hpp"
#include "config/scenario.hpp"
#include "planner/base/solid.hpp"
#include "sim/flight/closed_loop.hpp"
#include "tests/support/repetitions.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/log/flight_log.hpp"
#include "tools/runs/summaries.hpp"

namespace jink::tools::log {
namespace {

/// Header and first record.
std::array<std::string, 2> first_lines(const std::filesystem::path& file) {
  std::istringstream in(support::read(file));
  std::array<std::string, 2> lines;
  for (std::string& line : lines) std::getline(in, line);
  return lines;
}

std::filesystem::path fly(const support::Folder& folder, const config::Scenario& scenario, int threads) {
  const auto file = folder.path() / (scenario.name + std::to_string(threads) + ".jsonl");
  const config::Settings settings;
  FlightLog log(file, runs::scenario_header(scenario, 5, settings), {.wait = true});
  sim::flight::ClosedLoopOptions options;
  options.seed = 5;
  options.threads = threads;
  options.flight_observers = {&log};
  options.truth_observers = {&log};
  (void)sim::flight::fly_closed_loop(scenario, settings, options);
  log.close();
  return file;
}

FlightComparison compare(const std::filesystem::path& log, int threads = 2,
                         const std::vector<std::string>& overrides = {}) {
  FlightRecording recording(log);
  std::vector<std::string> missing;
  ReplaySettings settings;
  settings.recorded = config::recorded_settings(recording.source(), recording.parameters(), {}, missing);
  settings.settings = config::recorded_settings(recording.source(), recording.parameters(), overrides, missing);
  settings.seed = recording.seed();
  settings.threads = threads;
  EXPECT_TRUE(missing.empty());
  return compare_plans(recording, settings);
}

std::filesystem::path fly(const support::Folder& folder, const std::string& scenario_name, int threads) {
  return fly(folder, config::load_scenario(config::config_folder() / "scenarios" / (scenario_name + ".yaml")), threads);
}

TEST(FlightReplay, ARecordedFlightDecidesTheSameAtAnyNumberOfThreads) {
  const support::Folder folder;
  for (const int flown : {1, 4}) {
    const auto log = fly(folder, "table2-1", flown);
    for (const int threads : {1, 4}) {
      const FlightComparison comparison = compare(log, threads);
      EXPECT_GT(comparison.plans, 20U);
      EXPECT_TRUE(comparison.differences.empty()) << flown << " threads, again with " << threads;
    }
  }
}

// The map is in the log once, and each plan tells what it saw of it.
TEST(FlightReplay, AFlightByAMapDecidesTheSame) {
  const support::Folder folder;
  auto scenario = config::load_scenario(config::config_folder() / "scenarios" / "crossing.yaml");
  scenario.map = {{config::BoxShape{{1, 5, 3}}, config::LinearMotion{{10, 1, 1.5}}, {0.4, 0, 0}},
                  {config::SphereShape{0.7}, config::LinearMotion{{14, -1, 2}}},
                  {config::VertexShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 4}}}, config::LinearMotion{{6, -2, 0}}},
                  {config::BoxShape{{1, 5, 3}}, config::LinearMotion{{500, 1, 1.5}}}};
  const auto log = fly(folder, scenario, 2);
  const FlightComparison comparison = compare(log);
  EXPECT_GT(comparison.plans, 20U);
  EXPECT_TRUE(comparison.differences.empty());
  FlightRecording recording(log);
  const auto plan = recording.next();
  ASSERT_TRUE(plan.has_value());
  EXPECT_EQ(plan->job.map.map->tracks().size(), 4U);
  std::vector<planner::base::Track> seen;
  plan->job.map.append_to(seen);
  EXPECT_EQ(seen.size(), 3U);
  // Without it, it is another world.
  const std::string text = support::read(log);
  const std::size_t begin = text.find("\"map\":[[");
  const std::size_t end = text.find("\"parameters\"");
  ASSERT_LT(begin, end);
  const auto without = folder.write("without.jsonl", text.substr(0, begin) + text.substr(end));
  EXPECT_FALSE(compare(without).differences.empty());
}

// What was seen is in the log by what changed of it.
TEST(FlightReplay, AFlightThatSeesForItselfDecidesTheSame) {
  const support::Folder folder;
  auto scenario = config::load_scenario(config::config_folder() / "scenarios" / "crossing.yaml");
  scenario.sensing.scan = config::depth_camera();
  scenario.map = {{config::BoxShape{{1, 5, 3}}, config::LinearMotion{{10, 1, 1.5}}, {0.4, 0, 0}}};
  scenario.time_limit = 8.0;
  const auto log = fly(folder, scenario, 2);
  for (const int threads : {1, 2}) {
    const FlightComparison comparison = compare(log, threads);
    EXPECT_GT(comparison.plans, 20U);
    EXPECT_TRUE(comparison.differences.empty());
  }
  FlightRecording recording(log);
  std::size_t most = 0;
  while (const auto plan = recording.next())
    if (plan->job.map.seen != nullptr) most = std::max(most, plan->job.map.map->tracks().size());
  EXPECT_GT(most, 1U);
  EXPECT_EQ(recording.unknown(), 0U);
  // Each number is that of the record before.
  std::string text = support::read(log);
  const std::size_t record = text.find("{\"type\":\"seen\"", text.find("{\"type\":\"seen\"") + 1);
  ASSERT_NE(record, std::string::npos);
  text.erase(record, text.find('\n', record) + 1 - record);
  EXPECT_THROW((void)compare(folder.write("without.jsonl", text)), std::runtime_error);
}

TEST(FlightReplay, OtherParametersDecideOtherwise) {
  const support::Folder folder;
  const auto log = fly(folder, "crossing", 2);
  EXPECT_TRUE(compare(log).differences.empty());
  // By way of the planner, of the request, and of how far the searches go.
  for (const char* change :
       support::repetitions({"horizon.weight_clearance=5", "horizon.margin=1.2", "horizon.generations=5"})) {
    const FlightComparison comparison = compare(log, 2, {change});
    ASSERT_FALSE(comparison.differences.empty()) << change;
    const auto apart = [](const PlanDifference& d) { return d.max_distance.value_or(0.0) > 0.0; };
    EXPECT_TRUE(std::all_of(comparison.differences.begin(), comparison.differences.end(), apart)) << change;
  }
}

/// A job among `tracks`, with everything in it that a companion could set.
bridge::companion::PlanJob job(std::uint64_t number, std::vector<planner::base::Track> tracks) {
  bridge::companion::PlanJob job;
  job.number = number;
  job.begun = 1.0 / 3.0;
  job.start = 0.7;
  job.tracks = std::move(tracks);
  job.request.position = {0.1, 0.2, 2.3};
  job.request.velocity = {2.0, -0.0, 0.0};
  job.request.target = {20.0, 0.0, 2.0};
  job.request.margin = 0.41;
  job.request.track_acceleration = 0.3;
  job.request.sudden_change = 1.1;
  job.request.time_price = 7.3;  // above the cruise speed, so that it counts
  job.request.volume_clearance = 0.4;
  job.request.acceleration_trust = 0.6;
  return job;
}

planner::base::Track sphere(std::uint64_t id, const Vec3& position, const Vec3& velocity, double radius) {
  return {id, position, velocity, {0.01, -0.02, 0.0}, radius, 0.05, 0.1, 0.03};
}

/// Plans as a companion's thread does, under a deadline of so many µs, and logs it.
class RealTimePlans {
 public:
  explicit RealTimePlans(const std::filesystem::path& file)
      : log_(file, {{"mission", "m"}, {"seed", 9}, {"parameters", parameters_of(settings_)}}),
        planner_(settings_.horizon, settings_.optimizer) {}

  planner::verify::Plan make(bridge::companion::PlanJob job, std::chrono::microseconds time) {
    bridge::companion::PlanResult result;
    result.job = std::move(job);
    const bridge::prediction::Obstacles obstacles = bridge::companion::obstacles_of(result.job, settings_.horizon);
    bridge::companion::set_obstacles(result.job, obstacles);
    const planner::base::Budget budget{settings_.horizon.generations, std::chrono::steady_clock::now() + time};
    result.plan = planner_.plan(result.job.request, result.job.previous, 9, result.job.number, budget, pool_);
    log_.on_plan(result.job.start, result);
    return result.plan;
  }
  void close() { log_.close(); }

 private:
  config::Settings settings_;
  FlightLog log_;
  planner::horizon::HorizonPlanner planner_;
  planner::base::WorkerPool pool_{2};
};

// Deadlines from none to plenty, an obstacle that nothing avoids (so that both searches run and are cut), an unbounded
// volume, a previous plan, the largest id, and a request that cannot be planned.
TEST(FlightReplay, PlansUnderADeadlineAreRepeated) {
  const support::Folder folder;
  const auto file = folder.path() / "flight.jsonl";
  RealTimePlans plans(file);
  const auto beside = sphere(18446744073709551615U, {8, 0.2, 2}, {-1, 0.1, 0}, 0.8);
  const auto unavoidable = sphere(2, {16, 0, 2}, {-14, 0, 0}, 6.0);
  bool two_searches = false, cut = false;
  std::uint64_t number = 0;
  planner::base::TimedPath previous;
  for (const int microseconds : {-1, 50, 300, 1000, 5000}) {
    for (const auto& track : {beside, unavoidable}) {
      bridge::companion::PlanJob next = job(number++, {track});
      next.previous = previous;
      const planner::verify::Plan plan = plans.make(std::move(next), std::chrono::microseconds(microseconds));
      previous = plan.path;
      two_searches = two_searches || plan.searches[1].schedule > 0;
      cut = cut || plan.deadline_reached;
    }
  }
  bridge::companion::PlanJob impossible = job(number++, {beside});
  impossible.request.position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(plans.make(std::move(impossible), std::chrono::microseconds(100)).status,
            planner::verify::PlanStatus::kInvalid);
  plans.close();
  ASSERT_TRUE(two_searches && cut);
  for (const int threads : {1, 4}) {
    const FlightComparison comparison = compare(file, threads);
    EXPECT_EQ(comparison.plans, number);
    EXPECT_TRUE(comparison.differences.empty()) << comparison.differences.size() << " of " << number;
  }
}

// Another vehicle's path decides, and all of it is recorded: without it, or with its end a little later, the plan is
// another one.
TEST(FlightReplay, PlansAmongATeamsPathsAreRepeated) {
  const support::Folder folder;
  const auto file = folder.path() / "flight.jsonl";
  RealTimePlans plans(file);
  bridge::companion::PlanJob next = job(0, {});
  planner::geometry::KnownPath path;
  path.id = 18446744073709551615U;
  path.points = {{1.0 / 3.0, {12, 0.1, 2}, Vec3::Zero(), Vec3::Zero()}, {6.1, {2, 0.2, 2}, Vec3::Zero(), Vec3::Zero()}};
  path.offset = 0.7;
  path.radius = 0.8;
  path.margin = 0.1;
  path.position_sigma = 0.05;
  path.velocity_sigma = 0.03;
  path.age = 0.2;
  next.paths = {path};
  const planner::verify::Plan plan = plans.make(std::move(next), std::chrono::seconds(10));
  plans.close();
  ASSERT_TRUE(plan.verification.free());
  EXPECT_EQ(plan.verification.nearest_id, path.id);
  EXPECT_TRUE(compare(file).differences.empty());
  const auto [header, line] = first_lines(file);
  Json changed = Json::parse(line);
  changed["from"]["paths"][0]["points"][1][0] = 7.5;
  EXPECT_EQ(compare(folder.log(header + "\n" + changed.dump() + "\n")).differences.size(), 1U);
  changed["from"]["paths"] = Json::array();
  EXPECT_EQ(compare(folder.log(header + "\n" + changed.dump() + "\n")).differences.size(), 1U);
  changed["from"]["paths"] = Json::array({{{"id", 1}, {"points", Json::array()}}});
  EXPECT_THROW(compare(folder.log(header + "\n" + changed.dump() + "\n")), std::runtime_error);
}

// A prism and a hull decide, and all of them is recorded: with another edge, yaw or vertex the plan is another one.
TEST(FlightReplay, PlansAmongSolidsAreRepeated) {
  const support::Folder folder;
  const auto file = folder.path() / "flight.jsonl";
  RealTimePlans plans(file);
  using planner::base::Solid;
  std::vector<planner::base::Track> tracks{sphere(1, {6, 0.2, 2}, {0, 0, 0}, 2.0),
                                           sphere(2, {10, 1, 2}, {0, 0, 0}, 3.0)};
  tracks[0].body = {Solid::box({0.5, 3.1, 1.7}, {{0.0, 0.1, 0.0}, Eigen::Matrix3d::Identity()}), 1.0 / 3.0, -0.2};
  tracks[1].body = {Solid::hull({{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1.0 / 3.0, -1, 1}}), 0.0, 0.0};
  plans.make(job(0, tracks), std::chrono::seconds(10));
  plans.close();
  EXPECT_TRUE(compare(file).differences.empty());
  const auto [header, line] = first_lines(file);
  const auto differences = [&, head = header](const Json& record) {
    return compare(folder.log(head + "\n" + record.dump() + "\n")).differences.size();
  };
  const Json recorded = Json::parse(line);
  ASSERT_EQ(recorded["from"]["tracks"][0][14]["prism"].size(), 17U);
  Json changed = recorded;
  changed["from"]["tracks"][0][14]["prism"][1] = 0.9;
  EXPECT_EQ(differences(changed), 1U);
  changed = recorded;
  changed["from"]["tracks"][0][14]["yaw"] = 0.9;
  EXPECT_EQ(differences(changed), 1U);
  for (const Json& bad : {Json({{"yaw", 0}, {"yaw_rate", 0}, {"prism", {1, 2, 3}}}), Json(3),
                          Json({{"yaw", 0}, {"yaw_rate", 0}, {"hull", {9, 9, 9}}}),
                          Json({{"yaw", 0}, {"yaw_rate", 0}, {"hull", Json::array()}})}) {
    changed["from"]["tracks"][0][14] = bad;
    EXPECT_THROW(differences(changed), std::runtime_error) << bad;
  }
}

// A log from before it was says nothing of it, and is read.
TEST(FlightReplay, PlansAmongWhatChangesSuddenlyAreRepeated) {
  const support::Folder folder;
  const auto file = folder.path() / "flight.jsonl";
  RealTimePlans plans(file);
  planner::base::Track exact = sphere(1, {8, 0.2, 2}, {-1, 0.1, 0}, 0.8);
  exact.position_sigma = exact.velocity_sigma = 0.0;
  exact.sudden_change = 1.0;
  plans.make(job(0, {exact}), std::chrono::seconds(10));
  plans.close();
  EXPECT_TRUE(compare(file).differences.empty());
  const auto [header, line] = first_lines(file);
  Json changed = Json::parse(line);
  Json& numbers = changed["from"]["tracks"][0];
  ASSERT_EQ(numbers.size(), 15U);
  for (const bool cut : {false, true}) {
    numbers.back() = 0.0;
    if (cut) numbers.erase(numbers.size() - 1);
    EXPECT_EQ(compare(folder.log(header + "\n" + changed.dump() + "\n")).differences.size(), 1U);
  }
}

/// That a flag of the request is recorded, and decides; a log from before it was says nothing of it, and is read.
void expect_flag_decides(const char* flag, bridge::companion::PlanJob next) {
  const support::Folder folder;
  const auto file = folder.path() / "flight.jsonl";
  RealTimePlans plans(file);
  plans.make(std::move(next), std::chrono::seconds(10));
  plans.close();
  EXPECT_TRUE(compare(file).differences.empty());
  const auto [header, line] = first_lines(file);
  Json changed = Json::parse(line);
  changed["from"][flag] = false;
  EXPECT_EQ(compare(folder.log(header + "\n" + changed.dump() + "\n")).differences.size(), 1U);
  changed["from"].erase(flag);
  EXPECT_EQ(compare(folder.log(header + "\n" + changed.dump() + "\n")).differences.size(), 1U);
}

TEST(FlightReplay, PlansOfAVehicleThatIsStuckAreRepeated) {
  bridge::companion::PlanJob next = job(0, {sphere(1, {8, 0.2, 2}, {-1, 0.1, 0}, 0.8)});
  next.request.stuck = true;
  expect_flag_decides("stuck", std::move(next));
}

TEST(FlightReplay, PlansOfAVehicleThatHoldsAreRepeated) {
  bridge::companion::PlanJob next = job(0, {sphere(1, {2, 6, 2.3}, {0, -3, 0}, 0.8)});
  next.request.target = {2, 0, 2.3};
  next.request.velocity.setZero();
  next.request.holds = true;
  expect_flag_decides("holds", std::move(next));
}

// What comes across the target passes after a visit.
TEST(FlightReplay, PlansOfAVisitAreRepeated) {
  bridge::companion::PlanJob next = job(0, {sphere(1, {2, 15, 2.3}, {0, -3, 0}, 0.8)});
  next.request.target = {2, 0, 2.3};
  next.request.velocity.setZero();
  next.request.visit = true;
  expect_flag_decides("visit", std::move(next));
}

/// A log of one plan, line by line: header, plan.
std::array<std::string, 2> one_plan(const support::Folder& folder) {
  const auto file = folder.path() / "one.jsonl";
  RealTimePlans plans(file);
  plans.make(job(0, {sphere(1, {8, 0.2, 2}, {-1, 0.1, 0}, 0.8)}), std::chrono::seconds(10));
  plans.close();
  return first_lines(file);
}

TEST(FlightReplay, TellsOneBitOfAPath) {
  const support::Folder folder;
  auto lines = one_plan(folder);
  EXPECT_TRUE(compare(folder.log(lines[0] + "\n" + lines[1] + "\n")).differences.empty());
  Json plan = Json::parse(lines[1]);
  double& y = plan["path"][5][2].get_ref<double&>();
  y = std::nextafter(y, 100.0);
  const FlightComparison comparison = compare(folder.log(lines[0] + "\n" + plan.dump() + "\n"));
  ASSERT_EQ(comparison.differences.size(), 1U);
  EXPECT_EQ(comparison.differences[0].line, 2U);
  EXPECT_LT(*comparison.differences[0].max_distance, 1e-12);
  plan = Json::parse(lines[1]);
  plan["status"] = "blocked";
  EXPECT_EQ(compare(folder.log(lines[0] + "\n" + plan.dump() + "\n")).differences.size(), 1U);
}

TEST(FlightReplay, TakesALogWhoseLastLineIsCutOff) {
  const support::Folder folder;
  const auto lines = one_plan(folder);
  const std::string whole = lines[0] + "\n" + lines[1] + "\n";
  FlightRecording recording(folder.log(whole + lines[1].substr(0, lines[1].size() / 2)));
  EXPECT_TRUE(recording.next().has_value());
  EXPECT_FALSE(recording.next().has_value());
  EXPECT_TRUE(recording.cut_off());
}

TEST(FlightReplay, PassesOverWhatIsNoPlanAndCountsIt) {
  const support::Folder folder;
  const auto lines = one_plan(folder);
  const std::string old = R"({"type":"plan","t":1,"path":[],"ms":1,"status":"reaches"})";
  FlightRecording recording(folder.log(lines[0] + "\n" + old + "\n\n" + R"({"type":"state","t":1})" + "\n" +
                                       R"({"type":"mystery"})" + "\n" + lines[1] + "\n"));
  ASSERT_TRUE(recording.next().has_value());
  EXPECT_FALSE(recording.next().has_value());
  EXPECT_EQ(recording.without_inputs(), 1U);
  EXPECT_EQ(recording.unknown(), 1U);
  EXPECT_FALSE(recording.cut_off());
}

std::string error_of(const std::filesystem::path& file) {
  try {
    FlightRecording recording(file);
    while (recording.next()) {
    }
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(file.string() + ":")) << text;
    return text.substr(std::min(text.size(), file.string().size()));
  }
  return "accepted";
}

/// A JSON pointer into a line, what is put there, and what the error says then.
using BadValue = std::array<std::string, 3>;

/// What is said of the log in which line `changed` (0: the header) has the bad value; the good plan follows.
std::string error_with(const BadValue& bad, std::size_t changed, const support::Folder& folder,
                       const std::array<std::string, 2>& good) {
  auto lines = good;
  Json line = Json::parse(lines[changed]);
  line[Json::json_pointer(bad[0])] = Json::parse(bad[1]);
  lines[changed] = line.dump();
  std::string said = error_of(folder.log(lines[0] + "\n" + lines[1] + "\n" + good[1] + "\n"));
  EXPECT_NE(said.find(bad[2]), std::string::npos) << bad[0] << " = " << bad[1] << ": " << said;
  return said;
}

TEST(FlightReplay, NamesTheLineOfABadRecord) {
  const support::Folder folder;
  const auto lines = one_plan(folder);
  const std::vector<BadValue> cases = {
      {"/t", R"("x")", "\"t\" is not a number"},
      {"/t", "null", "a time is not finite"},
      {"/number", "-1", "\"number\" is not a whole number"},
      {"/status", R"("great")", "\"status\" is not one of reaches"},
      {"/searches", "[[1,1]]", "\"searches\" is not a list of 2"},
      {"/searches/0", "[5,6]", "no [scheduled, done] generations"},
      {"/searches/0", "[99999999999,3]", "no [scheduled, done] generations"},
      {"/searches/0", "[3.5,3]", "no [scheduled, done] generations"},
      {"/path/3/0", "-1.0", "\"path\" is not a path"},
      {"/path/3", "[1,2,3]", "\"path\" is not a list of 4 numbers"},
      {"/from", "7", "has no \"begun\""},
      {"/from/start", R"("soon")", "\"start\" is not a number"},
      {"/from/p", "[1,2]", "\"p\" is not a list of 3 numbers"},
      {"/from/p/1", R"("Inf")", "\"p\" is not a number"},
      {"/from/vehicle/3", "0.0", "\"vehicle\" holds a limit that is not above 0"},
      {"/from/vehicle/3", R"("nan")", "\"vehicle\" holds a limit that is not above 0"},
      {"/from/volume/0/2", "1000.0", "accepted"},
      {"/from/volume/1/2", R"("nan")", "\"volume\" is not [min, max]"},
      {"/from/margin", "-0.1", "is below 0"},
      {"/from/sudden_change", "-0.1", "is below 0"},
      {"/from/volume_clearance", "-0.1", "is below 0"},
      {"/from/time_price", "-0.1", "is below 0"},
      {"/from/tracks/0", "[1,2,3]", "\"tracks\" is not a list of 14 numbers"},
      {"/from/tracks/0/0", "1.5", "an id that is not a whole number"},
      {"/from/previous", "[[0,0,0,0],[-1,0,0,0]]", "\"previous\" is not a path"},
      {"/from/previous", "{}", "\"previous\" is not a list"},
  };
  for (const BadValue& bad : cases) {
    const std::string said = error_with(bad, 1, folder, lines);
    EXPECT_TRUE(said == "accepted" || said.starts_with(":2: ")) << said;
  }
  EXPECT_EQ(error_of(folder.log(lines[0] + "\n{\"type\":\n" + lines[1] + "\n")), ":2: is not JSON");
  EXPECT_EQ(error_of(folder.log(lines[0] + "\n[]\n" + lines[1] + "\n")), ":2: is not a JSON object");
}

TEST(FlightReplay, RefusesAWrongHeader) {
  const support::Folder folder;
  const auto lines = one_plan(folder);
  const std::vector<BadValue> cases = {
      {"/format", R"("jink-log/2")", "format: \"jink-log/2\" is not \"jink-log/1\""},
      {"/type", R"("plan")", "is not a jink-log/1 header"},
      {"/seed", "-4", "header \"seed\" is not a whole number"},
      {"/version", "1", "header \"version\" is not text"},
      {"/mission", "{}", "header \"mission\" is not text"},
      {"/parameters", "[]", "header \"parameters\" is not an object"},
      {"/parameters/horizon.margin", "0.35", "header \"horizon.margin\" is not text"},
  };
  for (const BadValue& bad : cases) (void)error_with(bad, 0, folder, lines);
  EXPECT_NE(error_of(folder.log("")).find("the file is empty"), std::string::npos);
  EXPECT_NE(error_of(folder.log("\x01\x02")).find("is not a jink-log/1 header"), std::string::npos);
}

TEST(RecordedSettings, AreTheLogsOwnAndCheckedLikeAFile) {
  config::Settings settings;
  settings.horizon.margin = 0.1 + 0.2;
  const auto values = config::list_settings(settings);
  std::vector<std::string> missing;
  EXPECT_EQ(config::list_settings(config::recorded_settings("log:1", values, {}, missing)), values);
  EXPECT_TRUE(missing.empty());
  const std::vector<config::SettingText> few{{"horizon.margin", "0.5"}};
  const auto changed = config::recorded_settings("log:1", few, {"horizon.population=100"}, missing);
  EXPECT_EQ(changed.horizon.margin, 0.5);
  EXPECT_EQ(changed.horizon.population, 100);
  EXPECT_EQ(missing.size(), values.size() - 1);
  const auto error = [&](const config::SettingText& bad) {
    try {
      (void)config::recorded_settings("log:1", {bad}, {}, missing);
    } catch (const config::ConfigError& complaint) {
      return std::string(complaint.what());
    }
    return std::string("accepted");
  };
  EXPECT_TRUE(error({"horizon.margn", "1"}).starts_with("log:1: key 'horizon.margn': unknown key"));
  EXPECT_TRUE(error({"horizon.margin", "-1"}).starts_with("log:1: key 'horizon.margin': value '-1' is not in"));
  EXPECT_NE(error({"horizon.population", "1"}).find("log:1"), std::string::npos);
}

}  // namespace
}  // namespace jink::tools::log
