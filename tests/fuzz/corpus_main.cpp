// SPDX-License-Identifier: BSD-3-Clause
// Runs a fuzzer on files and folders of files instead of libFuzzer's inputs: a corpus as a regression test, and one
// input while its finding is looked into. `--random COUNT [SEED]` runs it on so many random inputs, at the release
// build's speed; the one that fails is left as fuzz-failed.
#include <fcntl.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "planner/base/random.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

constexpr const char* kFailed = "fuzz-failed";

int run_random(unsigned long long count, unsigned long long seed) {
  constexpr std::size_t kLongest = 800;  // bytes
  std::vector<std::uint8_t> bytes;
  jink::fuzz::OpenFile failed(::creat(kFailed, S_IRUSR | S_IWUSR));
  for (unsigned long long n = 0; n < count; ++n) {
    jink::planner::base::RandomStream random(seed, n);
    bytes.resize(random.below(kLongest) + 1);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.below(256));
    failed.write(bytes.data(), bytes.size());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::filesystem::remove(kFailed);
  std::printf("%llu random inputs\n", count);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 && std::string(argv[1]) == "--random")
    return run_random(std::strtoull(argv[2], nullptr, 10), argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i) {
    if (!std::filesystem::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!in) {
      std::fprintf(stderr, "%s: cannot be read\n", file.c_str());
      return 1;
    }
    std::fprintf(stderr, "%s\n", file.c_str());
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::printf("%zu inputs\n", files.size());
  return files.empty() ? 1 : 0;
}
