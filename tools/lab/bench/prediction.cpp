// SPDX-License-Identifier: BSD-3-Clause
// Whether what is stated of where movers will be is true: how often they are in the regions stated.
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/families/families.hpp"
#include "sim/families/recorded.hpp"
#include "tools/lab/bench/measure.hpp"
#include "tools/lab/calibration/calibration.hpp"

namespace jink::tools::lab::bench {
namespace {

using calibration::Calibration;
using calibration::kLeads;

std::vector<std::string> cells(const std::string& name, const Calibration& calibration) {
  std::vector<std::string> cells{name, fmt::format("{:.0f}", calibration.predictions())};
  for (const Calibration::Lead& lead : calibration.leads) {
    for (std::size_t k = 0; k < lead.inside.size(); ++k) cells.push_back(fmt::format("{:.1f}", 100.0 * lead.share(k)));
    cells.push_back(fmt::format("{:.2f}", lead.rms()));
  }
  return cells;
}

}  // namespace

void bench_prediction(const Options& options) {
  print_title(
      "prediction",
      fmt::format("Realistic tracks: how often a mover is in the region stated for 50, 90 and 99 %, and the root "
                  "mean square of the error, m, at {}, {} and {} s; {} worlds of each family.",
                  kLeads[0], kLeads[1], kLeads[2], options.seeds));
  Table table({"movers", "predictions", "50 %", "90", "99", "0.5 s, m", "50 %", "90", "99", "1 s, m", "50 %", "90",
               "99", "2 s, m"});
  Calibration all;
  const auto add = [&](const std::string& name, const auto& make) {
    Calibration sum;
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(options.seeds); ++seed) {
      config::Scenario scenario = make(seed);
      set_tier(scenario, sim::families::Tier::kRealistic, seed);
      sum.add(calibration::watch(scenario, seed));
    }
    if (sum.predictions() == 0.0) return;
    all.add(sum);
    table.row(cells(name, sum));
  };
  for (const std::string_view family : measured_families(options))
    add(std::string(family), [family](std::uint64_t seed) { return sim::families::make_world(family, seed); });
  for (const std::string& file : options.recordings) {
    const sim::recorded::Recording recording = sim::recorded::load_recording(file);
    add(std::filesystem::path(file).filename().string(),
        [&](std::uint64_t seed) { return sim::families::make_recorded_world(recording, seed); });
  }
  table.row(cells("all", all));
  table.print();
}

}  // namespace jink::tools::lab::bench
