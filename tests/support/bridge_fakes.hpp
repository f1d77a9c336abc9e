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

#include "bridge/clock.hpp"
#include "bridge/companion.hpp"

namespace jink::bridge::testing {

class FakeClock final : public Clock {
 public:
  [[nodiscard]] double now() const override { return time; }
  double time = 0.0;
};

/// Tells what `telemetry` holds, records what it is sent.
class FakeLink final : public VehicleLink {
 public:
  [[nodiscard]] VehicleState state() override { return telemetry; }
  [[nodiscard]] bool send(const Setpoint& setpoint) override {
    if (!works) return false;
    sent.push_back(setpoint);
    return true;
  }
  void request(Command command) override { requests.push_back(command); }
  [[nodiscard]] std::optional<CommandReport> next_report() override {
    if (reports.empty()) return std::nullopt;
    CommandReport report = std::move(reports.front());
    reports.pop_front();
    return report;
  }

  VehicleState telemetry;
  bool works = true;
  std::vector<Setpoint> sent;
  std::vector<Command> requests;
  std::deque<CommandReport> reports;
};

class FakeTracks final : public TrackSource {
 public:
  bool poll(TrackMessage& message) override {
    if (messages.empty()) return false;
    message = std::move(messages.front());
    messages.pop_front();
    return true;
  }
  [[nodiscard]] TrackSourceStatus status() const override { return told; }

  std::deque<TrackMessage> messages;
  TrackSourceStatus told;
};

/// Hands out, `takes` seconds after each job, the path that `make` gives: straight to the target by default.
class FakePlanner final : public PlannerTask {
 public:
  void start(PlanJob job) override {
    if (throws_at_start) throw std::runtime_error("no memory");
    jobs.push_back(std::move(job));
    busy_ = true;
  }
  [[nodiscard]] bool busy() const override { return busy_; }
  [[nodiscard]] double latency() const override { return promised; }
  [[nodiscard]] std::optional<PlanResult> poll(double now) override {
    if (throws) throw std::runtime_error("no memory");
    if (!busy_ || silent || now + 1e-9 < jobs.back().begun + takes) return std::nullopt;
    busy_ = false;
    PlanResult result;
    result.job = jobs.back();
    result.ms = 1e3 * takes;
    result.missed = now > result.job.start + 1e-9;
    if (valid) {
      result.plan.status = planner::PlanStatus::kReaches;
      result.plan.path = straight(result.job.request);
    }
    return result;
  }

  /// At `speed` from the request's position to its target.
  [[nodiscard]] planner::TimedPath straight(const planner::PathRequest& request) const {
    const Vec3 way = request.target - request.position;
    const double time = way.norm() / speed;
    planner::TimedPath path;
    for (double t = 0.0; t < time; t += 0.1)
      path.push_back({t, request.position + t / time * way, way / time, Vec3::Zero()});
    path.push_back({time + 1e-3, request.target, Vec3::Zero(), Vec3::Zero()});
    return path;
  }

  std::vector<PlanJob> jobs;
  double promised = 0.04, takes = 0.04;
  double speed = 2.0;
  bool silent = false, valid = true, throws = false, throws_at_start = false;

 private:
  bool busy_ = false;
};

struct Event {
  double t = 0.0;
  std::string name, detail;
};

/// Remembers what the companion says.
class Recorder final : public FlightObserver {
 public:
  void on_event(double t, std::string_view name, const std::string& detail) override {
    events.push_back({t, std::string(name), detail});
  }
  void on_setpoint(double t, const Setpoint& setpoint) override { setpoints.emplace_back(t, setpoint); }
  void on_tracks(double, const std::vector<planner::Track>& seen) override { tracks = seen; }
  void on_plan(double, const PlanResult&) override { ++plans; }
  void on_state(double, const VehicleState&) override { ++states; }

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
  std::vector<std::pair<double, Setpoint>> setpoints;
  std::vector<planner::Track> tracks;
  int plans = 0, states = 0;
};

}  // namespace jink::bridge::testing
