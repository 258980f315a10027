// In the processes of a run nothing of ours is allocated from tick to tick; what the middleware allocates is printed.
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
Allocations AllocationsOf(int ticks, const std::string& more) {
  ScratchFolder folder;
  const std::filesystem::path counts = folder.path() / "counts";
  std::filesystem::create_directory(counts);
  WriteFile(folder.File("ring.toml"), "[run]\nduration_s = " + std::to_string(ticks / 100) + ".0\n[agents]\ncount = " +
                                          std::to_string(kAgents) +
                                          "\nrandom = { min_m = [-9, -9, 1], max_m = [9, 9, 9] }\n[graph]\n"
                                          "topology = 'ring'\n[output]\nsave_plot = false\n" +
                                          more);
  const std::string preload = MASCOT_BINARY_DIR "/tests/preload/libcount_allocations.so";
  const Ran ran = Shell("LD_PRELOAD=" + preload + " MASCOT_ALLOCATIONS=" + counts.string() + " " MASCOT_BINARY_DIR
                        "/orchestrator up " + folder.File("ring.toml") + " --quiet --out " + folder.File("run"));
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  return Read(counts);
}

class WireAllocations : public testing::TestWithParam<const char*> {};

TEST_P(WireAllocations, OfOursAreNoneFromTickToTick) {
  constexpr int kFew = 500, kMore = 10500, kTicks = kMore - kFew;  // what the start takes, both take
  const Allocations few = AllocationsOf(kFew, GetParam());
  Allocations more = AllocationsOf(kMore, GetParam());
  for (const auto& [program, files] : few)
    for (const auto& [file, count] : files) more[program][file] -= count;
  for (const auto& [program, files] : more)
    for (const auto& [file, count] : files)
      if (count > kTicks / 100) std::cout << program << ": " << count * 1.0 / kTicks << " per tick by " << file << '\n';
  // How often a process reports while it starts is chance; an allocation per tick would be kTicks, in each process.
  EXPECT_LT(more["agent"]["agent"], kTicks / 20);
  EXPECT_LT(more["physics_server"]["physics_server"], kTicks / 20);
  EXPECT_LT(more["orchestrator"]["orchestrator"], kTicks / 5) << "a few for each chunk of the recording";
  EXPECT_GT(few.at("agent").at("agent"), 0) << "those of the start are counted";
}

INSTANTIATE_TEST_SUITE_P(Experiments, WireAllocations,
                         testing::Values("", "[network]\ndelivery = 'bundled'\nagents_per_process = 2\n"));

}  // namespace
}  // namespace mascot
