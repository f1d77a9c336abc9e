// SPDX-License-Identifier: BSD-3-Clause
#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace jink::worlds {

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kSolvable:
      return "solvable";
    case Verdict::kImpossible:
      return "impossible";
    case Verdict::kUnknown:
      return "unknown";
  }
  return "?";
}

Judgement judge(const config::Scenario& scenario, const JudgeOptions& options) {
  Judgement judgement;
  if (certainly_impossible(scenario, options)) {
    judgement.verdict = Verdict::kImpossible;
  } else if (auto flight = find_flight(scenario, options)) {
    judgement.verdict = Verdict::kSolvable;
    judgement.flight = *std::move(flight);
  }
  return judgement;
}

namespace {

/// The largest of |what| / duration over the pieces of the path.
template <typename Way>
double top_rate(std::span<const TimedPoint> path, const Way& way) {
  double top = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double length = way(path[i].position - path[i - 1].position);
    if (length > 0.0) top = std::max(top, length / std::max(path[i].t - path[i - 1].t, 0.0));
  }
  return top;
}

}  // namespace

double top_speed(std::span<const TimedPoint> path) {
  return top_rate(path, [](const Vec3& way) { return way.norm(); });
}

double top_climb(std::span<const TimedPoint> path) {
  return top_rate(path, [](const Vec3& way) { return std::abs(way.z()); });
}

}  // namespace jink::worlds
