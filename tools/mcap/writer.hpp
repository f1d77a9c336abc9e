// SPDX-License-Identifier: BSD-3-Clause
// The MCAP container (https://mcap.dev/spec, major version 0), as far as it takes to write an indexed file: messages in
// uncompressed chunks, each followed by its message indexes, and at the end the summary by which readers seek.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace jink::tools::mcap {

/// Writes one file from its beginning to its end. Messages may come in any order of time; readers order them by the
/// index. Times are ns since an epoch of the writer's choice. Not thread safe.
class McapWriter {
 public:
  using Id = std::uint16_t;
  /// Creates the file. Throws std::runtime_error that names it where it cannot be written.
  McapWriter(const std::filesystem::path& file, std::string_view profile, std::string_view library);
  /// Without close() the file has no summary; whoever stopped halfway removes it.
  ~McapWriter() = default;
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// A JSON schema by its well-known name. At most 65535.
  Id add_schema(std::string_view name, std::string_view json_schema);
  /// A topic whose messages are JSON of that schema. At most 65535.
  Id add_channel(Id schema, std::string_view topic);
  void write(Id channel, std::uint64_t time_ns, std::string_view json);
  /// Text about the whole recording.
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& values);
  /// Ends the file with its summary. Throws std::runtime_error where not all could be written (a full disk).
  void close();

  [[nodiscard]] std::uint64_t messages() const { return messages_; }

 private:
  struct IndexEntry {
    std::uint64_t time_ns = 0, offset = 0;  // within the chunk's records
  };
  struct ChunkPlace {
    std::uint64_t first_ns = 0, last_ns = 0, start = 0, length = 0, index_length = 0, size = 0;
    std::map<Id, std::uint64_t> indexes;  // where each channel's message index is
  };
  struct MetadataPlace {
    std::uint64_t start = 0, length = 0;
    std::string name;
  };

  void put(std::string_view bytes);
  void end_chunk();
  [[nodiscard]] std::string chunk_indexes() const;
  [[nodiscard]] std::string metadata_indexes() const;
  [[nodiscard]] std::string statistics() const;

  std::filesystem::path file_;
  std::ofstream out_;
  std::uint64_t at_ = 0;            // bytes written
  std::uint32_t crc_ = 0;           // of them
  std::string schemas_, channels_;  // their records, again for the summary
  Id schema_count_ = 0, channel_count_ = 0;
  std::string chunk_;  // records of the one that is being filled
  std::map<Id, std::vector<IndexEntry>> index_;
  std::vector<ChunkPlace> chunks_;
  std::vector<MetadataPlace> metadata_;
  std::map<Id, std::uint64_t> counts_;
  std::uint64_t messages_ = 0, first_ns_ = 0, last_ns_ = 0;
};

}  // namespace jink::tools::mcap
