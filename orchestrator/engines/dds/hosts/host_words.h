#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mascot {

// What `up` and `orchestrator host` tell each other: a JSON object a line, with its kind under "kind". Lines for one
// host of several that were started together have its name under "node"; those of a host always have.

using HostWords = nlohmann::ordered_json;

/// From one sign of life, {"kind": "alive"}, to the next, in both directions.
constexpr std::chrono::milliseconds kBetweenSigns{500};

/// The first message of a host: its name and its build.
struct HostHello {
  std::string build;      ///< BuildText()
  std::string sources;    ///< SourcesText(); empty: a host that does not know the word
  std::string processor;  ///< ProcessorText(); likewise
  std::string machine;    ///< equal for hosts that share memory, so that one domain lock and one sweep are for both
  std::string seen_from;  ///< our address, as that host sees it; empty: unknown
};
/// This machine, as HostHello has it.
std::string MachineText();

/// A process that a host shall start: `agent` with these arguments and --parent.
struct HostProcess {
  std::string name;
  std::vector<std::string> arguments;
  std::string credentials = {};  ///< as ToText() makes them; empty: without network.security
};
/// What a host shall do.
struct HostJob {
  int domain = 0;
  bool own_memory = true;  ///< lock the domain there, and sweep
  std::uint64_t shared_memory = 0;
  double silence_s = 10;  ///< the host ends its share if it hears nothing for this time
  std::vector<HostProcess> processes;
};

HostWords WordsOf(const HostHello& hello);
HostWords WordsOf(const HostJob& job);
/// Read a message of the other side. They throw JsonError for anything else, because the other side may be another
/// program than `orchestrator host`, or a terminal.
HostHello ReadHello(const HostWords& words);
HostJob ReadJob(const HostWords& words);

}  // namespace mascot
