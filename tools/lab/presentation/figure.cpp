// SPDX-License-Identifier: BSD-3-Clause
// Drawing: the files, and gnuplot run on them.
#include "tools/lab/presentation/figure.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <limits>
#include <system_error>

#include "tools/lab/statistics/statistics.hpp"

namespace jink::tools::lab::presentation {
namespace {

constexpr std::size_t kLongestComplaint = 8192;  // bytes kept of what gnuplot says

[[noreturn]] void refuse(const std::string& id, const std::string& reason) {
  throw FigureError(fmt::format("figure {}: {}", id, reason));
}

void write(const std::string& id, const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  if (!out) refuse(id, fmt::format("cannot write {}", file.string()));
}

/// A pipe's two ends, closed by whoever holds them last.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) ends_ = {-1, -1};
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(std::size_t end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }
  [[nodiscard]] int end(std::size_t which) const { return ends_[which]; }

 private:
  std::array<int, 2> ends_{-1, -1};
};

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 1024> buffer{};
  for (;;) {
    const ssize_t got = ::read(descriptor, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    if (text.size() < kLongestComplaint) text.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

/// The line of gnuplot's complaint that says what is wrong: it marks the place with a caret and says it below.
std::string complaint(const std::string& said) {
  std::string last;
  for (std::size_t begin = 0; begin < said.size();) {
    const std::size_t end = std::min(said.find('\n', begin), said.size());
    const std::string line = said.substr(begin, end - begin);
    const std::size_t text = line.find_first_not_of(" \t");
    if (text != std::string::npos && line.find_first_not_of(" \t^") != std::string::npos) last = line.substr(text);
    if (last.find("line ") != std::string::npos && last.find(".gp") != std::string::npos) break;
    begin = end + 1;
  }
  return last.empty() ? "it says nothing" : last;
}

/// Runs gnuplot in a folder. Throws FigureError.
void run_gnuplot(const std::string& id, const std::filesystem::path& folder) {
  Pipe pipe;
  if (pipe.end(0) < 0) refuse(id, fmt::format("no pipe to gnuplot: {}", std::generic_category().message(errno)));
  // Without the user's own settings, so that the same figure looks the same everywhere.
  std::string program = "gnuplot", defaults = "-d", script = id + ".gp";
  std::array<char*, 4> arguments{program.data(), defaults.data(), script.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, pipe.end(1), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, pipe.end(1), STDERR_FILENO);
  // In a process group of its own: a Ctrl-C is for us, who end what was begun.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t child = -1;
  const int failure = ::posix_spawnp(&child, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) refuse(id, "gnuplot is not installed (Debian: gnuplot-nox; tools/setup.sh installs it)");
  if (failure != 0) refuse(id, fmt::format("gnuplot cannot be run: {}", std::generic_category().message(failure)));
  pipe.close_end(1);
  const std::string said = read_all(pipe.end(0));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) refuse(id, fmt::format("gnuplot was ended by signal {}", WTERMSIG(status)));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) refuse(id, fmt::format("gnuplot failed: {}", complaint(said)));
}

}  // namespace

Series box_series(std::string label, const std::vector<std::vector<double>>& samples) {
  Series series;
  series.label = std::move(label);
  series.kind = Kind::boxes;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::vector<double> sorted = samples[i];
    std::sort(sorted.begin(), sorted.end());
    series.x.push_back(static_cast<double>(i));
    series.least.push_back(statistics::quantile(sorted, 0.0));
    series.low.push_back(statistics::quantile(sorted, 0.25));
    series.y.push_back(statistics::quantile(sorted, 0.5));
    series.high.push_back(statistics::quantile(sorted, 0.75));
    series.greatest.push_back(statistics::quantile(sorted, 1.0));
  }
  return series;
}

Drawn draw(const Figure& figure, const std::filesystem::path& folder) {
  const std::string script = gnuplot_script(figure), data = gnuplot_data(figure);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) refuse(figure.id, fmt::format("cannot make {}: {}", folder.string(), error.message()));
  const auto file = [&](const char* ending) { return folder / (figure.id + ending); };
  Drawn drawn{file(".gp"), file(".dat"), file(".png"), file(".svg")};
  write(figure.id, drawn.data, data);
  write(figure.id, drawn.script, script);
  // A picture of before must not pass for one of now.
  for (const std::filesystem::path& picture : {drawn.png, drawn.svg}) std::filesystem::remove(picture, error);
  run_gnuplot(figure.id, folder);
  for (const std::filesystem::path& picture : {drawn.png, drawn.svg})
    if (std::filesystem::file_size(picture, error) == 0 || error)
      refuse(figure.id, fmt::format("gnuplot has not written {}", picture.string()));
  return drawn;
}

}  // namespace jink::tools::lab::presentation
