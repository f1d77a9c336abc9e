// SPDX-License-Identifier: BSD-3-Clause
#include "tools/log/map_record.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace jink::tools::log {
namespace {

Vec3 at(const std::vector<double>& numbers, std::size_t i) {
  return {numbers[i], numbers[i + 1], numbers[i + 2]};
}

bridge::map::CellBox box_of(const Json& item) {
  constexpr double kFarthest = 1e7;  // cells
  const auto numbers = exact_numbers<6>(item, "boxes");
  if (!std::all_of(numbers.begin(), numbers.end(),
                   [](double n) { return std::abs(n) <= kFarthest && n == std::floor(n); }))
    refuse("a box of cells holds what is no number of a cell");
  const Eigen::Map<const Eigen::Array<double, 6, 1>> corners(numbers.data());
  const bridge::map::CellBox box{corners.head<3>().cast<int>(), corners.tail<3>().cast<int>()};
  if (!(box.min.array() < box.max.array()).all()) refuse("a box of cells is empty");
  return box;
}

}  // namespace

std::shared_ptr<const planner::base::Solid> solid_of(const Json& record) {
  using planner::base::Solid;
  const char* const kind = record.contains("hull") ? "hull" : "prism";
  std::vector<double> x;
  for (const Json& number : list_of(record, kind)) x.push_back(exact(number, kind));
  try {
    if (record.contains("hull")) {
      if (x.size() % 3 != 0) refuse("\"hull\" is not a list of points");
      std::vector<Vec3> vertices;
      for (std::size_t i = 0; i < x.size(); i += 3) vertices.push_back(at(x, i));
      return Solid::hull(std::move(vertices));
    }
    constexpr std::size_t kNumbers = 17;
    if (x.size() != kNumbers) refuse("\"prism\" is not a list of 17 numbers");
    Solid::Pose pose{at(x, 5), {}};
    pose.axes << at(x, 8), at(x, 11), at(x, 14);
    return Solid::prism(at(x, 0), x[3], x[4], pose);
  } catch (const std::invalid_argument& error) {
    refuse(error.what());
  }
}

std::shared_ptr<const planner::geometry::StaticMap> map_of(const Json& header, const char* key) {
  if (!header.contains(key)) return nullptr;
  std::vector<planner::base::Track> tracks;
  for (const Json& item : list_of(header, key)) {
    constexpr std::size_t kNumbers = 4;  // and a solid, where it has one
    if (!item.is_array() || item.size() != kNumbers + 1) check_list(item, key, kNumbers);
    planner::base::Track track;
    track.position = {exact(item[0], key), exact(item[1], key), exact(item[2], key)};
    track.radius = exact(item[3], key);
    if (item.size() > kNumbers) {
      if (!item[kNumbers].is_object()) refuse("\"" + std::string(key) + "\" holds a solid that is no object");
      track.body.solid = solid_of(item[kNumbers]);
    }
    tracks.push_back(std::move(track));
  }
  return std::make_shared<const planner::geometry::StaticMap>(std::move(tracks));
}

std::shared_ptr<const bridge::map::Seen> seen_of(const Json& record, const bridge::map::Seen* before,
                                                 const planner::geometry::StaticMap* known) {
  bridge::map::Seen seen;
  if (before != nullptr) seen.boxes = before->boxes;
  seen.number = count_of(record, "number");
  const auto origin = exact_numbers<3>(member(record, "origin"), "origin");
  seen.origin = {origin[0], origin[1], origin[2]};
  if (!seen.origin.allFinite()) refuse("\"origin\" is not finite");
  for (const Json& item : list_of(record, "removed")) {
    const auto gone = std::find(seen.boxes.begin(), seen.boxes.end(), box_of(item));
    if (gone == seen.boxes.end()) refuse("\"removed\" names a box that is not there");
    seen.boxes.erase(gone);
  }
  for (const Json& item : list_of(record, "added")) seen.boxes.push_back(box_of(item));
  std::sort(seen.boxes.begin(), seen.boxes.end(), bridge::map::comes_before);
  const planner::geometry::StaticMap none;
  seen.map = bridge::map::with_boxes(known != nullptr ? *known : none, seen.boxes, seen.origin);
  return std::make_shared<const bridge::map::Seen>(std::move(seen));
}

}  // namespace jink::tools::log
