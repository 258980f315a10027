// Random networks, held against ONNX Runtime.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "agent/network/network.h"
#include "tests/agent/network/random_network.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot::test {
namespace {

TEST(NetworkBesideOnnxRuntime, AnswersAlikeOnAThousandRandomNetworks) {
  const std::string folder = SourceFolder() + "/tests/onnxruntime";
  if (!std::filesystem::exists(folder + "/node_modules"))
    throw std::runtime_error(folder + "/node_modules is missing: run scripts/test, which installs it with `npm ci`");
  constexpr unsigned kNetworks = 1000;
  const ScratchFolder scratch;
  std::vector<std::vector<double>> answers;
  std::set<std::string> operators;
  for (unsigned seed = 0; seed < kNetworks; ++seed) {
    RandomNetwork drawn(seed);
    const std::vector<double> row = drawn.MakeInput();
    const std::string name = scratch.File(std::to_string(seed));
    WriteFile(name + ".onnx", drawn.model().Bytes());
    WriteFile(name + ".json", nlohmann::json(row).dump());
    const Network network = Network::FromOnnx(drawn.model().Bytes());
    Network::Scratch numbers = network.MakeScratch();
    const auto answer = network.Answer(row, numbers);
    answers.emplace_back(answer.begin(), answer.end());
    for (const NetworkNode& node : ReadOnnx(drawn.model().Bytes()).nodes) operators.insert(node.op);
  }
  std::string names;
  for (const std::string& each : operators) names += (names.empty() ? "" : ", ") + each;
  EXPECT_EQ(names, OperatorNames()) << "an operator is not tried";

  const Ran theirs = Shell("node '" + folder + "/answers.mjs' '" + scratch.path().string() + "'");
  ASSERT_EQ(theirs.exit_code, 0) << theirs.output;
  // Theirs are of float, and off by RandomNetwork::kMaxError at most; their functions take approximations of their own.
  for (unsigned seed = 0; seed < kNetworks; ++seed) {
    const auto expected =
        nlohmann::json::parse(ReadFile(scratch.File(std::to_string(seed) + ".answer.json"))).get<std::vector<double>>();
    EXPECT_THAT(answers[seed], testing::Pointwise(testing::DoubleNear(1e-6), expected)) << "network " << seed;
  }
}

}  // namespace
}  // namespace mascot::test
