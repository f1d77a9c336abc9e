// SPDX-License-Identifier: BSD-3-Clause
// What stands, as a log's header and its `seen` records have it: read.
#pragma once

#include <memory>

#include "bridge/map/mapper.hpp"
#include "planner/base/solid.hpp"
#include "planner/geometry/static_map.hpp"
#include "tools/log/log_reader.hpp"

namespace jink::tools::log {

// All throw std::invalid_argument that names the key.

/// The solid of a record with `prism` or `hull` (FlightLog).
[[nodiscard]] std::shared_ptr<const planner::base::Solid> solid_of(const Json& record);
/// The header's `map` or `stands`; none where it has none.
[[nodiscard]] std::shared_ptr<const planner::geometry::StaticMap> map_of(const Json& header, const char* key = "map");
/// What has been seen by a `seen` record, from what had been before (null: nothing); its map is that and what was known
/// (null: nothing).
[[nodiscard]] std::shared_ptr<const bridge::map::Seen> seen_of(const Json& record, const bridge::map::Seen* before,
                                                               const planner::geometry::StaticMap* known);

}  // namespace jink::tools::log
