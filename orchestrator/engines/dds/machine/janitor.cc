#include "orchestrator/engines/dds/machine/janitor.h"

#include <signal.h>

#include <string>
#include <utility>

#include "bus/process_main.h"
#include "bus/shared_memory.h"
#include "system/children.h"
#include "system/left_file.h"
#include "system/spawn.h"

namespace mascot {
Janitor::Janitor(const DomainLock& lock) { Start(lock.domain(), lock.descriptors()); }

Janitor::Janitor() { Start(kNoDomain, {}); }

void Janitor::Start(int domain, std::span<const int> lock) {
  Pipe pipe = MakePipe();
  // Signals for the run, and a terminal that hangs up, do not reach it.
  process_ = Spawn({.words = {ProgramFolder() / "physics_server", kSweepAfterRun, std::to_string(domain)},
                    .name = "janitor",
                    .group = Program::Group::kOwnSession,
                    .signals = Program::Signals::kBlocked,
                    .input = pipe.reads.number(),
                    .output = Program::kNowhere,
                    .errors = Program::kNowhere,
                    .shared = {lock.begin(), lock.end()}});
  lifeline_ = std::move(pipe.writes);
}

Janitor::~Janitor() { process_.Release(); }

void Janitor::LeaveWords(const std::string& path, const std::string& text) const {
  // If the janitor has ended, the file is not left, and that is all.
  static_cast<void>(WriteAll(lifeline_.number(), path + '\0' + text));
}

void Janitor::Dismiss() {
  process_.Signal(SIGKILL);
  process_.Reap();
}

}  // namespace mascot
