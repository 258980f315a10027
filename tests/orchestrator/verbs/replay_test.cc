// `orchestrator replay`: one agent's process lives through a recording; recorded samples come back on DDS.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <map>
#include <mutex>

#include "bus/bus.h"
#include "bus/cdr.h"
#include "bus/wire.h"
#include "orchestrator/formats/mcap/reader.h"
#include "tests/support/edited_recording.h"
#include "tests/support/folders.h"
#include "tests/support/intruder.h"
#include "tests/support/orchestrator.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using Json = nlohmann::json;

const std::string kReplaying = BuildFolder() + "/orchestrator";

/// Two bodies that do what the law wants, 101 ticks.
constexpr const char* kPair =
    "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [4, 2, 1]]\n"
    "[law]\nname = 'consensus'\np_gain = 0.2\nv_gain = 0.3\n";

/// Five agents on a ring that lose messages and send some; losses, faults of parts, fresh starts, and a gain by event.
constexpr const char* kRing =
    "[run]\nduration_s = 2.0\non_agent_loss = 'hold'\n[agents]\ncount = 5\n"
    "position_m = [[0, 0, 2], [4, 0, 3], [6, 4, 4], [2, 6, 5], [-2, 3, 6]]\n[graph]\ntopology = 'ring'\n"
    "[link]\nloss = 0.1\ndelay_s = 0.02\n[law]\nname = 'event_triggered'\n"
    "[[events]]\nat_s = 0.0\nfault = { agent = 5, of = 'sensor', kind = 'garbage' }\n"
    "[[events]]\nat_s = 0.5\nfault = { agent = 3, kind = 'kill' }\n"
    "[[events]]\nat_s = 0.6\nfault = { agent = 4, kind = 'hang' }\n"
    "[[events]]\nat_s = 0.7\nfault = { agent = 1, kind = 'kill', unanswered = true }\n"
    "[[events]]\nat_s = 0.8\nfault = { agent = 2, of = 'link', kind = 'delayed', delay_s = 0.1 }\n"
    "[[events]]\nat_s = 1.0\nrestart = 3\n"
    "[[events]]\nat_s = 1.2\nrestart = 1\n"
    "[[events]]\nat_s = 1.4\nrestart = 2\n";

class Replay : public testing::Test {
 protected:
  /// Flies an experiment, or one of the shipped ones. Returns the run's folder.
  std::string Fly(const std::string& toml, std::vector<std::string> more = {"--engine", "inprocess"},
                  const std::string& name = "run") {
    std::string file = toml;
    if (toml.find('\n') != toml.npos) WriteFile(file = scratch_.File(name + ".toml"), toml);
    Up up(scratch_, name, file, std::move(more));
    EXPECT_EQ(up.Wait(), 0) << up.err();
    return up.path().string();
  }
  /// Standard output and error, one behind the other.
  static Ran Of(const std::string& run, const std::string& more) {
    return Shell("'" + kReplaying + "' replay '" + run + "' --quiet " + more);
  }
  static Json JsonOf(const std::string& run, const std::string& more) {
    return Json::parse(Shell("'" + kReplaying + "' replay '" + run + "' --json " + more + " 2>/dev/null").output);
  }
  std::string File(const std::string& name) const { return scratch_.File(name); }

  ScratchFolder scratch_;
};

// --- every agent decides the same -----------------------------------------------------------------------

struct Flight {
  std::string name;
  std::string toml;  ///< an experiment, or the name of a shipped one
  int agents = 0;
  std::vector<std::string> more = {};
};

class ReplayOf : public testing::TestWithParam<std::tuple<Flight, std::string>> {
 protected:
  ScratchFolder scratch_;
};

TEST_P(ReplayOf, EveryAgentDecidesTheSameBits) {
  const auto& [flight, delivery] = GetParam();
  std::string file = Config(flight.toml);
  if (flight.toml.find('\n') != flight.toml.npos) WriteFile(file = scratch_.File("a.toml"), flight.toml);
  std::vector<std::string> words = {"--engine", "inprocess", "--set", "network.delivery=" + delivery};
  words.insert(words.end(), flight.more.begin(), flight.more.end());
  Up up(scratch_, "run", file, words);
  ASSERT_EQ(up.Wait(), 0) << up.err();
  for (int id = 1; id <= flight.agents; ++id) {
    const Ran ran =
        Shell("'" + kReplaying + "' replay '" + up.path().string() + "' --quiet --to " + std::to_string(id));
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_THAT(ran.output, HasSubstr("run.mcap: agent " + std::to_string(id) + " decides the same, bit for bit: "));
  }
}

INSTANTIATE_TEST_SUITE_P(Flights, ReplayOf,
                         testing::Combine(testing::Values(Flight{"quadrotors", "leaderless", 4, {"--duration-s", "3"}},
                                                          Flight{"events", "formation_change", 5, {}},  // and goto
                                                          Flight{"several laws", "mixed", 4, {"--duration-s", "3"}},
                                                          Flight{"Python", "custom", 4, {"--duration-s", "2"}},
                                                          Flight{"losses", kRing, 5, {}}),
                                          testing::Values("bundled", "topics")),
                         [](const auto& row) {
                           return ParamName(std::get<0>(row.param).name + " " + std::get<1>(row.param));
                         });

TEST_F(Replay, OfARunOverDdsWithSeveralAgentsInAProcess) {
  const std::string run = Fly(kRing, {"--set", "network.agents_per_process=3"});
  for (const char* id : {"1", "3", "5"}) EXPECT_EQ(Of(run, "--to " + std::string(id)).exit_code, 0);
}

TEST_F(Replay, OfARunWithCertificatesNeedsNone) {
  const std::string run = Fly(kRing, {"--set", "network.security=graph", "--set", "network.protection=sign"});
  EXPECT_EQ(JsonOf(run, "--to 3")["differing_ticks"], 0);
}

TEST_F(Replay, AnAgentThatWasLostHasAFreshProcessFromItsRestartOn) {
  const std::string run = Fly(kRing);
  const Json three = JsonOf(run, "--to 3"), one = JsonOf(run, "--to 1"), four = JsonOf(run, "--to 4");
  EXPECT_EQ(three["processes"], 2);
  EXPECT_EQ(three["lost_ticks"], 50);
  EXPECT_EQ(three["ticks"], 151);
  EXPECT_EQ(one["lost_ticks"], 51) << "the tick before the event was not answered, either";
  EXPECT_EQ(four["processes"], 1) << "it hangs to the end";
  EXPECT_EQ(four["ticks"], 60);
  EXPECT_EQ(JsonOf(run, "--to 2")["processes"], 2) << "restarted without a loss";
  EXPECT_EQ(Of(run, "--to 3").output,
            run +
                "/run.mcap: agent 3 decides the same, bit for bit: 151 ticks; it was lost at 50 others, and had 2 "
                "processes\n");
}

TEST_F(Replay, OfARunInRealTimePassesOverWhatTheAgentHasMissed) {
  const std::string run = Fly(Config("leaderless"), {"--duration-s", "1", "--set", "run.mode=realtime"});
  const Json all = JsonOf(run, "--to 2");
  EXPECT_EQ(all["differing_ticks"], 0);
  EXPECT_EQ(all["ticks"].get<int>() + all["missed_ticks"].get<int>(), 101);
}

TEST_F(Replay, OfACutRecordingGoesUpToTheCut) {
  const std::string run = Fly(Config("leaderless"), {"--engine", "inprocess", "--duration-s", "20"});
  const std::string bytes = ReadFile(run + "/run.mcap"), cut = File("cut.mcap");
  WriteFile(cut, bytes.substr(0, bytes.size() * 2 / 3));
  const Ran ran = Of(cut, "--to 1");
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.output,
              ContainsRegex("cut.mcap: agent 1 decides the same, bit for bit: [0-9]+ ticks\n.*cut.mcap: cut: "));
}

// --- decides otherwise ----------------------------------------------------------------------------------

TEST_F(Replay, AnotherGainIsLocatedWithItsTickAndSize) {
  const std::string run = Fly(std::string(kPair) + "[[events]]\nat_s = 0.4\nset = { 'law.p_gain' = 0.5 }\n");
  const Json other = JsonOf(run, "--to 1 --set law.p_gain=0.3");
  EXPECT_EQ(other["first"]["tick"], 0);
  EXPECT_EQ(other["first"]["topic"], "command");
  EXPECT_EQ(other["first"]["field"], "acceleration_wanted.x");
  EXPECT_EQ(other["ticks"], 101);
  EXPECT_EQ(other["differing_ticks"], 40) << "from the event on the gain is the same";
  const Json& wanted = other["fields"][0];
  EXPECT_EQ(wanted["field"], "acceleration_wanted");
  EXPECT_EQ(wanted["unit"], "m/s^2");
  // a_1 = p_gain (p_2 - p_1) + v_gain (v_2 - v_1): the difference is 0.1 (p_2 - p_1), whose x is 4 m at first.
  EXPECT_NEAR(wanted["first"]["difference"], 0.1 * 4, 1e-15);
  EXPECT_NEAR(wanted["first"]["recorded"], 0.2 * 4, 1e-15);
  EXPECT_EQ(wanted["largest"], wanted["first"]) << "they approach each other";
}

TEST_F(Replay, SaysInWordsFromWhereOnAnAgentDecidesOtherwise) {
  const std::string run = Fly(kPair);
  const Ran ran = Of(run, "--to 1 --set law.p_gain=0.25");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.output,
              MatchesRegex(run + "/run.mcap: agent 1 decides otherwise from tick 0 \\(0.0 s\\) on: command: "
                                 "acceleration_wanted.x is 0.8 in the recording, 1 now\n"
                                 "101 of 101 ticks differ\n"
                                 "  acceleration_wanted: at 101 ticks, first by 0.1[0-9]* m/s\\^2 "
                                 "\\(acceleration_wanted.x at 0.0 s\\), most by 0.1[0-9]* m/s\\^2 .*\n"
                                 "  acceleration_limited: .*\n  actuator: .*\n"));
}

TEST_F(Replay, AnEditedLawInPythonIsComparedFromItsFile) {
  const std::string law = "def control(t, me, neighbours):\n    return [0.5, 0.0, 0.0]\n";
  WriteFile(File("law.py"), law);
  const std::string run = Fly(
      "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [4, 2, 1]]\n"
      "[law]\nname = 'custom'\nfile = 'law.py'\n");
  EXPECT_EQ(Of(run, "--to 2 --law '" + File("law.py") + "'").exit_code, 0);
  WriteFile(File("law.py"),
            "def control(t, me, neighbours):\n    return [0.5, 0.25 if t >= 0.5 and me.id == 2 else 0.0, 0.0]\n");
  EXPECT_EQ(Of(run, "--to 2").exit_code, 0) << "the recording holds the law that flew";
  const Json two = JsonOf(run, "--to 2 --law '" + File("law.py") + "'");
  EXPECT_EQ(two["first"]["tick"], 50);
  EXPECT_EQ(two["first"]["field"], "acceleration_wanted.y");
  EXPECT_EQ(two["differing_ticks"], 51);
  EXPECT_EQ(two["fields"][0]["largest"]["difference"], 0.25);
  EXPECT_EQ(Of(run, "--to 1 --law '" + File("law.py") + "'").exit_code, 0);
}

TEST_F(Replay, AnotherMessageCounts) {
  const std::string law =
      "def control(t, me, neighbours):\n    return [0.0, 0.0, 0.0]\ndef message(me):\n    return [1.0, ";
  WriteFile(File("law.py"), law + "2.0]\n");
  const std::string run = Fly(
      "[run]\nduration_s = 0.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [4, 2, 1]]\n"
      "[law]\nname = 'custom'\nfile = 'law.py'\n");
  WriteFile(File("law.py"), law + "2.5]\n");
  const Json one = JsonOf(run, "--to 1 --law '" + File("law.py") + "'");
  EXPECT_EQ(one["first"]["topic"], "message");
  EXPECT_EQ(one["first"]["field"], "data[1]");
  EXPECT_EQ(one["differing_ticks"], 51);
  EXPECT_EQ(one["fields"][0]["first"]["difference"], 0.5);
}

TEST_F(Replay, OneByteOfARecordedCommandIsNamed) {
  const std::string run = Fly(kPair), changed = File("changed.mcap");
  CopyRecording(run + "/run.mcap", changed, [](const std::string& topic, McapContents::Message& message) {
    if (topic == "/agent_2/command" && message.sequence == 57) message.data.back() ^= 1;
    return true;
  });
  const Json two = JsonOf(changed, "--to 2");
  EXPECT_EQ(two["first"]["tick"], 57);
  EXPECT_EQ(two["first"]["field"], "acceleration_limited.z") << "the last number of a command";
  EXPECT_EQ(two["differing_ticks"], 1);
  EXPECT_EQ(Of(changed, "--to 2").exit_code, 1);
  EXPECT_EQ(Of(changed, "--to 1").exit_code, 0) << "it does not hear commands";
}

// --- what cannot be replayed ----------------------------------------------------------------------------

TEST_F(Replay, RefusesRecordingsThatLackWhatTheAgentHeard) {
  const auto refusal = [&](const std::vector<std::string>& sets, const std::string& toml = kPair) {
    std::vector<std::string> words{"--engine", "inprocess"};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    static int number = 0;
    const Ran ran = Of(Fly(toml, words, "run_" + std::to_string(++number)), "--to 1");
    EXPECT_EQ(ran.exit_code, 2);
    return ran.output;
  };
  EXPECT_THAT(
      refusal({"record.rate_hz=10"}),
      EndsWith("run.mcap: expected a recording of every tick, which the agent answers, got one of every 10 ticks "
               "(record.rate_hz)\n"));
  EXPECT_THAT(refusal({"record.topics=['/agent_1/*', '/event']"}),
              EndsWith("run.mcap: holds no /agent_2/state, which agent 1 hears: record.topics left it out\n"));
  EXPECT_THAT(refusal({"record.topics=['/agent_2/*', '/event']"}),
              EndsWith("run.mcap: holds no /agent_1/state, which is its own: record.topics left it out\n"));
  EXPECT_THAT(
      refusal({"record.topics=['*/state', '/event']"}),
      EndsWith("run.mcap: holds no /agent_1/command, with which its answers are compared: record.topics left it "
               "out\n"));
  EXPECT_THAT(refusal({"record.topics=['*/state', '*/command', '/event']"}, kRing),
              EndsWith("run.mcap: holds no /agent_2/message, which agent 1 hears: record.topics left it out\n"));
  EXPECT_THAT(refusal({"record.topics=['*/state', '*/command', '*/message']"}, kRing),
              EndsWith("run.mcap: holds no /event, which changes the run: record.topics left it out\n"));
}

TEST_F(Replay, RefusesMessagesOfARunInRealTime) {
  const std::string run = Fly(Config("event_triggered"), {"--duration-s", "0.5", "--set", "run.mode=realtime"});
  const Ran ran = Of(run, "--to 1");
  EXPECT_EQ(ran.exit_code, 2);
  EXPECT_THAT(ran.output, EndsWith("run.mcap: expected run.mode = \"lockstep\" for a law that sends messages, got "
                                   "\"realtime\": nobody has recorded when they reached agent 1\n"));
}

TEST_F(Replay, RefusesWhatDoesNotFitTheRecording) {
  const std::string run = Fly(kPair);
  const auto refusal = [&](const std::string& more) {
    const Ran ran = Of(run, more);
    EXPECT_EQ(ran.exit_code, 2) << more;
    return ran.output;
  };
  EXPECT_EQ(refusal("--to 3"), "error: --to: expected an agent of 1 to 2, got 3\n");
  EXPECT_EQ(refusal("--to 1 --set control.rate_hz=50"),
            "error: --set: control.rate_hz: expected 100, as in the recording, got 50\n");
  EXPECT_EQ(refusal("--to 1 --set run.duration_s=0.5"),
            "error: --set: run.duration_s: expected 1.0, as in the recording, got 0.5\n");
  EXPECT_THAT(refusal("--to 1 --set agents.count=1"), HasSubstr("error: "));
  EXPECT_THAT(refusal("--to 1 --set law.p_gian=1"), HasSubstr("(did you mean \"p_gain\"?)"));
  EXPECT_THAT(refusal("--to 1 --law nowhere.py"), HasSubstr("nowhere.py"));
  WriteFile(run + "/config.toml", ReadFile(run + "/config.toml") + "\n[law.safety]\ndistance_m = 1.0\n");
  EXPECT_THAT(refusal("--to 1"), HasSubstr("config.toml beside it is of another experiment: [law] safety = "));
  EXPECT_EQ(Of(run + "/run.mcap", "--to 1").exit_code, 0);
}

TEST_F(Replay, RefusesOptionsThatDoNotGoTogether) {
  const std::string run = Fly(kPair);
  const auto refusal = [&](const std::string& more) {
    const Ran ran = Of(run, more);
    EXPECT_EQ(ran.exit_code, 2) << more;
    return ran.output;
  };
  const std::string with = ": expected --to AGENT with it\n",
                    without = ": expected without --to: the agent gets the next tick when it has answered\n";
  EXPECT_EQ(refusal("--debug"), "error: --debug" + with);
  EXPECT_EQ(refusal("--agent agent"), "error: --agent" + with);
  EXPECT_EQ(refusal("--law a.py"), "error: --law" + with);
  EXPECT_EQ(refusal("--set law.p_gain=1"), "error: --set" + with);
  EXPECT_EQ(refusal("--json"), "error: --json" + with);
  EXPECT_EQ(refusal("--to 1 --speed 2"), "error: --speed" + without);
  EXPECT_EQ(refusal("--to 1 --wait-for /clock"), "error: --wait-for" + without);
  EXPECT_EQ(refusal("--to 1 --debug --agent agent"),
            "error: --debug: expected without --agent: a debugger for that program is part of its command\n");
  EXPECT_EQ(
      refusal("--wait-for /clok"),
      "error: --wait-for: expected a topic of the recording, such as /clock, got '/clok' (`orchestrator info` lists "
      "them)\n");
  for (const std::string speed : {"-1", "x", "nan", "1e9"})
    EXPECT_EQ(
        refusal("--speed " + speed),
        "error: --speed: expected recorded seconds a second, up to 1e6, or 0 or fastest: as fast as listeners take "
        "samples, got '" +
            speed + "'\n");
}

TEST_F(Replay, SaysThatThereIsNoDebugger) {
  const std::string run = Fly(kPair);
  const Ran ran =
      Shell("PATH='" + scratch_.path().string() + "' '" + kReplaying + "' replay '" + run + "' --to 1 --debug");
  EXPECT_EQ(ran.exit_code, 2);
  EXPECT_EQ(ran.output, "error: --debug: expected the debugger gdb, which is not installed (apt install gdb)\n");
}

// --- the agent's process --------------------------------------------------------------------------------

TEST_F(Replay, AnAgentThatIsKilledIsNamed) {
  const std::string run = Fly(Config("leaderless"));
  Running replay(kReplaying, {"replay", run, "--to", "2"}, File("killed"));
  pid_t agent = 0;
  ASSERT_TRUE(Until([&] { return (agent = ChildOf(replay.pid(), "/agent --id 2 ")) != 0; }));
  SignalTo(agent, SIGKILL);
  EXPECT_EQ(replay.Wait(), 1);
  EXPECT_THAT(replay.err(),
              ContainsRegex("error: (before the first tick|tick [0-9]+ \\([0-9.]+ s\\)): agent_2 was killed "
                            "by signal 9 \\(Killed\\)"));
}

TEST_F(Replay, ALawThatFailsIsNamedWithTickAndLine) {
  WriteFile(File("law.py"), "def control(t, me, neighbours):\n    return [0.0, 0.0, 0.0]\n");
  const std::string run = Fly(
      "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [4, 2, 1]]\n"
      "[law]\nname = 'custom'\nfile = 'law.py'\n");
  WriteFile(File("law.py"),
            "def control(t, me, neighbours):\n    return [0.0, 0.0, 0.0 if t < 0.3 else neighbours[7].gap]\n");
  const Ran ran = Of(run, "--to 1 --law '" + File("law.py") + "'");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.output, HasSubstr("agent 1 decides the same, bit for bit: 30 ticks\n"));
  EXPECT_THAT(ran.output, HasSubstr("error: tick 30 (0.3 s): agent_1: tick 30: the law of agent 1 failed at t = 0.3 s "
                                    "(exited with code 1)\n"));
  EXPECT_THAT(ran.output, HasSubstr("File \"law.py\", line 2, in control"));
}

TEST_F(Replay, TakesAnotherAgentProgramByACommandOfTheShell) {
  const std::string run = Fly(kRing);
  const std::string command = "env MASCOT_NOTHING=1 " + BuildFolder() + "/agent";
  EXPECT_EQ(Of(run, "--to 5 --agent '" + command + "'").exit_code, 0);
  EXPECT_EQ(JsonOf(run, "--to 3 --agent '" + command + "'")["processes"], 2);
  // A wrapper that does not become the agent, but waits for it.
  WriteFile(File("wrapper"), "#!/bin/sh\n" + BuildFolder() + "/agent \"$@\"\n");
  EXPECT_EQ(Of(run, "--to 1 --agent 'sh " + File("wrapper") + "'").exit_code, 0);
  const Ran nowhere = Of(run, "--to 1 --agent /nowhere/agent");
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.output, HasSubstr("before the first tick: agent_1 exited with code 127"));
  EXPECT_THAT(nowhere.output, HasSubstr("/nowhere/agent: not found"));
}

TEST_F(Replay, InADebuggerTheAgentStopsWhereItIsAskedTo) {
  if (Shell("gdb --version").exit_code != 0) GTEST_SKIP() << "gdb is not installed (scripts/setup --test)";
  const std::string run = Fly(kPair);
  WriteFile(File("commands"),
            "set pagination off\nbreak mascot::Agent::Want\nrun\nbacktrace 2\ndelete\ncontinue\nquit\n");
  const Ran ran = Shell("'" + kReplaying + "' replay '" + run + "' --to 1 --debug <'" + File("commands") + "'");
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, ContainsRegex("Breakpoint 1, .*mascot::Agent::Want"));
  EXPECT_THAT(ran.output, HasSubstr("mascot::AgentsOnBundles::Answer"));
  EXPECT_THAT(ran.output, HasSubstr("all of the recording is played: the comparison comes when the debugger ends"));
  EXPECT_THAT(ran.output, HasSubstr("agent 1 decides the same, bit for bit: 101 ticks"));
  WriteFile(File("commands"), "quit\n");
  const Ran quit = Shell("'" + kReplaying + "' replay '" + run + "' --to 1 --debug <'" + File("commands") + "'");
  EXPECT_EQ(quit.exit_code, 1);
  EXPECT_THAT(quit.output, HasSubstr("error: before the first tick: the debugger of agent_1 exited with code 0"));
}

// --- samples for tools that listen ----------------------------------------------------------------------

/// Hears all topics of a recording, as bytes.
class Ear {
 public:
  Ear(int domain, const McapContents& contents) : domain_(Options(domain), [] {}) {
    for (const auto& [id, channel] : contents.channels) {
      const Topic topic = Topic::Parse(channel.topic).value();
      readers_.push_back(std::make_unique<RawReader>(
          domain_, topic, [this, name = channel.topic](const RawReader::Bytes& bytes, const Sender& /*sender*/) {
            const std::lock_guard lock(mutex_);
            heard_[name].push_back(bytes);
          }));
    }
  }
  std::map<std::string, std::vector<RawReader::Bytes>> heard() {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  static DomainOptions Options(int domain) {
    DomainOptions options;
    options.domain = domain;
    options.name = "ear";
    options.loopback = true;
    return options;
  }
  std::mutex mutex_;
  std::map<std::string, std::vector<RawReader::Bytes>> heard_;
  Domain domain_;
  std::vector<std::unique_ptr<RawReader>> readers_;
};

TEST_F(Replay, AListenerHearsExactlyTheRecordedSamples) {
  const std::string run = Fly(kRing, {"--engine", "inprocess", "--set", "record.ros_types=true"});
  const McapContents contents = ReadMcap(run + "/run.mcap");
  std::map<std::string, std::vector<RawReader::Bytes>> recorded;
  ReadMcap(run + "/run.mcap", [&](const McapContents::Message& message) {
    auto& samples = recorded[contents.channels.at(message.channel).topic];
    samples.push_back(message.data);
    samples.back().resize(PaddedSize(static_cast<std::uint32_t>(message.data.size())));  // of RTPS
  });
  ASSERT_EQ(recorded.size(), 24u) << "5 of each: state, command, message, odom; and clock, event, tf, scene";
  std::vector<std::string> words{"replay", run, "--speed", "fastest"};
  for (const auto& [name, samples] : recorded) words.insert(words.end(), {"--wait-for", name});
  Running replay(kReplaying, words, File("replay"));
  ASSERT_TRUE(Until([&] { return replay.Said("waiting for somebody who listens to "); })) << replay.err();
  Ear ear(DomainOf(replay), contents);
  EXPECT_EQ(replay.Wait(), 0) << replay.err();
  EXPECT_EQ(replay.out(), run + "/run.mcap: " + std::to_string(contents.messages) + " samples of 2.0 s\n");
  const auto heard = ear.heard();
  for (const auto& [name, samples] : recorded) EXPECT_TRUE(heard.contains(name) && heard.at(name) == samples) << name;
}

TEST_F(Replay, AnotherVendorSeesWhatWasRecordedForRos) {
  const std::string program = BuildFolder() + "/cyclone_rviz";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "built without cyclonedds-dev: run scripts/setup --test";
  const std::string run = Fly(kPair, {"--engine", "inprocess", "--set", "record.ros_types=true"});
  Running replay(kReplaying, {"replay", run, "--wait-for", "/tf", "--wait-for", "/scene"}, File("replay"));
  ASSERT_TRUE(Until([&] { return replay.Said("waiting for somebody who listens to "); })) << replay.err();
  const Running rviz(program, {std::to_string(DomainOf(replay))}, File("rviz"));
  EXPECT_EQ(replay.Wait(), 0) << replay.err();
  const auto sees = [&](const std::string& what, std::size_t least) {
    return Until([&] { return CountOf("{\"" + what + "\"", rviz.out()) >= least; });
  };
  EXPECT_TRUE(sees("transforms", 100)) << "of 101: it may have come after the first\n" << rviz.out();
  EXPECT_TRUE(sees("markers", 1)) << rviz.out();
}

TEST_F(Replay, PlaysAtTheSpeedThatIsAsked) {
  const std::string run = Fly(Config("leaderless"), {"--engine", "inprocess", "--duration-s", "2"});
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(Of(run, "--speed 4").exit_code, 0);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(500));
}

TEST_F(Replay, CtrlCEndsItAndNothingIsLeft) {
  const std::string run = Fly(Config("leaderless"));
  const int domain = 87;  // no other test has it
  Running replay(kReplaying, {"replay", run, "--domain", std::to_string(domain)}, File("replay"));
  ASSERT_TRUE(Until([&] { return replay.Said("DDS domain 87 (ROS_DOMAIN_ID=87)") && replay.Said(" s\n"); }));
  const std::string ports = "ls /dev/shm | grep -c 'fastrtps_port" + std::to_string((7400 + 250 * domain) / 1000) + "'";
  EXPECT_NE(Shell(ports).output, "0\n");
  replay.Signal(SIGINT);
  EXPECT_EQ(replay.Wait(), 130);
  EXPECT_EQ(Shell(ports).output, "0\n");
  Running one(kReplaying, {"replay", run, "--to", "1", "--domain", std::to_string(domain)}, File("one"));
  ASSERT_TRUE(Until([&] { return ChildOf(one.pid(), "/agent --id 1 ") != 0; }));
  one.Signal(SIGINT);
  EXPECT_THAT(one.Wait(), testing::AnyOf(130, 0)) << "0: it had played all";
  EXPECT_EQ(Shell(ports).output, "0\n");
}

TEST_F(Replay, IsSweptAfterItWasKilled) {
  const std::string run = Fly(Config("leaderless"));
  Running replay(kReplaying, {"replay", run, "--domain", "86"}, File("replay"));
  ASSERT_TRUE(Until([&] { return replay.Said(" s\n"); }));
  const std::string ports = "ls /dev/shm | grep -c 'fastrtps_port289'";
  EXPECT_NE(Shell(ports).output, "0\n");
  replay.Signal(SIGKILL);
  EXPECT_EQ(replay.Wait(), -SIGKILL);
  EXPECT_TRUE(Until([&] { return Shell(ports).output == "0\n"; })) << "by the janitor";
}

}  // namespace
}  // namespace mascot::test
