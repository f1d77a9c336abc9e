// SPDX-License-Identifier: BSD-3-Clause
// Plans a whole path at once, as the paper does: its Table 12, instance 1, five spheres that pass on the way to a place
// 11 m away, and one more that stands in the way, since the five leave straight on free. East, north, up; m, s, rad.
#include <array>
#include <cstdio>

#include "planner/paper/paper_planner.hpp"

using namespace jink::planner;

namespace {

base::Track sphere(const jink::Vec3& position, const jink::Vec3& velocity) {
  base::Track track;
  track.position = position;
  track.velocity = velocity;
  track.radius = 0.5;
  return track;
}

}  // namespace

int main() {
  const std::array obstacles{sphere({5, 5, 1}, {4, -2, 1}),  sphere({3, 3, 2}, {2, -2, -2}),
                             sphere({5, 3, 1}, {4, 2, 2}),   sphere({1.5, 2.5, 1}, {1, 1, 1.5}),
                             sphere({1, 1, 1.5}, {1, 1, 1}), sphere({6, 6, 0.2}, {0, 0, 0})};
  paper::PaperRequest request;
  request.start = {0, 0, 0};
  request.target = {8, 8, 0};
  request.volume.min.z() = 0;  // the ground
  request.tracks = obstacles;

  base::WorkerPool pool;  // a thread for each core; the path is the same for any number
  const verify::Plan plan = paper::plan_paper(request, pool);
  for (const base::TimedPoint& point : plan.path) {
    std::printf("%5.2f s  (%5.2f, %5.2f, %5.2f)\n", point.t, point.position.x(), point.position.y(),
                point.position.z());
  }
  std::printf("%s: %.2f m where straight on is %.2f m, never nearer than %.2f m\n", to_string(plan.status).data(),
              base::path_length(plan.path), (request.target - request.start).norm(), plan.verification.min_clearance);
  return plan.status == verify::PlanStatus::kReaches ? 0 : 1;
}
