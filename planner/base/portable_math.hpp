// SPDX-License-Identifier: BSD-3-Clause
// Functions of the C library whose last bit differs between machines (and, in one library, between processors), in
// plain IEEE arithmetic: the same bits everywhere.
#pragma once

#include <cassert>
#include <cmath>
#include <numbers>

namespace jink::planner::base {

/// atan2(y, x) for y >= 0: rad in [0, π]; 0 at the origin. Within 4e-16. Plain selects and arithmetic, so that a loop
/// over lanes is vectorised. The rational approximation is that of Cephes's atan.c (Moshier 1989), used up to tan(π/8).
inline double arc_tangent2(double y, double x) {
  constexpr double kTanPi8 = 0.41421356237309504880;
  const double a = std::abs(x);
  const double high = a > y ? a : y;
  const double low = a > y ? y : a;
  const bool upper = low > kTanPi8 * high;  // from π/8 to π/4: atan t = π/4 + atan((t − 1)/(t + 1))
  const double numerator = upper ? low - high : low;
  const double denominator = upper ? low + high : high;
  const double t = numerator / (denominator > 0.0 ? denominator : 1.0);
  const double z = t * t;
  const double p =
      (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
       1.228866684490136173410e2) *
          z -
      6.485021904942025371773e1;
  const double q =
      ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
       4.853903996359136964868e2) *
          z +
      1.945506571482613964425e2;
  const double octant = t + t * (z * p / q) + (upper ? 0.25 * std::numbers::pi : 0.0);
  const double quadrant = y > a ? 0.5 * std::numbers::pi - octant : octant;
  return x < 0.0 ? std::numbers::pi - quadrant : quadrant;
}

/// Natural logarithm of a finite x > 0, within 2 units in the last place of max(1, |result|): the series of atanh about
/// the nearest power of two.
inline double logarithm(double x) {
  assert(x > 0.0);
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // [0.5, 1)
  if (mantissa < 0.5 * std::numbers::sqrt2) {
    mantissa *= 2.0;
    --exponent;
  }
  const double t = (mantissa - 1.0) / (mantissa + 1.0);  // |t| < 0.172
  const double z = t * t;
  double series = 0.0;
  for (int k = 25; k >= 3; k -= 2) series = (series + 1.0 / k) * z;
  return exponent * std::numbers::ln2 + 2.0 * (t + t * series);
}

/// e^x for |x| <= 700, within 4e-16 of the result for small x: Taylor's series about the nearest multiple of ln 2.
inline double exponential(double x) {
  assert(std::abs(x) <= 700.0);
  const double power = std::floor(x / std::numbers::ln2 + 0.5);
  const double r = x - power * std::numbers::ln2;  // |r| < 0.35
  double series = 1.0;
  for (int k = 16; k >= 1; --k) series = 1.0 + series * (r / k);
  return std::ldexp(series, static_cast<int>(power));
}

/// Both of one angle.
struct SineCosine {
  double sine = 0.0,  ///< of the angle
      cosine = 1.0;   ///< of the same angle
};

/// Of |x| <= 1e5 rad, within 4e-16 for small x and 1e-11 at that bound: Taylor's series about the nearest multiple of
/// a right angle, whose value is taken in two parts.
inline SineCosine sine_cosine(double x) {
  assert(std::abs(x) <= 1e5);
  constexpr double kHigh = 1.57079632673412561417e+00;  // 33 bits of pi / 2
  constexpr double kLow = 6.07710050650619224932e-11;   // and the rest
  const double turns = std::floor(x / (kHigh + kLow) + 0.5);
  const double r = (x - turns * kHigh) - turns * kLow;  // |r| < 0.79
  const double z = r * r;
  double sine = 0.0;
  double cosine = 0.0;
  for (int k = 16; k >= 2; k -= 2) {
    sine = (1.0 + sine) * -z / (k * (k + 1.0));
    cosine = (1.0 + cosine) * -z / (k * (k - 1.0));
  }
  sine = r + r * sine;
  cosine += 1.0;
  const int quadrant = static_cast<int>(turns - 4.0 * std::floor(0.25 * turns));
  if (quadrant == 0) return {sine, cosine};
  if (quadrant == 1) return {cosine, -sine};
  if (quadrant == 2) return {-sine, -cosine};
  return {-cosine, sine};
}

/// sqrt(x² + y²), within 1 unit in the last place for sizes of 1e-150 to 1e150: Borges, "Algorithm 1014: An Improved
/// Algorithm for hypot(x,y)", ACM TOMS 47(1), 2020, without fused multiplication. NaN where either is.
inline double hypotenuse(double x, double y) {
  const bool steep = std::abs(x) < std::abs(y);
  const double a = std::abs(steep ? y : x);
  const double b = std::abs(steep ? x : y);
  if (b <= a * 0x1p-54) return a + b;
  const double h = std::sqrt(a * a + b * b);
  double excess = 0.0;  // of h², to the first order
  if (h <= 2.0 * b) {
    const double d = h - b;
    excess = a * (2.0 * d - a) + (d - 2.0 * (a - b)) * d;
  } else {
    const double d = h - a;
    excess = 2.0 * d * (a - 2.0 * b) + ((4.0 * d - b) * b + d * d);
  }
  return h - excess / (2.0 * h);
}

}  // namespace jink::planner::base
