// SPDX-License-Identifier: BSD-3-Clause
// What a study was run on: without it, times say nothing.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace jink::tools::lab::study {

struct Machine {
  std::string cpu;       ///< its name as the system gives it; "unknown" where it does not
  int cores = 0;         ///< that this process may use
  std::string compiler;  ///< with its version, and the kind of build
  std::string system;    ///< kernel and architecture
  bool operator==(const Machine&) const = default;
};

/// The one that this runs on.
[[nodiscard]] Machine this_machine();

/// A line of the results file, and the inverse, which throws std::runtime_error for anything else.
[[nodiscard]] nlohmann::ordered_json to_json(const Machine& machine);
[[nodiscard]] Machine machine_from(const nlohmann::ordered_json& line);

}  // namespace jink::tools::lab::study
