// SPDX-License-Identifier: BSD-3-Clause
#include "config/octomap.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>

#include "config/error.hpp"
#include "config/text.hpp"
#include "config/yaml.hpp"

namespace jink::config {
namespace {

constexpr std::string_view kBinaryHead = "# Octomap OcTree binary file";
constexpr std::string_view kFullHead = "# Octomap OcTree file";
constexpr int kDepth = 16;  // of OctoMap's trees
constexpr std::size_t kLargestMapBytes = std::size_t{256} << 20;
constexpr std::size_t kMostLeaves = 4'000'000;

/// Of whole smallest cells, from the tree's centre on.
struct Cells {
  std::array<int, 3> min{}, max{};
};

/// A file from its first line to its last byte.
class TreeReader {
 public:
  explicit TreeReader(const std::filesystem::path& file) : file_(file.string()), in_(file, std::ios::binary) {
    errno = 0;
    if (!in_.is_open() || in_.peek() == std::ifstream::traits_type::eof()) fail("is empty or cannot be read");
    std::error_code ignored;
    if (std::filesystem::file_size(file, ignored) > kLargestMapBytes && !ignored) fail("is larger than 256 MiB");
    read_head();
  }

  [[nodiscard]] double resolution() const { return resolution_; }

  std::vector<Cells> occupied() {
    constexpr int kHalf = 1 << (kDepth - 1);
    if (nodes_ > 0) read_node({-kHalf, -kHalf, -kHalf}, 0);
    if (in_.peek() != std::ifstream::traits_type::eof()) fail("goes on behind its tree");
    return std::move(leaves_);
  }

  [[noreturn]] void fail(const std::string& what) const { throw ConfigError(file_ + ": " + what); }

 private:
  void read_head() {
    std::string type;
    std::string text;
    int line = 0;
    const auto fail_here = [&](const std::string& what) {
      throw ConfigError(file_ + ":" + std::to_string(line) + ": " + what);
    };
    while (std::getline(in_, text)) {
      ++line;
      if (line == 1) {
        binary_ = text.starts_with(kBinaryHead);
        if (!binary_ && !text.starts_with(kFullHead))
          fail_here("is no OctoMap: it does not begin with '# Octomap OcTree'");
      }
      if (text.starts_with("#")) continue;
      if (text == "data") break;
      const std::size_t space = text.find(' ');
      const std::string key = text.substr(0, space);
      const std::string value = space == std::string::npos ? std::string() : text.substr(space + 1);
      const auto number = parse_number(value);
      if (key == "id") {
        type = value;
      } else if (key == "size") {
        const Range sizes = closed(0, 1e10);
        if (!number || !sizes.contains(*number))
          fail_here("key 'size': value '" + value + "' is not in " + sizes.text());
        nodes_ = static_cast<std::uint64_t>(*number);
      } else if (key == "res") {
        const Range sizes = above(0, 1e3);
        if (!number || !sizes.contains(*number))
          fail_here("key 'res': value '" + value + "' is not in " + sizes.text());
        resolution_ = *number;
      } else {
        fail_here("unknown key '" + key.substr(0, 40) + "'; expected id, size, res, then data");
      }
    }
    if (text != "data" || type.empty() || resolution_ == 0.0) fail("is cut off: it has not all of id, res and data");
    colored_ = type == "ColorOcTree";
    if (!colored_ && type != "OcTree") fail("key 'id': value '" + type + "' is not one of OcTree, ColorOcTree");
  }

  std::uint8_t byte() {
    char c = 0;
    if (!in_.get(c)) fail("is cut off within its tree");
    return static_cast<std::uint8_t>(c);
  }

  void add(const std::array<int, 3>& min, int depth) {
    if (leaves_.size() == kMostLeaves) fail("has more than 4 million occupied leaves; expected a coarser resolution");
    const int size = 1 << (kDepth - depth);
    leaves_.push_back({min, {min[0] + size, min[1] + size, min[2] + size}});
  }

  static std::array<int, 3> child(const std::array<int, 3>& min, int depth, unsigned i) {
    const int half = 1 << (kDepth - depth - 1);
    std::array<int, 3> result = min;
    for (unsigned axis = 0; axis < 3; ++axis) result[axis] += (i >> axis & 1U) != 0 ? half : 0;
    return result;
  }

  void read_node(const std::array<int, 3>& min, int depth) {
    binary_ ? read_binary_node(min, depth) : read_full_node(min, depth);
  }

  // Two bits for each child: 0 unknown, 1 free, 2 occupied, 3 with children of its own, which follow.
  void read_binary_node(const std::array<int, 3>& min, int depth) {
    const unsigned low = byte();
    const unsigned kinds = low | static_cast<unsigned>(byte()) << 8U;
    if (kinds != 0) check_depth(depth);
    for (unsigned i = 0; i < 8; ++i) {
      if ((kinds >> 2 * i & 3U) == 2) add(child(min, depth, i), depth + 1);
    }
    for (unsigned i = 0; i < 8; ++i) {
      if ((kinds >> 2 * i & 3U) == 3) read_node(child(min, depth, i), depth + 1);
    }
  }

  // The logarithm of the odds that it is occupied, its colour, and a bit for each child, which follow.
  void read_full_node(const std::array<int, 3>& min, int depth) {
    std::uint32_t bits = 0;
    for (unsigned i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(byte()) << 8 * i;
    const auto odds = std::bit_cast<float>(bits);
    if (std::isnan(odds)) fail("holds odds that are not a number");
    for (int i = 0; colored_ && i < 3; ++i) (void)byte();
    const unsigned children = byte();
    if (children == 0 && odds >= 0.0F) add(min, depth);
    if (children != 0) check_depth(depth);
    for (unsigned i = 0; i < 8; ++i) {
      if ((children >> i & 1U) != 0) read_node(child(min, depth, i), depth + 1);
    }
  }

  void check_depth(int depth) const {
    if (depth >= kDepth) fail("is nested deeper than 16 levels");
  }

  std::string file_;
  std::ifstream in_;
  bool binary_ = true;
  bool colored_ = false;
  double resolution_ = 0.0;
  std::uint64_t nodes_ = 0;
  std::vector<Cells> leaves_;
};

/// Joins what follows each other along an axis and is the same across it.
void merge_along(std::size_t axis, std::vector<Cells>& cells) {
  const std::size_t b = (axis + 1) % 3;
  const std::size_t c = (axis + 2) % 3;
  const auto across = [&](const Cells& x) { return std::tuple(x.min[b], x.max[b], x.min[c], x.max[c]); };
  std::sort(cells.begin(), cells.end(), [&](const Cells& x, const Cells& y) {
    return std::tuple_cat(across(x), std::tuple(x.min[axis])) < std::tuple_cat(across(y), std::tuple(y.min[axis]));
  });
  std::size_t last = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    if (across(cells[last]) == across(cells[i]) && cells[last].max[axis] == cells[i].min[axis]) {
      cells[last].max[axis] = cells[i].max[axis];
    } else {
      cells[++last] = cells[i];
    }
  }
  if (!cells.empty()) cells.resize(last + 1);
}

}  // namespace

bool is_octomap(const std::filesystem::path& file) {
  constexpr std::string_view kAnyHead = "# Octomap OcTree";
  if (file.extension() == ".bt" || file.extension() == ".ot") return true;
  std::array<char, kAnyHead.size()> head{};
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), head.size());
  return in && std::string_view(head.data(), head.size()) == kAnyHead;
}

std::vector<Obstacle> load_octomap(const std::filesystem::path& file, std::size_t most) {
  TreeReader reader(file);
  std::vector<Cells> cells = reader.occupied();
  for (std::size_t axis = 0, merged = 0; merged < 3; axis = (axis + 1) % 3) {  // until a round changes nothing
    const std::size_t before = cells.size();
    merge_along(axis, cells);
    merged = cells.size() < before ? 0 : merged + 1;
  }
  if (cells.size() > most) {
    reader.fail("becomes " + std::to_string(cells.size()) + " boxes; expected at most " + std::to_string(most) +
                ", of a coarser resolution");
  }
  std::vector<Obstacle> boxes;
  boxes.reserve(cells.size());
  for (const Cells& c : cells) {
    const Vec3 min = reader.resolution() * Vec3(c.min[0], c.min[1], c.min[2]);
    const Vec3 max = reader.resolution() * Vec3(c.max[0], c.max[1], c.max[2]);
    if (!(min.array() >= kCoordinate.min).all() || !(max.array() <= kCoordinate.max).all())
      reader.fail("has a leaf beyond " + kCoordinate.text());
    boxes.push_back({BoxShape{max - min}, LinearMotion{0.5 * (min + max)}});
  }
  return boxes;
}

}  // namespace jink::config
