#include "orchestrator/verbs/law_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "agent/laws/laws.h"
#include "agent/python/python.h"
#include "agent/python/shared_random.h"
#include "agent/user_code/law_output.h"
#include "base/after_last.h"
#include "base/number.h"
#include "base/utf8.h"
#include "experiment/live_experiment.h"
#include "orchestrator/team/ideal_team.h"
#include "orchestrator/verbs/verb.h"
#include "system/asked_program.h"
#include "system/children.h"
#include "system/left_file.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

/// How much of an experiment is flown: this much simulated time, and at least so many ticks, but no more once the wall
/// clock says so. What is compared is what both flights have.
constexpr double kTrial_s = 1;
constexpr std::int64_t kMinTicks = 3;
constexpr auto kLongest = 1s;

// What a flight says of itself, in lines: the first word is one of these. kEnd comes last.
constexpr std::string_view kCommands = "commands", kShared = "shared", kUnread = "unread", kFailure = "failure",
                           kEnd = "end";

/// The bits of a command before all limits, in one word.
std::string BitsOf(const Command& command) {
  std::string bits;
  for (const Eigen::Vector3d* vector : {&command.a_law_W, &command.v_law_W})
    for (const double number : *vector) bits += fmt::format("{:x}.", std::bit_cast<std::uint64_t>(number));
  return bits;
}

/// A failure in a line: which law failed, and the last line of a traceback.
std::string InOneLine(const std::string& failure) {
  const std::string first = failure.substr(0, failure.find('\n'));
  const std::string last(AfterLast(failure, '\n'));
  return PlainLine(first == last ? first : first + ": " + last);
}

/// Flies the beginning of an experiment, and says what happened.
class TrialFlight {
 public:
  explicit TrialFlight(const Experiment& experiment) : experiment_(experiment) {}

  std::string Fly() {
    try {
      IdealTeam team(experiment_);
      if (PythonHasStarted()) shared_.emplace();
      FlyWith(team);
    } catch (const std::exception& failure) {
      Say(kFailure, InOneLine(failure.what()));
    }
    if (shared_)
      for (const std::string& module : shared_->Used()) Say(kShared, module);
    for (const std::string& warning : UnreadParams(experiment_)) Say(kUnread, warning);
    Say(kEnd, "");
    return said_;
  }

 private:
  void FlyWith(IdealTeam& team) {
    const auto began = std::chrono::steady_clock::now();
    const auto ticks = std::min<std::int64_t>(
        experiment_.ticks(),
        std::max<std::int64_t>(kMinTicks, static_cast<std::int64_t>(kTrial_s * experiment_.control.rate_hz)));
    LiveExperiment live(experiment_, &LawTable(), /*checked=*/true);
    auto event = experiment_.events.begin();
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
      if (tick >= kMinTicks && std::chrono::steady_clock::now() - began > kLongest) return;
      for (; event != experiment_.events.end() && event->tick == tick; ++event) team.Adopt(live.After(*event));
      team.Step();
      std::string words;
      for (const Command& command : team.commands()) words += BitsOf(command) + " ";
      Say(kCommands, words);
    }
  }

  void Say(std::string_view word, const std::string& text) { said_ += fmt::format("{} {}\n", word, text); }

  const Experiment& experiment_;
  std::optional<SharedRandom> shared_;
  std::string said_;
};

/// What a flight has said.
struct TrialReport {
  std::vector<std::vector<std::string>> commands;  // by tick, by id - 1
  std::vector<std::string> shared, unread;
  std::string failure;
};

TrialReport ReportFrom(const AskedProgram::Answer& answer) {
  TrialReport report;
  bool is_whole = false;
  std::istringstream lines(answer.text);
  for (std::string line; std::getline(lines, line);) {
    const std::string word = line.substr(0, line.find(' '));
    const std::string text = line.substr(std::min(line.size(), word.size() + 1));
    if (word == kCommands) {
      std::istringstream words(text);
      report.commands.emplace_back();
      for (std::string bits; words >> bits;) report.commands.back().push_back(bits);
    }
    if (word == kShared) report.shared.push_back(text);
    if (word == kUnread) report.unread.push_back(text);
    if (word == kFailure) report.failure = text;
    is_whole = is_whole || word == kEnd;
  }
  if (!is_whole) report.failure = "the process that flew it " + (answer.end.empty() ? "has ended" : answer.end);
  return report;
}

/// What the laws of users in an experiment say of generators that are seeded.
std::string SeededBy(const Experiment& experiment) {
  std::string words;
  for (const LawEntry* law : LawsIn(experiment))
    if (!law->seeded.empty()) words += fmt::format("; {}", law->seeded);
  return words;
}

/// Where two flights first differ, in words; empty: nowhere.
std::string DifferenceOf(const Experiment& experiment, const TrialReport& a, const TrialReport& b) {
  for (std::size_t tick = 0; tick < std::min(a.commands.size(), b.commands.size()); ++tick) {
    const auto [mine, others] = std::ranges::mismatch(a.commands[tick], b.commands[tick]);
    if (mine == a.commands[tick].end() && others == b.commands[tick].end()) continue;
    return fmt::format("agent {} wants something else at t = {:g} s when the same start is flown again",
                       mine - a.commands[tick].begin() + 1, experiment.time_s(static_cast<std::int64_t>(tick)));
  }
  return a.failure.empty() != b.failure.empty() ? "one flight fails, and another from the same start does not" : "";
}

}  // namespace

LawTrial TryLaws(const Experiment& experiment) {
  LawTrial trial;
  const auto is_alone = [](const AgentConfig& agent) { return agent.law.params->once_per_process; };
  if (std::ranges::count_if(experiment.agents, is_alone) > 1) return trial;  // it flies all agents in one process
  if (!FliesCodeOfUsers(experiment) || experiment.user_code == UserCode::kNeverRuns) return trial;
  const std::vector<std::string> words{(ProgramFolder() / "orchestrator").string(), kTrialFlight};
  AskedProgram first(words, experiment.resolved), second(words, experiment.resolved);
  const TrialReport a = ReportFrom(first.Wait()), b = ReportFrom(second.Wait());
  if (const std::string where = DifferenceOf(experiment, a, b); !where.empty()) {
    trial.difference = fmt::format(
        "law: {}: its law draws random numbers without a seed, or asks a clock or the system, so that no run can be "
        "repeated{}",
        where, SeededBy(experiment));
    trial.warnings.push_back(trial.difference);
  }
  for (const std::string& module : a.shared)
    trial.warnings.push_back(
        fmt::format("law: it draws from {}, which all laws in a process share: what an agent draws depends on which "
                    "agents share its process{}",
                    module, SeededBy(experiment)));
  trial.warnings.insert(trial.warnings.end(), a.unread.begin(), a.unread.end());
  if (!a.failure.empty() && !b.failure.empty())
    trial.warnings.push_back("law: it fails when its beginning is flown on ideal bodies: " + a.failure);
  return trial;
}

int FlyTrial(std::string_view descriptor) {
  const std::optional<int> to = NumberFrom<int>(descriptor);
  if (!to) return kExitUsage;
  const std::string text = ReadToEnd(0);
  const SuppressedLawOutput suppressed;
  const Experiment experiment =
      LoadExperiment(Section::FromText(text, "the resolved experiment"), "trial", /*checked=*/true);
  return WriteAll(*to, TrialFlight(experiment).Fly()) ? kExitDone : kExitFailed;
}

}  // namespace mascot
