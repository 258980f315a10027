#pragma once

#include <string>
#include <vector>

#include "base/agent_range.h"
#include "experiment/experiment.h"

namespace mascot {

/// DomainOptions::participants of the physics server and the orchestrator: it sizes their buffers, which must hold what
/// is sent and not read yet.
int ParticipantsOfServer(const Experiment& experiment);
/// The same of a process of agents.
int ParticipantsOfAgents(const Experiment& experiment, AgentRange agents);

/// Arguments of a process of the run in this domain, wherever it is. `participants`: as above.
std::vector<std::string> ArgumentsOf(const Experiment& experiment, int domain, int participants);
/// The same of a process of agents.
std::vector<std::string> ArgumentsOf(const Experiment& experiment, int domain, AgentRange agents);

/// Warnings ("key: text") about keys of [network] that make a run over DDS slower than it could be.
std::vector<std::string> DeliveryWarnings(const Experiment& experiment);
/// Throws ConfigError if the experiment has more agent processes on this host than one DDS domain can hold.
void RefuseTooManyProcesses(const Experiment& experiment);

}  // namespace mascot
