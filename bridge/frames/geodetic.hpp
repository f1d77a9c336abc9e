// SPDX-License-Identifier: BSD-3-Clause
// A place on the earth. What converts it is bridge/frames.
#pragma once

namespace jink::bridge::frames {

/// WGS 84. One altitude datum is used throughout: that of the autopilot's origin (GPS_GLOBAL_ORIGIN, above mean sea
/// level); only differences of altitudes are ever used.
struct Geodetic {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;

  bool operator==(const Geodetic&) const = default;
};

}  // namespace jink::bridge::frames
