// SPDX-License-Identifier: BSD-3-Clause
// One flight of a campaign, and what a failed one leaves.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "config/scenario.hpp"
#include "config/settings.hpp"
#include "sim/flight/closed_loop.hpp"
#include "sim/recorded/recording.hpp"
#include "tools/lab/arena/flight_record.hpp"
#include "tools/lab/arena/settings.hpp"

namespace jink::tools::lab::arena {

/// Whether to give up now; asked at every turn of a flight, from the thread that flies.
using Stop = std::function<bool()>;

/// What a flight throws that was given up.
class Cancelled : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "given up"; }
};

using sim::recorded::Recording;

/// The world of a flight, sensed as its tier has it; of the family kRecorded, out of the recording. Throws
/// std::invalid_argument for an unknown family or tier, std::runtime_error where the recording has no such world.
[[nodiscard]] config::Scenario scenario_of(const World& world, std::string_view tier,
                                           const Recording* recording = nullptr);

/// How `pilot` flies in the closed loop, with one thread; each plan's wall time goes to `times`, where it is not null
/// (it outlives the flight).
[[nodiscard]] sim::flight::ClosedLoopOptions flight_options(const std::string& pilot, std::uint64_t seed,
                                                            const config::Settings& settings,
                                                            DurationHistogram* times = nullptr);

/// Flies. Throws Cancelled once `stop` says so, and what the simulator throws.
[[nodiscard]] FlightRecord fly(const Job& job, const config::Scenario& scenario, const config::Settings& settings,
                               const Stop& stop);

/// OUT/failed/NAME of a flight.
[[nodiscard]] std::filesystem::path failure_folder(const std::filesystem::path& out, const std::string& name);

struct FailureOptions {
  const std::filesystem::path& out;
  const config::Settings& settings;
  bool log = true;
};

/// Leaves scenario.yaml of a failed flight, as it was `flown`, in its folder and, if asked for, the log flight.jsonl,
/// by flying it again from the written scenario. Throws std::runtime_error where that ends differently (then something
/// is not deterministic), ResultsError where it cannot be written, and as fly().
void save_failure(const FailureOptions& options, const Job& job, const config::Scenario& flown,
                  const FlightRecord& record, const Stop& stop);

/// The command that flies a failed flight again and shows it, for a shell in today's working folder.
[[nodiscard]] std::string replay_command(const std::filesystem::path& out, const FlightRecord& record);

/// The oracle's answer. Seconds at most for most worlds.
[[nodiscard]] Verdict judge_world(const World& world, const Recording* recording = nullptr);

}  // namespace jink::tools::lab::arena
