#include "system/line_pipe.h"

#include <gmock/gmock.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <stdexcept>
#include <thread>

namespace mascot {
namespace {

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
  const auto read_all = [&] {
    for (int k = 0; k < 200; ++k) {
      Say(std::string(40'000, 'x'));
      reader.Next();
    }
  };
  EXPECT_THAT(read_all, ThrowsMessage<std::runtime_error>("a line of a pipe is too long"));
}

TEST_F(LinePipe, WritesLinesInOrderHoweverLongTheReaderTakes) {
  constexpr int kLines = 20'000;
  LineReader reader(ends_[0]);
  {
    LineWriter writer(ends_[1]);
    for (int k = 0; k < kLines; ++k) writer.Write("line " + std::to_string(k));  // more than a pipe holds: nobody waits
    for (int k = 0; k < kLines; ++k) {
      auto line = reader.Next();
      for (pollfd more{ends_[0], POLLIN, 0}; !line; line = reader.Next()) poll(&more, 1, 1000);
      ASSERT_EQ(*line, "line " + std::to_string(k));
    }
    EXPECT_FALSE(writer.broken());
  }
  EXPECT_FALSE(reader.Next());
}

TEST_F(LinePipe, TellsHowMuchWaits) {
  LineReader reader(ends_[0]);
  LineWriter writer(ends_[1]);
  const std::string line(1'000'000, 'x');
  writer.Write(line);
  EXPECT_GT(writer.waiting(), 900'000U) << "a pipe holds 64 KiB";
  for (pollfd more{ends_[0], POLLIN, 0}; reader.Next() != line;) poll(&more, 1, 1000);
  while (writer.waiting() > 0) std::this_thread::yield();
}

TEST_F(LinePipe, EndsThoughNobodyReads) {
  LineWriter writer(ends_[1]);
  writer.Write(std::string(1'000'000, 'x'));
}

TEST_F(LinePipe, KnowsThatTheReaderHasGone) {
  std::signal(SIGPIPE, SIG_IGN);
  LineWriter writer(ends_[1]);
  CloseReader();
  writer.Write("nobody reads this");
  while (!writer.broken()) std::this_thread::yield();
  writer.Write("and not this");
  std::signal(SIGPIPE, SIG_DFL);
}

}  // namespace
}  // namespace mascot
