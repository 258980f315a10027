#include "vehicle/process/command_reader.h"

#include <algorithm>
#include <utility>

#include "bus/bundle.h"
#include "bus/wire.h"
#include "experiment/processes.h"

namespace mascot {
namespace {

AgentRange ProcessWith(const Experiment& experiment, int agent) {
  const auto processes = AgentProcesses(experiment);
  return *std::ranges::find_if(processes, [agent](AgentRange process) { return process.Holds(agent); });
}

}  // namespace

CommandReader::CommandReader(Domain& domain, const Experiment& experiment, int agent, OnCommand on_command)
    : agent_(agent), last_tick_(experiment.ticks()), on_command_(std::move(on_command)) {
  if (experiment.network.is_bundled()) {
    const AgentRange process = ProcessWith(experiment, agent);
    answers_.emplace(domain, Topic::Answers(process),
                     [this](const RawReader::Bytes& bytes, const Sender& /*sender*/) { TakeFrom(bytes); });
  } else {
    commands_.emplace(domain, Topic::Command(agent), [this](const mascot_msgs::msg::AgentCommand& command) {
      Take(command.agent(), command.tick(), FromWire(command).a_limited_W);
    });
  }
}

bool CommandReader::Matched() const { return (answers_ ? answers_->matched() : commands_->matched()) >= 1; }

void CommandReader::TakeFrom(const RawReader::Bytes& answers) {
  BundleReader sample(answers);
  const BundleReader::Section commands = sample.Next(kCommandBody);
  for (std::size_t k = 0; k < commands.count; ++k) {
    const BodyHead head = HeadOf(commands[k].data());
    if (std::cmp_not_equal(head.agent, agent_)) continue;
    Command command;
    GetCommand(commands[k].data(), command);
    Take(head.agent, head.tick, command.a_limited_W);
  }
}

void CommandReader::Take(std::uint32_t agent, std::uint64_t tick, const Eigen::Vector3d& a_W) {
  on_command_(CheckedTick(Topic::Command(agent_), agent, tick, last_tick_), a_W);
}

}  // namespace mascot
