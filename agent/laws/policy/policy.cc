// A trained network decides: its input is what the agent perceives (agent/laws/parts/observation.h), its answer what
// the agent wants, and the message that the agent sends.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/parts/observation.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/network/network.h"
#include "base/base64.h"
#include "base/utf8.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxPolicy = std::size_t{4} << 20;       // bytes of a file
constexpr const char* kObservationKey = "mascot_observation";  // in the file's metadata: the layout's hash

constexpr Key kPolicyParameters[] = {
    key::Text("file", "the network, in the format ONNX; its path from the folder of this file"),
    key::Text("onnx_base64", "the contents of the file in base64").Otherwise("what the file holds"),
    key::Text("onnx_file", "what the network goes by in messages").Otherwise("the name of the file"),
    key::OneOf("output", kOutputs.names(), "what the first three numbers of its answer are, in W")
        .Default("\"acceleration\""),
};

struct PolicyParams final : LawParams {
  std::shared_ptr<const Network> network;  ///< null after a mistake
  Wanted wanted = Wanted::kAcceleration;
  ObservationLayout layout;
};

class Policy final : public Law {
 public:
  Policy(const Experiment& experiment, int id)
      : params_(&ParamsOf<PolicyParams>(experiment.agent(id).law)),
        observer_(experiment, id, params_->layout),
        observation_(params_->layout.size()),
        scratch_(params_->network->MakeScratch()) {}
  Wanted wanted() const override { return params_->wanted; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<PolicyParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    observer_.Observe(self, heard, observation_);
    answer_ = params_->network->Answer(observation_, scratch_);
    return {answer_[0], answer_[1], answer_[2]};
  }
  std::span<const double> Message() override { return answer_.subspan(3); }

 private:
  const PolicyParams* params_;  // the experiment owns them
  Observer observer_;
  std::vector<double> observation_;
  Network::Scratch scratch_;
  std::span<const double> answer_;
};

/// Reads the contents of the file, and what messages call it. Notes a mistake if there are none.
std::optional<Section::FileContents> ReadContents(Section& law) {
  law.Supersede("file", {"onnx_base64", "onnx_file"});
  law.Supersede("onnx_base64", {"file", "onnx_file"});
  if (!HasOneOf(law, "file", "onnx_base64", "file")) return std::nullopt;
  Section::FileContents contents;
  if (law.Has("file")) {
    contents = law.ContentsOfFile("file", "onnx_base64", kMaxPolicy);
  } else {
    const auto bytes = FromBase64(law.Text("onnx_base64"));
    if (!bytes) law.Fail("onnx_base64", "expected base64, got other text");
    if (bytes && bytes->size() > kMaxPolicy)
      law.Fail("onnx_base64", fmt::format("expected at most {} bytes, got {}", kMaxPolicy, bytes->size()));
    contents = {bytes.value_or(""), "onnx_base64"};
  }
  contents.name = law.Text("onnx_file", contents.name);
  if (law.Wrong("file") || law.Wrong("onnx_base64")) return std::nullopt;
  return contents;
}

std::shared_ptr<const LawParams> ReadPolicy(const Experiment& experiment, const LawConfig& /*law*/, Section& section) {
  auto params = std::make_shared<PolicyParams>();
  params->wanted = kOutputs.Value(section.OneOf("output"));
  const std::string key = section.Has("file") ? "file" : "onnx_base64";
  const auto contents = ReadContents(section);
  if (!contents) return params;
  const auto refuse = [&](const std::string& expected, const std::string& got) {
    section.Fail(key, fmt::format("expected {}, got {}: {}", expected, contents->name, got));
  };
  try {
    auto network = std::make_shared<const Network>(Network::FromOnnx(contents->bytes));
    if (network->outputs() < 3 || network->outputs() > 3 + kMaxMessage) {
      refuse(fmt::format("3 numbers as answer, and at most {} of a message behind them", kMaxMessage),
             fmt::format("{}", network->outputs()));
      return params;
    }
    const std::size_t message = network->outputs() - 3;
    params->layout = LayoutOf(experiment, message);
    params->sends_messages = message > 0;
    const std::string expected =
        fmt::format("a network for \"{}\" ({} numbers), whose metadata have {} = \"{}\"", params->layout.Text(),
                    params->layout.size(), kObservationKey, params->layout.Hash());
    const auto told = network->metadata().find(kObservationKey);
    if (told == network->metadata().end())
      refuse(expected, fmt::format("metadata without {}", kObservationKey));
    else if (told->second != params->layout.Hash())
      refuse(expected, fmt::format("{} = \"{}\"", kObservationKey, Shortened(PlainLine(told->second), 100)));
    else if (network->inputs() != params->layout.size())
      refuse(expected, fmt::format("one for {} numbers", network->inputs()));
    params->network = std::move(network);
  } catch (const NetworkError& error) {
    refuse("a network that can be flown", error.what());
  }
  return params;
}

std::unique_ptr<Law> MakePolicy(const Experiment& experiment, int id) {
  return std::make_unique<Policy>(experiment, id);
}

}  // namespace

LawEntry PolicyLaw() {
  return {
      .name = "policy",
      .summary = "a trained network decides",
      .equation =
          "(a_i, m_i) = network(p_i, v_i, attitude_i, for each neighbour p_j - p_i, v_j - v_i, a_ij, heard, age, m_j)",
      .tex = R"((a_i, m_i) = \pi(p_i, v_i, q_i, \{p_j - p_i, v_j - v_i, a_{ij}, h_{ij}, \tau_{ij}, m_j\}_{j \in N_i}))",
      .graph = "any",
      .details =
          "The network is a file of the format ONNX (docs/policy.md). It is computed here, in a fixed order and by "
          "functions that have the same bits on every processor.\nIts input is what the agent perceives: `orchestrator "
          "check` shows the "
          "layout, whose hash the file's metadata must have as mascot_observation. Its answer is what the agent "
          "wants, and behind that the message that it sends, if there is one.",
      .theory = "none: what a network has learned is not known",
      .source = "Open Neural Network Exchange (onnx.ai), operators of opsets 9 to 21",
      .parameters = kPolicyParameters,
      .drawing = {},
      .read = ReadPolicy,
      .make = MakePolicy,
      .wanted = [](const LawConfig& law) { return ParamsOf<PolicyParams>(law).wanted; },
      .observation = [](const LawConfig& law) -> const ObservationLayout& {
        return ParamsOf<PolicyParams>(law).layout;
      }};
}

}  // namespace mascot
