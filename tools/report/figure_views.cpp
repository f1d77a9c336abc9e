// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <variant>

#include "planner/geometry/obstacle_motion.hpp"
#include "tools/report/convex_hull.hpp"
#include "tools/report/figure_parts.hpp"
#include "tools/report/shape_corners.hpp"

namespace jink::tools::report {
namespace {

using jink::tools::figures::Kind;
using jink::tools::figures::Look;
using jink::tools::figures::Panel;
using jink::tools::figures::Series;

constexpr double kPad = 2.0;         // m, before and behind the flown way
constexpr double kBeside = 3.5;      // m, beside it
constexpr double kTrail = 2.0;       // s, of an obstacle's way before and after the instant
constexpr double kAheadStep = 0.1;   // s
constexpr double kMostExtent = 1e5;  // m; nothing that flies a log's length goes further
constexpr std::string_view kMapEdge = "#8d8f86";
constexpr std::array<const char*, 3> kAxes{"East (m)", "North (m)", "Up (m)"};

std::string text_of(std::string_view text) {
  return std::string(text);
}
Vec3 vector(const Triple& v) {
  return {v[0], v[1], v[2]};
}
Triple triple(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

/// A series of places as one view shows them.
class Drawing {
 public:
  Drawing(const FigureScale& scale, bool from_above, std::string label, Kind kind, Look look)
      : scale_(scale), up_(from_above ? 1 - scale.across : 2) {
    series_.label = std::move(label);
    series_.kind = kind;
    series_.look = std::move(look);
  }

  void add(const Triple& p) { put(p[scale_.across], p[up_]); }
  void gap() { put(kNone, kNone); }
  void add_way(const std::vector<MotionSample>& motion) {
    double last = -std::numeric_limits<double>::infinity();
    for (const MotionSample& sample : motion) {
      if (sample.t - last > kMissing) gap();
      add(sample.position);
      last = sample.t;
    }
    gap();
  }
  void add_disc(const Triple& centre, double radius) {
    constexpr int kCorners = 48;
    for (int i = 0; i <= kCorners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kCorners;
      put(centre[scale_.across] + radius * std::cos(angle), centre[up_] + radius * std::sin(angle));
    }
    gap();
  }
  /// The silhouette of a solid with these corners.
  void add_outline(const std::vector<Triple>& corners) {
    std::vector<Vec3> seen;
    for (const Triple& p : corners) seen.emplace_back(p[scale_.across], p[up_], 0.0);
    std::vector<std::size_t> ring = hull_ring(seen, Vec3::UnitZ());
    ring.push_back(ring.front());
    for (const std::size_t i : ring) put(seen[i].x(), seen[i].y());
    gap();
  }
  /// Into the panel, where there is anything to draw.
  void add_to(Panel& panel) && {
    const auto drawn = [](double y) { return std::isfinite(y); };
    if (std::any_of(series_.y.begin(), series_.y.end(), drawn)) panel.series.push_back(std::move(series_));
  }

 private:
  void put(double x, double y) {
    const bool finite = std::isfinite(x) && std::isfinite(y);
    series_.x.push_back(finite ? x : kNone);
    series_.y.push_back(finite ? y : kNone);
  }

  const FigureScale& scale_;
  std::size_t up_;
  Series series_{};
};

/// One view while it is filled, from what lies below to what lies on top.
struct View {
  const FigureFlight& flight;
  const FigureScale& scale;
  bool from_above = true;
  Panel panel{};

  [[nodiscard]] Drawing drawing(std::string label, Kind kind, Look look) const {
    return {scale, from_above, std::move(label), kind, std::move(look)};
  }
  [[nodiscard]] double metres(double mm) const { return mm / scale.scale; }
  /// Text above a place, or below it, where that is in the view.
  void note(const Triple& p, std::string text, double above) {
    const std::size_t a = scale.across, u = from_above ? 1 - a : 2;
    if (p[a] < scale.low[a] || p[a] > scale.high[a] || p[u] < scale.low[u] || p[u] > scale.high[u]) return;
    panel.notes.push_back({.x = p[a], .y = p[u], .text = std::move(text), .above = above});
  }
};

template <typename Sample>
const Sample* newest(const std::vector<Sample>& samples, double t) {
  const auto next = std::upper_bound(samples.begin(), samples.end(), t + 1e-9,
                                     [](double time, const Sample& s) { return time < s.t; });
  return next == samples.begin() ? nullptr : &*std::prev(next);
}

/// The corners of an obstacle that is no sphere; none of one that is.
std::vector<Triple> corners_of(const FlightData& flight, const Body& body, double t) {
  std::vector<Triple> corners;
  const auto shape = flight.shapes.find(body.id);
  if (shape == flight.shapes.end()) return corners;
  for (const Vec3& corner : shape_corners(shape->second, t)) corners.push_back(triple(vector(body.position) + corner));
  return corners;
}

/// What stands by a map, if any, as far as it is in view.
void add_map(View& view, const planner::geometry::StaticMap* map, const char* label, std::string_view colour) {
  if (map == nullptr) return;
  const auto &low = view.scale.low, &high = view.scale.high;
  const Vec3 up(0.0, 0.0, view.flight.data.map_up);
  Drawing solids = view.drawing(label, Kind::areas,
                                {.colour = text_of(colour), .width = 0.5, .edge = text_of(kMapEdge), .opacity = 0.4});
  for (std::size_t i = 0; i < map->tracks().size(); ++i) {
    const planner::base::Box& box = map->box(i);
    const auto is_in_view = [&](std::size_t k) {
      const auto axis = static_cast<Eigen::Index>(k);
      return box.min[axis] + up[axis] <= high[k] && box.max[axis] + up[axis] >= low[k];
    };
    if (!is_in_view(view.scale.across) || !is_in_view(view.from_above ? 1 - view.scale.across : 2)) continue;
    const planner::base::Track& track = map->tracks()[i];
    if (track.body.solid == nullptr) {
      solids.add_disc(triple(track.position + up), track.radius);
      continue;
    }
    std::vector<Triple> corners;
    for (const Vec3& corner : solid_corners(*track.body.solid)) corners.push_back(triple(track.position + up + corner));
    solids.add_outline(corners);
  }
  std::move(solids).add_to(view.panel);
}

/// Where each obstacle was shortly before the instant and will be shortly after it.
void add_trails(View& view) {
  std::map<std::uint64_t, std::vector<Triple>> trails;
  for (const BodyFrame& frame : view.flight.data.obstacles) {
    if (std::abs(frame.t - view.flight.at) > kTrail) continue;
    for (const Body& body : frame.bodies) trails[body.id].push_back(body.position);
  }
  Drawing ways =
      view.drawing("its way, 2 s each way", Kind::line, {.colour = text_of(FigureColors::kObstacle), .width = 1.0});
  for (const auto& [id, trail] : trails) {
    for (const Triple& p : trail) ways.add(p);
    ways.gap();
  }
  std::move(ways).add_to(view.panel);
}

void add_obstacles(View& view) {
  const BodyFrame* frame = newest(view.flight.data.obstacles, view.flight.at);
  if (frame == nullptr) return;
  std::vector<Body> bodies = frame->bodies;  // from far to near
  const std::size_t depth = view.from_above ? 2 : 1 - view.scale.across;
  const double sign = !view.from_above && view.scale.across == 0 ? -1.0 : 1.0;
  std::stable_sort(bodies.begin(), bodies.end(),
                   [&](const Body& a, const Body& b) { return sign * a.position[depth] < sign * b.position[depth]; });
  Drawing shapes = view.drawing("obstacle", Kind::areas,
                                {.colour = text_of(FigureColors::kObstacle), .width = 0.7, .edge = "#7a5510"});
  for (const Body& body : bodies) {
    const std::vector<Triple> corners = corners_of(view.flight.data, body, frame->t);
    if (corners.empty())
      shapes.add_disc(body.position, body.radius);
    else
      shapes.add_outline(corners);
  }
  std::move(shapes).add_to(view.panel);
}

/// The predictions, and the obstacles as they are tracked where no more is known of them.
void add_tracks(View& view) {
  const BodyFrame* frame = newest(view.flight.data.tracks, view.flight.at);
  if (frame == nullptr) return;
  const PlanRecord* plan = view.flight.plan();
  const double trust = plan == nullptr ? 0.0 : plan->acceleration_trust;
  Drawing discs = view.drawing("obstacle, as tracked", Kind::areas,
                               {.colour = text_of(FigureColors::kObstacle),
                                .width = 0.7,
                                .edge = text_of(FigureColors::kTrack),
                                .opacity = 0.5});
  Drawing ahead = view.drawing("prediction, 2 s", Kind::line,
                               {.colour = text_of(FigureColors::kTrack), .width = 1.1, .dashes = "(16,9)"});
  for (const Body& body : frame->bodies) {
    const planner::base::Track track{.position = vector(body.position),
                                     .velocity = vector(body.velocity),
                                     .acceleration = vector(body.acceleration),
                                     .radius = body.radius,
                                     .age = body.age};
    for (double s = 0.0; s <= kTrail; s += kAheadStep)
      ahead.add(triple(planner::geometry::predict_position(track, s, trust)));
    ahead.gap();
    if (view.flight.data.obstacles.empty()) discs.add_disc(body.position, body.radius);
  }
  std::move(discs).add_to(view.panel);
  std::move(ahead).add_to(view.panel);
}

/// The plan from where it is at the instant.
void add_plan(View& view) {
  const PlanRecord* plan = view.flight.plan();
  if (plan == nullptr) return;
  const double at = view.flight.at;
  const bool blocked = is_blocked(*plan);
  Drawing path = view.drawing(blocked ? "plan, blocked" : "plan", Kind::line,
                              {.colour = text_of(blocked ? FigureColors::kBlocked : FigureColors::kPlan),
                               .width = 2.4,
                               .dashes = blocked ? "(16,6)" : "solid"});
  bool begun = false;
  for (std::size_t i = 0; i < plan->path.size(); ++i) {
    const auto& [t, x, y, z] = plan->path[i];
    if (t < at) continue;
    if (!begun && i > 0 && t > plan->path[i - 1][0]) {
      const auto& before = plan->path[i - 1];
      const double share = (at - before[0]) / (t - before[0]);
      path.add({before[1] + share * (x - before[1]), before[2] + share * (y - before[2]),
                before[3] + share * (z - before[3])});
    }
    path.add({x, y, z});
    begun = true;
  }
  std::move(path).add_to(view.panel);
}

/// The way round what stands that the plan was led along.
void add_way(View& view) {
  const PlanRecord* plan = view.flight.plan();
  if (plan == nullptr || plan->way.empty() || plan->path.empty()) return;
  Drawing way =
      view.drawing("guide", Kind::line, {.colour = text_of(FigureColors::kPlan), .width = 1.1, .dashes = "(4,8)"});
  const auto& [t, x, y, z] = plan->path.front();
  way.add({x, y, z});
  for (const Triple& place : plan->way) way.add(place);
  std::move(way).add_to(view.panel);
}

/// Dots along the flown way, a round number of seconds apart.
void add_clock(View& view) {
  const std::vector<MotionSample>& motion = view.flight.motion();
  const double length = motion.back().t - motion.front().t;
  if (!(length > 0.0)) return;
  const double step = jink::tools::figures::round_step(length, 8.0);
  Drawing dots =
      view.drawing("", Kind::areas, {.colour = "#ffffff", .width = 1.0, .edge = text_of(FigureColors::kFlown)});
  for (double n = std::ceil(motion.front().t / step); n * step <= motion.back().t; ++n) {
    const MotionSample* sample = newest(motion, n * step);
    if (sample == nullptr) continue;
    dots.add_disc(sample->position, view.metres(0.55));
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%g s", n * step);
    if (view.from_above) view.note(sample->position, text.data(), 2.0);
  }
  std::move(dots).add_to(view.panel);
}

void add_ends(View& view) {
  Drawing marks = view.drawing("", Kind::points, {.colour = "#1c2530", .width = 1.5, .mark = 12, .mark_size = 1.4});
  for (const char* key : {"start", "target"}) {
    const auto found = view.flight.data.header.find(key);
    if (found == view.flight.data.header.end() || !found->is_array() || found->size() != 3) continue;
    Triple p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = (*found)[k].is_number() ? (*found)[k].get<double>() : 0.0;
    marks.add(p);
    view.note(p, key, -3.0);
  }
  std::move(marks).add_to(view.panel);
}

void add_vehicle(View& view, const std::vector<MotionSample>& motion, std::uint64_t number, std::string_view colour) {
  const MotionSample* sample = newest(motion, view.flight.at);
  if (sample == nullptr) return;
  Drawing disc = view.drawing("", Kind::areas, {.colour = text_of(colour), .width = 0.8, .edge = "#ffffff"});
  disc.add_disc(sample->position, std::max(view.metres(0.6), vehicle_radius(view.flight.data, number).value_or(0.0)));
  std::move(disc).add_to(view.panel);
}

}  // namespace

const PlanRecord* FigureFlight::plan() const {
  return newest(data.plans, at);
}

FigureScale figure_scale(const FigureFlight& flight, double width, double height) {
  FigureScale s;
  bool any = false;
  const auto include = [&](const Triple& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = std::clamp(p[k], -kMostExtent, kMostExtent);
      s.low[k] = any ? std::min(s.low[k], x) : x;
      s.high[k] = any ? std::max(s.high[k], x) : x;
    }
    any = true;
  };
  for (const MotionSample& sample : flight.motion()) include(sample.position);
  for (const OtherVehicle& other : flight.data.others) {
    for (const MotionSample& sample : other.truth) include(sample.position);
  }
  if (const PlanRecord* plan = flight.plan()) {
    for (const auto& [t, x, y, z] : plan->path) include({x, y, z});
  }
  s.across = s.high[1] - s.low[1] > 1.3 * (s.high[0] - s.low[0]) ? 1 : 0;
  const std::size_t down = 1 - s.across;
  s.low[s.across] -= kPad;
  s.high[s.across] += kPad;
  s.low[down] -= kBeside;
  s.high[down] += kBeside;
  s.low[2] = std::min(s.low[2] - 0.5, 0.0);
  s.high[2] += 1.0;
  s.scale = std::min({width / (s.high[s.across] - s.low[s.across]), height / (s.high[down] - s.low[down]),
                      height / (s.high[2] - s.low[2])});
  const double spare = width / s.scale - (s.high[s.across] - s.low[s.across]);
  s.low[s.across] -= 0.5 * spare;
  s.high[s.across] += 0.5 * spare;
  return s;
}

double view_height(const FigureScale& scale, bool from_above) {
  const std::size_t k = from_above ? 1 - scale.across : 2;
  return (scale.high[k] - scale.low[k]) * scale.scale;
}

Panel view_panel(const FigureFlight& flight, const FigureScale& scale, bool from_above,
                 const jink::tools::figures::Frame& frame) {
  View view{flight, scale, from_above};
  Panel& panel = view.panel;
  const std::size_t a = scale.across, u = from_above ? 1 - a : 2;
  panel.frame = frame;
  panel.x_range = {scale.low[a], scale.high[a]};
  panel.y_range = {scale.low[u], scale.high[u]};
  // Where north runs across, east runs down: so it is seen from above and not from below.
  if (from_above && a == 1) std::swap(panel.y_range->first, panel.y_range->second);
  panel.y_label = kAxes[u];
  panel.x_numbers = !from_above;
  panel.y_step = jink::tools::figures::round_step(scale.high[u] - scale.low[u], std::max(2.0, frame.height / 9.0));
  if (!from_above) panel.x_label = kAxes[a];
  add_map(view, flight.data.map.get(), "map", FigureColors::kMap);
  add_map(view, seen_at(flight.data, flight.at), "map, as seen", FigureColors::kSeen);
  add_trails(view);
  add_obstacles(view);
  add_tracks(view);
  Drawing others = view.drawing("other vehicles", Kind::line, {.colour = text_of(FigureColors::kOther), .width = 1.1});
  for (const OtherVehicle& other : flight.data.others) others.add_way(other.truth);
  std::move(others).add_to(panel);
  Drawing flown = view.drawing("flown", Kind::line, {.colour = text_of(FigureColors::kFlown), .width = 1.7});
  flown.add_way(flight.motion());
  std::move(flown).add_to(panel);
  add_way(view);
  add_plan(view);
  add_clock(view);
  add_ends(view);
  for (const OtherVehicle& other : flight.data.others)
    add_vehicle(view, other.truth, other.number, FigureColors::kOther);
  add_vehicle(view, flight.motion(), 0, FigureColors::kFlown);
  return std::move(view.panel);
}

}  // namespace jink::tools::report
