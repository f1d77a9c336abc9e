// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/progress_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace jink::tools::cli {

std::string progress_text(const ProgressStatus& s) {
  std::string text = fmt::format("[{:6.1f} s]", s.t);
  if (!s.mode.empty()) text += " " + s.mode;
  for (std::size_t i = 0; i < s.stale.size(); ++i) text += (i == 0 ? "  ! " : ", ") + s.stale[i];
  if (s.progress) text += fmt::format("  {:.0f} %", 100.0 * *s.progress);
  if (s.to_go) text += fmt::format("  {:.1f} m to go", *s.to_go);
  if (s.nearest && std::isfinite(*s.nearest)) text += fmt::format("  nearest {:.1f} m", *s.nearest);
  if (s.nearest && !std::isfinite(*s.nearest)) text += "  nothing near";
  if (s.plan_ms) text += fmt::format("  plan {:.0f} ms", *s.plan_ms);
  if (s.speed) text += fmt::format("  {:.1f} m/s", *s.speed);
  if (s.height) text += fmt::format("  z {:.1f} m{}", *s.height, s.estimated ? " estimated" : "");
  if (s.tracks) text += fmt::format("  {} track{}", *s.tracks, *s.tracks == 1 ? "" : "s");
  return text;
}

bool ProgressLine::due(double now) {
  const bool first = !last_;
  if (last_ && now - *last_ < period_) return false;
  last_ = now;
  return !first || printer_.terminal();
}

void ProgressLine::show(const std::string& text) {
  printer_.terminal() ? printer_.live(text) : printer_.line(text);
}

FlightProgress::FlightProgress(const config::Mission& mission, double stale_state, BackgroundPrinter& printer,
                               const bridge::base::Clock* pace)
    : mission_(mission), stale_state_(stale_state), line_(printer, kPlainPeriod), pace_(pace) {}

void FlightProgress::on_state(double t, const bridge::vehicle::VehicleState& state) {
  const double now = pace_ != nullptr ? pace_->now() : t;
  position_ = state.motion.value.position;
  if (!line_.due(now)) return;
  const bool known = state.motion.heard();
  status_.t = t;
  status_.mode =
      state.heartbeat_stamp == bridge::base::kNever ? "" : std::string(bridge::vehicle::to_string(state.mode));
  if (known) {
    status_.speed = state.motion.value.velocity.norm();
    status_.height = state.motion.value.position.z();
    status_.estimated = true;
    find_progress(state.motion.value.position);
  }
  find_stale(t, state);
  line_.show(progress_text(status_));
}

void FlightProgress::find_progress(const Vec3& position) {
  if (flown_) return;  // a landing leads away from the target
  double left = (mission_.waypoints[waypoint_] - position).norm();
  for (std::size_t i = waypoint_ + 1; i < mission_.waypoints.size(); ++i)
    left += (mission_.waypoints[i] - mission_.waypoints[i - 1]).norm();
  status_.to_go = left;
  if (!flying_) return;
  whole_ = std::max(whole_, left);  // a detour does not count backwards
  status_.progress = whole_ > 0.0 ? 1.0 - left / whole_ : 1.0;
}

void FlightProgress::find_stale(double t, const bridge::vehicle::VehicleState& state) {
  status_.stale.clear();
  const auto old = [](const char* what, double age) { return fmt::format("{} {:.1f} s old", what, age); };
  if (state.heartbeat_stamp == bridge::base::kNever) {
    status_.stale.emplace_back("no autopilot yet");
  } else if (t - state.heartbeat_stamp > kOldHeartbeat) {
    status_.stale.push_back(old("heartbeat", t - state.heartbeat_stamp));
  } else if (!state.motion.heard()) {
    status_.stale.emplace_back("no position yet");
  }
  if (state.motion.heard() && state.motion.silence(t) > stale_state_)
    status_.stale.push_back(old("position", state.motion.silence(t)));
  if (!last_tracks_) {
    if (mission_.tracks.required) status_.stale.emplace_back("no tracks yet");
  } else if (t - *last_tracks_ > mission_.tracks.timeout_s) {
    status_.stale.push_back(old("tracks", t - *last_tracks_));
  }
}

void FlightProgress::on_tracks(double t, const std::vector<planner::base::Track>& tracks) {
  last_tracks_ = t;
  status_.tracks = tracks.size();
  status_.nearest = planner::base::kInfinity;
  for (const planner::base::Track& track : tracks) {
    const double free = (track.position - position_).norm() - track.radius - mission_.vehicle.radius;
    status_.nearest = std::min(*status_.nearest, free);
  }
}

void FlightProgress::on_plan(double, const bridge::companion::PlanResult& result) {
  status_.plan_ms = result.ms;
}

void FlightProgress::on_event(double, std::string_view name, const std::string& detail) {
  if (name == "phase") {
    const bool flies = detail.starts_with("flying");
    flown_ = flying_ && !flies;
    flying_ = flying_ || flies;
    if (flown_) {
      status_.progress.reset();
      status_.to_go.reset();
      status_.plan_ms.reset();
    }
  }
  if (name == "waypoint" && waypoint_ + 1 < mission_.waypoints.size()) ++waypoint_;
}

}  // namespace jink::tools::cli
