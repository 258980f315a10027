#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/number.h"
#include "experiment/toml/section.h"
#include "orchestrator/control/running_runs.h"
#include "orchestrator/verbs/verb.h"
#include "system/standard_streams.h"

namespace mascot {
namespace {

struct SendArgs {
  std::optional<std::string> run;
  std::optional<int> domain;
  std::vector<int> agents;
  std::vector<std::string> words;
};

[[noreturn]] void Expected(const std::string& what, const std::string& got) {
  throw ConfigError({"send: expected " + what + ", got " + (got.empty() ? "nothing" : "'" + got + "'")});
}

double NumberOf(const std::string& word, const std::string& what) {
  const auto number = NumberFrom<double>(word);
  if (!number) Expected(what, word);
  return *number;
}

/// The value that this TOML text is; nothing: it is none.
std::optional<Value> TomlValue(const std::string& text) try {
  if (text.find('\n') != std::string::npos) return std::nullopt;
  return Section::FromInlineTable("value = " + text, "").Free("value");
} catch (const ConfigError&) {
  return std::nullopt;
}

/// "law.p_gain=0.2" as key and value; as in --set, a word need not be quoted.
std::pair<std::string, Value> Assignment(const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos || equals == 0) Expected("KEY=VALUE", word);
  const std::string key = word.substr(0, equals), text = word.substr(equals + 1);
  if (auto value = TomlValue(text)) return {key, *std::move(value)};
  const bool is_word = !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0;
  if (!is_word) Expected("a TOML value after '='", word);
  return {key, Value{text}};
}

/// One thing that can be asked for: what comes after its name, how many words that is at least and at most, and the
/// request that it makes.
struct Sentence {
  std::string_view name;
  const char* words;
  std::size_t least, most;
  Request (*request)(const SendArgs& args, const std::vector<std::string>& words);
};

Request EdgesRequest(const char* key, const std::vector<std::string>& words) {
  std::string edges;
  for (const std::string& word : words) {
    const std::size_t comma = word.find(',');
    const std::string what = "an edge HEARER,HEARD, such as 2,1";
    if (comma == std::string::npos) Expected(what, word);
    edges += fmt::format("{}[{}, {}]", edges.empty() ? "" : ", ", NumberOf(word.substr(0, comma), what),
                         NumberOf(word.substr(comma + 1), what));
  }
  return {.kind = Request::Kind::kEvent, .toml = fmt::format("{} = [{}]", key, edges)};
}

Request SetRequest(const SendArgs& args, const std::vector<std::string>& words) {
  Value::Table set;
  for (const std::string& word : words)
    if (!set.insert(Assignment(word)).second) Expected("each key once", word);
  Request request{.kind = Request::Kind::kEvent, .toml = "set = " + ToToml(Value{std::move(set)})};
  if (!args.agents.empty()) request.toml += fmt::format("\nagents = [{}]", fmt::join(args.agents, ", "));
  return request;
}

Request GoToRequest(const SendArgs& /*args*/, const std::vector<std::string>& words) {
  const double agent = NumberOf(words[0], "an agent's number"), x = NumberOf(words[1], "a number as X"),
               y = NumberOf(words[2], "a number as Y"), z = NumberOf(words[3], "a number as Z");
  return {.kind = Request::Kind::kEvent,
          .toml = fmt::format("goto = {{ agent = {}, position_m = [{}, {}, {}] }}", agent, ShortestFloat(x),
                              ShortestFloat(y), ShortestFloat(z))};
}

Request FaultRequest(const SendArgs& /*args*/, const std::vector<std::string>& words) {
  Value::Table fault{{"agent", {static_cast<std::int64_t>(NumberOf(words[0], "an agent's number"))}},
                     {"kind", {words[1]}}};
  for (std::size_t i = 2; i < words.size(); ++i)
    if (!fault.insert(Assignment(words[i])).second) Expected("each key once", words[i]);
  return {.kind = Request::Kind::kEvent, .toml = "fault = " + ToToml(Value{std::move(fault)})};
}

Request RestartRequest(const SendArgs& /*args*/, const std::vector<std::string>& words) {
  return {.kind = Request::Kind::kEvent,
          .toml = fmt::format("restart = {:.0f}", NumberOf(words[0], "an agent's number"))};
}

constexpr std::size_t kAny = 1000;
constexpr Sentence kSentences[] = {
    {"pause", "", 0, 0, [](const auto&, const auto&) { return Request{.kind = Request::Kind::kPause}; }},
    {"resume", "", 0, 0, [](const auto&, const auto&) { return Request{.kind = Request::Kind::kResume}; }},
    {"step", "[TICKS]", 0, 1,
     [](const auto&, const auto& words) {
       return Request{.kind = Request::Kind::kStep,
                      .number = words.empty() ? 1 : NumberOf(words[0], "a number of ticks")};
     }},
    {"pace", "FACTOR", 1, 1,
     [](const auto&, const auto& words) {
       return Request{.kind = Request::Kind::kPace,
                      .number = NumberOf(words[0], "simulated seconds a second, or 0: as fast as it goes")};
     }},
    {"start", "", 0, 0, [](const auto&, const auto&) { return Request{.kind = Request::Kind::kStart}; }},
    {"land", "[AGENT]", 0, 1,
     [](const auto&, const auto& words) {
       return Request{.kind = Request::Kind::kLand,
                      .number = words.empty() ? 0 : NumberOf(words[0], "an agent's number")};
     }},
    {"kill", "AGENT", 1, 1,
     [](const auto&, const auto& words) {
       return Request{.kind = Request::Kind::kKill, .number = NumberOf(words[0], "an agent's number")};
     }},
    {"stop", "", 0, 0, [](const auto&, const auto&) { return Request{.kind = Request::Kind::kStop}; }},
    {"goto", "AGENT X Y Z", 4, 4, GoToRequest},
    {"set", "KEY=VALUE...", 1, kAny, SetRequest},
    {"cut", "HEARER,HEARD...", 1, kAny, [](const auto&, const auto& words) { return EdgesRequest("cut", words); }},
    {"mend", "HEARER,HEARD...", 1, kAny, [](const auto&, const auto& words) { return EdgesRequest("mend", words); }},
    {"fault", "AGENT KIND [KEY=VALUE...]", 2, kAny, FaultRequest},
    {"restart", "AGENT", 1, 1, RestartRequest},
    {"event", "TOML", 1, 1,
     [](const auto&, const auto& words) { return Request{.kind = Request::Kind::kEvent, .toml = words[0]}; }},
};

std::string Usage() {
  std::string text;
  for (const Sentence& sentence : kSentences)
    text +=
        (text.empty() ? "" : " | ") + std::string(sentence.name) + (*sentence.words != 0 ? " " : "") + sentence.words;
  return text;
}

Request RequestOf(const SendArgs& args) {
  for (const Sentence& sentence : kSentences) {
    if (args.words.empty() || sentence.name != args.words.front()) continue;
    const std::vector<std::string> words(args.words.begin() + 1, args.words.end());
    if (words.size() < sentence.least || words.size() > sentence.most)
      throw ConfigError(
          {fmt::format("send: expected {}{}{}, got {} word{} behind it", sentence.name, *sentence.words != 0 ? " " : "",
                       sentence.words, words.size(), words.size() == 1 ? "" : "s")});
    if (!args.agents.empty() && sentence.name != "set")
      throw ConfigError({"send: --agents: expected with set only, got it with " + std::string(sentence.name)});
    return sentence.request(args, words);
  }
  Expected(Usage(), args.words.empty() ? "" : args.words.front());
}

std::string ListOf(const std::vector<RunningRun>& runs) {
  std::string text;
  for (const RunningRun& run : runs)
    text += run.voice == RunningRun::Voice::kAnswers
                ? fmt::format("\n  {}{}", run.domain < 0 ? "" : fmt::format("domain {}: ", run.domain), run.folder)
                : fmt::format("\n  process {}, which {}", run.process,
                              run.voice == RunningRun::Voice::kStopped ? "is stopped" : "does not answer");
  return text;
}

/// The run that is meant. Throws ConfigError if it is not exactly one.
RunningRun RunOf(const SendArgs& args) {
  namespace fs = std::filesystem;
  std::vector<RunningRun> ours, meant;
  std::error_code ignored;
  for (RunningRun& run : RunsAlive())
    if (run.is_ours()) ours.push_back(std::move(run));
  for (const RunningRun& run : ours)
    if ((!args.run || fs::weakly_canonical(*args.run, ignored) == fs::weakly_canonical(run.folder, ignored)) &&
        (!args.domain || *args.domain == run.domain))
      meant.push_back(run);
  if (meant.size() == 1) return meant.front();
  if (ours.empty()) throw ConfigError({"send: no run of yours is alive on this machine"});
  const bool all_answer =
      std::ranges::all_of(ours, [](const RunningRun& run) { return run.voice == RunningRun::Voice::kAnswers; });
  if (meant.empty())
    throw ConfigError({(all_answer ? "send: that run is not alive; these are:"
                                   : "send: that run is not among those that answer; alive are:") +
                       ListOf(ours)});
  throw ConfigError({"send: several runs are alive; --run DIR or --domain D says which:" + ListOf(meant)});
}

/// Asks on a terminal whether motors shall stop. Without one, whoever has written the command has decided.
bool IsMeant(const Request& request) {
  if (request.kind != Request::Kind::kKill || !IsInputATerminal()) return true;
  std::cerr << fmt::format("Stop the motors of vehicle {}? In the air it falls. Type yes: ", request.number);
  std::string answer;
  std::getline(std::cin, answer);
  return answer == "yes";
}

int Send(const SendArgs& args) {
  const Request request = RequestOf(args);
  if (!IsMeant(request)) {
    std::cerr << "nothing was sent\n";
    return kExitFailed;
  }
  const Answer answer = AskRun(RunOf(args).process, request);
  if (answer.granted) {
    std::cout << answer.words << "\n";
    FlushStandardOutput();
    return kExitDone;
  }
  std::cerr << "error: " << answer.words << "\n";
  return kExitFailed;
}

}  // namespace

std::function<int()> SetUpSend(CLI::App& command) {
  auto args = std::make_shared<SendArgs>();
  command.add_option("--run", args->run, "the folder of the run; not needed if only one is alive")->type_name("DIR");
  command.add_option("--domain", args->domain, "the DDS domain of the run")->type_name("D");
  command
      .add_option("--agents", args->agents, "with set: for which agents (default: all agents that the key can concern)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("ID,...");
  command.add_option("words", args->words, Usage())->type_name("WHAT");
  command.footer("Exit code: 0 done; 1 the run refused, and says why; 2 no such run, or wrong usage.");
  return [args] { return Send(*args); };
}

}  // namespace mascot
