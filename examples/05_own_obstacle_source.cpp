// SPDX-License-Identifier: BSD-3-Clause
// Obstacles from a source of your own: a detector that measures positions alone, ten times a second, with 5 cm of noise
// and 50 ms late. jink's track table finds the velocities, and the planner flies among what it makes of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "bridge/prediction/learned_motion.hpp"
#include "bridge/tracking/track_inbox.hpp"
#include "bridge/tracking/track_table.hpp"
#include "planner/base/random.hpp"
#include "planner/horizon/horizon_planner.hpp"

using namespace jink::planner;
namespace prediction = jink::bridge::prediction;
namespace tracking = jink::bridge::tracking;

namespace {

constexpr double kStep = 0.1;    // s, between measurements, and between plans
constexpr double kLate = 0.05;   // s, from a measurement to its reception
constexpr double kSigma = 0.05;  // m

/// The source: receive() may be called from the sensor's own thread.
class Detector final : public tracking::TrackSource {
 public:
  void receive(double now, std::span<const jink::Vec3> positions) {
    tracking::TrackMessage message;
    message.received = now;
    message.stamp_age = kLate;
    message.positions_only = true;
    tracking::TrackValidator validator(message, positions.size());  // leaves out, and counts, what is no number
    for (const jink::Vec3& position : positions) {
      base::Track track;
      track.id = static_cast<std::uint64_t>(&position - positions.data());
      track.position = position;
      track.position_sigma = kSigma;
      track.radius = 0.5;
      validator.add(track);
    }
    inbox_.put(std::move(message), validator.why());
  }
  bool poll(tracking::TrackMessage& message) override { return inbox_.poll(message); }
  [[nodiscard]] tracking::TrackSourceStatus status() const override { return inbox_.status(); }

 private:
  tracking::TrackInbox inbox_;
};

/// Two that walk across the way, as they truly are.
struct Walkers {
  std::array<jink::Vec3, 2> velocities{jink::Vec3(0, 1.2, 0), jink::Vec3(0, -0.8, 0)};
  [[nodiscard]] std::array<jink::Vec3, 2> at(double t) const {
    return {jink::Vec3(6, -3, 2) + t * velocities[0], jink::Vec3(13, 4, 2) + t * velocities[1]};
  }
};

std::array<jink::Vec3, 2> measured(std::array<jink::Vec3, 2> positions, base::RandomStream& noise) {
  for (jink::Vec3& position : positions) {
    for (double& coordinate : position) coordinate += kSigma * noise.normal();
  }
  return positions;
}

}  // namespace

int main() {
  const Walkers walkers;
  base::RandomStream noise(1);
  Detector detector;
  tracking::TrackTable table(1.0);  // s, that an obstacle is believed to be there once it is not seen

  const base::HorizonSettings settings;
  horizon::HorizonPlanner planner(settings);
  base::WorkerPool pool(1);
  auto request = horizon::PathRequest::with(settings);
  request.position = {0, 0, 2};
  request.target = {20, 0, 2};
  request.volume = {{-5, -10, 0.5}, {25, 10, 8}};

  base::TimedPath flown;
  bool reached = false;
  double clearance = base::kInfinity;
  double off = 0;  // m/s, of the velocities found, after the first second
  for (std::uint64_t number = 0; number < 200 && !reached; ++number) {
    const double now = kStep * static_cast<double>(number);
    std::array<jink::Vec3, 2> seen = measured(walkers.at(now - kLate), noise);
    if (number == 30) seen[1].x() = std::numeric_limits<double>::quiet_NaN();
    detector.receive(now, seen);

    tracking::TrackMessage message;
    while (detector.poll(message)) table.ingest(message);
    table.find_self(now, request.position, request.velocity, request.vehicle.radius);
    std::vector<prediction::Forecast> forecasts;
    const std::vector<base::Track> tracks = table.predict(now, settings.acceleration_trust, &forecasts);
    const prediction::Obstacles obstacles =
        obstacles_of(tracks, forecasts, {}, settings.horizon(), settings.step, settings.acceleration_trust);
    for (const base::Track& track : tracks) {
      if (now > 1) off = std::max(off, (track.velocity - walkers.velocities.at(track.id)).norm());
    }

    request.tracks = obstacles.tracks;
    request.paths = obstacles.paths;
    request.standing = obstacles.standing;
    const verify::Plan plan = planner.plan(request, flown, 1, number, {settings.generations}, pool);
    if (plan.path.empty()) break;
    flown = base::later(plan.path, kStep);
    request.position = flown.front().position;
    request.velocity = flown.front().velocity;
    for (const jink::Vec3& walker : walkers.at(now + kStep)) {
      clearance = std::min(clearance, (walker - request.position).norm() - 0.5 - request.vehicle.radius);
    }
    reached = (request.position - request.target).norm() < settings.near_target;
    if (number % 5 == 0) {
      std::printf("%4.1f s  at (%5.2f, %5.2f, %5.2f), %zu obstacles\n", now, request.position.x(), request.position.y(),
                  request.position.z(), tracks.size());
    }
  }
  const tracking::TrackSourceStatus status = detector.status();
  std::printf("left out: %d (%s)\n", static_cast<int>(status.dropped_tracks), status.last_refusal.c_str());
  std::printf("%s; never nearer than %.2f m; velocities off by at most %.2f m/s\n", reached ? "reached" : "not reached",
              clearance, off);
  return reached && clearance > 0 && off < 1 && status.dropped_tracks == 1 ? 0 : 1;
}
