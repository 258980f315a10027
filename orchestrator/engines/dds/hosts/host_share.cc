#include "orchestrator/engines/dds/hosts/host_share.h"

#include <unistd.h>

#include <climits>
#include <iostream>

#include "base/utf8.h"
#include "bus/resources.h"
#include "bus/shared_memory.h"
#include "idl/topics.h"
#include "orchestrator/engines/dds/hosts/same_bits.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"
#include "system/build.h"
#include "system/descendants.h"
#include "system/environment.h"
#include "system/failure.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

constexpr std::size_t kLongestError = 150, kLongestWord = 1000;
constexpr std::size_t kMaxWaiting = 16U << 20U;  // bytes that `up` has not read yet; what is printed beyond is lost
constexpr auto kEndGrace = 5s;                   // for processes that were told to end, over DDS

/// What this machine is called among those that were started together.
std::string NodeName() {
  char name[HOST_NAME_MAX + 1] = "";
  gethostname(name, sizeof name - 1);
  const std::string of_slurm = EnvironmentText("SLURMD_NODENAME");
  return of_slurm.empty() ? name : of_slurm;
}

/// Our address at the other end of the ssh connection that started us: its first word.
std::string SeenFrom() {
  const std::string connection = EnvironmentText("SSH_CONNECTION");
  return connection.substr(0, connection.find(' '));
}

}  // namespace

HostShare::HostShare(StopSignal& stop)
    : stop_(stop),
      node_(NodeName()),
      input_(STDIN_FILENO),
      output_(STDOUT_FILENO),
      logs_([this](const std::string& process, const std::string& line) { TakeLine(process, line); },
            [](const std::string& words) { std::cerr << words << std::endl; }),  // its logs are with `up`
      children_(logs_),
      heard_(WallClock::now()) {}

/// Passes a line on, unless too much waits already. Called in the thread that copies logs.
void HostShare::TakeLine(const std::string& process, const std::string& line) {
  if (output_.waiting() <= kMaxWaiting) {
    losing_.erase(process);
    TellLine(process, line);
  } else if (losing_.insert(process).second) {
    TellLine(process, "orchestrator: lines are missing here, because `up` did not read them in time");
  }
}

/// Tells a line in pieces: what merges the lines of several hosts may not keep a long one in one piece.
void HostShare::TellLine(const std::string& process, std::string_view line) {
  constexpr std::size_t kPiece = 100;  // JSON may need six characters for each
  do {
    const std::string_view piece = line.size() <= kPiece ? line : CutUtf8(line, kPiece);
    line.remove_prefix(piece.size());
    Tell({{"kind", "line"}, {"process", process}, {"text", piece}, {"more", !line.empty()}});
  } while (!line.empty());
}

void HostShare::Tell(HostWords words) {
  words["node"] = node_;
  output_.Write(CompactJson(words));
}

int HostShare::Run() {
  Tell(WordsOf(HostHello{.build = BuildText(),
                         .sources = SourcesText(),
                         .processor = ProcessorText(),
                         .machine = MachineText(),
                         .seen_from = SeenFrom()}));
  try {
    while (Look()) {
      const int signal = stop_.Within(20ms);
      if (signal == 0) continue;
      code_ = 128 + signal;
      break;
    }
  } catch (const std::exception& failure) {
    std::cerr << "error: " << InWords(failure) << std::endl;
    Tell({{"kind", "error"}, {"text", CutUtf8(Plain(InWords(failure)), kLongestError)}});
    code_ = 1;
  }
  Leave();
  return code_;
}

/// Returns whether to go on.
bool HostShare::Look() {
  while (const auto line = input_.Next()) {
    heard_ = WallClock::now();
    Obey(*line);
  }
  TellExits();
  const auto now = WallClock::now();
  if (now > told_ + kBetweenSigns) {
    told_ = now;
    Tell({{"kind", "alive"}});
  }
  if (ending_) return !children_.empty() && now < end_by_;
  if (input_.ended() || output_.broken()) {
    std::cerr << "the connection to `up` has ended" << std::endl;
    code_ = 1;
    return false;
  }
  if (now - heard_ > silence_) {
    std::cerr << "nothing was heard of `up` for " << silence_.count() << " s" << std::endl;
    code_ = 1;
    return false;
  }
  return true;
}

void HostShare::Obey(const std::string& line) {
  const auto words = ObjectOrNothing(line);
  if (!words) throw JsonError("expected the words of `up`, got something else");
  OutsideFields fields(*words);
  const std::string kind = fields.Text("kind", kLongestWord);
  const std::string node = fields.Has("node") ? fields.Text("node", kLongestWord) : "";
  fields.Require();
  if (!node.empty() && node != node_) return;
  if (kind == "job") Start(ReadJob(*words));
  if (kind == "kill") children_.Kill();
  if (kind == "end" && !ending_) {
    ending_ = true;
    end_by_ = WallClock::now() + kEndGrace;
  }
}

void HostShare::Start(const HostJob& job) {
  if (domain_ >= 0) throw JsonError("expected one job, got another");
  domain_ = job.domain;
  silence_ = std::chrono::duration<double>(job.silence_s);
  if (job.own_memory) {
    lock_.emplace(job.domain);
    SweepSharedMemory(job.domain);
    janitor_.emplace(*lock_);
    children_.Share(janitor_->lifeline());
    for (const int descriptor : lock_->descriptors()) children_.Share(descriptor);
  }
  const int processes = static_cast<int>(job.processes.size());
  RequireResources({.shared_memory = job.shared_memory, .processes = processes, .descriptors = 64 + 3 * processes});
  for (const HostProcess& process : job.processes) {
    std::vector<std::string> arguments = process.arguments;
    arguments.insert(arguments.end(), {"--parent", std::to_string(getpid())});
    if (!process.credentials.empty()) {
      if (!credentials_) credentials_.emplace();
      const std::string file = process.name + ".toml";
      credentials_->Write(file, process.credentials);
      arguments.insert(arguments.end(), {"--credentials", (credentials_->path() / file).string()});
    }
    const char* const program = VehicleOf(process.name) ? "vehicle" : "agent";
    const pid_t pid = children_.Spawn(process.name, ProgramFolder() / program, arguments, "/dev/null");
    Tell({{"kind", "started"}, {"process", process.name}, {"pid", pid}});
  }
}

void HostShare::TellExits() {
  for (const Exit& exit : children_.Reap()) {
    logs_.LastLines(exit.process);  // its last lines come first
    Tell({{"kind", "exit"}, {"process", exit.process}, {"status", exit.status}});
  }
}

void HostShare::Leave() {
  children_.Stop(code_ == 0 ? 2s : 500ms);
  TellExits();
  KillDescendants({janitor_ ? janitor_->process() : 0});
  SweepPrivateFolders();
  if (!lock_) return;
  SweepSharedMemory(domain_);
  if (janitor_) janitor_->Dismiss();  // none if it could not be started
}

}  // namespace mascot
