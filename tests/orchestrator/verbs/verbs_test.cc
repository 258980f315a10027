#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "agent/laws/laws.h"
#include "bus/qos.h"
#include "experiment/airframe.h"
#include "experiment/read_experiment.h"
#include "orchestrator/verbs/verb.h"
#include "physics_server/model.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;
using SetUpVerb = std::function<int()>(CLI::App& command);

/// Standard output while this object lives.
class Captured {
 public:
  Captured() { ::testing::internal::CaptureStdout(); }
  ~Captured() {
    if (!is_taken_) (void)::testing::internal::GetCapturedStdout();
  }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;
  std::string Text() {
    is_taken_ = true;
    return ::testing::internal::GetCapturedStdout();
  }

 private:
  bool is_taken_ = false;
};

/// Output of a verb; checks that it returns 0. Throws what the verb throws.
std::string Printed(SetUpVerb* set_up, std::vector<std::string> args) {
  CLI::App app;
  const auto run = set_up(app);
  std::reverse(args.begin(), args.end());  // CLI11 expects them in reverse order
  app.parse(args);
  Captured captured;
  EXPECT_EQ(run(), 0);
  return captured.Text();
}

class Verbs : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() /
        ("mascot-" + std::to_string(getpid()) + "-" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    std::ofstream(path()) << "[run]\nduration_s = 40.0\n[agents]\ncount = 4\n"
                             "position_m = [[-1, 1, 1], [-1, -1, 2], [1, -1, 3], [1, 1, 4]]\n"
                             "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\n";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string path() const { return (folder_ / "four agents.toml").string(); }

 private:
  std::filesystem::path folder_;
};

TEST_F(Verbs, CheckSaysWhatTheExperimentIsAndWhatTheoryExpects) {
  const std::string text = Printed(SetUpCheck, {path()});
  EXPECT_THAT(text, AllOf(HasSubstr(path() + ": valid\n"), HasSubstr("  experiment     four agents\n"),
                          HasSubstr("  agents         4 quadrotor\n"),
                          HasSubstr("  law            consensus, no leader, axes xy\n"),
                          HasSubstr("  duration       40 s, 4000 ticks at 100 Hz\n"),
                          HasSubstr("  starts         x -1.0 to 1.0 m, y -1.0 to 1.0 m, z 1.0 to 4.0 m\n"),
                          HasSubstr("  files          about 5.9 MB: recording 3.2 MB, states.npz 2.7 MB\n")));
  EXPECT_THAT(text, AllOf(HasSubstr("  graph          6 edges, symmetric\n"), HasSubstr("  lambda_2       0.585786\n"),
                          HasSubstr("  components     1 strongly connected\n"), HasSubstr("  roots          1-4\n"),
                          HasSubstr("  stable         yes\n"), HasSubstr("  first command  2 m/s^2 of 3 allowed\n"),
                          HasSubstr("  settles in     ")));
}

TEST_F(Verbs, CheckSaysWhatKeepsFilesSmall) {
  const auto files = [&](const std::vector<std::string>& sets) {
    std::vector<std::string> words{path()};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    const std::string text = Printed(SetUpCheck, words);
    const std::size_t at = text.find("  files ");
    return text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_EQ(files({"output.save_data=false"}), "  files          about 3.2 MB");
  EXPECT_EQ(files({"record.topics=[]"}), "  files          about 2.7 MB");
  EXPECT_EQ(files({"record.topics=[]", "output.save_data=false"}),
            "  files          none of the states (output.save_data, record.topics)");
  EXPECT_EQ(files({"agents.model=single_integrator", "output.save_data=false"}), "  files          about 1.6 MB");
  EXPECT_EQ(
      files({"run.duration_s=4000"}),
      "  files          about 589 MB: recording 320 MB, states.npz 269 MB; output.save_data = false leaves out the "
      "latter, which `export` makes of the recording; record.rate_hz makes both smaller");
  EXPECT_EQ(files({"run.duration_s=4000", "output.save_data=false"}),
            "  files          about 320 MB; record.rate_hz makes it smaller");
  EXPECT_EQ(files({"run.duration_s=4000", "record.rate_hz=10"}),
            "  files          about 59 MB: recording 32 MB, states.npz 27 MB");
  EXPECT_EQ(files({"output.save_data=false", "record.ros_types=true"}), "  files          about 4.9 MB");
}

TEST_F(Verbs, CheckTakesTheOptionsOfARun) {
  EXPECT_THAT(Printed(SetUpCheck, {path(), "--duration-s", "10", "--set", "run.duration_s=20"}),
              HasSubstr("  duration       10 s, 1000 ticks at 100 Hz\n"));
  const auto predicted = [](const std::string& seed) {
    const std::string config = test::SourceFolder() + "/configs/leaderless.toml";
    return Json::parse(Printed(SetUpCheck, {config, "--json", "--seed", seed}))["predicted"]["value_m"];
  };
  EXPECT_EQ(predicted("3"), predicted("3"));
  EXPECT_NE(predicted("3"), predicted("4"));
}

TEST_F(Verbs, CheckPrintsWarningsAfterItsFacts) {
  EXPECT_THAT(Printed(SetUpCheck, {path(), "--set", "law.beta=0.0"}),
              HasSubstr("\nwarning: law.beta: unstable, it must be above 0, got 0\n"));
}

TEST_F(Verbs, CheckSaysWhichDelaysAreInEffect) {
  const std::vector<std::string> late = {path(),
                                         "--set",
                                         "link.delay_s=0.025",
                                         "--set",
                                         "link.override=[{ edges = [[1, 2]], jitter_s = 0.012 }]",
                                         "--set",
                                         "sensors.own.delay_s=0.02"};
  const std::string text = Printed(SetUpCheck, late);
  EXPECT_THAT(text, HasSubstr("  delay in use   link.delay_s = 0.025 s -+ 0.012 s is 2 to 4 ticks, 0.02 to 0.04 s\n"
                              "  delay in use   link.delay_s = 0.025 s is 3 ticks, 0.03 s\n"
                              "  delay in use   sensors.own.delay_s = 0.02 s is 2 ticks, 0.02 s\n"));
  EXPECT_THAT(Printed(SetUpCheck, {path()}), Not(HasSubstr("in use")));
  std::vector<std::string> as_json = late;
  as_json.push_back("--json");
  const Json delays = Json::parse(Printed(SetUpCheck, as_json))["delays"];
  EXPECT_EQ(delays.size(), 3u);
  EXPECT_EQ(delays[0], (Json{{"key", "link.delay_s"}, {"asked_s", 0.025}, {"least_s", 0.02}, {"most_s", 0.04}}));
}

TEST_F(Verbs, CheckSaysWhatThePredictedSettlingTimeIsOf) {
  EXPECT_THAT(Printed(SetUpCheck, {path()}), HasSubstr(" s (2 %, from this start)\n"));
  // A run that is too long to be flown ahead, and far below the limits.
  const std::vector<std::string> long_run = {path(),
                                             "--set",
                                             "run.duration_s=50000",
                                             "--set",
                                             "agents.position_m=[[0, 0, 1], [0.1, 0, 2], [0, 0, 3], [0, 0, 4]]",
                                             "--set",
                                             "law.beta=2.0"};
  EXPECT_THAT(Printed(SetUpCheck, long_run), HasSubstr(" s (2 %, slowest mode)\n"));
  std::vector<std::string> chain = long_run;
  chain.insert(chain.end(), {"--set", "graph.topology='directed_ring'"});
  EXPECT_THAT(Printed(SetUpCheck, chain), HasSubstr(" s (2 %, slowest mode; later along chains)\n"));
  const std::string together = "agents.position_m=[[0, 0, 1], [0, 0, 2], [0, 0, 3], [0, 0, 4]]";
  EXPECT_THAT(Printed(SetUpCheck, {path(), "--set", together}), Not(HasSubstr("settles in"))) << "they agree already";
}

TEST_F(Verbs, CheckPrintsTheSameAsJson) {
  const Json json = Json::parse(Printed(SetUpCheck, {path(), "--json"}));
  EXPECT_EQ(json["experiment"], "four agents");
  EXPECT_EQ(json["ticks"], 4000);
  EXPECT_EQ(json["models"]["quadrotor"], 4);
  EXPECT_EQ(json["graph"]["edges"], 6);
  EXPECT_NEAR(json["graph"]["lambda_2"].get<double>(), 2 - std::sqrt(2), 1e-12);
  EXPECT_EQ(json["graph"]["spanning_tree"], (std::vector<int>{0, 1, 2, 3}));
  EXPECT_NEAR(json["predicted"]["value_m"][2].get<double>(), 2.5, 1e-12);
  EXPECT_TRUE(json["predicted"]["minmax_time_s"].is_null());
  EXPECT_TRUE(json["warnings"].empty());
}

TEST_F(Verbs, CheckSaysHowLongPeriodsAndDelaysMayBe) {
  EXPECT_THAT(Printed(SetUpCheck, {path()}), AllOf(HasSubstr(" 1/s (from this start; slowest mode 0.4939)\n"),
                                                   HasSubstr("  control period below 0.5858 s (now 0.01 s)\n"),
                                                   HasSubstr("  delay          of neighbours' samples: below "),
                                                   HasSubstr("; of these and the own: below ")));
  const Json json = Json::parse(Printed(SetUpCheck, {path(), "--json"}))["predicted"];
  EXPECT_NEAR(json["control_period_bound_s"].get<double>(), 2 / (2 + std::sqrt(2)), 1e-9);
  EXPECT_EQ(json["delay_independent"], false);
  EXPECT_GT(json["delay_margin_s"], 0);
  EXPECT_GT(json["own_delay_margin_s"], 0);
  EXPECT_TRUE(json["silent"].is_null());
  EXPECT_EQ(json["on_average"], false);
}

TEST_F(Verbs, CheckSaysWhenTheGraphHasASpanningTree) {
  const std::vector<std::string> turns = {path(), "--set", "graph.repeat_s=1.0", "--set",
                                          "graph.schedule=[{ at_s = 0.4, edges = [] }]"};
  EXPECT_THAT(Printed(SetUpCheck, turns),
              AllOf(HasSubstr("  graph          6 edges, symmetric, in the union of 2 graphs\n"),
                    HasSubstr("  spanning tree  in the union of any 0.61 s\n")));
  std::vector<std::string> as_json = turns;
  as_json.push_back("--json");
  const Json json = Json::parse(Printed(SetUpCheck, as_json))["predicted"]["persistence"];
  EXPECT_EQ(json["joint"], true);
  EXPECT_EQ(json["always"], false);
  EXPECT_EQ(json["never_alone"], false);
  EXPECT_NEAR(json["window_s"].get<double>(), 0.61, 1e-12);
  EXPECT_TRUE(json["from_s"].is_null());
  EXPECT_TRUE(json["in_range_at_start"].is_null());
}

TEST_F(Verbs, CheckSaysWhyTheoryIsSilent) {
  EXPECT_THAT(
      Printed(SetUpCheck, {path(), "--set", "graph.range_m=100.0"}),
      AllOf(HasSubstr("  spanning tree  at every time, and within range at the start\n"),
            HasSubstr(
                "  theory         silent, because graph.range_m: which agents hear which depends on where they go\n")));
}

TEST_F(Verbs, CheckTimesTheEdgesOfMinMax) {
  const std::string text = Printed(SetUpCheck, {path(), "--set", "law.name='minmax'", "--set", "law.leader=1", "--set",
                                                "law.beta=[0.5, 1, 2, 2.5]"});
  EXPECT_THAT(text,
              AllOf(HasSubstr("  edge 2 -> 1    meets in 3.464 s; with a lag of 0.091 s it trembles by 0.023 m, within "
                              "0.046 m from 2.978 s on\n"),
                    HasSubstr("  edge 4 -> 3    meets within 4 s\n")));
}

TEST_F(Verbs, SetReplacesKeysAndLeavesTheNextArgumentAlone) {
  EXPECT_THAT(Printed(SetUpCheck, {"--set", "run.duration_s=1.0", path()}), HasSubstr("1 s, 100 ticks"));
}

TEST_F(Verbs, SetWithoutAKeyOrValueIsAMistake) {
  for (const std::string wrong : {"law.beta", "=3", "law.beta="}) {
    try {
      Printed(SetUpGraph, {path(), "--set", wrong});
      ADD_FAILURE() << wrong;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.what(), "--set: expected key=value (such as law.p_gain=0.5), got '" + wrong + "'");
    }
  }
}

TEST_F(Verbs, GraphPrintsMatricesAndWhatTheyImply) {
  const std::string text = Printed(SetUpGraph, {path(), "--set", "graph.topology='directed_ring'"});
  EXPECT_THAT(text, AllOf(HasSubstr("4 agents, 4 edges, directed\n"), HasSubstr("laplacian\n"),
                          HasSubstr("components     {1-4}\n"), HasSubstr("roots          1-4\n"),
                          HasSubstr("spanning tree  root 1; follows:")));
  EXPECT_THAT(
      Printed(SetUpGraph, {path()}),
      AllOf(HasSubstr("adjacency (row i: the agents that agent i hears)\n  0 1 0 0\n  1 0 1 0\n  0 1 0 1\n  0 0 1 0\n"),
            HasSubstr("laplacian\n   1 -1  0  0\n  -1  2 -1  0\n   0 -1  2 -1\n   0  0 -1  1\n"),
            HasSubstr("eigenvalues of the laplacian\n  0 0.585786 2 3.41421\n"), HasSubstr("lambda_2       0.585786\n"),
            HasSubstr("follows: 2->1 3->2 4->3\n")));
}

TEST_F(Verbs, GraphSaysWhatIsMissingInADisconnectedGraph) {
  // graph.edges with --set would contradict the topology in the file, so that the file is rewritten.
  std::ofstream(path()) << "[run]\nduration_s = 1.0\n[agents]\ncount = 4\n"
                           "[graph]\nedges = [[1, 2], [2, 1], [4, 3]]\n";
  EXPECT_THAT(Printed(SetUpGraph, {path()}),
              AllOf(HasSubstr("components     {1-2} {3} {4}\n"), HasSubstr("roots          none\n"),
                    HasSubstr("spanning tree  none\n")));
}

TEST_F(Verbs, GraphPrintsTheSameAsJson) {
  const Json json = Json::parse(Printed(SetUpGraph, {path(), "--json"}));
  EXPECT_EQ(json["laplacian"][1], (std::vector<double>{-1, 2, -1, 0}));
  EXPECT_EQ(json["adjacency"][1], (std::vector<double>{1, 0, 1, 0}));
  EXPECT_NEAR(json["eigenvalues"][3][0].get<double>(), 2 + std::sqrt(2), 1e-12);
  EXPECT_EQ(json["components"], Json({{1, 2, 3, 4}}));
  EXPECT_EQ(json["tree_root"], 1);
}

TEST_F(Verbs, GraphThatChangesSaysWhenItsEdgesWork) {
  std::ofstream(path()) << "[run]\nduration_s = 1.0\n[agents]\ncount = 3\n"
                           "[graph]\nedges = [[1, 2, 0.5]]\nrepeat_s = 1.0\nrange_m = 15.0\n"
                           "[[graph.schedule]]\nat_s = 0.5\nedges = [[2, 3]]\n";
  const std::string when = "union of 2 graphs that take turns, from 0, 0.5 s, again every 1 s; edges work within 15 m";
  EXPECT_THAT(Printed(SetUpGraph, {path()}), HasSubstr("3 agents, 2 edges, directed\n" + when + "\nadjacency"));
  EXPECT_THAT(Printed(SetUpGraph, {path(), "--dot"}), HasSubstr("\n  label=\"" + when + "\"\n"));
  const Json json = Json::parse(Printed(SetUpGraph, {path(), "--json"}));
  EXPECT_EQ(json["schedule"], Json::parse(R"([{"at_s": 0.0, "edges": [[1, 2, 0.5]]},
                                              {"at_s": 0.5, "edges": [[2, 3, 1.0]]}])"));
  EXPECT_EQ(json["repeat_s"], 1.0);
  EXPECT_EQ(json["range_m"], 15.0);
  EXPECT_THAT(Printed(SetUpGraph, {path(), "--set", "graph={ range_m = 2.5 }"}),
              HasSubstr("symmetric\nedges work within 2.5 m\n"));
}

TEST_F(Verbs, GraphDrawsItselfForGraphviz) {
  EXPECT_THAT(Printed(SetUpGraph, {path(), "--dot", "--set", "law.leader=2"}),
              AllOf(HasSubstr("\ngraph {\n"), HasSubstr("\n  2 [shape=doublecircle]\n"),
                    HasSubstr("\n  1 -- 2\n  2 -- 3\n  3 -- 4\n}\n")));
  EXPECT_THAT(Printed(SetUpGraph, {path(), "--dot", "--set", "graph.topology='directed_ring'"}),
              HasSubstr("\ndigraph {\n"));
  EXPECT_THAT(
      [&] {
        Printed(SetUpGraph, {path(), "--dot", "--json"});
      },
      ::testing::ThrowsMessage<CLI::ParseError>("--json excludes --dot"));
}

TEST(Check, SaysThatTopicsAreSlower) {
  const auto checked = [](const std::string& delivery) {
    ScratchFolder folder;
    WriteFile(folder.File("a.toml"), "run.duration_s = 1\nagents.count = 3\nnetwork.delivery = '" + delivery + "'\n");
    return Printed(SetUpCheck, {folder.File("a.toml")});
  };
  EXPECT_THAT(
      checked("topics"),
      HasSubstr("warning: network.delivery: \"topics\" is for tools that listen to them; \"auto\" is faster\n"));
  for (const char* delivery : {"auto", "bundled"})
    EXPECT_THAT(checked(delivery), ::testing::Not(HasSubstr("network.delivery")));
}

TEST(Check, SaysWhichEdgesCertificatesAllowForLater) {
  ScratchFolder folder;
  const std::string file = folder.File("a.toml");
  WriteFile(file,
            "run.duration_s = 5\nagents.count = 3\nnetwork.security = 'graph'\n[graph]\nedges = [[1, 2]]\n"
            "[[graph.schedule]]\nat_s = 1.0\nedges = [[1, 2], [2, 3], [3, 1]]\n");
  EXPECT_THAT(Printed(SetUpCheck, {file}),
              HasSubstr("security       certificates allow 3 edges, 2 of them for later: 2 hears 3, 3 hears 1\n"));
  const auto json = nlohmann::json::parse(Printed(SetUpCheck, {file, "--json"}));
  EXPECT_EQ(json["security"],
            nlohmann::json::parse(R"({"protection": "none", "edges": 3, "edges_for_later": [[2, 3], [3, 1]]})"));
  WriteFile(file, "run.duration_s = 5\nagents.count = 3\n");
  EXPECT_TRUE(nlohmann::json::parse(Printed(SetUpCheck, {file, "--json"}))["security"].is_null());
}

TEST(Tables, LawsShowEveryLawWithEquationAndEveryParameter) {
  // Long texts are wrapped: compare them with spaces in place of line breaks.
  const auto words = [](const std::string& text) { return std::regex_replace(text, std::regex("\\s+"), " "); };
  const std::string text = words(Printed(SetUpLaws, {}));
  for (const LawEntry& law : Laws()) {
    EXPECT_THAT(text, AllOf(HasSubstr(std::string(law.name)), HasSubstr(words(std::string(law.equation)))));
    for (const Key& parameter : law.parameters) EXPECT_THAT(text, HasSubstr(std::string(parameter.meaning)));
    for (const LawFigure& figure : law.figures) EXPECT_THAT(text, HasSubstr(std::string(figure.meaning)));
  }
  EXPECT_THAT(text, AllOf(HasSubstr(" goals_m~* "), HasSubstr(" p_gain~ = 1.0 ")));
  const Json json = Json::parse(Printed(SetUpLaws, {"--json"}));
  ASSERT_EQ(json.size(), Laws().size());
  EXPECT_EQ(json[1]["name"], "waypoint");
  EXPECT_EQ(json[1]["axes"], "xyz");
  EXPECT_EQ(json[1]["parameters"][0]["required"], false) << "each agent may have its own";
  EXPECT_EQ(json[1]["parameters"][1]["default"], 1.0);
}

TEST(Tables, LawsShowOneLawIfItIsNamed) {
  const std::string text = Printed(SetUpLaws, {"finite_time"});
  EXPECT_THAT(text, AllOf(StartsWith("finite_time\n"), HasSubstr("    agreement_time_s               from which on"),
                          ::testing::Not(HasSubstr("minmax"))));
  EXPECT_EQ(Json::parse(Printed(SetUpLaws, {"minmax", "--json"})).size(), 1u);
  EXPECT_THAT([] { Printed(SetUpLaws, {"finitetime"}); },
              testing::ThrowsMessage<ConfigError>(
                  "laws: expected the name of a law, got 'finitetime' (did you mean \"finite_time\"?)"));
}

TEST(Tables, AreWithin80Columns) {
  for (const std::string& text : {Printed(SetUpLaws, {}), Printed(SetUpAirframes, {}), Printed(SetUpKeys, {})}) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), 80u) << line;
      EXPECT_FALSE(line.ends_with(' ')) << line;
    }
  }
}

TEST(Tables, AirframesShowOneIfItIsNamed) {
  const std::string text = Printed(SetUpAirframes, {"crazyflie"});
  EXPECT_THAT(text, AllOf(StartsWith("crazyflie\n"), ::testing::Not(HasSubstr("mascot\n"))));
  EXPECT_THAT([] { Printed(SetUpAirframes, {"crazyfly"}); },
              testing::ThrowsMessage<ConfigError>(
                  "airframes: expected the name of an airframe, got 'crazyfly' (did you mean \"crazyflie\"?)"));
}

TEST(Keys, ShowThoseThatBeginAsAsked) {
  const std::string text = Printed(SetUpKeys, {"agents.random.h"});
  EXPECT_EQ(text,
            "agents.random.heading           true | false; default false\n"
            "    whether each agent starts with a random yaw\n");
  EXPECT_THAT(Printed(SetUpKeys, {"law.beta"}),
              AllOf(HasSubstr("    damping of the agent's own velocity; of consensus, formation\n"),
                    HasSubstr("    dynamic: how fast the memory decays; of event_triggered\n")));
  EXPECT_EQ(Printed(SetUpKeys, {"law.bet", "--names"}), "law.beta\n") << "each name once";
  EXPECT_THAT([] { Printed(SetUpKeys, {"agents.randm"}); },
              testing::ThrowsMessage<ConfigError>(
                  "keys: expected the beginning of a key, got 'agents.randm' (did you mean \"agents.random\"?)"));
}

TEST(Keys, AreThoseThatTheReaderTakes) {
  const Json keys = Json::parse(Printed(SetUpKeys, {"--json"}));
  std::size_t parameters = 0;
  for (const LawEntry& law : Laws()) parameters += law.parameters.size();
  std::size_t listed = 0;
  for (const Json& key : keys) listed += key["laws"].size();
  EXPECT_EQ(listed, parameters) << "each parameter of each law, once";
}

TEST(Runs, ListsRemovesAndKeepsNotes) {
  ScratchFolder scratch;
  const std::string run = scratch.File("runs/a/b");
  std::filesystem::create_directories(run);
  WriteFile(run + "/config.toml", "format = 1\n[run]\nname = 'a'\n");
  WriteFile(run + "/summary.json", R"({"sim_s": 1.5, "exit": 130})");
  EXPECT_EQ(Printed(SetUpRuns, {run, "--note", "stopped by hand"}), "");
  const std::string text = Printed(SetUpRuns, {scratch.File("runs")});
  EXPECT_THAT(text, AllOf(StartsWith("written              name                 flown     size  exit  folder\n"),
                          HasSubstr("  a                    1.5 s     "),
                          HasSubstr(" B   130  " + run + "  # stopped by hand\n")));
  const Json json = Json::parse(Printed(SetUpRuns, {scratch.File("runs"), "--json"}));
  EXPECT_EQ(json[0]["exit"], 130);
  EXPECT_EQ(json[0]["note"], "stopped by hand");
  std::filesystem::create_directories(scratch.File("empty"));
  EXPECT_EQ(Printed(SetUpRuns, {scratch.File("empty")}), "no run in " + scratch.File("empty") + "\n");
  EXPECT_THAT(
      [&] {
        Printed(SetUpRuns, {"--remove", run});
      },
      testing::ThrowsMessage<ConfigError>(HasSubstr("which no run has made")))
      << "it has no recording";
}

TEST(New, WritesAnExperimentOfEachLawThatIsShipped) {
  ScratchFolder folder;
  for (const LawEntry& law : Laws()) {
    const std::string file = folder.File(std::string(law.name) + ".toml");
    const auto write = [&] { return Printed(SetUpNew, {std::string(law.name), file}); };
    if (law.name == "plugin" || law.name == "fmu" || law.is_driven) {
      EXPECT_THAT(write, testing::ThrowsMessage<std::runtime_error>(HasSubstr("shows " + std::string(law.name))));
      continue;
    }
    EXPECT_EQ(write(),
              file + ": an experiment with " + std::string(law.name) + "; next: orchestrator up " + file + "\n");
    EXPECT_EQ(LoadExperiment(Section::FromFile(file), "e").law.name, law.name);
    for (const Key& parameter : law.parameters)
      EXPECT_THAT(ReadRegularFile(file), HasSubstr(std::string(parameter.name))) << law.name;
    EXPECT_THAT(write, testing::ThrowsMessage<ConfigError>(
                           file + ": expected a new file, got one that exists (--force replaces it)"));
    EXPECT_NO_THROW(Printed(SetUpNew, {std::string(law.name), file, "--force"}));
  }
  const std::string message =
      folder.File("policy.onnx") + ": expected a new file, got one that exists (--force replaces it)";
  EXPECT_THAT(
      [&] {
        Printed(SetUpNew, {"policy", folder.File("other.toml")});
      },
      testing::ThrowsMessage<ConfigError>(message));
  EXPECT_FALSE(std::filesystem::exists(folder.File("other.toml"))) << "both files, or none";
  EXPECT_THAT([] { Printed(SetUpNew, {"consensu"}); },
              testing::ThrowsMessage<ConfigError>(
                  "new: expected the name of a law, got 'consensu' (did you mean \"consensus\"?)"));
}

TEST(Tables, ModelsShowEveryModelWithItsActuators) {
  const std::string text = Printed(SetUpModels, {});
  for (const ModelTraits& model : Models())
    EXPECT_THAT(text, AllOf(HasSubstr(std::string(model.name)), HasSubstr(std::string(model.actuator))));
  EXPECT_EQ(Json::parse(Printed(SetUpModels, {"--json"})).size(), Models().size());
}

TEST(Tables, AirframesShowEveryAirframeWithItsKeysAndWhatFollowsFromThem) {
  const std::string text = Printed(SetUpAirframes, {});
  for (const Airframe& airframe : Airframes())
    EXPECT_THAT(text, HasSubstr(airframe.name + "\n  keys of a table of your own: airframe = { base = \"" +
                                airframe.name + "\", ... }\n"));
  EXPECT_THAT(text, AllOf(HasSubstr("    mass_kg = 1.477 "), HasSubstr("    size_m = [0.7, 0.7, 0.12] "),
                          HasSubstr("    altitude = { kp = 25.0, kd = 10.0 }\n"),
                          HasSubstr("    hover_rotor_speed_rad_per_s = 549.4\n")));
  const Json json = Json::parse(Printed(SetUpAirframes, {"--json"}));
  ASSERT_EQ(json.size(), Airframes().size());
  EXPECT_EQ(json[2]["name"], "crazyflie");
  EXPECT_EQ(json[2]["attitude"]["kp"], 100.0);
  // Four rotors at the hover speed carry the weight.
  const double hover_rad_per_s = json[2]["derived"]["hover_rotor_speed_rad_per_s"], lift_n_s2 = json[2]["lift_n_s2"];
  EXPECT_NEAR(4 * lift_n_s2 * hover_rad_per_s * hover_rad_per_s, 0.027 * 9.81, 1e-12);
  EXPECT_NEAR(json[2]["derived"]["thrust_to_weight"].get<double>(), 0.6 / (0.027 * 9.81), 1e-12);
}

TEST(Tables, EveryKeyThatAirframesShowsIsOneThatATableMayHave) {
  const Json json = Json::parse(Printed(SetUpAirframes, {"--json"}));
  std::string table = "[agents.airframe]\nbase = 'crazyflie'\n";
  std::set<std::string> keys;
  for (const auto& [key, value] : json[0].items()) {
    if (key == "derived") continue;
    keys.insert(key);
    if (value.is_object())
      table += key + " = { kp = " + value["kp"].dump() + ", kd = " + value["kd"].dump() + " }\n";
    else
      table += key + " = " + value.dump() + "\n";
  }
  Section document = Section::FromText(table, "x.toml");
  document.Use(ExperimentKeys());
  Section agents = document.Child("agents");
  const Airframe body = ReadAirframe(agents, "airframe");
  agents.Done();
  document.ThrowIfWrong();
  EXPECT_EQ(body.name, json[0]["name"]);
  EXPECT_EQ(body.attitude.kd, json[0]["attitude"]["kd"]);
  // No key is missing: the resolved document contains every key that reading asks for.
  std::istringstream resolved(document.Resolved());
  for (std::string line; std::getline(resolved, line);) {
    const std::string key = line.substr(0, line.find(" = "));
    if (key == line || key == "base" || key == "kp" || key == "kd") continue;
    EXPECT_TRUE(keys.contains(key)) << line;
  }
}

TEST(Names, OfTransportsThatAnExperimentMayUseAreThoseOfTheBus) {
  const auto network = std::ranges::find(ExperimentKeys(), "network", &Key::name);
  const auto transport = std::ranges::find(network->keys, "transport", &Key::name);
  EXPECT_THAT(TransportNames(), ElementsAreArray(transport->names.begin(), transport->names.end()));
}

}  // namespace
}  // namespace mascot
