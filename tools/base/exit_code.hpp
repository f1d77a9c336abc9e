// SPDX-License-Identifier: BSD-3-Clause
// How a command ends: exit codes, and the error that is bad usage.
#pragma once

#include <stdexcept>

namespace jink::tools::base {

/// Contracts, "Exit codes".
enum ExitCode : int { kExitReached = 0, kExitFailed = 1, kExitUsage = 2, kExitMissingPeer = 3 };

/// Bad usage or a file that cannot be read or written: exit code 2 with this one line.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace jink::tools::base
