// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/stop_and_wait.hpp"

#include "tools/lab/baselines/path_builder.hpp"

namespace jink::tools::lab::baselines {

planner::verify::Plan WaitingPilot::plan(const bridge::companion::PlanJob& job) {
  const planner::horizon::PathRequest& request = job.request;
  const double normal = normal_acceleration(request, settings_);
  PathBuilder go(request, settings_, normal);
  go.fly_to_target();
  if (check(go.path(), request, request.margin, settings_.time).free())
    return verified_plan(go.path(), request, settings_.time);

  PathBuilder wait(request, settings_, normal);
  wait.stop();
  const planner::verify::Verification going = check(go.path(), request, 0.0, settings_.time);
  const planner::verify::Verification waiting = check(wait.path(), request, 0.0, settings_.time);
  const bool goes_on = !waiting.free() && is_safer(going, waiting);
  return verified_plan(goes_on ? go.path() : wait.path(), request, settings_.time);
}

}  // namespace jink::tools::lab::baselines
