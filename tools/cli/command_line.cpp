// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/command_line.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <thread>
#include <utility>

#include "tools/base/atomic_file.hpp"

namespace jink::tools::cli {
namespace {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

}  // namespace

Validator whole_number(const base::WholeRange& range) {
  return [range](std::string& text) {
    std::uint64_t value = 0;
    std::string wrong = base::read_whole(text, range, value);
    if (wrong.empty()) text = std::to_string(value);
    return wrong;
  };
}

Validator number_in(const base::NumberRange& range) {
  return [range](const std::string& text) {
    double ignored = 0.0;
    return base::read_number(text, range, ignored);
  };
}

Validator some_name() {
  return [](const std::string& text) { return std::string(text.empty() ? "is empty; expected a name" : ""); };
}

Validator writable_file() {
  return [](const std::string& text) { return text == "-" ? std::string() : base::why_unwritable(text); };
}

void CommonOptions::add_to(const Parser& parser) {
  parser.add_option("--seed", seed, "seed of every random number (recorded; never drawn from the clock)")
      .transform(whole_number(base::kSeed))
      .show_default();
  parser.add_option("--threads", threads, "threads of the planner, 1 to 256 (default: one for each core)")
      .transform(whole_number(base::kThreads));
  parser.add_option("--config", config, "planner parameters (default: the shipped planner.yaml)").check(some_name());
  parser.add_option("--set", overrides, "change one parameter: section.key=value; may be repeated").single_value();
  parser.add_option("--json", json, "write the summary object to FILE; - is stdout, then all else goes to stderr")
      .check(some_name());  // that it can be written is each command's to check: campaigns make its folder first
}

config::Settings CommonOptions::settings() const {
  return config::load_settings(config, overrides);
}

int CommonOptions::thread_count() const {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

BackgroundPrinter::BackgroundPrinter(const Printer& printer)
    : printer_(printer), thread_([this](const std::stop_token& stop) { work(stop); }) {}

BackgroundPrinter::~BackgroundPrinter() {
  thread_.request_stop();
  thread_.join();
}

void BackgroundPrinter::put(std::string text, bool live) {
  {
    const std::scoped_lock lock(mutex_);
    if (live && !queue_.empty() && queue_.back().live) queue_.pop_back();  // nobody will read what it replaces
    if (queue_.size() == kMost) {
      ++dropped_;
      return;
    }
    queue_.push_back({std::move(text), live});
  }
  filled_.notify_one();
}

void BackgroundPrinter::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (filled_.wait(lock, stop, [&] { return !queue_.empty(); }) || !queue_.empty()) {
    const Text next = std::move(queue_.front());
    queue_.pop_front();
    const std::uint64_t dropped = std::exchange(dropped_, 0);
    lock.unlock();
    if (dropped > 0) printer_.line("(" + std::to_string(dropped) + " lines left out: they were not read)");
    next.live ? printer_.live(next.text) : printer_.line(next.text);
    lock.lock();
  }
}

void Printer::line(const std::string& text) const {
  if (live_) std::fputs("\r\033[K", file_);
  live_ = false;
  std::fprintf(file_, "%s\n", text.c_str());
  std::fflush(file_);
}

bool Printer::terminal() const {
  return isatty(fileno(file_)) == 1;
}

void Printer::live(const std::string& text) const {
  if (!terminal()) return;
  winsize size{};
  const bool known = ioctl(fileno(file_), TIOCGWINSZ, &size) == 0 && size.ws_col > 1;  // NOLINT: the system's interface
  // A line that wraps could not be rewritten.
  const std::size_t room = known ? static_cast<std::size_t>(size.ws_col - 1) : text.size();
  std::fprintf(file_, "\r\033[K%s", text.substr(0, room).c_str());
  std::fflush(file_);
  live_ = true;
}

void require_json(const std::string& file) {
  if (file.empty() || file == "-") return;
  if (const std::string why = base::why_unwritable(file); !why.empty()) throw UsageError("--json: " + why);
}

void write_json(const std::string& file, const nlohmann::ordered_json& summary) {
  if (file.empty()) return;
  const std::string text = summary.dump() + "\n";
  if (file == "-") {
    if (!(std::cout << text << std::flush)) throw UsageError("--json: stdout cannot be written");
    return;
  }
  if (base::write_file(file, text)) throw UsageError("--json: '" + file + "' cannot be written");
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int) { g_interrupted.store(true); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);  // the terminal is gone: the vehicle is not
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);  // whoever read our output is gone: likewise
}

bool interrupted() {
  return g_interrupted.load();
}

void end_on_signals() {
  struct sigaction action = {};
  action.sa_handler = [](int) {
    constexpr std::string_view kLine = "jink: interrupted\n";
    const auto written = ::write(STDERR_FILENO, kLine.data(), kLine.size());
    static_cast<void>(written);  // nobody is left to be told
    ::_exit(base::kExitFailed);
  };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;              // NOLINT: the system's interface
    if (::open("/dev/null", O_RDWR) != stream) std::abort();  // NOLINT: the lowest free number, which is this one
  }
}

}  // namespace jink::tools::cli
