// SPDX-License-Identifier: BSD-3-Clause
// Known places under a roof: offices, a lift, a storage hall, a hall with a gate.
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/families/places.hpp"

namespace jink::sim::families {
namespace {

constexpr double kLowest = 0.3;      // m, floor of the flight volume: the vehicle's radius
constexpr double kDoorWidth = 1.3;   // m
constexpr double kPartition = 0.12;  // m, thickness of an office's walls

/// Of an office: between two walls across it, with a door to the corridor.
struct Room {
  double side = 1.0;  ///< of the corridor, in y
  double x0 = 0.0, x1 = 0.0;
  double door = 0.0;  ///< x of its middle
};

/// A corridor along x in the middle of a floor, and rooms on both sides.
struct Office {
  double corridor = 0.0;  ///< half its width
  double depth = 0.0;     ///< of the rooms
  double height = 0.0;
  double door_height = 0.0;
  std::vector<Room> rooms;

  /// y of a place that far into a room on that side.
  [[nodiscard]] double inside(double side, double far) const { return side * (corridor + kPartition + far); }
};

Office random_office(RandomStream& random, double length) {
  Office office;
  office.corridor = 0.5 * random.uniform(2.0, 2.8);
  office.depth = random.uniform(4.0, 5.5);
  office.height = random.uniform(2.6, 3.0);
  office.door_height = random.uniform(2.1, 2.2);
  for (const double side : {-1.0, 1.0}) {
    const auto count = static_cast<int>(length / random.uniform(4.2, 6.5));
    for (int i = 0; i < count; ++i) {
      const double x0 = length * i / count;
      const double x1 = length * (i + 1) / count;
      office.rooms.push_back({side, x0, x1, random.uniform(x0 + 1.0, x1 - 1.0)});
    }
  }
  return office;
}

/// The wall between the corridor and its rooms on one side: what the doors leave of it.
void add_corridor_wall(config::Scenario& scenario, const Office& office, double side, double length) {
  const double y0 = side < 0.0 ? -office.corridor - kPartition : office.corridor;
  const double y1 = y0 + kPartition;
  double x = 0.0;
  for (const Room& room : office.rooms) {
    if (room.side != side) continue;
    const double low = room.door - 0.5 * kDoorWidth;
    const double high = room.door + 0.5 * kDoorWidth;
    scenario.map.push_back(block({x, y0, 0.0}, {low, y1, office.height}));
    scenario.map.push_back(block({low, y0, office.door_height}, {high, y1, office.height}));
    x = high;
  }
  scenario.map.push_back(block({x, y0, 0.0}, {length, y1, office.height}));
}

/// The wall to the next room, a desk at the far wall and a cupboard in a corner.
void furnish(config::Scenario& scenario, RandomStream& random, const Office& office, const Room& room) {
  const auto add = [&](double x0, double x1, double near, double far, double height) {
    const double a = office.inside(room.side, near);
    const double b = office.inside(room.side, far);
    scenario.map.push_back(block({x0, std::min(a, b), 0.0}, {x1, std::max(a, b), height}));
  };
  if (room.x0 > 0.0) add(room.x0 - 0.5 * kPartition, room.x0 + 0.5 * kPartition, 0.0, office.depth, office.height);
  const double x = random.uniform(room.x0 + 0.1, room.x1 - 1.8);
  add(x, x + 1.6, office.depth - 0.8, office.depth, random.uniform(0.7, 0.8));
  if (random.below(2) == 0) return;
  const double corner = random.below(2) == 0 ? room.x0 + 0.1 : room.x1 - 0.6;
  add(corner, corner + 0.5, office.depth - 1.8, office.depth - 0.9, random.uniform(1.4, 2.0));
}

/// In a room, where there is no furniture.
Vec3 random_spot(RandomStream& random, const Office& office, const Room& room) {
  const double x = random.uniform(room.x0 + 1.3, room.x1 - 1.3);
  return {x, office.inside(room.side, random.uniform(1.3, office.depth - 1.9)), random.uniform(1.2, 1.6)};
}

/// From a spot in one room to one in another, through both doors and along the corridor.
std::vector<Stop> way_between(RandomStream& random, const Office& office, const Room& from, const Room& to) {
  const double lane = random.uniform(-0.5, 0.5) * office.corridor;
  const auto at_door = [&](const Room& room) { return Vec3(room.door, office.inside(room.side, 0.6), 0.0); };
  const Vec3 first = random_spot(random, office, from);
  const Vec3 last = random_spot(random, office, to);
  const double waits = random.uniform(0, 6);
  return {{first, waits},
          {at_door(from), 0.0},
          {{from.door, lane, 0.0}, random.uniform(0, 1)},
          {{to.door, lane, 0.0}, 0.0},
          {at_door(to), 0.0},
          {last, random.uniform(1, 6)}};
}

const Room& random_room(RandomStream& random, const Office& office) {
  return office.rooms[random.below(office.rooms.size())];
}

}  // namespace

// From a room to another one far away.
void build_office(config::Scenario& scenario, RandomStream& random) {
  const double length = random.uniform(22, 36);
  const Office office = random_office(random, length);
  const double half = office.inside(1.0, office.depth);
  do {
    scenario.start = random_spot(random, office, random_room(random, office));
    scenario.target = random_spot(random, office, random_room(random, office));
  } while ((scenario.target - scenario.start).norm() < 15.0);
  scenario.world = planner::base::Box{{0, -half, kLowest}, {length, half, office.height}};
  add_shell(scenario);
  for (const double side : {-1.0, 1.0}) add_corridor_wall(scenario, office, side, length);
  for (const Room& room : office.rooms) furnish(scenario, random, office, room);
  add_walkers(scenario, random, random_count(random, 1, 4), [&] {
    const Room& from = random_room(random, office);
    return way_between(random, office, from, random_room(random, office));
  });
  turn_quarters(scenario, random);
}

namespace {

/// A panel that slides along y in front of an opening of a wall at x, on the side of smaller x where `before`. It
/// overlaps the wall by a little where it is shut.
void add_panel(config::Scenario& scenario, double x, bool before, const Opening& opening, double slide,
               const DoorTimes& times) {
  constexpr double kThick = 0.06;  // m
  constexpr double kOff = 0.03;    // m, off the wall
  constexpr double kLap = 0.05;    // m
  const double middle = before ? x - kOff - 0.5 * kThick : x + kOff + 0.5 * kThick;
  const Vec3 shut(middle, opening.middle, 0.5 * (opening.height + kLap));
  scenario.obstacles.push_back({config::BoxShape{{kThick, opening.width + 2.0 * kLap, opening.height + kLap}},
                                opens_and_shuts(shut, shut + slide * Vec3::UnitY(), times)});
}

/// Two panels that part in the middle.
void add_lift_door(config::Scenario& scenario, double x, bool before, const Opening& opening, const DoorTimes& times) {
  for (const double side : {-1.0, 1.0}) {
    constexpr double kLeft = 0.06;  // m, of the lap on the wall and the gap in the middle
    const Opening leaf{opening.middle + side * (0.25 * opening.width + kLeft), 0.5 * opening.width, opening.height};
    add_panel(scenario, x, before, leaf, side * 0.5 * opening.width, times);
  }
}

DoorTimes random_lift_times(RandomStream& random) {
  DoorTimes times{random.uniform(4, 8), random.uniform(6, 10), random.uniform(1.2, 2.2), 0.0};
  times.first = random.uniform(0.0, times.shut + times.open);
  return times;
}

/// From one place of a hall's part to another, level.
std::vector<Stop> across(RandomStream& random, double x0, double x1, double half_width) {
  const auto any = [&] {
    const double wait = random.uniform(0, 4);
    return Stop{{random.uniform(x0, x1), random.uniform(-half_width, half_width), 0.0}, wait};
  };
  return {any(), any(), any()};
}

}  // namespace

// Through a lift that has a door to either side; one waits in it for the other where they are not open at a time.
void build_lift_door(config::Scenario& scenario, RandomStream& random) {
  const double half = 0.5 * random.uniform(6, 9);
  const double height = random.uniform(2.6, 3.2);
  const double front = random.uniform(8, 12);
  const double back = front + random.uniform(2.6, 3.6);
  const double length = back + random.uniform(8, 12);
  const double y = random.uniform(-1, 1);
  const double cabin = 0.5 * random.uniform(2.2, 3.0);
  const Opening opening{y, random.uniform(1.3, 1.7), random.uniform(2.1, 2.3)};
  scenario.start = {random.uniform(1, 1.5), random.uniform(1 - half, half - 1), random.uniform(1.2, 1.6)};
  scenario.target = {length - random.uniform(1, 1.5), random.uniform(1 - half, half - 1), random.uniform(1.2, 1.6)};
  scenario.world = planner::base::Box{{0, -half, kLowest}, {length, half, height}};
  add_shell(scenario);
  constexpr double kFrame = 0.15;  // m, thickness of the cabin's walls
  add_wall_with(scenario, {front, front + kFrame, -half, half, height}, opening);
  add_wall_with(scenario, {back - kFrame, back, -half, half, height}, opening);
  scenario.map.push_back(block({front + kFrame, -half, 0.0}, {back - kFrame, y - cabin, height}));
  scenario.map.push_back(block({front + kFrame, y + cabin, 0.0}, {back - kFrame, half, height}));
  add_lift_door(scenario, front, true, opening, random_lift_times(random));
  add_lift_door(scenario, back, false, opening, random_lift_times(random));
  const int count = random_count(random, 0, 2);
  add_walkers(scenario, random, count, [&] { return across(random, 0.5, front - 0.7, half - 0.5); });
  turn_quarters(scenario, random);
}

namespace {

/// A forklift of so much room along an axis, to and fro between two places of an aisle.
void add_forklift(config::Scenario& scenario, RandomStream& random, const Vec3& from, const Vec3& to) {
  constexpr double kLong = 2.4, kWide = 1.1, kHigh = 2.1;  // m
  const bool along_y = from.y() != to.y();
  const Vec3 edges = along_y ? Vec3(kWide, kLong, kHigh) : Vec3(kLong, kWide, kHigh);
  const Vec3 up = 0.5 * kHigh * Vec3::UnitZ();
  const Stop first{from + up, random.uniform(2, 6)};
  const Stop last{to + up, random.uniform(2, 6)};
  const double begin = random.uniform(0, 5);
  scenario.obstacles.push_back(
      {config::BoxShape{edges}, there_and_back({first, last}, random.uniform(1.2, 2.5), begin)});
}

}  // namespace

// Rows of racks across the way, each with a passage, and an aisle round them.
void build_racks(config::Scenario& scenario, RandomStream& random) {
  constexpr double kRack = 1.1;   // m, depth of a row
  constexpr double kFront = 3.6;  // m, to the first row and from the last
  const double half = 0.5 * random.uniform(14, 20);
  const double height = random.uniform(5.5, 8);
  const double aisle = random.uniform(2.4, 3.2);
  const double end = random.uniform(2.2, 2.8);  // width of the aisles at the rows' ends
  const int rows = random_count(random, 4, 7);
  const double length = 2 * kFront + rows * kRack + (rows - 1) * aisle;
  scenario.start = {random.uniform(1, 1.6), random.uniform(4.5 - half, half - 4.5), random.uniform(1.2, 2.5)};
  scenario.target = {length - random.uniform(1, 1.6), random.uniform(4.5 - half, half - 4.5), random.uniform(1.2, 2.5)};
  scenario.world = planner::base::Box{{0, -half, kLowest}, {length, half, height}};
  add_shell(scenario);
  for (int row = 0; row < rows; ++row) {
    const double x = kFront + row * (kRack + aisle);
    const Opening passage{random.uniform(3 + end - half, half - 3 - end), random.uniform(1.8, 2.6),
                          random.uniform(2.2, 2.8)};
    add_wall_with(scenario, {x, x + kRack, end - half, half - end, height - random.uniform(0.4, 2.5)}, passage);
  }
  const double side = random.below(2) == 0 ? 1.0 : -1.0;
  const double y = side * (half - 0.5 * end);
  add_forklift(scenario, random, {2.0, y, 0.0}, {length - 2.0, y, 0.0});
  if (random.below(2) == 0) {
    const double x = kFront + kRack + 0.5 * aisle;
    add_forklift(scenario, random, {x, side * (half - end - 1.5), 0.0}, {x, -side * (half - end - 1.5), 0.0});
  }
  const int count = random_count(random, 1, 3);
  add_walkers(scenario, random, count, [&] {
    const auto gap = static_cast<double>(random.below(static_cast<std::uint64_t>(rows) - 1));
    const double x = kFront + kRack + gap * (kRack + aisle) + random.uniform(0.6, aisle - 0.6);
    const double out = -side * (half - 0.5 * end);
    const double along = random.uniform(2, length - 2);
    return std::vector<Stop>{
        {{x, random.uniform(3 - half, half - 3), 0.0}, 2.0}, {{x, out, 0.0}, 0.0}, {{along, out, 0.0}, 3.0}};
  });
  turn_quarters(scenario, random);
}

namespace {

/// A forklift that drives through the gate each time that it is open, there and back again.
void add_drive_through(config::Scenario& scenario, RandomStream& random, double gate, double y,
                       const DoorTimes& times) {
  constexpr double kAway = 4.0;  // m, from the gate, where it waits
  const Vec3 edges{2.4, 1.1, 2.0};
  const double speed = random.uniform(1.5, 2.5);
  Vec3 here(gate - kAway, y, 0.5 * edges.z());
  Vec3 there(gate + kAway, y, 0.5 * edges.z());
  config::WaypointsMotion motion;
  for (double t = times.first; t < kBusy; t += times.open + times.shut + 2.0 * times.moving) {
    const double sets_out = t + times.moving + 0.5;
    motion.times.insert(motion.times.end(), {sets_out, sets_out + 2.0 * kAway / speed});
    motion.points.insert(motion.points.end(), {here, there});
    std::swap(here, there);
  }
  scenario.obstacles.push_back({config::BoxShape{edges}, motion});
}

}  // namespace

// A hall that a wall parts from side to side, with a gate that slides along it.
void build_sliding_gate(config::Scenario& scenario, RandomStream& random) {
  constexpr double kWall = 0.2;  // m, its thickness
  const double half = 0.5 * random.uniform(14, 20);
  const double height = random.uniform(3.2, 5);
  const double length = random.uniform(19, 32);
  const double gate = random.uniform(8, length - 8);
  const Opening opening{random.uniform(-1.5, 1.5), random.uniform(2.4, 4.0), random.uniform(2.3, 3.0)};
  scenario.start = {random.uniform(1, 1.5), random.uniform(1.5 - half, half - 1.5), random.uniform(1.2, 2)};
  scenario.target = {length - random.uniform(1, 1.5), random.uniform(1.5 - half, half - 1.5), random.uniform(1.2, 2)};
  scenario.world = planner::base::Box{{0, -half, kLowest}, {length, half, height}};
  add_shell(scenario);
  add_wall_with(scenario, {gate, gate + kWall, -half, half, height}, opening);
  DoorTimes times{random.uniform(5, 10), random.uniform(8, 15), opening.width / random.uniform(0.6, 1.2), 0.0};
  times.first = random.uniform(0.0, times.shut + times.open);
  const double slide = opening.middle > 0.0 ? -opening.width : opening.width;
  add_panel(scenario, gate, true, opening, slide, times);
  if (random.below(2) == 0) add_drive_through(scenario, random, gate, opening.middle, times);
  for (int count = random_count(random, 0, 4); count > 0; --count) {
    const double x = random.uniform(3.5, length - 3.5);
    const double aside = random.uniform(3.0, half - 1.0);
    const Vec3 place(x, random.below(2) == 0 ? aside : -aside, 0.0);
    if (std::abs(x - gate) < 2.0) continue;
    const double edge = 0.5 * random.uniform(0.8, 1.2);
    scenario.map.push_back(block(place - Vec3(edge, edge, 0), place + Vec3(edge, edge, random.uniform(0.8, 2.5))));
  }
  const int people = random_count(random, 0, 3);
  add_walkers(scenario, random, people, [&] {
    const bool behind = random.below(2) == 0;
    return across(random, behind ? gate + 0.8 : 0.5, behind ? length - 0.5 : gate - 0.8, half - 0.5);
  });
  turn_quarters(scenario, random);
}

}  // namespace jink::sim::families
