// SPDX-License-Identifier: BSD-3-Clause
#include "tools/command_line.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <system_error>
#include <thread>
#include <utility>

namespace jink::tools {
namespace {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

constexpr std::int64_t kMostThreads = 256;

}  // namespace

void CommonOptions::add_to(CLI::App& app) {
  app.add_option("--seed", seed, "seed of every random number (recorded; never drawn from the clock)")
      ->check(
          [](const std::string& text) {
            const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
            return digits ? std::string() : "Value " + text + " is not a whole number from 0 to 18446744073709551615";
          },
          "")
      ->capture_default_str();
  app.add_option("--threads", threads, "threads of the planner, 1 to 256 (default: one for each core)")
      ->check(CLI::Range(std::int64_t{1}, kMostThreads));
  app.add_option("--config", config, "planner parameters (default: config/planner.yaml)");
  app.add_option("--set", overrides, "change one parameter: section.key=value; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--json", json, "write the summary object to FILE; - is stdout, then all else goes to stderr");
}

config::Settings CommonOptions::settings() const {
  return config::load_settings(
      config.empty() ? config::config_folder() / "planner.yaml" : std::filesystem::path(config), overrides);
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
  const std::string unfinished = file + ".part";
  std::error_code error;
  const bool opened = std::ofstream(unfinished).is_open();
  std::filesystem::remove(unfinished, error);
  if (!opened || std::filesystem::is_directory(file, error))
    throw UsageError("--json: '" + file + "' cannot be written");
}

void write_json(const std::string& file, const nlohmann::ordered_json& summary) {
  if (file.empty()) return;
  const std::string text = summary.dump() + "\n";
  if (file == "-") {
    std::cout << text << std::flush;
    return;
  }
  const std::string unfinished = file + ".part";
  {
    std::ofstream out(unfinished);
    out << text << std::flush;
    if (!out) throw UsageError("--json: '" + file + "' cannot be written");
  }
  std::error_code error;
  std::filesystem::rename(unfinished, file, error);
  if (error) {
    std::filesystem::remove(unfinished, error);
    throw UsageError("--json: '" + file + "' cannot be written");
  }
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

}  // namespace jink::tools
