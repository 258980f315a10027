// law.name = "octave": laws in MATLAB's language. These tests need Octave.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "agent/agent.h"
#include "agent/laws/laws.h"
#include "agent/octave/octave_text.h"
#include "agent/user_code/law_output.h"
#include "system/environment.h"
#include "tests/experiment/fly_rows.h"
#include "tests/support/orchestrator.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using test::ChildOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Lines of [law] with this text; the text begins in line 12 of the experiment, with more lines in front later.
std::string InOctave(const std::string& text, const std::string& lines = "") {
  return "name = 'octave'\n" + lines + "octave = '''\n" + text + "'''\n";
}

/// A law whose function control has these statements in its third line.
std::string Control(const std::string& statements, const std::string& lines = "") {
  return InOctave("function [a, message] = control(t, me, neighbours, params)\n  a = [0 0 0]; message = [];\n  " +
                      statements + "\nend\n",
                  lines);
}

std::string RefusalOf(const std::string& law) { return Refusal(Three(law)); }

/// What the law of agent 1 wants at tick 3, 0.03 s.
Eigen::Vector3d WantsInOctave(const std::string& law) {
  const Experiment experiment = Load(Three(law));
  Agent agent(experiment, 1);
  const Others others = Standing();
  Motion self;
  self.p_WB = {0, 0, 1};
  self.v_WB = {0, 0.25, 0};
  const Command command = agent.Want(3, self, others.samples());
  return command.a_law_W;
}

/// The error of the first call of the law; empty: none.
std::string FailureOf(const std::string& law, const std::string& before = "") {
  const Experiment experiment = Load(before + Three(law).substr(before.empty() ? 0 : Three("").find("[agents]")));
  try {
    Agent(experiment, 1).Want(3, Motion{}, Standing().samples());
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// --- what control is given -----------------------------------------------------------------------------

TEST(OctaveLaw, IsGivenTheTimeItselfAndItsNeighboursAsColumns) {
  EXPECT_EQ(WantsInOctave(Control(R"(
assert(t, 0.03);
assert(isequal(me.id, 1) && isequal(me.position, [0; 0; 1]) && isequal(me.velocity, [0; 0.25; 0]));
assert(isequal(size(me.acceleration), [3 1]) && isequal(me.orientation, [1; 0; 0; 0]));
assert(isequal(size(me.angular_velocity), [3 1]) && isequal(size(me.ranges), [3 0]) && isempty(me.message));
assert(isequal(size(neighbours), [1 2]) && isequal([neighbours.id], [2 3]) && isequal([neighbours.weight], [0.5 1]));
assert(isequal([neighbours.position], [1 0; 0 2; 2 3]) && isequal(neighbours(2).velocity, [0.5; 0; 0]));
assert(isequal([neighbours.age_s], [0 0]) && isempty(neighbours(1).message) && isempty(neighbours(2).message));
assert(isequal(size(neighbours(1).orientation), [4 1]) && isequal(size(neighbours(1).angular_velocity), [3 1]));
assert(isequal(size(neighbours(1).acceleration), [3 1]));
a = [1 2 3];)",
                                  "axes = 'xyz'\n")),
            Eigen::Vector3d(1, 2, 3));
}

TEST(OctaveLaw, WithoutNeighboursIsGivenNone) {
  const Experiment experiment =
      Load(Three(Control("assert(isequal(size(neighbours), [1 0]));\nfor j = neighbours\n"
                         "error('there is one');\nend\na = [7 8];")));
  EXPECT_EQ(MakeLaw(experiment, 1)->Want_W(0, Motion{}, {}), Eigen::Vector3d(7, 8, 0));
}

TEST(OctaveLaw, IsGivenItsParametersAsAStruct) {
  EXPECT_EQ(
      WantsInOctave(Control(R"(
assert(isequal(params.gain, 0.1) && isequal(params.count, 3) && isequal(params.on, true) && islogical(params.on));
assert(isequal(params.name, "caf\303\251 'x' \"y\" \\") && isequal(params.row, [1 2.5 3]) && isempty(params.none));
assert(isequal(params.matrix, [1 2; 3 4]) && isequal(params.ragged, {[1 2], 3}) && isequal(params.words, {"a", "b"}));
assert(isequal(params.flags, [true false]) && isequal(params.inner.deep.x, 1e-300));
assert(isinf(params.infinite) && isnan(params.missing));
a = [params.gain 0];)",
                            "params = { gain = 0.1, count = 3, on = true, name = \"café 'x' \\\"y\\\" \\\\\", row = "
                            "[1, 2.5, 3], none = [], matrix = [[1, 2], [3, 4]], ragged = [[1, 2], 3], words = ['a', "
                            "'b'], flags = [true, false], inner = { deep = { x = 1e-300 } }, infinite = inf, "
                            "missing = nan }\n")),
      Eigen::Vector3d(0.1, 0, 0));
}

TEST(OctaveLaw, MayTakeNoParameters) {
  EXPECT_EQ(
      WantsInOctave(InOctave("function a = control(t, me, neighbours)\n  a = neighbours(1).position(1:2);\nend\n")),
      Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(WantsInOctave(InOctave("function varargout = control(varargin)\n  varargout = {[nargin 2], 5};\nend\n")),
            Eigen::Vector3d(4, 2, 0));
}

TEST(OctaveLaw, SeesTheNearestPointsOfObstacles) {
  const Experiment experiment = Load(Three(Control("a = me.ranges(:, 1);\nassert(isequal(size(me.ranges), [3 2]));")));
  const auto law = MakeLaw(experiment, 1);
  const Eigen::Vector3d seen[] = {{1, 2, 3}, {4, 5, 6}};
  law->See(seen);
  EXPECT_EQ(law->Want_W(0, Motion{}, {}), Eigen::Vector3d(1, 2, 3));
}

TEST(OctaveLaw, HearsMessagesAndItsOwnLast) {
  const Experiment experiment = Load(Three(
      Control("a = [numel(me.message) numel(neighbours(1).message)];\nif t > 0\nassert(isequal(me.message, [1; 2]));\n"
              "end\nmessage = [1 2];\nassert(isequal(neighbours(1).message, [8; 9; 10]));")));
  ASSERT_TRUE(experiment.law.params->sends_messages);
  const auto law = MakeLaw(experiment, 1);
  const std::vector<double> said = {8, 9, 10};
  const Heard heard[] = {{.id = 2, .weight = 1, .message = said}};
  EXPECT_EQ(law->Want_W(0, Motion{}, heard), Eigen::Vector3d(0, 3, 0));
  EXPECT_THAT(law->Message(), ::testing::ElementsAre(1, 2));
  EXPECT_EQ(law->Want_W(0.01, Motion{}, heard), Eigen::Vector3d(2, 3, 0));
  EXPECT_FALSE(Load(Three(Control("", "messages = false\n"))).law.params->sends_messages);
  EXPECT_FALSE(
      Load(Three(InOctave("function a = control(t, me, neighbours)\n  a = [0 0];\nend\n"))).law.params->sends_messages);
}

TEST(OctaveLaw, GetsParametersThatAnEventHasChangedAndKeepsWhatItRemembers) {
  const std::string law = Control(
      "persistent calls;\nif isempty(calls)\ncalls = 0;\nend\ncalls = calls + 1;\n"
      "a = [params.gain calls];",
      "params = { gain = 1 }\n");
  const Experiment experiment = Load(Three(law));
  std::string other = law;
  const Experiment changed = Load(Three(other.replace(other.find("gain = 1"), 8, "gain = 5")));
  const auto one = MakeLaw(experiment, 1), two = MakeLaw(experiment, 2);
  EXPECT_EQ(one->Want_W(0, Motion{}, {}), Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(one->Want_W(0, Motion{}, {}), Eigen::Vector3d(1, 2, 0));
  one->Adopt(changed.agent(1));
  EXPECT_EQ(one->Want_W(0, Motion{}, {}), Eigen::Vector3d(5, 3, 0));
  EXPECT_EQ(two->Want_W(0, Motion{}, {}), Eigen::Vector3d(1, 1, 0)) << "persistent variables are an agent's own";
}

TEST(OctaveLaw, DrawsNumbersThatAreItsAgentsOwnAndRepeatable) {
  const auto drawn = [](int id, const std::string& seed) {
    const Experiment experiment = Load("[run]\nduration_s = 1.0\nseed = " + seed + "\n[agents]\ncount = 3\n[law]\n" +
                                       Control("a = [rand randn rande];"));
    EXPECT_TRUE(EntryOf(experiment.law).draws(experiment.law));
    return Eigen::Vector3d(MakeLaw(experiment, id)->Want_W(0, Motion{}, {}));
  };
  EXPECT_EQ(drawn(1, "1"), drawn(1, "1"));
  EXPECT_NE(drawn(1, "1"), drawn(2, "1"));
  EXPECT_NE(drawn(1, "1"), drawn(1, "2"));
}

TEST(OctaveLaw, WantsAVelocityIfTheFileSaysSo) {
  EXPECT_EQ(WantedBy(Load(Three(Control("", "output = 'velocity'\n"))).law), Wanted::kVelocity);
  EXPECT_EQ(WantedBy(Load(Three(Control(""))).law), Wanted::kAcceleration);
}

TEST(OctaveLaw, ThatIsTheConsensusLawFliesAsThisLawDoes) {
  const auto octave =
      Fly(Three(InOctave("function a = control(t, me, neighbours, params)\n"
                         "  a = -params.beta * me.velocity;\n  for j = neighbours\n"
                         "    a = a + j.weight * params.p_gain * (j.position - me.position);\n  end\nend\n",
                         "params = { p_gain = 0.5, beta = 1.5 }\n")));
  const auto linear = Fly(Three("name = 'consensus'\np_gain = 0.5\nbeta = 1.5\n"));
  ASSERT_EQ(octave.size(), linear.size());
  for (std::size_t tick = 0; tick < octave.size(); ++tick)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_LT((octave[tick].motions[i].p_WB - linear[tick].motions[i].p_WB).norm(), 1e-12);
  EXPECT_GT((octave.back().motions[0].p_WB - octave.front().motions[0].p_WB).norm(), 0.1) << "nobody has moved";
}

// --- files ---------------------------------------------------------------------------------------------

TEST(OctaveLaw, TravelsWithTheFunctionFilesThatItCalls) {
  ScratchFolder folder;
  WriteFile(folder.File("law.m"),
            "function a = control(t, me, neighbours)\n  a = twice(local());  % see law\nend\n"
            "function x = local()\n  x = 2;\nend\n");
  WriteFile(folder.File("twice.m"), "function y = twice(x)\n  y = [add_one(x) 2];\nend\n");
  WriteFile(folder.File("add_one.m"), "function y = add_one(x)\n  y = x + 1;\nend\n");
  WriteFile(folder.File("unused.m"), "nonsense(");
  WriteFile(folder.File("run.toml"), Three("name = 'octave'\nfile = 'law.m'\n"));
  const std::string resolved = LoadExperiment(Section::FromFile(folder.File("run.toml")), "run").resolved;
  std::filesystem::remove_all(folder.path());
  const Experiment again = LoadExperiment(Section::FromText(resolved, "elsewhere.toml"), "run", /*checked=*/true);
  EXPECT_EQ(MakeLaw(again, 1)->Want_W(0, Motion{}, {}), Eigen::Vector3d(3, 2, 0));
  EXPECT_THAT(resolved, testing::Not(HasSubstr("unused")));
  EXPECT_THAT(resolved, testing::Not(HasSubstr("'law.m' =")));
  EXPECT_EQ(LoadExperiment(Section::FromText(resolved, "elsewhere.toml"), "run").resolved, resolved);
}

TEST(OctaveLaw, LeavesNoFilesBehind) {
  ScratchFolder folder;
  setenv("TMPDIR", folder.path().c_str(), 1);
  EXPECT_EQ(WantsInOctave(Control("fclose(fopen('mine.txt', 'w')); a = [1 1];")), Eigen::Vector3d(1, 1, 0));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  unsetenv("TMPDIR");
}

// --- mistakes that are found when the experiment is read --------------------------------------------------

TEST(OctaveLaw, IsRefusedWithThePlaceOfTheMistake) {
  EXPECT_THAT(RefusalOf(Control("a = (1 + ;")), StartsWith("test.toml:14:12: law.octave: expected a law for "));
  EXPECT_THAT(RefusalOf(Control("a = (1 + ;")), HasSubstr("got: syntax error"));
  EXPECT_EQ(RefusalOf(InOctave("function a = contrl(t, me, neighbours)\n  a = [0 0];\nend\n")),
            "test.toml:12:1: law.octave: expected a law for Octave, got: expected a file that begins with the "
            "function control, got another function");
  for (const char* text : {"1;\nfunction a = control(t, me, neighbours)\n  a = [0 0];\nend\n", "x = 3;\n", ""})
    EXPECT_THAT(RefusalOf(InOctave(text)),
                HasSubstr("expected a file that begins with the function control, got none"));
  EXPECT_EQ(RefusalOf(InOctave("function a = control(t, me)\n  a = [0 0];\nend\n")),
            "test.toml:12:1: law.octave: expected a = control(t, me, neighbours, params), got control with 2 "
            "inputs");
  EXPECT_EQ(RefusalOf(InOctave("function control(t, me, neighbours)\nend\n")),
            "test.toml:12:1: law.octave: expected a = control(t, me, neighbours, params), got control without an "
            "output");
  EXPECT_THAT(RefusalOf(InOctave("function a = control(t, me, n)\n  a = [0 0];\nend\n", "messages = true\n")),
              HasSubstr("law.messages: expected a law with [a, message] = control(...), got one without a message"));
  EXPECT_THAT(
      RefusalOf(InOctave("function a = control(t, me, n)\n  a = f;\nend\n", "modules = { 'f.m' = 'function (' }\n")),
      ContainsRegex("f.m:1:[0-9]+: law.octave: expected a law for Octave, got: "));
}

TEST(OctaveLaw, IsRefusedWithKeysThatDoNotFit) {
  EXPECT_THAT(RefusalOf("name = 'octave'\n"), HasSubstr("law: expected one of octave, file, got none"));
  EXPECT_THAT(RefusalOf(InOctave("", "file = 'law.m'\n")),
              HasSubstr("law.file: expected one of octave, file, got both"));
  EXPECT_THAT(RefusalOf(Control("", "params = 3\n")), HasSubstr("law.params: expected a table, got a number"));
  EXPECT_THAT(RefusalOf(Control("", "modules = 3\n")), HasSubstr("law.modules: expected a table, got a number"));
  EXPECT_THAT(RefusalOf(Control("", "modules = { 'f.m' = 3 }\n")), HasSubstr("law.modules.f.m: expected text"));
  for (const char* name : {"f", "../f.m", "in/f.m"})
    EXPECT_THAT(RefusalOf(Control("", fmt::format("modules = {{ '{}' = '' }}\n", name))),
                HasSubstr("expected the name of a file, such as saturate.m"));
}

TEST(OctaveLaw, NeedsOctave) {
  const std::string path = EnvironmentText("PATH");
  setenv("PATH", "/nonexistent", 1);
  const std::string refusal = RefusalOf(Control(""));
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(refusal,
            "folder/test.toml:11:10: law.octave: expected Octave, got no octave-cli in PATH: apt install octave");
}

// --- mistakes in flight ---------------------------------------------------------------------------------

TEST(OctaveLaw, ThatFailsSaysAgentTimeFileLineAndColumn) {
  EXPECT_EQ(FailureOf(Control("a = me.nothing;")),
            "tick 3: the law of agent 1 failed at t = 0.03 s\ntest.toml:14:5: structure has no member 'nothing'");
  EXPECT_THAT(FailureOf(Control("  error('no: %d', 3);")), HasSubstr("\ntest.toml:14:5: no: 3"));
  EXPECT_THAT(FailureOf(Control("a = f;", "modules = { 'f.m' = \"function y = f()\\n  y = x;\\nend\" }\n")),
              HasSubstr("\nf.m:2:5: 'x' undefined"));
  EXPECT_THAT(FailureOf(Control("error(\"two\\nlines\\n\\x1b[31m\");")), HasSubstr("two\\nlines\\n\\u001b[31m"));
  EXPECT_THAT(FailureOf(Control("a = me.nothing;", "octave_file = 'mine.m'\noctave_line = 7\n")),
              HasSubstr("\nmine.m:9:5: structure has no member"));
}

TEST(OctaveLaw, MustReturnTwoOrThreeFiniteNumbers) {
  const auto failure = [](const std::string& a) { return FailureOf(Control("a = " + a + ";")); };
  EXPECT_THAT(failure("[1 2 3 4]"), HasSubstr("control is 1 x 4, expected 3 numbers or 2 (x, y)"));
  EXPECT_THAT(failure("[]"), HasSubstr("control is 0 x 0, expected 3 numbers or 2 (x, y)"));
  EXPECT_THAT(failure("[1 2i 3]"), HasSubstr("control is complex, expected 3 numbers or 2 (x, y)"));
  EXPECT_THAT(failure("'abc'"), HasSubstr("control is a char, expected 3 numbers or 2 (x, y)"));
  EXPECT_THAT(failure("{1, 2}"), HasSubstr("control is a cell, expected 3 numbers or 2 (x, y)"));
  EXPECT_THAT(failure("[1 NaN 3]"), HasSubstr("control is [1 NaN 3], expected finite numbers"));
  EXPECT_EQ(FailureOf(Control("a = int8([1 2 3]);")), "");
  EXPECT_THAT(FailureOf(InOctave("function a = control(t, me, n)\nend\n")), ContainsRegex("undefined|not defined"));
  EXPECT_THAT(FailureOf(Control("message = 1:65;")),
              HasSubstr("the second output of control is 1 x 65, expected at most 64 numbers"));
  EXPECT_THAT(FailureOf(Control("message = eye(2);")), HasSubstr("is 2 x 2, expected at most 64 numbers"));
  EXPECT_THAT(FailureOf(Control("message = 'x';")), HasSubstr("is a char, expected at most 64 numbers"));
  EXPECT_EQ(FailureOf(Control("message = 1:64;")), "");
}

TEST(OctaveLaw, ThatTakesTooLongOrTooMuchIsEnded) {
  EXPECT_THAT(FailureOf(Control("while true\nend"), "[run]\nduration_s = 1.0\nagent_timeout_s = 1.0\n"),
              HasSubstr("failed at t = 0.03 s: TimeoutError: took longer than 0.8 run.agent_timeout_s = 0.8 s"));
  EXPECT_THAT(FailureOf(Control("while true\ndisp(1:100);\nend"), "[run]\nduration_s = 1.0\nagent_timeout_s = 1.0\n"),
              HasSubstr("TimeoutError: took longer"));
  EXPECT_THAT(FailureOf(Control("x = ones(1e4, 3e3);\nwhile true\nend"),
                        "[run]\nduration_s = 1.0\nagent_timeout_s = 100.0\n[control]\npython_memory_mb = 200\n"),
              HasSubstr("MemoryError: needs more than control.python_memory_mb = 200"));
}

TEST(OctaveLaw, WhoseOctaveEndsFails) {
  const std::string failed = "the law of agent 1 failed at t = 0.03 s: ";
  EXPECT_THAT(FailureOf(Control("exit(7);")), HasSubstr(failed + "Octave exited with code 7"));
  EXPECT_THAT(FailureOf(Control("kill(getpid(), 9);")), HasSubstr(failed + "Octave was killed by signal 9 (Killed)"));
  EXPECT_THAT(FailureOf(Control("to = max(fopen('all')); fwrite(to, 1e300, 'double'); fflush(to);\nwhile true\nend")),
              HasSubstr(failed + "its code has written into the pipes of Octave"));
  EXPECT_THAT(
      FailureOf(Control("fclose('all');\nwhile true\nend"), "[run]\nduration_s = 1.0\nagent_timeout_s = 10.0\n"),
      ContainsRegex("Octave|TimeoutError"));
}

TEST(OctaveLaw, WhoseOctaveIsKilledBetweenCallsFails) {
  const Experiment experiment = Load(Three(Control("")));
  const auto law = MakeLaw(experiment, 1);
  law->Want_W(0, Motion{}, {});
  const pid_t octave = ChildOf(getpid(), "mascot_driver");
  ASSERT_GT(octave, 0);
  kill(octave, SIGKILL);
  std::string failure;
  try {
    law->Want_W(0.01, Motion{}, {});
  } catch (const std::runtime_error& error) {
    failure = error.what();
  }
  EXPECT_EQ(failure, "the law of agent 1 failed at t = 0.01 s: Octave was killed by signal 9 (Killed)");
}

TEST(OctaveLaw, EndsItsOctaveWithIt) {
  const Experiment experiment = Load(Three(Control("")));
  auto law = MakeLaw(experiment, 1);
  law->AwaitStart();
  EXPECT_GT(ChildOf(getpid(), "mascot_driver"), 0);
  law.reset();
  EXPECT_EQ(ChildOf(getpid(), "mascot_driver"), 0);
}

// --- output --------------------------------------------------------------------------------------------

TEST(OctaveLaw, PrintsInWholeLinesToStandardError) {
  const std::string law = Control("disp(me.id); printf('\\x1b[31m half'); warning('careful'); a = [1 1];");
  const Experiment experiment = Load(Three(law));
  const auto printed = [&] {
    testing::internal::CaptureStderr();
    MakeLaw(experiment, 1)->Want_W(0, Motion{}, {});
    return testing::internal::GetCapturedStderr();
  };
  const std::string said = printed();
  EXPECT_THAT(said, HasSubstr("1\n"));
  EXPECT_THAT(said, HasSubstr("warning: careful\n"));
  EXPECT_THAT(said, HasSubstr("\\u001b[31m half"));
  const SuppressedLawOutput suppressed;
  EXPECT_EQ(printed(), "");
}

TEST(OctaveText, IsReadByOctaveAsItStands) {
  EXPECT_EQ(ToOctave(Value{{0.1}}), "0.10000000000000001");
  EXPECT_EQ(QuotedForOctave("a\"\n"), "\"a\\042\\012\"");
}

}  // namespace
}  // namespace mascot
