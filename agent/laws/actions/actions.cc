// Somebody outside decides: whoever steps the run (orchestrator/engines/flight.h) gives each agent an action at each
// tick, which is what the agent wants, and the message that it sends.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr Key kActionsParameters[] = {
    key::OneOf("output", kOutputs.names(), "what the first three numbers of an action are, in W")
        .Default("\"acceleration\""),
    key::Integer("message", 0, kMaxMessage, "how many numbers follow them, which the agent sends as its message")
        .Default("0"),
};

constexpr std::size_t kWantedNumbers = 3;

struct ActionsParams final : LawParams {
  Wanted wanted = Wanted::kAcceleration;
};

class Actions final : public Law {
 public:
  explicit Actions(const AgentConfig& agent)
      : wanted_(ParamsOf<ActionsParams>(agent.law).wanted), action_(agent.law.params->action) {}

  Wanted wanted() const override { return wanted_; }
  void Act(std::span<const double> action) override {
    if (action.size() != action_.size())
      throw std::runtime_error(fmt::format("expected an action of {} numbers, got {}", action_.size(), action.size()));
    std::ranges::copy(action, action_.begin());
  }
  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& /*self*/, std::span<const Heard> /*heard*/) override {
    return {action_[0], action_[1], action_[2]};
  }
  std::span<const double> Message() override { return std::span<const double>(action_).subspan(kWantedNumbers); }

 private:
  const Wanted wanted_;
  std::vector<double> action_;  // the newest
};

std::shared_ptr<const LawParams> ReadActions(const Experiment& /*experiment*/, const LawConfig& /*law*/,
                                             Section& section) {
  auto params = std::make_shared<ActionsParams>();
  params->wanted = kOutputs.Value(section.OneOf("output"));
  const auto message = static_cast<std::size_t>(section.Integer("message"));
  params->sends_messages = message > 0;
  params->action = kWantedNumbers + message;
  params->fixed = "an action has as many numbers as at the start of the law";
  return params;
}

std::unique_ptr<Law> MakeActions(const Experiment& experiment, int id) {
  return std::make_unique<Actions>(experiment.agent(id));
}

}  // namespace

LawEntry ActionsLaw() {
  return {
      .name = "actions",
      .summary = "a program that steps the run decides, tick by tick",
      .equation = "(a_i, m_i) = what is given from outside at each tick",
      .tex = R"((a_i, m_i) = \text{what is given from outside at each tick})",
      .graph = "any",
      .details =
          "The actions are recorded (/agent_<id>/action), so that `orchestrator verify` flies the run again without "
          "the program that gave them. `orchestrator up` refuses this law: it gives no actions.\nAn action holds "
          "until the next one; before the first it is 0.",
      .theory = "none: what is given from outside is not known",
      .source = "docs/laws.md",
      .parameters = kActionsParameters,
      .is_driven = true,
      .drawing = {},
      .read = ReadActions,
      .make = MakeActions,
      .wanted = [](const LawConfig& law) { return ParamsOf<ActionsParams>(law).wanted; }};
}

}  // namespace mascot
