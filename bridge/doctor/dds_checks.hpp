// SPDX-License-Identifier: BSD-3-Clause
// What `jink doctor` says of the DDS side of a mission.
#pragma once

#include <stop_token>
#include <vector>

#include "bridge/doctor/check.hpp"
#include "config/mission.hpp"

namespace jink::bridge::doctor {

/// Listens in the mission's domain for `seconds` (blocks that long, or until `stop` says so) and says what it saw: the
/// domain's participants, then each topic that the mission needs, tracks first. Nothing is ever published.
///
/// A topic is kOk with writers that match and data that arrive (rate, age of the stamps), or readers that match what
/// the mission writes. kFault: payloads or frames that cannot be used, another type on the topic, a QoS that does not
/// match (by the policy's name), matched without any data. kMissing: nobody, where the mission needs somebody: any
/// source of tracks with tracks.required, each writer that the mission names, the clouds of points of a mission with
/// `cloud`, the position with state: dds, the readers of setpoints with setpoints: dds. kWarning: stamps that are more
/// than a second off, two writers of the position, tracks that are not required and not there, messages without an
/// obstacle, a writer of tracks that the mission does not name. Near matches of the name (without rt/, other namespace,
/// another version's suffix, a slip of the pen) and of the type are named in the finding or the remedy.
/// @throws std::runtime_error, one line, when Fast DDS cannot open its transports.
[[nodiscard]] std::vector<Check> inspect_dds(const config::Mission& mission, double seconds,
                                             const std::stop_token& stop = {});

}  // namespace jink::bridge::doctor
