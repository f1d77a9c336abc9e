// SPDX-License-Identifier: BSD-3-Clause
// Judges a path that somebody else has planned. Its points, half a second apart, are all free, but something fast comes
// through between two of them: the verifier looks at all instants. What it says is held against what geometry says.
#include <cmath>
#include <cstdio>

#include "planner/verify/verifier.hpp"

using namespace jink::planner;

namespace {

/// 10 m east at 2 m/s, a point each half second, after a wait.
base::TimedPath path_of_somebody(double wait) {
  base::TimedPath path;
  if (wait > 0) path.push_back({0, {0, 0, 2}});
  for (int i = 0; i <= 10; ++i) path.push_back({wait + 0.5 * i, {1.0 * i, 0, 2}});
  return path;
}

}  // namespace

int main() {
  base::Track bird;  // crosses the path at x = 4.5 m, when somebody is there
  bird.id = 7;
  bird.velocity = {0, 15, 0};
  bird.position = jink::Vec3(4.5, 0, 2) - 2.25 * bird.velocity;
  bird.radius = 0.3;

  verify::VerifierInput input;
  input.tracks = {&bird, 1};
  input.vehicle_radius = 0.3;
  input.limits = {.max_speed = 5, .max_climb = 2, .max_acceleration = 6};

  const base::TimedPath path = path_of_somebody(0);
  input.path = path;
  const verify::Verification hit = verify::verify(input);
  if (!hit.first_contact) return 1;
  std::printf("hits %d at %.4f s with %.2f m/s\n", static_cast<int>(hit.nearest_id), *hit.first_contact,
              hit.contact_speed);

  const base::TimedPath late = path_of_somebody(1);
  input.path = late;
  const verify::Verification free = verify::verify(input);
  std::printf("a second later it is %s, never nearer than %.4f m (at %.2f s), and %s: %.2f times the acceleration\n",
              free.free() ? "free" : "not free", free.min_clearance, free.t_min_clearance,
              free.flyable() ? "flyable" : "not flyable", free.limits.acceleration);

  // They close in at the speed of their difference, so touch when that far before the meeting; who is 2 m late passes
  // as far as the line of relative motion is away.
  const double speed = std::hypot(2, 15);
  const double contact = 2.25 - (0.3 + 0.3) / speed;
  const double clearance = 2 * 15 / speed - (0.3 + 0.3);
  std::printf("by hand: at %.4f s with %.2f m/s; %.4f m\n", contact, speed, clearance);
  const bool right =
      std::abs(*hit.first_contact - contact) < verify::kUsualAccuracy && std::abs(hit.contact_speed - speed) < 1e-6 &&
      std::abs(free.min_clearance - clearance) < verify::kUsualAccuracy && free.free() && !free.flyable();
  return right ? 0 : 1;
}
