// A law written by the user in C++, in its own shared library (agent/plugin.h).
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "agent/law_library.h"
#include "agent/laws.h"
#include "agent/laws/user_params.h"
#include "experiment/toml/utf8.h"

namespace mascot {
namespace {

constexpr Key kPluginParameters[] = {
    key::Text("library", "the shared library that holds the law; its path from the folder of this file").Required(),
    key::Any("params", "goes to the law's constructor, which refuses what it does not know").Default("{}").Live(),
    key::Boolean("messages", "whether it sends messages").Otherwise("whether it overrides Message()"),
    key::Integer("leader", 0, kMaxAgents, "for the law, if it asks; 0: none").Default("0"),
};

struct PluginConfig final : LawParams {
  std::string library;  ///< absolute path; "" after a mistake
  Value params;         ///< a table
  /// What the laws wanted when they were tried; an acceleration if they were not.
  Wanted wanted = Wanted::kAcceleration;
};

void ReadKeys(Section& law, PluginConfig& plugin) {
  plugin.library = law.PathOfFile("library");
  if (law.Has("params") && law.Kind("params") != "table")
    law.Fail("params", "expected a table, got a " + law.Kind("params"));
  else
    plugin.params = law.Free("params");
}

PluginSetup SetupOf(const Experiment& experiment, int id, PluginParams& params) {
  return {.id = id,
          .agents = experiment.size(),
          .leader = experiment.agent(id).law.leader,
          .rate_hz = static_cast<double>(experiment.control.rate_hz),
          .seed = experiment.run.seed,
          .params = params};
}

// --- during a run -----------------------------------------------------------------------------------

/// Text of the exception that is being handled.
std::string ExceptionText() {
  try {
    throw;
  } catch (const std::exception& error) {
    return Utf8(error.what());
  } catch (...) {
    return "it threw something that is no std::exception";
  }
}

/// The user's law; its exceptions get the agent and the time in front.
class PluginLaw final : public Law {
 public:
  PluginLaw(const PluginConfig& plugin, const PluginSetup& setup)
      : id_(setup.id), library_(plugin.library), params_(ToToml(plugin.params)), law_(library_.Make(setup)) {}

  Wanted wanted() const override {
    return Guarded([&] { return law_->wanted(); });
  }
  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    t_s_ = t_s;
    return Guarded([&] { return law_->Want_W(t_s, self, heard); });
  }
  void Adopt(const AgentConfig& agent) override {
    const Value& params = ParamsOf<PluginConfig>(agent.law).params;
    if (ToToml(params) == std::exchange(params_, ToToml(params)) || library_.set() == nullptr) return;
    Guarded([&] {
      PluginParams changed(params);
      library_.set()(*law_, changed);
    });
  }
  std::span<const double> Message() override {
    return Guarded([&] {
      const std::span<const double> message = law_->Message();
      if (message.size() > kMaxMessage)
        throw std::length_error("Message() returned " + std::to_string(message.size()) + " numbers, expected at most " +
                                std::to_string(kMaxMessage));
      return message;
    });
  }

 private:
  template <class Call>
  std::invoke_result_t<Call> Guarded(Call call) const {
    try {
      return call();
    } catch (...) {
      throw std::runtime_error("the law of agent " + std::to_string(id_) + " failed at t = " + ShortestFloat(t_s_) +
                               " s: " + ExceptionText());
    }
  }

  int id_;
  LawLibrary library_;
  std::string params_;  // as TOML
  std::unique_ptr<Law> law_;
  double t_s_ = 0;
};

// --- when an experiment is read -----------------------------------------------------------------------

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
    NoteRefusal(law, Utf8(refusal.what()));
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
  if ((experiment.checked && law.Has("messages")) || law.Wrong("")) return law.Boolean("messages", false);
  const bool can_send = TryAll(experiment, config, plugin, law);
  const bool sends = law.Boolean("messages", can_send);
  if (sends && !can_send && !law.Wrong("")) law.Fail("messages", "expected a law that overrides Message(), got none");
  return sends;
}

std::shared_ptr<const LawParams> ReadPlugin(const Experiment& experiment, const LawConfig& law, Section& section) {
  auto plugin = std::make_shared<PluginConfig>();
  ReadKeys(section, *plugin);
  plugin->sends_messages = SendsMessages(experiment, law, *plugin, section);
  plugin->files = {plugin->library};
  return plugin;
}

std::unique_ptr<Law> MakePlugin(const Experiment& experiment, int id) {
  const auto& plugin = ParamsOf<PluginConfig>(experiment.agent(id).law);
  try {
    PluginParams params(plugin.params);
    return std::make_unique<PluginLaw>(plugin, SetupOf(experiment, id, params));
  } catch (...) {
    throw std::runtime_error("cannot make the law of agent " + std::to_string(id) + ": " + ExceptionText() +
                             " (every host that flies it needs the same library at the same path)");
  }
}

Wanted WantedByPlugin(const LawConfig& law) { return ParamsOf<PluginConfig>(law).wanted; }

}  // namespace

LawEntry PluginLaw() {
  return {.name = "plugin",
          .summary = "your own law, in C++: a shared library that is loaded when the experiment is read",
          .equation = "Want_W(t_s, self, heard) -> acceleration or velocity",
          .theory = "none: check knows only built-in laws",
          .source = "docs/plugin_law.md",
          .parameters = kPluginParameters,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadPlugin,
          .make = MakePlugin,
          .wanted = WantedByPlugin};
}

}  // namespace mascot
