// SPDX-License-Identifier: BSD-3-Clause
// Puts the parts of a campaign together.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "tools/lab/campaign/jsonl_file.hpp"

namespace jink::tools::lab::campaign {

/// The results of all folders, of whose settings only the shards may differ. `read(folder)` gives a part, `take(merged,
/// part)` moves what is in it. Throws ResultsError, which names the folder or says that these are two of `kind`.
template <class Results, class Read, class Take>
Results merge(const std::vector<std::filesystem::path>& folders, const char* kind, const Read& read, const Take& take) {
  Results merged;
  for (const std::filesystem::path& folder : folders) {
    Results part = read(folder);
    part.settings.shard = {};
    if (&folder == &folders.front()) merged.settings = part.settings;
    const auto differ = differences(merged.settings, folders.front().string(), part.settings, folder.string());
    if (!differ.empty()) throw ResultsError(fmt::format("these are two {}: {}", kind, differ.front()));
    try {
      take(merged, part);
    } catch (const ResultsError& error) {
      throw ResultsError(fmt::format("{}: {}", folder.string(), error.what()));
    }
  }
  return merged;
}

}  // namespace jink::tools::lab::campaign
