// SPDX-License-Identifier: BSD-3-Clause
// How many worlds of each family have a flight, and what it costs to know: jink_oracle_table [LAST_SEED [FAMILY...]].
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "sim/families/families.hpp"
#include "tools/lab/oracle/feasibility.hpp"

namespace {

using jink::tools::lab::oracle::Verdict;

/// s, of this thread's processor: other processes have no say in it.
double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void print_family(const std::string& family, int last_seed) {
  int count[3] = {0, 0, 0};
  std::string open;  // the seeds without a flight
  std::vector<double> times;
  for (int seed = 1; seed <= last_seed; ++seed) {
    const auto scenario = jink::sim::families::make_world(family, static_cast<std::uint64_t>(seed));
    const double begun = processor_time();
    const Verdict verdict = jink::tools::lab::oracle::judge(scenario).verdict;
    times.push_back(processor_time() - begun);
    ++count[static_cast<int>(verdict)];
    if (verdict != Verdict::kSolvable) open += " " + std::to_string(seed);
  }
  double sum = 0.0;
  for (const double time : times) sum += time;
  std::printf("%-22s %5d %5d %5d  %8.3f %8.3f %s\n", family.c_str(), count[0], count[1], count[2],
              sum / static_cast<double>(times.size()), *std::max_element(times.begin(), times.end()), open.c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  int last_seed = 10;
  if (argc > 1) {
    const std::string_view text = argv[1];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), last_seed);
    if (error != std::errc() || end != text.data() + text.size() || last_seed < 1 || last_seed > 1000000) {
      std::fprintf(stderr, "LAST_SEED '%s': expected an integer in [1, 1000000]\n", argv[1]);
      return 2;
    }
  }
  std::vector<std::string> families(argv + std::min(argc, 2), argv + argc);
  const auto known = jink::sim::families::world_families();
  const auto others = jink::sim::families::others_families();
  for (const std::string& family : families) {
    if (std::find(known.begin(), known.end(), family) != known.end()) continue;
    if (std::find(others.begin(), others.end(), family) != others.end()) continue;
    std::fprintf(stderr, "FAMILY '%s' is not a world family\n", family.c_str());
    return 2;
  }
  if (families.empty()) families.assign(known.begin(), known.end());
  std::printf("%-22s %5s %5s %5s  %8s %8s %s\n", "family", "solv.", "imp.", "unkn.", "mean s", "most s", "not solved");
  for (const std::string& family : families) print_family(family, last_seed);
  return 0;
}
