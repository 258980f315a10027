#include "system/line_pipe.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/waits.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

using test::Await;
using test::AwaitInput;
using ::testing::ThrowsMessage;

class LinePipe : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(pipe(ends_.data()), 0); }
  void TearDown() override {
    CloseReader();
    CloseWriter();
  }
  void CloseReader() { Close(ends_[0]); }
  void CloseWriter() { Close(ends_[1]); }
  void Say(const std::string& text) const { ASSERT_EQ(write(ends_[1], text.data(), text.size()), std::ssize(text)); }
  /// The next line, once it is there.
  std::optional<std::string> AwaitLine(LineReader& reader) const {
    auto line = reader.Next();
    while (!line && !reader.ended() && AwaitInput(ends_[0], "a line")) line = reader.Next();
    return line;
  }

  std::array<int, 2> ends_ = {-1, -1};

 private:
  static void Close(int& end) {
    if (end >= 0) close(end);
    end = -1;
  }
};

TEST_F(LinePipe, GivesWholeLinesAndWaitsForNone) {
  LineReader reader(ends_[0]);
  EXPECT_FALSE(reader.Next());
  Say("one\n\ntw");
  EXPECT_EQ(reader.Next(), "one");
  EXPECT_EQ(reader.Next(), "");
  EXPECT_FALSE(reader.Next());
  Say("o\nthree");
  EXPECT_EQ(reader.Next(), "two");
  EXPECT_FALSE(reader.ended());
  CloseWriter();
  EXPECT_FALSE(reader.Next()) << "the last one was cut";
  EXPECT_TRUE(reader.ended());
}

TEST_F(LinePipe, RefusesLinesWithoutEnd) {
  LineReader reader(ends_[0]);
  const std::string part(1 << 15, 'x');
  for (int k = 0; k < 4 << 20 >> 15; ++k) {  // 4 MiB may yet end
    Say(part);
    EXPECT_EQ(reader.Next(), std::nullopt);
  }
  Say("x");
  EXPECT_THAT([&] { reader.Next(); }, ThrowsMessage<std::runtime_error>("a line of a pipe is too long"));
}

TEST_F(LinePipe, TakesTheLongestLine) {
  LineReader reader(ends_[0]);
  const std::string part(1 << 15, 'x');
  for (int k = 0; k < 4 << 20 >> 15; ++k) {
    Say(part);
    EXPECT_EQ(reader.Next(), std::nullopt);
  }
  Say("\nnext\n");
  EXPECT_EQ(reader.Next(), std::string(4 << 20, 'x'));
  EXPECT_EQ(reader.Next(), "next");
}

TEST_F(LinePipe, WritesLinesInOrderHoweverLongTheReaderTakes) {
  constexpr int kLines = 20'000;
  LineReader reader(ends_[0]);
  {
    LineWriter writer(ends_[1]);
    for (int k = 0; k < kLines; ++k) writer.Write("line " + std::to_string(k));
    EXPECT_GT(writer.waiting(), 0U) << "more than a pipe holds, and the one who writes has not waited";
    for (int k = 0; k < kLines; ++k) {
      ASSERT_EQ(AwaitLine(reader), "line " + std::to_string(k));
    }
    EXPECT_FALSE(writer.broken());
  }
  EXPECT_FALSE(reader.Next());
}

TEST_F(LinePipe, TellsHowMuchWaits) {
  LineReader reader(ends_[0]);
  LineWriter writer(ends_[1]);
  const std::string line(1'000'000, 'x');
  EXPECT_EQ(writer.waiting(), 0U);
  const auto room = static_cast<std::size_t>(fcntl(ends_[1], F_GETPIPE_SZ));
  writer.Write(line);
  EXPECT_GE(writer.waiting(), line.size() + 1 - room) << "all but what a pipe holds";
  EXPECT_TRUE(Await("the pipe to be full", [&] { return writer.waiting() <= line.size() + 1 - room; }));
  EXPECT_EQ(writer.waiting(), line.size() + 1 - room) << "with the line's end";
  EXPECT_EQ(AwaitLine(reader), line);
  EXPECT_TRUE(Await("the writer to have nothing left", [&] { return writer.waiting() == 0; }));
}

TEST_F(LinePipe, EndsThoughNobodyReads) {
  const std::string line(1'000'000, 'x');
  {
    LineWriter writer(ends_[1], 10ms);
    writer.Write("one");
    writer.Write(line);
  }
  CloseWriter();
  LineReader reader(ends_[0]);
  EXPECT_EQ(AwaitLine(reader), "one");
  EXPECT_FALSE(AwaitLine(reader)) << "it was cut: a pipe does not hold it";
  EXPECT_TRUE(reader.ended());
}

TEST_F(LinePipe, WritesWhatIsLeftAtItsEndAsLongAsTheReaderTakesSome) {
  const std::string line(1'000'000, 'x');
  LineReader reader(ends_[0]);
  std::vector<std::optional<std::string>> got;
  std::jthread reading;
  {
    LineWriter writer(ends_[1]);
    for (int k = 0; k < 3; ++k) writer.Write(line);
    reading = std::jthread([&] {
      for (int k = 0; k < 3; ++k) got.push_back(AwaitLine(reader));
    });
  }
  reading.join();
  EXPECT_THAT(got, testing::Each(testing::Optional(line)));
}

TEST_F(LinePipe, KnowsThatTheReaderHasGone) {
  std::signal(SIGPIPE, SIG_IGN);
  LineWriter writer(ends_[1]);
  CloseReader();
  EXPECT_FALSE(writer.broken()) << "it has not tried yet";
  writer.Write("nobody reads this");
  EXPECT_TRUE(Await("the writer to know", [&] { return writer.broken(); }));
  const std::size_t waiting = writer.waiting();
  writer.Write("and not this");
  EXPECT_EQ(writer.waiting(), waiting) << "it is kept for nobody";
  std::signal(SIGPIPE, SIG_DFL);
}

}  // namespace
}  // namespace mascot
