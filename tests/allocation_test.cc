// From tick to tick nothing of ours is allocated, in the real processes; what the middleware allocates is printed.
#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <sstream>
#include <string>

#include "tests/orchestrator.h"

namespace mascot {
namespace {

using namespace test;

/// Calls of malloc, by the program whose processes made them ("agent": all of them together), then by the file that
/// the calling code lies in.
using Allocations = std::map<std::string, std::map<std::string, long>>;

Allocations Read(const std::filesystem::path& folder) {
  Allocations all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {  // agent.1234
    std::istringstream lines(ReadFile(entry.path().string()));
    long count = 0;
    for (std::string file; lines >> count >> file;)
      all[entry.path().stem().string()][std::filesystem::path(file).filename().string()] += count;
  }
  return all;
}

constexpr int kAgents = 4;

/// Of a whole run of so many ticks.
Allocations AllocationsOf(int ticks, const std::string& engine, const std::string& more) {
  ScratchFolder folder;
  const std::filesystem::path counts = folder.path() / "counts";
  std::filesystem::create_directory(counts);
  WriteFile(folder.File("a.toml"), "[run]\nduration_s = " + std::to_string(ticks / 100) +
                                       ".0\n[output]\nsave_plot = false\n[agents]\ncount = " + std::to_string(kAgents) +
                                       "\nrandom = { min_m = [-9, -9, 1], max_m = [9, 9, 9] }\n" + more);
  const std::string preload = MASCOT_BINARY_DIR "/tests/preload/libcount_allocations.so";
  const Ran ran = Shell("LD_PRELOAD=" + preload + " MASCOT_ALLOCATIONS=" + counts.string() +
                        " " MASCOT_BINARY_DIR "/orchestrator up " + folder.File("a.toml") + " --engine " + engine +
                        " --quiet --out " + folder.File("run"));
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  return Read(counts);
}

constexpr int kFew = 500, kMore = 10500, kTicks = kMore - kFew;
/// An allocation per tick would be kTicks. How often a process reports while it starts is chance; the recording
/// allocates a little for each of its chunks, of 100 ticks.
constexpr int kTolerance = kTicks / 10;

/// Of kTicks ticks: what a longer run takes beyond a shorter one, which has the same start and end.
Allocations AllocationsOfTicks(const std::string& engine, const std::string& experiment) {
  const Allocations few = AllocationsOf(kFew, engine, experiment);
  Allocations more = AllocationsOf(kMore, engine, experiment);
  EXPECT_FALSE(few.empty()) << "nobody counted";
  for (const auto& [program, files] : few) {
    EXPECT_GT(files.at(program), 0) << "those of the start are counted";
    for (const auto& [file, count] : files) more[program][file] -= count;
  }
  for (const auto& [program, files] : more)
    for (const auto& [file, count] : files)
      if (count > kTolerance) std::cout << program << ": " << count * 1.0 / kTicks << " per tick by " << file << '\n';
  return more;
}

class AllocationsOverDds : public testing::TestWithParam<const char*> {};

TEST_P(AllocationsOverDds, OfOursAreNoneFromTickToTick) {
  Allocations counted = AllocationsOfTicks("dds", GetParam());
  for (const char* program : {"agent", "physics_server"})
    EXPECT_LT(counted.at(program)[program], kTolerance) << program;
  // The recorder's rows find their sizes; each batch of them is confirmed.
  EXPECT_LT(counted.at("orchestrator")["orchestrator"], kTicks);
}

INSTANTIATE_TEST_SUITE_P(Experiments, AllocationsOverDds,
                         testing::Values("[graph]\ntopology = 'ring'\n",
                                         "[graph]\ntopology = 'ring'\n[network]\ndelivery = 'bundled'\n"
                                         "agents_per_process = 2\n"));

class AllocationsInOneProcess : public testing::TestWithParam<const char*> {};

TEST_P(AllocationsInOneProcess, OfOursAreNoneFromTickToTick) {
  EXPECT_LT(AllocationsOfTicks("inprocess", GetParam()).at("orchestrator")["orchestrator"], kTolerance);
}

INSTANTIATE_TEST_SUITE_P(
    Experiments, AllocationsInOneProcess,
    testing::Values("[law]\np_gain = 0.1\n",
                    "[graph]\ntopology = 'ring'\n[link]\nloss = 0.2\ndelay_s = 0.05\njitter_s = 0.02\n",
                    "[physics]\nwind = { gust_std_m_per_s = 1.0 }\n[sensors.own]\nposition_std_m = 0.01\n[law]\nname = "
                    "'formation'\nshape = 'circle'\n",
                    "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1, 1.5, 2]\n",
                    "[physics]\ncollisions = false\n[law]\nname = 'waypoint'\nwaypoints_m = [[1, 1, 1], [2, 2, "
                    "2]]\n[graph]\nrange_m = 5.0\n"));

}  // namespace
}  // namespace mascot
