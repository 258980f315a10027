#pragma once

#include <functional>
#include <string_view>

namespace CLI {
class App;
}

namespace mascot {

/// Exit codes. A verb that a signal interrupts returns 128 + signal.
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;  ///< a run failed, a request was refused, or a recording is not what it should be
inline constexpr int kExitUsage = 2;   ///< wrong arguments or experiment; thrown as ConfigError
inline constexpr int kExitIncomplete = 3;  ///< done for what is left of a recording that was cut or damaged

/// Calls `action`, and returns its exit code. What it throws becomes lines on stderr and kExitUsage or kExitFailed.
int ExitCodeOf(const std::function<int()>& action);

/// A row of the verb table. `set_up` declares the options of the verb on `command`, and returns a function to call
/// after parsing, which returns the exit code.
struct VerbEntry {
  std::string_view name;
  std::string_view summary;
  std::function<int()> (*set_up)(CLI::App& command);
};

std::function<int()> SetUpUp(CLI::App& command);         // up.cc
std::function<int()> SetUpCheck(CLI::App& command);      // check.cc
std::function<int()> SetUpGraph(CLI::App& command);      // graph.cc
std::function<int()> SetUpLaws(CLI::App& command);       // tables.cc
std::function<int()> SetUpModels(CLI::App& command);     // tables.cc
std::function<int()> SetUpAirframes(CLI::App& command);  // airframes.cc
std::function<int()> SetUpKeys(CLI::App& command);       // keys.cc
std::function<int()> SetUpNew(CLI::App& command);        // keys.cc
std::function<int()> SetUpInfo(CLI::App& command);       // info.cc
std::function<int()> SetUpRuns(CLI::App& command);       // runs.cc
std::function<int()> SetUpPlot(CLI::App& command);       // plot.cc
std::function<int()> SetUpExport(CLI::App& command);     // export.cc
std::function<int()> SetUpRecover(CLI::App& command);    // recover.cc
std::function<int()> SetUpVerify(CLI::App& command);     // verify.cc
std::function<int()> SetUpReplay(CLI::App& command);     // replay.cc
std::function<int()> SetUpPs(CLI::App& command);         // ps.cc
std::function<int()> SetUpSend(CLI::App& command);       // send.cc
std::function<int()> SetUpCompare(CLI::App& command);    // compare.cc
std::function<int()> SetUpSweep(CLI::App& command);      // sweep.cc
std::function<int()> SetUpTune(CLI::App& command);       // tune.cc
std::function<int()> SetUpView(CLI::App& command);       // view.cc
std::function<int()> SetUpServe(CLI::App& command);      // serve.cc
std::function<int()> SetUpFmu(CLI::App& command);        // fmu.cc
std::function<int()> SetUpHost(CLI::App& command);       // host.cc

}  // namespace mascot
