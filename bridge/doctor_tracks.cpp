// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/doctor_tracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "bridge/clock.hpp"
#include "bridge/dds_tracks.hpp"

namespace jink::bridge {

namespace {

using Level = Check::Level;

constexpr auto kSlice = std::chrono::milliseconds(20);
constexpr double kClockOffset_s = 1.0;  // beyond which a stamp is not believed (TrackTable)

Check no_data(const config::Mission& mission, const TrackSourceStatus& status, double seconds) {
  const Level level = mission.tracks.required ? Level::kMissing : Level::kWarning;
  if (status.bad_frames > 0) {
    return {Level::kFault, kTracksTopic, "all refused: " + status.last_refusal,
            "have the writer publish in the frame map (ENU from the local origin)"};
  }
  if (status.writers > 0) {
    return {level, kTracksTopic, fmt::format("{} writer, but no data within {:.1f} s", status.writers, seconds),
            "shared memory between containers? run the writer with UDP alone (FASTDDS_BUILTIN_TRANSPORTS=UDPv4)"};
  }
  return {level, kTracksTopic, fmt::format("no writer on domain {} within {:.1f} s", mission.dds_domain, seconds),
          "start `jink sim SCENARIO` or your track writer, or check the mission's dds.domain"};
}

}  // namespace

std::vector<Check> inspect_tracks(const config::Mission& mission, double seconds, const std::stop_token& stop) {
  if (!mission.tracks.sources.jink) return {};
  const SteadyClock clock;
  DdsTrackReader reader(mission.dds_domain, clock);
  std::uint64_t messages = 0;
  double first = 0.0;
  double last = 0.0;
  double least_age = planner::kInfinity;
  std::size_t most = 0;
  while (clock.now() < seconds && !stop.stop_requested()) {
    for (TrackMessage message; reader.poll(message); ++messages) {
      if (messages == 0) first = message.received;
      last = message.received;
      least_age = std::min(least_age, message.stamp_age);
      most = std::max(most, message.tracks.size());
    }
    std::this_thread::sleep_for(kSlice);
  }
  const TrackSourceStatus status = reader.status();
  if (messages == 0) return {no_data(mission, status, seconds)};
  const double rate = messages > 1 ? static_cast<double>(messages - 1) / (last - first) : 0.0;
  std::vector<Check> checks{{Level::kOk, kTracksTopic,
                             fmt::format("{} writer{}, {:.1f} messages/s, up to {} tracks", status.writers,
                                         status.writers == 1 ? "" : "s", rate, most),
                             ""}};
  if (std::abs(least_age) > kClockOffset_s) {
    checks.push_back({Level::kWarning, "track clock", fmt::format("stamps are {:.1f} s off", least_age),
                      "synchronise the clocks (chrony); until then delays are guessed from the arrival"});
  }
  if (status.dropped_tracks + status.bad_frames + reader.malformed() > 0) {
    checks.push_back({Level::kWarning, "refused tracks",
                      fmt::format("{} tracks, {} messages by frame, {} undecodable; {}", status.dropped_tracks,
                                  status.bad_frames, reader.malformed(), status.last_refusal),
                      "correct the writer"});
  }
  return checks;
}

}  // namespace jink::bridge
