#include "orchestrator/formats/mcap/writer.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <stdexcept>
#include <utility>

#include "orchestrator/formats/input_file.h"
#include "orchestrator/formats/mcap/background_compressor.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/output_file.h"

namespace mascot {
namespace {

using mcap::Op;
using mcap::Record;

constexpr std::string_view kProfile = "ros2", kProgram = "mascot";

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr std::uint64_t kChunkSpan_ns = 1'000'000'000;
/// A chunk is closed before it grows beyond this, even within a tick. Half of what the reader accepts, since schema and
/// channel records are added to it.
constexpr std::size_t kLargestChunkBytes = mcap::kMaxChunkBytes / 2;

struct SchemaState {
  std::string name;
  std::string text;
  bool written = false;
};

struct ChannelState {
  McapWriter::Channel description;
  std::uint16_t schema = 0;
  std::uint64_t messages = 0;
  Bytes index;  // message index of the open chunk: (log time, offset in the chunk) pairs, as on disk
};

/// Records of one kind for the summary.
struct SummaryGroup {
  Op op;
  Bytes records;
  std::uint32_t count = 0;

  Record Add() {
    ++count;
    return Record(records, op);
  }
};

}  // namespace

struct McapWriter::Impl {
  explicit Impl(const std::string& path) : file(path) { chunk.reserve(kChunkBytes + kChunkBytes / 4); }

  void WriteData(ByteSpan bytes);
  void FlushRecord();
  Record SchemaRecord(Bytes& out, std::uint16_t id);
  Record ChannelRecord(Bytes& out, std::uint16_t id);
  void Announce(std::uint16_t channel);
  void CloseChunk();
  void WriteClosed();
  void IndexChunk(std::uint64_t offset, std::uint64_t length, std::string_view compression, std::uint64_t stored_bytes);
  void WriteSummary();
  SummaryGroup Statistics();

  OutputFile file;
  std::uint32_t data_crc = 0;
  bool closed = false;
  Bytes record;  // scratch: a record outside chunks
  std::vector<SchemaState> schemas;
  std::vector<ChannelState> channels;

  /// A full chunk. It is compressed in another thread while the next one fills. The caller's thread writes it when the
  /// next one is full or something else is to be written.
  struct Closed {
    Bytes raw;
    std::uint64_t start_ns = 0;
    std::uint64_t end_ns = 0;
    std::vector<Bytes> index;  // message indexes, by channel - 1
  };
  Closed full;
  mcap::BackgroundCompressor compressor;  // of full.raw; busy: it is to be written
  Bytes chunk;                            // the open chunk, uncompressed
  std::uint64_t chunk_messages = 0;
  std::uint64_t chunk_start_ns = 0;
  std::uint64_t chunk_end_ns = 0;

  std::uint64_t messages = 0;
  std::uint64_t start_ns = 0;
  std::uint64_t end_ns = 0;
  SummaryGroup chunk_indexes{Op::kChunkIndex, {}};
  SummaryGroup attachment_indexes{Op::kAttachmentIndex, {}};
  SummaryGroup metadata_indexes{Op::kMetadataIndex, {}};
};

std::string McapWriter::Library() { return std::string(kProgram) + " " MASCOT_VERSION; }

McapWriter::McapWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {
  impl_->WriteData(mcap::kMagic);
  Record(impl_->record, Op::kHeader).String(kProfile).String(Library()).End();
  impl_->FlushRecord();
}

McapWriter::~McapWriter() {
  try {
    impl_->WriteClosed();
  } catch (const std::exception&) {  // a destructor cannot report it; Close() would have
  }
}

std::uint16_t McapWriter::AddChannel(const Channel& channel) {
  assert(!impl_->closed);
  std::vector<SchemaState>& schemas = impl_->schemas;
  std::vector<ChannelState>& channels = impl_->channels;
  if (channels.size() == std::numeric_limits<std::uint16_t>::max())
    throw std::runtime_error(impl_->file.path() + ": more channels than MCAP can number (65535)");
  auto schema = std::find_if(schemas.begin(), schemas.end(), [&](const auto& s) {
    return s.name == channel.schema_name && s.text == channel.schema_text;
  });
  if (schema == schemas.end()) schema = schemas.insert(schema, {channel.schema_name, channel.schema_text});
  channels.push_back({channel, static_cast<std::uint16_t>(schema - schemas.begin() + 1), 0, {}});
  return static_cast<std::uint16_t>(channels.size());
}

void McapWriter::Write(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data) {
  assert(!impl_->closed && channel >= 1 && channel <= impl_->channels.size());
  Impl& m = *impl_;
  if (data.size() > kLargestChunkBytes)
    throw std::runtime_error(m.file.path() + ": a message of " + std::to_string(data.size()) +
                             " bytes, above the limit of " + std::to_string(kLargestChunkBytes));
  if (m.chunk.size() + data.size() > kLargestChunkBytes) m.CloseChunk();
  ChannelState& state = m.channels[channel - 1u];
  if (state.messages == 0) m.Announce(channel);

  Append(state.index, time_ns);
  Append(state.index, std::uint64_t{m.chunk.size()});
  const auto sequence = static_cast<std::uint32_t>(state.messages);
  Record(m.chunk, Op::kMessage).U16(channel).U32(sequence).U64(time_ns).U64(time_ns).Raw(data).End();

  m.chunk_start_ns = m.chunk_messages == 0 ? time_ns : std::min(m.chunk_start_ns, time_ns);
  m.chunk_end_ns = m.chunk_messages == 0 ? time_ns : std::max(m.chunk_end_ns, time_ns);
  ++m.chunk_messages;
  ++state.messages;
}

void McapWriter::EndTick() {
  if (impl_->chunk.size() >= kChunkBytes || impl_->chunk_end_ns - impl_->chunk_start_ns >= kChunkSpan_ns)
    impl_->CloseChunk();
}

void McapWriter::Attach(const std::string& name, const std::string& media_type, std::string_view data) {
  Impl& m = *impl_;
  m.CloseChunk();
  m.WriteClosed();
  const std::uint64_t offset = m.file.size();
  Record attachment(m.record, Op::kAttachment);
  attachment.U64(0).U64(0).String(name).String(media_type).U64(data.size()).Raw(AsBytes(data));
  attachment.U32(Crc32(0, ByteSpan(m.record).subspan(mcap::kFrameBytes))).End();
  m.FlushRecord();
  Record index = m.attachment_indexes.Add().U64(offset).U64(m.file.size() - offset).U64(0).U64(0);
  index.U64(data.size()).String(name).String(media_type).End();
}

void McapWriter::Metadata(const std::string& name, const std::map<std::string, std::string>& entries) {
  Impl& m = *impl_;
  m.CloseChunk();
  m.WriteClosed();
  const std::uint64_t offset = m.file.size();
  Record(m.record, Op::kMetadata).String(name).Map(entries).End();
  m.FlushRecord();
  m.metadata_indexes.Add().U64(offset).U64(m.file.size() - offset).String(name).End();
}

void McapWriter::Close() {
  if (impl_->closed) return;
  impl_->CloseChunk();
  impl_->WriteClosed();
  Record(impl_->record, Op::kDataEnd).U32(impl_->data_crc).End();
  impl_->FlushRecord();
  impl_->WriteSummary();
  impl_->file.SyncAndClose();
  impl_->closed = true;
}

bool IsByMcapWriter(const std::string& path) {
  // After the magic: the opcode of the header and its length (1 + 8 bytes), the profile and the library, each behind
  // its length (4 bytes). The library ends with a version.
  constexpr std::size_t kProfileAt = 21, kLibraryAt = kProfileAt + kProfile.size() + 4;
  Bytes bytes;
  InputFile(path).Read(0, kLibraryAt + kProgram.size(), bytes);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return bytes.size() == kLibraryAt + kProgram.size() &&
         std::equal(mcap::kMagic.begin(), mcap::kMagic.end(), bytes.begin()) &&
         text.substr(kProfileAt, kProfile.size()) == kProfile && text.substr(kLibraryAt) == kProgram;
}

std::uint64_t McapWriter::messages() const { return impl_->messages + impl_->chunk_messages; }
std::uint64_t McapWriter::bytes() const { return impl_->file.size(); }

/// Writes bytes of the data section and adds them to data_crc, which DataEnd holds: the CRC of all bytes before it.
void McapWriter::Impl::WriteData(ByteSpan bytes) {
  data_crc = Crc32(data_crc, bytes);
  file.Write(bytes);
}

void McapWriter::Impl::FlushRecord() {
  WriteData(record);
  record.clear();
}

Record McapWriter::Impl::SchemaRecord(Bytes& out, std::uint16_t id) {
  const SchemaState& schema = schemas[id - 1u];
  return Record(out, Op::kSchema).U16(id).String(schema.name).String("ros2msg").String(schema.text);
}

Record McapWriter::Impl::ChannelRecord(Bytes& out, std::uint16_t id) {
  const ChannelState& channel = channels[id - 1u];
  const Channel& description = channel.description;
  Record channel_record(out, Op::kChannel);
  return channel_record.U16(id).U16(channel.schema).String(description.topic).String("cdr").Map(description.metadata);
}

/// Writes the channel's schema and channel records into the chunk, once, just before its first message.
void McapWriter::Impl::Announce(std::uint16_t channel) {
  const std::uint16_t schema = channels[channel - 1u].schema;
  if (!std::exchange(schemas[schema - 1u].written, true)) SchemaRecord(chunk, schema).End();
  ChannelRecord(chunk, channel).End();
}

void McapWriter::Impl::CloseChunk() {
  if (chunk_messages == 0) return;  // readers would take the times of an empty chunk as valid
  WriteClosed();                    // the chunk before
  full.index.resize(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) full.index[i].swap(channels[i].index);
  full.raw.swap(chunk);
  full.start_ns = chunk_start_ns;
  full.end_ns = chunk_end_ns;
  compressor.Begin(full.raw);
  start_ns = messages == 0 ? chunk_start_ns : std::min(start_ns, chunk_start_ns);
  end_ns = messages == 0 ? chunk_end_ns : std::max(end_ns, chunk_end_ns);
  messages += chunk_messages;
  chunk.clear();
  chunk_messages = chunk_start_ns = chunk_end_ns = 0;
}

void McapWriter::Impl::WriteClosed() {
  if (!compressor.IsBusy()) return;
  const ByteSpan compressed = compressor.End();
  const ByteSpan stored = compressed.empty() ? ByteSpan(full.raw) : compressed;
  const std::string_view compression = compressed.empty() ? "" : "zstd";
  const std::uint64_t offset = file.size();
  Record head(record, Op::kChunk);
  head.U64(full.start_ns).U64(full.end_ns).U64(full.raw.size());
  head.U32(Crc32(0, full.raw)).String(compression).U64(stored.size()).End(/*beyond=*/stored.size());
  FlushRecord();
  WriteData(stored);
  IndexChunk(offset, file.size() - offset, compression, stored.size());
}

/// Writes the message index of each channel in the chunk, and adds the chunk's index to the summary.
void McapWriter::Impl::IndexChunk(std::uint64_t offset, std::uint64_t length, std::string_view compression,
                                  std::uint64_t stored_bytes) {
  const auto occurs = [](const Bytes& entries) { return !entries.empty(); };
  const auto occurring = std::count_if(full.index.begin(), full.index.end(), occurs);
  Record index = chunk_indexes.Add().U64(full.start_ns).U64(full.end_ns).U64(offset).U64(length);
  index.U32(static_cast<std::uint32_t>(occurring * 10));
  const std::uint64_t message_indexes = file.size();
  for (std::size_t i = 0; i < full.index.size(); ++i) {
    if (!occurs(full.index[i])) continue;
    const auto id = static_cast<std::uint16_t>(i + 1);
    index.U16(id).U64(message_indexes + record.size());
    Bytes& entries = full.index[i];
    Record(record, Op::kMessageIndex).U16(id).U32(static_cast<std::uint32_t>(entries.size())).Raw(entries).End();
    entries.clear();
  }
  FlushRecord();
  index.U64(file.size() - message_indexes).String(compression).U64(stored_bytes).U64(full.raw.size()).End();
}

SummaryGroup McapWriter::Impl::Statistics() {
  SummaryGroup group{Op::kStatistics, {}};
  const auto used = std::count_if(channels.begin(), channels.end(), [](const auto& c) { return c.messages > 0; });
  const auto written = std::count_if(schemas.begin(), schemas.end(), [](const auto& s) { return s.written; });
  Record counts =
      group.Add().U64(messages).U16(static_cast<std::uint16_t>(written)).U32(static_cast<std::uint32_t>(used));
  counts.U32(attachment_indexes.count).U32(metadata_indexes.count).U32(chunk_indexes.count).U64(start_ns).U64(end_ns);
  counts.U32(static_cast<std::uint32_t>(used * 10));
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].messages > 0) counts.U16(static_cast<std::uint16_t>(i + 1)).U64(channels[i].messages);
  counts.End();
  return group;
}

/// Writes the record groups in the order that readers expect (channels before statistics), their offsets, footer and
/// magic.
void McapWriter::Impl::WriteSummary() {
  SummaryGroup used_schemas{Op::kSchema, {}};
  SummaryGroup used_channels{Op::kChannel, {}};
  for (std::size_t i = 0; i < schemas.size(); ++i)
    if (schemas[i].written) SchemaRecord(used_schemas.records, static_cast<std::uint16_t>(i + 1)).End();
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].messages > 0) ChannelRecord(used_channels.records, static_cast<std::uint16_t>(i + 1)).End();
  SummaryGroup statistics = Statistics();

  const std::uint64_t summary_start = file.size();
  std::uint32_t crc = 0;
  const auto write = [&](ByteSpan bytes) {
    crc = Crc32(crc, bytes);
    file.Write(bytes);
  };
  for (const SummaryGroup* group :
       {&used_schemas, &used_channels, &statistics, &chunk_indexes, &attachment_indexes, &metadata_indexes}) {
    if (group->records.empty()) continue;
    const auto op = static_cast<std::uint8_t>(group->op);
    Record(record, Op::kSummaryOffset).U8(op).U64(file.size()).U64(group->records.size()).End();
    write(group->records);
  }
  const std::uint64_t offsets_start = file.size();
  write(record);
  record.clear();
  Record footer = Record(record, Op::kFooter).U64(summary_start).U64(offsets_start);
  footer.End(/*beyond=*/sizeof crc);  // the CRC covers the footer's own frame and offsets
  write(record);
  record.clear();
  Append(record, crc);
  Append(record, ByteSpan(mcap::kMagic));
  file.Write(record);
}

}  // namespace mascot
