// SPDX-License-Identifier: BSD-3-Clause
// What the fuzzers share: their input piece by piece, as a file, and how they say that something is wrong.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

/// libFuzzer's entry: one input. Always returns 0; what is wrong ends the process.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace jink::fuzz {

/// Ends the process, and libFuzzer keeps the input, unless `holds`.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

/// Takes the input apart. Where it is used up, everything that is taken is zero or empty.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  std::uint8_t byte() {
    const auto one = bytes(1);
    return one.empty() ? std::uint8_t{0} : one[0];
  }
  std::span<const std::uint8_t> bytes(std::size_t count) {
    const auto taken = rest_.first(std::min(count, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// A file that stays open. What is written replaces what was before.
class OpenFile {
 public:
  explicit OpenFile(int descriptor) : descriptor_(descriptor) {
    require(descriptor_ >= 0, "a file that cannot be opened");
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  void write(const std::uint8_t* data, std::size_t size) {
    const auto length = static_cast<off_t>(size);
    require(::ftruncate(descriptor_, 0) == 0 && ::pwrite(descriptor_, data, size, 0) == length, "a file's write");
  }
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// A file in memory for those who read files. The same one for all inputs.
class MemoryFile : public OpenFile {
 public:
  MemoryFile() : OpenFile(::memfd_create("fuzz", 0)) {}
};

}  // namespace jink::fuzz
