// The per-tick samples as we lay them out ourselves are those of Fast CDR, byte for byte.
#include "bus/sample_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "bus/bundle.h"
#include "bus/wire.h"

namespace mascot {
namespace {

constexpr int kSamples = 1000;

/// Numbers of all kinds: of any size, 0 with both signs, infinities, NaN.
class Numbers {
 public:
  double Next() {
    constexpr double kSpecial[] = {0.0, -0.0, std::numeric_limits<double>::infinity(),
                                   std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::denorm_min()};
    if (Below(10) == 0) return kSpecial[Below(std::size(kSpecial))];
    return std::ldexp(std::uniform_real_distribution<double>(-1, 1)(engine_), static_cast<int>(Below(200)) - 100);
  }
  Eigen::Vector3d Vector() { return {Next(), Next(), Next()}; }
  std::size_t Below(std::size_t bound) { return std::uniform_int_distribution<std::size_t>(0, bound - 1)(engine_); }
  std::int64_t Tick() { return static_cast<std::int64_t>(Below(std::size_t{1} << 33)); }  // 270 years at 1 Hz

 private:
  std::mt19937_64 engine_{7};
};

using Bytes = std::vector<std::uint8_t>;

/// A sample with its encapsulation, as `put` lays out its body of this size.
template <class Put>
Bytes Sample(std::size_t body, const Put& put) {
  Bytes bytes(kEncapsulation.size() + body, 0xEE);
  std::ranges::copy(kEncapsulation, bytes.begin());
  put(bytes.data() + kEncapsulation.size());
  return bytes;
}

template <class Message>
Bytes ByFastCdr(Message& sample) {
  Bytes bytes;
  Serialize(sample, bytes);
  return bytes;
}

/// The bits of these numbers, so that NaN equals NaN and 0 is not -0.
template <class Values>
std::vector<std::uint64_t> Bits(const Values& numbers) {
  std::vector<std::uint64_t> bits;
  for (const double number : numbers) bits.push_back(std::bit_cast<std::uint64_t>(number));
  return bits;
}

bool Same(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return Bits(a) == Bits(b); }

TEST(SampleLayout, OfStatesIsThatOfFastCdr) {
  Numbers numbers;
  for (int k = 0; k < kSamples; ++k) {
    Motion motion{
        .p_WB = numbers.Vector(), .v_WB = numbers.Vector(), .w_WB_B = numbers.Vector(), .a_WB = numbers.Vector()};
    motion.q_WB.coeffs() << numbers.Next(), numbers.Next(), numbers.Next(), numbers.Next();
    const std::int64_t tick = numbers.Tick();
    const int rate = 1 + static_cast<int>(numbers.Below(1000)), id = 1 + static_cast<int>(numbers.Below(10'000)),
              events = static_cast<int>(numbers.Below(1000));
    mascot_msgs::msg::AgentState sample;
    ToWire(tick, rate, id, events, motion, sample);
    const Bytes bytes = Sample(kStateBody, [&](auto* body) { PutState(tick, rate, id, events, motion, body); });
    ASSERT_EQ(bytes, ByFastCdr(sample));
    const std::uint8_t* const body = bytes.data() + kEncapsulation.size();
    Motion back;
    GetState(body, back);
    EXPECT_TRUE(Same(back.p_WB, motion.p_WB) && Same(back.v_WB, motion.v_WB) && Same(back.w_WB_B, motion.w_WB_B) &&
                Same(back.a_WB, motion.a_WB));
    EXPECT_EQ(Bits(back.q_WB.coeffs()), Bits(motion.q_WB.coeffs()));
    const BodyHead head = HeadOf(body);
    EXPECT_EQ(std::tuple(head.tick, head.agent, head.more),
              std::tuple(static_cast<std::uint64_t>(tick), static_cast<std::uint32_t>(id),
                         static_cast<std::uint32_t>(events)));
  }
}

TEST(SampleLayout, OfCommandsIsThatOfFastCdr) {
  Numbers numbers;
  for (int k = 0; k < kSamples; ++k) {
    const Command command{.actuator = {numbers.Next(), numbers.Next(), numbers.Next(), numbers.Next()},
                          .a_law_W = numbers.Vector(),
                          .a_limited_W = numbers.Vector(),
                          .flags = static_cast<std::uint32_t>(numbers.Below(64))};
    const std::int64_t tick = numbers.Tick();
    const int id = 1 + static_cast<int>(numbers.Below(10'000));
    mascot_msgs::msg::AgentCommand sample;
    ToWire(tick, 100, id, command, sample);
    const Bytes bytes = Sample(kCommandBody, [&](auto* body) { PutCommand(tick, 100, id, command, body); });
    ASSERT_EQ(bytes, ByFastCdr(sample));
    Command back;
    back.v_law_W = back.v_limited_W = {1, 2, 3};
    GetCommand(bytes.data() + kEncapsulation.size(), back);
    EXPECT_TRUE(Same(back.a_law_W, command.a_law_W) && Same(back.a_limited_W, command.a_limited_W));
    EXPECT_EQ(Bits(back.actuator), Bits(command.actuator));
    EXPECT_EQ(back.flags, command.flags);
    EXPECT_TRUE(back.v_law_W.isZero() && back.v_limited_W.isZero());
  }
}

TEST(SampleLayout, OfMessagesAndTheClockIsThatOfFastCdr) {
  Numbers numbers;
  for (std::size_t size = 0; size <= kMaxNumbers; ++size) {
    std::vector<double> message(size);
    std::ranges::generate(message, [&] { return numbers.Next(); });
    const std::int64_t tick = numbers.Tick();
    mascot_msgs::msg::AgentMessage sample;
    ToWire(tick, 30, 5, message, sample);
    const Bytes bytes = Sample(MessageBody(size), [&](auto* body) { PutMessage(tick, 30, 5, message, body); });
    ASSERT_EQ(bytes, ByFastCdr(sample));
    std::vector<double> back{1, 2, 3};
    GetMessage(bytes.data() + kEncapsulation.size(), back);
    EXPECT_EQ(Bits(back), Bits(message));
    rosgraph_msgs::msg::Clock clock;
    ToWire(tick, 30, clock);
    EXPECT_EQ(Sample(kClockBody, [&](auto* body) { PutClock(tick, 30, body); }), ByFastCdr(clock));
  }
}

TEST(SampleLayout, OfActionsIsThatOfMessages) {
  Numbers numbers;
  for (std::size_t size = 0; size <= kMaxActionNumbers; ++size) {
    std::vector<double> action(size);
    std::ranges::generate(action, [&] { return numbers.Next(); });
    mascot_msgs::msg::AgentAction sample;
    sample.stamp().sec(2);
    sample.tick(60);
    sample.agent(5);
    sample.data().assign(action.begin(), action.end());
    EXPECT_EQ(Sample(MessageBody(size), [&](auto* body) { PutMessage(60, 30, 5, action, body); }), ByFastCdr(sample));
  }
}

// --- samples that carry samples -------------------------------------------------------------------------

/// Adds bodies of states, commands or messages of these agents, and the same samples for Fast CDR.
void AddStates(const std::vector<int>& ids, BundleWriter& ours, std::vector<mascot_msgs::msg::AgentState>& theirs) {
  for (const int id : ids) {
    const Motion motion{.p_WB = {1.0 * id, 2, 3}};
    PutState(9, 100, id, 2, motion, ours.Add(kStateBody));
    ToWire(9, 100, id, 2, motion, theirs.emplace_back());
  }
}
void AddCommands(const std::vector<int>& ids, BundleWriter& ours, std::vector<mascot_msgs::msg::AgentCommand>& theirs) {
  for (const int id : ids) {
    const Command command{.actuator = {1.0 * id, 2, 3, 4}, .flags = 5};
    PutCommand(8, 100, id, command, ours.Add(kCommandBody));
    ToWire(8, 100, id, command, theirs.emplace_back());
  }
}
void AddMessages(const std::vector<int>& ids, BundleWriter& ours, std::vector<mascot_msgs::msg::AgentMessage>& theirs) {
  for (const int id : ids) {
    const std::vector<double> numbers(static_cast<std::size_t>(id), 0.5);
    PutMessage(8, 100, id, numbers, ours.Add(MessageBody(numbers.size())));
    ToWire(8, 100, id, numbers, theirs.emplace_back());
  }
}

template <class PubSub>
Bytes CarriedByFastCdr(typename PubSub::type& sample) {
  ZeroPadded<PubSub> type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  EXPECT_TRUE(type.serialize(&sample, &payload));
  return {payload.data, payload.data + payload.length};
}

TEST(Bundle, OfEveryKindIsThatOfFastCdr) {
  for (const auto& [first, second] :
       {std::pair<std::vector<int>, std::vector<int>>{{1, 2, 3}, {0, 4, 7}}, {{5}, {}}, {{}, {3}}, {{}, {}}}) {
    BundleWriter ours;
    mascot_msgs::msg::Bundle bundle;
    ours.Begin(9);
    bundle.tick(9);
    ours.BeginSection(7);
    bundle.own(7);
    AddStates(first, ours, bundle.states());
    ours.BeginSection();
    AddMessages(second, ours, bundle.messages());
    EXPECT_EQ(ours.bytes(), CarriedByFastCdr<BundleType>(bundle));
    mascot_msgs::msg::Answers answers;
    ours.Begin(8);
    answers.tick(8);
    ours.BeginSection();
    AddCommands(first, ours, answers.commands());
    ours.BeginSection();
    AddMessages(second, ours, answers.messages());
    EXPECT_EQ(ours.bytes(), CarriedByFastCdr<AnswersType>(answers));
    mascot_msgs::msg::TickRow row;
    ours.Begin(9);
    row.tick(9);
    ours.BeginSection();
    AddStates(first, ours, row.states());
    ours.BeginSection();
    AddCommands(second, ours, row.commands());
    ours.BeginSection();
    AddMessages(first, ours, row.messages());
    EXPECT_EQ(ours.bytes(), CarriedByFastCdr<RowType>(row));
  }
}

TEST(Bundle, IsReadAsItWasWrittenAndNotBeyondItsEnd) {
  BundleWriter writer;
  std::vector<mascot_msgs::msg::AgentCommand> commands;
  std::vector<mascot_msgs::msg::AgentMessage> messages;
  writer.Begin(8);
  writer.BeginSection(6);
  AddCommands({3, 4}, writer, commands);
  writer.BeginSection();
  AddMessages({2, 1}, writer, messages);
  const auto read = [](std::span<const std::uint8_t> bytes) {
    BundleReader reader(bytes);
    EXPECT_EQ(reader.tick(), 8);
    const BundleReader::Section section = reader.Next(kCommandBody);
    EXPECT_EQ(section.number, 6);
    EXPECT_EQ(section.count, 2);
    EXPECT_EQ(HeadOf(section[1].data()).agent, 4);
    const auto bodies = reader.NextMessages();
    EXPECT_EQ(bodies.size(), 2);
    EXPECT_EQ(bodies[0].size(), MessageBody(2));
    EXPECT_EQ(HeadOf(bodies[1].data()).agent, 1);
    reader.End();
  };
  const Bytes whole = writer.bytes();
  read(whole);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(
        {
          BundleReader reader({whole.data(), size});
          reader.Next(kCommandBody);
          reader.NextMessages();
          reader.End();
        },
        std::runtime_error)
        << size;
  Bytes huge = whole;
  std::fill_n(huge.begin() + 16, 4, std::uint8_t{0xff});  // the count of commands
  EXPECT_THROW(BundleReader(huge).Next(kCommandBody), std::runtime_error);
}

}  // namespace
}  // namespace mascot
