#include "orchestrator/verbs/fly.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "agent/laws/laws.h"
#include "agent/user_code/last_words.h"
#include "bus/leave.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/verbs/one_of.h"
#include "system/control_groups.h"
#include "system/interruptions.h"

namespace mascot {
namespace {

constexpr int kMaxThreads = 1024;

}  // namespace

void EngineArgs::AddTo(CLI::App& command, const std::string& help) {
  command.add_option("--engine", name, help)->check(OneOf({kOverDds, kInProcess}));
  command.add_option(
      "--threads", threads,
      "with --engine inprocess: how many threads fly a large team (default: one per core that the recording leaves)");
}

void EngineArgs::Refuse(const Experiment& experiment, bool gives_actions) const {
  if (!gives_actions) RefuseActions(experiment);
  if (threads && name != kInProcess) throw ConfigError({"--threads: expected --engine inprocess with it"});
  if (threads && (*threads < 1 || *threads > kMaxThreads))
    throw ConfigError({fmt::format("--threads: expected 1 to {}, got {}", kMaxThreads, *threads)});
  if (name == kOverDds) return RefuseTooManyProcesses(experiment);
  RefuseInProcess(experiment, "--engine inprocess");
}

Crew EngineArgs::MakeCrew(const Experiment& experiment, int others) const {
  if (name != kInProcess) return Crew();
  const int members = threads.value_or(UsableProcessors() - others);
  return Crew(std::clamp(members, 1, std::max(1, experiment.size() / kMinAgentsPerThread)),
              threads ? Crew::Size::kExactly : Crew::Size::kAtMost);
}

EngineRun::EngineRun(const std::string& engine, const Experiment& experiment, const RunFolder& folder,
                     const std::vector<RowSink*>& sinks, RunRequests* requests, Console& console, StopSignal& stop,
                     Crew& crew, RosSource* ros, ActionSource* actions)
    : experiment_(experiment),
      sinks_(sinks),
      requests_(requests),
      console_(console),
      stop_(stop),
      crew_(crew),
      actions_(actions) {
  if (engine == kOverDds)
    dds_.emplace(experiment, folder, sinks, requests, console, stop, ros, actions);
  else if (FliesCodeOfUsers(experiment))
    janitor_.emplace();
}

void EngineRun::LeaveIfKilled(const std::string& path, const std::string& text) {
  if (dds_) dds_->LeaveIfKilled(path, text);
  if (janitor_) janitor_->LeaveWords(path, text);
}

EngineResult EngineRun::Fly() {
  if (dds_) return dds_->Fly();
  const Interruptions interruptions(stop_, console_, [](int code) {
    const char* const reason = "a second signal has ended the process at once";
    LastWords::Leave(&reason, 1, code);
  });
  EngineResult result = RunInProcess(
      experiment_, sinks_, [&] { return interruptions.signal() == 0; }, requests_, crew_,
      [&](const std::string& words) { console_.Line(words); }, actions_);
  result.signal = interruptions.signal();
  return result;
}

void EngineRun::End(bool process_goes_on) {
  if (janitor_) janitor_->Dismiss();  // the orchestrator kills what laws have started at its own end
  if (dds_) has_left_ = dds_->End(process_goes_on);
}

void EngineRun::LeaveByForceIfNeeded(int code) const {
  if (has_left_) return;
  LeaveNow({.code = code, .process = "orchestrator", .says_so = false});  // its threads use what would be destroyed
}

}  // namespace mascot
