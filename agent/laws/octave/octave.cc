// A law written by the user in MATLAB's language, run by Octave: control(t, me, neighbours, params) -> acceleration or
// velocity in W.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/laws/parts/law_text.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/user_params.h"
#include "agent/octave/octave_process.h"
#include "agent/octave/octave_text.h"
#include "agent/user_code/law_output.h"

namespace mascot {
namespace {

constexpr const char* kOctaveKey = "octave";

constexpr Key kOctaveParameters[] = {
    key::Text(kOctaveKey, "the law itself: functions, the first of them control(t, me, neighbours, params)"),
    key::Text("file", "a file that holds the law, instead of octave; its path from the folder of this file"),
    key::Any("params", "goes to control as a struct").Default("{}").Live(),
    key::Any("modules", "texts of the function files that the law calls, by their names")
        .Otherwise("those that stand beside it"),
    key::OneOf("output", kOutputs.names(), "what control returns, 3 numbers or 2 (x, y), in W")
        .Default("\"acceleration\""),
    key::Boolean("messages", "whether it sends messages").Otherwise("whether control has a second output"),
    key::Text("octave_file", "what octave goes by in messages").Otherwise("this file"),
    key::Integer("octave_line", 1, 1'000'000, "the line of octave_file at which octave begins")
        .Otherwise("where it stands"),
};

struct OctaveParams final : LawParams {
  OctaveCode code;
  Wanted wanted = Wanted::kAcceleration;
  Value params;  ///< a table
};

LawLimits StartLimits(const Experiment& experiment) {
  return {experiment.run.start_timeout_s, "run.start_timeout_s", experiment.control.python_memory_mb};
}

class LawInOctave final : public Law {
 public:
  LawInOctave(const Experiment& experiment, int id)
      : id_(id),
        limits_(LimitsOfLaws(experiment)),
        start_limits_(StartLimits(experiment)),
        params_(&ParamsOf<OctaveParams>(experiment.agent(id).law)) {
    Guarded([&] { octave_.emplace(params_->code, experiment.run.seed, id, kMaxMessage); });
  }
  Wanted wanted() const override { return params_->wanted; }
  void See(std::span<const Eigen::Vector3d> nearest_W) override { seen_W_ = nearest_W; }
  void Adopt(const AgentConfig& agent) override {
    const auto& now = ParamsOf<OctaveParams>(agent.law);
    params_are_new_ = params_are_new_ || !(now.params == params_->params);
    params_ = &now;
  }
  void AwaitStart() override {
    if (!std::exchange(has_begun_, true)) Guarded([&] { octave_->Begin(start_limits_); });
  }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    t_s_ = t_s;
    AwaitStart();
    PutCall(self, heard);
    OctaveProcess::Answer answer;
    Guarded([&] {
      if (std::exchange(params_are_new_, false)) octave_->SetParams(params_->params, limits_);
      answer = octave_->Control(call_, limits_);
    });
    message_.assign(answer.message.begin(), answer.message.end());
    return {answer.wanted[0], answer.wanted[1], answer.wanted.size() == 3 ? answer.wanted[2] : 0};
  }
  std::span<const double> Message() override { return message_; }

 private:
  /// The values in the order of agent/octave/octave_driver.h.
  void PutCall(const Motion& self, std::span<const Heard> heard) {
    call_.Clear();
    call_.Add(t_s_);
    PutAgent(id_, self);
    ranges_.clear();
    for (const Eigen::Vector3d& point : seen_W_) ranges_.insert(ranges_.end(), point.data(), point.data() + 3);
    call_.Add(ranges_);
    call_.Add(message_);
    for (const Heard& j : heard) {
      PutAgent(j.id, j.motion);
      call_.Add(j.weight);
      call_.Add(j.age_s);
      call_.Add(j.message);
    }
  }
  void PutAgent(int id, const Motion& motion) {
    const double wxyz[] = {motion.q_WB.w(), motion.q_WB.x(), motion.q_WB.y(), motion.q_WB.z()};
    call_.Add(id);
    for (const Eigen::Vector3d* v : {&motion.p_WB, &motion.v_WB, &motion.a_WB})
      call_.Add(std::span<const double>(v->data(), 3));
    call_.Add(wxyz);
    call_.Add(std::span<const double>(motion.w_WB_B.data(), 3));
  }

  /// Runs `call`, whose errors get the agent and the time in front.
  template <class Call>
  void Guarded(Call call) const {
    const auto failed = [this] {
      return fmt::format("the law of agent {} failed at t = {} s", id_, ShortestFloat(t_s_));
    };
    try {
      call();
    } catch (const OctaveError& error) {
      throw std::runtime_error(failed() + "\n" + error.place() + ": " + error.what());
    } catch (const std::exception& error) {
      throw std::runtime_error(failed() + ": " + error.what());
    }
  }

  int id_;
  LawLimits limits_, start_limits_;
  const OctaveParams* params_;  // the experiment owns them
  std::optional<OctaveProcess> octave_;
  bool has_begun_ = false, params_are_new_ = true;
  double t_s_ = 0;
  std::span<const Eigen::Vector3d> seen_W_;
  OctaveValues call_;
  std::vector<double> ranges_, message_;
};

void ReadOctaveCode(const Experiment& experiment, Section& law, OctaveCode& code) {
  const FindModules find = [](const LawText& text, const std::string& folder) {
    return FunctionFiles(text.text, folder, text.file);
  };
  const bool looks_beside = !experiment.checked && experiment.user_code == UserCode::kMayRun;
  LawText text = ReadLawText(law, kOctaveKey, looks_beside ? find : nullptr);
  for (const auto& [name, module] : text.modules)
    if (name.find('/') != std::string::npos || !name.ends_with(".m"))
      law.FailInside("modules", name, "expected the name of a file, such as saturate.m");
  code = {std::move(text.text), std::move(text.file), text.line, std::move(text.modules)};
}

/// Lets Octave read the code, to find mistakes in it. Returns whether control has a second output, the message.
bool TryCode(const Experiment& experiment, Section& law, const OctaveCode& code) {
  const SuppressedLawOutput suppressed;
  const std::string key = TextKey(law, kOctaveKey);
  const auto fail = [&](const std::string& got) {
    law.FailInText(key, fmt::format("{}:{}:1", code.file, code.line),
                   "expected a = control(t, me, neighbours, params), got " + got);
  };
  try {
    const OctaveSignature control = OctaveProcess(code, 0, 0, kMaxMessage).Begin(StartLimits(experiment));
    if (control.inputs >= 0 && control.inputs != 3 && control.inputs != 4)
      fail(fmt::format("control with {} inputs", control.inputs));
    if (control.outputs == 0) fail("control without an output");
    return control.outputs > 1 || control.outputs < -1;
  } catch (const OctaveError& error) {
    law.FailInText(key, error.place(), std::string("expected a law for Octave, got: ") + error.what());
  } catch (const std::exception& error) {
    law.Fail(key, error.what());
  }
  return false;
}

bool SendsByOctave(const Experiment& experiment, Section& law, const OctaveCode& code) {
  const bool is_known = experiment.checked && law.Has("messages");  // reading a checked experiment starts no Octave
  if (is_known || experiment.user_code == UserCode::kNeverRuns || law.Wrong("")) return law.Boolean("messages", false);
  const bool can_send = TryCode(experiment, law, code);
  const bool sends = law.Boolean("messages", can_send);
  if (sends && !can_send && !law.Wrong(""))
    law.Fail("messages", "expected a law with [a, message] = control(...), got one without a message");
  return sends;
}

std::shared_ptr<const LawParams> ReadOctave(const Experiment& experiment, const LawConfig& /*law*/, Section& section) {
  auto params = std::make_shared<OctaveParams>();
  ReadOctaveCode(experiment, section, params->code);
  params->wanted = kOutputs.Value(section.OneOf("output"));
  params->params = ReadUserParams(section);
  params->sends_messages = SendsByOctave(experiment, section, params->code);
  return params;
}

std::unique_ptr<Law> MakeOctave(const Experiment& experiment, int id) {
  return std::make_unique<LawInOctave>(experiment, id);
}

/// Only rand, randn, randi, rande, randg, randp and randperm know run.seed.
bool DrawsByOctave(const LawConfig& law) {
  const OctaveCode& code = ParamsOf<OctaveParams>(law).code;
  const auto names_it = [](const std::string& text) { return text.find("rand") != std::string::npos; };
  return names_it(code.text) ||
         std::ranges::any_of(code.modules, [&](const auto& module) { return names_it(module.second); });
}

Wanted WantedByOctave(const LawConfig& law) { return ParamsOf<OctaveParams>(law).wanted; }

}  // namespace

LawEntry OctaveLaw() {
  return {.name = "octave",
          .summary = "your own law, in MATLAB's language: Octave runs it",
          .equation = "a = control(t, me, neighbours, params), or [a, message] = control(...)",
          .tex = R"(\texttt{control(t, me, neighbours, params)} \to [a_x, a_y, a_z] \text{ or } [a_x, a_y])",
          .graph = "what the code needs",
          .theory = "none: check knows only built-in laws",
          .source = "docs/octave.md",
          .parameters = kOctaveParameters,
          .is_of_user = true,
          .seeded = "rand, randn and the like in Octave are each agent's own, and run.seed seeds them",
          .sees_obstacles = true,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadOctave,
          .make = MakeOctave,
          .draws = DrawsByOctave,
          .wanted = WantedByOctave};
}

}  // namespace mascot
