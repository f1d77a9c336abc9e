// SPDX-License-Identifier: BSD-3-Clause
// Bytes as a flight log: what the report and the replay make of it is refused with one line, or is data. What the
// replay accepts can be planned: the first plans are, by a small planner.
#include <stdexcept>

#include "config/error.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/log/flight_replay.hpp"
#include "tools/report/flight_data.hpp"
#include "tools/report/report_data.hpp"

namespace {

using jink::fuzz::require;

constexpr int kPlanned = 3;
constexpr std::size_t kMostTracks = 50;

jink::planner::base::HorizonSettings small() {
  jink::planner::base::HorizonSettings settings;
  settings.waypoints = 2;
  settings.time = 2.0;
  settings.slaves = 2;
  settings.population = 8;
  settings.generations = 2;
  return settings;
}

void plan(jink::tools::log::RecordedPlan& recorded, jink::planner::horizon::HorizonPlanner& planner,
          jink::planner::base::WorkerPool& pool) {
  jink::bridge::companion::PlanJob& job = recorded.job;
  job.request.tracks = job.tracks;
  const jink::planner::verify::Plan made = planner.plan(job.request, job.previous, 1, job.number, {2}, pool);
  require(made.path.empty() == (made.status == jink::planner::verify::PlanStatus::kInvalid), "a plan without a path");
}

void replay(const std::filesystem::path& file) {
  static jink::planner::horizon::HorizonPlanner planner(small());
  static jink::planner::base::WorkerPool pool(1);
  jink::tools::log::FlightRecording recording(file);
  std::vector<std::string> missing;
  try {
    (void)jink::config::recorded_settings(recording.source(), recording.parameters(), {}, missing);
  } catch (const jink::config::ConfigError& error) {
    require(std::strchr(error.what(), '\n') == nullptr, "an error of more than one line");
  }
  for (int i = 0; auto recorded = recording.next(); ++i) {
    if (i < kPlanned && recorded->job.tracks.size() <= kMostTracks) plan(*recorded, planner, pool);
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static jink::fuzz::MemoryFile file;
  file.write(data, size);
  for (const bool report : {true, false}) {
    try {
      if (report) {
        (void)jink::tools::report::report_data(jink::tools::report::read_flight(file.path()), nullptr);
      } else {
        replay(file.path());
      }
    } catch (const std::runtime_error& error) {
      require(std::strstr(error.what(), "/proc/self/fd/") != nullptr, "an error that does not name the file");
      require(std::strchr(error.what(), '\n') == nullptr, "an error of more than one line");
    }
  }
  return 0;
}
