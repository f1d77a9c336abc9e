// SPDX-License-Identifier: BSD-3-Clause
// A flight for a world whose future is known: find_flight() of judge.hpp.
//
// A state is a place on a grid of a quarter of a metre and a velocity of whole metres per second on each axis, at a
// multiple of half a second. From one to the next the acceleration is constant, so places stay on the grid:
// (v0 + v1) / 2 · 0.5 s is a multiple of 0.25 m, and no axis turns round on the way. A place is even or odd with its
// velocity, so states at rest are half a metre apart.
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

namespace jink::tools::lab::oracle {
namespace {

constexpr double kStep = 0.5;         // s
constexpr double kGrid = 0.25;        // m, kStep · 1 m/s / 2
constexpr int kSamples = 8;           // pieces of a step for which obstacles are taken to move straight
constexpr double kLastLeg = 1.0;      // s, from rest at the last state to rest at the target
constexpr double kLastLength = 0.44;  // m, at most, of that leg: sqrt(3) / 2 · 0.5 m and a little
constexpr double kCoarse = 1.0;       // m, cells for which few states are kept, so that a beam does not bunch
constexpr double kLongest = 4.0;      // straight flights at full speed, that a flight may take
constexpr double kPatience = 30.0;    // s, besides
constexpr double kMostChange = 2.0;   // m/s, in a step: more adds states that lead nowhere else
constexpr double kBend = 0.002;       // m, that the true flight may be off its polyline

struct State {
  Index place;     ///< from the start, in kGrid
  Index velocity;  ///< m/s
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

/// An obstacle's enclosing sphere during one step.
struct Mover {
  std::array<Vec3, kSamples + 1> centers;
  double keep_off = 0.0;  ///< from its centre to the vehicle's
  Vec3 middle = Vec3::Zero();
  double reach = 0.0;  ///< of the centres from `middle`
};

/// Of the vehicle's centre during one step.
using Way = std::array<Vec3, kSamples + 1>;

double squared_distance_to_way(const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double length = way.squaredNorm();
  const double u = length > 0.0 ? std::clamp(-from.dot(way) / length, 0.0, 1.0) : 0.0;
  return (from + u * way).squaredNorm();
}

bool clear_of(const Mover& mover, const Way& way) {
  const double least = mover.keep_off * mover.keep_off;
  for (std::size_t i = 0; i < kSamples; ++i) {
    if (squared_distance_to_way(way[i] - mover.centers[i], way[i + 1] - mover.centers[i + 1]) < least) return false;
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
  int per_cell;       ///< of them in one coarse cell
  double slack;       ///< m, added to the margin for what the obstacles do between samples
};

class Search {
 public:
  Search(const config::Scenario& scenario, const OracleOptions& options, const Beam& beam)
      : world_(scenario), options_(options), beam_(beam), box_(box_of(scenario)) {
    const planner::base::VehicleLimits& limits = scenario.vehicle;
    const double change = std::min(kMostChange, options.acceleration_share * limits.max_acceleration * kStep) + 1e-9;
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
    const double straight = (scenario.target - scenario.start).norm() / scenario.vehicle.max_speed;
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
    return world_.scenario().start + kGrid * state.place.cast<double>().matrix();
  }

  void place_movers(double t) {
    movers_.resize(static_cast<std::size_t>(world_.obstacle_count()));
    for (int i = 0; i < world_.obstacle_count(); ++i) {
      Mover& mover = movers_[static_cast<std::size_t>(i)];
      for (std::size_t j = 0; j <= kSamples; ++j) {
        const planner::geometry::Sphere sphere = world_.sphere(i, t + kStep * static_cast<double>(j) / kSamples);
        mover.centers[j] = sphere.center;
        mover.keep_off = sphere.radius + world_.scenario().vehicle.radius + options_.margin + beam_.slack;
      }
      mover.middle = mover.centers[kSamples / 2];
      mover.reach = 0.0;
      for (const Vec3& center : mover.centers) mover.reach = std::max(mover.reach, (center - mover.middle).norm());
    }
  }

  [[nodiscard]] bool within_limits(const Index& velocity) const {
    const planner::base::VehicleLimits& limits = world_.scenario().vehicle;
    return velocity.matrix().cast<double>().norm() <= limits.max_speed && std::abs(velocity.z()) <= limits.max_climb;
  }

  /// What a state might touch during the step, whatever it does.
  void gather_near(const State& state) {
    const Vec3 from = position(state);
    const double way = (state.velocity.matrix().cast<double>().norm() +
                        0.5 * options_.acceleration_share * world_.scenario().vehicle.max_acceleration * kStep) *
                       kStep;
    near_.clear();
    for (const Mover& mover : movers_) {
      const double reach = mover.keep_off + mover.reach + way;
      if ((mover.middle - from).squaredNorm() < reach * reach) near_.push_back(&mover);
    }
  }

  [[nodiscard]] Way way_of(const State& from, const Index& change) const {
    Way way;
    const Vec3 velocity = from.velocity.cast<double>().matrix();
    const Vec3 acceleration = change.cast<double>().matrix() / kStep;
    for (std::size_t i = 0; i <= kSamples; ++i) {
      const double t = kStep * static_cast<double>(i) / kSamples;
      way[i] = position(from) + t * velocity + 0.5 * t * t * acceleration;
    }
    return way;
  }

  std::vector<State> successors() {
    std::unordered_set<State, StateHash> next;
    const std::vector<State>& layer = layers_.back();
    for (std::size_t i = 0; i < layer.size(); ++i) {
      const State& from = layer[i];
      gather_near(from);
      for (const Index& change : changes_) {
        State to{from.place + 2 * from.velocity + change, from.velocity + change, static_cast<int>(i), 0.0};
        if (!within_limits(to.velocity) || !box_.contains(position(to)) || next.contains(to)) continue;
        if (!near_.empty()) {
          const Way way = way_of(from, change);
          if (!std::all_of(near_.begin(), near_.end(), [&](const Mover* mover) { return clear_of(*mover, way); }))
            continue;
        }
        to.to_go = guess(to);
        next.insert(to);
      }
    }
    return {next.begin(), next.end()};
  }

  [[nodiscard]] double guess(const State& state) const {
    constexpr double kAcceleration = 2.0;  // m/s², on one axis
    constexpr double kTieBreak = 0.05;     // weight of the axes that are not the slowest
    const Vec3 distance = world_.scenario().target - position(state);
    const planner::base::VehicleLimits& limits = world_.scenario().vehicle;
    double slowest = 0.0;
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double limit = std::floor(axis == 2 ? limits.max_climb : limits.max_speed);
      const double time = time_to_rest(distance[axis], state.velocity[axis], kAcceleration, std::max(limit, 1.0));
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
        const double place = std::floor(state.place[axis] * kGrid / kCoarse);
        cell = cell << 16U | static_cast<std::uint16_t>(static_cast<int>(place));
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
      if (true_clearance(world_.scenario(), leg) < options_.margin + kBend) continue;
      Flight flight = trace(static_cast<int>(i));
      flight.arrival_time = leg.back().t;
      flight.path.insert(flight.path.end(), leg.begin() + 1, leg.end());
      flight.min_clearance = true_clearance(world_.scenario(), flight.path);
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

  sim::world::World world_;
  OracleOptions options_;
  Beam beam_;
  planner::base::Box box_;
  std::vector<Index> changes_;              ///< of the velocity in a step
  std::vector<std::vector<State>> layers_;  ///< the states at each step's time
  std::vector<Mover> movers_;               ///< in the step from the newest layer on
  std::vector<const Mover*> near_;          ///< those that the state at hand might touch
};

}  // namespace

std::optional<Flight> find_flight(const config::Scenario& scenario, const OracleOptions& options, Effort effort) {
  constexpr Beam kNarrow{500, 3, 0.02};
  constexpr Beam kWide{3000, 6, 0.06};
  return Search(scenario, options, effort == Effort::kNarrow ? kNarrow : kWide).run();
}

std::optional<Flight> find_flight(const config::Scenario& scenario, const OracleOptions& options) {
  auto flight = find_flight(scenario, options, Effort::kNarrow);
  return flight ? flight : find_flight(scenario, options, Effort::kWide);
}

}  // namespace jink::tools::lab::oracle
