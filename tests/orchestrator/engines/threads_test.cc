// Runs in one process give the same bits, whatever the number of threads that compute them.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/crew.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/team/row_sink.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

/// Keeps the bytes of all rows, one after the other.
class Bytes final : public RowSink {
 public:
  void Add(const FlownRow& row) override {
    const Row& bytes = row.bytes();
    for (const auto* samples : {&bytes.states, &bytes.commands, &bytes.messages, &bytes.events})
      for (const Row::Bytes& sample : *samples) all.insert(all.end(), sample.begin(), sample.end());
  }
  std::vector<std::uint8_t> all;
};

struct Outcome {
  std::vector<std::uint8_t> bytes;
  std::string failure;
  std::int64_t contacts = 0;
  double fidelity_rms_m = 0;
};

Outcome Fly(const std::string& toml, int threads) {
  const Experiment experiment = Load(toml);
  Crew crew(threads);
  Bytes bytes;
  RunMeter meter(experiment, crew);
  const EngineResult result = RunInProcess(
      experiment, {&bytes, &meter}, [] { return true; }, nullptr, crew);
  return {.bytes = bytes.all,
          .failure = result.failure,
          .contacts = result.contacts.value().total(),
          .fidelity_rms_m = meter.Result().fidelity->rms_m};
}

/// A team that is large enough for several threads, in little room.
std::string Crowd(const std::string& more) {
  return "run.duration_s = 1.5\ngraph.topology = 'ring'\nphysics.collisions = true\nagents = { count = 110, "
         "random = { min_separation_m = 0.7, min_m = [-4, -4, 2], max_m = [4, 4, 6] } }\n" +
         more;
}

constexpr int kThreads[] = {2, 3, 8};

TEST(Threads, GiveTheSameBits) {
  std::int64_t contacts = 0;
  for (const std::string& more : std::vector<std::string>{
           "law = { name = 'consensus', axes = 'xyz' }\n",
           "law = { name = 'consensus', axes = 'xyz' }\nlink = { loss = 0.2, delay_s = 0.03, jitter_s = 0.02 }\n"
           "sensors.own.position_std_m = 0.01\nphysics.wind.gust_std_m_per_s = 1\n",
           "law = { name = 'event_triggered', axes = 'xyz' }\n",  // sends messages
           "law = { name = 'consensus', axes = 'xyz' }\n[[events]]\nat_s = 0.5\nset = { law.p_gain = 2.0 }\n"
           "[[events]]\nat_s = 1.0\nset = { link.loss = 0.3 }\n",
       }) {
    const Outcome one = Fly(Crowd(more), 1);
    EXPECT_EQ(one.failure, "");
    EXPECT_GT(one.fidelity_rms_m, 0);
    contacts += one.contacts;
    for (const int threads : kThreads) {
      const Outcome other = Fly(Crowd(more), threads);
      EXPECT_EQ(other.failure, "");
      EXPECT_TRUE(one.bytes == other.bytes) << threads << " threads: " << more;
      EXPECT_EQ(one.contacts, other.contacts);
      EXPECT_EQ(one.fidelity_rms_m, other.fidelity_rms_m);
    }
  }
  EXPECT_GT(contacts, 20) << "contacts come and go";
}

TEST(Threads, LeaveLawsOfUsersToOne) {
  // The law would see it if two agents were asked at the same time, or in another order.
  const std::string law = Crowd(
      "law = { name = 'custom', axes = 'xyz', python = '''\n"
      "import sys\n"
      "def control(t, me, neighbours):\n"
      "  before = getattr(sys, 'last_asked', 0)\n"
      "  sys.last_asked = me.id\n"
      "  assert me.id in (1, before + 1), f'after {before}'\n"
      "  return [0, 0, 0]\n"
      "''' }\n");
  EXPECT_EQ(Fly(law, 3).failure, "");
  EXPECT_TRUE(Fly(law, 1).bytes == Fly(law, 3).bytes);
}

}  // namespace
}  // namespace mascot
