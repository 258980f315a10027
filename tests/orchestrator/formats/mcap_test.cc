#include <gmock/gmock.h>
#include <sys/resource.h>
#include <zstd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>
#include <tuple>

#include "orchestrator/formats/mcap/index.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/writer.h"
#include "tests/orchestrator/formats/mcap_files.h"
#include "tests/support/scratch.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using mcap::Op;
using mcap::Record;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Pair;
using testing::StartsWith;
using testing::ThrowsMessage;

/// Bytes that zstd cannot compress.
Bytes Noise(std::mt19937_64& random, std::size_t bytes) {
  Bytes noise(bytes);
  for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
  return noise;
}

std::vector<McapContents::Message> Messages(const std::string& path) {
  std::vector<McapContents::Message> messages;
  ReadMcap(path, [&](const auto& message) { messages.push_back(message); });
  return messages;
}

/// Writes two channels; chunks compressed, stored, stored, compressed; an attachment and metadata between them.
std::string WriteSmallFile(const std::string& path) {
  std::mt19937_64 random(1);
  McapWriter writer(path);
  const auto one = writer.AddChannel(Numbers("/one"));
  const auto two = writer.AddChannel(Numbers("/two"));
  for (std::uint64_t k = 0; k < 4; ++k) {
    writer.Write(one, k * kMs, Bytes(40));
    writer.Write(two, k * kMs, Bytes(40));
  }
  writer.Attach("config.toml", "application/toml", "[run]\n");
  writer.Write(one, 4 * kMs + 77, Noise(random, 40));
  writer.Metadata("mascot", {{"seed", "1"}});
  writer.Write(two, 5 * kMs + 77, Noise(random, 40));
  writer.Metadata("more", {});
  for (std::uint64_t k = 0; k < 4; ++k) writer.Write(one, (6 + k) * kMs, Bytes(40));
  writer.Close();
  return ReadFile(path);
}

TEST(Mcap, ReadsBackWhatItWrote) {
  const ScratchFolder scratch;
  WriteSmallFile(scratch.File("run.mcap"));
  std::vector<McapContents::Message> messages;
  const McapContents contents =
      ReadMcap(scratch.File("run.mcap"), [&](const auto& message) { messages.push_back(message); });
  EXPECT_TRUE(contents.complete);
  EXPECT_EQ(contents.damage, "");
  EXPECT_EQ(contents.profile, "ros2");
  EXPECT_EQ(contents.library, McapWriter::Library());
  EXPECT_THAT(contents.library, MatchesRegex("mascot [0-9]+\\.[0-9]+\\.[0-9]+"));
  EXPECT_EQ(contents.messages, 14u);
  EXPECT_EQ(contents.chunks, 4u);
  EXPECT_THAT(contents.attachments, ElementsAre(Pair("config.toml", "[run]\n")));
  EXPECT_THAT(contents.metadata, ElementsAre(Pair("mascot", ElementsAre(Pair("seed", "1"))), Pair("more", IsEmpty())));

  ASSERT_EQ(contents.channels.size(), 2u);
  const auto& one = contents.channels.at(1);
  EXPECT_EQ(one.topic, "/one");
  EXPECT_EQ(one.schema_name, "test_msgs/msg/Number");
  EXPECT_EQ(one.schema_encoding, "ros2msg");
  EXPECT_EQ(one.schema_text, "uint64 n\n");
  EXPECT_EQ(one.message_encoding, "cdr");
  EXPECT_THAT(one.metadata, ElementsAre(Pair("a", "b")));
  EXPECT_EQ(one.messages, 9u);
  EXPECT_EQ(one.bytes, 9 * 40u);
  EXPECT_EQ(one.first_time, 0u);
  EXPECT_EQ(one.last_time, 9 * kMs);
  EXPECT_EQ(one.gaps, 0u);

  std::mt19937_64 random(1);
  EXPECT_EQ(messages[8].channel, 1u);
  EXPECT_EQ(messages[8].sequence, 4u);
  EXPECT_EQ(messages[8].log_time, 4 * kMs + 77);
  EXPECT_EQ(messages[8].data, Noise(random, 40));
}

TEST(Mcap, GivesOneMessageAtATime) {
  const ScratchFolder scratch;
  WriteSmallFile(scratch.File("run.mcap"));
  McapReader reader(scratch.File("run.mcap"));
  ASSERT_NE(reader.Next(), nullptr);
  EXPECT_EQ(reader.contents().messages, 1u);
  for (int k = 1; k < 14; ++k) ASSERT_NE(reader.Next(), nullptr);
  EXPECT_FALSE(reader.contents().complete);
  EXPECT_EQ(reader.Next(), nullptr);
  EXPECT_TRUE(reader.contents().complete);
  EXPECT_EQ(reader.Next(), nullptr);
}

TEST(Mcap, EqualCallsGiveEqualBytes) {
  const ScratchFolder scratch;
  EXPECT_EQ(WriteSmallFile(scratch.File("a.mcap")), WriteSmallFile(scratch.File("b.mcap")));
}

TEST(Mcap, CountsWhatWasWritten) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  const auto channel = writer.AddChannel(Numbers("/n"));
  writer.Write(channel, 0, Bytes(8));
  EXPECT_EQ(writer.messages(), 1u);
  writer.Close();
  EXPECT_EQ(writer.bytes(), ReadFile(scratch.File("run.mcap")).size());
}

TEST(Mcap, AnEmptyRecordingIsComplete) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  writer.AddChannel(Numbers("/never_used"));
  writer.EndTick();
  writer.Close();
  const McapContents contents = ReadMcap(scratch.File("run.mcap"));
  EXPECT_TRUE(contents.complete) << contents.damage;
  EXPECT_EQ(contents.chunks, 0u);
  EXPECT_THAT(contents.channels, IsEmpty());
}

/// Number of chunks of a file with one tick, of one message, for each size.
std::uint64_t ChunksOf(const std::vector<std::size_t>& sizes) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  const auto channel = writer.AddChannel(Numbers("/n"));
  std::uint64_t time_ns = 0;
  for (const std::size_t size : sizes) {
    writer.Write(channel, time_ns++, Bytes(size));
    writer.EndTick();
  }
  writer.Close();
  return ReadMcap(scratch.File("run.mcap")).chunks;
}

TEST(Mcap, AChunkClosesAtTheFirstTickBoundaryWithOneMebibyte) {
  const std::size_t overhead = 31;  // bytes of a message record without its data
  const std::size_t announced = (9 + 2 + 4 + 20 + 4 + 7 + 4 + 9) + (9 + 2 + 2 + 4 + 2 + 4 + 3 + 4 + 4 + 1 + 4 + 1);
  const std::size_t rest = (1u << 20) - announced - 2 * overhead - 1000;
  EXPECT_EQ(ChunksOf({1000, rest - 1, 0}), 1u) << "one byte less: the third tick still belongs to it";
  EXPECT_EQ(ChunksOf({1000, rest, 0}), 2u) << "exactly one mebibyte";
}

TEST(Mcap, AChunkClosesAtTheFirstTickBoundaryThatSpansOneSecond) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  const auto channel = writer.AddChannel(Numbers("/n"));
  for (std::uint64_t k = 0; k <= 300; ++k) {  // chunks end at tick 100, tick 201 and the end of the file
    writer.Write(channel, k * 10 * kMs, Bytes(8));
    writer.EndTick();
  }
  writer.Close();
  EXPECT_EQ(ReadMcap(scratch.File("run.mcap")).chunks, 3u);
}

/// The threads of this process that are not among `known`.
std::set<std::string> ThreadsBeside(const std::set<std::string>& known) {
  std::set<std::string> threads;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task"))
    if (!known.contains(thread.path().filename())) threads.insert(thread.path().filename());
  return threads;
}

TEST(Mcap, AllChunksAreCompressedByOneThreadThatLivesAsLongAsTheWriter) {
  const ScratchFolder scratch;
  std::thread([] {}).join();  // with the first thread of a program, ThreadSanitizer starts one of its own
  const std::set<std::string> known = ThreadsBeside({});
  {
    McapWriter writer(scratch.File("run.mcap"));
    const auto channel = writer.AddChannel(Numbers("/one"));
    std::set<std::string> seen;
    for (std::uint64_t k = 0; k < 50; ++k) {
      writer.Write(channel, k * 1000 * kMs, Bytes(100'000));
      writer.Write(channel, (k + 1) * 1000 * kMs, Bytes(100'000));
      writer.EndTick();
      seen.merge(ThreadsBeside(known));
    }
    EXPECT_EQ(seen.size(), 1u);
    writer.Close();
  }
  EXPECT_TRUE(test::Until([&] { return ThreadsBeside(known).empty(); }))
      << "the kernel lists a joined one for a moment";
  EXPECT_EQ(ReadMcap(scratch.File("run.mcap")).chunks, 50u);
}

TEST(Mcap, NeverWritesAChunkThatItWouldRefuseToRead) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  const auto channel = writer.AddChannel(Numbers("/n"));
  const Bytes eight_mebibyte(std::size_t{8} << 20);
  for (std::uint64_t k = 0; k < 10; ++k) writer.Write(channel, k, eight_mebibyte);  // one tick
  writer.Close();
  const McapContents contents = ReadMcap(scratch.File("run.mcap"));
  EXPECT_TRUE(contents.complete) << contents.damage;
  EXPECT_EQ(contents.messages, 10u);
  EXPECT_EQ(contents.chunks, 4u);
}

TEST(Mcap, RefusesAMessageThatNoChunkCanHold) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  McapWriter writer(path);
  const auto channel = writer.AddChannel(Numbers("/n"));
  EXPECT_THAT([&] { writer.Write(channel, 0, Bytes((std::size_t{32} << 20) + 1)); },
              ThrowsMessage<std::runtime_error>(path + ": a message of 33554433 bytes, above the limit of 33554432"));
}

TEST(Mcap, ChannelsWithOtherTextsOfASchemaKeepTheirOwn) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  for (const std::string text : {"uint64 n\n", "int8 n\n"})
    writer.Write(writer.AddChannel({"/" + text.substr(0, 1), "test_msgs/msg/Number", text, {}}), 0, Bytes(8));
  writer.Close();
  const McapContents contents = ReadMcap(scratch.File("run.mcap"));
  EXPECT_EQ(contents.channels.at(1).schema_text, "uint64 n\n");
  EXPECT_EQ(contents.channels.at(2).schema_text, "int8 n\n");
}

/// Offset in `file` after which each message is complete: its end, or the end of its chunk if that is compressed.
std::vector<std::size_t> MessageEnds(const std::string& file) {
  std::vector<std::size_t> ends;
  for (std::size_t offset = mcap::kMagic.size(); offset + mcap::kFrameBytes < file.size();) {
    mcap::Fields record(AsBytes(file).subspan(offset));
    const auto op = static_cast<Op>(record.U8());
    mcap::Fields body(record.Raw(record.U64()));
    offset = file.size() - record.rest().size();
    if (op != Op::kChunk) continue;
    body.Raw(2 * sizeof(std::uint64_t));  // times
    Bytes raw(body.U64());
    body.U32();  // CRC
    const bool compressed = body.String() == "zstd";
    const ByteSpan stored = body.Raw(body.U64());
    if (compressed) ZSTD_decompress(raw.data(), raw.size(), stored.data(), stored.size());
    if (!compressed) raw.assign(stored.begin(), stored.end());
    for (mcap::Fields chunk(raw); !chunk.rest().empty();) {
      const bool message = static_cast<Op>(chunk.U8()) == Op::kMessage;
      chunk.Raw(chunk.U64());
      if (message) ends.push_back(offset - (compressed ? 0 : chunk.rest().size()));
    }
  }
  return ends;
}

void CutAtEveryByte(const std::string& path) {
  const std::string file = ReadFile(path);
  const std::vector<McapContents::Message> all = Messages(path);
  const std::vector<std::size_t> ends = MessageEnds(file);
  ASSERT_EQ(ends.size(), all.size());
  for (std::size_t left = file.size(); left > 0; --left) {
    const std::size_t cut = left - 1;
    std::filesystem::resize_file(path, cut);
    std::vector<McapContents::Message> read;
    const McapContents contents = ReadMcap(path, [&](const auto& message) { read.push_back(message); });
    const auto whole = std::count_if(ends.begin(), ends.end(), [cut](std::size_t end) { return end <= cut; });
    ASSERT_FALSE(contents.complete) << "cut at " << cut;
    ASSERT_TRUE(contents.cut) << "cut at " << cut;
    ASSERT_THAT(contents.damage, AllOf(HasSubstr("the file "), HasSubstr("byte "))) << "cut at " << cut;
    ASSERT_GE(read.size(), static_cast<std::size_t>(whole)) << "cut at " << cut;  // a cut zstd frame may give more
    for (std::size_t i = 0; i < read.size(); ++i)
      ASSERT_EQ(std::tie(read[i].channel, read[i].sequence, read[i].data),
                std::tie(all[i].channel, all[i].sequence, all[i].data))
          << "cut at " << cut;
  }
}

TEST(Mcap, AFileCutAtAnyByteStillGivesEveryWholeMessageBeforeTheCut) {
  const ScratchFolder scratch;
  WriteSmallFile(scratch.File("run.mcap"));
  CutAtEveryByte(scratch.File("run.mcap"));
}

TEST(Mcap, AnUncompressedChunkCutAtAnyByteStillGivesEveryWholeMessageBeforeTheCut) {
  const ScratchFolder scratch;
  Bytes records;
  Record(records, Op::kChannel).U16(1).U16(0).String("/n").String("cdr").Map({}).End();
  for (std::uint32_t k = 0; k < 10; ++k) Record(records, Op::kMessage).U16(1).U32(k).U64(k).U64(k).U64(k).End();
  WriteFile(scratch.File("run.mcap"), Handmade(ChunkRecord(records.size(), "", records)));
  CutAtEveryByte(scratch.File("run.mcap"));
}

TEST(Mcap, EveryWholeBlockOfACutChunkIsRead) {
  const ScratchFolder scratch;
  std::mt19937_64 random(1);
  McapWriter writer(scratch.File("run.mcap"));
  const auto channel = writer.AddChannel(Numbers("/n"));
  for (std::uint64_t k = 0; k < 500; ++k) {
    Bytes half_noise = Noise(random, 1000);
    half_noise.resize(2000);
    writer.Write(channel, k, half_noise);
  }
  writer.Close();  // one chunk of 1 MB: eight blocks of zstd
  const std::string whole = ReadFile(scratch.File("run.mcap"));
  WriteFile(scratch.File("cut.mcap"), whole.substr(0, whole.size() / 2));
  const std::size_t rescued = Messages(scratch.File("cut.mcap")).size();
  EXPECT_GT(rescued, 100u);
  EXPECT_LT(rescued, 300u);
}

TEST(Mcap, AFileWithAnyByteChangedIsNeverComplete) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("bad.mcap");
  const std::string file = WriteSmallFile(path);
  std::fstream bad(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto put = [&bad](std::size_t at, char byte) { bad.seekp(static_cast<std::streamoff>(at)).put(byte).flush(); };
  for (std::size_t at = mcap::kMagic.size(); at < file.size(); ++at) {
    put(at, static_cast<char>(file[at] ^ 0x41));
    const McapContents contents = ReadMcap(path);
    put(at, file[at]);
    ASSERT_FALSE(contents.complete) << "byte " << at;
    ASSERT_NE(contents.damage, "") << "byte " << at;
  }
  EXPECT_TRUE(ReadMcap(path).complete);
}

TEST(Mcap, NoMessageOfAChunkWithAWrongCrcIsRead) {
  const ScratchFolder scratch;
  std::mt19937_64 random(1);
  McapWriter writer(scratch.File("run.mcap"));
  writer.Write(writer.AddChannel(Numbers("/n")), 0, Noise(random, 100));
  writer.Close();
  std::string file = ReadFile(scratch.File("run.mcap"));
  std::mt19937_64 again(1);
  const Bytes noise = Noise(again, 100);
  file[file.find(std::string(noise.begin(), noise.end()))] ^= 1;
  WriteFile(scratch.File("bad.mcap"), file);
  const McapContents contents = ReadMcap(scratch.File("bad.mcap"));
  EXPECT_THAT(contents.damage, StartsWith("the CRC of a chunk is wrong (record at byte "));
  EXPECT_EQ(contents.messages, 0u);
}

TEST(Mcap, HostileFilesAreDescribed) {
  const ScratchFolder scratch;
  for (const Hostile& hostile : HostileFiles()) {
    WriteFile(scratch.File("bad.mcap"), Handmade(hostile.records));
    const McapContents contents = ReadMcap(scratch.File("bad.mcap"));
    EXPECT_FALSE(contents.complete) << hostile.name;
    EXPECT_EQ(contents.damage, hostile.damage + " (record at byte 33)") << hostile.name;
  }
}

TEST(Mcap, ChunksThatUnpackToVeryMuchMoreThanTheyTakeAreRefusedAllTogether) {
  const Bytes zeros(std::size_t{63} << 20);
  Bytes packed(ZSTD_compressBound(zeros.size()));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), zeros.data(), zeros.size(), 3));
  const Bytes chunk = ChunkRecord(zeros.size(), "zstd", packed);
  Bytes chunks;
  for (int k = 0; k < 300; ++k) Append(chunks, ByteSpan(chunk));
  const ScratchFolder scratch;
  const std::string path = scratch.File("zeros.mcap");
  WriteFile(path, Handmade(chunks));
  const McapContents contents = ReadMcap(path);
  const std::uint64_t refused = contents.chunks + 1;  // the first that is not unpacked
  EXPECT_LT(refused * zeros.size(), std::uint64_t{400} << 20);
  EXPECT_EQ(contents.damage, "its chunks up to here unpack to " + std::to_string(refused * zeros.size()) +
                                 " bytes, above the limit of 268435456 and 300 times the " +
                                 std::to_string(refused * packed.size()) + " that they take (record at byte " +
                                 std::to_string(33 + contents.chunks * chunk.size()) + ")");
}

TEST(Mcap, AWrongLengthDoesNotTakeTheRestOfALargeFileIntoMemory) {
  const ScratchFolder scratch;
  const std::uint64_t large = std::uint64_t{300} << 20;
  Bytes record;
  Record(record, Op::kMetadata).End(/*beyond=*/large);
  WriteFile(scratch.File("bad.mcap"), Handmade(record));
  std::filesystem::resize_file(scratch.File("bad.mcap"), 2 * large);  // sparse
  EXPECT_EQ(ReadMcap(scratch.File("bad.mcap")).damage,
            "a record of 314572800 bytes, above the limit of 268435456 (record at byte 33)");
}

TEST(Mcap, SaysWhetherDamageIsInTheSummaryAlone) {
  const ScratchFolder scratch;
  const std::string file = WriteSmallFile(scratch.File("run.mcap"));
  const auto read = [&](const std::string& bytes) {
    WriteFile(scratch.File("bad.mcap"), bytes);
    return ReadMcap(scratch.File("bad.mcap"));
  };
  EXPECT_TRUE(read(file.substr(0, file.size() - 1)).data_complete);
  EXPECT_FALSE(read(file.substr(0, file.size() / 2)).data_complete);
  std::string changed = file;
  changed[file.size() - 20] ^= 1;  // in the footer
  EXPECT_TRUE(read(changed).data_complete);
  EXPECT_FALSE(read(changed).cut);
}

TEST(Mcap, CountsAGapWhereverTheSequenceDoesNotRiseByOne) {
  const ScratchFolder scratch;
  Bytes records;
  Record(records, Op::kChannel).U16(1).U16(0).String("/n").String("cdr").Map({}).End();
  for (const std::uint32_t sequence : {1u, 2u, 4u, 4u, 5u})
    Record(records, Op::kMessage).U16(1).U32(sequence).U64(0).U64(0).End();
  WriteFile(scratch.File("gaps.mcap"), Handmade(records));
  EXPECT_EQ(ReadMcap(scratch.File("gaps.mcap")).channels.at(1).gaps, 3u);
}

TEST(Mcap, StatisticsThatDoNotMatchAreDamage) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  writer.Close();
  std::string file = ReadFile(scratch.File("run.mcap"));
  // Count one message too many, and mark the CRC of the summary as absent.
  const std::string statistics = std::string(1, '\x0b') + std::string("\x2e\0\0\0\0\0\0\0", 8);
  file[file.find(statistics) + 9] = 1;
  file.replace(file.size() - 12, 4, 4, '\0');
  WriteFile(scratch.File("run.mcap"), file);
  EXPECT_THAT(ReadMcap(scratch.File("run.mcap")).damage, StartsWith("the statistics do not count what the file holds"));
}

TEST(Mcap, BytesAfterTheEndAreDamage) {
  const ScratchFolder scratch;
  WriteFile(scratch.File("long.mcap"), WriteSmallFile(scratch.File("run.mcap")) + "x");
  EXPECT_THAT(ReadMcap(scratch.File("long.mcap")).damage,
              StartsWith("the file does not end with MCAP's magic bytes behind its footer"));
}

TEST(Mcap, AFileThatCannotBeOpenedOrIsNoMcapIsAnError) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.mcap");
  const auto read = [&] { ReadMcap(path); };
  EXPECT_THAT(read, ThrowsMessage<std::runtime_error>("cannot open " + path + ": No such file or directory"));
  WriteFile(path, "PK\x03\x04, surely");
  EXPECT_THAT(read,
              ThrowsMessage<std::runtime_error>(path + ": is no MCAP file: it does not begin with MCAP's magic bytes"));
  EXPECT_THAT([&] { ReadMcap(scratch.path().string()); },
              ThrowsMessage<std::runtime_error>("cannot open " + scratch.path().string() + ": Is a directory"));
  EXPECT_THAT([&] { ReadMcap("/dev/zero"); },
              ThrowsMessage<std::runtime_error>("cannot open /dev/zero: not a regular file"));
}

TEST(Mcap, AFullDiskIsAnErrorThatNamesTheFile) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{4, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THAT([&] { McapWriter writer(path); },
              ThrowsMessage<std::runtime_error>("cannot write " + path + ": File too large"));
  ::setrlimit(RLIMIT_FSIZE, &before);
}

/// The messages of all chunks, one chunk after the other.
std::vector<McapContents::Message> MessagesOf(McapIndex& index) {
  std::vector<McapContents::Message> messages;
  for (const McapIndex::Chunk& chunk : index.chunks())
    index.ReadChunk(chunk, [&](const auto& message) { messages.push_back(message); });
  return messages;
}

MATCHER(IsSameMessage, "") {
  const auto& [a, b] = arg;
  return std::tie(a.channel, a.sequence, a.log_time, a.data) == std::tie(b.channel, b.sequence, b.log_time, b.data);
}

TEST(McapIndex, KnowsAndReadsWhatTheReaderDoes) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  WriteSmallFile(path);
  McapIndex index(path);
  EXPECT_TRUE(index.is_indexed());
  const McapContents contents = ReadMcap(path);
  EXPECT_EQ(index.contents().attachments, contents.attachments);
  EXPECT_EQ(index.contents().metadata, contents.metadata);
  EXPECT_EQ(index.contents().messages, contents.messages);
  EXPECT_TRUE(index.contents().complete);
  for (const auto& [id, channel] : contents.channels) {
    EXPECT_EQ(index.contents().channels.at(id).topic, channel.topic);
    EXPECT_EQ(index.contents().channels.at(id).messages, channel.messages);
  }
  ASSERT_EQ(index.chunks().size(), 4u);
  EXPECT_EQ(index.chunks()[0].last_ns, 3 * kMs);
  EXPECT_THAT(index.chunks()[0].channels, ElementsAre(1, 2));
  EXPECT_THAT(index.chunks()[3].channels, ElementsAre(1));
  EXPECT_THAT(MessagesOf(index), testing::Pointwise(IsSameMessage(), Messages(path)));
}

TEST(McapIndex, AFileCutAtAnyByteIsReadThroughAndGivesEveryWholeMessage) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("cut.mcap"), whole = WriteSmallFile(scratch.File("whole.mcap"));
  for (std::size_t size = 8; size < whole.size(); ++size) {
    WriteFile(path, whole.substr(0, size));
    McapIndex index(path);
    EXPECT_FALSE(index.is_indexed());
    EXPECT_EQ(index.contents().damage, ReadMcap(path).damage);
    ASSERT_THAT(MessagesOf(index), testing::Pointwise(IsSameMessage(), Messages(path))) << "cut at " << size;
  }
}

/// Where the first chunk index of a file has its numbers, and the end of the file the CRC of the summary.
struct ChunkIndexPlaces {
  std::size_t offset = 0, length = 0, index_bytes = 0, stored_bytes = 0, bytes = 0, crc = 0;
};

ChunkIndexPlaces PlacesIn(const std::string& file) {
  const auto number = [&file](std::size_t at, std::size_t bytes) {
    std::uint64_t value = 0;
    std::memcpy(&value, file.data() + at, bytes);
    return static_cast<std::size_t>(value);
  };
  ChunkIndexPlaces places{.crc = file.size() - 8 - 4};
  constexpr std::size_t kFrame = 9;
  std::size_t at = number(places.crc - 16, 8);
  while (file[at] != 0x08) at += kFrame + number(at + 1, 8);
  places.offset = at + kFrame + 16;
  places.length = places.offset + 8;
  const std::size_t map = places.length + 8;
  places.index_bytes = map + 4 + number(map, 4);
  const std::size_t compression = places.index_bytes + 8;
  places.stored_bytes = compression + 4 + number(compression, 4);
  places.bytes = places.stored_bytes + 8;
  return places;
}

TEST(McapIndex, NumbersThatCannotBeInTheIndexAreNotBelieved) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.mcap"), whole = WriteSmallFile(scratch.File("whole.mcap"));
  const ChunkIndexPlaces places = PlacesIn(whole);
  std::string without_crc = whole;
  without_crc.replace(places.crc, 4, 4, '\0');
  WriteFile(path, without_crc);
  EXPECT_TRUE(McapIndex(path).is_indexed());
  for (const std::size_t place : {places.offset, places.length, places.index_bytes, places.stored_bytes, places.bytes})
    for (const std::uint64_t number : {~std::uint64_t{0}, ~std::uint64_t{0} - 40, std::uint64_t{1} << 62}) {
      std::string file = without_crc;
      std::memcpy(&file[place], &number, 8);
      WriteFile(path, file);
      McapIndex index(path);
      EXPECT_FALSE(index.is_indexed()) << place << " " << number;
      EXPECT_THAT(MessagesOf(index), testing::Pointwise(IsSameMessage(), Messages(path)));
    }
}

TEST(McapIndex, OpensALongFileByReadingLittleOfIt) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("long.mcap");
  McapWriter writer(path);
  const auto channel = writer.AddChannel(Numbers("/n"));
  std::mt19937_64 random(1);
  for (std::uint64_t k = 0; k < 200; ++k) {  // 20 KiB a second
    writer.Write(channel, k * 1000 * kMs, Noise(random, 10 << 10));
    writer.Write(channel, (k * 1000 + 999) * kMs, Noise(random, 10 << 10));
    writer.Write(channel, (k * 1000 + 999) * kMs + kMs, {});
    writer.EndTick();
  }
  writer.Close();
  McapIndex index(path);
  const std::uint64_t size = std::filesystem::file_size(path);
  ASSERT_EQ(index.chunks().size(), 200u);
  EXPECT_LT(index.bytes_read(), size / 100);
  index.ReadChunk(index.chunks()[150], [](const auto&) {});
  EXPECT_LT(index.bytes_read(), size / 50);
}

TEST(McapIndex, ADamagedChunkIsAnErrorThatSaysWhere) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  std::string bytes = WriteSmallFile(path);
  const std::uint64_t offset = McapIndex(path).chunks()[1].offset;
  bytes[offset + 60] = static_cast<char>(bytes[offset + 60] ^ 1);
  WriteFile(path, bytes);
  McapIndex index(path);
  EXPECT_TRUE(index.is_indexed());
  EXPECT_THAT([&] { MessagesOf(index); },
              ThrowsMessage<std::runtime_error>(path + ": the CRC of a chunk is wrong (record at byte " +
                                                std::to_string(offset) + ")"));
}

TEST(Mcap, AFileThatCannotBeCreatedIsAnErrorThatNamesIt) {
  EXPECT_THAT([] { McapWriter writer("/nowhere/run.mcap"); },
              ThrowsMessage<std::runtime_error>("cannot create /nowhere/run.mcap: No such file or directory"));
}

TEST(Mcap, AfterAFailedWriteEveryFurtherOneFailsAndWhatWasThereIsReadable) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{20'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  {
    std::mt19937_64 random(1);
    McapWriter writer(path);
    const auto channel = writer.AddChannel(Numbers("/n"));
    const auto tick = [&](std::uint64_t second) {
      writer.Write(channel, 2 * second * 1000 * kMs, Noise(random, 3000));
      writer.Write(channel, (2 * second + 1) * 1000 * kMs, Noise(random, 3000));
      writer.EndTick();
    };
    const std::string error = "cannot write " + path + ": File too large";
    EXPECT_THAT(([&] {
                  for (std::uint64_t k = 0; k < 10; ++k) tick(k);
                }),
                ThrowsMessage<std::runtime_error>(error));
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_THAT([&] { writer.Close(); }, ThrowsMessage<std::runtime_error>(error));
  }
  EXPECT_EQ(ReadFile(path).size(), 20'000u);
  EXPECT_EQ(Messages(path).size(), 6u);  // three whole chunks, and no whole message of the fourth
}

}  // namespace
}  // namespace mascot
