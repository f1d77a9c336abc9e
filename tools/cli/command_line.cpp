// SPDX-License-Identifier: BSD-3-Clause
#include "tools/cli/command_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <system_error>
#include <thread>
#include <utility>

#include "tools/base/atomic_file.hpp"

namespace jink::tools::cli {
namespace {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

constexpr std::uint64_t kMostThreads = 256;

/// What is wrong with the name of a file to be written; empty: nothing.
std::string why_unwritable(const std::string& file) {
  if (file.empty()) return "is empty; expected the name of a file";
  std::error_code ignored;  // what cannot be examined is not there, and opening it tells
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_directory(status)) return "'" + file + "' is a directory";
  const bool there = std::filesystem::exists(status);
  if (there && !std::filesystem::is_regular_file(status))
    return "";  // opening a pipe would say something to its reader
  if (!std::ofstream(file, std::ios::app)) return "'" + file + "' cannot be written";
  // A link that leads nowhere yet would be what is removed.
  if (!there && !std::filesystem::is_symlink(file, ignored)) std::filesystem::remove(file, ignored);
  return "";
}

}  // namespace

Validator whole_number(std::uint64_t least, std::uint64_t most) {
  const auto check = [=](std::string& text) {
    std::uint64_t value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (text.empty() || error != std::errc() || end != last || value < least || value > most)
      return fmt::format("Value {} not in range {} to {}", text, least, most);
    text = std::to_string(value);
    return std::string();
  };
  return check;
}

Validator number_in(double least, double most) {
  const auto check = [=](const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool number = !text.empty() && end == text.c_str() + text.size();
    return number && value >= least && value <= most ? std::string()
                                                     : fmt::format("Value {} not in range {} to {}", text, least, most);
  };
  return check;
}

Validator some_name() {
  return [](const std::string& text) { return std::string(text.empty() ? "is empty; expected a name" : ""); };
}

Validator writable_file() {
  return [](const std::string& text) { return text == "-" ? std::string() : why_unwritable(text); };
}

void refuse_same_file(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written) {
  namespace fs = std::filesystem;
  const auto same = [](const NamedFile& a, const NamedFile& b) {
    if (a.file.empty() || b.file.empty() || a.file == "-" || b.file == "-") return false;
    std::error_code error;  // of what is not there yet
    const fs::path one = fs::weakly_canonical(a.file, error), other = fs::weakly_canonical(b.file, error);
    if (error || one != other) return false;
    const fs::file_status status = fs::status(one, error);
    return !fs::exists(status) || fs::is_regular_file(status);
  };
  std::vector<NamedFile> taken = read;
  for (const NamedFile& next : written) {
    for (const NamedFile& other : taken) {
      if (same(next, other))
        throw UsageError(fmt::format("{}: '{}' is {} too; expected another file", next.name, next.file, other.name));
    }
    taken.push_back(next);
  }
}

void CommonOptions::add_to(const Parser& parser) {
  parser.add_option("--seed", seed, "seed of every random number (recorded; never drawn from the clock)")
      .transform(whole_number(0, std::numeric_limits<std::uint64_t>::max()))
      .show_default();
  parser.add_option("--threads", threads, "threads of the planner, 1 to 256 (default: one for each core)")
      .transform(whole_number(1, kMostThreads));
  parser.add_option("--config", config, "planner parameters (default: the shipped planner.yaml)").check(some_name());
  parser.add_option("--set", overrides, "change one parameter: section.key=value; may be repeated").single_value();
  parser.add_option("--json", json, "write the summary object to FILE; - is stdout, then all else goes to stderr")
      .check(some_name());  // that it can be written is each command's to check: campaigns make its folder first
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
  if (const std::string why = why_unwritable(file); !why.empty()) throw UsageError("--json: " + why);
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
