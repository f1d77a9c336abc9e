// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/arena/tables.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

namespace jink::tools::lab::arena {
namespace {

/// Flights of a row, before they are counted.
struct Sample {
  std::vector<const FlightRecord*> possible, impossible;
  std::int64_t solvable = 0, reached_solvable = 0;
};

/// What is known of each world that has a flight record, by family and seed.
class Verdicts {
 public:
  explicit Verdicts(const Results& results) {
    for (const auto& [number, world] : results.worlds) judged_[{world.family, world.seed}] = world.verdict;
    for (const auto& [job, flight] : results.flights)
      if (flight.reached()) judged_[{flight.family, flight.seed}] = Verdict::kFlown;
  }
  [[nodiscard]] bool is(const FlightRecord& flight, Verdict verdict) const {
    const auto found = judged_.find({flight.family, flight.seed});
    return found != judged_.end() && found->second == verdict;
  }
  [[nodiscard]] bool has_flight(const FlightRecord& flight) const {
    return is(flight, Verdict::kFlown) || is(flight, Verdict::kSolvable);
  }
  [[nodiscard]] std::size_t count(Verdict verdict) const {
    return static_cast<std::size_t>(
        std::count_if(judged_.begin(), judged_.end(), [&](const auto& one) { return one.second == verdict; }));
  }

 private:
  std::map<std::pair<std::string, std::uint64_t>, Verdict> judged_;
};

Proportion share(const std::vector<const FlightRecord*>& flights, const std::set<std::string>& outcomes) {
  const auto count = std::count_if(flights.begin(), flights.end(),
                                   [&](const auto* flight) { return outcomes.count(flight->outcome) > 0; });
  return statistics::wilson(count, static_cast<std::int64_t>(flights.size()));
}

std::vector<double> clearances(const std::vector<const FlightRecord*>& flights) {
  std::vector<double> values;
  for (const FlightRecord* flight : flights) values.push_back(flight->min_clearance);
  return values;
}

Row row_of(const Sample& sample) {
  Row row;
  const auto& flights = sample.possible;
  row.reached = share(flights, {"reached"});
  row.collisions = share(flights, {"collision"});
  row.left_world = share(flights, {"left_world"});
  row.timeouts = share(flights, {"timeout"});
  const std::int64_t named = row.reached.count + row.collisions.count + row.left_world.count + row.timeouts.count;
  row.others = statistics::wilson(row.reached.of - named, row.reached.of);
  row.reached_solvable = statistics::wilson(sample.reached_solvable, sample.solvable);
  row.clearance = Spread(clearances(flights));
  std::vector<double> time, time_at_limit, length;
  std::int64_t late = 0;
  for (const FlightRecord* flight : flights) {
    row.plans += flight->plans;
    row.deadline_misses += flight->deadline_misses;
    row.plan_ms.add(flight->measured.plan_ms);
    late += flight->measured.late_plans;
    if (!flight->reached() || flight->straight_length <= 0.0) continue;
    time.push_back(flight->flight_time * flight->cruise_speed / flight->straight_length);
    time_at_limit.push_back(flight->flight_time * flight->speed_limit / flight->straight_length);
    length.push_back(flight->path_length / flight->straight_length);
  }
  row.time = Spread(std::move(time));
  row.time_at_limit = Spread(std::move(time_at_limit));
  row.length = Spread(std::move(length));
  row.late_plans = statistics::wilson(late, row.plan_ms.count());
  row.impossible = static_cast<std::int64_t>(sample.impossible.size());
  row.impossible_collisions = share(sample.impossible, {"collision"}).count;
  row.impossible_clearance = Spread(clearances(sample.impossible));
  return row;
}

using Key = std::tuple<std::string, std::string, std::string>;  // family, tier, pilot

void put(const FlightRecord& flight, const Verdicts& verdicts, Sample& sample) {
  if (verdicts.is(flight, Verdict::kImpossible)) {
    sample.impossible.push_back(&flight);
    return;
  }
  sample.possible.push_back(&flight);
  if (!verdicts.has_flight(flight)) return;
  ++sample.solvable;
  if (flight.reached()) ++sample.reached_solvable;
}

void add_rows(const std::string& family, const CampaignSettings& settings, const std::map<Key, Sample>& samples,
              std::vector<Row>& rows) {
  for (const std::string& tier : settings.tiers) {
    for (const std::string& pilot : settings.pilots) {
      const auto found = samples.find({family, tier, pilot});
      if (found == samples.end()) continue;
      Row row = row_of(found->second);
      row.family = family;
      row.tier = tier;
      row.pilot = pilot;
      rows.push_back(std::move(row));
    }
  }
}

}  // namespace

Spread::Spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  min = statistics::quantile(values, 0.0);
  p5 = statistics::quantile(values, 0.05);
  median = statistics::quantile(values, 0.5);
  p95 = statistics::quantile(values, 0.95);
  max = statistics::quantile(values, 1.0);
}

Summary summarise(const Results& results) {
  const Verdicts verdicts(results);
  std::map<Key, Sample> samples;
  Summary summary;
  for (const auto& [job, flight] : results.flights) {
    put(flight, verdicts, samples[{flight.family, flight.tier, flight.pilot}]);
    put(flight, verdicts, samples[{"all", flight.tier, flight.pilot}]);
    if (!flight.reached()) summary.failures.push_back(flight);
  }
  const std::vector<std::string>& pilots = results.settings.pilots;
  std::stable_sort(summary.failures.begin(), summary.failures.end(), [&](const auto& a, const auto& b) {
    return std::find(pilots.begin(), pilots.end(), a.pilot) < std::find(pilots.begin(), pilots.end(), b.pilot);
  });
  for (const std::string& family : results.settings.families) add_rows(family, results.settings, samples, summary.rows);
  add_rows("all", results.settings, samples, summary.totals);
  summary.expected = jobs_of(results.settings).size();
  summary.flights = results.flights.size();
  summary.unknown_worlds = verdicts.count(Verdict::kUnknown);
  summary.impossible_worlds = verdicts.count(Verdict::kImpossible);
  return summary;
}

}  // namespace jink::tools::lab::arena
