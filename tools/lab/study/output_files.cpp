// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/output_files.hpp"

#include <fmt/format.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <system_error>

#include "config/scenario_writer.hpp"
#include "tools/lab/campaign/workers.hpp"
#include "tools/lab/study/figures.hpp"
#include "tools/lab/study/report_text.hpp"
#include "tools/lab/study/tables.hpp"
#include "tools/lab/study/verdicts.hpp"

namespace jink::tools::lab::study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void write_tables(const std::map<std::string, presentation::Table>& tables, const fs::path& out) {
  for (const auto& [id, table] : tables) {
    campaign::write_atomically(out / (id + ".csv"), presentation::to_csv(table));
    campaign::write_atomically(out / (id + ".md"), presentation::to_markdown(table));
    campaign::write_atomically(out / (id + ".tex"), presentation::to_latex(table));
  }
}

/// Several at once; each into files of its own.
std::map<std::string, presentation::FigureFile> draw_figures(const std::vector<CaptionedFigure>& drawings,
                                                             const fs::path& out, int threads) {
  std::vector<presentation::FigureFile> drawn(drawings.size());
  std::atomic<std::size_t> next{0};
  campaign::Workers workers;
  workers.run(
      threads,
      [&] {
        const std::size_t i = next++;
        if (i >= drawings.size()) return false;
        drawn[i] = {drawings[i].figure.id, drawings[i].caption,
                    jink::tools::figures::svg_element(jink::tools::figures::draw(drawings[i].figure, out).svg,
                                                      drawings[i].figure.id + '-')};
        return true;
      },
      [] {});
  std::map<std::string, presentation::FigureFile> result;
  for (presentation::FigureFile& one : drawn) {
    const std::string id = one.id;
    result.emplace(id, std::move(one));
  }
  return result;
}

/// The blocked worlds that runs were made in, as scenarios for `jink plan`.
void write_worlds(const Results& results, const Setting& setting, const fs::path& out) {
  std::map<std::string, std::pair<std::string, int>> names;
  for (const auto& [number, record] : results.runs) {
    const Job& job = record.job;
    if (!is_blocked(job.variant.world) || job.variant.kind != RunKind::kPath) continue;
    names.try_emplace(
        is_pictured(job.variant.world) ? job.variant.world : fmt::format("{}-run{}", job.variant.world, job.run + 1),
        job.variant.world, job.run);
  }
  std::error_code error;
  fs::create_directories(out / "worlds", error);
  if (error) throw ResultsError(fmt::format("{}: {}", (out / "worlds").string(), error.message()));
  for (const auto& [file, world] : names)
    campaign::write_atomically(out / "worlds" / (file + ".yaml"),
                               config::to_yaml(setting.scenes.scenario(world.first, world.second)));
}

Json summary_json(const Selection& s, const ReportParts& parts, const fs::path& out) {
  StudySettings whole = s.settings();
  whole.shard = {};
  const std::size_t all = variants_of(whole).size() * static_cast<std::size_t>(whole.runs);
  Json machines = Json::array();
  for (const Machine& machine : s.results().machines) machines.push_back(to_json(machine));
  Json claims = Json::array();
  for (const Claim& c : parts.claims)
    claims.push_back({{"claim", c.claim},
                      {"agrees", c.outcome == Outcome::kUnknown        ? Json()
                                 : c.outcome == Outcome::kNoDifference ? Json("not shown")
                                                                       : Json(c.outcome == Outcome::kBetter)},
                      {"finding", c.finding}});
  Json tables = Json::array(), figures = Json::array();
  for (const auto& [id, table] : parts.tables) tables.push_back(id);
  for (const auto& [id, figure] : parts.figures) figures.push_back(id);
  return {{"format", "jink-study/1"},
          {"version", s.settings().version},
          {"seed", s.settings().seed},
          {"runs", s.settings().runs},
          {"quick", s.settings().quick},
          {"shard", campaign::to_string(s.settings().shard)},
          {"runs_done", s.results().runs.size()},
          {"runs_of_whole", all},
          {"complete", s.results().runs.size() == all},
          {"machines", machines},
          {"out", out.string()},
          {"report", (out / "report.html").string()},
          {"tables", tables},
          {"figures", figures},
          {"claims", claims},
          {"verdicts", verdict_sentences(s)}};
}

}  // namespace

Json write_study(const Results& results, const Setting& setting, const fs::path& out, int threads) {
  const Selection selection(results);
  ReportParts parts;
  for (presentation::Table& table : all_tables(selection, setting.scenes)) {
    const std::string id = table.id;
    parts.tables.emplace(id, std::move(table));
  }
  parts.claims = judge_claims(selection);
  parts.tables.emplace("claims", claim_table(parts.claims));
  parts.tables.emplace("verdicts", verdict_table(selection));
  write_tables(parts.tables, out);
  write_worlds(results, setting, out);
  campaign::write_atomically(out / "planner.yaml", campaign::parameters_yaml(results.settings.parameters));
  parts.figures = draw_figures(all_figures(selection, setting), out, threads);
  campaign::write_atomically(out / "report.html", presentation::report_html(study_report(selection, setting, parts)));
  return summary_json(selection, parts, out);
}

}  // namespace jink::tools::lab::study
