#include "orchestrator/theory/from_start.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "orchestrator/measuring/agreement_meter.h"
#include "orchestrator/team/ideal_team.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

/// What the laws themselves do, on ideal bodies.
FromStart FlyIdeal(const Experiment& experiment) {
  AgreementMeter meter(experiment);
  IdealTeam team(experiment);
  const std::vector<Eigen::Vector3d> place_W = LinearTeamOf(experiment).team->place_W;
  for (std::int64_t tick = 0; tick < experiment.ticks(); ++tick) {
    if (tick > 0) team.Step();
    std::vector<Eigen::Vector3d> q_W;
    for (int id = 1; id <= experiment.size(); ++id)
      q_W.push_back(team.p_W(id) - place_W[static_cast<std::size_t>(id - 1)]);
    meter.Add(q_W);
  }
  return {.settling_time_s = meter.settling_time_s(), .rate_per_s = meter.rate_per_s()};
}

FromStart FromMatrices(const Experiment& experiment) {
  return FlyFromStart(experiment, *LinearTeamOf(experiment).team, *TimelineOf(experiment), experiment.run.duration_s);
}

std::string Agents(std::mt19937& random, int count, const std::string& model) {
  std::uniform_real_distribution<double> place(-3, 3);
  std::string positions, velocities;
  for (int i = 0; i < count; ++i) {
    positions += fmt::format("[{:.3f}, {:.3f}, {:.3f}],", place(random), place(random), 10 + place(random));
    velocities += fmt::format("[{:.3f}, {:.3f}, 0],", 0.2 * place(random), 0.2 * place(random));
  }
  return fmt::format(
      "[run]\nduration_s = 120.0\n[physics]\ncollisions = false\n[control]\nrate_hz = 20\n"
      "max_acceleration_m_per_s2 = 1000.0\nmax_speed_m_per_s = 1000.0\n"
      "[agents]\ncount = {}\nmodel = '{}'\nposition_m = [{}]\nvelocity_m_per_s = [{}]\n",
      count, model, positions, velocities);
}

void ExpectTheSame(const std::string& toml) {
  const Experiment experiment = Load(toml);
  const FromStart flown = FlyIdeal(experiment), predicted = FromMatrices(experiment);
  ASSERT_TRUE(flown.settling_time_s && flown.rate_per_s) << toml;
  ASSERT_TRUE(predicted.settling_time_s && predicted.rate_per_s) << toml;
  EXPECT_NEAR(*predicted.settling_time_s, *flown.settling_time_s, 1.01 * experiment.period_s()) << toml;
  EXPECT_NEAR(*predicted.rate_per_s, *flown.rate_per_s, 1e-3 * *flown.rate_per_s) << toml;
}

TEST(FromStart, IsWhatTheLawsDoOnIdealBodiesWithAnyDelays) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const std::string delays = fmt::format(
        "[sensors.own]\ndelay_s = {:.3f}\n[link]\ndelay_s = {:.3f}\n[[link.override]]\nedges = [[1, 2]]\ndelay_s = "
        "{:.3f}\n",
        trial % 2 * 0.1 * unit(random), 0.3 * unit(random), 0.4 * unit(random));
    const std::string law =
        trial % 3 == 0 ? fmt::format("name = 'velocity_consensus'\np_gain = {:.3f}\n", 0.4 + 0.4 * unit(random))
                       : fmt::format("name = 'consensus'\np_gain = {:.3f}\nv_gain = {:.3f}\nbeta = {:.3f}\n",
                                     0.4 + unit(random), 0.5 * unit(random), 1.2 + unit(random));
    const char* model = trial % 4 < 2 ? "double_integrator" : "single_integrator";
    ExpectTheSame(Agents(random, 3 + trial % 4, model) + "[graph]\ntopology = 'ring'\n" + delays + "[law]\n" + law);
  }
}

TEST(FromStart, FollowsSwitchingGraphsLateAgentsAndLeadersThatStand) {
  std::mt19937 random(2);
  const std::string consensus = "[law]\nname = 'consensus'\nbeta = 2.0\n", link = "[link]\ndelay_s = 0.12\n";
  ExpectTheSame(Agents(random, 4, "double_integrator") +
                "[graph]\ntopology = 'path'\nrepeat_s = 2.0\n[[graph.schedule]]\nat_s = 1.0\ntopology = 'ring'\n" +
                link + consensus);
  ExpectTheSame(Agents(random, 4, "double_integrator") + "[[agents.override]]\nid = 3\nstart_s = 4.0\n" +
                "[graph]\ntopology = 'complete'\n" + link + consensus);
  std::string still = Agents(random, 4, "double_integrator");
  still.resize(still.find("velocity_m_per_s"));
  ExpectTheSame(still + "[graph]\ntopology = 'path'\n" + link + consensus + "leader = 1\n");
  ExpectTheSame(still + "[graph]\ntopology = 'path'\n" + link +
                "[law]\nname = 'formation'\nbeta = 2.0\naxes = 'xy'\nshape = 'line'\nspacing_m = 1.5\n");
}

TEST(FromStart, IsUnknownWhereItIsTooMuchWork) {
  std::mt19937 random(3);
  const Experiment experiment =
      Load(Agents(random, 3, "double_integrator") + "[graph]\ntopology = 'ring'\n[law]\nname = 'consensus'\n");
  const FromStart from_start = FlyFromStart(experiment, *LinearTeamOf(experiment).team, *TimelineOf(experiment), 1e6);
  EXPECT_FALSE(from_start.is_flown);
  EXPECT_FALSE(from_start.settling_time_s);
  EXPECT_FALSE(from_start.rate_per_s);
}

}  // namespace
}  // namespace mascot
