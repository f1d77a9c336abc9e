// SPDX-License-Identifier: BSD-3-Clause
// Stand-ins for what the companion talks to: a clock, an autopilot, a track writer and a planner that do as a test
// says.
#pragma once

#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/companion/companion.hpp"

namespace jink::bridge::testing {

class FakeClock final : public base::Clock {
 public:
  [[nodiscard]] double now() const override { return time; }
  double time = 0.0;
};

/// Tells what `telemetry` holds, records what it is sent.
class FakeLink final : public vehicle::VehicleLink {
 public:
  [[nodiscard]] vehicle::VehicleState state() override { return telemetry; }
  [[nodiscard]] bool send(const vehicle::Setpoint& setpoint) override {
    if (!works) return false;
    sent.push_back(setpoint);
    return true;
  }
  void request(vehicle::Command command) override { requests.push_back(command); }
  [[nodiscard]] std::optional<vehicle::CommandReport> next_report() override {
    if (reports.empty()) return std::nullopt;
    vehicle::CommandReport report = std::move(reports.front());
    reports.pop_front();
    return report;
  }

  vehicle::VehicleState telemetry;
  bool works = true;
  std::vector<vehicle::Setpoint> sent;
  std::vector<vehicle::Command> requests;
  std::deque<vehicle::CommandReport> reports;
};

class FakeTracks final : public tracking::TrackSource {
 public:
  bool poll(tracking::TrackMessage& message) override {
    if (messages.empty()) return false;
    message = std::move(messages.front());
    messages.pop_front();
    return true;
  }
  [[nodiscard]] tracking::TrackSourceStatus status() const override { return told; }

  std::deque<tracking::TrackMessage> messages;
  tracking::TrackSourceStatus told;
};

/// Hands out, `takes` seconds after each job, the path that `make` gives: straight to the target by default.
class FakePlanner final : public companion::PlannerTask {
 public:
  void start(companion::PlanJob job) override {
    if (throws_at_start) throw std::runtime_error("no memory");
    jobs.push_back(std::move(job));
    busy_ = true;
  }
  [[nodiscard]] bool busy() const override { return busy_; }
  [[nodiscard]] double latency() const override { return promised; }
  [[nodiscard]] std::optional<companion::PlanResult> poll(double now) override {
    if (throws) throw std::runtime_error("no memory");
    if (!busy_ || silent || now + 1e-9 < jobs.back().begun + takes) return std::nullopt;
    busy_ = false;
    companion::PlanResult result;
    result.job = jobs.back();
    result.ms = 1e3 * takes;
    result.missed = now > result.job.start + 1e-9;
    if (valid) {
      result.plan.status = status;
      const bool stops = result.job.goal == companion::Goal::Kind::kStop;
      planner::base::TimedPath& path = result.plan.path;
      path = stops ? stop(result.job.request) : straight(result.job.request);
      if (stays > 0.0) path.push_back({path.back().t + stays, path.back().position, Vec3::Zero(), Vec3::Zero()});
    }
    return result;
  }

  /// At `speed` from the request's position to its target.
  [[nodiscard]] planner::base::TimedPath straight(const planner::horizon::PathRequest& request) const {
    const Vec3 way = request.target - request.position;
    const double time = way.norm() / speed;
    planner::base::TimedPath path;
    for (double t = 0.0; t < time; t += 0.1)
      path.push_back({t, request.position + t / time * way, way / time, Vec3::Zero()});
    path.push_back({time + 1e-3, request.target, Vec3::Zero(), Vec3::Zero()});
    return path;
  }

  /// From the request's velocity evenly down to rest at its target.
  [[nodiscard]] static planner::base::TimedPath stop(const planner::horizon::PathRequest& request) {
    const Vec3 way = request.target - request.position;
    const double speed = request.velocity.norm();
    if (speed < 0.05 || way.norm() < 0.01) return {{0.0, request.target, Vec3::Zero(), Vec3::Zero()}};
    const double time = 2.0 * way.norm() / speed;
    planner::base::TimedPath path;
    for (double t = 0.0; t < time; t += 0.02) {
      const double s = t / time;
      path.push_back({t, request.position + s * (2.0 - s) * way, 2.0 * (1.0 - s) / time * way, Vec3::Zero()});
    }
    path.push_back({time + 1e-3, request.target, Vec3::Zero(), Vec3::Zero()});
    return path;
  }

  std::vector<companion::PlanJob> jobs;
  planner::verify::PlanStatus status = planner::verify::PlanStatus::kReaches;
  double promised = 0.04, takes = 0.04;
  double speed = 2.0;
  double stays = 0.0;  // s, that a path goes on at its end
  bool silent = false, valid = true, throws = false, throws_at_start = false;

 private:
  bool busy_ = false;
};

/// The real one with a budget of next to nothing, in virtual time; and it may fall silent, or throw.
class SmallPlanner final : public companion::PlannerTask {
 public:
  /// `latency`: s, that a plan takes.
  explicit SmallPlanner(double latency) : planner_(settings(), latency) {}
  void start(companion::PlanJob job) override { planner_.start(std::move(job)); }
  [[nodiscard]] bool busy() const override { return planner_.busy(); }
  [[nodiscard]] double latency() const override { return planner_.latency(); }
  [[nodiscard]] std::optional<companion::PlanResult> poll(double now) override {
    if (throws) throw std::runtime_error("no memory");
    return silent ? std::nullopt : planner_.poll(now);
  }
  bool silent = false, throws = false;

 private:
  static companion::PlannerTaskSettings settings() {
    companion::PlannerTaskSettings s;
    s.horizon.slaves = s.horizon.sharing = 1;
    s.horizon.population = 8;
    s.horizon.generations = 2;
    s.threads = 1;
    return s;
  }
  companion::VirtualPlanner planner_;
};

struct Event {
  double t = 0.0;
  std::string name, detail;
};

/// Remembers what the companion says.
class Recorder final : public companion::FlightObserver {
 public:
  void on_event(double t, std::string_view name, const std::string& detail) override {
    events.push_back({t, std::string(name), detail});
  }
  void on_setpoint(double t, const vehicle::Setpoint& setpoint) override { setpoints.emplace_back(t, setpoint); }
  void on_tracks(double, const std::vector<planner::base::Track>& seen) override { tracks = seen; }
  void on_plan(double, const companion::PlanResult&) override { ++plans; }
  void on_state(double, const vehicle::VehicleState&) override { ++states; }

  /// How often an event of this name came.
  [[nodiscard]] int count(std::string_view name) const {
    int n = 0;
    for (const Event& event : events) n += event.name == name ? 1 : 0;
    return n;
  }
  /// The detail of the newest of them; empty: none.
  [[nodiscard]] std::string last(std::string_view name) const {
    for (auto event = events.rbegin(); event != events.rend(); ++event) {
      if (event->name == name) return event->detail;
    }
    return {};
  }

  std::vector<Event> events;
  std::vector<std::pair<double, vehicle::Setpoint>> setpoints;
  std::vector<planner::base::Track> tracks;
  int plans = 0, states = 0;
};

}  // namespace jink::bridge::testing
