// Cost of single operations: a call of a law, a tick of the world, a row of the recording. Google Benchmark.
#include <benchmark/benchmark.h>

#include <chrono>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "agent/agent.h"
#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/recording/run_writer.h"
#include "physics_server/world.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

Experiment Load(int agents, const std::string& more) {
  const std::string top = std::to_string(2 + agents);
  const std::string text = "[run]\nduration_s = 100000.0\n[agents]\ncount = " + std::to_string(agents) +
                           "\nrandom = { min_m = [-99, -99, 1], max_m = [99, 99, " + top + "] }\n" + more;
  return LoadExperiment(Section::FromText(text, "bench.toml"), "bench");
}

// --- laws: an agent that hears five others --------------------------------------------------------------

void CallLaw(benchmark::State& state, const std::string& law) try {
  Experiment experiment = Load(6, "[law]\n" + law);
  Agent agent(experiment, 1);
  std::vector<Motion> motions(6);
  std::vector<Sample> samples;
  for (const AgentConfig& config : experiment.agents) {
    motions[static_cast<std::size_t>(config.id - 1)].p_WB = config.p_W;
    if (config.id > 1) samples.push_back({&motions[static_cast<std::size_t>(config.id - 1)]});
  }
  agent.AwaitLaw();
  std::int64_t tick = 0;
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(agent.Want(tick++, motions[0], samples));
} catch (const std::exception& failure) {  // there may be no Octave
  state.SkipWithError(failure.what());
}

constexpr const char* kNothing =
    "name = 'custom'\npython = '''\ndef control(t, me, neighbours):\n    return 0.0, 0.0\n'''\n";
constexpr const char* kConsensus = R"(name = 'custom'
python = '''
def control(t, me, neighbours):
    a = -me.velocity
    for j in neighbours:
        a += j.weight * (j.position - me.position)
    return a
'''
)";

constexpr const char* kNothingInOctave =
    "name = 'octave'\noctave = '''\nfunction a = control(t, me, neighbours)\n  a = [0 0];\nend\n'''\n";
constexpr const char* kConsensusInOctave = R"(name = 'octave'
octave = '''
function a = control(t, me, neighbours)
  a = -me.velocity;
  for j = neighbours
    a = a + j.weight * (j.position - me.position);
  end
end
'''
)";

BENCHMARK_CAPTURE(CallLaw, cpp_consensus, std::string("name = 'consensus'\n"));
BENCHMARK_CAPTURE(CallLaw, python_nothing, std::string(kNothing));
BENCHMARK_CAPTURE(CallLaw, python_consensus, std::string(kConsensus));
BENCHMARK_CAPTURE(CallLaw, octave_nothing, std::string(kNothingInOctave))->UseRealTime();
BENCHMARK_CAPTURE(CallLaw, octave_consensus, std::string(kConsensusInOctave))->UseRealTime();

// --- physics: a tick of ten steps -----------------------------------------------------------------------

void StepWorld(benchmark::State& state, World::LookForContacts look) {
  const auto agents = static_cast<int>(state.range(0));
  const Experiment experiment = Load(agents, "");
  World world(experiment, look);
  const double hover = experiment.agent(1).airframe.HoverRotorSpeed(experiment.physics.gravity_m_per_s2);
  const std::vector<Actuation> commands(static_cast<std::size_t>(agents), Actuation{hover, hover, hover, hover});
  for ([[maybe_unused]] auto _ : state) world.Step(commands);
  state.SetItemsProcessed(state.iterations() * agents * experiment.steps_per_tick());
}

BENCHMARK_CAPTURE(StepWorld, when_close, World::LookForContacts::kWhenClose)->Arg(10)->Arg(100)->Arg(1000);
BENCHMARK_CAPTURE(StepWorld, always, World::LookForContacts::kAlways)->Arg(10)->Arg(100)->Arg(1000);

// --- recording: a row, with its metrics, to the disk ----------------------------------------------------

void RecordRow(benchmark::State& state) {
  const auto agents = static_cast<int>(state.range(0));
  Experiment experiment = Load(agents, "[output]\nfidelity = false\n");
  const ScratchFolder scratch;
  const RunFolder folder(scratch.File("run"), experiment, false);
  RunWriter writer(experiment, folder, "");
  RunMeter meter(experiment);
  RowFeed feed(experiment, {&writer, &meter});
  DecodedRow row(agents);
  std::int64_t tick = 0;
  for ([[maybe_unused]] auto _ : state) {
    for (std::size_t i = 0; i < row.motions.size(); ++i) row.motions[i].p_WB.x() += 1e-3 * static_cast<double>(i);
    feed.Add(tick++, row);
  }
  writer.Close("");
  const auto samples = static_cast<std::int64_t>(writer.samples());
  state.SetItemsProcessed(samples);
  constexpr std::int64_t kSampleBytes = 144;  // average of a state and a command
  state.SetBytesProcessed(samples * kSampleBytes);
}

BENCHMARK(RecordRow)->Arg(10)->Arg(100);

// --- events: one by hand, in a team whose file has some for later ---------------------------------------

constexpr int kTeam = 200;

/// A law with a list of places, one for each agent; the events of the file set another of its keys than the one by
/// hand.
Experiment WithEvents(int events) {
  std::string offsets, later;
  for (int id = 1; id <= kTeam; ++id) offsets += "[" + std::to_string(id) + ".5, 0, 0], ";
  for (int k = 1; k <= events; ++k)
    later += "[[events]]\nat_s = " + std::to_string(50000 + k) + ".0\nset = { \"law.v_gain\" = " + std::to_string(k) +
             ".5 }\n";
  return Load(kTeam, "[graph]\ntopology = 'ring'\n[law]\nname = 'formation'\noffsets_m = [" + offsets +
                         "]\n[output]\nfidelity = false\n" + later);
}

constexpr const char* kByHand = "set = { \"law.p_gain\" = 0.5 }";

/// Until it is granted, in the orchestrator.
void AskForEvent(benchmark::State& state) {
  const Experiment experiment = WithEvents(static_cast<int>(state.range(0)));
  RunRequests requests(experiment, 0);
  requests.Open();
  const std::jthread run([&requests](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      requests.WaitUntil(std::chrono::steady_clock::now() + std::chrono::milliseconds(10));
      if (requests.Next()) requests.Done(7);
    }
  });
  for ([[maybe_unused]] auto _ : state)
    if (!requests.Ask({.kind = Request::Kind::kEvent, .toml = kByHand}).granted) state.SkipWithError("refused");
}

BENCHMARK(AskForEvent)->Arg(0)->Arg(100)->UseRealTime()->Unit(benchmark::kMillisecond);

/// What each process of a run does with one that has come.
void TakeEvent(benchmark::State& state) {
  const Experiment experiment = WithEvents(static_cast<int>(state.range(0)));
  LiveExperiment live(experiment, &LawTable(), /*checked=*/true);
  for ([[maybe_unused]] auto _ : state) {
    live.Take(EventFrom(7, kByHand, kTeam, "event by hand"));
    benchmark::DoNotOptimize(live.now());
  }
}

BENCHMARK(TakeEvent)->Arg(0)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mascot

BENCHMARK_MAIN();
