// Laws in shared libraries, with the libraries of tests/plugins.
#include <gmock/gmock.h>

#include "agent/agent.h"
#include "agent/laws/laws.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"
#include "tests/support/three_agents.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

std::string Library(const std::string& name) { return test::BuildFolder() + "/tests/plugins/lib" + name + ".so"; }

/// An experiment with the plug-in `name`: lines 10 and 11 of [law]; `lines` follow.
std::string Plugin(const std::string& name, const std::string& lines = "") {
  return Three("name = 'plugin'\nlibrary = '" + Library(name) + "'\n" + lines);
}
std::string Mirror(const std::string& params, const std::string& lines = "") {
  return Plugin("mirror", "params = { " + params + " }\n" + lines);
}

/// The command of agent 1 at tick 3.
Command FirstCommand(const std::string& toml) {
  Experiment experiment = Load(toml);
  Motion self;
  self.p_WB = {0, 0, 1};
  self.v_WB = {0, 0.25, 0};
  return Agent(experiment, 1).Want(3, self, Standing().samples());
}

// --- inputs and outputs -----------------------------------------------------------------------------

TEST(PluginLaw, SeesItselfAndItsNeighbours) {
  EXPECT_EQ(FirstCommand(Plugin("mirror")).a_law_W, Eigen::Vector3d(0.5, 2 - 0.25, 0)) << "sum a_ij (p_j - p_i) - v_i";
}

TEST(PluginLaw, SeesObstaclesWithinTheRange) {
  const std::string obstacle =
      "[[physics.obstacles]]\nshape = 'box'\nposition_m = [0, 7, 1]\nsize_m = [2, 4, 2]\n[sensors]\nrange_m = 6.0\n";
  EXPECT_EQ(FirstCommand(Mirror("does = 'feel'", "axes = 'xyz'\n")).a_law_W, Eigen::Vector3d(0, 0, 0)) << "none";
  EXPECT_EQ(FirstCommand(obstacle + Mirror("does = 'feel'", "axes = 'xyz'\n")).a_law_W, Eigen::Vector3d(0, 5, 1));
}

TEST(PluginLaw, GetsItsParameters) {
  EXPECT_EQ(FirstCommand(Mirror("gain = 2")).a_law_W, Eigen::Vector3d(1, 4 - 0.25, 0));
  EXPECT_EQ(FirstCommand(Mirror("bonus = 1")).a_law_W, Eigen::Vector3d(1, 4 - 0.25, 0));
  EXPECT_EQ(FirstCommand(Mirror("gain = 0.5, more_gains = [1, 0.5], times = 2")).a_law_W,
            Eigen::Vector3d(2, 8 - 0.25, 0));
}

TEST(PluginLaw, KnowsItsAgent) {
  const std::string tell = Mirror("does = 'tell'", "leader = 2\naxes = 'xyz'\n");
  EXPECT_EQ(FirstCommand(tell).a_law_W, Eigen::Vector3d(1 + 30 + 200, 100, 1))
      << "id, agents, leader; control rate; seed";
}

TEST(PluginLaw, MayWantAVelocity) {
  EXPECT_EQ(FirstCommand(Mirror("velocity = true, gain = 0.5")).a_law_W, Eigen::Vector3d(0.5, 2 - 0.5, 0))
      << "k_v = 2 times (v* - v), v* = [0.25, 1, 0]";
}

TEST(PluginLaw, SendsMessagesIfItOverridesMessage) {
  Experiment experiment = Load(Plugin("talker"));
  EXPECT_TRUE(experiment.agent(1).sends_messages);
  EXPECT_FALSE(Load(Plugin("mirror")).agent(1).sends_messages);
  EXPECT_FALSE(Load(Plugin("talker", "messages = false\n")).agent(1).sends_messages);
  Agent agent(experiment, 1);
  Others others = Standing();
  others.said = {4, 5};
  agent.Want(0, Motion{}, others.samples());
  EXPECT_THAT(std::vector(agent.message().begin(), agent.message().end()), ElementsAre(1.09, 1.09));
}

TEST(PluginLaw, MayBeOneAgentsOwn) {
  const std::string toml =
      Three("name = 'consensus'\n",
            "[[agents.override]]\nid = 2\nlaw = { name = 'plugin', library = '" + Library("talker") + "' }\n");
  Experiment experiment = Load(toml);
  EXPECT_FALSE(experiment.agent(1).sends_messages);
  EXPECT_TRUE(experiment.agent(2).sends_messages);
  EXPECT_GT(Agent(experiment, 2).Want(0, Motion{}, {}).a_law_W.x(), 0);
}

// --- where its file is ------------------------------------------------------------------------------

TEST(PluginLaw, IsLookedForBesideTheFileAndItsResolvedPathIsAbsolute) {
  ScratchFolder folder;
  std::filesystem::copy_file(Library("mirror"), folder.File("liblaw.so"));
  WriteFile(folder.File("run.toml"), Three("name = 'plugin'\nlibrary = './liblaw.so'\n"));
  Section document = Section::FromFile(folder.File("run.toml"));
  LoadExperiment(document, "run");
  const std::string path = (std::filesystem::canonical(folder.path()) / "liblaw.so").string();
  EXPECT_THAT(document.Resolved(), HasSubstr("\nlibrary = \"" + path + "\"\nparams = {}\nmessages = false\n"));
  Experiment again = LoadExperiment(Section::FromText(document.Resolved(), "elsewhere.toml"), "run", /*checked=*/true);
  EXPECT_EQ(Agent(again, 3).Want(0, Motion{}, {}).a_law_W, Eigen::Vector3d::Zero());
}

TEST(PluginLaw, ThatIsGoneWhereItIsFlownNamesAgentPathAndReason) {
  const std::string resolved = Three("name = 'plugin'\nlibrary = '/nowhere/liblaw.so'\nmessages = false\n");
  Experiment elsewhere = LoadExperiment(Section::FromText(resolved, "run"), "run", /*checked=*/true);
  EXPECT_THAT([&] { Agent(elsewhere, 2); },
              ThrowsMessage<std::runtime_error>(
                  "cannot make the law of agent 2: expected a shared library, got /nowhere/liblaw.so: No such file or "
                  "directory (every host that flies it needs the same library at the same path)"));
}

// --- mistakes at check: the library -----------------------------------------------------------------

const std::string kAtLibrary = "folder/test.toml:11:11: law.library: ";

TEST(PluginLaw, ThatIsNotAFileIsRefused) {
  const auto with = [](const std::string& path) {
    return Refusal(Three("name = 'plugin'\nlibrary = '" + path + "'\n"));
  };
  EXPECT_EQ(with("/nowhere/liblaw.so"),
            kAtLibrary + "expected a shared library, got /nowhere/liblaw.so: No such file or directory");
  EXPECT_EQ(with("/dev/null"), kAtLibrary + "expected a shared library, got /dev/null: not a regular file");
  EXPECT_EQ(with(""), kAtLibrary + "expected the path of a file, got ''");
  EXPECT_EQ(Refusal(Three("name = 'plugin'\n")),
            "folder/test.toml:9:1: law.library: expected the path of a file, got nothing");
}

TEST(PluginLaw, ThatIsNotASharedLibraryIsRefused) {
  ScratchFolder folder;
  const auto with = [&](const std::string& bytes) {
    const std::string path = (std::filesystem::canonical(folder.path()) / "law.so").string();
    WriteFile(path, bytes);
    std::string refusal = Refusal(Three("name = 'plugin'\nlibrary = '" + path + "'\n"));
    return refusal.replace(refusal.find(path), path.size(), "PATH");
  };
  EXPECT_EQ(with("class MyLaw {};\n"), kAtLibrary + "expected a shared library, got PATH: file too short");
  EXPECT_EQ(with(std::string(4096, 'x')), kAtLibrary + "expected a shared library, got PATH: invalid ELF header");
}

TEST(PluginLaw, WithAnUndefinedSymbolIsRefusedAtOnce) {
  EXPECT_EQ(Refusal(Plugin("unfinished")), kAtLibrary + "expected a shared library, got " + Library("unfinished") +
                                               ": undefined symbol: mascot_test_gain_that_nobody_defines");
}

TEST(PluginLaw, ThatExportsNoLawIsRefused) {
  EXPECT_EQ(Refusal(Plugin("lawless")), kAtLibrary +
                                            "expected a library that exports mascot_plugin_law (by MASCOT_PLUGIN_LAW), "
                                            "got " +
                                            Library("lawless") + " without it");
}

TEST(PluginLaw, OfAnotherInterfaceIsRefused) {
  EXPECT_EQ(Refusal(Plugin("later")), kAtLibrary + "expected a library of law interface 3, got " + Library("later") +
                                          " of interface 4 (compile it against the headers of this MASCOT)");
}

TEST(PluginLaw, OfAnEarlierInterfaceIsRefused) {
  EXPECT_EQ(Refusal(Plugin("earlier")), kAtLibrary + "expected a library of law interface 3, got " +
                                            Library("earlier") +
                                            " of interface 1 (compile it against the headers of this MASCOT)");
}

TEST(PluginLaw, WithAnotherMemoryLayoutIsRefused) {
  EXPECT_EQ(
      Refusal(Plugin("mirror_aligned")),
      kAtLibrary + "expected a library compiled as this program was, got " + Library("mirror_aligned") +
          " with EIGEN_MAX_STATIC_ALIGN_BYTES = 32 (here 16), sizeof(Motion) = 160 (here 144), alignof(Motion) = 32 "
          "(here 16), sizeof(Heard) = 224 (here 192); -march=native and -mavx change Eigen's alignment: leave "
          "them out or add -DEIGEN_MAX_STATIC_ALIGN_BYTES=16");
}

TEST(PluginLaw, OfAnotherStandardLibraryIsRefused) {
  EXPECT_THAT(Refusal(Plugin("mirror_debug")),
              AllOf(HasSubstr(Library("mirror_debug") + " with _GLIBCXX_DEBUG = 1 (here 0), sizeof(PluginParams) = "),
                    Not(HasSubstr("Eigen"))));
}

// --- mistakes at check: its parameters --------------------------------------------------------------

TEST(PluginLaw, SaysWhatItRefusesAtItsPlace) {
  const std::string at = "folder/test.toml:12:";
  EXPECT_EQ(Refusal(Mirror("gain = 'fast'")), at + "19: law.params.gain: expected a number in [0, 10], got 'fast'");
  EXPECT_EQ(Refusal(Mirror("gain = 10.5")), at + "19: law.params.gain: expected a number in [0, 10], got 10.5");
  EXPECT_EQ(Refusal(Mirror("gain = nan")), at + "19: law.params.gain: expected a number in [0, 10], got nan");
  EXPECT_EQ(Refusal(Mirror("velocity = 1")), at + "23: law.params.velocity: expected true or false, got 1");
  EXPECT_EQ(Refusal(Mirror("does = [1, 2]")), at + "19: law.params.does: expected a string, got a list of 2");
  EXPECT_EQ(Refusal(Mirror("times = 1.0")), at + "20: law.params.times: expected an integer in [1, 9], got 1");
  EXPECT_EQ(Refusal(Mirror("times = 10")), at + "20: law.params.times: expected an integer in [1, 9], got 10");
  EXPECT_EQ(Refusal(Mirror("more_gains = { a = 1 }")),
            at + "25: law.params.more_gains: expected a list of numbers, got a table");
  EXPECT_EQ(Refusal(Mirror("more_gains = [1, false]")),
            at + "25: law.params.more_gains[1]: expected a number in [0, 10], got false");
  EXPECT_EQ(Refusal(Mirror("gian = 1")), at + "19: law.params.gian: unknown key (did you mean \"gain\"?)");
  EXPECT_EQ(Refusal(Mirror("colour = 1")), at + "21: law.params.colour: unknown key");
  EXPECT_EQ(Refusal(Plugin("mirror", "params = 3\n")), at + "10: law.params: expected a table, got a number");
}

TEST(PluginLaw, MayRefuseInWordsOfItsOwn) {
  EXPECT_EQ(Refusal(Mirror("does = 'refuse'")),
            "folder/test.toml:12:10: law.params: expected what the law takes, got: gains and\\nmass do not fit");
}

TEST(PluginLaw, IsAskedForEveryAgent) {
  EXPECT_EQ(Refusal(Mirror("does = 'refuse 2'")),
            "folder/test.toml:12:19: law.params.does: expected a law for 2, got none");
  EXPECT_EQ(Refusal(Three("name = 'plugin'\nlibrary = '" + Library("mirror") + "'\n",
                          "[[agents.override]]\nid = 2\nlaw = { params = { does = 'refuse 2' } }\n")),
            "folder/test.toml:9:27: agents.override[0].law.params.does: expected a law for 2, got none");
  EXPECT_EQ(Refusal(Three("name = 'plugin'\nlibrary = '" + Library("mirror") + "'\n",
                          "[[agents.override]]\nid = 1\nlaw = { params = { does = 'refuse 2' } }\n")),
            "");
}

TEST(PluginLaw, ThatCannotBeMadeIsAMistakeToo) {
  EXPECT_EQ(Refusal(Mirror("does = 'break'")),
            kAtLibrary + "expected a law of agent 1, got an exception: no map for agent 1");
  EXPECT_EQ(Refusal(Mirror("does = 'break oddly'")),
            kAtLibrary + "expected a law of agent 1, got an exception: it threw something that is no std::exception");
}

TEST(PluginLaw, RefusesToSendMessagesThatItDoesNotDefine) {
  EXPECT_EQ(Refusal(Plugin("mirror", "messages = true\n")),
            "folder/test.toml:12:12: law.messages: expected a law that overrides Message(), got none");
}

// --- mistakes while it runs -------------------------------------------------------------------------

TEST(PluginLaw, ThatThrowsInFlightEndsTheRunWithAgentAndTime) {
  EXPECT_THAT([] { FirstCommand(Mirror("does = 'throw'")); },
              ThrowsMessage<std::runtime_error>("tick 3: the law of agent 1 failed at t = 0.03 s: the map ends here"));
  EXPECT_THAT([] { FirstCommand(Mirror("does = 'throw oddly'")); },
              ThrowsMessage<std::runtime_error>(
                  "tick 3: the law of agent 1 failed at t = 0.03 s: it threw something that is no std::exception"));
}

TEST(PluginLaw, ThatReturnsNanEndsTheRunWithAgentAndTick) {
  EXPECT_THAT([] { FirstCommand(Mirror("does = 'nan'")); },
              ThrowsMessage<std::runtime_error>("tick 3: agent 1: the law's acceleration is not finite (0, nan, 0)"));
  EXPECT_THAT([] { FirstCommand(Mirror("does = 'nan', velocity = true")); },
              ThrowsMessage<std::runtime_error>("tick 3: agent 1: the law's velocity is not finite (0, nan, 0)"));
}

TEST(PluginLaw, ThatSaysTooMuchEndsTheRun) {
  EXPECT_NO_THROW(FirstCommand(Plugin("talker", "params = { words = 64 }\n")));
  EXPECT_THAT(
      [] { FirstCommand(Plugin("talker", "params = { words = 65 }\n")); },
      ThrowsMessage<std::runtime_error>(
          "tick 3: the law of agent 1 failed at t = 0.03 s: Message() returned 65 numbers, expected at most 64"));
}

}  // namespace
}  // namespace mascot
