// SPDX-License-Identifier: BSD-3-Clause
#include "planner/horizon/guide.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "planner/base/solid.hpp"
#include "planner/geometry/validity.hpp"
#include "planner/horizon/polyline.hpp"
#include "tests/support/boxes.hpp"

namespace jink::planner::horizon {
namespace {

using support::box;
using support::numbered;
using support::wall_with_two_doors;

constexpr double kVehicle = 0.3;
constexpr double kKept = 0.35;

/// A wall across at x, higher than the volume, with a door of some width about y.
std::vector<base::Track> wall(double x, double y, double width) {
  const double left = 20.0 - (y + 0.5 * width);
  const double right = 20.0 + (y - 0.5 * width);
  return {box({x, 20.0 - 0.5 * left, 4}, {0.2, left, 12}), box({x, -20.0 + 0.5 * right, 4}, {0.2, right, 12})};
}

/// Three walls: in front, to the left, to the right.
std::vector<base::Track> dead_end() {
  return numbered({box({10, 0, 4}, {0.2, 8, 12}), box({6, 4, 4}, {8, 0.2, 12}), box({6, -4, 4}, {8, 0.2, 12})});
}

PathRequest guide_request(const std::vector<base::Track>& tracks, const Vec3& position = {8, 0, 2}) {
  PathRequest request;
  request.position = position;
  request.target = {20, 0, 2};
  request.volume = {{-10, -20, 0}, {30, 20, 8}};
  request.margin = kKept;
  request.tracks = tracks;
  return request;
}

double clearance_of(const std::vector<base::Track>& tracks, const Vec3& from, const Vec3& to) {
  Standing standing;
  standing.set(tracks, {}, 0.0);
  double least = 100.0;
  for (int i = 0; i <= 1000; ++i) least = std::min(least, standing.distance(from + i / 1000.0 * (to - from), 100.0));
  return least - kVehicle;
}

TEST(Standing, KnowsTheDistanceToSpheresSolidsAndTheMap) {
  base::Track ball;
  ball.position = {0, 0, 0};
  ball.radius = 1.0;
  const geometry::StaticMap map({box({0, 10, 0}, {2, 2, 2})});
  Standing standing;
  EXPECT_TRUE(standing.empty());
  const std::vector<base::Track> tracks{ball, box({10, 0, 0}, {2, 4, 2})};
  standing.set(tracks, {&map, 1.0}, 0.0);
  EXPECT_FALSE(standing.empty());
  EXPECT_NEAR(standing.distance({-3, 0, 0}, 50.0), 2.0, 1e-12);
  EXPECT_NEAR(standing.distance({-3, 0, 0}, 1.5), 1.5, 1e-12) << "no farther than asked for";
  EXPECT_NEAR(standing.distance({10, 5, 0}, 50.0), 3.0, 1e-12);
  EXPECT_NEAR(standing.distance({0, 10, 4}, 50.0), 2.0, 1e-12) << "the map is 1 m higher here";
  EXPECT_NEAR(standing.distance({0, 0, 0}, 50.0), -1.0, 1e-12);
  // Through the gap between the ball (from x = 1) and the box (to x = 9).
  EXPECT_TRUE(standing.is_clear({5, -9, 0}, {5, 9, 0}, 3.9));
  EXPECT_FALSE(standing.is_clear({5, -9, 0}, {5, 9, 0}, 4.1));
  // What is uncertain counts as larger; what is no higher than the floor is the ground.
  std::vector<base::Track> blurred = tracks;
  blurred[0].position_sigma = 0.2;
  standing.set(blurred, {&map, 0.0, 1.0, 0.3}, 2.0);
  EXPECT_NEAR(standing.distance({-3, 0, 0}, 50.0), 1.6, 1e-12);
  EXPECT_GT(standing.distance({0, 10, 2}, 50.0), 5.0);
}

TEST(GridSearch, FindsTheWayRoundAndSaysWhereThereIsNone) {
  const std::vector<base::Track> tracks = dead_end();
  Standing standing;
  standing.set(tracks, {}, 0.0);
  GridSearch search;
  EXPECT_EQ(search.advance(standing, 10), GridSearch::State::kIdle);
  GridQuery query{{8, 0, 2}, {20, 0, 2}, {{-10, -20, 0}, {30, 20, 3.5}}, kVehicle, 0.1, 0.55, 1.5, 0.5};
  search.begin(query);
  int calls = 0;
  while (search.advance(standing, 100) == GridSearch::State::kSearching) ++calls;
  EXPECT_GT(calls, 3);
  ASSERT_EQ(search.state(), GridSearch::State::kFound);
  const std::vector<Vec3> way = search.way();
  EXPECT_EQ(way.front(), query.from);
  EXPECT_EQ(way.back(), query.to);
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    length += (way[i] - way[i - 1]).norm();
    EXPECT_GE(clearance_of(tracks, way[i - 1], way[i]), 0.1 - 1e-9);
  }
  // Back out at x = 2, round a corner at y = 4: the shortest goes by (2 - c, 4 + c) and (10 + c, 4 + c).
  EXPECT_GT(length, 7.2 + 8.0 + 10.7);
  EXPECT_LT(length, 1.25 * (7.2 + 8.0 + 10.7) + 4.0);
  // The same in one go.
  GridSearch whole;
  whole.begin(query);
  EXPECT_EQ(whole.advance(standing, std::numeric_limits<int>::max()), GridSearch::State::kFound);
  EXPECT_EQ(whole.way(), way);

  std::vector<base::Track> closed = tracks;
  closed.push_back(box({2, 0, 4}, {0.2, 8.2, 12}));
  standing.set(closed, {}, 0.0);
  whole.begin(query);
  EXPECT_EQ(whole.advance(standing, std::numeric_limits<int>::max()), GridSearch::State::kNone);
}

TEST(Guide, LeadsStraightOnWhereNothingStandsInTheWay) {
  std::vector<base::Track> tracks = numbered({box({10, 8, 2}, {1, 1, 1}), box({10, 0, 2}, {1, 1, 1})});
  tracks[1].velocity = {0, 2, 0};  // moves: the plans' affair
  PathRequest request = guide_request(tracks);
  Guide guide({}, Guide::Knowledge::kWhole);
  guide.lead(request, 0.0);
  EXPECT_EQ(request.target, Vec3(20, 0, 2));
  EXPECT_EQ(request.margin, kKept);
  EXPECT_TRUE(request.way.empty());
  EXPECT_TRUE(guide.way().empty());
}

TEST(Guide, LeadsOutOfADeadEndToPlacesInSight) {
  const std::vector<base::Track> tracks = dead_end();
  Guide guide({}, Guide::Knowledge::kWhole);
  Vec3 position(8, 0, 2);
  double flown = 0.0;
  for (int n = 0; n < 400 && (position - Vec3(20, 0, 2)).norm() > 0.5; ++n) {
    PathRequest request = guide_request(tracks, position);
    request.visit = true;
    guide.lead(request, 0.1 * n);
    const Vec3 way = request.way.empty() ? Vec3(request.target - position) : Vec3(request.way.front() - position);
    EXPECT_TRUE(request.way.empty() || request.way.back() == request.target);
    EXPECT_EQ(request.visit, request.target == Vec3(20, 0, 2));
    const double step = std::min(0.3, way.norm());
    ASSERT_GT(step, 0.0);
    const Vec3 next = position + step / way.norm() * way;
    ASSERT_GT(clearance_of(tracks, position, next), 0.0) << position.transpose();
    position = next;
    flown += step;
  }
  EXPECT_LT((position - Vec3(20, 0, 2)).norm(), 0.51);
  EXPECT_LT(flown, 36.0);
}

// Who evaded into the next room is as near to its way as before, but for the wall between.
TEST(Guide, LooksForTheWayAnewWhereSomethingStandsBetween) {
  std::vector<base::Track> tracks = wall(10, 5, 1.6);
  tracks.push_back(box({4, 1.5, 4}, {12, 0.2, 12}));
  tracks = numbered(std::move(tracks));
  const Vec3 before(0, 3, 2), behind(0, 0.8, 2);
  Guide guide(base::HorizonSettings{}, Guide::Knowledge::kWhole);
  PathRequest request = guide_request(tracks, before);
  guide.lead(request, 0.0);
  ASSERT_FALSE(guide.way().empty());
  EXPECT_GT(request.target.y(), 3.0);
  for (int call = 0; call < 100; ++call) {
    request = guide_request(tracks, behind);
    guide.lead(request, 0.1 * call);
  }
  EXPECT_LT(request.target.x(), -1.9) << "round the end of the wall between";
  EXPECT_GT(clearance_of(tracks, behind, request.target), 0.0);
}

// As wide as what a map of cells leaves of a door of 1.3 m.
TEST(Guide, FindsANarrowDoorWhereverItIsBesideTheGrid) {
  const base::HorizonSettings settings;
  for (const double aside : {0.0, 0.05, 0.1, 0.125, 0.15, 0.2}) {
    const std::vector<base::Track> tracks = numbered(wall(10, 3.0 + aside, 0.9));
    PathRequest request = guide_request(tracks);
    Guide guide(settings, Guide::Knowledge::kWhole);
    guide.lead(request, 0.0);
    ASSERT_FALSE(guide.way().empty()) << aside;
    for (std::size_t i = 1; i < guide.way().size(); ++i)
      EXPECT_GT(clearance_of(tracks, guide.way()[i - 1], guide.way()[i]), settings.guide_margin - 0.06) << aside;
  }
}

// Beside what stands; what moves beside the door keeps all of it.
TEST(Guide, LetsTheMarginGiveWayInADoorWithSpeed) {
  std::vector<base::Track> tracks = numbered(wall(10, 0.0, 1.3));
  tracks.push_back(box({10, 3, 2}, {0.5, 0.5, 1.8}));
  tracks.back().id = 77;
  tracks.back().velocity = {0, 1, 0};
  PathRequest request = guide_request(tracks, {8, 0.3, 2});
  Guide guide({}, Guide::Knowledge::kWhole);
  guide.lead(request, 0.0);
  ASSERT_FALSE(guide.way().empty());
  EXPECT_EQ(request.margin, kKept);
  EXPECT_GE(request.standing_margin, 0.1);
  EXPECT_LT(request.standing_margin, 0.3);
  EXPECT_NEAR(request.vehicle.cruise_speed, 3.0 * request.standing_margin / kKept, 1e-12);
  EXPECT_EQ(std::vector<std::uint64_t>(guide.standing().begin(), guide.standing().end()),
            (std::vector<std::uint64_t>{1, 2}));
  // Far from it nothing gives way.
  request = guide_request(tracks, {0, 0.3, 2});
  guide = Guide({}, Guide::Knowledge::kWhole);
  guide.lead(request, 0.0);
  EXPECT_EQ(request.margin_beside_standing(), kKept);
  EXPECT_TRUE(guide.standing().empty());
  EXPECT_EQ(request.vehicle.cruise_speed, 3.0);
  // Nor beside a wall's end, however near the way passes: there is room on the other side.
  const std::vector<base::Track> end = numbered({box({10, -10, 4}, {0.2, 20.6, 12})});
  request = guide_request(end, {8, 0.3, 2});
  guide = Guide({}, Guide::Knowledge::kWhole);
  guide.lead(request, 0.0);
  ASSERT_FALSE(guide.way().empty());
  EXPECT_EQ(request.margin_beside_standing(), kKept);
  // Who does not know where the door is but to a decimetre or two does not go through.
  std::vector<base::Track> blurred = tracks;
  for (base::Track& track : blurred) track.position_sigma = 0.3;
  request = guide_request(blurred, {8, 0.3, 2});
  guide = Guide({}, Guide::Knowledge::kWhole);
  guide.lead(request, 0.0);
  EXPECT_TRUE(guide.way().empty());
  EXPECT_EQ(request.margin_beside_standing(), kKept);
}

// Through the other door: not beside what is in the first one, nor round a block that stands free.
TEST(Guide, FindsOtherWaysWhenThatIsWanted) {
  std::vector<base::Track> tracks = wall_with_two_doors(10, 6);
  for (const double y : {0.0, 0.5}) {
    SCOPED_TRACE(y);
    const auto asked = [&] { return guide_request(tracks, {5, y, 2}); };
    Guide guide({}, Guide::Knowledge::kWhole);
    PathRequest request = asked();
    guide.lead(request, 0.0);
    EXPECT_TRUE(guide.others().empty());
    guide.want_others();
    for (int n = 0; n < 8; ++n) {
      request = asked();
      guide.lead(request, 0.1 * n);
      EXPECT_LT(request.target.y(), 1.0) << "until it is taken";
    }
    ASSERT_EQ(guide.others().size(), 1U);
    EXPECT_EQ(guide.others()[0].front(), asked().position);
    EXPECT_EQ(guide.others()[0].back(), asked().target);
    PathRequest other = asked();
    guide.lead_along(0, other);
    EXPECT_GT(other.target.y(), 4.0);
    EXPECT_GT(clearance_of(tracks, other.position, other.way.front()), 0.0);
    guide.forget_others();
    EXPECT_TRUE(guide.others().empty());
    guide.want_others();
    for (int n = 0; n < 8; ++n) guide.lead(request = asked(), 0.9);
    ASSERT_EQ(guide.others().size(), 1U) << "again";
    guide.take(0);
    EXPECT_TRUE(guide.others().empty());
    request = asked();
    guide.lead(request, 1.0);
    EXPECT_EQ(request.target, other.target) << "though straight on is nearer";
    EXPECT_NEAR(left_along(guide.way(), asked().position), 19.3, 1.0);
  }
  tracks.pop_back();
  tracks.push_back(box({10, 13.3, 4}, {0.2, 20.7, 12}));  // the second door is closed
  PathRequest request = guide_request(tracks, {5, 0.5, 2});
  Guide guide({}, Guide::Knowledge::kWhole);
  guide.lead(request, 0.0);
  guide.want_others();
  for (int n = 0; n < 8; ++n) {
    request = guide_request(tracks, {5, 0.5, 2});
    guide.lead(request, 0.1 * n);
  }
  EXPECT_TRUE(guide.others().empty());
}

// A door that closes may open again: where there is no other way it is waited there, not where it closed.
TEST(Guide, WaitsBeforeAClosedDoorWhereThereIsNoOtherWay) {
  const std::vector<base::Track> open = numbered(wall(12, 0, 1.3));
  std::vector<base::Track> closed = open;
  closed.push_back(box({12, 0, 4}, {0.2, 1.3, 12}));
  closed.back().id = 9;
  Guide guide(base::HorizonSettings{}, Guide::Knowledge::kWhole);
  const Vec3 start(6, 5, 2);
  const auto target = [&](const std::vector<base::Track>& tracks, const Vec3& position, double now) {
    PathRequest request = guide_request(tracks, position);
    guide.lead(request, now);
    return request.target;
  };
  EXPECT_GT(target(open, start, 0.0).x(), 11.0);
  for (const double now : {0.1, 0.2, 5.0}) {
    const Vec3 waits = target(closed, start, now);
    EXPECT_LT(waits.x(), 11.3);
    EXPECT_GT(waits.x(), 10.0);
    EXPECT_LT(std::abs(waits.y()), 1.0);
  }
  const Vec3 before(10.8, 0.1, 2);
  EXPECT_LT((target(closed, before, 6.0) - before).norm(), 0.5) << "it is there";
  EXPECT_GT(target(open, before, 6.1).x(), 12.0) << "at once";
  // Nothing was known of a way when it was closed: straight on, as ever.
  Guide other(base::HorizonSettings{}, Guide::Knowledge::kWhole);
  PathRequest request = guide_request(closed, start);
  other.lead(request, 0.0);
  EXPECT_EQ(request.target, guide_request(closed, start).target);
}

TEST(Guide, PassesByTheMapAsByTracks) {
  const geometry::StaticMap map(dead_end());
  PathRequest request = guide_request({});
  Guide guide({}, Guide::Knowledge::kSensed);
  for (int n = 0; n < 100 && guide.way().empty(); ++n) {
    request = guide_request({});
    guide.lead(request, 0.05 * n, {&map});
  }
  EXPECT_FALSE(guide.way().empty());
  EXPECT_NE(request.target, Vec3(20, 0, 2));
}

// What is tracked stands once it has rested for a second; out of sight it stands still, in sight it does not.
TEST(Guide, RemembersWhatStandsOutOfSight) {
  const std::vector<base::Track> tracks = dead_end();
  base::Track far;
  far.id = 99;
  far.radius = 0.5;
  far.position = {8, -15, 2};
  far.velocity = {1, 0, 0};
  Guide guide({}, Guide::Knowledge::kSensed);
  const auto led = [&](double now, const std::vector<base::Track>& seen) {
    PathRequest request = guide_request(seen);
    guide.lead(request, now);
    return !guide.way().empty();
  };
  EXPECT_FALSE(led(0.0, tracks));
  EXPECT_FALSE(led(0.9, tracks));
  bool found = false;
  double now = 1.0;
  for (; now < 4.0 && !found; now += 0.05) found = led(now, tracks);
  EXPECT_TRUE(found);
  EXPECT_TRUE(led(now + 20.0, {})) << "nothing is seen at all";
  EXPECT_FALSE(led(now + 21.0, {far})) << "who sees as far would see the walls";
}

/// How long dead_end() must have been tracked, s, until it counts as standing beside something that moves. `change` is
/// made to each of its tracks at a time.
double settled_after(const std::function<void(double now, base::Track&)>& change) {
  base::Track mover;
  mover.id = 99;
  mover.radius = 0.5;
  mover.position = {3, -8, 2};
  mover.velocity = {1, 0, 0};
  Guide guide({}, Guide::Knowledge::kSensed);
  for (int n = 0; n < 120; ++n) {
    std::vector<base::Track> tracks = dead_end();
    for (base::Track& track : tracks) change(0.05 * n, track);
    tracks.push_back(mover);
    PathRequest request = guide_request(tracks);
    guide.lead(request, 0.05 * n);
    if (!guide.way().empty()) return 0.05 * n;
  }
  return base::kInfinity;
}

TEST(Guide, DoesNotLookAtWhatIsFarOff) {
  std::vector<base::Track> tracks = numbered(wall(10, 0.0, 1.3));
  tracks.push_back(box({2000, 0, 2}, {1, 1, 1}));
  tracks.back().id = 9;
  Guide guide({}, Guide::Knowledge::kSensed);
  for (int n = 0; n < 100; ++n) {
    PathRequest request = guide_request(tracks, {8, 0.3, 2});
    guide.lead(request, 0.05 * n);
  }
  EXPECT_EQ(std::vector<std::uint64_t>(guide.standing().begin(), guide.standing().end()),
            (std::vector<std::uint64_t>{1, 2}));
}

TEST(Guide, TellsWhatStandsFromWhatMovesTrackByTrack) {
  const double exactly = settled_after([](double, base::Track&) {});
  EXPECT_LT(exactly, 4.0) << "a second, and the search";
  // In noise it takes two seconds longer.
  const double in_noise = settled_after([](double now, base::Track& track) {
    track.velocity_sigma = 0.15;
    track.position_sigma = 0.05;
    track.velocity = {0.2 * std::sin(9.0 * now), 0.2 * std::cos(7.0 * now), 0};
    track.position.x() += 0.03 * std::sin(11.0 * now);
  });
  EXPECT_NEAR(in_noise, exactly + 2.0, 0.3);
  // What creeps does not stand, however slow, nor does what turns, nor what swings where it turns back.
  EXPECT_EQ(settled_after([](double now, base::Track& track) {
              track.velocity_sigma = 0.15;
              track.position.x() += 0.25 * now;
              track.velocity = {0.25, 0, 0};
            }),
            base::kInfinity);
  EXPECT_EQ(settled_after([](double, base::Track& track) { track.body.yaw_rate = 0.01; }), base::kInfinity);
  EXPECT_EQ(settled_after([](double, base::Track& track) { track.acceleration = {0, 0.3, 0}; }), base::kInfinity);
}

TEST(SetApart, MovesTracksToWhatStandsWithoutTheirMotion) {
  std::vector<base::Track> tracks = dead_end();
  tracks[1].velocity = {0.1, 0, 0};
  tracks[1].acceleration = {0, 0.1, 0};
  std::vector<base::Track> standing = numbered({box({5, 0, 0}, {1, 1, 1})});
  set_apart(std::vector<std::uint64_t>{2, 3, 50}, tracks, standing);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].id, 1U);
  ASSERT_EQ(standing.size(), 3U);
  EXPECT_EQ(standing[1].id, 2U);
  EXPECT_TRUE(geometry::is_at_rest(standing[1]));
  EXPECT_EQ(standing[2].position, dead_end()[2].position);
}

TEST(Guide, LeavesBadRequestsAndGuidelessSettingsAlone) {
  const std::vector<base::Track> tracks = dead_end();
  PathRequest request = guide_request(tracks);
  request.position.x() = std::nan("");
  Guide({}, Guide::Knowledge::kWhole).lead(request, 0.0);
  EXPECT_EQ(request.target, Vec3(20, 0, 2));
  base::HorizonSettings settings;
  settings.guide = false;
  request = guide_request(tracks);
  Guide(settings, Guide::Knowledge::kWhole).lead(request, 0.0);
  EXPECT_EQ(request.target, Vec3(20, 0, 2));
}

}  // namespace
}  // namespace jink::planner::horizon
