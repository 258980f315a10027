// `orchestrator send` and `orchestrator ps`: the real programs.

#include <gmock/gmock.h>

#include <random>
#include <thread>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kRun = R"(
[run]
duration_s = 20.0
pace = 1.0
[agents]
count = 3
model = "double_integrator"
random = {}
[graph]
topology = "ring"
[law]
name = "consensus"
leader = 1
[[events]]
at_s = 1.0
set = { "law.p_gain" = 0.4 }
)";

Ran Orchestrator(const std::string& words) { return Shell("'" + BuildFolder() + "/orchestrator' " + words + " 2>&1"); }

/// A run of the file above that has begun.
class SteeredRun : public Up {
 public:
  SteeredRun(const ScratchFolder& folder, const std::string& name, std::vector<std::string> more = {})
      : Up(folder, name, Written(folder), std::move(more)) {
    EXPECT_TRUE(Until([&] { return IsOver() || HasBegun(); })) << err();
  }
  Ran Send(const std::string& words) const { return Orchestrator("send --run '" + path().string() + "' " + words); }
  /// What `ps` says of this run; null if `ps` does not list it.
  nlohmann::json Ps() const {
    for (const auto& run : nlohmann::json::parse(Orchestrator("ps --json").output))
      if (run.value("process", 0) == pid()) return run;
    return {};
  }

 private:
  static std::string Written(const ScratchFolder& folder) {
    WriteFile(folder.File("run.toml"), kRun);
    return folder.File("run.toml");
  }
  bool HasBegun() const {
    const nlohmann::json run = Ps();
    return run.is_object() && run["tick"].is_number();
  }
};

TEST(Send, SteersARunThatFliesAgainFromItsFileInBothEngines) {
  const ScratchFolder folder;
  SteeredRun run(folder, "by_hand");
  const std::string paused = run.Send("pause").output;
  ASSERT_THAT(paused, StartsWith("paused after tick "));
  const int tick = std::stoi(paused.substr(std::string("paused after tick ").size()));
  const std::string next = "tick " + std::to_string(tick + 1);
  EXPECT_THAT(run.Send("goto 1 -2 3.5 2").output, StartsWith("takes effect at " + next));
  EXPECT_THAT(run.Send("--agents 2,3 set law.beta=2 law.p_gain=0.5").output, StartsWith("takes effect at " + next));
  EXPECT_TRUE(Until([&] { return run.Ps()["tick"] == tick; })) << "it is paused";
  EXPECT_THAT(run.Send("step 4").output, StartsWith("pauses after tick " + std::to_string(tick + 4)));
  EXPECT_TRUE(Until([&] { return run.Ps()["tick"] == tick + 4; }));
  EXPECT_EQ(run.Send("pace 5").output, "5.0 simulated seconds a second\n");
  EXPECT_EQ(run.Ps()["paused"], true);
  EXPECT_THAT(run.Send("resume").output, StartsWith("goes on with tick "));
  const auto throw_in = [&run](unsigned seed) {
    std::mt19937 random(seed);
    const std::string edge = std::to_string(1 + seed) + "," + std::to_string(seed);
    for (int k = 0; k < 10; ++k) {
      const std::string number = std::to_string(random() % 10);
      const std::string words[] = {"set law.p_gain=0." + number, "goto 1 " + number + " -4 2", "cut " + edge,
                                   "mend " + edge, "event 'set = { \"link.loss\" = 0." + number + " }'"};
      const Ran ran = run.Send(words[random() % std::size(words)]);
      EXPECT_EQ(ran.exit_code, 0) << ran.output;
    }
  };
  {
    std::jthread first([&] { throw_in(1); }), second([&] { throw_in(2); });
  }
  run.Send("pace 0");
  EXPECT_EQ(run.Wait(), 0) << run.err();
  const std::string config = (run.path() / "config.toml").string();
  EXPECT_THAT(run.File("config.toml"), HasSubstr("goto = { agent = 1, position_m = [-2.0, 3.5, 2.0] }\n"));
  Up dds(folder, "dds", config, {"--set", "run.pace=0"}),
      inprocess(folder, "inprocess", config, {"--engine", "inprocess", "--set", "run.pace=0"});
  EXPECT_EQ(dds.Wait(), 0) << dds.err();
  EXPECT_EQ(inprocess.Wait(), 0) << inprocess.err();
  EXPECT_EQ(dds.File("run.mcap"), run.File("run.mcap"));
  EXPECT_EQ(inprocess.File("run.mcap"), run.File("run.mcap"));
  EXPECT_EQ(dds.Summary()["consensus"], run.Summary()["consensus"]) << "predictions too";
  EXPECT_THAT(run.File("events.csv"), HasSubstr(" by hand,\"goto = { agent = 1, position_m = [-2.0, 3.5, 2.0] }\"\n"));
  EXPECT_THAT(run.File("events.csv"), HasSubstr("\n1,1,event,1,,event "));
  EXPECT_THAT(dds.File("events.csv"), Not(HasSubstr("by hand"))) << "all are of its file";
  EXPECT_THAT(run.Info(), EndsWith("complete: yes\n"));
  EXPECT_THAT(Orchestrator("verify '" + run.path().string() + "'").output, HasSubstr("the same, bit for bit"));
}

TEST(Send, SaysWhyTheRunRefuses) {
  const ScratchFolder folder;
  SteeredRun run(folder, "run", {"--engine", "inprocess"});
  const auto refusal = [&](const std::string& words) {
    const Ran ran = run.Send(words);
    EXPECT_EQ(ran.exit_code, 1) << words;
    return ran.output;
  };
  EXPECT_EQ(refusal("goto 9 1 1 1"), "error: event by hand: goto.agent: expected an integer in [1, 3], got 9\n");
  EXPECT_EQ(refusal("set agents.count=4"),
            "error: event by hand: agents.count: expected a live key, got one that no event changes\n");
  EXPECT_EQ(refusal("set law.p_gain=-1"), "error: event by hand: law.p_gain: expected a number in [0, 1000], got -1\n");
  EXPECT_EQ(refusal("set law.p_gain=fast"),
            "error: event by hand: law.p_gain: expected a number in [0, 1000], got 'fast'\n");
  EXPECT_EQ(refusal("set beta=2"), "error: event by hand: beta: unknown key (did you mean \"law.beta\"?)\n");
  EXPECT_EQ(refusal("set 'law.p_gain=-1 # slow'"),
            "error: event by hand: law.p_gain: expected a number in [0, 1000], got -1\n");
  EXPECT_EQ(refusal("pace -1"), "error: pace: expected a number in [0, 1000], got -1.0\n");
  const auto usage = [&](const std::string& words) {
    const Ran ran = run.Send(words);
    EXPECT_EQ(ran.exit_code, 2) << words;
    return ran.output;
  };
  EXPECT_THAT(usage("wait"),
              AllOf(StartsWith("error: send: expected pause | resume | step [TICKS] | "), EndsWith(", got 'wait'\n")));
  EXPECT_THAT(usage(""),
              AllOf(StartsWith("error: send: expected pause | resume | step [TICKS] | "), EndsWith(", got nothing\n")));
  EXPECT_EQ(usage("goto 1 2"), "error: send: expected goto AGENT X Y Z, got 2 words behind it\n");
  EXPECT_EQ(usage("goto one 2 3 4"), "error: send: expected an agent's number, got 'one'\n");
  EXPECT_EQ(usage("set law.p_gain"), "error: send: expected KEY=VALUE, got 'law.p_gain'\n");
  EXPECT_EQ(usage("set law.p_gain="), "error: send: expected a TOML value after '=', got 'law.p_gain='\n");
  EXPECT_EQ(usage("set law.beta=1 law.beta=2"), "error: send: expected each key once, got 'law.beta=2'\n");
  EXPECT_EQ(usage("cut 21"), "error: send: expected an edge HEARER,HEARD, such as 2,1, got '21'\n");
  EXPECT_EQ(usage("--agents 1 pause"), "error: send: --agents: expected with set only, got it with pause\n");
  EXPECT_EQ(run.Send("stop").output, "the run stops, and its results are written\n");
  EXPECT_EQ(run.Wait(), 0) << run.err();
  const Ran over = run.Send("pause");
  EXPECT_EQ(over.exit_code, 2);
  EXPECT_THAT(over.output, StartsWith("error: send: "));
}

TEST(Send, TheConfigOfAStoppedRunRepeatsIt) {
  const ScratchFolder folder;
  SteeredRun run(folder, "stopped",
                 {"--engine", "inprocess", "--duration-s", "1000", "--set",
                  "events=[{ at_s = 0.02, cut = [[1, 2]] }, { at_s = 900.0, mend = [[1, 2]] }]"});
  EXPECT_EQ(run.Send("stop").output, "the run stops, and its results are written\n");
  EXPECT_EQ(run.Wait(), 0) << run.err();
  const std::int64_t ticks = run.Summary()["ticks"];
  const std::string config = (run.path() / "config.toml").string(), again = folder.File("again");
  const Ran repeated = Shell("'" + BuildFolder() + "/orchestrator' up '" + config +
                             "' --engine inprocess --quiet --out '" + again + "' --set output.save_plot=false");
  ASSERT_EQ(repeated.exit_code, 0) << repeated.output;
  EXPECT_EQ(nlohmann::json::parse(ReadFile(again + "/summary.json"))["ticks"], ticks);
  EXPECT_EQ(ReadFile(again + "/states.npz"), ReadFile((run.path() / "states.npz").string()));
  for (const std::string& path : {run.path().string(), again}) {
    const Ran verified = Shell("'" + BuildFolder() + "/orchestrator' verify '" + path + "'");
    EXPECT_EQ(verified.exit_code, 0) << verified.output;
  }
}

TEST(Send, WantsToKnowWhichOfSeveralRuns) {
  const ScratchFolder folder;
  SteeredRun one(folder, "one"), two(folder, "two", {"--engine", "inprocess"});
  const nlohmann::json first = one.Ps();
  EXPECT_EQ(first["folder"], one.path().string());
  EXPECT_EQ(first["name"], "run");
  EXPECT_EQ(first["engine"], "dds");
  EXPECT_EQ(first["page"], nullptr);
  EXPECT_EQ(first["agents"], 3);
  EXPECT_EQ(two.Ps()["domain"], nullptr);
  EXPECT_THAT(Orchestrator("ps").output, AllOf(HasSubstr(one.path().string()), HasSubstr(two.path().string())));
  const Ran several = Orchestrator("send pause");
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_THAT(several.output,
              AllOf(StartsWith("error: send: several runs are alive; --run DIR or --domain D says which:"),
                    HasSubstr(one.path().string()), HasSubstr(two.path().string())));
  const std::string domain = std::to_string(first["domain"].get<int>());
  EXPECT_EQ(Orchestrator("send --domain " + domain + " pause").exit_code, 0);
  EXPECT_EQ(one.Ps()["paused"], true);
  EXPECT_EQ(two.Ps()["paused"], false);
  const Ran none = Orchestrator("send --domain 99 pause");
  EXPECT_EQ(none.exit_code, 2);
  // Beside runs of others, one of which may not answer just now.
  EXPECT_THAT(none.output, AnyOf(StartsWith("error: send: that run is not alive; these are:\n  "),
                                 StartsWith("error: send: that run is not among those that answer; alive are:\n  ")));
  // A paused run ends in order when it is interrupted.
  one.Signal(SIGINT);
  EXPECT_EQ(one.Wait(), 130) << one.err();
  EXPECT_THAT(one.Info(), HasSubstr("the run ended early"));
}

TEST(Send, ToARunThatIsStoppedSaysSo) {
  const ScratchFolder folder;
  SteeredRun run(folder, "stopped", {"--engine", "inprocess"});
  run.Signal(SIGSTOP);
  ASSERT_TRUE(Until([&] { return run.Ps()["state"] == "stopped"; }));
  const std::string lets_it_go_on = "stopped; `kill -CONT " + std::to_string(run.pid()) + "` lets it go on\n";
  EXPECT_THAT(Orchestrator("ps").output, HasSubstr(std::to_string(run.pid()) + " "));
  EXPECT_THAT(Orchestrator("ps").output, HasSubstr(lets_it_go_on));
  EXPECT_THAT(run.Send("pause").output, HasSubstr("send: that run is not among those that answer; alive are:"));
  EXPECT_THAT(run.Send("pause").output, HasSubstr("process " + std::to_string(run.pid()) + ", which is stopped"));
  run.Signal(SIGCONT);
  EXPECT_THAT(run.Send("pause").output, StartsWith("paused after tick "));
}

}  // namespace
}  // namespace mascot::test
