#include "agent/link.h"

#include <gmock/gmock.h>

#include <cmath>

#include "agent/laws/laws.h"
#include "agent/neighbours.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kRate = 100;

LinkConfig Config(double loss, double delay_s = 0, double jitter_s = 0) {
  LinkConfig config;
  config.loss = loss;
  config.delay_s = delay_s;
  config.jitter_s = jitter_s;
  return config;
}

/// Sends a sample at each tick 0 .. count - 1. Returns {tick, tick of the sample that was used} for ticks with a
/// sample.
std::vector<std::pair<std::int64_t, std::int64_t>> Pass(Link& link, int count) {
  std::vector<std::pair<std::int64_t, std::int64_t>> used;
  Motion motion;
  for (std::int64_t tick = 0; tick < count; ++tick) {
    motion.p_WB.x() = static_cast<double>(tick);
    link.Send(tick, 1.0, {&motion});
    const Link::Packet* packet = link.Receive(tick);
    if (packet == nullptr) continue;
    EXPECT_EQ(packet->motion.p_WB.x(), static_cast<double>(packet->sent));
    used.emplace_back(tick, packet->sent);
  }
  return used;
}

// --- one link ---------------------------------------------------------------------------------------

TEST(Link, DeliversEverythingAtOnceIfItIsPerfect) {
  Link link(LinkConfig{}, kRate, 1, 1, 2);
  EXPECT_THAT(Pass(link, 3), ElementsAre(std::pair(0, 0), std::pair(1, 1), std::pair(2, 2)));
  EXPECT_EQ(link.count().sent, 3u);
  EXPECT_EQ(link.count().lost + link.count().late, 0u);
}

TEST(Link, DelaysByWholeTicksRoundedUp) {
  for (const auto& [delay_s, ticks] : {std::pair(0.05, 5), {0.051, 6}, {0.001, 1}, {0.07, 7}}) {
    Link link(Config(0, delay_s), kRate, 1, 1, 2);
    const auto used = Pass(link, 20);
    ASSERT_EQ(std::ssize(used), 20 - ticks) << delay_s;
    for (const auto& [arrived, sent] : used) EXPECT_EQ(arrived - sent, ticks);
  }
}

TEST(Link, LosesTheGivenFractionOfTheSamples) {
  constexpr int kSamples = 20000;
  Link link(Config(0.2), kRate, 1, 1, 2);
  const auto used = Pass(link, kSamples);
  const double sigma = std::sqrt(0.2 * 0.8 / kSamples);
  EXPECT_NEAR(static_cast<double>(link.count().lost) / kSamples, 0.2, 5 * sigma);
  EXPECT_EQ(used.size() + link.count().lost, static_cast<std::size_t>(kSamples));
}

TEST(Link, LosesIndependentlyOfTheSampleBefore) {
  constexpr int kSamples = 20000;
  Link link(Config(0.5), kRate, 1, 1, 2);
  std::vector<bool> arrived(kSamples, false);
  for (const auto& [at, sent] : Pass(link, kSamples)) arrived[static_cast<std::size_t>(sent)] = true;
  int same = 0;
  for (std::size_t i = 1; i < arrived.size(); ++i) same += arrived[i] == arrived[i - 1];
  EXPECT_NEAR(static_cast<double>(same) / kSamples, 0.5, 5 * 0.5 / std::sqrt(kSamples));
}

TEST(Link, LosesInBurstsAsGilbertAndElliottSay) {
  // In the stationary state: bad with probability g / (g + b), bursts of 1 / b samples on average.
  constexpr int kSamples = 40000;
  LinkConfig config;
  config.bursts = GilbertElliott{.good_to_bad = 0.05, .bad_to_good = 0.25, .loss_good = 0, .loss_bad = 1};
  Link link(config, kRate, 1, 1, 2);
  const auto used = Pass(link, kSamples);
  int bursts = 0;
  for (std::size_t i = 1; i < used.size(); ++i) bursts += used[i].second > used[i - 1].second + 1;
  const double lost = static_cast<double>(link.count().lost);
  EXPECT_NEAR(lost / kSamples, 0.05 / 0.3, 0.015);
  EXPECT_NEAR(lost / bursts, 4.0, 0.25);
}

TEST(Link, NeverGivesASampleAfterOneThatWasSentLater) {
  Link link(Config(0, 0.1, 0.1), kRate, 1, 1, 2);
  const auto used = Pass(link, 2000);
  for (std::size_t i = 1; i < used.size(); ++i) EXPECT_GT(used[i].second, used[i - 1].second);
  for (const auto& [arrived, sent] : used) {
    EXPECT_GE(arrived - sent, 0);
    EXPECT_LE(arrived - sent, 20);
  }
  EXPECT_GT(link.count().late, 100u);
  EXPECT_NEAR(static_cast<double>(used.size() + link.count().late), 2000, 20);  // all except those still in flight
}

TEST(Link, ReordersOnlyIfToldTo) {
  LinkConfig config = Config(0, 0.05);
  Link in_order(config, kRate, 1, 1, 2);
  Pass(in_order, 500);
  EXPECT_EQ(in_order.count().late, 0u);
  config.reordering = 0.1;
  Link overtaken(config, kRate, 1, 1, 2);
  const auto used = Pass(overtaken, 500);
  EXPECT_GT(overtaken.count().late, 50u);
  EXPECT_THAT(used, ::testing::Contains(::testing::Truly([](const auto& at) { return at.first == at.second; })));
}

TEST(Link, HoldsTheLastSampleForTheHoldTime) {
  LinkConfig config = Config(0, 0.02);
  config.hold_s = 0.03;
  Link link(config, kRate, 1, 1, 2);
  const Motion motion;
  link.Send(0, 1.0, {&motion});
  std::vector<std::int64_t> heard;
  for (std::int64_t tick = 0; tick < 10; ++tick)
    if (link.Receive(tick) != nullptr) heard.push_back(tick);
  EXPECT_THAT(heard, ElementsAre(2, 3, 4, 5));
}

TEST(Link, FateDependsOnSeedEdgeAndTickAlone) {
  const auto lost = [](std::uint64_t seed, int hearer, int heard, std::int64_t first) {
    Link link(Config(0.5), kRate, seed, hearer, heard);
    std::vector<bool> fates;
    const Motion motion;
    for (std::int64_t tick = first; tick < 64; ++tick) {
      link.Send(tick, 1.0, {&motion});
      const Link::Packet* packet = link.Receive(tick);
      if (tick >= 32) fates.push_back(packet != nullptr);
    }
    return fates;
  };
  EXPECT_EQ(lost(1, 1, 2, 0), lost(1, 1, 2, 32)) << "what was sent before changes nothing";
  EXPECT_NE(lost(1, 1, 2, 0), lost(2, 1, 2, 0));
  EXPECT_NE(lost(1, 1, 2, 0), lost(1, 2, 1, 0)) << "each direction by itself";
  EXPECT_NE(lost(1, 1, 2, 0), lost(1, 1, 3, 0));
}

TEST(Link, SymmetricLosesTheSameSamplesBothWays) {
  LinkConfig config = Config(0.5, 0.05, 0.05);
  config.symmetric = true;
  Link there(config, kRate, 1, 1, 2), back(config, kRate, 1, 2, 1);
  EXPECT_EQ(Pass(there, 200), Pass(back, 200));
}

TEST(Link, DelaysSamplesAfterAMissedTickAsLongAsOthers) {
  Link link(Config(0, 0.03), kRate, 1, 1, 2);
  std::vector<std::pair<std::int64_t, std::int64_t>> used;
  const Motion motion;
  for (const std::int64_t tick : {0, 1, 2, 3, 4, 6, 7, 8, 20, 21, 22, 23}) {  // in real time an agent may miss ticks
    link.Send(tick, 1.0, {&motion});
    if (const Link::Packet* packet = link.Receive(tick)) used.emplace_back(tick, packet->sent);
  }
  EXPECT_THAT(used, ElementsAre(std::pair(3, 0), std::pair(4, 1), std::pair(6, 3), std::pair(7, 4), std::pair(23, 20)));
  EXPECT_EQ(link.count().lost, 0u);
}

TEST(Link, CarriesWeightAndMessageOfTheTickAtWhichTheSampleWasSent) {
  Link link(Config(0, 0.01), kRate, 1, 1, 2);
  const Motion motion;
  const std::vector<double> early = {1, 2}, late = {3};
  link.Send(0, 0.5, {&motion, early});
  EXPECT_EQ(link.Receive(0), nullptr);
  link.Send(1, 2.0, {&motion, late});
  const Link::Packet* packet = link.Receive(1);
  ASSERT_NE(packet, nullptr);
  EXPECT_EQ(packet->weight, 0.5);
  EXPECT_THAT(packet->message, ElementsAre(1, 2));
  EXPECT_EQ(link.count().numbers, 3u);
}

// --- Neighbours -------------------------------------------------------------------------------------

Experiment LoadThree(const std::string& rest) {
  return LoadExperiment(Section::FromText("[run]\nduration_s = 10.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\n"
                                          "position_m = [[0, 0, 1], [3, 0, 1], [9, 0, 1]]\n" +
                                              rest,
                                          "test.toml"),
                        "test");
}

/// Ids that agent 1 hears at `tick`, with all agents at their initial positions.
std::vector<int> HeardAt(const Experiment& experiment, std::int64_t tick) {
  Neighbours neighbours(experiment, 1);
  std::vector<Motion> motions(3);
  for (const AgentConfig& agent : experiment.agents) motions[static_cast<std::size_t>(agent.id - 1)].p_WB = agent.p_W;
  std::vector<Sample> samples;
  for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(1))
    samples.push_back({&motions[static_cast<std::size_t>(neighbour.id - 1)]});
  std::vector<int> ids;
  for (const Heard& heard : neighbours.Hear(tick, motions[0], samples)) ids.push_back(heard.id);
  return ids;
}

TEST(Neighbours, AreHeardInTheOrderOfTheirIds) {
  EXPECT_THAT(HeardAt(LoadThree("[graph]\nedges = [[1, 3], [1, 2]]\n"), 0), ElementsAre(2, 3));
}

TEST(Neighbours, AreHeardOnlyWithinRange) {
  EXPECT_THAT(HeardAt(LoadThree("[graph]\nrange_m = 3.1\n"), 0), ElementsAre(2));
  EXPECT_THAT(HeardAt(LoadThree("[graph]\nrange_m = 3.0\n"), 0), IsEmpty()) << "closer than, not as far as";
  EXPECT_THAT(HeardAt(LoadThree("[graph]\nrange_m = 10.0\n"), 0), ElementsAre(2, 3));
}

TEST(Neighbours, ChangeWithTheSchedule) {
  const Experiment e = LoadThree(
      "[graph]\nedges = [[1, 2]]\nrepeat_s = 3.0\n[[graph.schedule]]\nat_s = 1.0\nedges = [[1, 3]]\n"
      "[[graph.schedule]]\nat_s = 2.0\nedges = []\n");
  EXPECT_THAT(HeardAt(e, 99), ElementsAre(2));
  EXPECT_THAT(HeardAt(e, 100), ElementsAre(3)) << "from the tick at which it begins";
  EXPECT_THAT(HeardAt(e, 199), ElementsAre(3));
  EXPECT_THAT(HeardAt(e, 200), IsEmpty());
  EXPECT_THAT(HeardAt(e, 300), ElementsAre(2)) << "from the first again";
  EXPECT_THAT(HeardAt(e, 400), ElementsAre(3));
}

TEST(Neighbours, AreHeardOnlyWhileTheyAreThere) {
  const Experiment late = LoadThree("[[agents.override]]\nid = 2\nstart_s = 1.0\nstop_s = 2.0\n");
  EXPECT_THAT(HeardAt(late, 99), ElementsAre(3));
  EXPECT_THAT(HeardAt(late, 100), ElementsAre(2, 3));
  EXPECT_THAT(HeardAt(late, 199), ElementsAre(2, 3));
  EXPECT_THAT(HeardAt(late, 200), ElementsAre(3));
  EXPECT_THAT(HeardAt(LoadThree("[[agents.override]]\nid = 1\nstart_s = 1.0\n"), 0), IsEmpty());
}

TEST(Neighbours, MayDifferInTheirLinks) {
  const Experiment e = LoadThree("[link]\ndelay_s = 0.01\n[[link.override]]\nedges = [[1, 3]]\ndelay_s = 0.0\n");
  EXPECT_THAT(HeardAt(e, 0), ElementsAre(3));
  EXPECT_EQ(e.links.Of(1, 2).delay_s, 0.01);
  EXPECT_EQ(e.links.Of(1, 3).delay_s, 0.0);
  EXPECT_EQ(e.links.Of(3, 1).delay_s, 0.01);
}

TEST(Neighbours, AreSeenWithNoiseAndBias) {
  constexpr int kTicks = 4000;
  const Experiment e =
      LoadThree("[graph]\nedges = [[1, 2]]\n[sensors.heard]\nposition_std_m = 0.5\nvelocity_bias_std_m_per_s = 0.2\n");
  Neighbours neighbours(e, 1);
  Motion motion;
  const std::vector<Sample> samples = {{&motion}};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), square = Eigen::Vector3d::Zero(), bias;
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    const Motion seen = neighbours.Hear(tick, motion, samples)[0].motion;
    mean += seen.p_WB / kTicks;
    square += seen.p_WB.cwiseAbs2() / kTicks;
    if (tick > 0) {
      EXPECT_EQ(seen.v_WB, bias) << "a bias stays";
    }
    bias = seen.v_WB;
  }
  EXPECT_LT(mean.norm(), 5 * 0.5 / std::sqrt(kTicks));
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::sqrt(square[axis]), 0.5, 0.5 * 5 / std::sqrt(2 * kTicks));
  EXPECT_NE(bias, Eigen::Vector3d::Zero());
  EXPECT_LT(bias.norm(), 1);
}

/// The ticks of 0..12 at which agent 1 gets a message of agent 2, whose law begins anew at tick 5. What agent 2 sends
/// at tick k holds a message that is `ages[k]` ticks old.
std::vector<std::int64_t> TicksWithMessage(const std::string& rest, const std::vector<std::int64_t>& ages) {
  const Experiment before = LoadThree("[graph]\nedges = [[1, 2]]\n" + rest);
  Experiment after = before;
  after.agents[1].law.since = 5;
  Neighbours neighbours(before, 1);
  const Motion motion;
  const std::vector<double> said = {7};
  std::vector<std::int64_t> ticks;
  for (std::int64_t tick = 0; tick < std::ssize(ages); ++tick) {
    if (tick == 5) neighbours.Adopt(after);
    const std::vector<Sample> samples = {{&motion, said, ages[static_cast<std::size_t>(tick)]}};
    for (const Heard& heard : neighbours.Hear(tick, motion, samples))
      if (!heard.message.empty()) ticks.push_back(tick);
  }
  return ticks;
}

TEST(Neighbours, NeverPassOnAMessageOfTheLawBefore) {
  const std::vector<std::int64_t> each = {1, 1, 1, 1, 1, 1, 1, 1, 1};
  EXPECT_THAT(TicksWithMessage("", each), ElementsAre(0, 1, 2, 3, 4, 6, 7, 8));
  EXPECT_THAT(TicksWithMessage("[link]\ndelay_s = 0.02\n", each), ElementsAre(2, 3, 4, 8));
}

TEST(Neighbours, KnowAMessageOfTheLawBeforeAlsoIfTicksWereMissed) {
  // In real time: agent 2 misses ticks 5 and 6, answers tick 7, and misses tick 8.
  const std::vector<std::int64_t> ages = {1, 1, 1, 1, 1, 1, 2, 3, 1, 2, 1};
  EXPECT_THAT(TicksWithMessage("", ages), ElementsAre(0, 1, 2, 3, 4, 8, 9, 10));
  EXPECT_THAT(TicksWithMessage("[link]\ndelay_s = 0.02\n", ages), ElementsAre(2, 3, 4, 10));
  EXPECT_THAT(TicksWithMessage("[[agents.override]]\nid = 2\nlie = { offset_m = [1, 1, 1] }\n", ages),
              ElementsAre(0, 1, 2, 3, 4, 8, 9, 10));
}

// --- OwnSensor --------------------------------------------------------------------------------------

TEST(OwnSensor, IsExactByDefault) {
  OwnSensor sensor(SensorConfig{}, kRate, 1, 1);
  Motion self;
  self.p_WB = {1, 2, 3};
  EXPECT_EQ(sensor.Measure(0, self).p_WB, self.p_WB);
}

TEST(OwnSensor, DelaysPositionAndVelocityButNotAttitude) {
  SensorConfig config;
  config.own_delay_s = 0.03;
  OwnSensor sensor(config, kRate, 1, 1);
  for (std::int64_t tick = 0; tick < 20; ++tick) {
    Motion self;
    self.p_WB.x() = self.v_WB.x() = self.w_WB_B.x() = static_cast<double>(tick);
    const Motion seen = sensor.Measure(tick, self);
    EXPECT_EQ(seen.p_WB.x(), std::max<double>(0, static_cast<double>(tick) - 3));
    EXPECT_EQ(seen.v_WB.x(), seen.p_WB.x());
    EXPECT_EQ(seen.w_WB_B.x(), static_cast<double>(tick));
  }
}

TEST(OwnSensor, IsLateByWholeTicksRoundedUpAsLinksAre) {
  for (const auto& [delay_s, ticks] : {std::pair(0.004, 1), {0.01, 1}, {0.011, 2}, {0.07, 7}}) {
    SensorConfig config;
    config.own_delay_s = delay_s;
    OwnSensor sensor(config, kRate, 1, 1);
    for (std::int64_t tick = 0; tick < 20; ++tick) {
      Motion self;
      self.p_WB.x() = static_cast<double>(tick);
      EXPECT_EQ(sensor.Measure(tick, self).p_WB.x(), std::max<double>(0, static_cast<double>(tick) - ticks)) << delay_s;
    }
  }
}

TEST(OwnSensor, ErrorsDependOnSeedAgentAndTickAlone) {
  SensorConfig config;
  config.own.position_std_m = 0.1;
  const auto error = [&](std::uint64_t seed, int id, std::int64_t tick) {
    return OwnSensor(config, kRate, seed, id).Measure(tick, Motion{}).p_WB;
  };
  EXPECT_EQ(error(1, 1, 7), error(1, 1, 7));
  EXPECT_NE(error(1, 1, 7), error(1, 1, 8));
  EXPECT_NE(error(1, 1, 7), error(1, 2, 7));
  EXPECT_NE(error(1, 1, 7), error(2, 1, 7));
}

}  // namespace
}  // namespace mascot
