// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/study/machine.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <stdexcept>
#include <thread>

namespace jink::tools::lab::study {
namespace {

using Json = nlohmann::ordered_json;

/// "model name" is what x86 has; on ARM the device tree has the board's.
std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const auto colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  std::ifstream model("/proc/device-tree/model");
  std::string board;
  std::getline(model, board, '\0');
  return board.empty() ? "unknown" : board;
}

std::string compiler_name() {
#if defined(__clang__)
  return fmt::format("Clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  return fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "unknown";
#endif
}

}  // namespace

Machine this_machine() {
#ifdef NDEBUG
  const char* const build = "optimised";
#else
  const char* const build = "with assertions";
#endif
  utsname names{};
  const bool known = uname(&names) == 0;
  return {cpu_name(), static_cast<int>(std::thread::hardware_concurrency()),
          fmt::format("{}, {}", compiler_name(), build),
          known ? fmt::format("{} {} {}", names.sysname, names.release, names.machine) : "unknown"};
}

Json to_json(const Machine& m) {
  return {{"type", "machine"}, {"cpu", m.cpu}, {"cores", m.cores}, {"compiler", m.compiler}, {"system", m.system}};
}

Machine machine_from(const Json& line) {
  try {
    return {line.at("cpu").get<std::string>(), line.at("cores").get<int>(), line.at("compiler").get<std::string>(),
            line.at("system").get<std::string>()};
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("the machine: ") + error.what());
  }
}

}  // namespace jink::tools::lab::study
