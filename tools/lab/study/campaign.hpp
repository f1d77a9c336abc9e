// SPDX-License-Identifier: BSD-3-Clause
// Makes the study's runs that are still to be made.
#pragma once

#include <functional>

#include "tools/lab/study/results.hpp"
#include "tools/lab/study/run.hpp"

namespace jink::tools::lab::study {

/// How far a study is. Seconds are of the wall, estimated from the runs that this call has made; 0 before the first.
struct Progress {
  std::size_t done = 0;               ///< runs, those of an earlier call too
  std::size_t total = 0;              ///< of the shard
  double seconds_before = 0.0;        ///< that the runs of an earlier call would take
  double seconds_in_this_call = 0.0;  ///< that this call's runs took
  double seconds_left = 0.0;
  bool timing = false;  ///< the timed runs have begun
};

struct CampaignOptions {
  int threads = 1;                                   ///< runs at once; of the planner in a timed run
  std::function<bool()> interrupted;                 ///< asked often, from any thread; required
  std::function<void(const Progress&)> on_progress;  ///< called from the caller's thread a few times a second; required
};

/// Makes the runs, appends each to the file and puts it into `results`: first those that are not timed, several at once
/// with one thread each, then the timed ones one by one, each with the threads of the planner to itself. True once all
/// are there; false where it was interrupted: runs under way end. What a run throws ends the study: rethrown as
/// std::runtime_error that names the run, with all that ended before in the file.
bool run_campaign(Results& results, campaign::JsonLinesFile& file, const Setting& setting,
                  const CampaignOptions& options);

}  // namespace jink::tools::lab::study
