// SPDX-License-Identifier: BSD-3-Clause
#include "sim/recorded/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "bridge/frames/conversions.hpp"
#include "config/error.hpp"
#include "config/text.hpp"

namespace jink::sim::recorded {
namespace {

constexpr std::size_t kLargestBytes = std::size_t{256} << 20;
constexpr double kAnnotated = 0.4;    // s, between two annotated frames of ETH and UCY
constexpr double kLatestTime = 1e11;  // s: milliseconds since 1970 are taken for seconds
constexpr double kFarthest = 1e6;     // m
constexpr double kFastest = 1000.0;   // m/s
constexpr double kLargestSize = 1e3;  // m, radius and height

/// One line of the file: who is where when.
struct Row {
  std::size_t line = 0;
  double t = 0.0;
  std::string id;
  Vec3 place = Vec3::Zero();
  double radius = 0.0, height = 0.0;
};

std::string trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(kBlanks) - first + 1));
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(trimmed(cell));
  if (line.ends_with(',')) cells.emplace_back();
  return cells;
}

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Where in a row of CSV each value stands.
struct Columns {
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t t = kNone, id = kNone, x = kNone, y = kNone, z = kNone, radius = kNone, height = kNone;
};

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file.string()) { read_bytes(file); }

  Recording recording() {
    std::istringstream lines(text_);
    std::string line;
    bool begun = false;
    while (std::getline(lines, line)) {
      ++line_;
      if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte order mark
      const std::string bare = trimmed(line);
      if (bare.empty() || bare.front() == '#') continue;
      if (!std::exchange(begun, true) && read_head(line)) continue;
      columns_ ? read_cells(split(line)) : read_words(words_of(line));
    }
    if (!begun) throw config::ConfigError(file_ + ": holds nothing");
    if (!columns_) time_by_frames();
    put_together();
    return std::move(recording_);
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& what) const {
    throw config::ConfigError(fmt::format("{}:{}: {}", file_, line, what));
  }

  void read_bytes(const std::filesystem::path& file) {
    std::error_code none;
    if (std::filesystem::file_size(file, none) > kLargestBytes && !none)
      throw config::ConfigError(file_ + ": is larger than 256 MiB");
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    if (!in.is_open() || std::filesystem::is_directory(file, none) || !(bytes << in.rdbuf()))
      throw config::ConfigError(file_ + ": is empty or cannot be read");
    text_ = bytes.str();
    recording_.digest = 0xcbf29ce484222325ULL;
    for (const char c : text_)
      recording_.digest = (recording_.digest ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }

  /// False: the line is no header, but the first of ETH's or UCY's.
  bool read_head(const std::string& line) {
    if (config::parse_number(words_of(line).front())) return false;
    names_ = split(line);
    for (std::string& name : names_)
      std::transform(name.begin(), name.end(), name.begin(),
                     [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    const auto column = [&](std::initializer_list<std::string_view> known) {
      for (const std::string_view name : known) {
        const auto found = std::find(names_.begin(), names_.end(), name);
        if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
      }
      return Columns::kNone;
    };
    Columns c;
    geodetic_ = column({"lat", "latitude"}) != Columns::kNone;
    c.t = column({"t", "time", "timestamp"});
    c.id = column({"icao24", "hex", "id"});
    c.x = geodetic_ ? column({"lat", "latitude"}) : column({"x"});
    c.y = geodetic_ ? column({"lon", "longitude"}) : column({"y"});
    c.z = geodetic_ ? column({"geoaltitude", "baroaltitude", "altitude", "alt"}) : column({"z"});
    c.radius = column({"radius"});
    if (!geodetic_) c.height = column({"height"});
    for (const auto& [place, name] : {std::pair{c.t, "t"}, {c.id, "id"}, {c.x, "x"}, {c.y, "y"}, {c.z, "z"}}) {
      if (place == Columns::kNone)
        fail(line_, fmt::format("no column for {}: of a header t, id, x, y, z are needed, or time, icao24, lat, lon, "
                                "geoaltitude",
                                name));
    }
    columns_ = c;
    return true;
  }

  double number(const std::string& text, std::string_view name, const config::Range& range) const {
    const std::optional<double> value = config::parse_number(text);
    if (!value) fail(line_, fmt::format("{}: '{}' is not a number", name, text));
    if (!range.contains(*value)) fail(line_, fmt::format("{}: '{}' is not in {}", name, text, range.text()));
    return *value;
  }

  void read_cells(const std::vector<std::string>& cells) {
    if (cells.size() != names_.size())
      fail(line_, fmt::format("{} columns where the header has {}", cells.size(), names_.size()));
    const auto cell = [&](std::size_t column, const config::Range& range) {
      return number(cells[column], names_[column], range);
    };
    Row row;
    row.line = line_;
    if (geodetic_ && (cells[columns_->x].empty() || cells[columns_->y].empty() || cells[columns_->z].empty())) {
      ++recording_.without_place;
      return;
    }
    row.t = cell(columns_->t, config::within(kLatestTime));
    row.id = cells[columns_->id];
    if (row.id.empty()) fail(line_, names_[columns_->id] + ": is empty");
    if (geodetic_) {
      const bridge::frames::Geodetic place{cell(columns_->x, config::within(90.0)),
                                           cell(columns_->y, config::within(180.0)),
                                           cell(columns_->z, config::closed(-1000.0, 1e5))};
      // The origin at sea level, so that heights stay heights.
      if (!frame_) frame_.emplace(bridge::frames::Geodetic{place.latitude_deg, place.longitude_deg, 0.0});
      row.place = frame_->to_enu(place);
      if (row.place.cwiseAbs().maxCoeff() > kFarthest) fail(line_, "is more than 1000 km from the first place");
    } else {
      const config::Range range = config::within(kFarthest);
      row.place = {cell(columns_->x, range), cell(columns_->y, range), cell(columns_->z, range)};
    }
    row.radius = geodetic_ ? kAircraftRadius : kRadius;
    if (columns_->radius != Columns::kNone) row.radius = cell(columns_->radius, config::above(0.0, kLargestSize));
    if (columns_->height != Columns::kNone) row.height = cell(columns_->height, config::closed(0.0, kLargestSize));
    rows_.push_back(std::move(row));
  }

  void read_words(const std::vector<std::string>& words) {
    constexpr std::size_t kFour = 4, kObsmat = 8;
    if (words.size() < kFour)
      fail(line_, fmt::format("{} numbers: a header is missing, or there are 4 and more (frame, id, x, y), or 8 (ETH's "
                              "obsmat)",
                              words.size()));
    if (!rows_.empty() && width_ != words.size())
      fail(line_, fmt::format("{} numbers where the line before had {}", words.size(), width_));
    width_ = words.size();
    const config::Range range = config::within(kFarthest);
    const double frame = number(words[0], "frame", config::closed(0.0, kLatestTime));
    const double id = number(words[1], "id", config::closed(0.0, 1e9));
    const double x = number(words[2], "x", range);
    const double y = number(words[width_ == kObsmat ? 4 : 3], "y", range);
    rows_.push_back({line_, frame, config::number_text(id), Vec3(x, y, 0.5 * kPersonHeight), kRadius, kPersonHeight});
  }

  /// Frames to seconds: the smallest step of all is one between annotated frames.
  void time_by_frames() {
    std::vector<double> frames(rows_.size());
    std::transform(rows_.begin(), rows_.end(), frames.begin(), [](const Row& row) { return row.t; });
    std::sort(frames.begin(), frames.end());
    double step = planner::base::kInfinity;
    for (std::size_t i = 1; i < frames.size(); ++i) {
      const double apart = frames[i] - frames[i - 1];
      if (apart > 0.0) step = std::min(step, apart);
    }
    for (Row& row : rows_) row.t = std::isfinite(step) ? (row.t - frames.front()) / step * kAnnotated : 0.0;
  }

  void put_together() {
    std::map<std::string, std::size_t> place_of;
    std::vector<std::vector<const Row*>> of;
    for (const Row& row : rows_) {
      const auto [found, is_new] = place_of.emplace(row.id, of.size());
      if (is_new) of.emplace_back();
      of[found->second].push_back(&row);
    }
    for (std::vector<const Row*>& rows : of) {
      std::stable_sort(rows.begin(), rows.end(), [](const Row* a, const Row* b) { return a->t < b->t; });
      if (rows.size() == 1) {
        ++recording_.seen_once;
        continue;
      }
      Mover mover;
      mover.id = rows.front()->id;
      for (const Row* row : rows) add(*row, mover);
      recording_.movers.push_back(std::move(mover));
    }
    if (recording_.movers.empty()) throw config::ConfigError(file_ + ": nobody in it is at two places");
  }

  void add(const Row& row, Mover& mover) const {
    if (!mover.times.empty()) {
      const double dt = row.t - mover.times.back();
      const double speed = (row.place - mover.points.back()).norm() / dt;
      if (dt == 0.0) fail(row.line, fmt::format("'{}' is there twice at this time", row.id));
      if (speed > kFastest)
        fail(row.line, fmt::format("'{}' comes here at {:.0f} m/s, above {:.0f} m/s", row.id, speed, kFastest));
    }
    mover.times.push_back(row.t);
    mover.points.push_back(row.place);
    mover.radius = std::max(mover.radius, row.radius);
    mover.height = std::max(mover.height, row.height);
  }

  std::string file_, text_;
  std::size_t line_ = 0;
  std::vector<std::string> names_;  // of the columns
  std::optional<Columns> columns_;  // none: words
  bool geodetic_ = false;
  std::size_t width_ = 0;  // words in a line
  std::optional<bridge::frames::LocalFrame> frame_;
  std::vector<Row> rows_;
  Recording recording_;
};

}  // namespace

Recording load_recording(const std::filesystem::path& file) {
  return Reader(file).recording();
}

}  // namespace jink::sim::recorded
