// SPDX-License-Identifier: BSD-3-Clause
// Random streams that give the same numbers on every machine. The standard library's engines are portable but its
// distributions are not, so the bits are mapped to reals and to ranges here. Not for cryptography.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "planner/base/portable_math.hpp"

namespace jink::planner::base {

/// SplitMix64 (Steele, Lea and Flood 2014; constants of Vigna's public-domain splitmix64.c). A bijective mix of a
/// counter: good for spreading seeds, which is all that it is used for here.
class SplitMix64 {
 public:
  /// Begins at this counter; any value will do.
  explicit constexpr SplitMix64(std::uint64_t seed) noexcept : state_(seed) {}

  /// The next 64 bits.
  constexpr std::uint64_t next() noexcept {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31U);
  }

 private:
  std::uint64_t state_;
};

/// xoshiro256++ 1.0 (Blackman and Vigna 2019, public-domain reference xoshiro256plusplus.c). Period 2^256 - 1; the
/// state must not be all zero.
class Xoshiro256PlusPlus {
 public:
  /// Begins in this state. Precondition: not all zero.
  explicit constexpr Xoshiro256PlusPlus(const std::array<std::uint64_t, 4>& state) noexcept : state_(state) {}

  /// The next 64 bits.
  constexpr std::uint64_t next() noexcept {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t shifted = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

 private:
  std::array<std::uint64_t, 4> state_;
};

/// A stream of random numbers that depends on (seed, stream, substream) alone: the seed of the run, then for example
/// the slave and the generation, never the thread. Streams of different triples are unrelated for all practical
/// purposes (the three are hashed to 64 bits). O(1) per number, no heap. A value type; one stream is not to be shared
/// by threads.
///
/// The same bits on every machine.
class RandomStream {
 public:
  /// The stream of this name: seed, stream and substream.
  explicit constexpr RandomStream(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t substream = 0) noexcept
      : engine_(spread(seed, stream, substream)) {}

  /// 64 random bits.
  constexpr std::uint64_t next() noexcept { return engine_.next(); }

  /// Uniform in [0, 1): one of the 2^53 multiples of 2^-53, equally likely.
  constexpr double uniform() noexcept { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }

  /// Two independent numbers from one draw, uniform in [0, 1): multiples of 2^-32, equally likely.
  constexpr std::array<double, 2> uniform_pair() noexcept {
    const std::uint64_t bits = next();
    return {static_cast<double>(bits >> 32U) * 0x1.0p-32, static_cast<double>(bits & 0xffffffffU) * 0x1.0p-32};
  }

  /// Uniform in [lo, hi]; `hi` itself only where rounding reaches it, and always when lo == hi. Requires lo <= hi, both
  /// finite, and a finite hi - lo.
  constexpr double uniform(double lo, double hi) noexcept {
    assert(lo <= hi);
    const double value = lo + (hi - lo) * uniform();
    return value < hi ? value : hi;  // rounding of the sum must not leave the interval
  }

  /// Uniform in 0 .. n - 1, without bias. Requires n > 0.
  constexpr std::uint64_t below(std::uint64_t n) noexcept {
    assert(n > 0);
    // 2^64 mod n values at the bottom are rejected, which leaves a whole number of runs 0 .. n - 1.
    const std::uint64_t rejected = (0 - n) % n;
    std::uint64_t bits = next();
    while (bits < rejected) bits = next();
    return bits % n;
  }

  /// Normal with mean 0 and standard deviation 1, by Marsaglia's polar method. Each second call uses up the number that
  /// the first one left over, and draws nothing.
  double normal() noexcept {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double u = 0.0;
    double v = 0.0;
    double square = 0.0;
    do {
      u = 2.0 * uniform() - 1.0;
      v = 2.0 * uniform() - 1.0;
      square = u * u + v * v;
    } while (square >= 1.0 || square == 0.0);
    const double factor = std::sqrt(-2.0 * logarithm(square) / square);
    spare_ = v * factor;
    has_spare_ = true;
    return u * factor;
  }

 private:
  static constexpr std::array<std::uint64_t, 4> spread(std::uint64_t seed, std::uint64_t stream,
                                                       std::uint64_t substream) noexcept {
    // Each stage is a bijection of its word, so that triples that differ in one place alone can never collide.
    const std::uint64_t with_seed = SplitMix64(seed).next();
    const std::uint64_t with_stream = SplitMix64(with_seed ^ stream).next();
    SplitMix64 mix(with_stream ^ substream);
    // Four outputs of a bijection at four counters differ, so the state is never all zero.
    return {mix.next(), mix.next(), mix.next(), mix.next()};
  }

  Xoshiro256PlusPlus engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace jink::planner::base
