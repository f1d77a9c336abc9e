// SPDX-License-Identifier: BSD-3-Clause
// Maps that OctoMap writes (Hornung and others, "OctoMap: an efficient probabilistic 3D mapping framework based on
// octrees", 2013): trees of cubes, read without its library, which prints what it thinks of a broken file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "config/scenario.hpp"

namespace jink::config {

/// Whether the file begins as OctoMap's do, or is named as they are, .bt or .ot.
[[nodiscard]] bool is_octomap(const std::filesystem::path& file);

/// The occupied leaves as boxes, rows of leaves merged as long as they make boxes; what is unknown is free. Reads
/// binary trees (.bt) and full ones (.ot) of type OcTree or ColorOcTree; of a full one's leaves those are occupied that
/// are so with a probability of one half or more, as OctoMap has it.
///
/// Throws ConfigError where the file cannot be read, is of another type, cut off or longer than its tree, has a
/// resolution that is not in (0, 1000] or a box beyond 1e5 m; where it is larger than 256 MiB, has more than 4 million
/// occupied leaves or becomes more than `most` boxes.
std::vector<Obstacle> load_octomap(const std::filesystem::path& file, std::size_t most);

}  // namespace jink::config
