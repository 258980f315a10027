// `orchestrator host`: a host's share of a run. `up` starts it on each of the file's hosts, and tells it on its
// standard input what to do.

#include <CLI/CLI.hpp>

#include "orchestrator/engines/dds/hosts/host_share.h"
#include "orchestrator/verbs/verb.h"
#include "system/stop_signal.h"

namespace mascot {

std::function<int()> SetUpHost(CLI::App& /*command*/) {
  return [] {
    StopSignal stop;
    return HostShare(stop).Run();
  };
}

}  // namespace mascot
