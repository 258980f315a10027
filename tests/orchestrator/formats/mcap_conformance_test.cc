// Files of MCAP, and what is in them, as https://mcap.dev/spec has it: those of tests/mcap_conformance, made byte by
// byte there, and the conformance files of foxglove/mcap, where tests/mcap_conformance/fetch has brought them.
#include <gmock/gmock.h>
#include <zstd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "orchestrator/formats/mcap/index.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/writer.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using mcap::Fields;
using mcap::Op;
using Json = nlohmann::json;

const std::filesystem::path kOurs = test::SourceFolder() + "/tests/mcap_conformance";
const std::filesystem::path kTheirs = kOurs / "foxglove";  // see tests/mcap_conformance/fetch

/// A file, and what its .json says of it.
struct Example {
  explicit Example(const std::filesystem::path& path) : file(path.string()) {
    told = Json::parse(ReadFile(std::filesystem::path(path).replace_extension(".json")));
    for (const Json& record : told.at("records")) {
      Json fields = Json::object();
      for (const Json& field : record.at("fields")) fields[field[0].get<std::string>()] = field[1];
      records.emplace_back(record.at("type"), std::move(fields));
    }
    for (const Json& feature : told.at("meta").at("variant").at("features")) features.insert(feature);
  }
  bool Has(std::initializer_list<const char*> all) const {
    return std::ranges::all_of(all, [&](const char* feature) { return features.contains(feature); });
  }
  std::string damage() const { return told.value("damage", ""); }

  std::string file;
  Json told;
  std::vector<std::pair<std::string, Json>> records;  ///< type and fields, numbers as strings
  std::set<std::string> features;
};

std::vector<Example> ExamplesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".mcap") paths.push_back(entry.path());
  std::ranges::sort(paths);
  return {paths.begin(), paths.end()};
}

std::uint64_t NumberOf(const Json& field) { return std::stoull(field.get<std::string>()); }

std::string BytesOf(const Json& field) {
  std::string bytes;
  for (const Json& byte : field) bytes += static_cast<char>(std::stoi(byte.get<std::string>()));
  return bytes;
}

std::map<std::string, std::string> TextsOf(const Json& field) { return field; }

/// What a reader has to give of a file.
struct Contents {
  struct Channel {
    std::string topic, encoding, schema, schema_encoding, schema_text;
    std::map<std::string, std::string> metadata;
    std::uint64_t messages = 0;
    bool operator==(const Channel&) const = default;
    friend void PrintTo(const Channel& channel, std::ostream* out) {
      *out << channel.topic << " by " << channel.encoding << " of " << channel.schema << ": " << channel.messages;
    }
  };
  struct Message {
    std::uint64_t channel = 0, sequence = 0, log_time = 0;
    std::string data;
    auto operator<=>(const Message&) const = default;
    friend void PrintTo(const Message& message, std::ostream* out) {
      *out << message.channel << " #" << message.sequence << " at " << message.log_time << ": " << message.data;
    }
  };

  std::string profile, library;
  std::map<std::uint64_t, Channel> channels;
  std::vector<Message> messages;                                           // in the order of the file
  std::map<std::string, std::pair<std::string, std::string>> attachments;  // media type and bytes
  std::map<std::string, std::map<std::string, std::string>> metadata;
};

Contents ToldOf(const Example& example) {
  Contents contents;
  std::map<std::uint64_t, Json> schemas;
  for (const auto& [type, fields] : example.records) {
    if (type == "DataEnd") break;  // the summary says nothing new
    if (type == "Header") {
      contents.profile = fields.at("profile");
      contents.library = fields.at("library");
    } else if (type == "Schema") {
      schemas[NumberOf(fields.at("id"))] = fields;
    } else if (type == "Channel") {
      Contents::Channel channel{
          fields.at("topic"), fields.at("message_encoding"), {}, {}, {}, TextsOf(fields.at("metadata"))};
      if (const auto id = NumberOf(fields.at("schema_id")); id != 0) {
        const Json& schema = schemas.at(id);
        channel.schema = schema.at("name");
        channel.schema_encoding = schema.at("encoding");
        channel.schema_text = BytesOf(schema.at("data"));
      }
      contents.channels.try_emplace(NumberOf(fields.at("id")), channel);
    } else if (type == "Message") {
      const std::uint64_t channel = NumberOf(fields.at("channel_id"));
      ++contents.channels.at(channel).messages;
      contents.messages.push_back(
          {channel, NumberOf(fields.at("sequence")), NumberOf(fields.at("log_time")), BytesOf(fields.at("data"))});
    } else if (type == "Attachment") {
      contents.attachments[fields.at("name")] = {fields.at("media_type"), BytesOf(fields.at("data"))};
    } else if (type == "Metadata") {
      contents.metadata[fields.at("name")] = TextsOf(fields.at("metadata"));
    } else {
      ADD_FAILURE() << example.file << ": a record of the unknown type " << type;
    }
  }
  return contents;
}

Contents::Message MessageOf(const McapContents::Message& message) {
  return {message.channel, message.sequence, message.log_time, {message.data.begin(), message.data.end()}};
}

Contents ContentsOf(const McapContents& read, std::vector<Contents::Message> messages) {
  Contents contents{read.profile, read.library, {}, std::move(messages), {}, read.metadata};
  for (const auto& [id, c] : read.channels)
    contents.channels[id] = {c.topic,       c.message_encoding, c.schema_name, c.schema_encoding,
                             c.schema_text, c.metadata,         c.messages};
  for (const auto& [name, bytes] : read.attachments) contents.attachments[name] = {read.media_types.at(name), bytes};
  return contents;
}

void ExpectSame(const Contents& read, const Contents& told) {
  EXPECT_EQ(read.channels, told.channels);
  EXPECT_EQ(read.messages, told.messages);
  EXPECT_EQ(read.attachments, told.attachments);
  EXPECT_EQ(read.metadata, told.metadata);
}

/// McapReader gives all that the file is told to hold, and nothing else.
void ExpectRead(const Example& example) {
  const Contents told = ToldOf(example);
  std::vector<Contents::Message> messages;
  const McapContents read =
      ReadMcap(example.file, [&](const auto& message) { messages.push_back(MessageOf(message)); });
  ExpectSame(ContentsOf(read, messages), told);
  EXPECT_EQ(read.profile, told.profile);
  EXPECT_EQ(read.library, told.library);
  EXPECT_EQ(read.damage.substr(0, read.damage.find(" (record at byte ")), example.damage());
  EXPECT_EQ(read.complete, example.damage().empty());
}

/// McapIndex gives the same messages, in any order.
void ExpectReadByIndex(const Example& example) {
  McapIndex index(example.file);
  std::vector<Contents::Message> messages;
  for (const McapIndex::Chunk& chunk : index.chunks())
    index.ReadChunk(chunk, [&](const McapContents::Message& message) {
      messages.push_back(MessageOf(message));
      EXPECT_GE(message.log_time, chunk.first_ns);
      EXPECT_LE(message.log_time, chunk.last_ns);
      EXPECT_THAT(chunk.channels, ::testing::Contains(message.channel));
    });
  Contents told = ToldOf(example);
  // A channel that the index does not name has no messages.
  if (index.is_indexed())
    std::erase_if(told.channels, [&](const auto& c) {
      return !index.contents().channels.contains(static_cast<std::uint16_t>(c.first)) && c.second.messages == 0;
    });
  ExpectSame(ContentsOf(index.contents(), messages), told);
}

// --- record by record -------------------------------------------------------------------------------

Json Bytes2Json(ByteSpan bytes) {
  Json array = Json::array();
  for (const std::uint8_t byte : bytes) array.push_back(std::to_string(byte));
  return array;
}

/// A map of numbers, whose size in bytes is in front of it.
Json NumbersIn(Fields body) {
  Json numbers = Json::object();
  for (Fields entries(body.Raw(body.U32())); !entries.rest().empty();) {
    const std::string key = std::to_string(entries.U16());
    numbers[key] = std::to_string(entries.U64());
  }
  return numbers;
}

/// Takes fields off a record and names them, in their order in the specification.
class Namer {
 public:
  explicit Namer(Fields& body) : body_(body) {}
  Namer& U8(const char* name) { return Put(name, body_.U8()); }
  Namer& U16(const char* name) { return Put(name, body_.U16()); }
  Namer& U32(const char* name) { return Put(name, body_.U32()); }
  Namer& U64(const char* name) { return Put(name, body_.U64()); }
  Namer& Text(const char* name) {
    fields_[name] = body_.String();
    return *this;
  }
  Namer& Texts(const char* name) {
    fields_[name] = body_.Map();
    return *this;
  }
  Namer& Numbers(const char* name) {
    fields_[name] = NumbersIn(body_);
    body_.Raw(body_.U32());
    return *this;
  }
  Namer& Data(const char* name, std::uint64_t bytes) {
    fields_[name] = Bytes2Json(body_.Raw(bytes));
    return *this;
  }
  Json fields() const { return fields_; }

 private:
  Namer& Put(const char* name, std::uint64_t value) {
    fields_[name] = std::to_string(value);
    return *this;
  }
  Fields& body_;
  Json fields_ = Json::object();
};

using Records = std::vector<std::pair<std::string, Json>>;

void ListRecords(ByteSpan bytes, Records& records);

void ListChunk(Fields body, Records& records) {
  body.Raw(2 * sizeof(std::uint64_t));  // times
  Bytes open(body.U64());
  body.U32();  // CRC
  const std::string compression = body.String();
  const ByteSpan stored = body.Raw(body.U64());
  if (compression.empty()) return ListRecords(stored, records);
  EXPECT_EQ(ZSTD_decompress(open.data(), open.size(), stored.data(), stored.size()), open.size());
  ListRecords(open, records);
}

/// The records of a file from its first to its footer, in the form of a .json.
void ListRecords(ByteSpan bytes, Records& records) {
  while (!bytes.empty()) {
    Fields frame(bytes);
    const Op op{frame.U8()};
    const std::uint64_t size = frame.U64();
    Fields body(frame.Raw(size));
    bytes = frame.rest();
    Namer named(body);
    const auto add = [&](const char* type, const Namer& fields) { records.emplace_back(type, fields.fields()); };
    switch (op) {
      case Op::kHeader:
        add("Header", named.Text("profile").Text("library"));
        break;
      case Op::kFooter:
        return add("Footer", named.U64("summary_start").U64("summary_offset_start").U32("summary_crc"));
      case Op::kSchema: {
        named.U16("id").Text("name").Text("encoding");
        add("Schema", named.Data("data", body.U32()));
        break;
      }
      case Op::kChannel:
        add("Channel", named.U16("id").U16("schema_id").Text("topic").Text("message_encoding").Texts("metadata"));
        break;
      case Op::kMessage: {
        named.U16("channel_id").U32("sequence").U64("log_time").U64("publish_time");
        add("Message", named.Data("data", body.rest().size()));
        break;
      }
      case Op::kChunk:
        ListChunk(body, records);
        break;
      case Op::kMessageIndex:
        break;
      case Op::kChunkIndex:
        named.U64("message_start_time").U64("message_end_time").U64("chunk_start_offset").U64("chunk_length");
        named.Numbers("message_index_offsets").U64("message_index_length").Text("compression");
        add("ChunkIndex", named.U64("compressed_size").U64("uncompressed_size"));
        break;
      case Op::kAttachment: {
        named.U64("log_time").U64("create_time").Text("name").Text("media_type");
        add("Attachment", named.Data("data", body.U64()));
        break;
      }
      case Op::kAttachmentIndex:
        named.U64("offset").U64("length").U64("log_time").U64("create_time").U64("data_size").Text("name");
        add("AttachmentIndex", named.Text("media_type"));
        break;
      case Op::kStatistics:
        named.U64("message_count").U16("schema_count").U32("channel_count").U32("attachment_count");
        named.U32("metadata_count").U32("chunk_count").U64("message_start_time").U64("message_end_time");
        add("Statistics", named.Numbers("channel_message_counts"));
        break;
      case Op::kMetadata:
        add("Metadata", named.Text("name").Texts("metadata"));
        break;
      case Op::kMetadataIndex:
        add("MetadataIndex", named.U64("offset").U64("length").Text("name"));
        break;
      case Op::kSummaryOffset:
        add("SummaryOffset", named.U8("group_opcode").U64("group_start").U64("group_length"));
        break;
      case Op::kDataEnd:
        add("DataEnd", named.U32("data_section_crc"));
        break;
    }
  }
}

Records RecordsOf(const std::string& file) {
  Records records;
  const std::string bytes = ReadFile(file);
  ListRecords(AsBytes(bytes).subspan(mcap::kMagic.size()), records);
  return records;
}

/// What the summary says is where it says, and as long.
void ExpectRightPlaces(const std::string& file, const Records& records) {
  const std::string bytes = ReadFile(file);
  const auto at = [&](const Json& place) { return Fields(AsBytes(bytes).subspan(NumberOf(place))); };
  const auto expect = [&](Op op, const Json& place, const Json& length) {
    Fields frame = at(place);
    EXPECT_EQ(Op{frame.U8()}, op) << place;
    EXPECT_EQ(mcap::kFrameBytes + frame.U64(), NumberOf(length)) << place;
  };
  for (const auto& [type, fields] : records) {
    if (type == "AttachmentIndex") expect(Op::kAttachment, fields.at("offset"), fields.at("length"));
    if (type == "MetadataIndex") expect(Op::kMetadata, fields.at("offset"), fields.at("length"));
    if (type == "SummaryOffset") {
      EXPECT_EQ(std::to_string(at(fields.at("group_start")).U8()), fields.at("group_opcode"));
    }
    if (type == "ChunkIndex") {
      expect(Op::kChunk, fields.at("chunk_start_offset"), fields.at("chunk_length"));
      for (const auto& [channel, place] : fields.at("message_index_offsets").items()) {
        Fields index = at(place);
        EXPECT_EQ(Op{index.U8()}, Op::kMessageIndex) << place;
        index.U64();
        EXPECT_EQ(std::to_string(index.U16()), channel) << place;
      }
    }
    if (type == "Footer" && NumberOf(fields.at("summary_offset_start")) != 0) {
      EXPECT_EQ(Op{at(fields.at("summary_offset_start")).U8()}, Op::kSummaryOffset);
    }
  }
}

/// Removes the fields that say which library wrote a file, how it is packed, and where its records are.
Records Unplaced(Records records) {
  for (auto& [type, fields] : records) {
    for (const char* name :
         {"library", "data_section_crc", "summary_crc", "summary_start", "summary_offset_start", "chunk_start_offset",
          "chunk_length", "compression", "compressed_size", "offset", "group_start", "group_length"})
      fields.erase(name);
    if (fields.contains("message_index_offsets"))
      for (auto& [channel, place] : fields["message_index_offsets"].items()) place = "somewhere";
  }
  return records;
}

/// Writes with McapWriter what a file is told to hold: its messages in the same chunks.
void WriteAgain(const Example& example, const std::string& path) {
  McapWriter writer(path);
  std::map<std::uint64_t, Json> schemas;
  for (const auto& [type, fields] : example.records) {
    if (type == "DataEnd") break;
    if (type == "Schema") schemas[NumberOf(fields.at("id"))] = fields;
    if (type == "Channel") {
      const Json& schema = schemas.at(NumberOf(fields.at("schema_id")));
      EXPECT_EQ(writer.AddChannel({fields.at("topic"), schema.at("name"), BytesOf(schema.at("data")),
                                   TextsOf(fields.at("metadata"))}),
                NumberOf(fields.at("id")));
    }
    if (type == "Message") {
      const std::string data = BytesOf(fields.at("data"));
      writer.Write(static_cast<std::uint16_t>(NumberOf(fields.at("channel_id"))), NumberOf(fields.at("log_time")),
                   AsBytes(data));
    }
    if (type == "Attachment") writer.Attach(fields.at("name"), fields.at("media_type"), BytesOf(fields.at("data")));
    if (type == "Metadata") writer.Metadata(fields.at("name"), TextsOf(fields.at("metadata")));
  }
  writer.Close();
}

// --- the tests --------------------------------------------------------------------------------------

TEST(McapConformance, FilesAreReadAsTheyAreTold) {
  std::vector<Example> examples = ExamplesIn(kOurs);
  std::erase_if(examples, [](const Example& example) { return example.file.starts_with(kTheirs.string()); });
  EXPECT_GE(examples.size(), 30u);
  std::set<std::string> types, features;
  for (const Example& example : examples) {
    SCOPED_TRACE(example.file);
    ExpectRead(example);
    if (example.damage().empty()) {
      ExpectReadByIndex(example);
      EXPECT_EQ(RecordsOf(example.file), example.records);
      ExpectRightPlaces(example.file, example.records);
    }
    for (const auto& [type, fields] : example.records) types.insert(type);
    features.insert(example.features.begin(), example.features.end());
  }
  EXPECT_EQ(types.size(), 13u) << "of all 15, those that are in a .json";
  EXPECT_EQ(features.size(), 10u);
}

TEST(McapConformance, FilesAreThoseThatTheirMakerMakes) {
  const ScratchFolder scratch;
  const Ran made = Shell("/usr/bin/python3 '" + (kOurs / "make.py").string() + "' '" + scratch.path().string() + "'");
  ASSERT_EQ(made.exit_code, 0) << made.output;
  for (const auto& entry : std::filesystem::directory_iterator(scratch.path())) {
    const std::filesystem::path name = entry.path().filename();
    EXPECT_EQ(ReadFile(entry.path()), ReadFile(kOurs / name)) << name;
  }
}

TEST(McapConformance, FoxglovesFilesAreReadAsTheyAreTold) {
  if (!std::filesystem::exists(kTheirs)) GTEST_SKIP() << "tests/mcap_conformance/fetch brings them";
  for (const Example& example : ExamplesIn(kTheirs)) {
    SCOPED_TRACE(example.file);
    ExpectRead(example);
    ExpectReadByIndex(example);
    EXPECT_EQ(RecordsOf(example.file), example.records);
    ExpectRightPlaces(example.file, example.records);
  }
}

TEST(McapConformance, RecordingsAreWrittenAsMadeByHand) {
  const Example by_hand(kOurs / "all_kinds.mcap");
  const ScratchFolder scratch;
  WriteAgain(by_hand, scratch.File("again.mcap"));
  const Records written = RecordsOf(scratch.File("again.mcap"));
  EXPECT_EQ(Unplaced(written), Unplaced(by_hand.records));
  ExpectRightPlaces(scratch.File("again.mcap"), written);
}

}  // namespace
}  // namespace mascot
