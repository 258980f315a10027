// Nothing is allocated from tick to tick: every call of malloc in this program is counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <string>

#include "agent/laws.h"
#include "orchestrator/row_encoder.h"
#include "orchestrator/run_meter.h"
#include "orchestrator/state_arrays.h"
#include "orchestrator/team.h"
#include "physics_server/world.h"

namespace {
std::atomic<long> allocations = 0;
}

// What the C++ library's operators new call, and Bullet.
extern "C" void* __libc_malloc(std::size_t bytes);
extern "C" void* malloc(std::size_t bytes) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(bytes);
}

namespace mascot {
namespace {

/// Calls of malloc while `work` runs.
template <class Work>
long AllocationsOf(const Work& work) {
  const long before = allocations;
  work();
  return allocations - before;
}

TEST(Allocations, AreCounted) {
  EXPECT_GE(AllocationsOf([] { delete new std::string(100, 'x'); }), 2);
}

Experiment Load(const std::string& more) {
  const std::string text =
      "[run]\nduration_s = 100.0\n[agents]\ncount = 6\nrandom = { min_m = [-9, -9, 1], max_m = [9, 9, 9] }\n" + more;
  return LoadExperiment(Section::FromText(text, "a.toml"), "a");
}

/// Everything that one tick costs but the writing of files: laws, low-level stacks, links, physics, the wire's bytes,
/// what is measured.
class Ticks {
 public:
  explicit Ticks(const std::string& more)
      : experiment_(Load(more)),
        world_(experiment_),
        team_(experiment_),
        encoder_(experiment_),
        meter_(experiment_),
        row_(experiment_.size()),
        decoded_(experiment_.size()),
        arrays_(experiment_.size()),
        actuation_(static_cast<std::size_t>(experiment_.size())) {}

  void Run(int ticks) {
    for (int k = 0; k < ticks; ++k) {
      const std::int64_t tick = world_.tick();
      for (const AgentConfig& agent : experiment_.agents)
        row_.motions[static_cast<std::size_t>(agent.id - 1)] = world_.State(agent.id);
      for (const AgentConfig& agent : experiment_.agents) {
        const auto i = static_cast<std::size_t>(agent.id - 1);
        row_.commands[i] = team_.Decide(agent.id, tick, row_.motions);
        actuation_[i] = row_.commands[i].actuator;
      }
      team_.EndTick();
      decoded_.Take(encoder_.Encode(tick, row_));
      arrays_.Set(experiment_.time_s(tick), decoded_);
      meter_.Add(tick, decoded_);
      world_.Step(actuation_);
    }
  }

 private:
  Experiment experiment_;
  World world_;
  Team team_;
  RowEncoder encoder_;
  RunMeter meter_;
  DecodedRow row_, decoded_;
  StateRow arrays_;
  std::vector<Actuation> actuation_;
};

class Allocations : public testing::TestWithParam<const char*> {};

TEST_P(Allocations, AreNoneFromTickToTick) {
  Ticks ticks(GetParam());
  ticks.Run(200);  // buffers find their sizes
  EXPECT_EQ(AllocationsOf([&] { ticks.Run(500); }), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Experiments, Allocations,
    testing::Values("[law]\np_gain = 0.1\n",
                    "[graph]\ntopology = 'ring'\n[link]\nloss = 0.2\ndelay_s = 0.05\njitter_s = 0.02\n",
                    "[physics]\nwind = { gust_std_m_per_s = 1.0 }\n[sensors.own]\nposition_std_m = 0.01\n[law]\nname = "
                    "'formation'\nshape = 'circle'\n",
                    "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1, 1.5, 2, 2.5, 3]\n",
                    "[physics]\ncollisions = false\n[law]\nname = 'waypoint'\nwaypoints_m = [[1, 1, 1], [2, 2, "
                    "2]]\n[graph]\nrange_m = 5.0\n"));

}  // namespace
}  // namespace mascot
