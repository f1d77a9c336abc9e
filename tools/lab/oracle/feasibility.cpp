// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/oracle/feasibility.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <variant>

namespace jink::tools::lab::oracle {

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

namespace {

OracleResult judge_team(const config::Scenario& scenario, const OracleOptions& options) {
  OracleResult judgement;
  std::vector<Flight> flights = find_flights(scenario, options);
  if (!flights.empty()) {
    judgement.verdict = Verdict::kSolvable;
    judgement.flight = std::move(flights.front());
    judgement.others.assign(std::make_move_iterator(flights.begin() + 1), std::make_move_iterator(flights.end()));
    return judgement;
  }
  for (std::size_t k = 0; k <= scenario.vehicles.size(); ++k) {
    if (certainly_impossible(alone(scenario, k), options)) judgement.verdict = Verdict::kImpossible;
  }
  return judgement;
}

}  // namespace

// The proof is dearer than a narrow search, which most worlds need no more than; a wide one is the dearest.
OracleResult judge(const config::Scenario& scenario, const OracleOptions& options) {
  const auto chases = [](const config::Obstacle& obstacle) {
    return std::holds_alternative<config::ChaseMotion>(obstacle.motion);
  };
  if (std::any_of(scenario.obstacles.begin(), scenario.obstacles.end(), chases)) return {};
  if (!scenario.vehicles.empty()) return judge_team(scenario, options);
  OracleResult judgement;
  std::optional<Flight> flight = find_flight(scenario, options, Effort::kNarrow);
  if (!flight && certainly_impossible(scenario, options)) {
    judgement.verdict = Verdict::kImpossible;
    return judgement;
  }
  if (!flight) flight = find_flight(scenario, options, Effort::kWide);
  if (!flight) flight = find_tight_flight(scenario, options);
  if (flight) {
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

}  // namespace jink::tools::lab::oracle
