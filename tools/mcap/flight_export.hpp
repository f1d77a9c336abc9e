// SPDX-License-Identifier: BSD-3-Clause
// A flight log as an MCAP recording, for Foxglove, PlotJuggler and whatever else reads MCAP.
#pragma once

#include <cstdint>
#include <filesystem>

namespace jink::tools::mcap {

struct ExportResult {
  std::uint64_t messages = 0;
  std::size_t lines = 0;    ///< of the log, the header and skipped ones included
  std::size_t skipped = 0;  ///< of these: cut off at the end, without finite numbers, or of an unknown type
};

/// Reads the flight log `log` and writes `mcap`, whole or not at all: a temporary file is renamed. Messages are JSON
/// with JSON schemas; lengths in m, angles in rad, frame `map` (ENU, the log's own origin), and `vehicle`, `vehicle_N`
/// for a team's others, which `/tf` places in it (the log holds no attitude: they keep the axes of `map`). Message time
/// is the log's `t` in ns; where that begins below zero, all times are raised by whole seconds, which the metadata
/// record `jink` tells (`epoch_s`: the log's t at time 0).
///
/// One message for each record: /truth/pose, /truth/pose_N, /state/pose, /setpoint/pose (foxglove.PoseInFrame), /plan
/// (foxglove.PosesInFrame), /plan/time (jink.PlanTime {ms, status, kept, missed}), /events (foxglove.Log), and for each
/// sample of the vehicle /tf (foxglove.FrameTransform) and /speed (jink.Speed {speed, height}). /clearance
/// (jink.Clearance {clearance, from}) has one for each instant at which it is known. foxglove.SceneUpdate:
/// /scene/flight once (volume, start, target, the whole way), /scene/map once (what stands), /scene/seen twice a second
/// (what of it had been seen), /scene/vehicle once, /scene/obstacles (true shapes) and /scene/tracks (as tracked, and
/// where they are predicted to be within 2 s) at 20 Hz, /scene/plan with each plan, and the guide that it was led by.
///
/// Throws std::runtime_error as read_flight() does and where the file cannot be written.
ExportResult export_mcap(const std::filesystem::path& log, const std::filesystem::path& mcap);

}  // namespace jink::tools::mcap
