// SPDX-License-Identifier: BSD-3-Clause
// Counts heap allocations, on every thread, to prove that a hot path makes none. Linking allocation_guard.cpp replaces
// the global operator new and delete of the test binary. Memory that is taken from malloc directly is not seen; the
// planner has no such place, since its Eigen types have a fixed size.
#pragma once

#include <cstddef>

namespace jink::test {

/// Counts the calls of operator new, by any thread, since its construction.
class AllocationGuard {
 public:
  AllocationGuard();
  [[nodiscard]] std::size_t count() const;

 private:
  std::size_t at_start_;
};

}  // namespace jink::test
