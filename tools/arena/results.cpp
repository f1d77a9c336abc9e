// SPDX-License-Identifier: BSD-3-Clause
#include "tools/arena/results.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

namespace jink::arena {
namespace {

using Json = nlohmann::ordered_json;

std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw ResultsError(fmt::format("{}: cannot be read", file.string()));
  return text.str();
}

/// The flights and worlds that a file with these settings may hold.
struct Expected {
  explicit Expected(const CampaignSettings& settings) {
    for (Job& job : jobs_of(settings)) {
      worlds.emplace(job.world.number, job.world);
      const std::size_t number = job.number;
      jobs.emplace(number, std::move(job));
    }
  }
  void check(const FlightRecord& r) const {
    const auto found = jobs.find(r.job);
    if (found == jobs.end()) throw std::runtime_error(fmt::format("flight {} is not of this campaign", r.job));
    const Job& job = found->second;
    if (job.world.family != r.family || job.world.seed != r.seed || job.tier != r.tier || job.pilot != r.pilot)
      throw std::runtime_error(fmt::format("flight {} should be {}", r.job, job.name()));
  }
  void check(const WorldRecord& r) const {
    const auto found = worlds.find(r.world);
    if (found == worlds.end()) throw std::runtime_error(fmt::format("world {} is not of this campaign", r.world));
    if (found->second.family != r.family || found->second.seed != r.seed)
      throw std::runtime_error(
          fmt::format("world {} should be {}:{}", r.world, found->second.family, found->second.seed));
  }

  std::map<std::size_t, Job> jobs;
  std::map<std::size_t, World> worlds;
};

void add_line(const Json& line, const Expected& expected, Results& results) {
  const std::string type = line.is_object() ? line.value("type", "") : "";
  if (type == "flight") {
    FlightRecord record = flight_from(line);
    expected.check(record);
    results.add(std::move(record));
  } else if (type == "world") {
    const WorldRecord record = world_from(line);
    expected.check(record);
    results.add(record);
  } else {
    throw std::runtime_error("neither a flight nor a world");
  }
}

/// Throws nlohmann's exception.
Json parse(const std::string& text) {
  return Json::parse(text);
}

std::string system_error(const std::filesystem::path& file) {
  return fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno));
}

}  // namespace

void Results::add(FlightRecord record) {
  const auto found = flights.find(record.job);
  if (found == flights.end()) {
    const std::size_t job = record.job;
    flights.emplace(job, std::move(record));
  } else if (!same_result(found->second, record)) {
    throw ResultsError(fmt::format("flight {} ({}:{}, {}, {}) has two different results", record.job, record.family,
                                   record.seed, record.tier, record.pilot));
  }
}

void Results::add(const WorldRecord& record) {
  const auto [found, is_new] = worlds.emplace(record.world, record);
  if (!is_new && found->second.verdict != record.verdict)
    throw ResultsError(fmt::format("world {}:{} has two verdicts", record.family, record.seed));
}

std::filesystem::path results_path(const std::filesystem::path& out) {
  return out / "flights.jsonl";
}

bool has_begun(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(file, error) && read_text(file).find('\n') != std::string::npos;
}

Results read_results(const std::filesystem::path& file) {
  std::istringstream text(read_text(file));
  Results results;
  std::optional<Expected> expected;
  std::string line;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    if (text.eof()) {  // its end is missing
      results.cut_off = true;
      break;
    }
    try {
      const Json json = parse(line);
      if (expected) {
        add_line(json, *expected, results);
      } else {
        results.settings = from_header(json);
        expected.emplace(results.settings);
      }
    } catch (const Json::exception&) {
      throw ResultsError(fmt::format("{}:{}: is not JSON", file.string(), number));
    } catch (const std::runtime_error& error) {
      throw ResultsError(fmt::format("{}:{}: {}", file.string(), number, error.what()));
    }
  }
  if (!expected) throw ResultsError(fmt::format("{}: holds no header", file.string()));
  return results;
}

Results merge_results(const std::vector<std::filesystem::path>& folders) {
  Results merged;
  for (const std::filesystem::path& folder : folders) {
    Results part = read_results(results_path(folder));
    part.settings.shard = {};
    if (&folder == &folders.front()) merged.settings = part.settings;
    const auto differ = differences(merged.settings, folders.front().string(), part.settings, folder.string());
    if (!differ.empty()) throw ResultsError(fmt::format("these are two campaigns: {}", differ.front()));
    try {
      for (auto& [job, record] : part.flights) merged.add(std::move(record));
      for (const auto& [world, record] : part.worlds) merged.add(record);
    } catch (const ResultsError& error) {
      throw ResultsError(fmt::format("{}: {}", folder.string(), error.what()));
    }
  }
  return merged;
}

std::string to_text(const Results& results) {
  std::string text = to_header(results.settings).dump() + "\n";
  for (const auto& [world, record] : results.worlds) text += to_json(record).dump() + "\n";
  for (const auto& [job, record] : results.flights) text += to_json(record).dump() + "\n";
  return text;
}

void write_whole(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path unfinished = file.string() + ".part";
  {
    std::ofstream out(unfinished, std::ios::binary);
    out << text << std::flush;
    if (!out) throw ResultsError(system_error(file));
  }
  std::error_code error;
  std::filesystem::rename(unfinished, file, error);
  if (error) throw ResultsError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

ResultsFile::ResultsFile(const std::filesystem::path& file, const Results& results) : file_(file) {
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw ResultsError(system_error(file));
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw ResultsError(fmt::format("{}: another process is writing there", file.string()));
    const std::string text = read_text(file);
    const std::size_t end = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    if (::ftruncate(descriptor_, static_cast<off_t>(end)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0)
      throw ResultsError(system_error(file));
    if (end == 0) write(to_header(results.settings).dump() + "\n");
  } catch (const ResultsError&) {
    ::close(descriptor_);
    throw;
  }
}

ResultsFile::~ResultsFile() {
  ::close(descriptor_);
}

void ResultsFile::append(const Json& line) {
  write(line.dump() + "\n");
}

void ResultsFile::write(const std::string& text) {
  if (broken_) throw ResultsError(fmt::format("{}: could not be written before", file_.string()));
  broken_ = true;
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t n = ::write(descriptor_, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw ResultsError(system_error(file_));
    written += static_cast<std::size_t>(n);
  }
  broken_ = false;
}

}  // namespace jink::arena
