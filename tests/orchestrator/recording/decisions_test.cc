// What an agent decides in a replay, beside what it has decided in the run.
#include "orchestrator/recording/decisions.h"

#include <gmock/gmock.h>

#include "bus/wire.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Row::Bytes CommandOf(std::int64_t tick, double wanted_x, double rotor = 0) {
  Command command;
  command.a_law_W.x() = wanted_x;
  command.actuator[2] = rotor;
  mascot_msgs::msg::AgentCommand sample;
  ToWire(tick, /*rate_hz=*/100, /*agent=*/1, command, sample);
  Row::Bytes bytes;
  Serialize(sample, bytes);
  return bytes;
}

Row::Bytes MessageOf(std::int64_t tick, const std::vector<double>& numbers) {
  mascot_msgs::msg::AgentMessage sample;
  ToWire(tick, /*rate_hz=*/100, /*agent=*/1, numbers, sample);
  Row::Bytes bytes;
  Serialize(sample, bytes);
  return bytes;
}

std::vector<std::string> Names(const Decisions& decisions) {
  std::vector<std::string> names;
  for (const Decisions::Field& field : decisions.DifferingFields()) names.push_back(field.name);
  return names;
}

TEST(Decisions, ThatAreEqualAreCounted) {
  Decisions decisions;
  for (int tick = 0; tick < 3; ++tick) EXPECT_TRUE(decisions.AddCommand(tick, CommandOf(tick, 1), CommandOf(tick, 1)));
  EXPECT_EQ(decisions.ticks(), 3);
  EXPECT_EQ(decisions.differing(), 0);
  EXPECT_FALSE(decisions.first());
  EXPECT_THAT(decisions.DifferingFields(), IsEmpty());
}

TEST(Decisions, SayFromWhereOnTheyDifferAndByHowMuchFirstAndMost) {
  Decisions decisions;
  decisions.AddCommand(0, CommandOf(0, 1), CommandOf(0, 1));
  EXPECT_FALSE(decisions.AddCommand(1, CommandOf(1, 1, 10), CommandOf(1, 1.5, 11)));
  decisions.AddCommand(2, CommandOf(2, 1), CommandOf(2, -3));
  decisions.AddCommand(3, CommandOf(3, 1), CommandOf(3, 1));
  EXPECT_EQ(decisions.differing(), 2);
  ASSERT_TRUE(decisions.first());
  EXPECT_EQ(decisions.first()->tick, 1);
  EXPECT_EQ(decisions.first()->topic, "command");
  EXPECT_EQ(decisions.first()->difference.field, "acceleration_wanted.x") << "which the law decides first";
  EXPECT_EQ(decisions.first()->difference.first, "1");
  EXPECT_EQ(decisions.first()->difference.second, "1.5");
  ASSERT_THAT(Names(decisions), ElementsAre("acceleration_wanted", "actuator"));
  const Decisions::Field wanted = decisions.DifferingFields()[0], actuator = decisions.DifferingFields()[1];
  EXPECT_EQ(wanted.ticks, 2);
  EXPECT_EQ(wanted.first.difference(), 0.5);
  EXPECT_EQ(wanted.largest.tick, 2);
  EXPECT_EQ(wanted.largest.difference(), 4);
  EXPECT_EQ(actuator.ticks, 1);
  EXPECT_EQ(actuator.first.part, "[2]");
}

TEST(Decisions, DifferInTheSignOfZeroToo) {
  Decisions decisions;
  decisions.AddCommand(0, CommandOf(0, 0.0), CommandOf(0, -0.0));
  EXPECT_EQ(decisions.differing(), 1);
  EXPECT_EQ(decisions.first()->difference.second, "-0");
}

TEST(Decisions, ThatDifferInNoNumberAreNamedByFieldOrByte) {
  Decisions stamp, damaged;
  Row::Bytes other = CommandOf(0, 1);
  other[4] ^= 1;  // stamp.sec
  stamp.AddCommand(0, CommandOf(0, 1), other);
  EXPECT_EQ(stamp.first()->difference.field, "stamp.sec");
  damaged.AddCommand(0, CommandOf(0, 1), {0, 1, 0, 0});
  EXPECT_EQ(damaged.first()->difference.field, "size");
}

TEST(Decisions, OfMessagesCountOnceWithTheirCommand) {
  Decisions decisions;
  decisions.AddMessage(0, MessageOf(0, {1, 2}), MessageOf(0, {1, 5}));
  EXPECT_FALSE(decisions.AddCommand(0, CommandOf(0, 1), CommandOf(0, 1)));
  EXPECT_EQ(decisions.differing(), 1);
  EXPECT_EQ(decisions.first()->topic, "message");
  EXPECT_EQ(decisions.first()->difference.field, "data[1]");
  decisions.AddMessage(1, MessageOf(1, {1, 2}), {});
  decisions.AddCommand(1, CommandOf(1, 1), CommandOf(1, 1));
  EXPECT_EQ(decisions.differing(), 2);
}

TEST(Decisions, OfAnotherNumberOfNumbersAreNamed) {
  Decisions decisions;
  decisions.AddMessage(0, MessageOf(0, {1}), MessageOf(0, {1, 5}));
  EXPECT_EQ(decisions.first()->difference.field, "data.size()");
  Decisions none;
  none.AddMessage(0, MessageOf(0, {1}), {});
  EXPECT_EQ(none.first()->difference.second, "none");
}

}  // namespace
}  // namespace mascot
