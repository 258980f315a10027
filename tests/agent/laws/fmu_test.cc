// law.name = "fmu": an FMU decides. The FMUs are those of tests/fmus, which CMake builds.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "agent/fmi/archive.h"
#include "agent/laws/fmu/fmu_law.h"
#include "agent/laws/laws.h"
#include "base/base64.h"
#include "tests/experiment/fly_rows.h"
#include "tests/support/folders.h"
#include "tests/support/noise.h"
#include "tests/support/scratch.h"
#include "tests/support/three_agents.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;

std::string FmuFile(int version) { return fmt::format("{}/tests/fmus/law_fmi{}.fmu", test::BuildFolder(), version); }
std::string LawWith(int version, const std::string& lines = "") {
  return "name = 'fmu'\nfile = '" + FmuFile(version) + "'\n" + lines;
}

/// What is flown, and why it ended; "": it went through.
struct Flown {
  std::vector<DecodedRow> rows;
  std::string failure;
};
Flown FlyLaw(const std::string& law) {
  Rows rows;
  std::string failure = RunInProcess(Load(Three(law)), {&rows}, [] { return true; }).failure;
  return {std::move(rows.rows), std::move(failure)};
}

/// An FMU whose description or files are other ones, in base64.
std::string Edited(int version, const std::function<void(std::map<std::string, std::string>&)>& edit) {
  const FmuArchive archive(ReadFile(FmuFile(version)));
  std::map<std::string, std::string> files;
  for (const auto& [name, size] : archive.sizes()) files[name] = archive.Read(name);
  edit(files);
  return "name = 'fmu'\nfmu_base64 = '" + ToBase64(PackFiles(files)) + "'\n";
}
std::string Described(int version, const std::string& from, const std::string& to) {
  return Edited(version, [&](std::map<std::string, std::string>& files) {
    std::string& xml = files.at("modelDescription.xml");
    const std::size_t at = xml.find(from);
    EXPECT_NE(at, xml.npos) << from;
    if (at != xml.npos) xml.replace(at, from.size(), to);
  });
}

/// Where the library is in its archive.
std::string LibraryIn(int version) { return version == 2 ? "binaries/linux64/law.so" : "binaries/x86_64-linux/law.so"; }

class FmuLawOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Fmi, FmuLawOf, testing::Values(2, 3));

TEST_P(FmuLawOf, ConsensusFliesAsTheLawInCppDoes) {
  const auto fmu = FlyLaw(LawWith(GetParam(), "params = { p_gain = 0.5, beta = 1.5 }\n"));
  const auto linear = FlyLaw("name = 'consensus'\np_gain = 0.5\nbeta = 1.5\n");
  ASSERT_EQ(fmu.failure, "");
  ASSERT_EQ(fmu.rows.size(), linear.rows.size());
  for (std::size_t tick = 0; tick < fmu.rows.size(); ++tick)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_LT((fmu.rows[tick].motions[i].p_WB - linear.rows[tick].motions[i].p_WB).norm(), 1e-9);
  EXPECT_GT((fmu.rows.back().motions[0].p_WB - fmu.rows.front().motions[0].p_WB).norm(), 0.1) << "nobody has moved";
}

TEST_P(FmuLawOf, EachAgentHasAnInstanceThatCountsItsOwnSteps) {
  const auto flown = FlyLaw(LawWith(GetParam()));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_THAT(flown.rows[7].messages[i], testing::ElementsAre(8.0));
}

TEST_P(FmuLawOf, StepsFromATickToTheNext) {
  const auto flown = FlyLaw(LawWith(GetParam(), "params = { does = 7 }\n"));
  EXPECT_NEAR(flown.rows[30].commands[0].a_law_W.x(), 0.30, 1e-12);
  EXPECT_NEAR(flown.rows[30].commands[0].a_law_W.y(), 0.31, 1e-12);
}

TEST_P(FmuLawOf, TunableParametersAreChangedByEventsAndFixedOnesAreNot) {
  const auto with = [&](const std::string& params) {
    return LawWith(GetParam(),
                   "params = { p_gain = 0.5, beta = 1.5 }\n[[events]]\nat_s = 0.5\nset = { " + params + " }\n");
  };
  const auto changed = FlyLaw(with("'law.params.p_gain' = 1.0")), same = FlyLaw(with("'law.params.p_gain' = 0.5"));
  EXPECT_EQ(changed.rows[49].commands[0].a_law_W, same.rows[49].commands[0].a_law_W);
  EXPECT_GT((changed.rows[50].commands[0].a_law_W - same.rows[50].commands[0].a_law_W).norm(), 0.1);
  EXPECT_THAT(Refusal(Three(with("'law.params.beta' = 1.0"))),
              HasSubstr("law.params: expected a change of tunable parameters of the FMU, got beta, which is fixed"));
  EXPECT_THAT(FlyLaw(with("'law.params.p_gain' = -1.0")).failure,
              HasSubstr(fmt::format("the law of agent 1 does not take its new parameters: law_fmi{0}.fmu: {1}: error",
                                    GetParam(), GetParam() == 2 ? "fmi2SetReal" : "fmi3SetFloat64")));
}

TEST_P(FmuLawOf, TravelsWithTheExperiment) {
  const std::string resolved = Load(Three(LawWith(GetParam()))).resolved;
  EXPECT_THAT(resolved, testing::Not(HasSubstr("law_fmi2.fmu'")));
  const Experiment again = LoadExperiment(Section::FromText(resolved, "elsewhere.toml"), "run");
  EXPECT_EQ(again.resolved, resolved);
  Rows rows;
  EXPECT_EQ(RunInProcess(again, {&rows}, [] { return true; }).failure, "");
}

TEST_P(FmuLawOf, TakesSignalsByTables) {
  const std::string swapped =
      "params = { p_gain = 0.0, beta = 1.0 }\n[law.fmu]\ninputs = { 'v[1]' = 'neighbour[2].p[2]' }\n";
  const std::string array = "params = { p_gain = 0.0, beta = 1.0 }\n[law.fmu]\ninputs = { v = 'neighbour[2].p' }\n";
  const auto flown = FlyLaw(LawWith(GetParam(), GetParam() == 2 ? swapped : array));
  ASSERT_EQ(flown.failure, "");
  EXPECT_NEAR(flown.rows[0].commands[0].a_law_W.x(), GetParam() == 2 ? -2 : 0, 1e-12) << "agent 3 is at [0, 2, 3]";
  const auto outputs =
      FlyLaw(LawWith(GetParam(), "[law.fmu]\noutputs = { 'u[1]' = 'message[1]', 'message[2]' = 'message[1]' }\n"));
  ASSERT_EQ(outputs.failure, "");
  EXPECT_EQ(outputs.rows[4].commands[0].a_law_W.x(), 5) << "in place of the output u[1]";
  EXPECT_THAT(outputs.rows[4].messages[0], testing::ElementsAre(5, 5));
}

TEST_P(FmuLawOf, WantsAVelocityIfTheFileSaysSo) {
  const auto driven = FlyLaw(LawWith(GetParam(), "output = 'velocity'\n")), accelerated = FlyLaw(LawWith(GetParam()));
  EXPECT_GT((driven.rows.back().motions[0].p_WB - accelerated.rows.back().motions[0].p_WB).norm(), 0.005);
}

TEST_P(FmuLawOf, TakesPlacesOfNeighboursByOtherNamesAndAsAMatrix) {
  const std::string params = "params = { p_gain = 0.5 }\n";
  const std::string name = GetParam() == 2 ? "name=\"neighbour[2].p[1]\"" : "name=\"neighbour[2].p\"";
  const std::string renamed = GetParam() == 2 ? "name=\"neighbour2_p_x\"" : "name=\"neighbour2_p\"";
  const auto flown = FlyLaw(LawWith(GetParam(), params)), same = FlyLaw(Described(GetParam(), name, renamed) + params);
  ASSERT_EQ(same.failure, "");
  for (std::size_t tick = 0; tick < flown.rows.size(); ++tick)
    EXPECT_EQ(flown.rows[tick].commands[0].a_law_W, same.rows[tick].commands[0].a_law_W);
  const auto matrix = FlyLaw(LawWith(GetParam(), "params = { does = 10 }\n"));
  ASSERT_EQ(matrix.failure, "");
  EXPECT_EQ(matrix.rows[0].commands[0].a_law_W, Eigen::Vector3d(0, 2, 0)) << "agent 3 is at [0, 2, 3]";
}

TEST_P(FmuLawOf, ReadsAndExecutesItsResourcesAsTheArchiveLetsIt) {
  const auto flown = FlyLaw(LawWith(GetParam(), "params = { does = 11 }\n"));
  ASSERT_EQ(flown.failure, "");
  EXPECT_EQ(flown.rows[0].commands[0].a_law_W, Eigen::Vector3d(0.25, 1, 0));
  const Experiment again = LoadExperiment(
      Section::FromText(Load(Three(LawWith(GetParam(), "params = { does = 11 }\n"))).resolved, "elsewhere.toml"),
      "run");
  Rows rows;
  ASSERT_EQ(RunInProcess(again, {&rows}, [] { return true; }).failure, "");
  EXPECT_EQ(rows.rows[0].commands[0].a_law_W, Eigen::Vector3d(0.25, 1, 0)) << "packed, it holds the same files";
}

TEST_P(FmuLawOf, LogsItsWarnings) {
  testing::internal::CaptureStderr();
  const auto flown = FlyLaw(LawWith(GetParam(), "params = { does = 12 }\n"));
  const std::string words = testing::internal::GetCapturedStderr();
  EXPECT_THAT(words, HasSubstr("the law of agent 1: warning (logStatusWarning): too fast"));
  EXPECT_THAT(words, HasSubstr("the law of agent 1: (no more of its words are shown)")) << "after 100 lines";
  EXPECT_EQ(flown.failure, "");
}

TEST_P(FmuLawOf, WarnsOfInputsThatAreNoSignalsAndOfNeighboursWithoutInputs) {
  const auto warnings = [&](const std::string& law) {
    const Experiment experiment = Load(Three(law));
    return ParamsOf<FmuLawParams>(experiment.law).warnings;
  };
  EXPECT_THAT(warnings(LawWith(GetParam())), testing::IsEmpty());
  const std::string mode = Described(GetParam(), "name=\"id\"", "name=\"mode\"");
  EXPECT_THAT(warnings(mode),
              testing::ElementsAre("input 'mode' of fmu_base64 is no signal, and keeps its start value"));
  EXPECT_THAT(warnings(mode + "params = { mode = 3 }\n"), testing::IsEmpty());
}

// --- what goes wrong in a run ------------------------------------------------------------------------------

TEST_P(FmuLawOf, ThatFailsEndsTheRunWithItsWords) {
  const auto failure = [&](int does) {
    const Flown flown = FlyLaw(LawWith(GetParam(), fmt::format("params = {{ does = {} }}\n", does)));
    return flown.failure;
  };
  const std::string step = fmt::format("law_fmi{0}.fmu: fmi{0}DoStep: ", GetParam());
  EXPECT_THAT(failure(3), HasSubstr("the law of agent 1 failed at t = 0.0 s: " + step + "error: no more"));
  EXPECT_THAT(failure(5), HasSubstr(step + "discard"));
  EXPECT_THAT(failure(6), HasSubstr(step + (GetParam() == 2 ? "pending: " : "it wants the simulation to end")));
  if (GetParam() == 3) {
    EXPECT_THAT(failure(9), HasSubstr(step + "it returned early, at its time 0 s"));
  }
}

TEST_P(FmuLawOf, ThatHasHadAFatalErrorIsNotCalledAgain) {
  const std::string fatal = Described(GetParam(), "name=\"id\"", "name=\"when\"") + "params = { does = 4 }\n";
  EXPECT_THAT(FlyLaw(fatal).failure, HasSubstr(fmt::format("fmu_base64: fmi{}DoStep: fatal: no more", GetParam())));
  EXPECT_THAT(
      Refusal(Three(fatal)),
      HasSubstr("expected an FMU that can be started, got fmu_base64: it has had a fatal error, after which this "
                "process must not use it"));
}

TEST_P(FmuLawOf, ThatCrashesIsNamed) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_DEATH(FlyLaw(LawWith(GetParam(), "params = { does = 1 }\n")), "the law of agent 1 crashed: SIGSEGV");
}

TEST_P(FmuLawOf, ThatHangsEndsTheProcess) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const std::string law = LawWith(GetParam(), "params = { does = 2 }\n");
  const std::string hurried = "[run]\nagent_timeout_s = 0.5\n" + Three(law).substr(std::string("[run]\n").size());
  EXPECT_DEATH(RunInProcess(Load(hurried), {}, [] { return true; }),
               "the law of agent 1 took longer than 0.8 run.agent_timeout_s = 0.4 s and cannot be interrupted");
}

// --- what is refused ---------------------------------------------------------------------------------------

TEST_P(FmuLawOf, ParametersAreCheckedByTheDescription) {
  const auto with = [&](const std::string& params) {
    return Refusal(Three(LawWith(GetParam(), "params = { " + params + " }\n")));
  };
  EXPECT_THAT(with("p_gian = 1"),
              HasSubstr("law.params.p_gian: the FMU has no parameter of this name (did you mean \"p_gain\"?)"));
  EXPECT_THAT(with("p_gain = 'x'"), HasSubstr("law.params.p_gain: expected a number, got \"x\""));
  EXPECT_THAT(with("does = 0.5"), HasSubstr("law.params.does: expected an integer that fits its type, got 0.5"));
  EXPECT_THAT(with("does = 3000000000"),
              HasSubstr("law.params.does: expected an integer that fits its type, got 3000000000"));
  EXPECT_THAT(with("label = 1"), HasSubstr("law.params.label: expected a string, got 1"));
  EXPECT_THAT(with("p_gain = [1, 2]"), HasSubstr("law.params.p_gain: expected 1 values, got 2"));
  EXPECT_THAT(with("label = 'bad'"),
              HasSubstr(fmt::format("expected an FMU that can be started, got law_fmi{0}.fmu: fmi{0}SetString: error",
                                    GetParam())));
  EXPECT_THAT(Refusal(Three(LawWith(GetParam(), "params = 3\n"))),
              HasSubstr("law.params: expected a table, got a number"));
}

TEST_P(FmuLawOf, SignalsAreChecked) {
  const auto inputs = [&](const std::string& table) {
    return Refusal(Three(LawWith(GetParam(), "[law.fmu]\ninputs = { " + table + " }\n")));
  };
  EXPECT_THAT(inputs("idd = 't'"), HasSubstr("law.fmu.inputs.idd: the FMU has no input of this name"));
  EXPECT_THAT(
      inputs("id = 'neighbour[1].wieght'"),
      HasSubstr("law.fmu.inputs.id: there is no signal 'neighbour[1].wieght' (did you mean \"neighbour[1].weight\"?)"));
  EXPECT_THAT(inputs("id = 'p'"), HasSubstr("law.fmu.inputs.id: expected a signal of 1 numbers, got p"));
  EXPECT_THAT(inputs("id = 3"),
              HasSubstr("law.fmu.inputs.id: expected the name of a signal or variable in quotes, got 3"));
  const auto outputs = [&](const std::string& table) {
    return Refusal(Three(LawWith(GetParam(), "[law.fmu]\noutputs = { " + table + " }\n")));
  };
  EXPECT_THAT(outputs("'u[1]' = 'mesage[1]'"),
              HasSubstr("the FMU has no output 'mesage[1]' (did you mean \"message[1]\"?); it has 'u"));
  EXPECT_THAT(outputs("w = 'message[1]'"), HasSubstr("the law has no output of this name"));
}

TEST_P(FmuLawOf, AnInputCannotHaveASignalAndAValue) {
  const std::string value = "params = { id = 3 }\n";
  EXPECT_EQ(Refusal(Three(LawWith(GetParam(), value))), "") << "in place of the signal of its name";
  EXPECT_THAT(Refusal(Three(LawWith(GetParam(), value + "[law.fmu]\ninputs = { id = 't' }\n"))),
              HasSubstr("input 'id' has a signal in law.fmu.inputs and a value in law.params"));
}

/// The FMU of FMI 3 with more variables, in base64.
std::string WithVariables(const std::string& xml, const std::string& from = "", const std::string& to = "") {
  return Edited(3, [&](std::map<std::string, std::string>& files) {
    std::string& description = files.at("modelDescription.xml");
    description.insert(description.find("</ModelVariables>"), xml);
    if (!from.empty()) description.replace(description.find(from), from.size(), to);
  });
}

TEST(FmuLaw, InputsMustFitTheirSignals) {
  const auto with = [](const std::string& xml, const std::string& inputs = "") {
    return Refusal(Three(WithVariables(xml) + "[law.fmu]\ninputs = { " + inputs + " }\n"));
  };
  const std::string input = " valueReference='90' causality='input' start='0'";
  EXPECT_THAT(with("<String name='a'" + input + "/>", "a = 't'"),
              HasSubstr("law.fmu.inputs.a: expected an input of numbers, got one of another type"));
  EXPECT_THAT(with("<Float64 name='a'" + input + "><Dimension start='2'/></Float64>", "'a[2]' = 't'"),
              HasSubstr("input 'a' has a signal for some of its numbers in law.fmu.inputs, and not for all"));
  EXPECT_THAT(with("<Float64 name='attitude'" + input + "><Dimension start='3'/></Float64>"),
              HasSubstr("input 'attitude' has 3 numbers, which its signal has not: give it a signal in "
                        "[law.fmu.inputs], or a value in [law.params]"));
  EXPECT_THAT(with("<Float64 name='a' valueReference='90' causality='input'/>"), HasSubstr("input 'a' is no signal: "));
  EXPECT_EQ(with("<Clock name='a' valueReference='90' causality='input'/>"), "") << "a law has none to give";
  EXPECT_THAT(Refusal(Three(LawWith(3, "[law.fmu]\ninputs = 3\n"))),
              HasSubstr("law.fmu.inputs: expected a table, got a number"));
}

TEST(FmuLaw, OutputsMustBeWhatTheLawNeeds) {
  const auto with = [](const std::string& xml, const std::string& outputs = "", const std::string& to = "u") {
    return Refusal(
        Three(WithVariables(xml, "name=\"u\"", "name=\"" + to + "\"") + "[law.fmu]\noutputs = { " + outputs + " }\n"));
  };
  const std::string output = " valueReference='90' causality='output'";
  EXPECT_THAT(with("<String name='a'" + output + "/>", "'u[1]' = 'a'"),
              HasSubstr("law.fmu.outputs.u[1]: expected numbers, got a variable of another type"));
  EXPECT_THAT(with("<Float64 name='a'" + output + "><Dimension start='4'/></Float64>", "u = 'a'"),
              HasSubstr("law.fmu.outputs.u: expected at most 3 numbers, got more"));
  EXPECT_THAT(with("<Float64 name='a'" + output + "><Dimension start='2'/></Float64>", "'u[1]' = 'a'"),
              HasSubstr("law.fmu.outputs.u[1]: expected an output of one number, got 2"));
  EXPECT_THAT(with("<Float64 name='u[1]'" + output + "/>"),
              HasSubstr("expected an FMU whose output 'u[1]' can be used, got fmu_base64: it stands for a number that "
                        "another output gives"));
  EXPECT_THAT(with("<Float64 name='message[3]'" + output + "/>"),
              HasSubstr("expected an FMU with an output for each number of the message, got fmu_base64 without "
                        "message[2]"));
  EXPECT_EQ(with("<Float64 name='u[3,1]'" + output + "/>", "u = 'v_want'", "v_want"), "") << "a column";
}

TEST(FmuLaw, SignalsHaveTheNamesThatToolsCanWrite) {
  const auto one = [](const std::string& name) {
    const auto signals = SignalsOf(name, 1);
    return signals && signals->size() == 1
               ? std::tuple(signals->front().field, signals->front().place, signals->front().element)
               : std::tuple(FmuField::kTime, std::size_t{99}, std::size_t{99});
  };
  for (const char* const name : {"p[2]", "p_y", "p.y", "p[2,1]", "p[1,2]", "p[1, 2]"})
    EXPECT_EQ(one(name), std::tuple(FmuField::kPosition, 0, 1)) << name;
  for (const char* const name : {"neighbour[3].p[2]", "neighbour3_p[2]", "neighbour_3_p[2]", "neighbour3.p_y",
                                 "neighbour.p[3,2]", "neighbour_p[3,2]", "neighbour[3].p.y"})
    EXPECT_EQ(one(name), std::tuple(FmuField::kNeighbourPosition, 2, 1)) << name;
  for (const char* const name :
       {"neighbour[3].heard", "neighbour3_heard", "neighbour.heard[3]", "neighbour_heard[1,3]"})
    EXPECT_EQ(one(name), std::tuple(FmuField::kHeard, 2, 0)) << name;
  for (const char* const name : {"q", "p[0]", "p[x]", "neighbour[0].p[1]", "neighbours.p[1,1]", "Neighbour[1].heard"})
    EXPECT_FALSE(SignalsOf(name, 1) && !SignalsOf(name, 1)->empty()) << name;
}

TEST_P(FmuLawOf, AnFmuWithoutUIsRefusedWithItsOutputs) {
  const std::string u = GetParam() == 2 ? "name=\"u[1]\"" : "name=\"u\"";
  EXPECT_THAT(
      Refusal(Three(Described(GetParam(), u, "name=\"force\""))),
      HasSubstr("expected an FMU with outputs u[1], u[2] and perhaps u[3], or those that [law.fmu.outputs] names, "
                "got fmu_base64 with 'force'"));
}

TEST_P(FmuLawOf, AnInputThatIsNearlyASignalIsRefused) {
  EXPECT_THAT(
      Refusal(Three(Described(GetParam(), "name=\"neighbour[1].heard\"", "name=\"neighbor[1].heard\""))),
      HasSubstr("input 'neighbor[1].heard' is no signal (did you mean \"neighbour[1].heard\"?): give it a signal in "
                "[law.fmu.inputs], or a value in [law.params]"));
}

TEST_P(FmuLawOf, AWrongTokenIsToldWithTheWordsOfTheFmu) {
  EXPECT_THAT(
      Refusal(Three(Described(GetParam(), "\"{law}\"", "\"{other}\""))),
      HasSubstr(GetParam() == 2
                    ? "fmi2Instantiate: no instance (guid {other}): the guid {other} is not {law}"
                    : "fmi3InstantiateCoSimulation: no instance (instantiationToken {other}): the token is not {law}"));
}

TEST_P(FmuLawOf, AStepThatDoesNotFitThePeriodIsRefused) {
  const std::string steps = "canHandleVariableCommunicationStepSize=\"true\"";
  if (GetParam() == 3) {
    EXPECT_THAT(
        Refusal(Three(Described(3, steps, "fixedInternalStepSize=\"0.003\""))),
        HasSubstr("expected an FMU whose step divides the control period 0.01 s (control.rate_hz), got fmu_base64 "
                  "with a step of 0.003 s, which it cannot vary"));
  }
  EXPECT_EQ(Refusal(Three(Described(GetParam(), steps, "fixedInternalStepSize=\"0.005\""))), "");
  EXPECT_THAT(Refusal(Three(Described(GetParam(), steps + "/>", "/><DefaultExperiment stepSize=\"0.004\"/>"))),
              HasSubstr("with a step of 0.004 s, which it cannot vary"));
}

TEST_P(FmuLawOf, ThatAProcessCanHaveOnceIsFlownByOneAgent) {
  const std::string once = Described(GetParam(), "canHandle", "canBeInstantiatedOnlyOncePerProcess=\"true\" canHandle");
  EXPECT_THAT(
      FlyLaw(once).failure,
      HasSubstr("cannot make the law of agent 2: fmu_base64: a process can have it only once "
                "(canBeInstantiatedOnlyOncePerProcess), and another agent has it: fly the experiment over DDS"));
  EXPECT_THAT(Refusal("[network]\nagents_per_process = 2\n" + Three(once)),
              HasSubstr("which says canBeInstantiatedOnlyOncePerProcess: set network.agents_per_process = 1"));
}

TEST_P(FmuLawOf, BinariesOfOtherPlatformsAreListed) {
  const auto moved = [&](const std::string& to) {
    return Refusal(Three(Edited(GetParam(), [&](std::map<std::string, std::string>& files) {
      auto library = files.extract(LibraryIn(GetParam()));
      library.key() = to;
      files.insert(std::move(library));
    })));
  };
  const std::string missing = "an FMU without " + LibraryIn(GetParam());
  EXPECT_THAT(moved("binaries/win64/law.dll"), HasSubstr(missing + "; it has binaries for win64"));
  EXPECT_THAT(moved("sources/law.c"), HasSubstr(missing + ": it has sources alone, compile it first"));
}

TEST_P(FmuLawOf, ALibraryThatCannotBeLoadedIsRefused) {
  EXPECT_THAT(
      Refusal(Three(Edited(
          GetParam(), [&](std::map<std::string, std::string>& files) { files.at(LibraryIn(GetParam())) = "a poem"; }))),
      HasSubstr("its library cannot be loaded: "));
}

TEST_P(FmuLawOf, ALibraryWithoutItsFunctionsIsRefused) {
  EXPECT_THAT(Refusal(Three(Edited(GetParam(),
                                   [&](std::map<std::string, std::string>& files) {
                                     const FmuArchive other(ReadFile(FmuFile(5 - GetParam())));
                                     std::string& library = files.at(LibraryIn(GetParam()));
                                     library = other.Read(LibraryIn(5 - GetParam()));
                                   }))),
              HasSubstr(fmt::format("its library has no function fmi{}FreeInstance", GetParam())));
}

TEST(FmuLaw, NeedsADescription) {
  EXPECT_THAT(
      Refusal(Three(Edited(3, [](std::map<std::string, std::string>& files) { files.erase("modelDescription.xml"); }))),
      HasSubstr("got fmu_base64: an archive without modelDescription.xml"));
}

TEST(FmuLaw, MayNotBeTooLargeToTravel) {
  const std::string big = Edited(3, [](std::map<std::string, std::string>& files) {
    files["resources/noise"] = test::Noise(std::size_t{8} << 20);
  });
  EXPECT_THAT(Refusal(Three(big)), HasSubstr("law.fmu_base64: expected an FMU of which this platform needs at most "
                                             "8388608 bytes, which travel with the experiment, got "));
}

TEST(FmuLaw, NeedsOneFile) {
  EXPECT_THAT(Refusal(Three("name = 'fmu'\n")), HasSubstr("law: expected one of file, fmu_base64, got none"));
  EXPECT_THAT(Refusal(Three("name = 'fmu'\nfmu_base64 = '?'\n")),
              HasSubstr("law.fmu_base64: expected base64, got other text"));
  EXPECT_THAT(Refusal(Three("name = 'fmu'\nfmu_base64 = 'AAAA'\nfile = 'x.fmu'\n")),
              HasSubstr("law.file: expected one of file, fmu_base64, got both"));
  EXPECT_THAT(Refusal(Three("name = 'fmu'\nfmu_base64 = 'AAAA'\n")),
              HasSubstr("law.fmu_base64: expected an FMU that can be flown, got fmu_base64: no zip archive: "));
  EXPECT_THAT(Refusal(Three("name = 'fmu'\nfile = '/nowhere/x.fmu'\n")),
              HasSubstr("law.file: expected a readable file, got "));
}

}  // namespace
}  // namespace mascot
