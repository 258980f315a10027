// Runs in which agents have vehicles: real processes, with autopilots that are programs of ours (tests/fakes).

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/fakes.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Vehicles : public ::testing::Test {
 protected:
  /// Three agents, those of `real` with vehicles. `keys`: more of [[vehicles]].
  std::string Team(const std::string& real, const std::string& keys, double duration_s = 3,
                   const std::string& run = "") {
    WriteFile(folder_.File("team.toml"),
              "[run]\nmode = 'realtime'\nagent_timeout_s = 2.0\nduration_s = " + std::to_string(duration_s) + "\n" +
                  run +
                  "[agents]\ncount = 3\nmodel = 'double_integrator'\n"
                  "position_m = [[0.0, 0.0, 0.8], [4.0, 0.0, 0.8], [0.0, 4.0, 0.8]]\n[graph]\ntopology = 'complete'\n"
                  "[law]\nname = 'consensus'\np_gain = 0.05\nv_gain = 1.0\n[control]\nmax_acceleration_m_per_s2 = "
                  "0.5\n[output]\nsave_plot = false\n"
                  "[[vehicles]]\nagents = " +
                  real + "\ndomain = " + std::to_string(airfield_.domain()) +
                  "\naddress = '127.0.0.1'\ntakeoff_m = 0.5\n" + keys);
    return folder_.File("team.toml");
  }
  Up Fly(const std::string& team, const std::vector<std::string>& more = {"--go"}) {
    return Up(folder_, "run", team, more);
  }
  static Ran Orchestrator(const std::string& words) { return Shell("'" + BuildFolder() + "/orchestrator' " + words); }
  Ran Check(const std::string& team) { return Orchestrator("check '" + team + "' --vehicles"); }

  ScratchFolder folder_;
  Airfield airfield_{folder_};
};

const std::string kPx4 = "kind = 'px4'\n";
constexpr double kEndless = 1000;  // s

/// The file at the top of docs/vehicles.md, and the vehicles of its dry run.
TEST_F(Vehicles, OfTheirPageFlyAndKeepApart) {
  const std::string page = ReadFile(SourceFolder() + "/docs/vehicles.md"), begin = "```toml\n";
  const std::size_t from = page.find(begin) + begin.size();
  WriteFile(folder_.File("team.toml"), page.substr(from, page.find("```", from) - from));
  for (const char* words : {"--namespace px4_1 --system-id 2 --place 4,0,0 &", "--place 0,4,0 --release 1.18 &"})
    EXPECT_THAT(page, HasSubstr(words));
  airfield_.AddPx4(1, "4,0,0");
  airfield_.AddPx4(2, "0,4,0", {"--release", "1.18"});
  Up up = Fly(folder_.File("team.toml"),
              {"--go", "--set", "output.save_plot=false", "--set",
               "vehicles=[{ agents = [1, 2], kind = 'px4', address = '127.0.0.1', domain = " +
                   std::to_string(airfield_.domain()) + ", fence = [[-2, -2, 0], [6, 6, 3]] }]"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_EQ(up.Summary()["safety"]["collisions"], 0);
  EXPECT_GT(up.Summary()["safety"]["min_separation_m"], 1.0);
  for (const char* vehicle : {"1", "2"})
    EXPECT_THAT(up.err(), HasSubstr(std::string("vehicle ") + vehicle + ": landed"));
}

TEST_F(Vehicles, TakeOffFlyAndLand) {
  airfield_.AddPx4(1, "0,0,0");
  airfield_.AddPx4(2, "4,0,0", {"--release", "1.18"});
  Up up = Fly(Team("[1, 2]", kPx4));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  for (const char* words :
       {"vehicle 1: found: PX4 1.16 or 1.17", "vehicle 2: found: PX4 1.18", "vehicle 1: streaming", "vehicle 1: armed",
        "vehicle 1: taking off: to its start, [0.00, 0.00, 0.80]", "vehicle 1: ready", "vehicle 1: flying",
        "vehicle 2: landing: the run is over", "vehicle 2: landed"}) {
    EXPECT_THAT(up.err(), HasSubstr(words));
  }
  EXPECT_THAT(up.File("events.csv"), AllOf(HasSubstr("vehicle"), HasSubstr("flying"), HasSubstr("landed")));
  EXPECT_TRUE(airfield_.at(1).Said("disarmed"));
  for (const int k : {0, 1}) {
    const nlohmann::json vehicle = up.Summary().at("vehicles").at(static_cast<std::size_t>(k));
    EXPECT_EQ(vehicle.at("agent"), k + 1);
    EXPECT_EQ(vehicle.at("kind"), "px4");
    EXPECT_GE(vehicle.at("gap").at("flying").at("s"), 2.0);
    const Ran replayed = Orchestrator(fmt::format("replay '{}' --to {}", up.path().string(), k + 1));
    EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
    EXPECT_THAT(replayed.output, HasSubstr("decides the same, bit for bit: 301 ticks"));
  }
  EXPECT_THAT(up.out(), HasSubstr("m rms from its ideal body, "));
}

TEST_F(Vehicles, OfFourReleasesMeetWhereIdealBodiesMeet) {
  const char* releases[] = {"1.15", "1.16", "1.17", "1.18"};
  const char* places[] = {"0,0,0", "2,0,0", "2,2,0", "0,2,0"};
  for (int agent = 1; agent <= 4; ++agent)
    airfield_.AddPx4(agent, places[agent - 1], {"--release", releases[agent - 1]});
  WriteFile(
      folder_.File("meet.toml"),
      "[run]\nmode = 'realtime'\nagent_timeout_s = 2.0\nduration_s = 15.0\n[agents]\ncount = 4\n"
      "model = 'double_integrator'\nposition_m = [[0.0, 0.0, 0.8], [2.0, 0.0, 0.8], [2.0, 2.0, 0.8], "
      "[0.0, 2.0, 0.8]]\n[graph]\ntopology = 'complete'\n[law]\nname = 'consensus'\np_gain = 0.1\nv_gain = 0.5\n"
      "[output]\nsave_plot = false\n[[vehicles]]\nagents = '1-4'\nkind = 'px4'\naddress = '127.0.0.1'\ndomain = " +
          std::to_string(airfield_.domain()) + "\n");
  Up up = Fly(folder_.File("meet.toml"));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  constexpr double kGap_m = 0.15;  // fakes follow their set-points with gains of PX4's order
  for (const nlohmann::json& vehicle : up.Summary().at("vehicles")) {
    const nlohmann::json flying = vehicle.at("gap").at("flying");
    EXPECT_LT(flying.at("max_m"), kGap_m) << vehicle;
    EXPECT_LE(flying.at("rms_m"), flying.at("max_m"));
  }
  EXPECT_LT(up.Summary().at("consensus").at("final_disagreement_m"), 2 * kGap_m);
}

TEST_F(Vehicles, FlyWithSimulatedAgentsPastObstacles) {
  airfield_.AddPx4(1, "0,0,0");
  airfield_.AddPx4(2, "0,2,0", {"--release", "1.15"});
  std::string rows, goals;
  for (int k = 0; k < 10; ++k) {
    rows += fmt::format("[0.0, {}.0, 1.0],", 2 * k);
    goals += fmt::format("[6.0, {}.0, 1.0],", 2 * k);
  }
  WriteFile(folder_.File("course.toml"),
            "[run]\nmode = 'realtime'\nagent_timeout_s = 2.0\nduration_s = 12.0\n"
            "[agents]\ncount = 10\nmodel = 'double_integrator'\nposition_m = [" +
                rows +
                "]\n[[physics.obstacles]]\nshape = 'cylinder'\nposition_m = [3, 0.2, 1]\nsize_m = [1, 1, 2]\n"
                "[[physics.obstacles]]\nshape = 'box'\nposition_m = [3, 6.3, 1]\nsize_m = [1, 1, 2]\n"
                "[control]\nvelocity_gain = 2.0\nmax_acceleration_m_per_s2 = 2.0\n[sensors]\nrange_m = 3.0\n"
                "[graph]\ntopology = 'complete'\n[law]\nname = 'avoidance'\nspeed_m_per_s = 0.8\nrepulsion = 0.1\n"
                "influence_m = 1.5\ngoals_m = [" +
                goals + "]\n[output]\nsave_plot = false\n[[vehicles]]\nagents = [1, 2]\nkind = 'px4'\ndomain = " +
                std::to_string(airfield_.domain()) + "\naddress = '127.0.0.1'\n");
  Up up = Fly(folder_.File("course.toml"));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  const nlohmann::json summary = up.Summary();
  const nlohmann::json& safety = summary.at("safety");
  EXPECT_EQ(safety.at("collisions"), 0);
  EXPECT_EQ(safety.at("contacts").at("obstacles"), 0);
  EXPECT_GT(safety.at("min_separation_m"), 1.5);
  EXPECT_GT(summary.at("consensus").at("value_m").at(0), 5.0) << "all of them have come past the obstacles";
  for (const nlohmann::json& vehicle : summary.at("vehicles"))
    EXPECT_LT(vehicle.at("gap").at("flying").at("max_m"), 0.15) << vehicle;
  EXPECT_THAT(up.err(), AllOf(HasSubstr("vehicle 1: landed"), HasSubstr("vehicle 2: landed")));
}

TEST_F(Vehicles, MayFlyWithCredentials) {
  airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4), {"--go", "--set", "network.security=graph"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), AllOf(HasSubstr("vehicle 1: flying"), HasSubstr("vehicle 1: landed")));
}

TEST_F(Vehicles, TwentyFiveFlyFromOneMachine) {
  constexpr int kVehicles = 25;
  std::string places;
  for (int agent = 1; agent <= kVehicles; ++agent) {
    const int x_m = 2 * ((agent - 1) % 5), y_m = 2 * ((agent - 1) / 5);
    airfield_.AddPx4(agent, fmt::format("{},{},0", x_m, y_m));
    places += fmt::format("[{}, {}, 0.8],", x_m, y_m);
  }
  WriteFile(folder_.File("large.toml"),
            "[run]\nmode = 'realtime'\nagent_timeout_s = 5.0\nduration_s = 2.0\nstart_timeout_s = 150.0\n[graph]\n"
            "topology = 'ring'\n[agents]\ncount = 25\n"
            "model = 'double_integrator'\nposition_m = [" +
                places +
                "]\n[law]\nname = 'consensus'\np_gain = 0.02\n[output]\nsave_plot = false\n[[vehicles]]\n"
                "agents = '1-25'\nkind = 'px4'\naddress = '127.0.0.1'\ndomain = " +
                std::to_string(airfield_.domain()) + "\n");
  Up up = Fly(folder_.File("large.toml"));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  for (int agent = 1; agent <= kVehicles; ++agent)
    EXPECT_THAT(up.err(), AllOf(HasSubstr(fmt::format("vehicle {}: flying", agent)),
                                HasSubstr(fmt::format("vehicle {}: landed", agent))));
}

/// What a fake PX4 said when it was disarmed.
struct Landing {
  double east_m = 0, north_m = 0, highest_m = 0;
};

/// One vehicle whose agent goes by 1 m along W's x axis.
class OneAhead : public Vehicles {
 protected:
  Landing Fly1(const std::string& keys) {
    Running& px4 = airfield_.AddPx4(1, "0,0,0");
    WriteFile(folder_.File("ahead.toml"),
              "[run]\nmode = 'realtime'\nagent_timeout_s = 2.0\nduration_s = 6.0\n[agents]\ncount = 1\n"
              "model = 'double_integrator'\nposition_m = [[0.0, 0.0, 0.8]]\n[law]\nname = 'consensus'\nleader = 1\n"
              "leader_waypoints_m = [[1.0, 0.0, 0.8]]\n[output]\nsave_plot = false\n[[vehicles]]\nagents = [1]\n"
              "kind = 'px4'\naddress = '127.0.0.1'\ndomain = " +
                  std::to_string(airfield_.domain()) + "\n" + keys);
    Up up(folder_, "ahead_" + std::to_string(flights_++), folder_.File("ahead.toml"), {"--go"});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    EXPECT_TRUE(Until([&] { return px4.Said("highest: "); })) << px4.err();
    said_ = px4.err();
    Landing landing;
    const std::string at = said_.substr(said_.find("disarmed, "));
    EXPECT_EQ(
        std::sscanf(at.c_str(), "disarmed, %lf m east and %lf m north of where it was switched on; highest: %lf m",
                    &landing.east_m, &landing.north_m, &landing.highest_m),
        3)
        << at;
    return landing;
  }
  std::string said_;

 private:
  int flights_ = 0;
};

TEST_F(OneAhead, TheFramesYawTurnsTheWay) {
  constexpr double kNear_m = 0.3;  // it lands while it settles
  const Landing straight = Fly1("");
  EXPECT_NEAR(straight.east_m, 1, kNear_m);
  EXPECT_NEAR(straight.north_m, 0, kNear_m);
  const Landing turned = Fly1("yaw_rad = 1.5707963267948966\n");  // the frame's x axis is along W's y axis
  EXPECT_NEAR(turned.east_m, 0, kNear_m);
  EXPECT_NEAR(turned.north_m, -1, kNear_m);
}

TEST_F(OneAhead, TakesOffAsHighAsTheFileSays) {
  EXPECT_NEAR(Fly1("takeoff_m = 1.5\n").highest_m, 1.5, 0.2);
  EXPECT_NEAR(Fly1("takeoff_m = 0.5\n").highest_m, 0.8, 0.2) << "its agent's start is higher";
}

TEST_F(OneAhead, IsToldWhatTheFileSays) {
  for (const std::string_view told : {"velocity", "acceleration"}) {
    EXPECT_NEAR(Fly1(fmt::format("setpoint = '{}'\n", told)).east_m, 1, 0.6) << told;
    EXPECT_THAT(said_, HasSubstr(fmt::format("is told its {}\n", told)));
  }
  Fly1("");
  EXPECT_THAT(said_, HasSubstr("is told its position\n"));
  EXPECT_THAT(said_, Not(HasSubstr("is told its acceleration\n")));
}

TEST_F(Vehicles, OfAFrozenAgentAreLeftToTheirAutopilot) {
  Running& px4 = airfield_.AddPx4(1, "0,0,0");
  airfield_.AddPx4(2, "4,0,0");
  Up up = Fly(Team("[1, 2]", kPx4 + "on_loss = 'hold'\n", /*duration_s=*/8, "on_agent_loss = 'hold'\n"));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  const pid_t agent = up.Child("agent_1");
  SignalTo(agent, SIGSTOP);
  EXPECT_TRUE(Until([&] { return px4.Said("no sign of life: lands"); })) << px4.err();
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), HasSubstr("vehicle 1: its agent has not commanded for 0.5 s: nothing is sent until it does"));
  EXPECT_THAT(up.err(), HasSubstr("vehicle 2: landing: the run is over"));
}

TEST_F(Vehicles, MotorsStopWhenSomebodyMeansIt) {
  Running& px4 = airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4, kEndless));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  const std::string kill = "'" + BuildFolder() + "/orchestrator' send --run '" + up.path().string() + "' kill 1";
  const Ran doubtful = Shell("printf 'no\\n' | script -qec \"" + kill + "\" /dev/null");
  EXPECT_EQ(doubtful.exit_code, 1);
  EXPECT_THAT(doubtful.output, AllOf(HasSubstr("Stop the motors of vehicle 1? In the air it falls. Type yes: "),
                                     HasSubstr("nothing was sent")));
  EXPECT_FALSE(px4.Said("disarmed"));
  const Ran meant = Shell("printf 'yes\\n' | script -qec \"" + kill + "\" /dev/null");
  EXPECT_EQ(meant.exit_code, 0) << meant.output;
  EXPECT_THAT(meant.output, HasSubstr("the motors of vehicle 1 are to stop"));
  EXPECT_TRUE(Until([&] { return px4.Said("disarmed"); })) << px4.err();
  EXPECT_TRUE(Until([&] { return up.Said("vehicle 1: lost: its motors stand"); })) << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
}

TEST_F(Vehicles, ThatAreLostBeforeTheRunHasBegunEndIt) {
  airfield_.AddPx4(1, "0,0,0", {"--pilot-at-s", "12"});
  airfield_.AddPx4(2, "4,0,0", {"--refuses-arming"});
  airfield_.AddPx4(3, "0,4,0");
  Up up = Fly(Team("[1, 2, 3]", kPx4 + "on_loss = 'hold'\n", kEndless));
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), AllOf(HasSubstr("vehicle 1: lost: it follows no set-points any more"),
                              HasSubstr("the run cannot begin: vehicle 1 is lost"), HasSubstr("vehicle 3: landed")));
}

TEST_F(Vehicles, AreNotAwaitedByARunThatIsStopped) {
  airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4, kEndless), {});
  ASSERT_TRUE(Until([&] { return up.Said("all vehicles are there"); })) << up.err();
  const std::string send = "send --run '" + up.path().string() + "' ";
  const Ran resumed = Orchestrator(send + "resume");
  EXPECT_EQ(resumed.exit_code, 1);
  EXPECT_THAT(resumed.output, HasSubstr("the run has not begun: vehicle 1 is found"));
  for (const std::string_view what : {"pause", "step"})
    EXPECT_THAT(Orchestrator(send + std::string(what)).output,
                HasSubstr(fmt::format("{}: expected a run without vehicles, got one with [[vehicles]]: in a pause they "
                                      "would get no set-points",
                                      what)));
  EXPECT_THAT(Orchestrator(send + "land").output, HasSubstr("land: expected a vehicle in the air, got none"));
  EXPECT_THAT(Orchestrator(send + "land 3").output, HasSubstr("land: expected an agent with a vehicle (1), got 3"));
  EXPECT_THAT(Orchestrator("ps").output, HasSubstr("1 found"));
  const Ran stopped = Orchestrator(send + "stop");
  EXPECT_EQ(stopped.exit_code, 0) << stopped.output;
  EXPECT_THAT(stopped.output, HasSubstr("the run ends before it has begun"));
  EXPECT_EQ(up.Wait(), 0) << up.err();
}

TEST_F(Vehicles, NothingArmsBeforeSomebodySaysSo) {
  Running& px4 = airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4), {});
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: found"); })) << up.err();
  ASSERT_TRUE(Until([&] { return up.Said("still waiting: vehicle 1 is found"); })) << up.err();
  EXPECT_FALSE(px4.Said("armed"));
  EXPECT_EQ(Orchestrator("send --run '" + up.path().string() + "' start").exit_code, 0);
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  EXPECT_EQ(up.Wait(), 0) << up.err();
}

TEST_F(Vehicles, CtrlCLandsThem) {
  airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4, kEndless));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_THAT(up.err(), AllOf(HasSubstr("vehicle 1: landing"), HasSubstr("vehicle 1: landed")));
}

TEST_F(Vehicles, MotorsThatDoNotStopInTheAirAreTold) {
  airfield_.AddArdupilot(1, "0,0,0");
  Up up = Fly(Team("[1]", "kind = 'ardupilot'\n", kEndless));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  const Ran asked = Orchestrator("send --run '" + up.path().string() + "' kill 1");
  EXPECT_EQ(asked.exit_code, 0) << asked.output;
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: lost: its motors do not stop: disarming is refused"); }))
      << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
}

TEST_F(Vehicles, MotorsStopWhileAllLand) {
  airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4, kEndless));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  up.Signal(SIGINT);
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: landing"); })) << up.err();
  const std::string send = "send --run '" + up.path().string() + "' ";
  EXPECT_THAT(Orchestrator(send + "start").output, HasSubstr("the run is over"));
  const Ran killed = Orchestrator(send + "kill 1");
  EXPECT_EQ(killed.exit_code, 0) << killed.output;
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_THAT(up.err(), AllOf(HasSubstr("vehicle 1: lost: its motors stand"), Not(HasSubstr("vehicle 1: landed"))));
}

TEST_F(Vehicles, LoseTheirHeartbeatWithTheOrchestrator) {
  Running& px4 = airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4, kEndless));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  up.Signal(SIGKILL);
  EXPECT_EQ(up.Wait(), -SIGKILL);
  EXPECT_TRUE(Until([&] { return px4.Said("no sign of life: lands"); })) << px4.out();
  EXPECT_TRUE(Until([&] { return px4.Said("disarmed"); })) << px4.out();
}

TEST_F(Vehicles, LoseTheirHeartbeatWithASecondCtrlC) {
  Running& px4 = airfield_.AddPx4(1, "0,0,0");
  Up up = Fly(Team("[1]", kPx4, kEndless));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  up.Signal(SIGINT);
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: landing"); })) << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_THAT(up.err(), HasSubstr("nothing is sent to vehicles any more: their autopilots decide"));
  EXPECT_FALSE(up.Said("vehicle 1: landed"));
  EXPECT_TRUE(Until([&] { return px4.Said("disarmed"); })) << px4.err();
}

TEST_F(Vehicles, ThatLoseTheirProcessAreLeftToTheirAutopilot) {
  Running& px4 = airfield_.AddPx4(1, "0,0,0");
  airfield_.AddPx4(2, "4,0,0");
  Up up = Fly(Team("[1, 2]", kPx4 + "on_loss = 'hold'\n", /*duration_s=*/6));
  ASSERT_TRUE(Until([&] { return up.Said("vehicle 1: flying"); })) << up.err();
  SignalTo(ChildOf(up.pid(), "/vehicle "), SIGKILL);
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), HasSubstr("vehicle 1: lost: its process was killed by signal 9"));
  EXPECT_THAT(up.err(), HasSubstr("vehicle 2: landing: the run is over"));
  EXPECT_TRUE(Until([&] { return px4.Said("no sign of life: lands"); })) << px4.err();
}

/// What is wrong with the first of two vehicles in the air, what is said of it, and what the other one does.
struct Trouble {
  std::string name;
  std::vector<std::string> fake;  ///< options of the fake
  std::string keys;               ///< of [[vehicles]]
  std::string words;              ///< of `up`
  std::string other;              ///< of `up`, of the other vehicle
};

class InTheAir : public Vehicles, public ::testing::WithParamInterface<Trouble> {};

TEST_P(InTheAir, TroubleIsToldAndLeavesTheOthersInOrder) {
  const Trouble& trouble = GetParam();
  airfield_.AddPx4(1, "0,0,0", trouble.fake);
  airfield_.AddPx4(2, "4,0,0");
  Up up = Fly(Team("[1, 2]", kPx4 + trouble.keys, /*duration_s=*/10));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), HasSubstr(trouble.words));
  EXPECT_THAT(up.err(), HasSubstr(trouble.other));
  EXPECT_THAT(up.err(), HasSubstr("vehicle 2: landed"));
}

INSTANTIATE_TEST_SUITE_P(
    Vehicles, InTheAir,
    ::testing::Values(
        Trouble{"SilenceOfARadio",
                {"--silent-from-s", "7", "--silent-to-s", "37"},
                "on_loss = 'hold'\n",
                "vehicle 1: lost: nothing has been heard of where it is for 1.0 s",
                "vehicle 2: landing: the run is over"},
        Trouble{"SilenceThatLandsTheOthers",
                {"--silent-from-s", "7"},
                "on_loss = 'land'\n",
                "vehicle 1: lost: nothing has been heard of where it is for 1.0 s",
                "vehicle 2: landing: vehicle 1 is lost"},
        Trouble{"APilotThatTakesOver",
                {"--pilot-at-s", "7"},
                "on_loss = 'hold'\n",
                "vehicle 1: lost: it follows no set-points any more: a pilot or its own failsafe has taken over",
                "vehicle 2: landing: the run is over"},
        Trouble{"AnEstimatorThatMovesItsOrigin",
                {"--reset-at-s", "7"},
                "",
                "vehicle 1: its estimator has moved its origin by",
                "vehicle 1: landing: the run is over"},
        Trouble{"AFenceThatIsCrossed",
                {},
                "fence = [[-1.0, -1.0, -1.0], [5.0, 0.2, 2.0]]\n",
                "vehicle 1: landing: it is beyond its fence, at ",
                "vehicle 1: landed"}),
    [](const auto& row) { return row.param.name; });

/// What is wrong with a vehicle on the ground, and what is said of it.
struct Refusal {
  std::string name;
  std::vector<std::string> fake;
  std::string keys;
  std::string words;
};

class OnTheGround : public Vehicles, public ::testing::WithParamInterface<Refusal> {};

TEST_P(OnTheGround, WhatIsWrongIsToldAndTheVehicleStaysThere) {
  const Refusal& refusal = GetParam();
  Running& px4 = airfield_.AddPx4(1, "0,0,0", refusal.fake);
  Up up = Fly(Team("[1]", kPx4 + refusal.keys, kEndless));
  ASSERT_TRUE(Until([&] { return up.Said(refusal.words); })) << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_FALSE(px4.Said("\narmed"));
}

INSTANTIATE_TEST_SUITE_P(
    Vehicles, OnTheGround,
    ::testing::Values(Refusal{"AWrongSystemId",
                              {"--system-id", "9"},
                              "",
                              "vehicle 1: found: it does not follow set-points: it has not answered (is system_id "
                              "right? does it hear us?)"},
                      Refusal{"RefusedArming",
                              {"--refuses-arming"},
                              "",
                              "vehicle 1: found: it does not arm: arming is rejected for now"},
                      Refusal{"NoSignsOfLife",
                              {"--no-signs-of-life"},
                              "",
                              "vehicle 1: found: it does not arm: arming is rejected for now"},
                      Refusal{"AnUnknownHeading", {"--no-heading"}, "", "its heading is unknown"},
                      Refusal{"AnUnknownRelease",
                              {"--release", "strange"},
                              "",
                              "80 bytes of vehicle_status_v4: the known lengths are 83 (1.18)"},
                      Refusal{"AnOriginThatIsNotThatOfTheFile",
                              {},
                              "origin = [3.0, 0.0, 0.0]\n",
                              "vehicle 1: it does not start: it is 3.00 m from its start, and 0.5 m are allowed"}),
    [](const auto& row) { return row.param.name; });

TEST_F(Vehicles, AreHeardBeforeAFlightByNobodyWhoCommandsThem) {
  Running& px4 = airfield_.AddPx4(1, "0.1,0,0");
  const std::string team = Team("[1, 2]", kPx4);
  const Ran alone = Check(team);
  EXPECT_EQ(alone.exit_code, 1);
  EXPECT_THAT(alone.output, HasSubstr("vehicle 1    PX4 1.16 or 1.17, "));
  EXPECT_THAT(alone.output, HasSubstr("vehicle 2    absent\n  refused    nothing has been heard of it"));
  airfield_.AddPx4(2, "4,0,0", {"--release", "1.15"});
  const Ran both = Check(team);
  EXPECT_EQ(both.exit_code, 0) << both.output;
  EXPECT_THAT(both.output, HasSubstr("vehicle 2    PX4 1.15, "));
  EXPECT_THAT(both.output, Not(HasSubstr("refused")));
  EXPECT_FALSE(px4.Said("offboard"));
}

TEST_F(Vehicles, OfCrazyswarmFlyAndTumble) {
  airfield_.AddCrazyflie(1, "0,0,0");
  const std::string keys = "kind = 'crazyswarm'\norigin = 'shared'\n";
  Up up = Fly(Team("[1]", keys));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), AllOf(HasSubstr("vehicle 1: found: Crazyswarm2"), HasSubstr("vehicle 1: landed")));
  airfield_.AddCrazyflie(1, "0,0,0", {"--tumbles-at-s", "5"});
  Up tumbles(folder_, "tumbles", Team("[1]", keys, /*duration_s=*/10), {"--go"});
  EXPECT_EQ(tumbles.Wait(), 0) << tumbles.err();
  EXPECT_THAT(tumbles.err(), HasSubstr("vehicle 1: lost: it has tumbled"));
}

TEST_F(Vehicles, OfArdupilotFlyAndLandWithALowBattery) {
  airfield_.AddArdupilot(1, "0,0,0");
  const std::string keys = "kind = 'ardupilot'\n";
  Up up = Fly(Team("[1]", keys));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), AllOf(HasSubstr("vehicle 1: found: ArduPilot"), HasSubstr("vehicle 1: landed")));
  airfield_.AddArdupilot(1, "0,0,0", {"--battery-low-at-s", "7"});
  Up low(folder_, "low", Team("[1]", keys, /*duration_s=*/10), {"--go"});
  EXPECT_EQ(low.Wait(), 0) << low.err();
  EXPECT_THAT(low.err(),  // whichever message comes first
              AnyOf(HasSubstr("one of its failsafes is active: battery"), HasSubstr("its battery is at 10 %")));
}

}  // namespace
}  // namespace mascot::test
