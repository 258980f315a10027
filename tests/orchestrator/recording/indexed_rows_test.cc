// Rows of a recording in any order: the same as in the run, whatever was read before.
#include "orchestrator/recording/indexed_rows.h"

#include <gmock/gmock.h>

#include "orchestrator/formats/mcap/writer.h"
#include "tests/orchestrator/recording/flown.h"

namespace mascot {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kTwo = R"(
[run]
duration_s = 3.0
[agents]
count = 2
position_m = [[0, 0, 1], [4, 0, 1]]
model = "double_integrator"
[law]
name = "consensus"
[[events]]
at_s = 1.5
set = { "law.p_gain" = 0.3 }
[[events]]
at_s = 2.25
cut = [[1, 2]]
)";

TEST(IndexedRows, AreThoseOfTheRunInAnyOrder) {
  const ScratchFolder folder;
  const Flown run(folder, kTwo);
  IndexedRows rows(run.path());
  EXPECT_EQ(rows.ticks().rows(), 301);
  EXPECT_EQ(rows.loss(), "");
  EXPECT_EQ(rows.config(), run.experiment().resolved);
  DecodedRow row(2);
  for (const std::int64_t tick : {300, 0, 299, 150, 151, 149, 1, 100, 101, 99, 225}) {
    rows.Read(tick, row);
    EXPECT_TRUE(IsSame(row, run.at(tick).row)) << "tick " << tick;
  }
}

TEST(IndexedRows, NameAllEventsWithTheirTicks) {
  const ScratchFolder folder;
  const Flown run(folder, kTwo);
  const auto events = IndexedRows(run.path()).Events();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].tick, 150);
  EXPECT_EQ(events[0].number, 1);
  EXPECT_THAT(events[0].toml, HasSubstr("law.p_gain"));
  EXPECT_EQ(events[1].tick, 225);
  EXPECT_THAT(events[1].toml, HasSubstr("cut"));
}

TEST(IndexedRows, OfACutRecordingGoUpToTheCut) {
  const ScratchFolder folder;
  const Flown run(folder, kTwo);
  const std::string whole = ReadFile(run.path()), cut = folder.File("cut.mcap");
  WriteFile(cut, whole.substr(0, whole.size() * 2 / 3));
  IndexedRows rows(cut);
  EXPECT_GT(rows.ticks().rows(), 100);
  EXPECT_LT(rows.ticks().rows(), 301);
  EXPECT_THAT(rows.loss(), HasSubstr("the file ends"));
  DecodedRow row(2);
  for (const std::int64_t tick : {rows.ticks().last(), std::int64_t{0}}) {
    rows.Read(tick, row);
    EXPECT_TRUE(IsSame(row, run.at(tick).row)) << "tick " << tick;
  }
  for (const auto& event : rows.Events()) EXPECT_LE(event.tick, rows.ticks().last());
}

TEST(IndexedRows, OfALongRecordingTakeLittleOfTheFile) {
  const ScratchFolder folder;
  std::string toml = kTwo;
  toml.replace(toml.find("3.0"), 3, "100.0");
  const Flown run(folder, toml);
  IndexedRows rows(run.path());
  DecodedRow row(2);
  rows.Read(9000, row);
  EXPECT_TRUE(IsSame(row, run.at(9000).row));
  EXPECT_EQ(rows.Events().size(), 2u);
  EXPECT_LT(rows.bytes_read(), std::filesystem::file_size(run.path()) / 8);  // 3 seconds of 100, and the index
}

/// Copies a recording without the samples that `keeps` refuses, as a run in real time, where commands may be late.
std::string InRealTime(const ScratchFolder& folder, const std::string& path,
                       const std::function<bool(const std::string& topic, std::uint64_t tick)>& keeps) {
  const std::string copy = folder.File("realtime.mcap");
  const McapContents contents = ReadMcap(path);
  std::string config = contents.attachments.at("config.toml");
  config.replace(config.find("\"lockstep\""), 10, "\"realtime\"");
  McapWriter writer(copy);
  writer.Attach("config.toml", "application/toml", config);
  std::map<std::uint16_t, std::uint16_t> ids;
  for (const auto& [id, channel] : contents.channels)
    ids[id] = writer.AddChannel({channel.topic, channel.schema_name, channel.schema_text, channel.metadata});
  ReadMcap(path, [&](const McapContents::Message& message) {
    if (keeps(contents.channels.at(message.channel).topic, message.log_time / 10'000'000))
      writer.Write(ids.at(message.channel), message.log_time, message.data);
  });
  writer.Close();
  return copy;
}

TEST(IndexedRows, InRealTimeALateCommandIsTheOneBefore) {
  const ScratchFolder folder;
  const Flown run(folder, kTwo);
  IndexedRows rows(InRealTime(folder, run.path(), [](const std::string& topic, std::uint64_t tick) {
    return topic != "/agent_2/command" || tick == 0 || tick > 101;
  }));
  DecodedRow row(2);
  for (const std::int64_t tick : {50, 1, 100}) {
    rows.Read(tick, row);
    EXPECT_EQ(row.commands[0].a_limited_W, run.at(tick).row.commands[0].a_limited_W);
    EXPECT_EQ(row.commands[1].a_limited_W, run.at(0).row.commands[1].a_limited_W);
  }
  rows.Read(101, row);  // more than a second late
  EXPECT_EQ(row.commands[1].a_limited_W, Eigen::Vector3d::Zero());
}

TEST(IndexedRows, SayWhereTheFileIsDamagedAndGiveTheRest) {
  const ScratchFolder folder;
  const Flown run(folder, kTwo);
  std::string bytes = ReadFile(run.path());
  const std::uint64_t offset = McapIndex(run.path()).chunks().at(1).offset;
  bytes[offset + 100] = static_cast<char>(bytes[offset + 100] ^ 1);
  WriteFile(run.path(), bytes);
  DecodedRow row(2);
  IndexedRows rows(run.path());
  EXPECT_THAT([&] { rows.Read(150, row); },
              ThrowsMessage<std::runtime_error>(HasSubstr("(record at byte " + std::to_string(offset) + ")")));
  rows.Read(50, row);
  EXPECT_TRUE(IsSame(row, run.at(50).row));
}

TEST(IndexedRows, SayWhatIsMissing) {
  const ScratchFolder folder;
  std::string toml = kTwo;
  toml += "[record]\ntopics = ['*/command']\n";
  const Flown run(folder, toml);
  EXPECT_THAT([&] { IndexedRows rows(run.path()); },
              ThrowsMessage<std::runtime_error>(run.path() + ": holds no /agent_1/state: record.topics left it out"));
  WriteFile(folder.File("x.mcap"), "nothing");
  EXPECT_THROW(IndexedRows(folder.File("x.mcap")), ConfigError);
}

}  // namespace
}  // namespace mascot
