// A law written by the user in C++, in its own shared library (agent/laws/plugin/plugin.h).
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "agent/laws/plugin/plugin_law.h"

namespace mascot {
namespace {

constexpr Key kPluginParameters[] = {
    key::Text("library", "the shared library that holds the law; its path from the folder of this file").Required(),
    key::Any("params", "goes to the law's constructor, which refuses what it does not know").Default("{}").Live(),
    key::Boolean("messages", "whether it sends messages").Otherwise("whether it overrides Message()"),
    key::Integer("leader", 0, kMaxAgents, "for the law, if it asks; 0: none").Default("0"),
};

std::string NameOfLaw(int id) { return "the law of agent " + std::to_string(id); }

/// The user's law; its exceptions get the agent and the time in front.
class Plugin final : public Law {
 public:
  Plugin(const PluginConfig& plugin, const PluginSetup& setup, const LawLimits& limits)
      : who_(NameOfLaw(setup.id)),
        limits_(limits),
        library_(plugin.library),
        params_(ToToml(plugin.params)),
        law_(library_.Make(setup)) {}

  Wanted wanted() const override {
    return Guarded([&] { return law_->wanted(); });
  }
  void See(std::span<const Eigen::Vector3d> nearest_W) override {
    Guarded([&] { law_->See(nearest_W); });
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
    const LawAtWork at_work(who_, limits_);
    try {
      return call();
    } catch (...) {
      throw std::runtime_error(who_ + " failed at t = " + ShortestFloat(t_s_) + " s: " + ExceptionText());
    }
  }

  std::string who_;
  LawLimits limits_;
  LawLibrary library_;
  std::string params_;  // as TOML
  std::unique_ptr<Law> law_;
  double t_s_ = 0;
};

std::unique_ptr<Law> MakePlugin(const Experiment& experiment, int id) {
  const auto& plugin = ParamsOf<PluginConfig>(experiment.agent(id).law);
  const std::string who = NameOfLaw(id);
  const LawLimits limits = LimitsOfCompiledLaws(experiment);
  const LawAtWork at_work(who, limits);
  try {
    PluginParams params(plugin.params);
    return std::make_unique<Plugin>(plugin, SetupOf(experiment, id, params), limits);
  } catch (...) {
    throw std::runtime_error("cannot make " + who + ": " + ExceptionText() +
                             " (every host that flies it needs the same library at the same path)");
  }
}

/// MASCOT cannot tell whether the law draws random numbers: it is given run.seed.
bool DrawsByPlugin(const LawConfig& /*law*/) { return true; }

Wanted WantedByPlugin(const LawConfig& law) { return ParamsOf<PluginConfig>(law).wanted; }

}  // namespace

LawEntry PluginLaw() {
  return {.name = "plugin",
          .summary = "your own law, in C++: a shared library that is loaded when the experiment is read",
          .equation = "Want_W(t_s, self, heard) -> acceleration or velocity",
          .tex = R"(\texttt{Want\_W(t\_s, self, heard)} \to \text{acceleration or velocity})",
          .graph = "what the code needs",
          .theory = "none: check knows only built-in laws",
          .source = "docs/plugin_law.md",
          .parameters = kPluginParameters,
          .is_of_user = true,
          .seeded = "the setup of a law in C++ has run.seed and the agent's id, to seed generators with",
          .sees_obstacles = true,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadPlugin,
          .make = MakePlugin,
          .draws = DrawsByPlugin,
          .wanted = WantedByPlugin};
}

}  // namespace mascot
