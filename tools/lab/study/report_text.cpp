// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/report_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/presentation/paper_numbers.hpp"
#include "tools/lab/study/tables.hpp"

namespace jink::tools::lab::study {
namespace {

/// Puts sections together; ids that are not there are passed over.
class Sections {
 public:
  explicit Sections(const ReportParts& parts) : parts_(parts) {}

  void begin(std::string heading, int level = 1) { sections_.push_back({std::move(heading), {}, level}); }
  void text(std::string paragraph) { sections_.back().parts.emplace_back(std::move(paragraph)); }
  void list(std::vector<std::string> points) {
    if (!points.empty()) sections_.back().parts.emplace_back(presentation::List{std::move(points)});
  }
  void facts(presentation::Facts facts) { sections_.back().parts.emplace_back(std::move(facts)); }
  void tables(std::initializer_list<const char*> ids, bool blocked = false) {
    for (const char* id : ids) {
      const auto found = parts_.tables.find(table_id(id, blocked));
      if (found != parts_.tables.end()) sections_.back().parts.emplace_back(found->second);
    }
  }
  void figures(std::initializer_list<const char*> ids) {
    for (const char* id : ids) {
      const auto found = parts_.figures.find(id);
      if (found != parts_.figures.end()) sections_.back().parts.emplace_back(found->second);
    }
  }
  [[nodiscard]] std::vector<presentation::Section> take() { return std::move(sections_); }

 private:
  const ReportParts& parts_;
  std::vector<presentation::Section> sections_;
};

std::string parameter(const StudySettings& settings, const std::string& key) {
  for (const config::SettingText& one : settings.parameters)
    if (one.key == key) return one.value;
  return "unknown";
}

presentation::Facts run_facts(const Selection& s) {
  presentation::Facts facts;
  facts.facts = {{"jink", s.settings().version},
                 {"Seed", std::to_string(s.settings().seed)},
                 {"Runs of each variant", std::to_string(s.settings().runs)},
                 {"Shard", campaign::to_string(s.settings().shard)},
                 {"Population, iterations, sharing",
                  fmt::format("{}, {}, {}", s.sizes().population, s.sizes().iterations, s.sizes().sharing)}};
  std::vector<std::string> seeds;
  for (int run = 0; run < std::min(s.settings().runs, 5); ++run)
    seeds.push_back(std::to_string(run_seed(s.settings().seed, run)));
  facts.facts.emplace_back("Seeds of the runs", fmt::format("{}{} (each in `runs.jsonl`)", fmt::join(seeds, ", "),
                                                            s.settings().runs > 5 ? " ..." : ""));
  for (const Machine& m : s.results().machines)
    facts.facts.emplace_back(
        "Machine", fmt::format("{}, {} core{}, {}; {}", m.cpu, m.cores, m.cores == 1 ? "" : "s", m.system, m.compiler));
  facts.facts.emplace_back(
      "Constraint",
      fmt::format("`paper.constraint: {}`, `paper.axis: {}`, {} waypoints", parameter(s.settings(), "paper.constraint"),
                  parameter(s.settings(), "paper.axis"), parameter(s.settings(), "paper.waypoints")));
  facts.facts.emplace_back("Operators of MOMVO and PMOMVO", parameter(s.settings(), "optimizer.operators"));
  return facts;
}

void what_was_run(Sections& out, const Selection& s, const Setting& setting) {
  out.begin("What was run");
  out.text(extent_sentence(s));
  out.facts(run_facts(s));
  out.text(
      "Every algorithm solves the same problem objects with the same number of evaluations (population times "
      "iterations) and gives a front of at most the same size. Run number k of every variant has the same seed, so "
      "runs are compared in pairs. All results but times are the same bit by bit for any number of threads. Runs "
      "whose time is reported are made one at a time, after all others, with nothing else of the study beside them.");
  out.text(
      "The **blocked** worlds are the harder version of each experiment: start, target and number of obstacles of "
      "the paper's scenario, but obstacles of 0.5 m radius timed to meet the straight flight one after the other, "
      "every second one in its way and the others just beside it. Each run has another world, drawn from the seed, "
      "the same for all algorithms; the three of Table 12 are the same in all runs. They are in the folder `worlds`.");
  std::vector<std::string> at;
  for (const bool blocked : {false, true}) {
    std::vector<std::string> stations;
    std::size_t hit = 0;
    double hv = 0.0;
    const std::vector<FrontStep>& steps = blocked ? setting.blocked_steps : setting.steps;
    for (const FrontStep& step : steps) {
      stations.push_back(std::to_string(step.station + 1));
      hit += step.hit ? 1 : 0;
      hv += step.reference.hypervolume / static_cast<double>(steps.size());
    }
    at.push_back(
        fmt::format("{}: waypoints {}; the shortest way is blocked at {} of them; the reference fronts have a "
                    "mean HV of {:.4f}",
                    blocked ? "Blocked world" : "Scenario 5", fmt::join(stations, ", "), hit, hv));
  }
  out.text(
      "Tables 3 to 5 and the anytime curves need one problem that all solve. At the start of a path the straight way "
      "is best in both objectives at once, and its front is a single point. So the steps are taken in flight: the "
      "vehicle is 0.8 m beside and 0.4 m above the straight line and has been turning away from the target by 35 "
      "degrees, so that the shortest and the straightest way differ. In the blocked world they are the steps whose "
      "shortest way is blocked most, of those where some way is free and the front is no point:");
  out.list(at);
  std::vector<std::string> sources;
  for (const algorithms::Algorithm& a : algorithms::algorithms())
    if (!has_slaves(a.name) || a.name == kRetained)
      sources.push_back(fmt::format("**{}**: {}", has_slaves(a.name) ? "PMOMVO-m" : std::string(a.label), a.source));
  out.text("The algorithms:");
  out.list(sources);
  const std::string operators = parameter(s.settings(), "optimizer.operators");
  if (operators != "printed")
    out.text(fmt::format(
        "MOMVO and PMOMVO have jink's moves, `{}` (`docs/planner.md`), not those of the paper's Eq. (18) and (20) as "
        "printed, which `--set optimizer.operators=printed` runs.",
        operators));
}

/// The paper's numbers that cannot be right, by the notes of the data file.
std::vector<std::string> doubtful_numbers() {
  std::map<std::string_view, int> deviations;
  std::vector<std::pair<std::string, std::string_view>> places;  // those of one note together
  for (const presentation::PaperNumber& n : presentation::paper_numbers()) {
    if (n.note.empty()) continue;
    const std::string place = fmt::format("{} ({})", n.where, n.printed);
    if (n.statistic == "STD")
      ++deviations[n.table];
    else if (!places.empty() && places.back().second == n.note)
      places.back().first += "; " + place;
    else
      places.emplace_back(place, n.note);
  }
  std::vector<std::string> points;
  for (const auto& [place, note] : places) points.push_back(fmt::format("{}: {}", place, note));
  std::vector<std::string> counts;
  counts.reserve(deviations.size());
  for (const auto& [table, count] : deviations)
    counts.push_back(fmt::format("{} in {}", count, presentation::table_name(std::string(table))));
  if (!counts.empty())
    points.insert(points.begin(),
                  fmt::format("Standard deviations that do not fit best, mean and worst beside them: {}",
                              fmt::join(counts, ", ")));
  return points;
}

void what_cannot_be(Sections& out) {
  out.begin("What of the paper cannot be reproduced");
  // NOLINTBEGIN(bugprone-suspicious-missing-comma): sentences longer than a line
  out.list(
      {"Obstacle radii, vehicle size, cruise speed, time step, number of waypoints, the steering limit, the penalty, "
       "the archive's size and the width of a narrow pass are not given. Ours are in `planner.yaml` beside this "
       "page, and obstacles have 0.5 m.",
       "With the printed positions and speeds, obstacles of 0.5 m and our cruise speed the straight flight is free in "
       "all five scenarios of Table 2, so that the shortest path is the straight line and SLR 1. A mean SLR of 1.02, "
       "as "
       "the paper has, is then a search that has not ended, and the scenarios say nothing of avoidance. Hence the "
       "blocked worlds.",
       "The paper's flight time FT is hundreds of seconds for 12 to 22 m: it is for the most part the run time of a "
       "MATLAB program. Planning time and flown time are apart here.",
       "The sharing rates are {0, 1, 3, 7, 9} in the paper's text and {0, 1, 3, 4, 9} in its tables: all are run. "
       "One speed of scenario 2 is printed `[3- 3 1]` and read as [3 -3 1].",
       "Reference point and normalisation of HV are not given. Ours are stated at Table 3.",
       "Some equations are not taken as printed: (5)-(7) add half of aΔt² here, (8) keeps its signs, (11)-(13) begin "
       "where the segment does, (17) penalises g and h each for itself; (14) as printed, with the infinite line and "
       "obstacles at rest, is `paper.constraint=paper`, and (18) and (20) as printed are "
       "`optimizer.operators=printed`."});
  // NOLINTEND(bugprone-suspicious-missing-comma)
  out.text("Numbers in the paper's tables that cannot be as printed, by arithmetic alone:");
  out.list(doubtful_numbers());
}

/// All claims that these runs do not bear out, as sentences.
std::vector<std::string> disagreements(const std::vector<Claim>& claims) {
  std::vector<std::string> points;
  for (const Claim& c : claims)
    if (c.outcome == Outcome::kWorse) points.push_back(fmt::format("{}: {}.", c.claim, c.finding));
  return points;
}

std::vector<std::string> abstract_of(const Selection& s, const ReportParts& parts) {
  const auto count = [&](Outcome outcome) {
    return std::count_if(parts.claims.begin(), parts.claims.end(),
                         [&](const Claim& c) { return c.outcome == outcome; });
  };
  std::vector<std::string> paragraphs{fmt::format(
      "Section 5 of [Paper], \"Parallel Multiobjective Multiverse Optimizer for Path Planning of Unmanned Aerial "
      "Vehicles in a Dynamic Environment with Moving Obstacles\", again, with {} runs of each variant: all its "
      "tables and figures, the same on worlds whose straight line is blocked, and hypervolume during the search. Of "
      "{} statements of the paper that were checked, these runs agree with {}, do not agree with {}, and show "
      "neither for {}{}.",
      s.settings().runs, parts.claims.size(), count(Outcome::kBetter), count(Outcome::kWorse),
      count(Outcome::kNoDifference),
      count(Outcome::kUnknown) == 0 ? "" : fmt::format("; {} could not be judged", count(Outcome::kUnknown)))};
  const std::vector<std::string> sentences = verdict_sentences(s);
  for (std::size_t i = 0; i < std::min<std::size_t>(2, sentences.size()); ++i) paragraphs.push_back(sentences[i]);
  return paragraphs;
}

void harder_worlds(Sections& out) {
  out.begin("The same where the straight line is blocked");
  out.text(
      "Here a path may fail: problem (16) is solved waypoint by waypoint, and a step may end where no next one is "
      "free. Lengths and flight times are of the paths that reach; how many do stands beside them. What jink flies "
      "by is not this way of planning but its horizon planner, which the arena tests (`docs/arena.md`).");
  out.tables({"success"});
  out.begin("Fronts", 2);
  out.tables({"table03", "table04", "table05"}, true);
  out.figures({"figure08-blocked"});
  out.begin("Paths", 2);
  out.tables({"table06", "table07", "table07-flight", "table08", "table09", "table10", "table10-pairs", "table11",
              "table11-pairs"},
             true);
  out.begin("Avoidance", 2);
  out.tables({"table12"}, true);
  out.figures({"figure09-blocked", "figure10-blocked", "figure11-blocked"});
  out.begin("Population, iterations and other algorithms", 2);
  out.tables({"table13", "table13-reached", "table14", "table15", "anytime"}, true);
  out.figures({"anytime-blocked"});
}

}  // namespace

std::string extent_sentence(const Selection& s) {
  StudySettings whole = s.settings();
  whole.shard = {};
  const std::size_t all = variants_of(whole).size() * static_cast<std::size_t>(whole.runs);
  const std::size_t done = s.results().runs.size();
  const std::string quick = s.settings().quick
                                ? " This is a quick study: few runs, and Tables 13 and 14 without their largest "
                                  "cells. Take its numbers as a first look."
                                : "";
  if (done == all) return fmt::format("{} runs of {} variants, all there.{}", all, variants_of(whole).size(), quick);
  return fmt::format("**Incomplete:** {} of {} runs are there; what is missing is \"-\" in the tables.{}", done, all,
                     quick);
}

presentation::Report study_report(const Selection& s, const Setting& setting, const ReportParts& parts) {
  presentation::Report report;
  report.title = "PMOMVO for paths among moving obstacles: the paper's experiments again";
  report.byline = fmt::format("jink {}, seed {}, {} runs of each variant{}", s.settings().version, s.settings().seed,
                              s.settings().runs, s.settings().quick ? ", quick" : "");
  report.abstract = abstract_of(s, parts);
  Sections out(parts);
  what_was_run(out, s, setting);
  out.begin("What agrees and what does not");
  out.tables({"claims"});
  const std::vector<std::string> against = disagreements(parts.claims);
  if (!against.empty()) {
    out.text("So these runs do not bear out:");
    out.list(against);
  }
  out.text(
      "How PMOMVO-6, which the paper settles on, does against every other algorithm, first against NSGA-II and "
      "MOEA/D:");
  out.list(verdict_sentences(s));
  out.tables({"verdicts"});
  what_cannot_be(out);
  out.begin("Fronts over slaves and sharing rates");
  out.tables({"table03", "table04", "table05"});
  out.figures({"figure08"});
  out.begin("Paths over the five scenarios");
  out.tables({"table06", "table07", "table07-flight"});
  out.begin("Statistics", 2);
  out.tables({"table08", "table09", "table10", "table10-pairs", "table11", "table11-pairs"});
  out.begin("Avoidance of moving obstacles");
  out.tables({"table12"});
  out.figures({"figure09", "figure10", "figure11", "figure12"});
  out.begin("Computation time");
  out.figures({"figure13", "figure14", "figure15"});
  out.begin("Population and iterations");
  out.tables({"table13", "table14"});
  out.figures({"figure16", "figure17"});
  out.begin("Other algorithms");
  out.tables({"table15", "anytime"});
  out.figures({"anytime"});
  harder_worlds(out);
  report.sections = out.take();
  return report;
}

}  // namespace jink::tools::lab::study
