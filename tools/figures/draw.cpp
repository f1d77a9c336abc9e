// SPDX-License-Identifier: BSD-3-Clause
// Drawing: the files, and gnuplot run on them.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <system_error>

#include "tools/figures/gnuplot.hpp"

namespace jink::tools::figures {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestComplaint = 8192;  // bytes kept of what gnuplot says
constexpr const char* kMissing = "gnuplot is not in PATH; figures need it (Debian: apt install gnuplot-nox)";

[[noreturn]] void refuse(const std::string& id, const std::string& reason) {
  throw FigureError(fmt::format("figure {}: {}", id, reason));
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write(const std::string& id, const fs::path& file, const std::string& text) {
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
void run_gnuplot(const std::string& id, const fs::path& folder) {
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
  // In a process group of its own: a Ctrl-C is for us, who end what was begun. One that comes before it has that group
  // waits for ever.
  sigset_t interrupt;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setsigmask(&attributes, &interrupt);
  pid_t child = -1;
  const int failure = ::posix_spawnp(&child, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) throw GnuplotMissing(fmt::format("figure {}: {}", id, kMissing));
  if (failure != 0) refuse(id, fmt::format("gnuplot cannot be run: {}", std::generic_category().message(failure)));
  pipe.close_end(1);
  const std::string said = read_all(pipe.end(0));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) refuse(id, fmt::format("gnuplot was ended by signal {}", WTERMSIG(status)));
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) refuse(id, fmt::format("gnuplot failed: {}", complaint(said)));
}

/// Tells a PNG's resolution, which gnuplot leaves out: the chunk pHYs of 300 dots an inch, behind the header.
void tell_resolution(const std::string& id, const fs::path& png) {
  static constexpr std::size_t kHeader = 33;  // the signature and the chunk IHDR
  static const std::string chunk("\0\0\0\x09pHYs\0\0\x2e\x23\0\0\x2e\x23\1\x78\xa5\x3f\x76", 21);
  std::string bytes = read(png);
  if (bytes.starts_with("\x89PNG") && bytes.size() > kHeader) write(id, png, bytes.insert(kHeader, chunk));
}

Drawn draw_as(const Figure& figure, const fs::path& folder, const std::string& formats) {
  const std::string script = gnuplot_script(figure, formats), data = gnuplot_data(figure);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(figure.id, fmt::format("cannot make {}: {}", folder.string(), error.message()));
  const auto file = [&](const std::string& ending) { return folder / (figure.id + '.' + ending); };
  write(figure.id, file("dat"), data);
  write(figure.id, file("gp"), script);
  // A picture of before must not pass for one of now.
  for (const char* picture : {"png", "svg"}) fs::remove(file(picture), error);
  run_gnuplot(figure.id, folder);
  std::istringstream endings(formats);
  for (std::string ending; endings >> ending;)
    if (fs::file_size(file(ending), error) == 0 || error)
      refuse(figure.id, fmt::format("gnuplot has not written {}", file(ending).string()));
  if (fs::exists(file("png"), error)) tell_resolution(figure.id, file("png"));
  return {file("gp"), file("dat"), file("png"), file("svg")};
}

/// A folder that goes with its owner.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "jink-figure-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw FigureError(fmt::format("cannot make {}: {}", name, std::generic_category().message(errno)));
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

void require_gnuplot() {
  const char* const path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe)
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / "gnuplot").c_str(), X_OK) == 0) return;
  throw GnuplotMissing(kMissing);
}

Drawn draw(const Figure& figure, const fs::path& folder) {
  return draw_as(figure, folder, "png svg");
}

std::string png_of(const Figure& figure) {
  const ScratchFolder folder;
  return read(draw_as(figure, folder.path(), "png").png);
}

std::string svg_of(const Figure& figure) {
  const ScratchFolder folder;
  return svg_element(draw_as(figure, folder.path(), "svg").svg, figure.id + '-');
}

std::string svg_element(const fs::path& file, const std::string& prefix) {
  const std::string text = read(file);
  const std::size_t begin = text.find("<svg"), end = text.rfind("</svg>");
  if (text.empty()) throw std::runtime_error(fmt::format("cannot read the figure {}", file.string()));
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw std::runtime_error(fmt::format("{} is no SVG", file.string()));
  static const std::regex mark(R"(( id=['"]|href=['"]#|url\(#))");
  return std::regex_replace(text.substr(begin, end + 6 - begin), mark, "$1" + prefix);
}

}  // namespace jink::tools::figures
