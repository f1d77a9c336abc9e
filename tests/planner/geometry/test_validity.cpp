// SPDX-License-Identifier: BSD-3-Clause
// Every number of a request, one after the other, as what it must not be: each planner refuses it, and so does the
// verifier where it reads it.
#include "planner/geometry/validity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "planner/horizon/contingency.hpp"
#include "planner/horizon/horizon_planner.hpp"
#include "planner/horizon/open_loop.hpp"
#include "planner/horizon/path_check.hpp"
#include "planner/paper/paper_planner.hpp"
#include "planner/verify/verifier.hpp"

namespace jink::planner {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = base::kInfinity;

/// All that a request, of any planner, and the verifier's input hold.
struct Everything {
  std::vector<base::Track> tracks{1};
  std::vector<geometry::KnownPath> paths{1};
  horizon::PathRequest request;
  double time_limit = 60.0, commit = 0.5;

  Everything() {
    tracks[0].position = {10, 3, 2};
    tracks[0].radius = 0.5;
    paths[0].points = {{0.0, {10, -4, 2}, Vec3::Zero(), Vec3::Zero()}, {1.0, {11, -4, 2}, Vec3::Zero(), Vec3::Zero()}};
    paths[0].radius = 0.5;
    request.position = {0, 0, 2};
    request.velocity = {1, 0, 0};
    request.target = {20, 0, 2};
    request.volume = {{-5, -10, 0.3}, {25, 10, 8}};
    request.margin = 0.35;
    request.track_acceleration = 0.4;
    request.volume_clearance = 0.4;
    request.sudden_change = 1.5;
    request.time_price = 2.5;
    request.acceleration_trust = 0.7;
  }

  [[nodiscard]] horizon::PathRequest bound() const {
    horizon::PathRequest r = request;
    r.tracks = tracks;
    r.paths = paths;
    return r;
  }
};

/// Who reads the number.
enum Reader : unsigned { kHorizon = 1, kPaper = 2, kVerifier = 4, kStops = 8, kOpenLoop = 16 };
constexpr unsigned kPlanners = kHorizon | kStops | kOpenLoop;
constexpr unsigned kAll = kPlanners | kPaper | kVerifier;

struct Field {
  const char* name;
  unsigned readers;
  std::function<double&(Everything&)> of;
  std::vector<double> refused;
};

std::ostream& operator<<(std::ostream& out, const Field& field) {
  return out << field.name;
}

const std::vector<double> kNoPlace{kNaN, kInf, -kInf, 1e200};
const std::vector<double> kNoAmount{kNaN, kInf, -kInf, -1e-3};
const std::vector<double> kNoLimit{kNaN, kInf, -kInf, -1e-3, 0.0};

// NOLINTBEGIN(cppcoreguidelines-macro-usage): a field is named once
#define JINK_FIELD(readers, expression, refused)                                          \
  Field {                                                                                 \
#expression, readers, [](Everything & e) -> double& { return e.expression; }, refused \
  }
// NOLINTEND(cppcoreguidelines-macro-usage)

std::vector<Field> fields() {
  const std::vector<double> nan{kNaN};
  const std::vector<double> no_trust{kNaN, -kInf, -1e-3};
  return {
      JINK_FIELD(kPlanners | kPaper, request.position[0], kNoPlace),
      JINK_FIELD(kPlanners, request.velocity[1], kNoPlace),
      JINK_FIELD(kHorizon | kPaper | kOpenLoop, request.target[2], kNoPlace),
      JINK_FIELD(kAll, request.volume.min[0], (std::vector<double>{kNaN, kInf, 26.0, -1e200})),
      JINK_FIELD(kAll, request.volume.max[2], (std::vector<double>{kNaN, -kInf, 0.2, 1e200})),
      JINK_FIELD(kAll, request.vehicle.radius, kNoAmount),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.length, kNoLimit),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.mass, kNoLimit),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.max_speed, kNoLimit),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.cruise_speed, kNoLimit),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.max_acceleration, kNoLimit),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.max_jerk, kNoLimit),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.max_climb, kNoLimit),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.drag, kNoAmount),
      JINK_FIELD(kPlanners | kPaper, request.vehicle.damping, kNoAmount),
      JINK_FIELD(kPlanners, request.margin, kNoAmount),
      JINK_FIELD(kPlanners, request.track_acceleration, kNoAmount),
      JINK_FIELD(kPlanners, request.volume_clearance, kNoAmount),
      JINK_FIELD(kPlanners, request.sudden_change, kNoAmount),
      JINK_FIELD(kPlanners, request.time_price, kNoAmount),
      JINK_FIELD(kPlanners | kVerifier, request.acceleration_trust, no_trust),
      JINK_FIELD(kAll, tracks[0].position[0], kNoPlace),
      JINK_FIELD(kAll, tracks[0].velocity[1], kNoPlace),
      JINK_FIELD(kAll, tracks[0].acceleration[2], (std::vector<double>{kNaN, kInf, -kInf, 1e15})),
      JINK_FIELD(kAll, tracks[0].radius, (std::vector<double>{kNaN, kInf, -kInf, -1e-3, 1e160})),
      JINK_FIELD(kAll, tracks[0].position_sigma, kNoAmount),
      JINK_FIELD(kAll, tracks[0].velocity_sigma, kNoAmount),
      JINK_FIELD(kAll, tracks[0].age, kNoAmount),
      JINK_FIELD(kAll, tracks[0].sudden_change, kNoAmount),
      JINK_FIELD(kPlanners | kVerifier, paths[0].points[1].position[1], kNoPlace),
      JINK_FIELD(kPlanners | kVerifier, paths[0].points[1].t,
                 (std::vector<double>{kNaN, kInf, -kInf, 0.0, -1.0, 1e300})),
      JINK_FIELD(kPlanners | kVerifier, paths[0].offset, kNoPlace),
      JINK_FIELD(kPlanners | kVerifier, paths[0].radius, (std::vector<double>{kNaN, kInf, -kInf, -1e-3, 1e160})),
      JINK_FIELD(kPlanners | kVerifier, paths[0].margin, kNoAmount),
      JINK_FIELD(kPlanners | kVerifier, paths[0].position_sigma, kNoAmount),
      JINK_FIELD(kPlanners | kVerifier, paths[0].velocity_sigma, kNoAmount),
      JINK_FIELD(kPlanners | kVerifier, paths[0].age, kNoAmount),
      JINK_FIELD(kPlanners | kVerifier, paths[0].until, nan),
      JINK_FIELD(kOpenLoop, time_limit, (std::vector<double>{kNaN, -1e-3})),
      JINK_FIELD(kOpenLoop, commit, (std::vector<double>{kNaN, 0.0, -0.5})),
  };
}

#undef JINK_FIELD

verify::Plan plan_horizon(const Everything& e) {
  base::WorkerPool pool(1);
  return horizon::HorizonPlanner{base::HorizonSettings{}}.plan(e.bound(), {}, 1, 0, {3}, pool);
}

verify::Plan plan_open_loop(const Everything& e) {
  base::WorkerPool pool(1);
  horizon::OpenLoopRequest request{e.bound(), e.time_limit, e.commit};
  request.path.velocity = request.path.velocity.cwiseProduct(Vec3(0, 1, 1));  // from rest
  return horizon::plan_open_loop({}, {}, request, 1, {3}, pool);
}

verify::Plan plan_paper(const Everything& e) {
  base::WorkerPool pool(1);
  paper::PaperRequest request;
  request.start = e.request.position;
  request.target = e.request.target;
  request.volume = e.request.volume;
  request.vehicle = e.request.vehicle;
  request.tracks = e.tracks;
  request.optimizer.iterations = 3;
  return paper::plan_paper(request, pool);
}

bool judged(const Everything& e) {
  const base::TimedPath path{{0.0, {0, 0, 2}, Vec3::Zero(), Vec3::Zero()},
                             {9.0, {20, 0, 2}, Vec3::Zero(), Vec3::Zero()}};
  const verify::Verification v = verify::verify(
      {path, e.tracks, 0.0, e.request.vehicle.radius, e.request.volume, e.request.acceleration_trust, kInf, e.paths});
  EXPECT_TRUE(v.valid || !v.free());
  return v.valid;
}

horizon::Stop stop(const Everything& e) {
  const std::vector<base::TimedPath> stops{
      {{0.0, {0, 0, 2}, {1, 0, 0}, Vec3::Zero()}, {1.0, {0.5, 0, 2}, Vec3::Zero(), Vec3::Zero()}}};
  return horizon::Contingency{base::HorizonSettings{}}.choose(e.bound(), stops);
}

void expect_refused(const verify::Plan& plan) {
  EXPECT_EQ(plan.status, verify::PlanStatus::kInvalid);
  EXPECT_TRUE(plan.path.empty());
}

class Validity : public testing::TestWithParam<Field> {};

TEST_P(Validity, NoOneTakesANumberThatIsNone) {
  const Field& field = GetParam();
  for (const double value : field.refused) {
    SCOPED_TRACE(value);
    Everything e;
    field.of(e) = value;
    if ((field.readers & kHorizon) != 0U) expect_refused(plan_horizon(e));
    if ((field.readers & kOpenLoop) != 0U) expect_refused(plan_open_loop(e));
    if ((field.readers & kPaper) != 0U) expect_refused(plan_paper(e));
    if ((field.readers & kVerifier) != 0U) {
      EXPECT_FALSE(judged(e));
    }
    if ((field.readers & kStops) != 0U) {
      const horizon::Stop chosen = stop(e);
      EXPECT_FALSE(chosen.verification.free());
      EXPECT_EQ(chosen.path.size(), 2U);  // it stops all the same
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryField, Validity, testing::ValuesIn(fields()), [](const auto& field) {
  std::string name = field.param.name;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
});

TEST(Validity, WhatIsReasonableIsTaken) {
  const Everything plain;
  EXPECT_NE(plan_horizon(plain).status, verify::PlanStatus::kInvalid);
  EXPECT_NE(plan_open_loop(plain).status, verify::PlanStatus::kInvalid);
  EXPECT_NE(plan_paper(plain).status, verify::PlanStatus::kInvalid);
  EXPECT_TRUE(stop(plain).verification.free());
  EXPECT_TRUE(judged(plain));
  Everything unbounded;
  unbounded.request.volume = {};
  unbounded.request.acceleration_trust = kInf;
  unbounded.paths[0].until = kInf;
  EXPECT_NE(plan_horizon(unbounded).status, verify::PlanStatus::kInvalid);
  // In a frame whose origin is 5000 km away, on a clock that counts from 1970.
  Everything far;
  const Vec3 away(4e5, 5e6, 0);
  far.request.position += away;
  far.request.target += away;
  far.request.volume = {far.request.volume.min + away, far.request.volume.max + away};
  far.tracks[0].position += away;
  far.paths[0].offset = 1.7e9;
  for (base::TimedPoint& point : far.paths[0].points) {
    point.position += away;
    point.t += 1.7e9;
  }
  EXPECT_EQ(plan_horizon(far).status, verify::PlanStatus::kReaches);
  EXPECT_TRUE(judged(far));
}

TEST(Validity, APathsTimesIncreaseAndItsSpeedsAreOnes) {
  const auto path = [](double t, double x) {
    return base::TimedPath{{0.0, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, {t, {x, 0, 0}, Vec3::Zero(), Vec3::Zero()}};
  };
  EXPECT_TRUE(geometry::is_valid_path(path(1.0, 1.0)));
  EXPECT_TRUE(geometry::is_valid_path(path(1e-9, 0.0)));
  EXPECT_FALSE(geometry::is_valid_path({}));
  EXPECT_FALSE(geometry::is_valid_path(path(0.0, 1.0)));
  EXPECT_FALSE(geometry::is_valid_path(path(-1.0, 1.0)));
  EXPECT_FALSE(geometry::is_valid_path(path(kNaN, 1.0)));
  EXPECT_FALSE(geometry::is_valid_path(path(kInf, 1.0)));
  EXPECT_FALSE(geometry::is_valid_path(path(1.0, kNaN)));
  EXPECT_FALSE(geometry::is_valid_path(path(1e-9, 1.0)));
  EXPECT_FALSE(geometry::is_valid_path(path(1.0, 1e200)));
}

}  // namespace
}  // namespace jink::planner
