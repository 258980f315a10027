#include "orchestrator/formats/mcap/index.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "orchestrator/formats/input_file.h"
#include "orchestrator/formats/mcap/chunk.h"
#include "orchestrator/formats/mcap/contents_builder.h"

namespace mascot {
namespace {

using mcap::Fields;
using mcap::Malformed;
using mcap::Op;

constexpr std::uint64_t kFooterBytes = mcap::kFrameBytes + 20;  // two offsets and a CRC
constexpr std::uint64_t kMinMessageBytes = mcap::kFrameBytes + 22;
constexpr std::uint64_t kFooterCovered = mcap::kFrameBytes + 16;

bool Is(std::uint8_t code, Op op) { return code == static_cast<std::uint8_t>(op); }

/// Where a record is that the summary indexes.
struct Place {
  std::uint64_t offset = 0, bytes = 0;
};

}  // namespace

class McapIndex::Impl {
 public:
  explicit Impl(const std::string& path) : path_(path), file_(path) {
    try {
      ReadSummary();
      is_indexed_ = true;
    } catch (const Malformed&) {  // what is wrong, the reader says
      ReadThrough();
    }
  }

  void ReadChunk(const Chunk& chunk, const std::function<void(const McapContents::Message&)>& on_message) try {
    const bool whole = ReadRecord(chunk.offset);
    const Fields body(ByteSpan(record_).subspan(mcap::kFrameBytes));
    if (Is(record_[0], Op::kMessage)) {
      mcap::ReadMessage(body, message_);
      return on_message(message_);
    }
    if (!Is(record_[0], Op::kChunk)) throw Malformed("the index points at no chunk");
    mcap::UnpackLimit limit;  // of this chunk; what all take together was looked at when the file was opened
    const ByteSpan all = mcap::OpenChunk(body, whole, decompressor_, limit).records;
    if (is_indexed_ && all.size() != chunk.bytes) throw Malformed("the index says another size of a chunk");
    for (ByteSpan records = all; !records.empty();) {
      if (!TakeMessage(records, whole)) continue;
      on_message(message_);
    }
  } catch (const Malformed& damage) {
    throw std::runtime_error(path_ + ": " + damage.what() + " (record at byte " + std::to_string(chunk.offset) + ")");
  }

  McapContents contents_;
  std::vector<Chunk> chunks_;
  bool is_indexed_ = false;
  std::uint64_t bytes_read_ = 0;

 private:
  void ReadSummary();
  bool IsAllIndexed(std::uint64_t summary_start, const std::vector<Place>& attachments,
                    const std::vector<Place>& metadata);
  void AddChunk(Fields body);
  void AddCounts(Fields body);
  void ReadIndexed(const std::vector<Place>& places, Op op, void (mcap::ContentsBuilder::*add)(Fields));
  void ReadThrough();
  bool ReadRecord(std::uint64_t offset);
  bool TakeMessage(ByteSpan& records, bool whole);
  void Read(std::uint64_t offset, std::uint64_t bytes, Bytes& out) {
    file_.Read(offset, bytes, out);
    bytes_read_ += out.size();
  }

  std::string path_;
  InputFile file_;
  mcap::ContentsBuilder builder_{contents_};
  Bytes record_;
  mcap::Decompressor decompressor_;
  McapContents::Message message_;
  mcap::UnpackLimit limit_;
  std::uint64_t chunks_end_ = 0, chunk_bytes_ = 0;  // of those in the index so far
};

/// Reads the summary, which the footer at the end of the file points at, and what it points at besides chunks. Throws
/// Malformed if it is not all there and right.
void McapIndex::Impl::ReadSummary() {
  const std::uint64_t tail = kFooterBytes + mcap::kMagic.size();
  if (file_.size() < tail) throw Malformed("no footer");
  Bytes bytes;
  Read(0, mcap::kMagic.size(), bytes);
  if (!std::ranges::equal(bytes, mcap::kMagic)) throw Malformed("no magic bytes");
  const std::uint64_t footer_at = file_.size() - tail;
  Read(footer_at, tail, bytes);
  Fields footer(bytes);
  if (!Is(footer.U8(), Op::kFooter) || footer.U64() != kFooterBytes - mcap::kFrameBytes) throw Malformed("no footer");
  const std::uint64_t start = footer.U64();
  footer.U64();  // start of the summary offsets
  const std::uint32_t crc = footer.U32();
  const bool ends = std::ranges::equal(footer.rest(), mcap::kMagic);
  if (!ends || start == 0 || start > footer_at || footer_at - start > mcap::kMaxRecordBytes)
    throw Malformed("no summary");
  Read(start, footer_at - start + kFooterCovered, bytes);
  if (crc != 0 && crc != Crc32(0, bytes)) throw Malformed("the CRC of the summary is wrong");

  std::vector<Place> attachments, metadata;
  bool has_statistics = false;
  for (ByteSpan records = ByteSpan(bytes).first(bytes.size() - kFooterCovered); !records.empty();) {
    auto [op, body] = mcap::TakeRecord(records);
    if (Is(op, Op::kSchema)) builder_.AddSchema(body);
    if (Is(op, Op::kChannel)) builder_.AddChannel(body);
    if (Is(op, Op::kChunkIndex)) AddChunk(body);
    if (Is(op, Op::kAttachmentIndex)) attachments.push_back({body.U64(), body.U64()});
    if (Is(op, Op::kMetadataIndex)) metadata.push_back({body.U64(), body.U64()});
    if (Is(op, Op::kStatistics)) {
      AddCounts(body);
      has_statistics = true;
    }
  }
  if (!has_statistics || chunks_.size() != contents_.chunks) throw Malformed("the summary does not index every chunk");
  if (!IsAllIndexed(start, attachments, metadata)) throw Malformed("the summary does not index all of the file");
  ReadIndexed(attachments, Op::kAttachment, &mcap::ContentsBuilder::AddAttachment);
  ReadIndexed(metadata, Op::kMetadata, &mcap::ContentsBuilder::AddMetadata);
  contents_.complete = contents_.data_complete = true;
}

/// Whether the chunks and what else the summary indexes leave no room for a message in front of it: MCAP lets messages
/// lie outside of chunks, too, and has no index of those.
bool McapIndex::Impl::IsAllIndexed(std::uint64_t summary_start, const std::vector<Place>& attachments,
                                   const std::vector<Place>& metadata) {
  constexpr std::uint64_t kDataEndBytes = mcap::kFrameBytes + 4;
  if (!ReadRecord(mcap::kMagic.size())) throw Malformed("no header");
  std::uint64_t room = summary_start - std::min(summary_start, mcap::kMagic.size() + record_.size() + kDataEndBytes);
  const auto fill = [&room](std::uint64_t bytes) { room -= std::min(room, bytes); };
  fill(chunk_bytes_);
  for (const std::vector<Place>* places : {&attachments, &metadata})
    for (const Place& place : *places) fill(place.bytes);
  return room < kMinMessageBytes;
}

void McapIndex::Impl::AddChunk(Fields body) {
  Chunk chunk;
  chunk.first_ns = body.U64();
  chunk.last_ns = body.U64();
  chunk.offset = body.U64();
  const std::uint64_t length = body.U64();
  if (chunk.offset > file_.size() || length > file_.size() - chunk.offset)
    throw Malformed("the index points beyond the end of the file");
  if (chunk.offset < chunks_end_) throw Malformed("the index names a part of the file twice");
  chunks_end_ = chunk.offset + length;
  for (Fields places(body.Raw(body.U32())); !places.rest().empty(); places.U64())
    chunk.channels.push_back(places.U16());
  std::ranges::sort(chunk.channels);
  const std::uint64_t index_bytes = body.U64();  // of the message indexes behind it
  const bool is_packed = !body.String().empty();
  const std::uint64_t stored_bytes = body.U64();
  chunk.bytes = body.U64();
  if (index_bytes > file_.size() - chunks_end_ || stored_bytes > length || chunk.bytes > mcap::kMaxChunkBytes)
    throw Malformed("the index has a chunk that cannot be");
  chunk_bytes_ += length + index_bytes;
  if (chunk.channels.empty() && chunk.bytes >= kMinMessageBytes)
    throw Malformed("the index does not say which channels a chunk has");
  if (is_packed) limit_.Add(stored_bytes, chunk.bytes);
  contents_.compressed_bytes += stored_bytes;
  contents_.uncompressed_bytes += chunk.bytes;
  chunks_.push_back(std::move(chunk));
}

void McapIndex::Impl::AddCounts(Fields body) {
  contents_.messages = body.U64();
  body.U16();                           // schemas
  body.U32();                           // channels
  body.Raw(2 * sizeof(std::uint32_t));  // attachments, metadata
  contents_.chunks = body.U32();
  body.Raw(2 * sizeof(std::uint64_t));  // start, end
  for (Fields counts(body.Raw(body.U32())); !counts.rest().empty();) {
    const auto channel = contents_.channels.find(counts.U16());
    if (channel == contents_.channels.end()) throw Malformed("the statistics count an unknown channel");
    channel->second.messages = counts.U64();
  }
}

void McapIndex::Impl::ReadIndexed(const std::vector<Place>& places, Op op, void (mcap::ContentsBuilder::*add)(Fields)) {
  for (const Place& place : places) {
    if (!ReadRecord(place.offset) || !Is(record_[0], op) || record_.size() != place.bytes)
      throw Malformed("the summary points at something else");
    (builder_.*add)(Fields(ByteSpan(record_).subspan(mcap::kFrameBytes)));
  }
}

void McapIndex::Impl::ReadThrough() {
  chunks_.clear();
  McapReader reader(path_);
  while (const McapContents::Message* message = reader.Next()) {
    if (chunks_.empty() || chunks_.back().offset != reader.record_offset())
      chunks_.push_back({reader.record_offset(), message->log_time, message->log_time, {}, 0});
    Chunk& chunk = chunks_.back();
    chunk.first_ns = std::min(chunk.first_ns, message->log_time);
    chunk.last_ns = std::max(chunk.last_ns, message->log_time);
    const auto place = std::ranges::lower_bound(chunk.channels, message->channel);
    if (place == chunk.channels.end() || *place != message->channel) chunk.channels.insert(place, message->channel);
  }
  contents_ = reader.contents();
}

/// Reads the record at `offset`, as far as it is there. Returns whether it is whole.
bool McapIndex::Impl::ReadRecord(std::uint64_t offset) {
  Read(offset, mcap::kFrameBytes, record_);
  Fields frame(record_);
  frame.U8();
  const std::uint64_t length = frame.U64();
  const std::uint64_t available = file_.size() - std::min(file_.size(), offset + mcap::kFrameBytes);
  if (std::min(length, available) > mcap::kMaxRecordBytes) throw Malformed("a record that is too long");
  Read(offset, mcap::kFrameBytes + std::min(length, available), record_);
  return length <= available;
}

/// Takes the next record off an open chunk. Returns whether it is a message, which message_ then holds. Where a chunk
/// is cut off nothing more follows.
bool McapIndex::Impl::TakeMessage(ByteSpan& records, bool whole) try {
  const auto [op, body] = mcap::TakeRecord(records);
  if (!Is(op, Op::kMessage)) return false;
  mcap::ReadMessage(body, message_);
  return true;
} catch (const Malformed&) {
  if (whole) throw;
  records = {};
  return false;
}

McapIndex::McapIndex(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}

McapIndex::~McapIndex() = default;

const McapContents& McapIndex::contents() const { return impl_->contents_; }

bool McapIndex::is_indexed() const { return impl_->is_indexed_; }

const std::vector<McapIndex::Chunk>& McapIndex::chunks() const { return impl_->chunks_; }

void McapIndex::ReadChunk(const Chunk& chunk, const std::function<void(const McapContents::Message&)>& on_message) {
  impl_->ReadChunk(chunk, on_message);
}

std::uint64_t McapIndex::bytes_read() const { return impl_->bytes_read_; }

}  // namespace mascot
