#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace mascot {

/// `orchestrator sweep merge`, a verb of the verb sweep: see VerbEntry.
std::function<int()> SetUpSweepMerge(CLI::App& command);

}  // namespace mascot
