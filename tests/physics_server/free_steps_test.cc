// Steps in which nothing can touch are computed without Bullet's contact detection. They must give the same bits as
// Bullet, and Bullet must take over before anything touches.
#include <gmock/gmock.h>

#include <cstring>
#include <memory>
#include <random>

#include "physics_server/lanes/rotor_bodies.h"
#include "physics_server/world.h"
#include "tests/physics_server/one_body.h"

namespace mascot {
namespace {

using Eigen::Vector3d;
using ::testing::MatchesRegex;
using ::testing::ThrowsMessage;
using Look = World::LookForContacts;

std::vector<double> Numbers(const World& world, int count) {
  std::vector<double> numbers;
  for (int id = 1; id <= count; ++id) {
    const Motion s = world.State(id);
    numbers.insert(numbers.end(), s.p_WB.begin(), s.p_WB.end());
    numbers.insert(numbers.end(), s.v_WB.begin(), s.v_WB.end());
    numbers.insert(numbers.end(), s.q_WB.coeffs().begin(), s.q_WB.coeffs().end());
    numbers.insert(numbers.end(), s.w_WB_B.begin(), s.w_WB_B.end());
  }
  return numbers;
}

bool SameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// The same experiment in two worlds: as we run it, and with Bullet's contact detection at every step.
struct Twins {
  explicit Twins(const Experiment& e) : ours(e, Look::kWhenClose), bullet(e, Look::kAlways), count(e.size()) {}
  void Step(const std::vector<Actuation>& commands) {
    ours.Step(commands);
    bullet.Step(commands);
  }
  bool Same() const { return SameBits(Numbers(ours, count), Numbers(bullet, count)); }
  World ours, bullet;
  int count;
};

/// Agents of all models in wind, with crossing paths, some of them on the ground. Rotors fail, at a tick or within one.
Experiment Swarm(unsigned seed, int count, double half_m = 4) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-half_m, half_m), height(0.5, 4), speed(-3, 3);
  std::vector<Vector3d> places;
  for (int i = 0; i < count; ++i) places.push_back({place(random), place(random), height(random)});
  Experiment e = Bodies("quadrotor", places);
  e.physics.wind.gust_std_m_per_s = 1;
  e.physics.obstacles = {{Shape::kBox, {0, 0, 2}, {0.5, 0.5, 4}, 0.3}, {Shape::kSphere, {3, 3, 3}, {1, 1, 1}, 0}};
  for (AgentConfig& agent : e.agents) {
    agent.v_W = {speed(random), speed(random), 0};
    agent.heading_rad = place(random);
    if (agent.id % 4 == 1) agent.model = "double_integrator";
    if (agent.id % 4 == 2) agent.model = "single_integrator";
    if (agent.id % 4 == 3) agent.model = "unicycle";
    if (agent.id % 8 == 0) agent.airframe = Built("crazyflie");
    if (agent.id % 5 == 0)
      e.physics.rotor_failures.push_back(
          {.agent = agent.id, .rotor = 1 + agent.id % 4, .at_s = 0.001 * (agent.id % 17), .remaining = 0.99});
  }
  return e;
}

std::vector<Actuation> RandomCommands(const Experiment& e, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Actuation> commands;
  for (const AgentConfig& agent : e.agents) {
    const double hover = agent.airframe.HoverRotorSpeed(9.81);
    Actuation command{};
    for (double& value : command)
      value = agent.model == "quadrotor" ? hover * (1 + 0.01 * unit(random)) : 2 * unit(random);
    commands.push_back(command);
  }
  return commands;
}

TEST(FreeSteps, GiveTheBitsOfBulletAsLongAsNothingTouches) {
  constexpr int kCount = 8;
  int flown = 0, near_misses = 0;
  std::int64_t with_contacts = 0, steps = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Experiment e = Swarm(seed, kCount);
    Twins twins(e);
    std::mt19937_64 random(seed);
    bool near_miss = false;
    for (int tick = 0; tick < 150; ++tick) {
      twins.Step(RandomCommands(e, random));
      if (twins.bullet.collisions() > 0) break;
      ASSERT_TRUE(twins.Same()) << "seed " << seed << ", tick " << tick;
      ASSERT_EQ(twins.ours.collisions(), 0);
      near_miss = near_miss || twins.ours.steps_with_contacts() > 0;  // close, but nothing touched
      ++flown;
    }
    near_misses += near_miss;
    with_contacts += twins.ours.steps_with_contacts();
    steps += twins.bullet.steps_with_contacts();
  }
  EXPECT_GT(flown, 1000);
  EXPECT_GT(near_misses, 20);
  EXPECT_LT(with_contacts, steps / 2) << "most of the time nobody was close";
}

TEST(FreeSteps, CountTheSameContactsAsBullet) {
  for (unsigned seed = 100; seed < 130; ++seed) {
    const Experiment e = Swarm(seed, 8);
    Twins twins(e);
    std::mt19937_64 random(seed);
    // Until the first contact, which both worlds must detect at the same tick.
    for (int tick = 0; tick < 300 && twins.bullet.collisions() == 0; ++tick) twins.Step(RandomCommands(e, random));
    EXPECT_EQ(twins.ours.contacts().agents, twins.bullet.contacts().agents) << seed;
    EXPECT_EQ(twins.ours.contacts().ground, twins.bullet.contacts().ground) << seed;
    EXPECT_EQ(twins.ours.contacts().obstacles, twins.bullet.contacts().obstacles) << seed;
  }
}

TEST(FreeSteps, HandOverBeforeFastBodiesTouch) {
  for (const double speed : {0.1, 1.0, 10.0, 60.0}) {  // 6 cm in a step: less than the bodies are thick
    Experiment e = Bodies("double_integrator", {{-5, 0, 10}, {5, 0.05, 10}});
    e.agents[0].v_W = {speed, 0, 0};
    e.agents[1].v_W = {-speed, 0, 0};
    Twins twins(e);
    const std::vector<Actuation> nothing(2);
    while (twins.ours.State(1).p_WB.x() < 3 && twins.ours.State(1).v_WB.x() > 0.5 * speed && twins.ours.tick() < 10'000)
      twins.Step(nothing);
    EXPECT_EQ(twins.ours.contacts().agents, 1) << speed;
    EXPECT_TRUE(twins.Same()) << speed;
  }
}

TEST(FreeSteps, LeaveStackedBodiesToBullet) {
  Experiment e = Bodies("quadrotor", {{0, 0, 0.1}, {0, 0, 0.3}, {0.1, 0, 0.5}, {5, 5, 3}});
  Twins twins(e);
  const std::vector<Actuation> rotors_off(4);
  for (int tick = 0; tick < 300; ++tick) twins.Step(rotors_off);
  EXPECT_EQ(twins.ours.contacts().total(), twins.bullet.contacts().total());
  EXPECT_GT(twins.ours.contacts().total(), 3);
  EXPECT_GT(twins.ours.steps_with_contacts(), 2500) << "they lie there from soon on";
  for (int id = 1; id <= 3; ++id)
    EXPECT_LT((twins.ours.State(id).p_WB - twins.bullet.State(id).p_WB).norm(), 1e-3) << id;
}

// Bullet gets only those bodies that may touch something, and they come and go. What it does with some must not depend
// on the others.
TEST(FreeSteps, OfSomeDoNotDependOnOthersFarAway) {
  constexpr int kCount = 8;
  std::int64_t contacts = 0, alone = 0;
  for (unsigned seed = 300; seed < 320; ++seed) {
    Experiment one = Swarm(seed, kCount), other = Swarm(seed + 1000, kCount);
    one.physics.rotor_failures.clear();  // of both, by numbers that are not those of the team
    one.physics.wind = other.physics.wind = {};
    Experiment both = one;
    both.agents.clear();
    for (int i = 0; i < kCount; ++i) {
      both.agents.push_back(one.agents[static_cast<std::size_t>(i)]);
      both.agents.push_back(other.agents[static_cast<std::size_t>(i)]);
      both.agents.back().p_W.x() += 1000;
    }
    for (int id = 1; id <= 2 * kCount; ++id) both.agents[static_cast<std::size_t>(id - 1)].id = id;
    World alone_world(one), world(both);
    std::mt19937_64 random(seed);
    for (int tick = 0; tick < 300; ++tick) {
      const std::vector<Actuation> commands = RandomCommands(one, random), of_others = RandomCommands(other, random);
      std::vector<Actuation> of_all;
      for (std::size_t i = 0; i < kCount; ++i) of_all.insert(of_all.end(), {commands[i], of_others[i]});
      alone_world.Step(commands);
      world.Step(of_all);
      for (int id = 1; id <= kCount; ++id)
        ASSERT_TRUE(alone_world.State(id).p_WB == world.State(2 * id - 1).p_WB &&
                    alone_world.State(id).q_WB.coeffs() == world.State(2 * id - 1).q_WB.coeffs())
            << "seed " << seed << ", tick " << tick << ", agent " << id;
    }
    contacts += alone_world.collisions();
    alone += world.collisions() - alone_world.collisions();
  }
  EXPECT_GT(contacts, 50);
  EXPECT_GT(alone, 20) << "the others touch each other, and come and go, too";
}

TEST(FreeSteps, SeeABodyThatIsThrownOutOfItsBox) {
  // A heavy body takes a light one, which lay still, along before itself. In the same tick that hits another one, to
  // which the heavy body does not come.
  Airframe light = Built("crazyflie");
  light.size_m.x() = 0.3;
  const double speed = 30, half_m = Built("mascot").size_m.x() / 2;
  const double front_m = -0.2, reached_m = front_m + speed * 0.01;
  int beyond_reach = 0;
  for (double rear_m = 0.2; rear_m < 0.45; rear_m += 0.01) {
    Experiment e = Bodies("quadrotor", {{front_m - half_m, 0, 10}, {0, 0, 10}, {rear_m + 0.15, 0, 10}}, light);
    e.agents[0].airframe = Built("mascot");
    e.agents[0].v_W = {speed, 0, 0};
    Twins twins(e);
    const std::vector<Actuation> nothing(3);
    twins.Step(nothing);
    EXPECT_EQ(twins.ours.contacts().agents, twins.bullet.contacts().agents) << rear_m;
    EXPECT_TRUE(twins.Same()) << rear_m;
    beyond_reach += twins.ours.contacts().agents == 2 && rear_m > std::max(reached_m, 0.15) + 0.05;
  }
  EXPECT_GT(beyond_reach, 5);
}

TEST(FreeSteps, AreTakenAgainWhenBodiesHaveSeparated) {
  Experiment e = Bodies("double_integrator", {{-1, 0, 10}, {1, 0, 10}});
  e.agents[0].v_W = {2, 0, 0};
  World world(e);
  const std::vector<Actuation> nothing(2);
  std::int64_t last = -1;
  for (int tick = 0; tick < 400; ++tick) {
    if (tick == 300) last = world.steps_with_contacts();
    std::vector<Actuation> commands = nothing;
    if (tick > 100) commands[0][0] = -5;  // away from each other
    world.Step(commands);
  }
  EXPECT_GE(world.contacts().agents, 1);
  EXPECT_EQ(world.steps_with_contacts(), last);
  EXPECT_LT(last, 1500);
}

TEST(FreeSteps, DetectNoContactsForHoveringTeams) {
  World world(Bodies("quadrotor", {{0, 0, 1}, {0, 0, 1.5}, {0, 0, 2}}));  // above each other, as after a meeting
  const double hover = Built("mascot").HoverRotorSpeed(9.81);
  const std::vector<Actuation> commands(3, Actuation{hover, hover, hover, hover});
  for (int tick = 0; tick < 500; ++tick) world.Step(commands);
  EXPECT_EQ(world.steps_with_contacts(), 0);
}

TEST(FreeSteps, GiveTheSameBitsWithAnyNumberOfLanes) {
  std::int64_t with_contacts = 0, steps = 0, contacts = 0;
  for (unsigned seed = 200; seed < 220; ++seed) {
    // Any number of bodies with rotors fills the last lanes or does not.
    const int count = 5 + static_cast<int>(seed % 7);
    Experiment e = Swarm(seed, count);
    if (seed % 2 == 0)
      for (AgentConfig& agent : e.agents) agent.model = "quadrotor";
    World one(e, Look::kWhenClose, 1);
    std::vector<std::unique_ptr<World>> others;
    for (const int lanes : LanesOfRotors()) others.push_back(std::make_unique<World>(e, Look::kWhenClose, lanes));
    std::mt19937_64 random(seed);
    for (int tick = 0; tick < 300; ++tick) {
      const std::vector<Actuation> commands = RandomCommands(e, random);
      one.Step(commands);
      for (const auto& other : others) {
        other->Step(commands);
        ASSERT_TRUE(SameBits(Numbers(one, count), Numbers(*other, count))) << "seed " << seed << ", tick " << tick;
      }
    }
    with_contacts += one.steps_with_contacts();
    contacts += one.collisions();
    steps += 3000;
  }
  EXPECT_GT(contacts, 20);
  EXPECT_GT(with_contacts, steps / 20);
  EXPECT_LT(with_contacts, steps * 19 / 20);
}

TEST(FreeSteps, GiveTheSameBitsWithAnyNumberOfThreads) {
  std::int64_t contacts = 0;
  for (unsigned seed = 400; seed < 404; ++seed) {
    const int count = 3 * kMinAgentsPerThread + static_cast<int>(seed % 7);
    const Experiment e = Swarm(seed, count, 6);
    Crew two(2), three(3);
    World one(e);
    World others[] = {World(e, Look::kWhenClose, World::kAllLanes, two), World(e, Look::kWhenClose, 1, three)};
    std::mt19937_64 random(seed);
    for (int tick = 0; tick < 150; ++tick) {
      const std::vector<Actuation> commands = RandomCommands(e, random);
      one.Step(commands);
      for (World& other : others) {
        other.Step(commands);
        ASSERT_TRUE(SameBits(Numbers(one, count), Numbers(other, count))) << "seed " << seed << ", tick " << tick;
      }
    }
    contacts += one.collisions();
  }
  EXPECT_GT(contacts, 40);
}

TEST(FreeSteps, OfSeveralThreadsNameTheFirstAgentThatFails) {
  std::vector<Vector3d> places;
  for (int i = 0; i < 3 * kMinAgentsPerThread; ++i) places.push_back({2.0 * i, 0, 2});
  for (const int members : {1, 2, 3}) {
    Crew crew(members);
    World world(Bodies("double_integrator", places), Look::kWhenClose, World::kAllLanes, crew);
    std::vector<Actuation> commands(places.size());
    for (const std::size_t i : {41, 50, 90}) commands[i][0] = 1e308;
    EXPECT_THAT(
        [&] {
          for (int tick = 0; tick < 1000; ++tick) world.Step(commands);
        },
        ThrowsMessage<std::runtime_error>(MatchesRegex("tick [0-9]+: agent 42: its state is not finite")));
  }
}

TEST(FreeSteps, OfBodiesThatSpinOrLieOnTheirBacksAreThoseOfBullet) {
  Airframe airframe = WithoutDrag();
  airframe.inertia_kg_m2 *= 0.005;
  const Experiment e =
      Bodies("quadrotor", {{0, 0, 500}, {50, 0, 500}, {100, 0, 500}, {150, 0, 500}, {200, 0, 500}}, airframe);
  Twins twins(e);
  std::mt19937_64 random(1);
  double most_turned = 1, fastest = 0;
  for (int tick = 0; tick < 200; ++tick) {
    // One rotor alone turns its body over, and faster and faster, beyond what Bullet turns a body by in a step.
    std::vector<Actuation> commands(5, Actuation{});
    for (std::size_t i = 0; i < 4; ++i) commands[i][i] = 1e4;
    twins.Step(commands);
    ASSERT_TRUE(twins.Same()) << "tick " << tick;
    for (int id = 1; id <= 5; ++id) {
      most_turned = std::min(most_turned, twins.ours.State(id).q_WB.toRotationMatrix()(2, 2));
      fastest = std::max(fastest, twins.ours.State(id).w_WB_B.norm());
    }
  }
  EXPECT_LT(most_turned, -0.9);
  EXPECT_GT(fastest, 785);
  EXPECT_EQ(twins.ours.steps_with_contacts(), 0);
}

}  // namespace
}  // namespace mascot
