// SPDX-License-Identifier: BSD-3-Clause
// From a path to the root value of a YAML document that is safe to walk.
#include <yaml-cpp/eventhandler.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <unordered_map>

#include "config/yaml.hpp"

namespace jink::config {
namespace {

constexpr std::size_t kLargestFileBytes = std::size_t{16} << 20;
constexpr std::size_t kMostValues = 1'000'000;
constexpr std::size_t kDeepest = 32;  // the formats need 5

int line_of(const YAML::Mark& mark) {
  return mark.line + 1;
}

[[noreturn]] void fail(const std::string& source, int line, const std::string& message) {
  throw ConfigError(source + ":" + std::to_string(line) + ": " + message);
}

std::string slurp(const std::filesystem::path& file) {
  const std::string source = file.string();
  std::error_code ignored;  // what cannot be examined cannot be opened either, and that error is reported
  if (std::filesystem::is_directory(file, ignored))
    throw ConfigError(source + ": is a directory, expected a YAML file");
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw ConfigError(source + ": cannot read: " + std::generic_category().message(errno));
  // Read in pieces up to the limit and not by the file's size, which says nothing for a pipe or a device.
  std::string text;
  std::string piece(std::size_t{1} << 16, '\0');
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())) || in.gcount() > 0) {
    text.append(piece, 0, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kLargestFileBytes) throw ConfigError(source + ": is larger than 16 MiB");
  }
  if (in.bad()) throw ConfigError(source + ": cannot read: " + std::generic_category().message(errno));
  return text;
}

/// Counts what the parser meets, aliases expanded, before any node is built. yaml-cpp shares the nodes of an alias, so
/// a bomb of aliases loads quickly and only hurts whoever walks it; here it is found without a walk.
class Census : public YAML::EventHandler {
 public:
  explicit Census(const std::string& source) : source_(source) {}

  [[nodiscard]] std::size_t documents() const { return documents_; }
  [[nodiscard]] bool empty() const { return empty_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) fail(source_, line_of(mark), "holds a second document, expected one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    empty_ = empty_ && open_.empty();  // a null as the root is an empty document
    leaf(mark, anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string&) override {
    empty_ = false;
    leaf(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto size = sizes_.find(anchor);
    if (size == sizes_.end()) fail(source_, line_of(mark), "an alias contains itself");
    add(size->second, mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YAML::anchor_t anchor;
    YAML::Mark mark;
    std::size_t size;
  };

  void add(std::size_t size, const YAML::Mark& mark) {
    std::size_t& total = open_.empty() ? root_size_ : open_.back().size;
    total += size;
    if (total > kMostValues) fail(source_, line_of(mark), "holds more than a million values");
  }
  void leaf(const YAML::Mark& mark, YAML::anchor_t anchor) {
    add(1, mark);
    if (anchor != YAML::NullAnchor) sizes_[anchor] = 1;
  }
  void open(const YAML::Mark& mark, YAML::anchor_t anchor) {
    empty_ = false;
    if (open_.size() == kDeepest) fail(source_, line_of(mark), "is nested deeper than " + std::to_string(kDeepest));
    open_.push_back({anchor, mark, 1});
  }
  void close() {
    const Open done = open_.back();
    open_.pop_back();
    if (done.anchor != YAML::NullAnchor) sizes_[done.anchor] = done.size;
    add(done.size, done.mark);
  }

  const std::string& source_;
  std::vector<Open> open_;
  std::unordered_map<YAML::anchor_t, std::size_t> sizes_;  // expanded, of what has been closed
  std::size_t root_size_ = 0;
  std::size_t documents_ = 0;
  bool empty_ = true;
};

}  // namespace

Value read_document(const std::filesystem::path& file) {
  const std::string source = file.string();
  const std::string text = slurp(file);
  try {
    Census census(source);
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(census)) {
    }
    if (census.documents() == 0 || census.empty()) throw ConfigError(source + ":1: is empty, expected a map");
    YAML::Node root = YAML::Load(text);
    const int line = line_of(root.Mark());
    return {root, source, "", line};
  } catch (const YAML::Exception& error) {
    fail(source, line_of(error.mark), "not valid YAML: " + error.msg);
  }
}

}  // namespace jink::config
