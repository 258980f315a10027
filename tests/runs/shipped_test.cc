// The shipped experiments, each run to its end in one process, compared with theory.

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "agent/laws/laws.h"
#include "bus/wire.h"
#include "orchestrator/formats/mcap/reader.h"
#include "tests/experiment/bad_config.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

/// All rows of a run, read back from its recording.
struct Flight {
  std::vector<std::vector<Motion>> motions;    // by tick, then by id - 1
  std::vector<std::vector<Command>> commands;  // by tick, then by id - 1
  nlohmann::json summary;
  double rate_hz = 100;

  explicit Flight(const std::string& config, const std::vector<std::string>& sets = {}) {
    ScratchFolder folder;
    std::vector<std::string> words{"--engine", "inprocess"};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    Up up(folder, "run", Config(config), words);
    EXPECT_EQ(up.Wait(), 0) << up.err();
    summary = up.Summary();
    const auto agents = summary["agents"].get<std::size_t>();
    motions.assign(summary["ticks"].get<std::size_t>() + 1, std::vector<Motion>(agents));
    commands.assign(motions.size(), std::vector<Command>(agents));
    ReadMcap(up.path() / "run.mcap", [&](const McapContents::Message& message) { Take(message); });
  }

  /// Takes a message. Channels are numbered in the order command 1, state 1, command 2, ..., clock.
  void Take(const McapContents::Message& message) {
    const std::size_t agent = (message.channel - 1u) / 2u;
    if (agent == motions[0].size()) return;  // the clock
    mascot_msgs::msg::AgentState state;
    mascot_msgs::msg::AgentCommand command;
    if (message.channel % 2 == 0) {
      Deserialize(message.data, state);
      motions[state.tick()][agent] = FromWire(state);
    } else {
      Deserialize(message.data, command);
      commands[command.tick()][agent] = FromWire(command);
    }
  }

  const Motion& At(std::size_t tick, int id) const { return motions[tick][static_cast<std::size_t>(id - 1)]; }
  std::size_t last() const { return motions.size() - 1; }
};

double Distance2d(const Motion& a, const Motion& b) { return (a.p_WB - b.p_WB).head<2>().norm(); }

// --- leaderless -----------------------------------------------------------------------------------------

TEST(Leaderless, DoubleIntegratorsFollowTheZeroOrderHoldRecursion) {
  const Flight flight("leaderless", {"agents.model=double_integrator"});
  const double h = 1 / flight.rate_hz;
  for (int id = 1; id <= 4; ++id) {
    Eigen::Vector3d p = flight.At(0, id).p_WB, v = flight.At(0, id).v_WB;
    for (std::size_t k = 0; k < flight.last(); ++k) {
      const Eigen::Vector3d u = flight.commands[k][static_cast<std::size_t>(id - 1)].a_limited_W;
      p += h * v + 0.5 * h * h * u;
      v += h * u;
      ASSERT_LT((flight.At(k + 1, id).p_WB - p).norm(), 2e-3) << "agent " << id << ", tick " << k + 1;
      ASSERT_LT((flight.At(k + 1, id).v_WB - v).norm(), 1e-9) << "agent " << id << ", tick " << k + 1;
    }
  }
}

TEST(Leaderless, QuadrotorsMeetAtThePredictedPoint) {
  for (int seed = 1; seed <= 3; ++seed) {
    const Flight flight("leaderless", {"run.seed=" + std::to_string(seed)});
    const auto& consensus = flight.summary["consensus"];
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (int id = 1; id <= 4; ++id) mean += flight.At(0, id).p_WB.head<2>() / 4;
    EXPECT_EQ(flight.summary["control"]["saturated_fraction"], 0.0);
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_NEAR(consensus["predicted"]["value_m"][axis].get<double>(), mean[axis], 1e-9);
      EXPECT_NEAR(consensus["value_m"][axis].get<double>(), mean[axis], 0.02);
    }
    EXPECT_LT(consensus["final_disagreement_m"].get<double>(), 0.01);
    EXPECT_LT(consensus["final_speed_m_per_s"].get<double>(), 0.01);
    EXPECT_EQ(flight.summary["safety"]["collisions"], 0);
  }
}

TEST(Leaderless, DecaysAndSettlesAsPredicted) {
  const auto consensus = Flight("leaderless").summary["consensus"];
  const double rate_per_s = consensus["predicted"]["rate_per_s"],
               settling_s = consensus["predicted"]["settling_time_s"];
  const double slowest_per_s = consensus["predicted"]["slowest_rate_per_s"];
  EXPECT_NEAR(slowest_per_s, 0.3, 0.001);  // s^2 + 0.9 s + 0.18 = (s + 0.3) (s + 0.6)
  EXPECT_NEAR(rate_per_s, slowest_per_s, 0.01 * slowest_per_s) << "from this start";
  EXPECT_NEAR(consensus["rate_per_s"].get<double>(), rate_per_s, 0.01 * rate_per_s);
  EXPECT_NEAR(consensus["settling_time_s"].get<double>(), settling_s, 0.01 * settling_s);
  EXPECT_NEAR(consensus["deviation"]["settling_time_s"].get<double>(),
              consensus["settling_time_s"].get<double>() - settling_s, 1e-9);
  EXPECT_LT(consensus["deviation"]["value_m"].get<double>(), 0.001);
}

TEST(Leaderless, QuadrotorsBehaveAsDoubleIntegratorsDo) {
  const auto fidelity = Flight("leaderless").summary["fidelity"];
  EXPECT_LT(fidelity["rms_m"].get<double>(), 0.003 * fidelity["travelled_m"].get<double>());
}

TEST(Leaderless, AnInitialVelocityMovesTheMeetingPointByItsMeanOverBeta) {
  const Flight flight("leaderless", {"agents.velocity_m_per_s=[[1,0,0],[0,1,0],[1,0,0],[0,-2,0]]"});
  Eigen::Vector2d expected = Eigen::Vector2d(0.5, -0.25) / 0.9;
  for (int id = 1; id <= 4; ++id) expected += flight.At(0, id).p_WB.head<2>() / 4;
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(flight.summary["consensus"]["predicted"]["value_m"][axis].get<double>(), expected[axis], 1e-9);
    EXPECT_NEAR(flight.summary["consensus"]["value_m"][axis].get<double>(), expected[axis], 0.02);
  }
}

// --- leader and followers -------------------------------------------------------------------------------

TEST(LeaderFollower, AllTenGatherAtTheLeader) {
  const Flight flight("leader_follower");
  for (int id = 1; id <= 10; ++id)
    EXPECT_LT(Distance2d(flight.At(flight.last(), id), flight.At(flight.last(), 4)), 0.01);
  EXPECT_LT((flight.At(flight.last(), 4).p_WB - flight.At(0, 4).p_WB).norm(), 1e-3);  // the leader has not moved
}

// --- waypoint -------------------------------------------------------------------------------------------

TEST(Waypoint, AStepOfTwentyMetresSettlesWithoutOvershoot) {
  const Flight flight("waypoint", {"law.waypoints_m=[[20, 0, 1]]"});
  std::size_t settled = 0;
  double peak = 0;
  for (std::size_t k = 0; k <= flight.last(); ++k) {
    const double x = flight.At(k, 1).p_WB.x();
    peak = std::max(peak, x);
    if (std::abs(x - 20) > 0.02 * 20) settled = k + 1;
  }
  EXPECT_LT(peak, 20 * 1.02);
  EXPECT_LT(static_cast<double>(settled) / flight.rate_hz, 12.0);
  EXPECT_LT((flight.At(flight.last(), 1).p_WB - Eigen::Vector3d(20, 0, 1)).norm(), 1e-3);  // no steady-state error
}

TEST(Waypoint, EveryWaypointIsReached) {
  const Flight flight("waypoint");
  for (const Eigen::Vector3d& waypoint : {Eigen::Vector3d(20, 0, 1), {20, 20, 3}, {0, 20, 3}, {0, 0, 1}}) {
    double nearest = 1e9;
    for (std::size_t k = 0; k <= flight.last(); ++k)
      nearest = std::min(nearest, (flight.At(k, 1).p_WB - waypoint).norm());
    EXPECT_LT(nearest, 0.2) << waypoint.transpose();
  }
  EXPECT_LT((flight.At(flight.last(), 1).p_WB - Eigen::Vector3d(0, 0, 1)).norm(), 0.02);
}

// --- min-max --------------------------------------------------------------------------------------------

/// Time (s) from which on the distance between child and parent along `axis` stays within `within_m`.
double TimeToStay(const Flight& flight, int child, int parent, int axis, double within_m) {
  std::size_t since = 0;
  for (std::size_t k = 0; k <= flight.last(); ++k)
    if (std::abs(flight.At(k, child).p_WB[axis] - flight.At(k, parent).p_WB[axis]) > within_m) since = k + 1;
  return static_cast<double>(since) / flight.rate_hz;
}

struct Case {
  double z0_m, beta_c, beta_p;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << "z0 = " << c.z0_m << " m, beta_c = " << c.beta_c << ", beta_p = " << c.beta_p << " m/s^2";
}

std::vector<std::string> TwoAgents(const Case& c, const std::string& model) {
  return {"agents.count=2", "graph.topology=path", "agents.model=" + model,
          "agents.position_m=[[0,0,1],[" + ShortestFloat(c.z0_m) + ",0,2]]",
          "law.beta=[" + ShortestFloat(c.beta_p) + "," + ShortestFloat(c.beta_c) + "]"};
}

class Minmax : public testing::TestWithParam<Case> {};

TEST_P(Minmax, AChildMeetsARestingParentInTheClosedFormsTime) {
  const Case c = GetParam();
  const double a = c.beta_c - c.beta_p;
  const double expected_s = std::sqrt(2 * c.z0_m * (1 / a + 1 / c.beta_c));
  const Flight ideal("minmax", TwoAgents(c, "double_integrator"));
  EXPECT_NEAR(ideal.summary["consensus"]["predicted"]["minmax_time_s"].get<double>(), expected_s, 1e-6);
  // TimeToStay is measured to 1 mm; the last 1 mm, braking with a, takes another sqrt(2 mm / a).
  const double ideal_s = TimeToStay(ideal, 2, 1, 0, 1e-3);
  EXPECT_NEAR(ideal_s + std::sqrt(2e-3 / a), expected_s, 0.03 * expected_s);
  const Flight quadrotors("minmax", TwoAgents(c, "quadrotor"));
  EXPECT_NEAR(TimeToStay(quadrotors, 2, 1, 0, 0.05), expected_s, 0.15 * expected_s);
  const auto consensus = quadrotors.summary["consensus"];
  EXPECT_NEAR(consensus["minmax_edges"][0]["time_s"].get<double>(), TimeToStay(quadrotors, 2, 1, 0, 0.05), 1e-9);
  EXPECT_NEAR(consensus["deviation"]["minmax_time_s"].get<double>(),
              consensus["minmax_edges"][0]["time_s"].get<double>() - expected_s, 1e-6);
}

TEST_P(Minmax, AMovingParentIsMetWithinTheBound) {
  const Case c = GetParam();
  auto sets = TwoAgents(c, "double_integrator");
  sets.push_back("law.leader_waypoints_m=[[-30,0,1]]");  // accelerates away with its full beta
  const Flight ideal("minmax", sets);
  const double bound_s = 2 * std::sqrt(c.z0_m / (c.beta_c - c.beta_p));
  EXPECT_LE(TimeToStay(ideal, 2, 1, 0, 0.02), 1.03 * bound_s);
}

INSTANTIATE_TEST_SUITE_P(Cases, Minmax, testing::Values(Case{10, 1, 0.5}, Case{5, 0.6, 0.2}, Case{16, 0.8, 0.4}),
                         NamedAsPrinted<Case>);

TEST(Minmax, ShippedQuadrotorsStayTogetherAfterwards) {
  const Flight flight("minmax");
  const double predicted_s = flight.summary["consensus"]["predicted"]["minmax_time_s"];
  double latest_s = 0;
  for (int child = 2; child <= 4; ++child)
    for (int axis = 0; axis < 2; ++axis)
      latest_s = std::max(latest_s, TimeToStay(flight, child, child - 1, axis, 0.05));
  EXPECT_LT(latest_s, 1.15 * predicted_s);
}

TEST(Minmax, SaysWhyAQuadrotorThatTremblesHasNoTime) {
  ScratchFolder folder;
  Up up(
      folder, "run", Config("minmax"),
      {"--engine", "inprocess", "--set", "agents.airframe='mascot_published'", "--set", "law.beta=[0.1,0.7,0.8,0.9]"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  const nlohmann::json consensus = up.Summary()["consensus"], edge = consensus["minmax_edges"][0];
  const nlohmann::json trembling = consensus["predicted"]["minmax_edges"][0]["trembling"];
  EXPECT_TRUE(edge["time_s"].is_null());
  EXPECT_EQ(edge["why_null"].get<std::string>().substr(0, 56),
            "agent 2 did not stay within 0.05 m of agent 1: up to 0.2");
  EXPECT_THAT(edge["why_null"],
              testing::HasSubstr("in the end; theory expects that it trembles by about 0.23 m, since it "
                                 "turns first, and so accelerates 0.26 s late"));
  EXPECT_NEAR(edge["end_m"].get<double>(), trembling["radius_m"].get<double>(), 0.05);
  EXPECT_THAT(up.out(),
              testing::ContainsRegex("caught up      not all, not for good .3 of 3 edges.: agent [234] did not"));
}

TEST(Published, FliesTheSetUpOfThePublishedTestbed) {
  const Flight flight("published");
  EXPECT_EQ(flight.summary["ticks"], 6000);
  EXPECT_EQ(flight.summary["safety"]["collisions"], 0);
  // The root rests and all agents end near it; the published run ends with chatter of 0.3 m and 0.15 m/s.
  EXPECT_LT(flight.summary["consensus"]["final_disagreement_m"].get<double>(), 0.3);
}

// --- check's warnings -----------------------------------------------------------------------------------

TEST(Check, SaysWhenAgentsShouldShareProcesses) {
  const auto check = [](const std::string& sets) {
    return Shell(BuildFolder() + "/orchestrator check " + Config("leaderless") +
                 " --set 'agents.random.max_m=[10, 10, 60]' " + sets)
        .output;
  };
  EXPECT_THAT(check("--set agents.count=33"),
              testing::HasSubstr(
                  "  processes      33 of agents over DDS; where agents share them (network.agents_per_process), "
                  "the same bytes fly faster\n"));
  EXPECT_THAT(check("--set agents.count=32"), testing::Not(testing::HasSubstr("processes")));
  EXPECT_THAT(check("--set agents.count=33 --set network.agents_per_process=2"),
              testing::Not(testing::HasSubstr("processes")));
}

TEST(Summary, OfAFlightOfOneTickHasNoShareOfNothing) {
  const ScratchFolder folder;
  const Ran run =
      Shell(BuildFolder() + "/orchestrator up " + Config("leaderless") +
            " --engine inprocess --duration-s 0.01 --set output.save_plot=false --out " + folder.File("run"));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, testing::ContainsRegex("fidelity       [0-9.e-]+ m rms from ideal double integrators, while "
                                                 "agents travelled [0-9.e-]+ m\n"));
}

TEST(Check, SaysAboutHowLargeTheFilesWillBe) {
  const ScratchFolder folder;
  for (const std::string config : {"leaderless", "coverage", "flocking"}) {
    const Ran checked = Shell(BuildFolder() + "/orchestrator check --json " + Config(config));
    const double said = nlohmann::json::parse(checked.output)["files_bytes"];
    const Ran run = Shell(BuildFolder() + "/orchestrator up " + Config(config) +
                          " --engine inprocess --quiet --set output.save_plot=false --out " + folder.File(config));
    ASSERT_EQ(run.exit_code, 0) << run.output;
    const auto size = [&](const char* name) {
      return static_cast<double>(std::filesystem::file_size(folder.File(config + "/" + name)));
    };
    const double share = said / (size("run.mcap") + size("states.npz"));
    EXPECT_GT(share, 0.7) << config;
    EXPECT_LT(share, 1.4) << config;
  }
}

TEST(Check, ShowsTheLayoutOfWhatAgentsOfAPolicyPerceive) {
  const std::string check = BuildFolder() + "/orchestrator check ";
  const std::string layout =
      "mascot observation 1: own p 3, v 3, attitude 4; 3 x (p 3, v 3, weight, heard, age, message 0)";
  EXPECT_THAT(
      Shell(check + Config("policy")).output,
      testing::HasSubstr("\n  observation    37 numbers, hash 8e254ebcb6026b10, of agents 1-4: " + layout + "\n"));
  const auto json = nlohmann::json::parse(Shell(check + "--json " + Config("policy")).output)["observations"];
  ASSERT_EQ(json.size(), 1U);
  EXPECT_EQ(json[0]["agents"], nlohmann::json({1, 2, 3, 4}));
  EXPECT_EQ(json[0]["layout"], layout);
  EXPECT_EQ(json[0]["hash"], "8e254ebcb6026b10");
  EXPECT_EQ(json[0]["numbers"], 37);
  EXPECT_EQ(json[0]["names"].size(), 37U);
  EXPECT_EQ(json[0]["names"][10], "neighbour[0].p.x");
  EXPECT_EQ(nlohmann::json::parse(Shell(check + "--json " + Config("leaderless")).output)["observations"],
            nlohmann::json::array());
  const std::string later = "--set 'law.schedule=[{ at_s = 5.0, name = \"policy\", file = \"" + SourceFolder() +
                            "/configs/policy.onnx\" }]' ";
  EXPECT_THAT(Shell(check + later + Config("leaderless")).output,
              testing::HasSubstr("\n  from 5 s       policy, no leader, axes xy\n  observation    37 numbers"));
}

TEST(Check, SaysWhatSurvivesTheFaultsOfAnExperiment) {
  const std::string check = BuildFolder() + "/orchestrator check " + Config("faults");
  const Ran said = Shell(check);
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_THAT(said.output, testing::HasSubstr("\n  losses         any one agent may be lost\n"));
  EXPECT_THAT(said.output,
              testing::HasSubstr(
                  "\n  faults         from 12 s agent 3 is lost: the others have a spanning tree\n"
                  "  faults         from 14 s no agent is lost, unheard or deaf, and none lies\n"
                  "  faults         from 30 s agent 5 lies: law formation leaves nothing out; the graph is 3-robust, "
                  "with which W-MSR would tolerate 1\n"
                  "  faults         from 40 s no agent is lost, unheard or deaf, and none lies\n"));
  const auto json = nlohmann::json::parse(Shell(check + " --json").output);
  EXPECT_EQ(json["cannot_lose"], nlohmann::json::array());
  ASSERT_EQ(json["survival"].size(), 4u);
  const nlohmann::json empty = nlohmann::json::array();
  EXPECT_EQ(json["survival"][0], nlohmann::json({{"from_s", 12.0},
                                                 {"lost", {3}},
                                                 {"unheard", empty},
                                                 {"deaf", empty},
                                                 {"liars", empty},
                                                 {"ends_run", false},
                                                 {"spanning_tree", true},
                                                 {"cut_off", empty},
                                                 {"robustness", nullptr},
                                                 {"liars_tolerated", nullptr},
                                                 {"liars_heard", 0}}));
  EXPECT_EQ(json["survival"][1]["from_s"], 14.0);
  EXPECT_EQ(json["survival"][2]["liars"], nlohmann::json({5}));
  EXPECT_EQ(json["survival"][2]["robustness"], 3);
  EXPECT_EQ(json["survival"][2]["liars_tolerated"], 1);
  EXPECT_EQ(json["survival"][2]["liars_heard"], 1);
  EXPECT_EQ(json["survival"][3]["spanning_tree"], nullptr);
  EXPECT_THAT(Shell(check + " --set graph.topology=path --set run.on_agent_loss=hold").output,
              testing::HasSubstr("\n  losses         without agent 2, 3, 4 or 5 the others have no spanning tree\n"));
}

TEST(Check, WarnsWhenTheFirstCommandWouldSaturate) {
  const Ran run = Shell(BuildFolder() + "/orchestrator check " + Config("leaderless") + " --set law.p_gain=1.0");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.output, testing::HasSubstr("control.max_acceleration_m_per_s2"));
  const Ran quiet = Shell(BuildFolder() + "/orchestrator check " + Config("leaderless"));
  EXPECT_THAT(quiet.output, testing::Not(testing::HasSubstr("warning")));
}

TEST(Check, PredictsFiniteValuesForEveryShippedExperiment) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceFolder() + "/configs")) {
    if (entry.path().extension() != ".toml") continue;
    const Ran run = Shell(BuildFolder() + "/orchestrator check --json " + entry.path().string());
    ASSERT_EQ(run.exit_code, 0) << entry.path();
    const auto check = nlohmann::json::parse(run.output);
    const auto& predicted = check["predicted"];
    for (const char* key : {"rate_per_s", "settling_time_s", "control_period_bound_s", "delay_margin_s",
                            "own_delay_margin_s", "minmax_time_s", "first_command_m_per_s2"}) {
      const auto& value = predicted.at(key);
      EXPECT_TRUE(value.is_null() || (std::isfinite(value.get<double>()) && value >= 0)) << entry.path() << " " << key;
    }
    EXPECT_NE(predicted["stable"], false) << entry.path();
    const auto& persistence = predicted["persistence"];
    EXPECT_TRUE(persistence.is_null() ||
                persistence["joint"] == (persistence["always"].get<bool>() || !persistence["window_s"].is_null()))
        << entry.path();
    const bool says_something = predicted["stable"] == true || !predicted["value_m"].is_null() ||
                                !predicted["minmax_time_s"].is_null() || !check["figures"].empty();
    EXPECT_TRUE(says_something || !predicted["silent"].is_null()) << entry.path();
    // Theory predicts when a linear team settles, or says why it does not.
    EXPECT_TRUE(predicted["stable"] != true || !predicted["settling_time_s"].is_null() ||
                !predicted["silent"].is_null())
        << entry.path();
  }
}

// --- bad configurations ---------------------------------------------------------------------------------

TEST(Check, WarnsWhenTheRunIsTooShort) {
  const Ran run = Shell(BuildFolder() + "/orchestrator check " + Config("leaderless") + " --set run.duration_s=10.0");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(
      run.output,
      testing::HasSubstr("warning: run.duration_s: the run ends after 10 s, before what theory expects at 15.34 s"));
}

TEST(BadConfig, StartsNothingAndWritesNothing) {
  for (const auto& entry : std::filesystem::directory_iterator(SourceFolder() + "/tests/bad_configs")) {
    if (entry.path().extension() != ".toml") continue;
    ScratchFolder folder;
    const std::string path = entry.path().string();
    std::string expected = ReadFile(std::filesystem::path(entry.path()).replace_extension(".expected").string());
    const std::string out = folder.File("out");
    Running up(BuildFolder() + "/orchestrator", {"up", path, "--out", out}, folder.File("up"));
    EXPECT_EQ(up.Wait(), 2) << path;
    std::string got;
    std::istringstream lines(up.err());
    for (std::string line; std::getline(lines, line); got += line + "\n") {
      ASSERT_TRUE(line.starts_with("error: ")) << line;
      line.erase(0, 7);
    }
    EXPECT_EQ(Anonymous(got, path), expected) << path;
    EXPECT_FALSE(std::filesystem::exists(out)) << path;
  }
}

// --- touch ----------------------------------------------------------------------------------------------

TEST(Touch, TheVeeFollowsItsLeaderAndWhoIsCutOffStaysBehind) {
  const auto flown = [](const std::string& events) {
    return Flight("touch", {"output.save_plot=false", "run.duration_s=40.0", "events=[" + events + "]"});
  };
  const std::string sent = "{ at_s = 15.0, goto = { agent = 1, position_m = [20.0, -10.0, 5.0] } }";
  const Flight whole = flown(sent), split = flown(sent + ", { at_s = 15.0, cut = [[4, 2]] }");
  const double step = 3 / std::sqrt(2.0);
  for (int id = 1; id <= 8; ++id) {
    const int row = id / 2, side = id % 2 == 0 ? 1 : -1;
    const Eigen::Vector3d place(20 - row * step, -10 + side * row * step, 5);
    EXPECT_LT((whole.At(whole.last(), id).p_WB - place).norm(), 0.1) << id;
    const bool is_cut_off = id == 4 || id == 6 || id == 8;
    EXPECT_EQ((split.At(split.last(), id).p_WB - place).norm() > 15, is_cut_off) << id;
  }
  for (const Flight* flight : {&whole, &split}) EXPECT_EQ(flight->summary["safety"]["collisions"], 0);
}

// --- formation, switching, custom, mixed ----------------------------------------------------------------

TEST(FormationInWind, KeepsItsDisplacementsOverABadNetwork) {
  const Flight flight("formation");
  const double radius = 2.0 / std::sin(std::numbers::pi / 12);
  double worst = 0;
  for (std::size_t tick = 2000; tick <= flight.last(); ++tick) {
    double squares = 0;
    for (int i = 0; i < 12; ++i) {
      const auto place = [&](int k) {
        const double angle = 2 * std::numbers::pi * k / 12;
        return Eigen::Vector2d(flight.At(tick, k + 1).p_WB.head<2>() -
                               radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      };
      squares += (place(i) - place((i + 1) % 12)).squaredNorm() / 12;
    }
    worst = std::max(worst, std::sqrt(squares));
  }
  EXPECT_LT(worst, 0.15);
  EXPECT_NEAR(flight.summary["links"]["lost"].get<double>() / flight.summary["links"]["sent"].get<double>(), 0.2, 0.01);
  EXPECT_LT(flight.summary["formation"]["worst_rms_m"].get<double>(), 0.15);
  EXPECT_EQ(flight.summary["safety"]["collisions"], 0);
}

TEST(FormationInWind, DecaysAsFastAsItsLossyLinksAllowOnAverage) {
  double rate_per_s = 0, predicted_per_s = 0;
  constexpr int kSeeds = 5;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const auto consensus = Flight("formation", {"run.seed=" + std::to_string(seed)}).summary["consensus"];
    EXPECT_EQ(consensus["predicted"]["on_average"], true);
    rate_per_s += consensus["rate_per_s"].get<double>() / kSeeds;
    predicted_per_s += consensus["predicted"]["rate_per_s"].get<double>() / kSeeds;
  }
  EXPECT_NEAR(rate_per_s, predicted_per_s, 0.1 * predicted_per_s);  // a gust and a limit move the last crossings
}

TEST(SwitchingGraph, StillMeetsAtTheMean) {
  const Flight flight("switching");
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int id = 1; id <= 6; ++id) mean += flight.At(0, id).p_WB.head<2>() / 6;
  for (int id = 1; id <= 6; ++id) EXPECT_LT((flight.At(flight.last(), id).p_WB.head<2>() - mean).norm(), 1e-3);
  EXPECT_LT(flight.summary["fidelity"]["rms_m"].get<double>(), 1e-9) << "single integrators are what they should be";
  EXPECT_TRUE(flight.summary["control"]["effort"].is_null()) << "velocities are commanded";
  for (const auto& row : flight.commands)
    for (const Command& command : row) ASSERT_TRUE(command.a_law_W.isZero(0) && command.a_limited_W.isZero(0));
  const auto consensus = flight.summary["consensus"];
  const double rate_per_s = consensus["predicted"]["rate_per_s"];
  EXPECT_NEAR(consensus["rate_per_s"].get<double>(), rate_per_s, 0.01 * rate_per_s);
  EXPECT_EQ(consensus["predicted"]["persistence"]["never_alone"], true);
  EXPECT_LT(consensus["deviation"]["value_m"].get<double>(), 1e-9);
  const auto schedule = flight.summary["graph"]["schedule"];
  ASSERT_EQ(schedule.size(), 2U);
  EXPECT_EQ(schedule[0]["at_s"], 0.0);
  EXPECT_EQ(schedule[1]["at_s"], 0.5);
  EXPECT_EQ(schedule[1]["edges"][0], nlohmann::json({1, 6, 1.0})) << "each of its graphs has six of the twelve edges";
  EXPECT_EQ(schedule[1]["edges"].size(), 6U);
  EXPECT_EQ(flight.summary["graph"]["edges"].size(), 12U);
}

TEST(CustomLawInPython, ChasesAroundTheCircle) {
  const Flight flight("custom");
  for (int id = 1; id <= 6; ++id) {
    const double radius = flight.At(flight.last(), id).p_WB.head<2>().norm();
    EXPECT_GT(radius, 5.0);
    EXPECT_LT(radius, 6.5);
    EXPECT_GT(flight.At(flight.last(), id).v_WB.norm(), 0.5);
  }
}

TEST(MixedTeam, FollowsItsLeaderPastTheObstacle) {
  const Flight flight("mixed");
  EXPECT_EQ(flight.summary["safety"]["collisions"], 0);
  EXPECT_GT(flight.At(flight.last(), 1).p_WB.x(), 18);
  for (int id = 2; id <= 6; ++id) EXPECT_GT(flight.At(flight.last(), id).p_WB.x(), 8) << id;
  EXPECT_NEAR(flight.At(flight.last(), 4).p_WB.z(), 0.1, 1e-9) << "rolls on the ground";
  EXPECT_GT(flight.summary["links"]["lost"], 0);
}

}  // namespace
}  // namespace mascot::test
