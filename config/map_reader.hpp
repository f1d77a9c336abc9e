// SPDX-License-Identifier: BSD-3-Clause
// The keys `map` and `no_fly` of scenarios and missions: what stands still and is known beforehand. Not a public
// header.
#pragma once

#include <filesystem>
#include <vector>

#include "config/scenario.hpp"
#include "config/yaml.hpp"

namespace jink::config {

/// The solids of `keys`, found in `file`: first those of `map`, then those of `no_fly`.
///
/// `map` is a list of obstacles without any motion, or the name of a file, from the folder of `file` on: such a list as
/// YAML, or an OctoMap (config/octomap.hpp). `no_fly` is a list of {polygon: [[x, y], ...], min: z, max: z}: 3 to 1000
/// corners of a simple polygon in either turn, convex or not. At most 100000 solids in all. Throws ConfigError; of
/// what is wrong within the map's file, with that one's place.
std::vector<Obstacle> read_map(const Map& keys, const std::filesystem::path& file);

}  // namespace jink::config
