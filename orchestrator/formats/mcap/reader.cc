#include "orchestrator/formats/mcap/reader.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "orchestrator/formats/input_file.h"
#include "orchestrator/formats/mcap/chunk.h"
#include "orchestrator/formats/mcap/contents_builder.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/zstd.h"

namespace mascot {
namespace {

using mcap::Fields;
using mcap::Malformed;
using mcap::Op;

/// Damage: the file ends where more must follow.
struct Truncated : Malformed {
  using Malformed::Malformed;
};

std::uint8_t Code(Op op) { return static_cast<std::uint8_t>(op); }

}  // namespace

/// Reads the file record by record and collects its contents. A malformed record throws Malformed, which ends the
/// reading.
class McapReader::Impl {
 public:
  explicit Impl(const std::string& path) : path_(path), file_(path) {
    UpToDamage([this] {
      ReadMagic();
      ReadHeader();
    });
  }

  const McapContents::Message* Next() {
    bool found = false;
    UpToDamage([&] {
      while (!over_ && !found) found = chunk_.empty() ? ReadDataRecord() : ReadChunkRecord();
    });
    return found ? &message_ : nullptr;
  }
  const McapContents& contents() const { return contents_; }
  std::uint64_t record_offset() const { return offset_; }

 private:
  /// Calls `read`. Damage ends the reading, and is described in the contents.
  template <class Read>
  void UpToDamage(const Read& read) try {
    read();
  } catch (const Malformed& damage) {
    over_ = true;
    contents_.cut = !whole_ || dynamic_cast<const Truncated*>(&damage) != nullptr;
    const std::string what = whole_ ? damage.what() : "the file ends inside a record";
    contents_.damage = what + " (record at byte " + std::to_string(offset_) + ")";
  }

  void ReadMagic();
  void ReadHeader();
  bool NextRecord();
  bool ReadDataRecord();
  void ReadMessage(Fields body);
  void OpenChunk(Fields body);
  bool ReadChunkRecord();
  void ReadDataEnd(Fields body);
  void ReadSummary();
  void ReadFooter(std::uint64_t summary_start, bool has_summary, std::uint32_t crc);
  void CompareStatistics(Fields body) const;

  std::string path_;
  InputFile file_;
  McapContents contents_;
  mcap::ContentsBuilder builder_{contents_};
  std::map<std::uint16_t, std::uint32_t> next_sequence_;  // expected next, by channel; starts at 0
  McapContents::Message message_;                         // reused: one allocation serves all messages
  bool over_ = false;                                     // the end of the file is read, or damage

  // The current record.
  std::uint64_t offset_ = 0;  // where it begins
  std::uint64_t next_ = 0;    // where the next record begins
  std::uint8_t op_ = 0;
  bool whole_ = true;  // all of its body is in the file
  Bytes record_;       // frame and body
  ByteSpan chunk_;     // if it is a chunk: the records in it that are still to be read
  Bytes frame_;
  mcap::Decompressor decompressor_;
  mcap::UnpackLimit limit_;
  std::uint32_t data_crc_ = 0;
};

void McapReader::Impl::ReadMagic() {
  file_.Read(0, mcap::kMagic.size(), record_);
  if (!std::equal(record_.begin(), record_.end(), mcap::kMagic.begin()))
    throw std::runtime_error(path_ + ": is no MCAP file: it does not begin with MCAP's magic bytes");
  if (record_.size() < mcap::kMagic.size()) throw Truncated("the file ends inside its first magic bytes");
  data_crc_ = Crc32(0, record_);
  next_ = mcap::kMagic.size();
}

/// Reads the record at `next_`. Returns false at the end of the file. `whole_` is false if the file ends inside it. A
/// wrong length does not make it read the rest of a large file into memory.
bool McapReader::Impl::NextRecord() {
  offset_ = next_;
  file_.Read(offset_, mcap::kFrameBytes, frame_);
  if (frame_.empty()) return false;
  if (frame_.size() < mcap::kFrameBytes) throw Truncated("the file ends inside a record's frame");
  Fields frame(frame_);
  op_ = frame.U8();
  const std::uint64_t length = frame.U64();
  const std::uint64_t available = file_.size() - offset_ - mcap::kFrameBytes;
  const std::uint64_t present = std::min(length, available);
  if (present > mcap::kMaxRecordBytes)
    throw Malformed("a record of " + std::to_string(length) + " bytes, above the limit of " +
                    std::to_string(mcap::kMaxRecordBytes));
  whole_ = length <= available;
  file_.Read(offset_, mcap::kFrameBytes + present, record_);
  next_ = offset_ + record_.size();
  return true;
}

void McapReader::Impl::ReadHeader() {
  if (!NextRecord() || !whole_) throw Truncated("the file ends before its header does");
  if (op_ != Code(Op::kHeader)) throw Malformed("expected a header record, got opcode " + std::to_string(op_));
  data_crc_ = Crc32(data_crc_, record_);
  Fields body(ByteSpan(record_).subspan(mcap::kFrameBytes));
  contents_.profile = body.String();
  contents_.library = body.String();
}

/// Reads the next record of the data section. Returns whether it is a message. Skips records with unknown opcodes.
bool McapReader::Impl::ReadDataRecord() {
  if (!whole_) throw Truncated("the file ends inside a record");  // a chunk, whose whole messages were read
  if (!NextRecord()) throw Truncated("the file ends without a summary: it was not closed");
  const Fields body(ByteSpan(record_).subspan(mcap::kFrameBytes));
  if (op_ == Code(Op::kChunk)) OpenChunk(body);  // even if cut: its whole messages count
  if (!whole_ && chunk_.empty()) throw Truncated("the file ends inside a record");
  if (op_ == Code(Op::kDataEnd)) {
    ReadDataEnd(body);
    return false;
  }
  if (op_ == Code(Op::kSchema)) builder_.AddSchema(body);
  if (op_ == Code(Op::kChannel)) builder_.AddChannel(body);
  if (op_ == Code(Op::kMessage)) ReadMessage(body);
  if (op_ == Code(Op::kAttachment)) builder_.AddAttachment(body);
  if (op_ == Code(Op::kMetadata)) builder_.AddMetadata(body);
  if (op_ == Code(Op::kFooter)) throw Malformed("a footer without the end of the data section");
  data_crc_ = Crc32(data_crc_, record_);
  return op_ == Code(Op::kMessage);
}

void McapReader::Impl::ReadMessage(Fields body) {
  mcap::ReadMessage(body, message_);
  const auto found = contents_.channels.find(message_.channel);
  if (found == contents_.channels.end())
    throw Malformed("a message on the unknown channel " + std::to_string(message_.channel));
  McapContents::ChannelInfo& channel = found->second;
  std::uint32_t& expected = next_sequence_[message_.channel];
  if (message_.sequence != expected) ++channel.gaps;
  expected = static_cast<std::uint32_t>(std::uint64_t{message_.sequence} + 1);  // from the last number on to 0
  channel.first_time = channel.messages == 0 ? message_.log_time : std::min(channel.first_time, message_.log_time);
  channel.last_time = std::max(channel.last_time, message_.log_time);
  channel.bytes += message_.data.size();
  ++channel.messages;
  ++contents_.messages;
}

void McapReader::Impl::OpenChunk(Fields body) {
  const mcap::Chunk chunk = mcap::OpenChunk(body, whole_, decompressor_, limit_);
  if (whole_) {
    ++contents_.chunks;
    contents_.compressed_bytes += chunk.stored_bytes;
    contents_.uncompressed_bytes += chunk.records.size();
  }
  chunk_ = chunk.records;
}

/// Reads the next record of the chunk. Returns whether it is a message.
bool McapReader::Impl::ReadChunkRecord() {
  const auto [op, body] = mcap::TakeRecord(chunk_);
  if (op == Code(Op::kSchema)) builder_.AddSchema(body);
  if (op == Code(Op::kChannel)) builder_.AddChannel(body);
  if (op == Code(Op::kMessage)) ReadMessage(body);
  return op == Code(Op::kMessage);
}

/// Reads the end of the data section, and the summary behind it.
void McapReader::Impl::ReadDataEnd(Fields body) {
  const std::uint32_t crc = body.U32();
  if (crc != 0 && crc != data_crc_) throw Malformed("the CRC of the data section is wrong");
  contents_.data_complete = true;
  ReadSummary();
  contents_.complete = over_ = true;
}

/// Reads the summary, if there is one, and compares its statistics and chunk indexes, if it has any, with the data
/// section.
void McapReader::Impl::ReadSummary() {
  const std::uint64_t summary_start = next_;
  std::uint32_t crc = 0;
  std::uint64_t chunk_indexes = 0;
  while (NextRecord()) {
    if (!whole_) throw Truncated("the file ends inside its summary");
    const Fields body(ByteSpan(record_).subspan(mcap::kFrameBytes));
    if (op_ == Code(Op::kFooter)) {
      if (chunk_indexes > 0 && chunk_indexes != contents_.chunks)
        throw Malformed("the summary does not index every chunk");
      return ReadFooter(summary_start, /*has_summary=*/offset_ != summary_start, crc);
    }
    crc = Crc32(crc, record_);
    if (op_ == Code(Op::kSchema)) builder_.AddSchema(body);
    if (op_ == Code(Op::kChannel)) builder_.AddChannel(body);
    if (op_ == Code(Op::kChunkIndex)) ++chunk_indexes;
    if (op_ == Code(Op::kStatistics)) CompareStatistics(body);
  }
  throw Truncated("the file ends inside its summary");
}

void McapReader::Impl::CompareStatistics(Fields body) const {
  const std::uint64_t messages = body.U64();
  body.U16();                           // schemas
  body.U32();                           // channels
  body.Raw(2 * sizeof(std::uint32_t));  // attachments, metadata
  const std::uint32_t chunks = body.U32();
  body.Raw(2 * sizeof(std::uint64_t));  // start, end
  bool right = messages == contents_.messages && chunks == contents_.chunks;
  for (Fields counts(body.Raw(body.U32())); !counts.rest().empty();) {
    const auto channel = contents_.channels.find(counts.U16());
    const std::uint64_t count = counts.U64();
    right = right && channel != contents_.channels.end() && channel->second.messages == count;
  }
  if (!right) throw Malformed("the statistics do not count what the file holds");
}

/// `crc` is the CRC of the summary so far; it also covers the footer's frame and its two offsets.
void McapReader::Impl::ReadFooter(std::uint64_t summary_start, bool has_summary, std::uint32_t crc) {
  Fields body(ByteSpan(record_).subspan(mcap::kFrameBytes));
  const std::uint64_t claimed_start = body.U64();
  body.U64();  // start of the summary offsets
  const std::uint32_t claimed_crc = body.U32();
  const std::size_t covered = mcap::kFrameBytes + 2 * sizeof(std::uint64_t);
  const bool is_told_as_none = claimed_start == 0 && !has_summary;
  if (claimed_start != summary_start && !is_told_as_none) throw Malformed("the footer does not point at the summary");
  if (claimed_crc != 0 && claimed_crc != Crc32(crc, ByteSpan(record_).first(covered)))
    throw Malformed("the CRC of the summary is wrong");
  file_.Read(next_, mcap::kMagic.size() + 1, frame_);
  if (frame_.size() < mcap::kMagic.size()) throw Truncated("the file ends inside its last magic bytes");
  if (!std::equal(frame_.begin(), frame_.end(), mcap::kMagic.begin(), mcap::kMagic.end()))
    throw Malformed("the file does not end with MCAP's magic bytes behind its footer");
}

McapReader::McapReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}

McapReader::~McapReader() = default;

const McapContents::Message* McapReader::Next() { return impl_->Next(); }

const McapContents& McapReader::contents() const { return impl_->contents(); }

std::uint64_t McapReader::record_offset() const { return impl_->record_offset(); }

McapContents ReadMcap(const std::string& path, const std::function<void(const McapContents::Message&)>& on_message) {
  McapReader reader(path);
  while (const McapContents::Message* message = reader.Next())
    if (on_message) on_message(*message);
  return reader.contents();
}

}  // namespace mascot
