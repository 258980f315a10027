// An FMU for co-simulation (FMI 2 or 3) decides: its inputs are what the agent perceives (agent/laws/fmu/signals.h),
// its output u what the agent wants, and its output message what the agent sends.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "agent/fmi/error.h"
#include "agent/laws/fmu/fmu_law.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/user_params.h"
#include "agent/user_code/law_at_work.h"
#include "agent/user_code/law_output.h"
#include "base/base64.h"
#include "base/utf8.h"
#include "experiment/processes.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxPacked = std::size_t{8} << 20;  // bytes of an FMU that travels with the experiment

constexpr Key kFmuTables[] = {
    key::Any("inputs", "a table: an input of the FMU = the signal that it gets, such as x_own = \"p[1]\"")
        .Default("{}"),
    key::Any("outputs", "a table: \"u[1]\", u or message = the output of the FMU that gives it").Default("{}"),
};
constexpr Key kFmuParameters[] = {
    key::Text("file", "the FMU, for co-simulation by FMI 2 or 3; its path from the folder of this file"),
    key::Text("fmu_base64", "what this platform needs of the FMU, in base64").Otherwise("what the file holds"),
    key::Text("fmu_file", "what the FMU goes by in messages").Otherwise("the name of the file"),
    key::OneOf("output", kOutputs.names(), "what its output u is, in W").Default("\"acceleration\""),
    key::Any("params",
             "values of the FMU's parameters by name, also lists, and of inputs that are to stay as they are; an event "
             "can change those that are tunable")
        .Default("{}")
        .Live(),
    key::Table("fmu", kFmuTables, "which inputs and outputs are which signals, besides those that have their names")
        .Otherwise("by name alone"),
};

/// Takes the words of an FMU to where laws print.
FmuLog LogOf(const std::string& who) {
  const auto output = std::make_shared<LawOutput>(LawOutput::Kind::kUsual);
  return [who, output](const std::string& line) { output->Add(who + ": " + line + "\n"); };
}

// --- the law -------------------------------------------------------------------------------------------------

class FmuLawOfAgent final : public Law {
 public:
  FmuLawOfAgent(const Experiment& experiment, int id)
      : id_(id),
        who_("the law of agent " + std::to_string(id)),
        limits_(LimitsOfCompiledLaws(experiment)),
        rate_hz_(experiment.control.rate_hz),
        params_(&ParamsOf<FmuLawParams>(experiment.agent(id).law)),
        inputs_(params_->inputs),
        outputs_(params_->outputs) {
    for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id)) ids_.push_back(neighbour.id);
    places_.resize(ids_.size());
    message_.resize(params_->message.size());
    const LawAtWork at_work(who_, limits_);
    try {
      instance_ = params_->fmu->Instantiate("agent " + std::to_string(id), LogOf(who_));
      instance_->Begin(SettingsOf(params_->parameters));
    } catch (const FmuError& error) {
      throw std::runtime_error("cannot make " + who_ + ": " + params_->name + ": " + error.what());
    }
  }
  ~FmuLawOfAgent() override {
    const LawAtWork at_work(who_, limits_);
    instance_.reset();
  }
  FmuLawOfAgent(const FmuLawOfAgent&) = delete;
  FmuLawOfAgent& operator=(const FmuLawOfAgent&) = delete;

  Wanted wanted() const override { return params_->wanted; }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    const LawAtWork at_work(who_, limits_);
    try {
      Perceive(t_s, self, heard);
      for (FmuInputs& inputs : inputs_) instance_->Set(inputs.numbers);
      if (steps_ == 0) instance_->Start();
      instance_->Step(static_cast<double>(steps_) / rate_hz_, 1.0 / rate_hz_);
      ++steps_;
      for (FmuNumbers& outputs : outputs_) instance_->Get(outputs);
    } catch (const FmuError& error) {
      throw std::runtime_error(who_ + " failed at t = " + ShortestFloat(t_s) + " s: " + params_->name + ": " +
                               error.what());
    }
    for (std::size_t k = 0; k < message_.size(); ++k) message_[k] = ValueOf(params_->message[k]);
    Eigen::Vector3d u_W = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      if (const auto& output = params_->u[k]) u_W[static_cast<Eigen::Index>(k)] = ValueOf(*output);
    return u_W;
  }

  std::span<const double> Message() override { return message_; }

  void Adopt(const AgentConfig& agent) override {
    const FmuLawParams& next = ParamsOf<FmuLawParams>(agent.law);
    std::vector<FmuParameter> changed;
    std::ranges::copy_if(next.parameters, std::back_inserter(changed), [&](const FmuParameter& parameter) {
      return std::ranges::find(params_->parameters, parameter) == params_->parameters.end();
    });
    params_ = &next;
    const LawAtWork at_work(who_, limits_);
    try {
      FmuSettings settings = SettingsOf(changed);
      for (FmuNumbers& numbers : settings.numbers) instance_->Set(numbers);
      for (const FmuTexts& texts : settings.texts) instance_->Set(texts);
    } catch (const FmuError& error) {
      throw std::runtime_error(who_ + " does not take its new parameters: " + params_->name + ": " + error.what());
    }
  }

 private:
  void Perceive(double t_s, const Motion& self, std::span<const Heard> heard) {
    auto one = heard.begin();
    for (std::size_t k = 0; k < ids_.size(); ++k) {
      const bool was_heard = one != heard.end() && one->id == ids_[k];
      places_[k] = was_heard ? &*one : nullptr;
      if (was_heard) ++one;
    }
    const Perception now{t_s, id_, &self, places_};
    for (FmuInputs& inputs : inputs_)
      for (std::size_t k = 0; k < inputs.signals.size(); ++k) inputs.numbers.values()[k] = inputs.signals[k].Value(now);
  }
  double ValueOf(const FmuOutput& output) const { return std::as_const(outputs_[output.group]).values()[output.value]; }

  const int id_;
  const std::string who_;
  const LawLimits limits_;
  const int rate_hz_;
  const FmuLawParams* params_;  // the experiment owns them
  std::vector<FmuInputs> inputs_;
  std::vector<FmuNumbers> outputs_;
  std::vector<int> ids_;  // of the agents in the places
  std::vector<const Heard*> places_;
  std::vector<double> message_;
  std::unique_ptr<FmuInstance> instance_;
  std::int64_t steps_ = 0;
};

// --- reading -------------------------------------------------------------------------------------------------

/// Reads the contents of the file, packed, and what messages call it. Notes a mistake if there are none.
std::optional<Section::FileContents> ReadPacked(Section& law) {
  law.Supersede("file", {"fmu_base64", "fmu_file"});
  law.Supersede("fmu_base64", {"file", "fmu_file"});
  if (!HasOneOf(law, "file", "fmu_base64", "file")) return std::nullopt;
  Section::FileContents contents;
  const std::string key = law.Has("file") ? "file" : "fmu_base64";
  if (key == "file") {
    contents = law.ContentsOfFile("file", Fmu::kMaxFile);
    try {
      if (!law.Wrong("file")) contents.bytes = Fmu::Pack(std::move(contents.bytes));
    } catch (const FmuError& error) {
      law.Fail("file", fmt::format("expected an FMU that can be flown, got {}: {}", contents.name, error.what()));
    }
  } else {
    const auto bytes = FromBase64(law.Text("fmu_base64"));
    if (!bytes) law.Fail("fmu_base64", "expected base64, got other text");
    contents = {bytes.value_or(""), "fmu_base64"};
  }
  if (contents.bytes.size() > kMaxPacked && !law.Wrong(key))
    law.Fail(key, fmt::format("expected an FMU of which this platform needs at most {} bytes, which travel with the "
                              "experiment, got {}",
                              kMaxPacked, contents.bytes.size()));
  if (law.Wrong(key)) return std::nullopt;
  if (key == "file") law.Free("fmu_base64", Value{ToBase64(contents.bytes)});
  contents.name = PlainLine(law.Text("fmu_file", contents.name));
  return contents;
}

/// Whether the FMU can step by the control period.
void CheckPeriod(const Experiment& experiment, const std::string& key, Section& law, const FmuLawParams& params) {
  const ModelDescription& model = params.fmu->model();
  if (model.handles_variable_steps || !model.fixed_step_s) return;
  const double steps = experiment.period_s() / *model.fixed_step_s, whole = std::floor(steps + 0.5);
  constexpr double kRounding = 1e-6;
  if (whole >= 1 && std::abs(steps - whole) <= kRounding * steps) return;
  law.Fail(key, fmt::format("expected an FMU whose step divides the control period {} s (control.rate_hz), got {} with "
                            "a step of {} s, which it cannot vary",
                            ShortestFloat(experiment.period_s()), params.name, ShortestFloat(*model.fixed_step_s)));
}

/// Refuses to put agents of an FMU that a process can have only once into one process.
void CheckProcesses(const Experiment& experiment, const LawConfig& law_config, const std::string& key, Section& law,
                    const FmuLawParams& params) {
  if (!params.fmu->model().once_per_process || experiment.network.agents_per_process == 1) return;
  for (const AgentRange& process : AgentProcesses(experiment)) {
    int agents = 0;
    for (int id = process.first; id <= process.last; ++id) {
      const AgentConfig& agent = experiment.agent(id);
      agents += (agent.has_own_law ? &agent.law == &law_config : &experiment.law == &law_config) ? 1 : 0;
    }
    if (agents < 2) continue;
    law.Fail(key, fmt::format("expected an FMU that a process can have several times, got {}, which says "
                              "canBeInstantiatedOnlyOncePerProcess: set network.agents_per_process = 1",
                              params.name));
    return;
  }
}

/// Makes an instance, to see that it takes its parameters; not of an FMU that this process may fly and can make once.
void TryInstance(const Experiment& experiment, const std::string& key, Section& law, const FmuLawParams& params) {
  if (params.once_per_process) return;
  const std::string who = "the law in " + params.name;
  const LawAtWork at_work(who, LimitsOfCompiledLaws(experiment));
  try {
    params.fmu->Instantiate("trial", LogOf(who))->Begin(SettingsOf(params.parameters));
  } catch (const std::runtime_error& error) {
    law.Fail(key, fmt::format("expected an FMU that can be started, got {}: {}", params.name, error.what()));
  }
}

/// Reads the FMU; null after a mistake. `name`: takes what messages call it.
std::shared_ptr<const Fmu> ReadFmuFile(const std::string& key, Section& law, std::string& name) {
  const auto contents = ReadPacked(law);
  if (!contents) return nullptr;
  name = contents->name;
  try {
    return Fmu::Of(contents->bytes);
  } catch (const FmuError& error) {
    law.Fail(key, fmt::format("expected an FMU that can be flown, got {}: {}", name, error.what()));
    return nullptr;
  }
}

/// Takes the tables whose content needs an FMU, when there is none.
void LeaveTables(Section& law) {
  law.Free("params");
  Section tables = law.Child("fmu");
  for (const char* const table : {"inputs", "outputs"}) tables.Free(table);
  tables.Done();
}

std::shared_ptr<const LawParams> ReadFmu(const Experiment& experiment, const LawConfig& config, Section& section) {
  auto params = std::make_shared<FmuLawParams>();
  params->wanted = kOutputs.Value(section.OneOf("output"));
  HasParamsTable(section);
  const std::string key = section.Has("file") ? "file" : "fmu_base64";
  params->fmu = ReadFmuFile(key, section, params->name);
  if (!params->fmu) {
    LeaveTables(section);
    return params;
  }
  const ModelDescription& model = params->fmu->model();
  params->once_per_process = model.once_per_process;
  params->parameters = ReadFmuParameters(model, section);
  MapFmuSignals(model, LayoutOf(experiment, 0).places, key, section, *params);
  CheckPeriod(experiment, key, section, *params);
  CheckProcesses(experiment, config, key, section, *params);
  if (!section.Wrong("") && !experiment.checked && experiment.user_code == UserCode::kMayRun)
    TryInstance(experiment, key, section, *params);
  return params;
}

std::unique_ptr<Law> MakeFmu(const Experiment& experiment, int id) {
  return std::make_unique<FmuLawOfAgent>(experiment, id);
}

}  // namespace

LawEntry FmuLaw() {
  return {
      .name = "fmu",
      .summary = "your own law, made by Simulink, OpenModelica or another tool: an FMU for co-simulation",
      .equation = "step(t, p_i, v_i, attitude_i, {p_j, v_j, a_ij, heard, age, m_j}) -> u, m_i",
      .tex = R"((u_i, m_i) = \text{FMU}(t, p_i, v_i, q_i, \{p_j, v_j, a_{ij}, h_{ij}, \tau_{ij}, m_j\}_{j \in N_i}))",
      .graph = "what the model needs",
      .details =
          "Each agent has an instance of its own. At each tick its inputs are set, it steps by the control "
          "period, and its outputs are read: u acts from this tick on.\nAn FMU that a process can have only "
          "once is flown over DDS, where each agent has a process.",
      .theory = "none: check knows only built-in laws",
      .source = "docs/fmu_law.md; Functional Mock-up Interface (fmi-standard.org), versions 2.0 and 3.0",
      .parameters = kFmuParameters,
      .is_of_user = true,
      .seeded = "an FMU draws from what it is given: give it a seed in law.params",
      .drawing = {.pictures = kDisagreementPicture},
      .read = ReadFmu,
      .make = MakeFmu,
      .unread = [](const LawConfig& law) { return ParamsOf<FmuLawParams>(law).warnings; },
      .wanted = [](const LawConfig& law) { return ParamsOf<FmuLawParams>(law).wanted; }};
}

}  // namespace mascot
