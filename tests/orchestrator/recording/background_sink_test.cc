// Rows that are passed on in another thread arrive as they are, all of them, in their order.
#include "orchestrator/recording/background_sink.h"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>

#include "tests/support/load.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using testing::ThrowsMessage;

constexpr int kRows = 5000;

Experiment ThreeThatSend() {
  return Load(
      "[run]\nduration_s = 1.0\n[agents]\ncount = 3\n[graph]\ntopology = 'ring'\n[law]\nname = 'event_triggered'\n");
}

/// A row that is made of its tick.
class NumberedRow final : public FlownRow {
 public:
  NumberedRow(std::int64_t tick, bool is_received, RowEncoder& encoder)
      : tick_(tick), is_received_(is_received), decoded_(3) {
    for (std::size_t i = 0; i < 3; ++i) {
      decoded_.motions[i].p_WB.setConstant(static_cast<double>(tick) + static_cast<double>(i));
      decoded_.commands[i].flags = static_cast<std::uint32_t>(tick);
      decoded_.messages[i].assign(static_cast<std::size_t>(tick % 5), static_cast<double>(tick));
    }
    if (tick % 7 == 0) decoded_.events.push_back({1, {.tick = tick}});
    bytes_ = encoder.Encode(tick, decoded_);
    if (is_received) bytes_.commands[1].clear();  // it was late
  }
  std::int64_t tick() const override { return tick_; }
  const DecodedRow& decoded() const override { return decoded_; }
  const Row& bytes() const override { return bytes_; }
  const Row* received() const override { return is_received_ ? &bytes_ : nullptr; }

 private:
  std::int64_t tick_;
  bool is_received_;
  DecodedRow decoded_;
  Row bytes_{3};
};

bool Same(const Row& a, const Row& b) {
  return a.tick == b.tick && a.clock == b.clock && a.states == b.states && a.commands == b.commands &&
         a.messages == b.messages && a.events == b.events;
}

/// Compares the rows that it gets with those that it must get; fails at a tick, or holds the thread up, if asked.
class Checks final : public RowSink {
 public:
  explicit Checks(const Experiment& experiment) : encoder_(experiment) {}
  void Add(const FlownRow& row) override {
    test::Until([&] { return !holds; });
    if (row.tick() == fails_at) throw std::runtime_error("the disk is full");
    const NumberedRow made(row.tick(), row.received() != nullptr, encoder_);
    if (row.tick() != rows || !Same(row.bytes(), made.bytes()) ||
        row.decoded().motions[2].p_WB != made.decoded().motions[2].p_WB ||
        row.decoded().messages != made.decoded().messages)
      ++wrong;
    ++rows;
  }

  std::int64_t fails_at = -1;
  std::atomic<bool> holds = false;
  std::atomic<std::int64_t> rows = 0, wrong = 0;

 private:
  RowEncoder encoder_;
};

TEST(BackgroundSink, PassesOnAllRowsInTheirOrder) {
  const Experiment experiment = ThreeThatSend();
  RowEncoder encoder(experiment);
  for (const bool is_received : {false, true}) {
    Checks checks(experiment);
    BackgroundSink sink(experiment, checks);
    for (std::int64_t tick = 0; tick < kRows; ++tick) sink.Add(NumberedRow(tick, is_received, encoder));
    sink.Finish();
    EXPECT_EQ(checks.rows, kRows);
    EXPECT_EQ(checks.wrong, 0);
  }
}

TEST(BackgroundSink, LetsTheRunWaitForASinkThatIsSlower) {
  const Experiment experiment = ThreeThatSend();
  RowEncoder encoder(experiment);
  Checks checks(experiment);
  checks.holds = true;
  BackgroundSink sink(experiment, checks);
  std::atomic<std::int64_t> added = 0;
  std::thread run([&] {
    for (std::int64_t tick = 0; tick < kRows; ++tick, ++added) sink.Add(NumberedRow(tick, false, encoder));
  });
  // The rows that are kept, and no more: the count stands still for as long as the sink is held up.
  ASSERT_TRUE(test::Until([&] { return added == 512; }));
  checks.holds = false;
  run.join();
  sink.Finish();
  EXPECT_EQ(checks.rows, kRows);
}

TEST(BackgroundSink, SaysWhatTheSinkHasThrown) {
  const Experiment experiment = ThreeThatSend();
  RowEncoder encoder(experiment);
  Checks checks(experiment);
  checks.fails_at = 100;
  BackgroundSink sink(experiment, checks);
  const auto add_all = [&] {
    for (std::int64_t tick = 0; tick < kRows; ++tick) sink.Add(NumberedRow(tick, false, encoder));
  };
  EXPECT_THAT(add_all, ThrowsMessage<std::runtime_error>("the disk is full"));
  EXPECT_THAT([&] { sink.Finish(); }, ThrowsMessage<std::runtime_error>("the disk is full"));
  EXPECT_EQ(checks.rows, 100) << "none after the one that failed";
}

TEST(BackgroundSink, PassesOnARowAfterWhichNoneComes) {
  const Experiment experiment = ThreeThatSend();
  RowEncoder encoder(experiment);
  Checks checks(experiment);
  BackgroundSink sink(experiment, checks);
  sink.Add(NumberedRow(0, false, encoder));
  EXPECT_TRUE(test::Until([&] { return checks.rows == 1; }));
  EXPECT_EQ(checks.wrong, 0);
}

TEST(BackgroundSink, EndsWithoutPassingOnWhatIsLeft) {
  const Experiment experiment = ThreeThatSend();
  RowEncoder encoder(experiment);
  Checks checks(experiment);
  checks.holds = true;
  {
    BackgroundSink sink(experiment, checks);
    for (std::int64_t tick = 0; tick < 200; ++tick) sink.Add(NumberedRow(tick, false, encoder));
    checks.fails_at = 0;
    checks.holds = false;
  }
  EXPECT_EQ(checks.rows, 0);
}

}  // namespace
}  // namespace mascot
