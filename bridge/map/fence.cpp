// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/fence.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "bridge/frames/conversions.hpp"
#include "config/solids.hpp"

namespace jink::bridge::map {
namespace {

using planner::geometry::Vec2;
using Area = std::vector<Vec2>;

// MAV_CMD_NAV_FENCE_*
constexpr std::uint32_t kReturnPoint = 5000;
constexpr std::uint32_t kPolygonInclusion = 5001;
constexpr std::uint32_t kPolygonExclusion = 5002;
constexpr std::uint32_t kCircleInclusion = 5003;
constexpr std::uint32_t kCircleExclusion = 5004;

constexpr double kWall = 1.0;          // m, thickness
constexpr int kCircleEdges = 64;       // 0.12 % of the radius are lost
constexpr double kFarthestAway = 1e5;  // m
constexpr double kLowest = -1000.0;    // m, of walls where no geofence bounds the heights
constexpr double kHighest = 10'000.0;  // m, likewise
constexpr double kBeyond = 10.0;       // m, that walls reach beyond the geofence's heights

[[noreturn]] void refuse_fence(std::size_t item, const std::string& what) {
  throw std::runtime_error("the autopilot's fence: item " + std::to_string(item) + " " + what);
}

/// Where a wall's inner face is the edge, nothing comes past a corner: there two walls touch.
void add_walls(const Area& area, double low, double high, std::vector<config::Obstacle>& solids) {
  for (std::size_t i = 0; i < area.size(); ++i) {
    const Vec2& a = area[i];
    const Vec2 edge = area[(i + 1) % area.size()] - a;
    const Vec2 out = Vec2(edge.y(), -edge.x()) / edge.norm();
    const Vec2 middle = a + 0.5 * edge + 0.5 * kWall * out;
    config::Obstacle wall{config::BoxShape{{edge.norm(), kWall, high - low}},
                          config::LinearMotion{{middle.x(), middle.y(), 0.5 * (low + high)}}};
    wall.orientation.x() = std::atan2(edge.y(), edge.x());
    solids.push_back(std::move(wall));
  }
}

bool is_inside(const Area& area, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < area.size(); ++i) {
    const Vec2& a = area[i];
    const Vec2& b = area[(i + 1) % area.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

}  // namespace

bool Fence::holds(const Vec3& p) const {
  return inside.empty() ||
         std::any_of(inside.begin(), inside.end(), [&](const Area& area) { return is_inside(area, p.head<2>()); });
}

Fence fence_of(std::span<const mavlink::MissionItem> items, const frames::Geodetic& origin, double low, double high) {
  const frames::LocalFrame frame(origin);
  const auto place = [&](std::size_t i) {
    const Vec3 p = frame.to_enu({items[i].latitude_deg, items[i].longitude_deg, origin.altitude_m});
    if (!(p.norm() <= kFarthestAway)) refuse_fence(i, "is more than 100 km from the local origin");
    return Vec2(p.x(), p.y());
  };
  Fence fence;
  for (std::size_t i = 0; i < items.size();) {
    const mavlink::MissionItem& first = items[i];
    if (first.command == kPolygonInclusion || first.command == kPolygonExclusion) {
      const double corners = first.param1;
      if (!(corners >= 3.0) || corners > static_cast<double>(items.size() - i))
        refuse_fence(i, "begins a polygon whose corners are not all there");
      Area area;
      for (const std::size_t begin = i; i < begin + static_cast<std::size_t>(corners); ++i) {
        if (items[i].command != first.command || items[i].param1 != corners)
          refuse_fence(i, "is no corner of the polygon that item " + std::to_string(begin) + " begins");
        area.push_back(place(i));
      }
      if (!planner::geometry::is_simple(area)) refuse_fence(i - 1, "ends a polygon that crosses itself");
      if (first.command == kPolygonInclusion) {
        fence.inside.push_back(planner::geometry::counter_clockwise(std::move(area)));
        continue;
      }
      ++fence.outside;
      std::vector<config::Obstacle> prisms = config::prisms(area, low, high);
      std::move(prisms.begin(), prisms.end(), std::back_inserter(fence.solids));
    } else if (first.command == kCircleInclusion || first.command == kCircleExclusion) {
      const double radius = first.param1;
      if (!(radius > 0.0 && radius <= kFarthestAway))
        refuse_fence(i, "is a circle of a radius that is not in (0, 100000]");
      const Vec2 centre = place(i++);
      if (first.command == kCircleExclusion) {
        ++fence.outside;
        fence.solids.push_back({config::CylinderShape{radius, high - low},
                                config::LinearMotion{{centre.x(), centre.y(), 0.5 * (low + high)}}});
        continue;
      }
      Area area;
      for (int k = 0; k < kCircleEdges; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / kCircleEdges;
        area.emplace_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
      }
      fence.inside.push_back(std::move(area));
    } else if (first.command == kReturnPoint) {
      ++i;
    } else {
      refuse_fence(i, "is none that a fence has: command " + std::to_string(first.command));
    }
  }
  for (const Area& area : fence.inside) add_walls(area, low, high, fence.solids);
  return fence;
}

config::Mission fenced(config::Mission mission, std::span<const mavlink::MissionItem> items,
                       const frames::Geodetic& origin) {
  const double low = std::max(mission.geofence.min.z() - kBeyond, kLowest);
  const double high = std::max(std::min(mission.geofence.max.z() + kBeyond, kHighest), low + kBeyond);
  const Fence fence = fence_of(items, origin, low, high);
  for (std::size_t i = 0; i < mission.waypoints.size(); ++i) {
    if (!fence.holds(mission.waypoints[i]))
      throw std::runtime_error("waypoint " + std::to_string(i + 1) + " is outside the autopilot's fence");
  }
  std::vector<planner::base::Track> tracks(mission.map->tracks().begin(), mission.map->tracks().end());
  for (const config::Obstacle& solid : fence.solids) tracks.push_back(config::track_at_rest(solid));
  mission.map = std::make_shared<const planner::geometry::StaticMap>(std::move(tracks));
  return mission;
}

}  // namespace jink::bridge::map
