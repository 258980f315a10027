// Our code allocates no memory during ticks, in the real processes. The allocations of the middleware are printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

#include "tests/support/orchestrator.h"
#include "tests/support/param_name.h"

namespace mascot {
namespace {

using namespace test;

/// Number of malloc calls, by program (sum over its processes), then by the executable or library of the calling code.
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
constexpr std::array kPrograms = {"agent", "physics_server", "orchestrator"};

/// What to put in front of a command so that it has a /dev/shm of its own; empty where that is not allowed. The
/// orchestrator looks at first through all processes of the machine if there is shared memory of other runs.
std::string Alone() {
  constexpr const char* kApart = "unshare --mount sh -c 'mount -t tmpfs none /dev/shm && exec \"$@\"' sh env ";
  static const bool allowed = Shell(std::string(kApart) + "true").exit_code == 0;
  return allowed ? kApart : "";
}

/// Allocations of a whole run of `ticks` ticks.
Allocations AllocationsOf(int ticks, const std::string& engine, const std::string& more) {
  ScratchFolder folder;
  const std::filesystem::path counts = folder.path() / "counts";
  std::filesystem::create_directory(counts);
  WriteFile(folder.File("a.toml"), "[run]\nduration_s = " + std::to_string(ticks / 100) +
                                       ".0\n[output]\nsave_plot = false\n[agents]\ncount = " + std::to_string(kAgents) +
                                       "\nrandom = { min_m = [-9, -9, 1], max_m = [9, 9, 9] }\n" + more);
  const std::string preload = MASCOT_BINARY_DIR "/tests/preload/libcount_allocations.so";
  const Ran ran = Shell(Alone() + "LD_PRELOAD=" + preload + " MASCOT_ALLOCATIONS=" + counts.string() +
                        " " MASCOT_BINARY_DIR "/orchestrator up " + folder.File("a.toml") + " --engine " + engine +
                        " --quiet --out " + folder.File("run"));
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  return Read(counts);
}

constexpr int kFew = 500, kMore = 10500, kTicks = kMore - kFew;
/// How many allocations of its own a program over DDS may make in kTicks ticks; one per tick would be kTicks. The
/// number of reports during the start varies, and on a busy machine a process waits again and again. The orchestrator
/// allocates a little for each chunk of 100 ticks of the recording, and more for chunks that end up larger than all
/// before.
constexpr int kTolerable = kTicks / 2;

/// For each program and file, the smaller of two counts.
void TakeFewer(const Allocations& other, Allocations& counts) {
  for (const auto& [program, files] : other)
    for (const auto& [file, count] : files) {
      const auto known = counts[program].emplace(file, count).first;
      known->second = std::min(known->second, count);
    }
}

/// Allocations of kTicks ticks: the difference between a longer and a shorter run, whose start and end are the same.
/// On a busy machine they are not: processes wait longer for each other. So a difference that is too large counts only
/// if more runs do not reduce it.
Allocations AllocationsOfTicks(const std::string& engine, const std::string& experiment) {
  constexpr int kMostAttempts = 4;
  Allocations few, more, ticks;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    TakeFewer(AllocationsOf(kFew, engine, experiment), few);
    TakeFewer(AllocationsOf(kMore, engine, experiment), more);
    ticks = more;
    for (const auto& [program, files] : few)
      for (const auto& [file, count] : files) ticks[program][file] -= count;
    if (std::ranges::all_of(kPrograms, [&](const char* p) { return ticks[p][p] < kTolerable; })) break;
  }
  EXPECT_FALSE(few.empty()) << "nobody counted";
  for (const auto& [program, files] : few) EXPECT_GT(files.at(program), 0) << "those of the start are counted";
  for (const auto& [program, files] : ticks)
    for (const auto& [file, count] : files)
      if (count > kTolerable) std::cout << program << ": " << count * 1.0 / kTicks << " per tick by " << file << '\n';
  return ticks;
}

/// An experiment and its name.
struct Setup {
  const char* name;
  const char* toml;
};

void PrintTo(const Setup& setup, std::ostream* out) { *out << testing::PrintToString(std::string(setup.toml)); }

std::string NameOf(const testing::TestParamInfo<Setup>& row) { return ParamName(row.param.name); }

class AllocationsOverDds : public testing::TestWithParam<Setup> {};

TEST_P(AllocationsOverDds, AreNeverMadeByOurCodeInATick) {
  Allocations counted = AllocationsOfTicks("dds", GetParam().toml);
  for (const char* program : kPrograms) EXPECT_LT(counted.at(program)[program], kTolerable) << program;
}

INSTANTIATE_TEST_SUITE_P(Experiments, AllocationsOverDds,
                         testing::Values(Setup{"topics", "[graph]\ntopology = 'ring'\n"},
                                         Setup{"bundled in processes of 2",
                                               "[graph]\ntopology = 'ring'\n[network]\ndelivery = 'bundled'\n"
                                               "agents_per_process = 2\n"}),
                         NameOf);

class AllocationsInOneProcess : public testing::TestWithParam<Setup> {};

TEST_P(AllocationsInOneProcess, AreNeverMadeByOurCodeInATick) {
  EXPECT_LT(AllocationsOfTicks("inprocess", GetParam().toml).at("orchestrator")["orchestrator"], kTicks / 10);
}

INSTANTIATE_TEST_SUITE_P(
    Experiments, AllocationsInOneProcess,
    testing::Values(
        Setup{"consensus", "[law]\np_gain = 0.1\n"},
        Setup{"lossy late links", "[graph]\ntopology = 'ring'\n[link]\nloss = 0.2\ndelay_s = 0.05\njitter_s = 0.02\n"},
        Setup{"formation in gusts with noisy sensors",
              "[physics]\nwind = { gust_std_m_per_s = 1.0 }\n[sensors.own]\nposition_std_m = 0.01\n"
              "[law]\nname = 'formation'\nshape = 'circle'\n"},
        Setup{"minmax", "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1, 1.5, 2]\n"},
        Setup{"past obstacles",
              "[physics]\nobstacles = [{ shape = 'box', position_m = [0, 0, 30], size_m = [1, 1, 1] }]\n"
              "[sensors]\nrange_m = 50.0\n"
              "[law]\nname = 'avoidance'\ngoals_m = [[9, 9, 1], [-9, 9, 1], [9, -9, 1], [-9, -9, 1]]\n"},
        Setup{"waypoints with links of limited range",
              "[physics]\ncollisions = false\n[law]\nname = 'waypoint'\nwaypoints_m = [[1, 1, 1], [2, 2, 2]]\n"
              "[graph]\nrange_m = 5.0\n"}),
    NameOf);

}  // namespace
}  // namespace mascot
