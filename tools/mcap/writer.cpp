// SPDX-License-Identifier: BSD-3-Clause
#include "tools/mcap/writer.hpp"

#include <zlib.h>

#include <algorithm>
#include <concepts>
#include <stdexcept>

namespace jink::tools::mcap {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

/// The CRC-32 of what `so_far` is of, then of `bytes`. 0 is that of nothing.
std::uint32_t crc32_of(std::uint32_t so_far, std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(so_far, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// The specification's opcodes.
enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

/// Fields in the specification's serialisation: little endian, text after its length.
class Fields {
 public:
  template <std::unsigned_integral Number>
  Fields& number(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8U * i) & 0xFFU);
    return *this;
  }
  Fields& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  Fields& raw(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Op op, const Fields& fields) {
  Fields head;
  head.number(static_cast<std::uint8_t>(op)).number(static_cast<std::uint64_t>(fields.bytes().size()));
  return head.bytes() + fields.bytes();
}

Fields text_map(const std::map<std::string, std::string>& values) {
  Fields entries;
  for (const auto& [key, value] : values) entries.text(key).text(value);
  return entries;
}

Fields number_map(const std::map<McapWriter::Id, std::uint64_t>& values) {
  Fields entries;
  for (const auto& [key, value] : values) entries.number(key).number(value);
  return entries;
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file, std::string_view profile, std::string_view library)
    : file_(file), out_(file, std::ios::binary) {
  if (!out_) throw std::runtime_error(file.string() + ": cannot be written");
  put(kMagic);
  put(record(Op::kHeader, Fields().text(profile).text(library)));
}

void McapWriter::put(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  at_ += bytes.size();
  crc_ = crc32_of(crc_, bytes);
}

McapWriter::Id McapWriter::add_schema(std::string_view name, std::string_view json_schema) {
  const Id id = ++schema_count_;  // 0 means none
  const std::string bytes = record(Op::kSchema, Fields().number(id).text(name).text("jsonschema").text(json_schema));
  schemas_ += bytes;
  chunk_ += bytes;
  return id;
}

McapWriter::Id McapWriter::add_channel(Id schema, std::string_view topic) {
  const Id id = ++channel_count_;
  const std::string bytes = record(Op::kChannel, Fields().number(id).number(schema).text(topic).text("json").text(""));
  channels_ += bytes;
  chunk_ += bytes;
  counts_[id] = 0;
  return id;
}

void McapWriter::write(Id channel, std::uint64_t time_ns, std::string_view json) {
  index_[channel].push_back({time_ns, chunk_.size()});
  const auto sequence = static_cast<std::uint32_t>(counts_[channel]++);
  chunk_ += record(Op::kMessage, Fields().number(channel).number(sequence).number(time_ns).number(time_ns).raw(json));
  first_ns_ = messages_ == 0 ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  ++messages_;
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  ChunkPlace place;
  bool any = false;
  for (const auto& [channel, entries] : index_) {
    for (const IndexEntry& entry : entries) {
      place.first_ns = any ? std::min(place.first_ns, entry.time_ns) : entry.time_ns;
      place.last_ns = std::max(place.last_ns, entry.time_ns);
      any = true;
    }
  }
  place.start = at_;
  place.size = chunk_.size();
  Fields fields;
  fields.number(place.first_ns).number(place.last_ns).number(place.size).number(crc32_of(0, chunk_)).text("");
  fields.number(place.size).raw(chunk_);
  put(record(Op::kChunk, fields));
  place.length = at_ - place.start;
  for (auto& [channel, entries] : index_) {
    const auto earlier = [](const IndexEntry& a, const IndexEntry& b) { return a.time_ns < b.time_ns; };
    std::stable_sort(entries.begin(), entries.end(), earlier);
    Fields pairs;
    for (const IndexEntry& entry : entries) pairs.number(entry.time_ns).number(entry.offset);
    place.indexes[channel] = at_;
    put(record(Op::kMessageIndex, Fields().number(channel).text(pairs.bytes())));
  }
  place.index_length = at_ - place.start - place.length;
  chunks_.push_back(std::move(place));
  chunk_.clear();
  index_.clear();
}

void McapWriter::add_metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  end_chunk();
  const std::uint64_t start = at_;
  put(record(Op::kMetadata, Fields().text(name).text(text_map(values).bytes())));
  metadata_.push_back({start, at_ - start, std::string(name)});
}

std::string McapWriter::chunk_indexes() const {
  std::string bytes;
  for (const ChunkPlace& chunk : chunks_) {
    Fields fields;
    fields.number(chunk.first_ns).number(chunk.last_ns).number(chunk.start).number(chunk.length);
    fields.text(number_map(chunk.indexes).bytes()).number(chunk.index_length).text("");
    bytes += record(Op::kChunkIndex, fields.number(chunk.size).number(chunk.size));
  }
  return bytes;
}

std::string McapWriter::metadata_indexes() const {
  std::string bytes;
  for (const MetadataPlace& place : metadata_)
    bytes += record(Op::kMetadataIndex, Fields().number(place.start).number(place.length).text(place.name));
  return bytes;
}

std::string McapWriter::statistics() const {
  Fields fields;
  fields.number(messages_).number(schema_count_).number(std::uint32_t{channel_count_}).number(std::uint32_t{0});
  fields.number(static_cast<std::uint32_t>(metadata_.size())).number(static_cast<std::uint32_t>(chunks_.size()));
  fields.number(first_ns_).number(last_ns_).text(number_map(counts_).bytes());
  return record(Op::kStatistics, fields);
}

void McapWriter::close() {
  end_chunk();
  put(record(Op::kDataEnd, Fields().number(crc_)));
  const std::uint64_t summary_start = at_;
  crc_ = 0;  // from here on that of the summary
  std::string offsets;
  const auto group = [&](Op op, const std::string& records) {
    if (records.empty()) return;
    const auto length = static_cast<std::uint64_t>(records.size());
    offsets += record(Op::kSummaryOffset, Fields().number(static_cast<std::uint8_t>(op)).number(at_).number(length));
    put(records);
  };
  group(Op::kSchema, schemas_);
  group(Op::kChannel, channels_);
  group(Op::kStatistics, statistics());
  group(Op::kChunkIndex, chunk_indexes());
  group(Op::kMetadataIndex, metadata_indexes());
  const std::uint64_t offsets_start = at_;
  put(offsets);
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  Fields footer;
  footer.number(static_cast<std::uint8_t>(Op::kFooter)).number(kFooterBytes);
  put(footer.number(summary_start).number(offsets_start).bytes());
  put(Fields().number(crc_).bytes());  // the argument is made before crc_ changes
  put(kMagic);
  out_.close();
  if (!out_) throw std::runtime_error(file_.string() + ": could not be written to its end");
}

}  // namespace jink::tools::mcap
