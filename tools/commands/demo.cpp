// SPDX-License-Identifier: BSD-3-Clause
// jink demo: a flight against the simulator: `jink sim` and `jink fly` as two processes, then the report.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "config/settings.hpp"
#include "tools/cli/command_line.hpp"
#include "tools/commands/commands.hpp"
#include "tools/report/html_report.hpp"

namespace jink::tools::commands {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kHeadStart{500};  // of the simulator: a port that is taken shows by then
constexpr std::chrono::milliseconds kPoll{20};

struct DemoOptions {
  std::string scenario;
  std::string mission;
  std::string out = "jink-demo";
};

/// A command of this program in a process of its own, which goes when this one goes.
class Child {
 public:
  /// What it prints goes to the file `output`; empty: to where this program's does. No thread runs yet. Throws
  /// std::system_error.
  Child(std::vector<std::string> arguments, const std::string& output) {
    const std::string program = fs::read_symlink("/proc/self/exe").string();
    arguments.insert(arguments.begin(), "jink");
    std::vector<char*> words;
    words.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ < 0) throw std::system_error(errno, std::generic_category(), "no process can be started");
    if (process_ > 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);    // NOLINT: the system's interface
    std::signal(SIGPIPE, SIG_DFL);         // what is ignored stays so in a new program
    if (!output.empty()) ::setpgid(0, 0);  // Ctrl-C is for who is heard: the simulator outlives the flight
    if (::getppid() != parent) ::_exit(base::kExitFailed);
    const int file =
        output.empty() ? -1 : ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);  // NOLINT: likewise
    if (file >= 0) {
      ::dup2(file, STDOUT_FILENO);
      ::dup2(file, STDERR_FILENO);
      ::close(file);
    }
    ::execv(program.c_str(), words.data());
    ::_exit(base::kExitFailed);
  }
  ~Child() {
    interrupt();
    (void)wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void interrupt() const {
    if (!status_) ::kill(process_, SIGINT);
  }
  /// Whether it has not ended.
  [[nodiscard]] bool runs() {
    int status = 0;
    if (!status_ && ::waitpid(process_, &status, WNOHANG) == process_) status_ = code(status);
    return !status_;
  }
  /// Its exit code, once it has ended; it is interrupted as this process is.
  [[nodiscard]] int wait() {
    for (bool told = false; runs(); std::this_thread::sleep_for(kPoll)) {
      if (cli::interrupted() && !told) interrupt();
      told = cli::interrupted();
    }
    return *status_;
  }

 private:
  static int code(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : base::kExitFailed; }

  pid_t process_ = -1;
  std::optional<int> status_;
};

std::string last_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  return last;
}

/// Where the flight's files go; those of a demo before are removed.
struct Files {
  explicit Files(const fs::path& folder) : out(folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (!error && ::access(folder.c_str(), W_OK) != 0) error.assign(errno, std::generic_category());
    if (error)
      throw cli::UsageError(fmt::format("--out: '{}' cannot be written ({})", folder.string(), error.message()));
    for (const char* name : {"sim.txt", "sim.jsonl", "sim.json", "fly.jsonl", "fly.json", "flight.html"})
      fs::remove(folder / name, error);
  }
  [[nodiscard]] std::string operator()(const char* name) const { return (out / name).string(); }

  fs::path out;
};

void tell_report(const Files& files) {
  std::error_code unknown;
  if (fs::file_size(files("fly.jsonl"), unknown) == 0 || unknown) return;
  std::ifstream in(files("fly.json"));
  const nlohmann::json summary = nlohmann::json::parse(in, nullptr, false);
  report::write_report(files("fly.jsonl"), files("flight.html"), summary.is_object() ? &summary : nullptr);
  fmt::print("flight report: {}\n", fs::absolute(files("flight.html")).string());
}

int run(const DemoOptions& options) {
  const auto shipped = [](const std::string& named, const char* file) {
    return named.empty() ? (config::config_folder() / file).string() : named;
  };
  const Files files(options.out);
  cli::catch_signals();
  Child sim({"sim", shipped(options.scenario, "scenarios/crossing.yaml"), "--log", files("sim.jsonl"), "--json",
             files("sim.json")},
            files("sim.txt"));
  std::this_thread::sleep_for(kHeadStart);
  if (!sim.runs()) {
    std::fprintf(stderr, "%s\n", last_line(files("sim.txt")).c_str());
    return sim.wait();
  }
  int flown = base::kExitFailed;
  {
    Child fly({"fly", shipped(options.mission, "missions/sitl.yaml"), "--log", files("fly.jsonl"), "--json",
               files("fly.json")},
              "");
    flown = fly.wait();
  }
  sim.interrupt();
  const int judged = sim.wait();
  if (flown == base::kExitUsage) return flown;  // it said why, and nothing flew
  fmt::print("the simulator's verdict: {}\n", last_line(files("sim.txt")));
  tell_report(files);
  return flown != base::kExitReached ? flown : judged;
}

}  // namespace

cli::Subcommand add_demo(const cli::Parser& jink) {
  const cli::Parser app =
      jink.add_subcommand("demo", "a first flight: the simulator and the companion as two processes, then the report");
  const auto options = std::make_shared<DemoOptions>();
  app.add_option("SCENARIO", options->scenario, "what is flown through (default: the shipped scenarios/crossing.yaml)")
      .check(cli::some_name());
  app.add_option("MISSION", options->mission, "what is flown (default: the shipped missions/sitl.yaml)")
      .check(cli::some_name());
  app.add_option("--out", options->out, "folder of logs, summaries and the report; made where there is none")
      .check(cli::some_name())
      .show_default();
  return {app, [options] { return run(*options); }};
}

}  // namespace jink::tools::commands
