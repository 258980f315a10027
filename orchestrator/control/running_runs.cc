#include "orchestrator/control/running_runs.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <utility>

#include "base/utf8.h"
#include "experiment/experiment.h"
#include "orchestrator/control/local_lines.h"
#include "orchestrator/control/request.h"
#include "orchestrator/control/run_socket.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"
#include "system/local_socket.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using RunsAnswer = nlohmann::ordered_json;
using Voice = RunningRun::Voice;
using LineTime = LocalLines::Time;

/// How long a run may take to accept a question; to answer what it is; to answer a request, since its laws may be slow;
/// and how long a stopped run is waited for.
constexpr auto kQuestionLimit = 1s, kWhoLimit = 5s, kRequestLimit = 60s;
constexpr auto kStoppedLimit = 250ms;
constexpr std::size_t kLongestPath = 4096, kLongestName = 1000, kLongestWords = 100'000;
constexpr double kLongest_s = 1e12, kFastest = 1e12;

/// What the kernel says of a process: its name, and what it does ('T', 't': stopped); empty, and 0, if it is not there.
struct ProcessFacts {
  std::string name;
  char state = 0;
};

ProcessFacts FactsOf(pid_t process) {
  std::string stat;
  std::getline(std::ifstream("/proc/" + std::to_string(process) + "/stat"), stat, '\0');
  const auto begin = stat.find('('), end = stat.rfind(')');  // the name may have any characters
  if (begin == std::string::npos || end == std::string::npos || end + 2 >= stat.size()) return {};
  return {stat.substr(begin + 1, end - begin - 1), stat[end + 2]};
}

bool IsStopped(pid_t process) {
  const char state = FactsOf(process).state;
  return state == 'T' || state == 't';
}

/// Whether a process is called as we are. Any process can choose its name: this tells programs apart, not users.
bool LooksLikeUs(pid_t process) { return FactsOf(process).name == FactsOf(::getpid()).name; }

/// Whether a process runs the file that we run. Only root can see it of every process.
bool RunsOurProgram(pid_t process) {
  struct stat its {
  }, ours{};
  return ::stat(("/proc/" + std::to_string(process) + "/exe").c_str(), &its) == 0 &&
         ::stat("/proc/self/exe", &ours) == 0 && its.st_dev == ours.st_dev && its.st_ino == ours.st_ino;
}

/// Whether to ask this process, and to believe it.
bool IsOurs(const ucred& peer) { return peer.uid == ::geteuid() || (::geteuid() == 0 && RunsOurProgram(peer.pid)); }

/// The names of all sockets that look like those of runs, by the process ids in them.
std::multimap<pid_t, std::string> NamesInUse() {
  std::multimap<pid_t, std::string> names;
  std::ifstream table("/proc/net/unix");
  for (std::string line; std::getline(table, line);) {
    const auto at = line.rfind('@');
    if (at == std::string::npos || line.compare(at + 1, kRunSocketPrefix.size(), kRunSocketPrefix) != 0) continue;
    pid_t process = 0;
    const char *begin = line.data() + at + 1 + kRunSocketPrefix.size(), *end = line.data() + line.size();
    const char* number_end = std::from_chars(begin, end, process).ptr;
    if (process > 0 && (number_end == end || *number_end == '-')) names.emplace(process, line.substr(at + 1));
  }
  return names;
}

/// What came of a question.
struct Said {
  Voice voice = Voice::kSilent;
  uid_t user = 0;
  std::optional<RunsAnswer> answer = {};  ///< kAnswers: the object, or nothing if it is none
};

/// Reads an answer until `until`; if the process is stopped, not that long.
Said Hear(LocalLines& run, const ucred& peer, LineTime until) {
  std::string line;
  for (;;) {
    const auto look = std::min(until, std::chrono::steady_clock::now() + kStoppedLimit);
    switch (run.Read(look, line)) {
      case LocalLines::End::kLine:
        return {Voice::kAnswers, peer.uid, ObjectOrNothing(line)};
      case LocalLines::End::kGone:
        return {Voice::kAnswers, peer.uid};
      case LocalLines::End::kLate:
        if (IsStopped(peer.pid)) return {Voice::kStopped, peer.uid};
        if (look == until) return {Voice::kSilent, peer.uid};
    }
  }
}

/// Asks the process behind one of its sockets. Nothing: that is not this process.
std::optional<Said> AskAt(const std::string& name, pid_t process, const RunsAnswer& question,
                          std::chrono::seconds limit) {
  Descriptor socket = MakeLocalSocket(SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (!ConnectTo(name, socket)) {
    if (errno != EAGAIN) return std::nullopt;
    struct stat folder {};  // so many wait already that no other is let in: the socket cannot tell the user
    if (::stat(("/proc/" + std::to_string(process)).c_str(), &folder) != 0) return std::nullopt;
    if (folder.st_uid != ::geteuid()) return Said{Voice::kOfOthers, folder.st_uid};
    return Said{IsStopped(process) ? Voice::kStopped : Voice::kSilent, folder.st_uid};
  }
  const auto peer = PeerOf(socket);
  if (!peer || peer->pid != process) return std::nullopt;
  if (!IsOurs(*peer)) return Said{Voice::kOfOthers, peer->uid};
  LocalLines run(std::move(socket));
  const auto now = std::chrono::steady_clock::now();
  if (!run.Write(CompactJson(question), now + kQuestionLimit)) return Said{Voice::kAnswers, peer->uid};
  return Hear(run, *peer, now + limit);
}

/// Asks a process, by whichever of these names is its. Nothing: none is.
template <class Names>
std::optional<Said> AskBy(const Names& names, pid_t process, const RunsAnswer& question, std::chrono::seconds limit) {
  for (auto [name, end] = names.equal_range(process); name != end; ++name)
    if (auto said = AskAt(name->second, process, question, limit)) return said;
  return std::nullopt;
}

/// Reads what a run says of itself. Returns whether it is what runs say.
bool Take(const RunsAnswer& answer, RunningRun& run) {
  OutsideFields fields(answer);
  run.name = PlainLine(fields.Text("name", kLongestName));
  run.folder = PlainLine(fields.Text("folder", kLongestPath));
  run.engine = PlainLine(fields.Text("engine", kLongestName));
  run.page = PlainLine(fields.Text("page", kLongestName));
  run.agents = static_cast<int>(fields.Integer("agents", 1, kMaxAgents));
  run.domain = static_cast<int>(fields.Integer("domain", -1, 232));
  run.tick = fields.Integer("tick", -1, INT64_MAX);
  run.t_s = fields.Number("t_s", 0, kLongest_s);
  run.duration_s = fields.Number("duration_s", 0, kLongest_s);
  run.paused = fields.Boolean("paused");
  run.pace = fields.Number("pace", 0, kFastest);
  run.vehicles = PlainLine(fields.Text("vehicles", kLongestWords));
  return fields.are_good();
}

}  // namespace

std::vector<RunningRun> RunsAlive() {
  std::vector<RunningRun> runs;
  const auto names = NamesInUse();
  for (auto name = names.begin(); name != names.end(); name = names.upper_bound(name->first)) {
    const pid_t process = name->first;
    const auto said = AskBy(names, process, {{"who", true}}, kWhoLimit);
    if (!said) continue;
    RunningRun run;
    run.process = process;
    run.user = UserName(said->user);
    run.voice = said->voice;
    const bool is_run = run.voice == Voice::kAnswers ? said->answer && Take(*said->answer, run) : LooksLikeUs(process);
    if (is_run) runs.push_back(std::move(run));
  }
  return runs;
}

std::string RunsJson(const std::vector<RunningRun>& runs) {
  RunsAnswer list = RunsAnswer::array();
  for (const RunningRun& run : runs) {
    RunsAnswer json{{"process", run.process}, {"user", run.user}};
    if (run.voice == Voice::kStopped || run.voice == Voice::kSilent)
      json["state"] = run.voice == Voice::kStopped ? "stopped" : "silent";
    if (run.voice == Voice::kAnswers)
      json.update({{"name", run.name},
                   {"folder", run.folder},
                   {"engine", run.engine},
                   {"page", run.page.empty() ? RunsAnswer() : RunsAnswer(run.page)},
                   {"domain", run.domain < 0 ? RunsAnswer() : RunsAnswer(run.domain)},
                   {"agents", run.agents},
                   {"tick", run.tick < 0 ? RunsAnswer() : RunsAnswer(run.tick)},
                   {"t_s", run.t_s},
                   {"duration_s", run.duration_s},
                   {"paused", run.paused},
                   {"pace", run.pace},
                   {"vehicles", run.vehicles.empty() ? RunsAnswer() : RunsAnswer(run.vehicles)}});
    list.push_back(std::move(json));
  }
  return list.dump(2, ' ', false, RunsAnswer::error_handler_t::replace);
}

Answer AskRun(pid_t process, const Request& request) {
  const auto said = AskBy(NamesInUse(), process, RequestJson(request), kRequestLimit);
  constexpr const char* kEnded = "the run ended before it answered";
  if (!said) return {false, kEnded};
  switch (said->voice) {
    case Voice::kOfOthers:
      return {false, fmt::format("process {} is user {}'s, who alone may ask it", process, UserName(said->user))};
    case Voice::kStopped:
      return {false, fmt::format("the run is stopped; `kill -CONT {}` lets it go on", process)};
    case Voice::kSilent:
      return {false, fmt::format("the run has not answered within {} s", kRequestLimit.count())};
    case Voice::kAnswers:
      break;
  }
  if (!said->answer) return {false, kEnded};
  OutsideFields fields(*said->answer);
  const Answer answer{fields.Boolean("granted"), Plain(fields.Text("words", kLongestWords))};
  return fields.are_good() ? answer : Answer{false, "the answer is none that a run gives"};
}

}  // namespace mascot
