// A law written by the user in Python: control(t, me, neighbours) -> acceleration or velocity in W.
#include "agent/laws/custom/custom.h"

#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/user_params.h"

namespace mascot {
namespace {

constexpr EnumNames<PythonStyle, 2> kPythonStyles({{PythonStyle::kStandard, "standard"},
                                                   {PythonStyle::kMascot, "mascot"}});

constexpr Key kCustomParameters[] = {
    key::Text("python",
              "the law itself: defines control(t, me, neighbours), may define start(me, params), message(me), set(me, "
              "params)"),
    key::Text("file", "a file that holds the law, instead of python; its path from the folder of this file"),
    key::Any("params", "goes to start(me, params) as a dict, and to set(me, params) when an event has changed it")
        .Default("{}")
        .Live(),
    key::Any("modules", "texts of the modules that the law imports, by their paths from its folder")
        .Otherwise("those that stand beside it"),
    key::Texts("data",
               "files that the law reads, by their paths from the folder of this file, below it; they travel with the "
               "experiment, together at most 4 MiB: the law finds the path of each as DATA[name]")
        .Otherwise("none"),
    key::Any("data_base64", "the contents of data in base64, by name").Otherwise("what the files hold"),
    key::OneOf("style", kPythonStyles.names(),
               "mascot: the published testbed's control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, "
               "leader)")
        .Default("\"standard\""),
    key::OneOf("output", kOutputs.names(), "what control returns, 3 numbers or 2 (x, y), in W")
        .Default("\"acceleration\""),
    key::Boolean("messages", "whether it sends messages").Otherwise("whether it defines message"),
    key::Integer("leader", 0, kMaxAgents,
                 "for control_user, which counts agents from 0: given as leader - 1, -1 if there is none")
        .Default("0"),
    key::Text("python_file", "what python goes by in messages").Otherwise("this file"),
    key::Integer("python_line", 1, 1'000'000, "the line of python_file at which python begins")
        .Otherwise("where it stands"),
};

/// Whether what only Python can tell of the law is to be found out.
bool AsksPython(const Experiment& experiment) {
  return !experiment.checked && experiment.user_code == UserCode::kMayRun;
}

/// The modules that the law imports. Notes a mistake if one cannot be read.
PythonModules ImportedModules(Section& law, const LawText& text, const std::string& folder) {
  try {
    return ModulesBeside(text.text, folder);
  } catch (const PythonError& error) {
    law.Fail(TextKey(law, kPythonKey), "expected modules that can be read, got " + error.summary());
    return {};
  }
}

void ReadKeys(const Experiment& experiment, Section& law, CustomParams& params) {
  const FindModules find = [&](const LawText& text, const std::string& folder) {
    return ImportedModules(law, text, folder);
  };
  static_cast<LawText&>(params) = ReadLawText(law, kPythonKey, AsksPython(experiment) ? find : nullptr);
  params.data = ReadLawData(law);
  params.style = kPythonStyles.Value(law.OneOf("style"));
  params.wanted = kOutputs.Value(law.OneOf("output"));
  params.params = ReadUserParams(law);
}

/// Whether the law sends messages: as the key says, else whether the text defines message().
bool SendsMessages(const Experiment& experiment, CustomParams& params, Section& law) {
  // A checked experiment has the key: reading it need not start Python.
  const bool is_known = experiment.checked && law.Has("messages");
  if (is_known || experiment.user_code == UserCode::kNeverRuns || law.Wrong("")) return law.Boolean("messages", false);
  LawLimits limits = LimitsOfLaws(experiment);
  if (experiment.run.start_timeout_s < limits.limit_s) {
    limits.limit_s = experiment.run.start_timeout_s;
    limits.source = "run.start_timeout_s";
  }
  const bool can_send = TryText(law, params, limits);
  const bool sends = law.Boolean("messages", can_send);
  if (sends && !can_send && !law.Wrong("")) law.Fail("messages", "expected a law that defines message(me), got none");
  return sends;
}

std::shared_ptr<const LawParams> ReadCustom(const Experiment& experiment, const LawConfig& /*law*/, Section& section) {
  auto params = std::make_shared<CustomParams>();
  ReadKeys(experiment, section, *params);
  params->sends_messages = SendsMessages(experiment, *params, section);
  return params;
}

std::unique_ptr<Law> MakeCustom(const Experiment& experiment, int id) {
  const LawConfig& law = experiment.agent(id).law;
  const auto& params = ParamsOf<CustomParams>(law);
  const LawLimits call = LimitsOfLaws(experiment);
  // The text has run in time before; now all agents may make their laws at once.
  const CustomLimits limits{call, {experiment.run.start_timeout_s, "run.start_timeout_s", call.memory_mb}};
  if (params.style == PythonStyle::kMascot) return MakePublishedLaw(params, limits, id, experiment.size(), law.leader);
  return MakeStandardLaw(params, limits, experiment.run.seed, id);
}

bool DrawsByCustom(const LawConfig& law) { return CanDraw(ParamsOf<CustomParams>(law)); }
std::vector<std::string> UnreadByCustom(const LawConfig& law) {
  const auto& params = ParamsOf<CustomParams>(law);
  return params.looked_up->Warnings(params.params);
}
Wanted WantedByCustom(const LawConfig& law) { return ParamsOf<CustomParams>(law).wanted; }

}  // namespace

LawEntry CustomLaw() {
  return {.name = "custom",
          .summary =
              "your own law, in Python: what one agent wants, from what it knows of itself and heard of its neighbours",
          .equation = "control(t, me, neighbours) -> [a_x, a_y, a_z] or [a_x, a_y]",
          .tex = R"(\texttt{control(t, me, neighbours)} \to [a_x, a_y, a_z] \text{ or } [a_x, a_y])",
          .graph = "what the code needs",
          .theory = "none: check knows only built-in laws",
          .source = "docs/laws.md",
          .parameters = kCustomParameters,
          .is_of_user = true,
          .seeded = "me.rng is each agent's own generator in Python, and run.seed seeds it",
          .sees_obstacles = true,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadCustom,
          .make = MakeCustom,
          .draws = DrawsByCustom,
          .unread = UnreadByCustom,
          .wanted = WantedByCustom};
}

}  // namespace mascot
