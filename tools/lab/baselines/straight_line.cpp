// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/straight_line.hpp"

#include "tools/lab/baselines/path_builder.hpp"

namespace jink::tools::lab::baselines {

planner::verify::Plan StraightPilot::plan(const bridge::companion::PlanJob& job) {
  PathBuilder motion(job.request, settings_, normal_acceleration(job.request, settings_));
  motion.fly_to_target();
  return verified_plan(motion.path(), job.request, settings_.time);
}

}  // namespace jink::tools::lab::baselines
