// SPDX-License-Identifier: BSD-3-Clause
// A flight for a world whose future is known: find_flight() of judge.hpp.
//
// A state is a place on a grid of a quarter of a metre and a velocity of whole metres per second on each axis, at a
// multiple of half a second. From one to the next the acceleration is constant, so places stay on the grid:
// (v0 + v1) / 2 · 0.5 s is a multiple of 0.25 m, and changes by one turn no axis round on the way. A place
// is even or odd with its velocity, so states at rest are half a metre apart. A fine search has half of all that: 1/8
// m, 0.5 m/s, 1/4 m.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "sim/world/world.hpp"
#include "tools/lab/oracle/cells.hpp"
#include "tools/lab/oracle/feasibility.hpp"
#include "tools/lab/oracle/standing.hpp"
#include "tools/lab/oracle/surface_distance.hpp"

namespace jink::tools::lab::oracle {
namespace {

constexpr double kStep = 0.5;         // s
constexpr int kSamples = 8;           // pieces of a step for which obstacles are taken to move straight
constexpr double kLastLeg = 1.0;      // s, from rest at the last state to rest at the target
constexpr double kLastLength = 0.44;  // m, at most, of that leg: sqrt(3) / 2 · 0.5 m and a little
constexpr double kLongest = 4.0;      // straight flights at full speed, that a flight may take
constexpr double kPatience = 30.0;    // s, besides
constexpr double kPieceEnd = 0.02;    // m, pieces of relative motion that are cut no more
constexpr double kBend = 0.002;       // m, that the true flight may be off its polyline

struct State {
  Index place;     ///< from the start, on the grid
  Index velocity;  ///< in the beam's unit
  int parent = -1;
  double to_go = 0.0;  ///< s, a guess

  bool operator==(const State& other) const {
    return (place == other.place).all() && (velocity == other.velocity).all();
  }
};

struct StateHash {
  std::size_t operator()(const State& state) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      hash = hash * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(state.place[axis] + 4096);
      hash = hash * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(state.velocity[axis] + 16);
    }
    return hash ^ hash >> 29U;
  }
};

/// An obstacle during one step.
struct Mover {
  std::array<Vec3, kSamples + 1> centers;  ///< of its enclosing sphere
  double keep_off = 0.0;                   ///< from there to the vehicle's centre, so that the spheres are free
  Vec3 middle = Vec3::Zero();
  double reach = 0.0;                    ///< of the centres from `middle`
  const config::Shape* shape = nullptr;  ///< null: the sphere is all of it
  double gap = 0.0;                      ///< from the shape's surface to the vehicle's centre
  std::array<Vec3, kSamples + 1> references;
  std::array<Eigen::Matrix3d, kSamples + 1> to_own;  ///< from ENU to the shape's own axes
};

/// Of the vehicle's centre during one step.
using Way = std::array<Vec3, kSamples + 1>;

double squared_distance_to_way(const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double length = way.squaredNorm();
  const double u = length > 0.0 ? std::clamp(-from.dot(way) / length, 0.0, 1.0) : 0.0;
  return (from + u * way).squaredNorm();
}

/// Whether the straight way between two places, relative to the shape, keeps `gap` from its surface. In between the
/// distance is at least what falling from both ends until they meet gives.
bool clear_between(const config::Shape& shape, double gap, const Vec3& from, double d0, const Vec3& to, double d1) {
  if (std::min(d0, d1) < gap) return false;
  const double length = (to - from).norm();
  if (0.5 * (d0 + d1 - length) >= gap || length < kPieceEnd) return true;
  const Vec3 middle = 0.5 * (from + to);
  const double d = surface_distance(shape, middle);
  return clear_between(shape, gap, from, d0, middle, d) && clear_between(shape, gap, middle, d, to, d1);
}

bool clear_of(const Mover& mover, const Way& way) {
  const double least = mover.keep_off * mover.keep_off;
  for (std::size_t i = 0; i < kSamples; ++i) {
    if (squared_distance_to_way(way[i] - mover.centers[i], way[i + 1] - mover.centers[i + 1]) >= least) continue;
    if (mover.shape == nullptr) return false;
    const Vec3 from = mover.to_own[i] * (way[i] - mover.references[i]);
    const Vec3 to = mover.to_own[i + 1] * (way[i + 1] - mover.references[i + 1]);
    const double d0 = surface_distance(*mover.shape, from);
    if (!clear_between(*mover.shape, mover.gap, from, d0, to, surface_distance(*mover.shape, to))) return false;
  }
  return true;
}

/// The shortest time on one axis to rest at a distance, from velocity `v`, with these limits.
double time_to_rest(double distance, double v, double acceleration, double limit) {
  const double after_stop = distance - v * std::abs(v) / (2.0 * acceleration);
  const double sense = after_stop < 0.0 ? -1.0 : 1.0;
  const double u = sense * v;
  const double ahead = sense * distance;
  const double peak = std::sqrt(std::max(0.0, acceleration * ahead + 0.5 * u * u));
  if (peak <= limit) return (2.0 * peak - u) / acceleration;
  return (2.0 * limit - u) / acceleration + (ahead - (limit * limit - 0.5 * u * u) / acceleration) / limit;
}

/// What an Effort means.
struct Beam {
  std::size_t width;  ///< states that are kept of each step
  int per_cell;       ///< of them in one coarse cell, so that a beam does not bunch
  double cell;        ///< m, its edge
  double slack;       ///< m, added to the margin for what the obstacles do between samples
  double unit;        ///< m/s, of velocities
  double change;      ///< m/s, the most in a step: more adds states that lead nowhere else
  bool by_velocity;   ///< whether states in a coarse cell count apart that fly differently

  [[nodiscard]] double grid() const { return 0.5 * kStep * unit; }  ///< m, of places
};

class Search {
 public:
  Search(const config::Scenario& scenario, const OracleOptions& options, const Beam& beam)
      : world_(with_standing_as_map(scenario, true)),
        judged_(with_map_as_obstacles(scenario)),
        options_(options),
        beam_(beam),
        box_(box_of(scenario)),
        gap_(scenario.vehicle.radius + options.margin + beam.slack),
        standing_(scenario, box_, gap_) {
    const double most_change = options.acceleration_share * scenario.vehicle.max_acceleration * kStep;
    const double change = (std::min(beam.change, most_change) + 1e-9) / beam.unit;
    const int most = static_cast<int>(change);
    for (int x = -most; x <= most; ++x) {
      for (int y = -most; y <= most; ++y) {
        for (int z = -most; z <= most; ++z) {
          if (std::hypot(x, y, z) <= change) changes_.emplace_back(x, y, z);
        }
      }
    }
  }

  std::optional<Flight> run() {
    const config::Scenario& scenario = world_.scenario();
    double straight = (scenario.target - scenario.start).norm() / scenario.vehicle.max_speed;
    if (!standing_.empty()) straight = std::max(straight, standing_.time_to_go(scenario.start));
    if (straight == planner::base::kInfinity) return std::nullopt;
    const int steps = static_cast<int>(std::min(scenario.time_limit, kLongest * straight + kPatience) / kStep);
    layers_.push_back({State{Index::Zero(), Index::Zero(), -1, 0.0}});
    for (int step = 0; step <= steps && !layers_.back().empty(); ++step) {
      place_movers(step * kStep);
      if (auto flight = arrive(step * kStep)) return flight;
      layers_.push_back(thinned(successors()));
    }
    return std::nullopt;
  }

 private:
  static planner::base::Box box_of(const config::Scenario& scenario) {
    if (scenario.world) return *scenario.world;
    planner::base::Box box{scenario.start.cwiseMin(scenario.target).array() - kAround,
                           scenario.start.cwiseMax(scenario.target).array() + kAround};
    box.min.z() = std::max(box.min.z(), std::min({0.0, scenario.start.z(), scenario.target.z()}));
    return box;
  }

  [[nodiscard]] Vec3 position(const State& state) const {
    return world_.scenario().start + beam_.grid() * state.place.cast<double>().matrix();
  }
  [[nodiscard]] Vec3 velocity(const State& state) const { return beam_.unit * state.velocity.cast<double>().matrix(); }

  /// How far obstacle `i` strays from straight motion between the samples of a step, m: twice as far as halfway, as
  /// where it turns at a waypoint.
  [[nodiscard]] double most_bend(int i, double t) const {
    constexpr double kPiece = kStep / kSamples;
    double most = 0.0;
    for (int j = 0; j < kSamples; ++j) {
      const auto at = [&](double share) { return world_.obstacle(i, t + (j + share) * kPiece).position; };
      most = std::max(most, 2.0 * (at(0.5) - 0.5 * (at(0.0) + at(1.0))).norm());
    }
    return most;
  }

  void place_movers(double t) {
    movers_.resize(static_cast<std::size_t>(world_.obstacle_count()));
    for (int i = 0; i < world_.obstacle_count(); ++i) {
      Mover& mover = movers_[static_cast<std::size_t>(i)];
      const config::Obstacle& obstacle = world_.scenario().obstacles[static_cast<std::size_t>(i)];
      mover.shape = std::holds_alternative<config::SphereShape>(obstacle.shape) ? nullptr : &obstacle.shape;
      mover.gap = gap_ + (mover.shape == nullptr ? 0.0 : most_bend(i, t));
      for (std::size_t j = 0; j <= kSamples; ++j) {
        const double at = t + kStep * static_cast<double>(j) / kSamples;
        const planner::geometry::Sphere sphere = world_.sphere(i, at);
        mover.centers[j] = sphere.center;
        mover.keep_off = sphere.radius + mover.gap;
        mover.references[j] = world_.obstacle(i, at).position;
        mover.to_own[j] = sim::world::axes_at(obstacle, at).transpose();
      }
      mover.middle = mover.centers[kSamples / 2];
      mover.reach = 0.0;
      for (const Vec3& center : mover.centers) mover.reach = std::max(mover.reach, (center - mover.middle).norm());
    }
  }

  [[nodiscard]] bool within_limits(const State& state) const {
    const planner::base::VehicleLimits& limits = world_.scenario().vehicle;
    return velocity(state).norm() <= limits.max_speed && std::abs(velocity(state).z()) <= limits.max_climb;
  }

  /// What a state might touch during the step, whatever it does.
  void gather_near(const State& state) {
    const Vec3 from = position(state);
    const double way = (velocity(state).norm() +
                        0.5 * options_.acceleration_share * world_.scenario().vehicle.max_acceleration * kStep) *
                       kStep;
    near_standing_ = !standing_.empty() && standing_.least_distance(from) < gap_ + way;
    near_.clear();
    for (const Mover& mover : movers_) {
      const double reach = mover.keep_off + mover.reach + way;
      if ((mover.middle - from).squaredNorm() < reach * reach) near_.push_back(&mover);
    }
  }

  [[nodiscard]] Way way_of(const State& from, const Index& change) const {
    Way way;
    const Vec3 speed = velocity(from);
    const Vec3 acceleration = beam_.unit * change.cast<double>().matrix() / kStep;
    for (std::size_t i = 0; i <= kSamples; ++i) {
      const double t = kStep * static_cast<double>(i) / kSamples;
      way[i] = position(from) + t * speed + 0.5 * t * t * acceleration;
    }
    return way;
  }

  /// In the world, clear of what stands and of what might be touched.
  [[nodiscard]] bool is_free(const Way& way) {
    if (!std::all_of(way.begin(), way.end(), [&](const Vec3& place) { return box_.contains(place); })) return false;
    if (near_standing_) {
      for (std::size_t i = 0; i < kSamples; ++i)
        if (!standing_.clear(way[i], way[i + 1])) return false;
    }
    return std::all_of(near_.begin(), near_.end(), [&](const Mover* mover) { return clear_of(*mover, way); });
  }

  std::vector<State> successors() {
    std::unordered_set<State, StateHash> next;
    const std::vector<State>& layer = layers_.back();
    for (std::size_t i = 0; i < layer.size(); ++i) {
      const State& from = layer[i];
      gather_near(from);
      for (const Index& change : changes_) {
        State to{from.place + 2 * from.velocity + change, from.velocity + change, static_cast<int>(i), 0.0};
        if (!within_limits(to) || !box_.contains(position(to)) || next.contains(to)) continue;
        const bool turns_round = (from.velocity * to.velocity < 0).any();
        if ((turns_round || near_standing_ || !near_.empty()) && !is_free(way_of(from, change))) continue;
        to.to_go = guess(to);
        next.insert(to);
      }
    }
    return {next.begin(), next.end()};
  }

  [[nodiscard]] double guess(const State& state) const {
    const double straight = guess_straight(state);
    return standing_.empty() ? straight : std::max(straight, guess_round(state));
  }

  /// Round what stands: along the way there, which bends, so that speed across it is lost.
  [[nodiscard]] double guess_round(const State& state) const {
    constexpr double kBraking = 2.0;  // m/s²
    constexpr double kAhead = 1.0;    // m, at least, where the way is looked at
    const Vec3 from = position(state);
    const double time = standing_.time_to_go(from);
    if (time == planner::base::kInfinity) return time;
    const Vec3 flown = velocity(state);
    const Vec3 ahead = standing_.ahead(from, kAhead + flown.squaredNorm() / (2.0 * kBraking));
    const Vec3 direction = (ahead - from).stableNormalized();
    const double along = flown.dot(direction);
    const double most = world_.scenario().vehicle.max_speed;
    return time_to_rest(time * most, along, kBraking, most) + (flown - along * direction).norm() / kBraking;
  }

  [[nodiscard]] double guess_straight(const State& state) const {
    constexpr double kAcceleration = 2.0;  // m/s², on one axis
    constexpr double kTieBreak = 0.05;     // weight of the axes that are not the slowest
    const Vec3 distance = world_.scenario().target - position(state);
    const planner::base::VehicleLimits& limits = world_.scenario().vehicle;
    double slowest = 0.0;
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double limit = std::floor(axis == 2 ? limits.max_climb : limits.max_speed);
      const double speed = beam_.unit * state.velocity[axis];
      const double time = time_to_rest(distance[axis], speed, kAcceleration, std::max(limit, 1.0));
      slowest = std::max(slowest, time);
      sum += time;
    }
    return slowest + kTieBreak * sum;
  }

  /// The most promising states, but few from any one place.
  [[nodiscard]] std::vector<State> thinned(std::vector<State> states) const {
    std::sort(states.begin(), states.end(), [](const State& a, const State& b) {
      const auto key = [](const State& s) {
        return std::tuple(s.to_go, s.place.x(), s.place.y(), s.place.z(), s.velocity.x(), s.velocity.y(),
                          s.velocity.z());
      };
      return key(a) < key(b);
    });
    std::unordered_map<std::uint64_t, int> kept_in;
    std::vector<State> kept;
    for (const State& state : states) {
      std::uint64_t cell = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double place = std::floor(state.place[axis] * beam_.grid() / beam_.cell);
        cell = cell << 16U | static_cast<std::uint16_t>(static_cast<int>(place));
        if (!beam_.by_velocity) continue;
        const auto fast = static_cast<int>(std::floor(0.5 * velocity(state)[axis] + 0.5));
        cell ^= static_cast<std::uint64_t>(fast + 8) << (48 + 4 * axis);
      }
      if (++kept_in[cell] > beam_.per_cell) continue;
      kept.push_back(state);
      if (kept.size() >= beam_.width) break;
    }
    return kept;
  }

  /// From rest at `from` to rest at the target: half of the time it speeds up, half of it it brakes.
  [[nodiscard]] std::vector<TimedPoint> last_leg(const Vec3& from, double t) const {
    std::vector<TimedPoint> leg;
    for (int j = 0; j <= 2 * kSamples; ++j) {
      const double u = static_cast<double>(j) / (2 * kSamples);
      const double share = u < 0.5 ? 2.0 * u * u : 1.0 - 2.0 * (1.0 - u) * (1.0 - u);
      leg.push_back({t + u * kLastLeg, (1.0 - share) * from + share * world_.scenario().target});
    }
    return leg;
  }

  /// From a state at rest near the target, where the last leg is free.
  std::optional<Flight> arrive(double t) const {
    const std::vector<State>& layer = layers_.back();
    const Vec3& target = world_.scenario().target;
    for (std::size_t i = 0; i < layer.size(); ++i) {
      if ((layer[i].velocity != 0).any() || (position(layer[i]) - target).norm() > kLastLength) continue;
      std::vector<TimedPoint> leg = last_leg(position(layer[i]), t);
      if (leg.back().t > world_.scenario().time_limit) return std::nullopt;
      // Where somebody stands at the target, this alone is most of the work saved.
      if (true_clearance(judged_, leg) < options_.margin + kBend) continue;
      Flight flight = trace(static_cast<int>(i));
      flight.arrival_time = leg.back().t;
      flight.path.insert(flight.path.end(), leg.begin() + 1, leg.end());
      flight.min_clearance = true_clearance(judged_, flight.path);
      if (flight.min_clearance >= options_.margin + kBend) return flight;
    }
    return std::nullopt;
  }

  /// The way to state `last` of the newest layer.
  [[nodiscard]] Flight trace(int last) const {
    std::vector<const State*> states(layers_.size());
    for (std::size_t step = layers_.size(); step-- > 0;) {
      states[step] = &layers_[step][static_cast<std::size_t>(last)];
      last = states[step]->parent;
    }
    Flight flight;
    flight.path.push_back({0.0, world_.scenario().start});
    for (std::size_t step = 0; step + 1 < states.size(); ++step) {
      const Way way = way_of(*states[step], states[step + 1]->velocity - states[step]->velocity);
      for (std::size_t i = 1; i <= kSamples; ++i) {
        const double t = kStep * (static_cast<double>(step) + static_cast<double>(i) / kSamples);
        flight.path.push_back({t, way[i]});
      }
    }
    return flight;
  }

  sim::world::World world_;   ///< its obstacles move, its map is all that stands
  sim::world::World judged_;  ///< the same with all of it as obstacles
  OracleOptions options_;
  Beam beam_;
  planner::base::Box box_;
  double gap_;  ///< m, from a surface to the vehicle's centre
  Standing standing_;
  std::vector<Index> changes_;              ///< of the velocity in a step
  std::vector<std::vector<State>> layers_;  ///< the states at each step's time
  std::vector<Mover> movers_;               ///< in the step from the newest layer on
  std::vector<const Mover*> near_;          ///< those that the state at hand might touch
  bool near_standing_ = false;              ///< whether it might touch what stands
};

}  // namespace

std::optional<Flight> find_flight(const config::Scenario& scenario, const OracleOptions& options, Effort effort) {
  constexpr Beam kNarrow{500, 3, 1.0, 0.02, 1.0, 2.0, false};
  constexpr Beam kWide{3000, 6, 1.0, 0.06, 1.0, 2.0, false};
  constexpr Beam kFine{2000, 3, 0.5, 0.02, 0.5, 1.0, true};
  const Beam& beam = effort == Effort::kNarrow ? kNarrow : effort == Effort::kWide ? kWide : kFine;
  return Search(scenario, options, beam).run();
}

std::optional<Flight> find_flight(const config::Scenario& scenario, const OracleOptions& options) {
  auto flight = find_flight(scenario, options, Effort::kNarrow);
  if (!flight) flight = find_flight(scenario, options, Effort::kWide);
  return flight ? flight : find_tight_flight(scenario, options);
}

std::optional<Flight> find_tight_flight(const config::Scenario& scenario, const OracleOptions& options) {
  if (options.least_margin >= options.margin) return std::nullopt;
  OracleOptions tight = options;
  tight.margin = options.least_margin;
  auto flight = find_flight(scenario, tight, Effort::kNarrow);
  return flight ? flight : find_flight(scenario, tight, Effort::kFine);
}

}  // namespace jink::tools::lab::oracle
