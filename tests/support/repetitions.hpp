// SPDX-License-Identifier: BSD-3-Clause
// Fewer repetitions under the sanitizers, where a flight takes ten times as long and the first of its kind touches the
// same memory. The release suite does them all.
#pragma once

#include <initializer_list>
#include <vector>

namespace jink::support {

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define JINK_SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define JINK_SANITIZED 1
#endif

#ifdef JINK_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// All of `cases`; under a sanitizer the first.
template <class Case>
std::vector<Case> repetitions(std::initializer_list<Case> cases) {
  if (kSanitized) return {*cases.begin()};
  return cases;
}

}  // namespace jink::support
