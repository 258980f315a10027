// law.name = "policy": a network decides.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "agent/laws/laws.h"
#include "agent/laws/parts/observation.h"
#include "base/base64.h"
#include "tests/experiment/fly_rows.h"
#include "tests/support/folders.h"
#include "tests/support/onnx_model.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using test::ConsensusNetwork;
using test::OnnxModel;
using ::testing::HasSubstr;

constexpr int kPlaces = 2;  // agent 1 hears 2 and 3

std::string Hash(std::size_t message = 0) { return ObservationLayout{.places = kPlaces, .message = message}.Hash(); }
OnnxModel Good() { return ConsensusNetwork(kPlaces, 0.5F, 1.5F).Metadata("mascot_observation", Hash()); }

std::vector<DecodedRow> Flown(const Experiment& experiment) {
  Rows rows;
  EXPECT_EQ(RunInProcess(experiment, {&rows}, [] { return true; }).failure, "");
  return rows.rows;
}

/// An experiment in a folder, with policy.onnx beside it.
class PolicyLaw : public testing::Test {
 protected:
  void Leave(OnnxModel& model) const { WriteFile(scratch_.File("policy.onnx"), model.Bytes()); }
  Experiment Read(const std::string& law = kLaw) const {
    WriteFile(scratch_.File("run.toml"), Three(law));
    return LoadExperiment(Section::FromFile(scratch_.File("run.toml")), "run");
  }
  std::string Refusal(const std::string& law = kLaw) const {
    try {
      Read(law);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "nothing";
  }

  static constexpr const char* kLaw = "name = 'policy'\nfile = 'policy.onnx'\n";
  const ScratchFolder scratch_;
};

TEST_F(PolicyLaw, ThatIsTheConsensusLawFliesAsThisLawDoes) {
  OnnxModel model = Good();
  Leave(model);
  const auto learned = Flown(Read()), linear = Flown(Read("name = 'consensus'\np_gain = 0.5\nbeta = 1.5\n"));
  ASSERT_EQ(learned.size(), linear.size());
  for (std::size_t tick = 0; tick < learned.size(); ++tick)
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT((learned[tick].commands[i].a_law_W - linear[tick].commands[i].a_law_W).norm(), 1e-12);
      EXPECT_LT((learned[tick].motions[i].p_WB - linear[tick].motions[i].p_WB).norm(), 1e-12);
    }
  EXPECT_GT((learned.back().motions[0].p_WB - learned.front().motions[0].p_WB).norm(), 0.1) << "nobody has moved";
}

TEST_F(PolicyLaw, TravelsWithTheExperiment) {
  OnnxModel model = Good();
  Leave(model);
  const std::string resolved = Read().resolved;
  std::filesystem::remove(scratch_.File("policy.onnx"));
  const Experiment again = LoadExperiment(Section::FromText(resolved, "elsewhere.toml"), "run");
  EXPECT_EQ(again.resolved, resolved);
  EXPECT_EQ(Flown(again).size(), 101U);
}

TEST_F(PolicyLaw, WantsAVelocityIfTheFileSaysSo) {
  OnnxModel model = Good();
  Leave(model);
  const auto accelerated = Flown(Read()), driven = Flown(Read(kLaw + std::string("output = 'velocity'\n")));
  EXPECT_GT((accelerated.back().motions[0].p_WB - driven.back().motions[0].p_WB).norm(), 0.005);
}

TEST_F(PolicyLaw, SendsWhatItsAnswerHasBehindTheCommand) {
  OnnxModel model(10 + kPlaces * 11);
  model.Integers("0", {0}).Integers("3", {3}).Integers("5", {5}).Integers("1", {1});
  model.Node("Slice", {"x", "0", "5", "1"}, "y").Output("y", 5).Metadata("mascot_observation", Hash(2));
  Leave(model);
  const auto rows = Flown(Read());
  EXPECT_THAT(rows[3].messages[1], testing::ElementsAre(rows[3].motions[1].v_WB.x(), rows[3].motions[1].v_WB.y()));
}

TEST_F(PolicyLaw, KeepsAgentsApartWithTheSafetyFilter) {
  OnnxModel model = Good();
  Leave(model);
  const auto distance_m = [&](const std::string& safety) {
    double least = 1e9;
    for (const DecodedRow& row : Flown(Read(kLaw + safety)))
      least = std::min(least, (row.motions[1].p_WB - row.motions[0].p_WB).head<2>().norm());
    return least;
  };
  const double without = distance_m("");
  EXPECT_GT(distance_m(fmt::format("[law.safety]\ndistance_m = {}\ngamma = 0.5\n", without + 0.05)), without + 0.02);
}

TEST_F(PolicyLaw, TellsWhatItsAgentsPerceive) {
  OnnxModel model = Good();
  Leave(model);
  const auto perceived = PerceivedIn(Read());
  ASSERT_EQ(perceived.size(), 1U);
  EXPECT_EQ(perceived[0].layout, (ObservationLayout{.places = kPlaces, .message = 0}));
  EXPECT_THAT(perceived[0].ids, testing::ElementsAre(1, 2, 3));
  EXPECT_TRUE(PerceivedIn(Read("name = 'consensus'\n")).empty());
}

// --- the one that is shipped -----------------------------------------------------------------------------

TEST(ShippedPolicy, IsWhatItsScriptWrites) {
  const ScratchFolder scratch;
  const std::string hash = ObservationLayout{.places = 3, .message = 0}.Hash();
  const Ran ran = Shell("/usr/bin/python3 " + test::SourceFolder() + "/docs/examples/policy/consensus_policy.py 3 " +
                        hash + " " + scratch.File("policy.onnx"));
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(ReadFile(scratch.File("policy.onnx")), ReadFile(test::SourceFolder() + "/configs/policy.onnx"));
}

TEST(ShippedPolicy, FliesAsTheConsensusLawWhoseGainsItHas) {
  const std::string file = test::SourceFolder() + "/configs/policy.toml";
  const std::vector<Override> shorter = {{.key = "run.duration_s", .value = "10.0"}};
  std::vector<Override> law = shorter;
  law.push_back({.key = "law", .value = "{ name = 'consensus', p_gain = 0.046875, beta = 0.90625 }"});
  const auto learned = Flown(LoadExperiment(Section::FromFile(file, shorter), "run"));
  const auto linear = Flown(LoadExperiment(Section::FromFile(file, law), "run"));
  ASSERT_EQ(learned.size(), linear.size());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((learned.back().motions[i].p_WB - linear.back().motions[i].p_WB).norm(), 1e-9);
    EXPECT_GT((learned.back().motions[i].p_WB - learned.front().motions[i].p_WB).norm(), 1);
  }
}

// --- what is refused -------------------------------------------------------------------------------------

TEST_F(PolicyLaw, ForAnotherLayoutIsRefused) {
  OnnxModel other = ConsensusNetwork(kPlaces, 0.5F, 1.5F).Metadata("mascot_observation", "0123456789abcdef");
  Leave(other);
  EXPECT_THAT(Refusal(),
              HasSubstr("law.file: expected a network for \"mascot observation 1: own p 3, v 3, attitude 4; 2 x "
                        "(p 3, v 3, weight, heard, age, message 0)\" (28 numbers), whose metadata have "
                        "mascot_observation = \"" +
                        Hash() + "\", got policy.onnx: mascot_observation = \"0123456789abcdef\""));
  OnnxModel garbled = ConsensusNetwork(kPlaces, 0.5F, 1.5F).Metadata("mascot_observation", "\x1B\n");
  Leave(garbled);
  EXPECT_THAT(Refusal(), HasSubstr("got policy.onnx: mascot_observation = \"\\u001b\\n\""));
  OnnxModel untold = ConsensusNetwork(kPlaces, 0.5F, 1.5F);
  Leave(untold);
  EXPECT_THAT(Refusal(), HasSubstr("got policy.onnx: metadata without mascot_observation"));
  OnnxModel wider = ConsensusNetwork(kPlaces + 1, 0.5F, 1.5F).Metadata("mascot_observation", Hash());
  Leave(wider);
  EXPECT_THAT(Refusal(), HasSubstr("got policy.onnx: one for 37 numbers"));
}

TEST_F(PolicyLaw, WithTooFewOrTooManyNumbersIsRefused) {
  for (const int numbers : {2, 68}) {
    OnnxModel model(70);
    model.Integers("0", {0}).Integers("n", {numbers}).Integers("1", {1});
    model.Node("Slice", {"x", "0", "n", "1"}, "y").Output("y", numbers);
    Leave(model);
    EXPECT_THAT(Refusal(),
                HasSubstr("law.file: expected 3 numbers as answer, and at most 64 of a message behind them, got "
                          "policy.onnx: " +
                          std::to_string(numbers)));
  }
}

TEST_F(PolicyLaw, ThatCannotBeReadIsRefusedWhereTheFileNamesIt) {
  EXPECT_THAT(Refusal(), HasSubstr("law.file: expected a readable file, got "));
  WriteFile(scratch_.File("policy.onnx"), "a poem");
  EXPECT_THAT(Refusal(),
              HasSubstr("law.file: expected a network that can be flown, got policy.onnx: expected a model in the "
                        "format ONNX, got something else"));
  OnnxModel unknown(10 + 9 * kPlaces);
  unknown.Node("Sin", {"x"}, "y").Output("y", 28);
  Leave(unknown);
  EXPECT_THAT(Refusal(), HasSubstr("got policy.onnx: node 1 (Sin): expected one of Abs, Add, "));
  EXPECT_THAT(Refusal("name = 'policy'\n"), HasSubstr("law: expected one of file, onnx_base64, got none"));
  EXPECT_THAT(Refusal("name = 'policy'\nonnx_base64 = '?'\n"),
              HasSubstr("law.onnx_base64: expected base64, got other text"));
  EXPECT_THAT(Refusal("name = 'policy'\nonnx_base64 = 'AAAA'\nfile = 'policy.onnx'\n"),
              HasSubstr("law.file: expected one of file, onnx_base64, got both"));
  EXPECT_THAT(Refusal("name = 'policy'\nonnx_base64 = '" + ToBase64(std::string((4 << 20) + 1, 'x')) + "'\n"),
              HasSubstr("law.onnx_base64: expected at most 4194304 bytes, got 4194305"));
  EXPECT_THAT(Refusal("name = 'policy'\nonnx_base64 = 'AAAA'\nonnx_file = 'mine.onnx'\n"),
              HasSubstr("law.onnx_base64: expected a network that can be flown, got mine.onnx: expected a model"));
  WriteFile(scratch_.File("policy.onnx"), std::string((4 << 20) + 1, 'x'));
  EXPECT_THAT(Refusal(),
              HasSubstr("law.file: expected a file of at most 4194304 bytes, which travels with the experiment, got "
                        "4194305"));
}

}  // namespace
}  // namespace mascot
