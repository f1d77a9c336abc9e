// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/settings.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "tools/lab/algorithms/registry.hpp"
#include "tools/lab/campaign/options.hpp"
#include "tools/lab/study/worlds.hpp"

namespace jink::tools::lab::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "jink-study-results/1";

/// The settings but for the parameters, then these.
std::vector<config::SettingText> listed(const StudySettings& s) {
  std::vector<config::SettingText> all{{"version", s.version},
                                       {"seed", std::to_string(s.seed)},
                                       {"runs", std::to_string(s.runs)},
                                       {"quick", s.quick ? "on" : "off"},
                                       {"shard", campaign::to_string(s.shard)}};
  all.insert(all.end(), s.parameters.begin(), s.parameters.end());
  return all;
}

int whole_parameter(const StudySettings& settings, const std::string& key) {
  const auto found = std::find_if(settings.parameters.begin(), settings.parameters.end(),
                                  [&](const config::SettingText& one) { return one.key == key; });
  const auto value = found == settings.parameters.end() ? std::nullopt : campaign::whole<int>(found->value);
  if (!value || *value < 0) throw std::runtime_error(fmt::format("the parameter {} is missing or no number", key));
  return *value;
}

/// The sharing rates that an algorithm has in the sweep.
std::vector<int> rates_of(const std::string& algorithm) {
  return algorithm == "momvo" ? std::vector<int>{0} : sharing_rates();
}

/// Collects variants, each once.
class VariantList {
 public:
  explicit VariantList(const PaperSizes& sizes) : sizes_(sizes) {}

  void add(RunKind kind, const std::string& algorithm, const std::string& world, int sharing, int times_population = 1,
           int times_iterations = 1) {
    Variant variant{kind,
                    algorithm,
                    world,
                    has_slaves(algorithm) ? sharing : 0,
                    sizes_.population * times_population,
                    sizes_.iterations * times_iterations};
    if (known_.insert(variant).second) variants_.push_back(std::move(variant));
  }
  void add(RunKind kind, const std::string& algorithm, const std::string& world) {
    add(kind, algorithm, world, sizes_.sharing);
  }
  [[nodiscard]] std::vector<Variant> take() { return std::move(variants_); }

 private:
  PaperSizes sizes_;
  std::set<Variant> known_;
  std::vector<Variant> variants_;
};

}  // namespace

std::string_view to_string(RunKind kind) {
  switch (kind) {
    case RunKind::kFront:
      return "front";
    case RunKind::kPath:
      return "path";
    case RunKind::kAnytime:
      return "anytime";
  }
  return "";
}

bool Variant::timed() const {
  if (kind == RunKind::kPath) return !is_pictured(world) && (is_own(algorithm) || is_hardest(world));
  return kind == RunKind::kAnytime;
}

std::string Job::name() const {
  return fmt::format("{} {} {} l={} {}x{} run {}", to_string(variant.kind), variant.algorithm, variant.world,
                     variant.sharing, variant.population, variant.iterations, run + 1);
}

PaperSizes sizes_of(const StudySettings& settings) {
  return {whole_parameter(settings, "optimizer.population"), whole_parameter(settings, "optimizer.iterations"),
          whole_parameter(settings, "optimizer.sharing")};
}

std::vector<int> sharing_rates() {
  return {0, 1, 3, 4, 7, 9};
}

std::vector<int> population_factors(const StudySettings& settings) {
  return settings.quick ? std::vector<int>{1, 2} : std::vector<int>{1, 2, 4};
}

std::vector<int> iteration_factors(const StudySettings& settings) {
  return settings.quick ? std::vector<int>{1, 2} : std::vector<int>{1, 2, 3};
}

bool is_own(std::string_view algorithm) {
  return algorithm == "momvo" || has_slaves(algorithm);
}

bool has_slaves(std::string_view algorithm) {
  return algorithm.substr(0, 7) == "pmomvo-";
}

std::vector<std::string> own_algorithms() {
  std::vector<std::string> names;
  for (const algorithms::Algorithm& a : algorithms::algorithms())
    if (is_own(a.name)) names.emplace_back(a.name);
  return names;
}

std::vector<std::string> other_algorithms() {
  std::vector<std::string> names;
  for (const algorithms::Algorithm& a : algorithms::algorithms())
    if (!is_own(a.name)) names.emplace_back(a.name);
  return names;
}

std::vector<Variant> variants_of(const StudySettings& settings) {
  VariantList variants(sizes_of(settings));
  const std::vector<std::string> own = own_algorithms();
  for (const std::string& world : {hardest_world(false), hardest_world(true)}) {
    for (const std::string& algorithm : own)
      for (const int sharing : rates_of(algorithm)) variants.add(RunKind::kFront, algorithm, world, sharing);
  }
  for (const bool blocked : {false, true})
    for (const std::string& world : pictured_worlds(blocked))
      variants.add(RunKind::kPath, std::string(kRetained), world);
  for (const bool blocked : {false, true}) {
    for (const std::string& world : numbered_worlds(blocked))
      for (const std::string& algorithm : own) variants.add(RunKind::kPath, algorithm, world);
    for (const std::string& algorithm : other_algorithms()) {
      variants.add(RunKind::kPath, algorithm, hardest_world(blocked));
      if (!blocked) continue;  // elsewhere there is nothing to fail at
      for (const std::string& world : numbered_worlds(true)) variants.add(RunKind::kPath, algorithm, world);
    }
    for (const int iterations : iteration_factors(settings))
      for (const int population : population_factors(settings))
        for (const std::string& algorithm : own)
          variants.add(RunKind::kPath, algorithm, hardest_world(blocked), sizes_of(settings).sharing, population,
                       iterations);
    for (const algorithms::Algorithm& algorithm : algorithms::algorithms())
      variants.add(RunKind::kAnytime, std::string(algorithm.name), hardest_world(blocked));
  }
  for (const std::string& algorithm : own)
    for (const int sharing : rates_of(algorithm))
      variants.add(RunKind::kPath, algorithm, hardest_world(false), sharing);
  return variants.take();
}

std::uint64_t run_seed(std::uint64_t seed, int run) {
  return campaign::seed_of(seed, "study", run);
}

std::vector<Job> jobs_of(const StudySettings& settings) {
  const std::vector<Variant> variants = variants_of(settings);
  std::vector<Job> jobs;
  for (const bool timed : {false, true}) {
    for (int run = 0; run < settings.runs; ++run) {
      for (std::size_t i = 0; i < variants.size(); ++i) {
        const std::size_t number = static_cast<std::size_t>(run) * variants.size() + i;
        // Diagonally: no shard may be left with few of the variants.
        const std::size_t part = (static_cast<std::size_t>(run) + i) % static_cast<std::size_t>(settings.shard.of);
        if (variants[i].timed() == timed && part + 1 == static_cast<std::size_t>(settings.shard.number))
          jobs.push_back({number, variants[i], run, run_seed(settings.seed, run)});
      }
    }
  }
  return jobs;
}

Json to_header(const StudySettings& s) {
  return {{"type", "header"},        {"format", kFormat},    {"version", s.version},
          {"seed", s.seed},          {"runs", s.runs},       {"quick", s.quick},
          {"shard", s.shard.number}, {"shards", s.shard.of}, {"parameters", campaign::to_json(s.parameters)}};
}

StudySettings from_header(const Json& header) {
  StudySettings s;
  campaign::read_header(header, kFormat, [&] {
    header.at("version").get_to(s.version);
    header.at("seed").get_to(s.seed);
    header.at("runs").get_to(s.runs);
    header.at("quick").get_to(s.quick);
    header.at("shard").get_to(s.shard.number);
    header.at("shards").get_to(s.shard.of);
    s.parameters = campaign::parameters_of(header.at("parameters"));
  });
  campaign::check_header(s.runs, kMostStudyRuns, s.shard);
  return s;
}

std::vector<std::string> differences(const StudySettings& a, const std::string& name_a, const StudySettings& b,
                                     const std::string& name_b) {
  return campaign::differences(listed(a), name_a, listed(b), name_b);
}

}  // namespace jink::tools::lab::study
