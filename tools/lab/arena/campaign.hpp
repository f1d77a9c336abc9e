// SPDX-License-Identifier: BSD-3-Clause
// Flies the flights of a campaign that are still to be flown, several at once.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "config/settings.hpp"
#include "sim/recorded/recording.hpp"
#include "tools/lab/arena/results.hpp"

namespace jink::tools::lab::arena {

/// How far a campaign is.
struct Progress {
  std::size_t done = 0;    ///< flights, those of an earlier run too
  std::size_t total = 0;   ///< of the shard
  std::size_t flown = 0;   ///< in this run
  std::size_t failed = 0;  ///< of those done: not reached
  std::size_t hit = 0;     ///< of these: collisions
};

struct CampaignOptions {
  std::filesystem::path out;                                  ///< exists
  config::Settings settings;                                  ///< what results.settings.parameters lists
  std::shared_ptr<const sim::recorded::Recording> recording;  ///< that results.settings.recorded names, if it does
  int threads = 1;                                            ///< flights at once; each plans in its own thread
  bool logs = true;                                  ///< whether a failed flight leaves its log, beside its scenario
  std::function<bool()> interrupted;                 ///< asked often, from any thread; required
  std::function<void(const Progress&)> on_progress;  ///< called from the caller's thread a few times a second; required
};

/// Flies, appends each result to the file and puts it into `results`. A world in which nobody reached the target is
/// shown to the oracle once its flights have ended, if results.settings.oracle. True once all is flown and judged;
/// false where it was interrupted: flights under way are given up. The results do not depend on the number of threads.
/// What a flight throws ends the campaign: rethrown as std::runtime_error that names the flight, with all that ended
/// before in the file.
bool fly_campaign(Results& results, ResultsFile& file, const CampaignOptions& options);

}  // namespace jink::tools::lab::arena
