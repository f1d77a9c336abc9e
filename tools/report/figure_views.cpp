// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <variant>

#include "planner/geometry/obstacle_motion.hpp"
#include "tools/report/figure_parts.hpp"

namespace jink::tools::report {
namespace {

constexpr double kPad = 2.0;         // m, before and behind the flown way
constexpr double kBeside = 3.5;      // m, beside it
constexpr double kTrail = 2.0;       // s, of an obstacle's way before and after the instant
constexpr double kAheadStep = 0.1;   // s
constexpr double kMostExtent = 1e5;  // m; nothing that flies a log's length goes further
constexpr std::string_view kSetpoint = "#a3adb8";
constexpr std::array<const char*, 3> kAxes{"east", "north", "up"};

/// A view: from metres to the sheet.
struct View {
  const FigureScale& scale;
  bool from_above = true;
  Frame frame{};

  [[nodiscard]] std::size_t down_axis() const { return from_above ? 1 - scale.across : 2; }
  /// Where north runs across, east runs down: so it is seen from above and not from below.
  [[nodiscard]] bool flipped() const { return from_above && scale.across == 1; }
  [[nodiscard]] Spot spot(const Triple& p) const {
    const std::size_t k = down_axis();
    const double above = flipped() ? p[k] - scale.low[k] : scale.high[k] - p[k];
    return {frame.x + (p[scale.across] - scale.low[scale.across]) * scale.scale, frame.y + above * scale.scale};
  }
};

Triple triple(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Vec3 vector(const Triple& v) {
  return {v[0], v[1], v[2]};
}

template <typename Sample>
const Sample* newest(const std::vector<Sample>& samples, double t) {
  const auto next = std::upper_bound(samples.begin(), samples.end(), t + 1e-9,
                                     [](double time, const Sample& s) { return time < s.t; });
  return next == samples.begin() ? nullptr : &*std::prev(next);
}

void draw_way(Canvas& canvas, const View& view, const std::vector<MotionSample>& motion, double from, double to,
              const Pen& pen) {
  std::vector<Spot> spots;
  for (const MotionSample& sample : motion) {
    if (sample.t >= from && sample.t <= to) spots.push_back(view.spot(sample.position));
  }
  canvas.line(spots, pen);
}

/// The corners of the convex hull of some spots, in order (monotone chain).
std::vector<Spot> outline(std::vector<Spot> spots) {
  std::sort(spots.begin(), spots.end());
  std::vector<Spot> ring;
  const auto add = [&](const Spot& p, std::size_t least) {
    const auto turns = [&] {
      const Spot &a = ring[ring.size() - 2], &b = ring.back();
      return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0.0;
    };
    while (ring.size() > least && turns()) ring.pop_back();
    ring.push_back(p);
  };
  for (const Spot& p : spots) add(p, 1);
  const std::size_t lower = ring.size();
  for (auto p = spots.rbegin() + 1; p != spots.rend(); ++p) add(*p, lower);
  if (ring.size() > 1) ring.pop_back();
  return ring;
}

/// The silhouette of an obstacle's true shape.
void draw_obstacle(Canvas& canvas, const View& view, const FlightData& flight, const Body& body) {
  const Pen edge{.color = "#7a5510", .width = 0.2};
  const auto shape = flight.shapes.find(body.id);
  if (shape == flight.shapes.end()) {
    canvas.circle(view.spot(body.position), body.radius * view.scale.scale, FigureColors::kObstacle, 1.0, edge);
    return;
  }
  std::vector<Spot> corners;
  const auto add = [&](const Vec3& corner) { corners.push_back(view.spot(triple(vector(body.position) + corner))); };
  if (const auto* box = std::get_if<config::BoxShape>(&shape->second)) {
    for (const unsigned i : {0U, 1U, 2U, 3U, 4U, 5U, 6U, 7U}) {
      const Vec3 side((i & 1U) != 0 ? 0.5 : -0.5, (i & 2U) != 0 ? 0.5 : -0.5, (i & 4U) != 0 ? 0.5 : -0.5);
      add(side.cwiseProduct(box->edges));
    }
  } else if (const auto* hull = std::get_if<config::VertexShape>(&shape->second)) {
    for (const Vec3& vertex : hull->vertices) add(vertex);
  }
  canvas.polygon(outline(std::move(corners)), FigureColors::kObstacle, 1.0, edge);
}

/// Where each obstacle was shortly before the instant and will be shortly after it.
void draw_trails(Canvas& canvas, const View& view, const FigureFlight& flight) {
  std::map<std::uint64_t, std::vector<Spot>> trails;
  for (const BodyFrame& frame : flight.data.obstacles) {
    if (std::abs(frame.t - flight.at) > kTrail) continue;
    for (const Body& body : frame.bodies) trails[body.id].push_back(view.spot(body.position));
  }
  for (const auto& [id, trail] : trails)
    canvas.line(trail, {.color = FigureColors::kObstacle, .width = 0.3, .opacity = 0.7});
}

void draw_tracks(Canvas& canvas, const View& view, const FigureFlight& flight) {
  const BodyFrame* frame = newest(flight.data.tracks, flight.at);
  if (frame == nullptr) return;
  const PlanRecord* plan = flight.plan();
  const double trust = plan == nullptr ? 0.0 : plan->acceleration_trust;
  const Pen pen{.color = FigureColors::kTrack, .width = 0.35, .dash = {1.0, 0.7}};
  for (const Body& body : frame->bodies) {
    const planner::base::Track track{.position = vector(body.position),
                                     .velocity = vector(body.velocity),
                                     .acceleration = vector(body.acceleration),
                                     .radius = body.radius,
                                     .age = body.age};
    std::vector<Spot> ahead;
    for (double s = 0.0; s <= kTrail; s += kAheadStep)
      ahead.push_back(view.spot(triple(planner::geometry::predict_position(track, s, trust))));
    canvas.line(ahead, pen);
    if (flight.data.obstacles.empty()) {  // all that is known of them
      const double radius = body.radius * view.scale.scale;
      canvas.circle(view.spot(body.position), radius, FigureColors::kObstacle, 0.5, pen);
    }
  }
}

void draw_plan(Canvas& canvas, const View& view, const FigureFlight& flight) {
  const PlanRecord* plan = flight.plan();
  if (plan == nullptr) return;
  std::vector<Spot> spots;
  for (std::size_t i = 0; i < plan->path.size(); ++i) {
    const auto& [t, x, y, z] = plan->path[i];
    if (t < flight.at) continue;
    if (spots.empty() && i > 0 && t > plan->path[i - 1][0]) {  // from where the plan is at the instant
      const auto& before = plan->path[i - 1];
      const double share = (flight.at - before[0]) / (t - before[0]);
      spots.push_back(view.spot({before[1] + share * (x - before[1]), before[2] + share * (y - before[2]),
                                 before[3] + share * (z - before[3])}));
    }
    spots.push_back(view.spot({x, y, z}));
  }
  const bool blocked = plan->status != "reaches" && plan->status != "progresses";
  Pen pen{.color = FigureColors::kPlan, .width = 0.9};
  if (blocked) pen = {.color = FigureColors::kBlocked, .width = 0.9, .dash = {2.0, 1.0}};
  canvas.line(spots, pen);
}

/// Dots along the flown way, a round number of seconds apart.
void draw_clock(Canvas& canvas, const View& view, const std::vector<MotionSample>& motion) {
  if (motion.size() < 2) return;
  const Ticks ticks = ticks_of(motion.front().t, motion.back().t, 8.0);
  for (const double t : ticks.values) {
    const MotionSample* sample = newest(motion, t);
    if (sample == nullptr) continue;
    const Spot spot = view.spot(sample->position);
    canvas.circle(spot, 0.55, "#ffffff", 1.0, {.color = FigureColors::kFlown, .width = 0.3});
    if (view.from_above)
      canvas.text({spot[0], spot[1] - 2.2}, ticks.text(t) + " s", {.size = 2.0, .align = Align::kCentre, .halo = true});
  }
}

void draw_ends(Canvas& canvas, const View& view, const FlightData& flight) {
  for (const char* key : {"start", "target"}) {
    const auto found = flight.header.find(key);
    if (found == flight.header.end() || !found->is_array() || found->size() != 3) continue;
    Triple p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = (*found)[k].is_number() ? (*found)[k].get<double>() : 0.0;
    const Spot s = view.spot(p);
    const std::array<Spot, 4> diamond{{{s[0], s[1] - 1.1}, {s[0] + 1.1, s[1]}, {s[0], s[1] + 1.1}, {s[0] - 1.1, s[1]}}};
    canvas.polygon(diamond, "#ffffff", 1.0, {.width = 0.4});
    canvas.text({s[0], s[1] + 2.9}, key, {.size = 2.3, .align = Align::kCentre, .halo = true});
  }
}

void draw_axes(Canvas& canvas, const View& view) {
  const FigureScale& s = view.scale;
  const Frame& f = view.frame;
  const std::size_t a = s.across, d = view.down_axis();
  const Pen grid{.color = "#dde3e9", .width = 0.15};
  const TextStyle small{.size = 2.3, .align = Align::kCentre, .color = "#45525f"};
  const Ticks across = ticks_of(s.low[a], s.high[a], f.width / 16.0);
  for (const double v : across.values) {
    const double x = f.x + (v - s.low[a]) * s.scale;
    canvas.line(std::array<Spot, 2>{{{x, f.y}, {x, f.y + f.height}}}, grid);
    if (!view.from_above) canvas.text({x, f.y + f.height + 2.2}, across.text(v), small);
  }
  const Ticks down = ticks_of(s.low[d], s.high[d], std::max(2.0, f.height / 9.0));
  for (const double v : down.values) {
    Triple p = s.low;
    p[d] = v;
    const double y = view.spot(p)[1];
    canvas.line(std::array<Spot, 2>{{{f.x, y}, {f.x + f.width, y}}}, grid);
    canvas.text({f.x - 1.2, y}, down.text(v), {.size = 2.3, .align = Align::kRight, .color = "#45525f"});
  }
  const TextStyle name{.size = 2.5, .align = Align::kCentre};
  if (!view.from_above) canvas.text({f.x + 0.5 * f.width, f.y + f.height + 5.6}, std::string(kAxes[a]) + ", m", name);
  canvas.text({f.x - 9.0, f.y + 0.5 * f.height}, std::string(kAxes[d]) + ", m",
              {.size = 2.5, .align = Align::kCentre, .upright = true});
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

void draw_view(Canvas& canvas, const FigureFlight& flight, const FigureScale& scale, bool from_above,
               const Frame& frame) {
  const View view{scale, from_above, frame};
  draw_axes(canvas, view);
  canvas.clip(frame);
  draw_trails(canvas, view, flight);
  if (const BodyFrame* obstacles = newest(flight.data.obstacles, flight.at)) {
    std::vector<Body> bodies = obstacles->bodies;  // from far to near
    const std::size_t depth = from_above ? 2 : 1 - scale.across;
    const double sign = !from_above && scale.across == 0 ? -1.0 : 1.0;
    const auto farther = [&](const Body& a, const Body& b) {
      return sign * a.position[depth] < sign * b.position[depth];
    };
    std::stable_sort(bodies.begin(), bodies.end(), farther);
    for (const Body& body : bodies) draw_obstacle(canvas, view, flight.data, body);
  }
  draw_tracks(canvas, view, flight);
  const double first = flight.data.first, last = flight.data.last;
  for (const OtherVehicle& other : flight.data.others)
    draw_way(canvas, view, other.truth, first, last, {.color = FigureColors::kOther, .width = 0.4});
  draw_way(canvas, view, flight.motion(), first, last, {.color = FigureColors::kFlown, .width = 0.6});
  draw_plan(canvas, view, flight);
  draw_clock(canvas, view, flight.motion());
  draw_ends(canvas, view, flight.data);
  const Pen rim{.color = "#ffffff", .width = 0.25};
  const auto draw_vehicle = [&](const std::vector<MotionSample>& motion, std::uint64_t number, std::string_view color) {
    const MotionSample* sample = newest(motion, flight.at);
    if (sample == nullptr) return;
    const double radius = std::max(0.6, vehicle_radius(flight.data, number).value_or(0.0) * scale.scale);
    canvas.circle(view.spot(sample->position), radius, color, 1.0, rim);
  };
  for (const OtherVehicle& other : flight.data.others) draw_vehicle(other.truth, other.number, FigureColors::kOther);
  draw_vehicle(flight.motion(), 0, FigureColors::kFlown);
  canvas.unclip();
  canvas.box(frame, {.color = "#56626f", .width = 0.25});
}

void draw_legend(Canvas& canvas, const FigureFlight& flight, const Spot& at, double width) {
  struct Entry {
    std::string text;
    Pen pen;
    bool dot = false;
    bool present = true;
  };
  const FlightData& data = flight.data;
  const PlanRecord* plan = flight.plan();
  const bool blocked = plan != nullptr && plan->status != "reaches" && plan->status != "progresses";
  const std::array<Entry, 6> entries{{
      {"flown", {.color = FigureColors::kFlown, .width = 0.6}, false, !flight.motion().empty()},
      {"other vehicles", {.color = FigureColors::kOther, .width = 0.4}, false, !data.others.empty()},
      {blocked ? "plan, blocked" : "plan",
       blocked ? Pen{.color = FigureColors::kBlocked, .width = 0.9, .dash = {2.0, 1.0}}
               : Pen{.color = FigureColors::kPlan, .width = 0.9},
       false, plan != nullptr},
      {data.obstacles.empty() ? "obstacle, as tracked" : "obstacle, its way",
       {.color = FigureColors::kObstacle, .width = 0.3},
       true,
       !data.obstacles.empty() || !data.tracks.empty()},
      {"prediction, 2 s",
       {.color = FigureColors::kTrack, .width = 0.35, .dash = {1.0, 0.7}},
       false,
       !data.tracks.empty()},
      {"setpoint", {.color = kSetpoint, .width = 0.3}, false, !data.setpoints.empty()},
  }};
  double x = at[0];
  for (const Entry& entry : entries) {
    if (!entry.present || x > at[0] + width) continue;
    canvas.line(std::array<Spot, 2>{{{x, at[1]}, {x + 7.0, at[1]}}}, entry.pen);
    if (entry.dot) canvas.circle({x + 3.5, at[1]}, 1.1, entry.pen.color, 1.0, {.color = "#7a5510", .width = 0.2});
    const TextStyle style{.size = 2.4};
    canvas.text({x + 8.2, at[1]}, entry.text, style);
    x += 8.2 + canvas.text_width(entry.text, style) + 5.0;
  }
}

}  // namespace jink::tools::report
