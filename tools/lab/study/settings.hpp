// SPDX-License-Identifier: BSD-3-Clause
// What the study runs: settings, and the list of runs that follows from them.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "tools/lab/campaign/settings_diff.hpp"

namespace jink::tools::lab::study {

inline constexpr int kMostStudyRuns = 1000;

struct StudySettings {
  std::string version;  ///< of jink
  std::uint64_t seed = 1;
  int runs = 0;
  bool quick = false;  ///< without the largest cells of Tables 13 and 14
  campaign::Shard shard;
  std::vector<config::SettingText> parameters;  ///< all of the planner's, as config::list_settings()
};

/// What a run does.
enum class RunKind {
  kFront,   ///< problem (16) at fixed steps: indicators of the front, [Paper] Tables 3-5
  kPath,    ///< a whole path: length, times, success, [Paper] Tables 6, 7 and 12-15
  kAnytime  ///< as kFront, stopped after several shares of the iterations
};
[[nodiscard]] std::string_view to_string(RunKind kind);

/// What the runs of a variant have in common.
struct Variant {
  RunKind kind = RunKind::kPath;
  std::string algorithm;  ///< a name of algorithms.hpp
  std::string world;      ///< a name of scenes.hpp
  int sharing = 0;        ///< l; 0 and without effect where the algorithm has no slaves
  int population = 0;
  int iterations = 0;

  bool operator==(const Variant&) const = default;
  bool operator<(const Variant& other) const {
    const auto tied = [](const Variant& v) {
      return std::tie(v.kind, v.algorithm, v.world, v.sharing, v.population, v.iterations);
    };
    return tied(*this) < tied(other);
  }

  /// Whether its wall time is reported: such a run is made alone, on all threads of the planner.
  [[nodiscard]] bool timed() const;
};

/// One run.
struct Job {
  std::size_t number = 0;  ///< in the whole study
  Variant variant;
  int run = 0;             ///< from 0
  std::uint64_t seed = 0;  ///< of the optimizer

  /// "path nsga2 table2-5 l=0 50x100 run 3"
  [[nodiscard]] std::string name() const;
};

/// The paper's numbers: population and iterations, and the sharing rate of Tables 6-15.
struct PaperSizes {
  int population = 0, iterations = 0, sharing = 0;
};
/// Those of the parameters optimizer.population, .iterations and .sharing. Throws std::runtime_error where one is
/// missing or no number from 0 on.
[[nodiscard]] PaperSizes sizes_of(const StudySettings& settings);

/// Sharing rates of Tables 3-5 and Figure 13: both lists that the paper prints.
[[nodiscard]] std::vector<int> sharing_rates();
/// Multiples of the population and of the iterations in Tables 13 and 14.
[[nodiscard]] std::vector<int> population_factors(const StudySettings& settings);
[[nodiscard]] std::vector<int> iteration_factors(const StudySettings& settings);

/// MOMVO and PMOMVO by name, in the order of tables; and the others.
[[nodiscard]] std::vector<std::string> own_algorithms();
[[nodiscard]] std::vector<std::string> other_algorithms();
[[nodiscard]] bool is_own(std::string_view algorithm);
/// Whether the sharing rate says anything to it.
[[nodiscard]] bool has_slaves(std::string_view algorithm);
/// The one that the paper settles on.
inline constexpr std::string_view kRetained = "pmomvo-6";

/// The variants of the whole study, none twice.
[[nodiscard]] std::vector<Variant> variants_of(const StudySettings& settings);

/// The seed of run number `run`, the same for every variant, so that runs can be compared in pairs.
[[nodiscard]] std::uint64_t run_seed(std::uint64_t seed, int run);

/// The shard's runs: those that are not timed, then the timed ones, each run by run through all variants, so that a
/// study that is cut short knows something of each.
[[nodiscard]] std::vector<Job> jobs_of(const StudySettings& settings);

/// The first line of the results file. from_header() throws std::runtime_error for anything that to_header() did not
/// write.
[[nodiscard]] nlohmann::ordered_json to_header(const StudySettings& settings);
[[nodiscard]] StudySettings from_header(const nlohmann::ordered_json& header);

/// As campaign::differences().
[[nodiscard]] std::vector<std::string> differences(const StudySettings& a, const std::string& name_a,
                                                   const StudySettings& b, const std::string& name_b);

}  // namespace jink::tools::lab::study
