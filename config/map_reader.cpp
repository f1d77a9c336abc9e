// SPDX-License-Identifier: BSD-3-Clause
#include "config/map_reader.hpp"

#include <iterator>
#include <string>
#include <utility>

#include "config/obstacle_reader.hpp"
#include "config/octomap.hpp"
#include "config/solids.hpp"
#include "planner/geometry/polygon.hpp"

namespace jink::config {
namespace {

constexpr std::size_t kMostSolids = 100'000;
constexpr std::size_t kMostCorners = 1000;

std::vector<Obstacle> read_solids(const Value& list) {
  std::vector<Obstacle> solids;
  for (const Value& item : list.list(0, kMostSolids)) solids.push_back(read_solid_at_rest(item));
  return solids;
}

std::vector<Obstacle> read_map_file(const Value& name, const std::filesystem::path& file) {
  const std::filesystem::path map = file.parent_path() / name.text();
  std::error_code ignored;
  if (!std::filesystem::exists(map, ignored)) name.fail("is no file: expected one from " + file.string() + " on");
  return is_octomap(map) ? load_octomap(map, kMostSolids) : read_solids(read_document(map));
}

std::vector<Obstacle> read_zone(const Value& value) {
  const Map map(value, {"polygon", "min", "max"});
  const Value polygon = map.at("polygon", "a list of [x, y]");
  std::vector<planner::geometry::Vec2> corners;
  for (const Value& corner : polygon.list(3, kMostCorners)) {
    const std::vector<Value> numbers = corner.list(2, 2);
    corners.emplace_back(numbers[0].number(kCoordinate), numbers[1].number(kCoordinate));
  }
  if (!planner::geometry::is_simple(corners))
    polygon.fail("crosses or touches itself; expected corners in their order around one area");
  const double min = map.number("min", kCoordinate);
  const double max = map.number("max", kCoordinate);
  if (max <= min) map.at("max", "").fail("is not above min; not in " + above(min, kCoordinate.max).text());
  return prisms(corners, min, max);
}

}  // namespace

std::vector<Obstacle> read_map(const Map& keys, const std::filesystem::path& file) {
  std::vector<Obstacle> solids;
  if (const auto map = keys.find("map")) solids = map->is_list() ? read_solids(*map) : read_map_file(*map, file);
  if (const auto zones = keys.find("no_fly")) {
    for (const Value& zone : zones->list(0, kMostSolids)) {
      std::vector<Obstacle> pieces = read_zone(zone);
      std::move(pieces.begin(), pieces.end(), std::back_inserter(solids));
      if (solids.size() > kMostSolids) zone.fail("is one too many; expected at most 100000 solids");
    }
  }
  return solids;
}

}  // namespace jink::config
