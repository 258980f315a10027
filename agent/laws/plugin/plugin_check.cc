// What a law in a shared library is when an experiment is read: it is made once for each agent.
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

#include "agent/laws/parts/user_params.h"
#include "agent/laws/plugin/plugin_law.h"
#include "base/utf8.h"

namespace mascot {
namespace {

void ReadKeys(Section& law, PluginConfig& plugin) {
  plugin.library = law.PathOfFile("library");
  plugin.params = ReadUserParams(law);
}

/// Notes a mistake that the law found in its parameters: at the key if `words` name it ("params.gain: expected ...").
void NoteRefusal(Section& law, const std::string& words) {
  constexpr std::string_view kInside = "params.";
  const auto colon = words.find(": ");
  if (words.starts_with(kInside) && colon != words.npos && colon > kInside.size())
    law.FailInside("params", words.substr(kInside.size(), colon - kInside.size()), words.substr(colon + 2));
  else
    law.Fail("params", "expected what the law takes, got: " + words);
}

/// Makes the law of agent `id` once, to check its parameters and to learn what it wants.
void Try(const LawLibrary& library, const Experiment& experiment, int id, PluginConfig& plugin, Section& law) {
  PluginParams params(plugin.params);
  try {
    plugin.wanted = library.Make(SetupOf(experiment, id, params))->wanted();
    FailUnknownParams(law, plugin.params, std::vector<std::string_view>(params.asked().begin(), params.asked().end()));
  } catch (const std::invalid_argument& refusal) {
    NoteRefusal(law, Plain(refusal.what()));
  } catch (...) {
    law.Fail("library", "expected a law of agent " + std::to_string(id) + ", got an exception: " + ExceptionText());
  }
}

/// Ids of the agents that use `law`.
std::vector<int> AgentsOf(const Experiment& experiment, const LawConfig& law) {
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents)
    if (agent.has_own_law ? &agent.law == &law : &experiment.law == &law) ids.push_back(agent.id);
  return ids;
}

/// Opens the library and lets it make a law for each agent. Returns whether it can send messages.
bool TryAll(const Experiment& experiment, const LawConfig& config, PluginConfig& plugin, Section& law) {
  const std::string who = "the law in " + plugin.library;
  const LawAtWork at_work(who, LimitsOfCompiledLaws(experiment));
  try {
    const LawLibrary library(plugin.library);
    for (const int id : AgentsOf(experiment, config)) {
      if (law.Wrong("")) break;  // the other agents' laws would find the same mistake
      Try(library, experiment, id, plugin, law);
    }
    if (library.set() == nullptr) plugin.fixed = "expected a law with Set(PluginParams&), got none";
    return library.sends_messages();
  } catch (const std::runtime_error& error) {
    law.Fail("library", error.what());
    return false;
  }
}

/// Whether the law sends messages: as the key says, else whether it overrides Message().
bool SendsMessages(const Experiment& experiment, const LawConfig& config, PluginConfig& plugin, Section& law) {
  // A checked experiment has the key: only a process that runs the law then needs the library.
  const bool is_known = experiment.checked && law.Has("messages");
  if (is_known || experiment.user_code == UserCode::kNeverRuns || law.Wrong("")) return law.Boolean("messages", false);
  const bool can_send = TryAll(experiment, config, plugin, law);
  const bool sends = law.Boolean("messages", can_send);
  if (sends && !can_send && !law.Wrong("")) law.Fail("messages", "expected a law that overrides Message(), got none");
  return sends;
}

}  // namespace

PluginSetup SetupOf(const Experiment& experiment, int id, PluginParams& params) {
  return {.id = id,
          .agents = experiment.size(),
          .leader = experiment.agent(id).law.leader,
          .rate_hz = static_cast<double>(experiment.control.rate_hz),
          .seed = experiment.run.seed,
          .params = params};
}

/// Text of the exception that is being handled.
std::string ExceptionText() {
  try {
    throw;
  } catch (const std::exception& error) {
    return Plain(error.what());
  } catch (...) {
    return "it threw something that is no std::exception";
  }
}

std::shared_ptr<const LawParams> ReadPlugin(const Experiment& experiment, const LawConfig& law, Section& section) {
  auto plugin = std::make_shared<PluginConfig>();
  ReadKeys(section, *plugin);
  plugin->sends_messages = SendsMessages(experiment, law, *plugin, section);
  plugin->files = {plugin->library};
  return plugin;
}

}  // namespace mascot
