// SPDX-License-Identifier: BSD-3-Clause
#include "tools/arena/straight_pilot.hpp"

#include "tools/arena/motion.hpp"

namespace jink::arena {

planner::Plan StraightPilot::plan(const bridge::PlanJob& job) {
  Motion motion(job.request, settings_, normal_acceleration(job.request, settings_));
  motion.fly_to_target();
  return judged(motion.path(), job.request, settings_.time);
}

}  // namespace jink::arena
