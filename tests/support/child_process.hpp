// SPDX-License-Identifier: BSD-3-Clause
// A program of another language as the other end of a transport test: its lines come out, orders go in, and it ends
// with the test whatever happens.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace jink::bridge::testing {

class ChildProcess {
 public:
  /// Starts `arguments` (the program's path first). stderr stays the test's own. @throws std::runtime_error.
  explicit ChildProcess(const std::vector<std::string>& arguments) {
    int in[2];
    int out[2];
    // Close-on-exec, or a second child would hold the first one's stdin open.
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    std::vector<char*> argv;
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));  // NOLINT: execv's interface
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ < 0) throw std::runtime_error("fork");
    if (pid_ == 0) {
      dup2(in[0], STDIN_FILENO);
      dup2(out[1], STDOUT_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    stdin_ = in[1];
    reader_ = std::jthread([this, fd = out[0]] { read_lines(fd); });
  }

  ~ChildProcess() {
    close(stdin_);
    for (int i = 0; i < 100 && waitpid(pid_, nullptr, WNOHANG) == 0; ++i) {
      if (i == 50) kill(pid_, SIGTERM);
      if (i == 99) kill(pid_, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void order(const std::string& line) {
    const std::string text = line + "\n";
    if (write(stdin_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) throw std::runtime_error("write");
  }

  /// The first line at or after number `from` that satisfies `wanted`; nothing when none came in `timeout`.
  std::optional<std::string> wait_line(const std::function<bool(const std::string&)>& wanted, std::size_t from = 0,
                                       std::chrono::seconds timeout = std::chrono::seconds(20)) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    std::unique_lock lock(mutex_);
    for (std::size_t next = from;;) {
      for (; next < lines_.size(); ++next) {
        if (wanted(lines_[next])) return lines_[next];
      }
      if (changed_.wait_until(lock, deadline) == std::cv_status::timeout && next >= lines_.size()) return std::nullopt;
    }
  }

  std::vector<std::string> lines() {
    const std::scoped_lock lock(mutex_);
    return lines_;
  }

 private:
  void read_lines(int fd) {
    std::string rest;
    char buffer[4096];
    for (ssize_t n = 0; (n = read(fd, buffer, sizeof buffer)) > 0;) {
      rest.append(buffer, static_cast<std::size_t>(n));
      const std::scoped_lock lock(mutex_);
      for (std::size_t end = 0; (end = rest.find('\n')) != std::string::npos; rest.erase(0, end + 1)) {
        lines_.push_back(rest.substr(0, end));
      }
      changed_.notify_all();
    }
    close(fd);
  }

  pid_t pid_ = -1;
  int stdin_ = -1;
  std::mutex mutex_;  // guards lines_
  std::condition_variable changed_;
  std::vector<std::string> lines_;
  std::jthread reader_;  // last: joined first, when the child's stdout has closed
};

/// Waits until `condition` holds; false after `timeout`. Real transports have their own time, so their tests wait.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::milliseconds timeout = std::chrono::seconds(20)) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace jink::bridge::testing
