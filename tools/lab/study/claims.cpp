// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>

#include "tools/lab/study/tables.hpp"
#include "tools/lab/study/verdicts.hpp"

namespace jink::tools::lab::study {
namespace {

using Value = std::function<double(const Record&)>;

/// A value averaged, in each run, over several variants: what runs are compared by.
class ByRun {
 public:
  void add(const Records& records, const Value& value) {
    for (const Record* r : records) {
      auto& [sum, count] = sums_[r->job.run];
      sum += value(*r);
      ++count;
    }
  }
  [[nodiscard]] double mean() const {
    double sum = 0.0;
    for (const auto& [run, entry] : sums_) sum += entry.first / entry.second;
    return sums_.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(sums_.size());
  }
  /// Of the runs that both have whole.
  [[nodiscard]] std::vector<double> minus(const ByRun& other) const {
    std::vector<double> differences;
    for (const auto& [run, entry] : sums_) {
      const auto found = other.sums_.find(run);
      if (found != other.sums_.end())
        differences.push_back(entry.first / entry.second - found->second.first / found->second.second);
    }
    return differences;
  }

 private:
  std::map<int, std::pair<double, int>> sums_;
};

Value value_of(const char* name) {
  return [name](const Record& r) { return r.value(name); };
}
double planning_ms(const Record& r) {
  return 1000.0 * r.measured.at(key::kPlanning);
}

/// By how much a path is longer than the straight line.
double excess_um(const Record& r) {
  return 1e6 * r.value(key::kLength) * (1.0 - 1.0 / r.value(key::kSlr));
}

std::vector<std::string> with_slaves() {
  std::vector<std::string> names = own_algorithms();
  names.erase(std::remove(names.begin(), names.end(), "momvo"), names.end());
  return names;
}

/// `sign` is -1 where larger is better.
Claim compared(std::string claim, const char* first_name, const ByRun& first, const char* second_name,
               const ByRun& second, double sign, double resolution = 0.0, const char* unit = "") {
  const Verdict v = judge(scaled(first.minus(second), sign), resolution);
  return {std::move(claim),
          fmt::format("{:.5g}{} {} against {:.5g}{} {}: difference {:+.3g}, 95 % interval {:.3g} to {:.3g}",
                      first.mean(), unit, first_name, second.mean(), unit, second_name, sign * v.mean,
                      std::min(sign * v.low, sign * v.high), std::max(sign * v.low, sign * v.high)),
          v.outcome};
}

Claim sharing_claim(const Selection& s, const char* name, const char* text, double sign) {
  ByRun most, none;
  for (const std::string& algorithm : with_slaves()) {
    most.add(s.fronts(algorithm, hardest_world(false), sharing_rates().back()), value_of(name));
    none.add(s.fronts(algorithm, hardest_world(false), 0), value_of(name));
  }
  return compared(text, "with l = 9", most, "with l = 0", none, sign);
}

Claim slaves_claim(const Selection& s) {
  ByRun many, few;
  const std::vector<std::string> names = with_slaves();
  many.add(s.fronts(names.back(), hardest_world(false), sharing_rates().back()), value_of(key::kHv));
  few.add(s.fronts(names.front(), hardest_world(false), sharing_rates().back()), value_of(key::kHv));
  return compared("HV grows with the number of slaves (Table 3)", "with 12 slaves", many, "with 2", few, -1.0);
}

Claim front_claim(const Selection& s) {
  ByRun parallel, alone;
  for (const std::string& algorithm : with_slaves())
    parallel.add(s.fronts(algorithm, hardest_world(false), sharing_rates().back()), value_of(key::kHv));
  alone.add(s.fronts("momvo", hardest_world(false), 0), value_of(key::kHv));
  return compared("PMOMVO with l = 9 has a greater HV than MOMVO (Table 3)", "of PMOMVO", parallel, "of MOMVO", alone,
                  -1.0);
}

Claim against_momvo(const Selection& s, std::string text, const Value& value, const char* unit, std::string about = {},
                    double resolution = 0.0) {
  ByRun parallel, alone;
  for (const std::string& world : numbered_worlds(false)) {
    for (const std::string& algorithm : with_slaves()) parallel.add(s.paths(algorithm, world), value);
    alone.add(s.paths("momvo", world), value);
  }
  Claim claim = compared(std::move(text), "with PMOMVO", parallel, "with MOMVO", alone, 1.0, resolution, unit);
  claim.finding = std::move(about) + claim.finding;
  return claim;
}

Claim fastest_claim(const Selection& s) {
  Claim claim{"PMOMVO-6 is the fastest in every scenario (Tables 7 and 9)", "runs are missing", Outcome::kUnknown};
  const std::optional<statistics::Scores> found = scores(s, Criterion::kTime, false);
  if (!found) return claim;
  const std::vector<std::string> own = own_algorithms();
  std::vector<std::string> winners;
  std::size_t won = 0;
  for (std::size_t world = 0; world < found->front().size(); ++world) {
    std::size_t best = 0;
    for (std::size_t a = 1; a < found->size(); ++a)
      if ((*found)[a][world] < (*found)[best][world]) best = a;
    winners.push_back(label_of(own[best]));
    if (own[best] == kRetained) ++won;
  }
  claim.finding = fmt::format("least mean planning time in {} of {} scenarios; the fastest are, in order, {}", won,
                              winners.size(), fmt::join(winners, ", "));
  claim.outcome = won == winners.size() ? Outcome::kBetter : Outcome::kWorse;
  return claim;
}

Claim optimum_claim(const Selection& s) {
  constexpr double kPaperLeast = 0.007;  // Table 6, scenario 4: mean SLR 1.0119 of MOMVO, 1.0045 of PMOMVO-8
  double narrowest = std::numeric_limits<double>::infinity(), widest = 0.0, greatest = 0.0;
  for (const std::string& world : numbered_worlds(false)) {
    std::vector<double> means;
    for (const std::string& algorithm : own_algorithms()) {
      const std::vector<double> slr = values(reached(s.paths(algorithm, world)), key::kSlr);
      if (!slr.empty()) means.push_back(statistics::mean(slr));
    }
    if (means.empty()) continue;
    const auto [least, most] = std::minmax_element(means.begin(), means.end());
    greatest = std::max(greatest, *most);
    narrowest = std::min(narrowest, *most - *least);
    widest = std::max(widest, *most - *least);
  }
  Claim claim{"The variants differ in path length by 0.7 to 2 % in each scenario (Table 6)", "runs are missing",
              Outcome::kUnknown};
  if (greatest <= 0.0) return claim;
  claim.finding = fmt::format("mean SLRs differ by {:.2g} to {:.2g} in a scenario; the greatest is 1 + {:.2g}",
                              narrowest, widest, greatest - 1.0);
  claim.outcome = narrowest < kPaperLeast ? Outcome::kWorse : Outcome::kBetter;
  return claim;
}

Claim difference_claim(const Selection& s) {
  Claim claim{"The more slaves, the shorter the paths, significantly (Tables 8, 10)", "runs are missing",
              Outcome::kUnknown};
  const std::optional<statistics::Scores> found = scores(s, Criterion::kLength, false);
  if (!found) return claim;
  const statistics::Scores ranks = statistics::friedman_ranks(*found);
  const std::vector<double> sums = statistics::rank_sums(ranks);
  const statistics::Friedman f = statistics::friedman(ranks);
  claim.finding = fmt::format(
      "F = {:.3f}, critical {:.4f}, p = {:.4f}; rank sums from MOMVO to PMOMVO-12: {}; means are ranked in steps of "
      "{:g}",
      f.iman_davenport, f.critical_f, f.iman_p, fmt::join(sums, ", "), kSameSlr);
  claim.outcome = f.rejected && std::is_sorted(sums.rbegin(), sums.rend()) ? Outcome::kBetter : Outcome::kWorse;
  return claim;
}

/// The means over all cells of Tables 13 and 14.
std::vector<double> size_means(const Selection& s, const std::string& algorithm,
                               const std::function<double(const Records&)>& of) {
  std::vector<double> means;
  for (const int i : iteration_factors(s.settings())) {
    for (const int p : population_factors(s.settings())) {
      const Records records =
          s.paths(algorithm, hardest_world(false), p * s.sizes().population, i * s.sizes().iterations);
      if (!records.empty()) means.push_back(of(records));
    }
  }
  return means;
}

Claim sizes_claim(const Selection& s) {
  constexpr double kPaperRange = 0.022;  // Table 13: 22.7612 m to 22.2672 m
  Claim claim{"Population and iterations change the path length little (Table 13)", "runs are missing",
              Outcome::kUnknown};
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
  for (const std::string& algorithm : own_algorithms()) {
    for (const double m :
         size_means(s, algorithm, [](const Records& all) { return statistics::mean(values(all, key::kLength)); })) {
      least = std::min(least, m);
      greatest = std::max(greatest, m);
    }
  }
  if (greatest <= 0.0) return claim;
  claim.finding = fmt::format("mean lengths from {:.6f} m to {:.6f} m, {:.5f} %; the paper's span 2.2 %", least,
                              greatest, 100.0 * (greatest / least - 1.0));
  claim.outcome = greatest / least - 1.0 <= kPaperRange ? Outcome::kBetter : Outcome::kWorse;
  return claim;
}

Claim effort_claim(const Selection& s) {
  Claim claim{"More iterations and universes cost less with slaves (Table 14)", "runs are missing", Outcome::kUnknown};
  const auto growth = [&](const std::string& algorithm) {
    const std::vector<double> times =
        size_means(s, algorithm, [](const Records& all) { return statistics::mean(measured(all, key::kPlanning)); });
    return times.size() < 2 ? 0.0 : times.back() / times.front();
  };
  const double alone = growth("momvo");
  const double retained = growth(std::string(kRetained));
  if (alone <= 0.0 || retained <= 0.0) return claim;
  claim.finding = fmt::format("from the smallest to the largest cell times {:.1f} for MOMVO, times {:.1f} for {}",
                              alone, retained, label_of(kRetained));
  claim.outcome = alone > 1.0 && retained > 1.0 && retained < alone ? Outcome::kBetter : Outcome::kWorse;
  return claim;
}

Claim others_claim(const Selection& s) {
  std::map<Outcome, std::vector<std::string>> found;
  for (const char* name : {"mssa", "mogwo", "nsga2", "mopso"}) {
    const std::vector<Verdict> verdicts = compare(s, name);
    found[verdicts[kLengthMetric].outcome].push_back(label_of(name) + " in length");
    found[verdicts[kTimeMetric].outcome].push_back(label_of(name) + " in time");
  }
  std::vector<std::string> parts;
  parts.reserve(found.size());
  for (const auto& [outcome, list] : found)
    parts.push_back(fmt::format("{} {}: {}", to_string(outcome), outcome == Outcome::kNoDifference ? "to" : "than",
                                fmt::join(list, ", ")));
  Outcome whole = Outcome::kBetter;
  for (const Outcome outcome : {Outcome::kUnknown, Outcome::kNoDifference, Outcome::kWorse})
    if (found.count(outcome) > 0) whole = outcome;
  return {"PMOMVO-6 beats four others in length and time (Table 15)", fmt::format("{}", fmt::join(parts, "; ")), whole};
}

std::string agreement(Outcome outcome) {
  switch (outcome) {
    case Outcome::kBetter:
      return "agrees";
    case Outcome::kWorse:
      return "does not agree";
    case Outcome::kNoDifference:
      return "not shown";
    case Outcome::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace

std::vector<Claim> judge_claims(const Selection& s) {
  return {sharing_claim(s, key::kHv, "HV grows with the sharing rate (Table 3)", -1.0),
          sharing_claim(s, key::kMs, "MS grows with the sharing rate (Table 4)", -1.0),
          sharing_claim(s, key::kHrs, "HRS falls with the sharing rate (Table 5)", 1.0),
          slaves_claim(s),
          front_claim(s),
          optimum_claim(s),
          against_momvo(s, "PMOMVO's paths are shorter than MOMVO's (Table 6)", excess_um, " µm",
                        "excess over the straight line: ", kResolvedUm),
          difference_claim(s),
          fastest_claim(s),
          against_momvo(s, "PMOMVO plans faster than MOMVO (Table 7)", planning_ms, " ms"),
          sizes_claim(s),
          effort_claim(s),
          others_claim(s)};
}

presentation::Table claim_table(const std::vector<Claim>& claims) {
  presentation::Table table;
  table.id = "claims";
  table.title = "What the paper says, and what these runs say";
  table.label_columns = 3;
  table.columns = {"The paper's claim", "These runs", "Finding"};
  for (const Claim& claim : claims) {
    presentation::Cell verdict = presentation::label(agreement(claim.outcome));
    verdict.marked = claim.outcome == Outcome::kWorse;
    table.rows.push_back({presentation::label(claim.claim), verdict, presentation::label(claim.finding)});
  }
  table.notes.emplace_back(
      "Means are compared run by run; they differ where the 95 % interval of the mean difference leaves out 0.");
  return table;
}

}  // namespace jink::tools::lab::study
