// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/baselines/registry.hpp"

#include <array>
#include <stdexcept>
#include <string>

#include "tools/lab/baselines/orca.hpp"
#include "tools/lab/baselines/paper_mode.hpp"
#include "tools/lab/baselines/rrt_star.hpp"
#include "tools/lab/baselines/stop_and_wait.hpp"
#include "tools/lab/baselines/straight_line.hpp"

namespace jink::tools::lab::baselines {
namespace {

constexpr std::array<std::string_view, 7> kPilots{"jink",          "paper", "momvo",   "straight",
                                                  "stop_and_wait", "orca",  "rrt_star"};

std::unique_ptr<Baseline> make_rival(std::string_view name, const bridge::companion::PlannerTaskSettings& settings,
                                     const planner::base::PaperSettings& paper) {
  if (name == "paper") return std::make_unique<PaperPilot>(settings, paper);
  if (name == "straight") return std::make_unique<StraightPilot>(settings.horizon);
  if (name == "stop_and_wait") return std::make_unique<WaitingPilot>(settings.horizon);
  if (name == "orca") return std::make_unique<OrcaPilot>(settings.horizon);
  if (name == "rrt_star") return std::make_unique<RrtPilot>(settings);
  throw std::invalid_argument("unknown pilot: " + std::string(name));
}

}  // namespace

std::span<const std::string_view> pilots() {
  return kPilots;
}

std::unique_ptr<bridge::companion::PlannerTask> make_pilot(std::string_view name,
                                                           const bridge::companion::PlannerTaskSettings& settings,
                                                           double latency, const planner::base::PaperSettings& paper) {
  if (name == "jink") return std::make_unique<bridge::companion::VirtualPlanner>(settings, latency);
  if (name == "momvo") {
    bridge::companion::PlannerTaskSettings alone = settings;
    alone.horizon.slaves = 1;
    alone.horizon.sharing = 0;
    return std::make_unique<bridge::companion::VirtualPlanner>(alone, latency);
  }
  return std::make_unique<BaselineTask>(make_rival(name, settings, paper), latency);
}

}  // namespace jink::tools::lab::baselines
