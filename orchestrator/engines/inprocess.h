#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/crew.h"
#include "experiment/experiment.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/team/action_source.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Throws ConfigError, with `who` in front, if the experiment cannot be flown in one process.
void RefuseInProcess(const Experiment& experiment, const std::string& who);

/// Runs the experiment in the threads of `crew` in this process, without DDS, with the same World and Agent classes as
/// the processes of the other engine. Every sink gets every row, in tick order. `go_on` is called at each tick, and
/// while a tick waits; the run ends early, in order, when it returns false. People steer the run by `requests`; null:
/// they cannot, and the run flies as fast as the machine can. A failure during a tick is reported in the result.
///
/// An agent whose law fails is lost, with all agents of its process (AgentProcesses()), as over DDS, where the process
/// ends: run.on_agent_loss says what follows. `tell` gets words for the user about it.
///
/// `actions`: what agents do whose laws take actions; null: they are given none.
EngineResult RunInProcess(
    const Experiment& experiment, const std::vector<RowSink*>& sinks, const std::function<bool()>& go_on,
    RunRequests* requests = nullptr, Crew& crew = Crew::Alone(),
    const std::function<void(const std::string& words)>& tell = [](const std::string&) {},
    ActionSource* actions = nullptr);

}  // namespace mascot
