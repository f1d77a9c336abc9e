// SPDX-License-Identifier: BSD-3-Clause
#include "tools/lab/campaign/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tools/lab/campaign/jsonl_file.hpp"

namespace jink::tools::lab::campaign {
namespace {

constexpr std::chrono::seconds kPlainPeriod{15};  // between lines where there is no terminal
constexpr std::size_t kBar = 24;

}  // namespace

Shard shard_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  const int number = whole<int>(std::string_view(text).substr(0, slash)).value_or(0);
  int of = 0;
  if (slash != std::string::npos) of = whole<int>(std::string_view(text).substr(slash + 1)).value_or(0);
  if (of < 1 || of > kMostShards || number < 1 || number > of)
    throw cli::UsageError(fmt::format("--shard: '{}' is not K/N with 1 <= K <= N <= {}", text, kMostShards));
  return {number, of};
}

void make_folder(const std::filesystem::path& out) {
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error || !std::filesystem::is_directory(out))
    throw cli::UsageError(fmt::format("--out: '{}' cannot be made a folder", out.string()));
}

bool goes_on(const std::filesystem::path& file, const std::string& out, bool resume, const cli::Printer& printer) {
  if (!has_begun(file)) {
    if (resume) printer.line(fmt::format("{} holds no campaign: this is the beginning of one", out));
    return false;
  }
  if (!resume)
    throw cli::UsageError(
        fmt::format("--out: '{}' holds a campaign; --resume goes on with it, another folder begins a new one", out));
  return true;
}

void require_same(const std::vector<std::string>& differences, const std::string& out) {
  if (!differences.empty())
    throw cli::UsageError(
        fmt::format("--resume: '{}' was begun with other settings: {}", out, fmt::join(differences, "; ")));
}

void refuse_beside(const cli::Parser& app, const char* mode, const std::vector<std::string>& useless) {
  if (app.count(mode) == 0) return;
  for (const std::string& name : useless)
    if (app.count(name) > 0) throw cli::UsageError(fmt::format("{}: has no effect beside {}", name, mode));
}

std::string duration(double seconds) {
  const long whole_seconds = std::lround(std::max(0.0, seconds));
  if (whole_seconds < 60) return fmt::format("{} s", whole_seconds);
  if (whole_seconds < 3600) return fmt::format("{} min {:02} s", whole_seconds / 60, whole_seconds % 60);
  return fmt::format("{} h {:02} min", whole_seconds / 3600, whole_seconds / 60 % 60);
}

void ProgressPrinter::operator()(const Progress& p) {
  const auto now = Clock::now();
  if (printer_.terminal()) {
    printer_.live(text(p, now));
  } else if (now - last_ >= kPlainPeriod && p.done < p.total) {
    printer_.line(text(p, now));
    last_ = now;
  }
}

std::string ProgressPrinter::text(const Progress& p, Clock::time_point now) const {
  const double elapsed = std::chrono::duration<double>(now - begun_).count();
  const double share = p.total > 0.0 ? std::min(1.0, p.done / p.total) : 1.0;
  const std::string left =
      p.in_this_run > 0.0 ? fmt::format(", {} left", duration(elapsed * (p.total - p.done) / p.in_this_run)) : "";
  return fmt::format("[{:{}}] {:3.0f} %  {}, {}{}", std::string(static_cast<std::size_t>(share * kBar), '#'), kBar,
                     100.0 * share, p.text, duration(elapsed), left);
}

}  // namespace jink::tools::lab::campaign
