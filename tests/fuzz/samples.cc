// Fuzzer: any bytes as a sample of each type of the wire. They are refused, or mean the same after they were sent
// again. The first byte chooses the type.
#include <span>
#include <stdexcept>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/process/bundle_inbox.h"
#include "bus/cdr.h"
#include "bus/sample_layout.h"
#include "bus/wire.h"
#include "idl/topics.h"
#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

using SampleBytes = std::span<const std::uint8_t>;

void Use(const mascot_msgs::msg::AgentState& state) { FromWire(state); }
void Use(const mascot_msgs::msg::AgentCommand& command) { FromWire(command); }
void Use(const mascot_msgs::msg::AgentMessage& message) { Require(message.data().size() <= 64, "too long a message"); }
void Use(const mascot_msgs::msg::AgentAction& action) { Require(action.data().size() <= 67, "too long an action"); }
void Use(const rosgraph_msgs::msg::Clock& /*clock*/) {}

/// A sample of a type that recordings have, by our own functions: once decoded, encoding and decoding it again changes
/// nothing.
template <class Sample>
void FuzzRecorded(SampleBytes bytes) {
  Sample sample;
  try {
    Deserialize(bytes, sample);
  } catch (const std::runtime_error&) {
    return;
  }
  Use(sample);
  std::vector<std::uint8_t> once, twice;
  Serialize(sample, once);
  Deserialize(once, sample);
  Serialize(sample, twice);
  Require(once == twice, "a sample changes when it is sent again");
}

void FuzzStatus(SampleBytes bytes) {
  mascot_msgs::msg::Status status;
  if (!Decode<StatusType>(bytes, status)) return;
  const std::string process = status.process().to_string();
  if (const auto agents = AgentsOf(process))
    Require(agents->first >= 1 && agents->first <= agents->last && ProcessName(*agents) == process, process);
  if (const auto topic = Topic::Parse(process)) Require(Topic::Parse(topic->Name()) == topic, process);
}

/// A sample of a type that is on the wire alone: decoding it must not crash.
template <class PubSub>
void FuzzUnrecorded(SampleBytes bytes) {
  typename PubSub::type sample;
  Decode<PubSub>(bytes, sample);
}

/// A sample that carries samples: it is refused, or is what an agent's process may take.
void FuzzBundle(SampleBytes bytes) {
  static const Experiment experiment = [] {
    const char* const talkers =
        "[run]\nduration_s = 100000.0\n[agents]\ncount = 3\n[graph]\ntopology = 'ring'\n[law]\nname = "
        "'event_triggered'\n";
    return LoadExperiment(Section::FromText(talkers, "fuzz.toml"), "fuzz");
  }();
  BundleInbox inbox(experiment, {1, 2});
  try {
    if (inbox.OnBundle(bytes) != BundleInbox::News::kComplete) return;
  } catch (const std::runtime_error&) {
    return;
  }
  for (const int id : {1, 2})
    for (const Sample& sample : inbox.SamplesOf(id))
      Require(sample.motion != nullptr && sample.message.size() <= kMaxNumbers && sample.message_age > 0,
              "a false sample");
}

constexpr void (*kFuzz[])(SampleBytes bytes) = {
    FuzzRecorded<mascot_msgs::msg::AgentState>,
    FuzzRecorded<mascot_msgs::msg::AgentCommand>,
    FuzzRecorded<mascot_msgs::msg::AgentMessage>,
    FuzzRecorded<rosgraph_msgs::msg::Clock>,
    FuzzStatus,
    FuzzBundle,
    FuzzUnrecorded<RequestType>,
    FuzzUnrecorded<ExperimentType>,
    FuzzRecorded<mascot_msgs::msg::AgentAction>,
};

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) mascot::kFuzz[data[0] % std::size(mascot::kFuzz)]({data + 1, size - 1});
  return 0;
}
