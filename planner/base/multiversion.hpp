// SPDX-License-Identifier: BSD-3-Clause
// One portable binary that uses wide registers where the processor has them.
#pragma once

/// Before a function's definition: compiled once for plain x86-64 and once for AVX2, chosen when the program is loaded.
/// What it calls must be inlined into it to profit. Every version gives the same bits: the operations are IEEE's, lane
/// by lane, and multiplications are not fused with additions (-ffp-contract=off). On other processors, and under the
/// sanitizers, whose run time is not up yet when the choice is made, there is one version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(JINK_ONE_VERSION)
#define JINK_MULTIVERSION __attribute__((target_clones("avx2", "default")))
#else
#define JINK_MULTIVERSION
#endif

/// For what a function with JINK_MULTIVERSION calls.
#define JINK_INLINED __attribute__((always_inline)) inline
