// SPDX-License-Identifier: BSD-3-Clause
// What real movers did: people, birds, drones, aircraft, as somebody recorded them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "planner/base/types.hpp"

namespace jink::sim::recorded {

/// Where one mover was when. At least two places.
struct Mover {
  std::string id;
  std::vector<double> times;  ///< s, of the recording's own clock; they increase
  std::vector<Vec3> points;   ///< ENU, m
  double radius = 0.0;        ///< m
  double height = 0.0;        ///< m, of a vertical cylinder about its point; 0: it is a sphere
};

struct Recording {
  std::vector<Mover> movers;      ///< in the order in which they come in the file
  std::size_t without_place = 0;  ///< rows that say of no place, and are left out
  std::size_t seen_once = 0;      ///< movers of one place, likewise
  std::uint64_t digest = 0;       ///< FNV-1a of the file's bytes
};

/// How large movers are where the file does not say so, m.
inline constexpr double kRadius = 0.3;          ///< of all but aircraft
inline constexpr double kPersonHeight = 1.8;    ///< of people, whose feet are at z = 0
inline constexpr double kAircraftRadius = 6.0;  ///< half of a light aircraft's span

/// Reads a recording. Its kind follows from the first line:
/// - CSV with a header that names `t`, `id`, `x`, `y` and `z` (s, ENU, m) and perhaps `radius` and `height` (m):
/// spheres,
///   or cylinders where there is a height.
/// - CSV of ADS-B, as the OpenSky Network's state vectors are: a header that names a time (`time`, `timestamp` or `t`,
///   s), an address (`icao24`, `hex` or `id`), `lat` and `lon` (or `latitude`, `longitude`; degrees) and a height
///   (`geoaltitude`, `baroaltitude`, `altitude` or `alt`, m; the first of these that is there), and perhaps
///   `radius`: spheres. The origin is below the first place, at sea level. Rows without a place are left out.
/// - The pedestrian sets ETH and UCY: no header, numbers between blanks; four in a line (frame, id, x, y) and more that
///   are not read, or the eight of ETH's obsmat (frame, id, x, z, y, and a velocity that is not read). People,
///   cylinders on the ground; the frames that are annotated are 0.4 s apart, as in those sets.
/// Columns come in any order, others are not read; letters' case does not count. Empty lines and those that begin with
/// # are left out.
///
/// Throws config::ConfigError (config/error.hpp) for anything else: unreadable or larger than 256 MiB, a value that is
/// no number or out of range (times 1e11 s, coordinates 1e6 m), a mover that is twice at one time or faster than 1000
/// m/s, nobody who moves through two places. O(rows · log(rows)).
[[nodiscard]] Recording load_recording(const std::filesystem::path& file);

}  // namespace jink::sim::recorded
