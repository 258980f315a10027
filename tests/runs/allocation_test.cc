// Our code allocates no memory during ticks, in the real processes. The allocations of the middleware are printed.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "tests/support/folders.h"
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
    auto& of_program = all[entry.path().stem().string()];  // also if it has made none
    long count = 0;
    for (std::string file; lines >> count >> file;)
      of_program[std::filesystem::path(file).filename().string()] += count;
  }
  return all;
}

constexpr std::array kPrograms = {"agent", "physics_server", "orchestrator"};

/// Writes an experiment of four agents that draws no picture.
void WriteExperiment(const std::string& path, const std::string& more) {
  WriteFile(
      path,
      "[output]\nsave_plot = false\n[agents]\ncount = 4\nrandom = { min_m = [-9, -9, 1], max_m = [9, 9, 9] }\n" + more);
}

const std::string kPreload = "LD_PRELOAD=" + test::BuildFolder() + "/tests/preload/libcount_allocations.so";
// --- over DDS: what is allocated between two ticks of one run ---------------------------------------

/// Waits until the recording of a run has become longer so many times. Each time, a chunk of 100 ticks has been
/// written.
void AwaitChunks(const std::filesystem::path& recording, int count, const Running& up) {
  std::uintmax_t size = 0, last = 0;
  int chunks = -1;  // the first look sees what was there before
  const auto are_there = [&] {
    std::error_code none_yet;
    const std::uintmax_t now = std::filesystem::file_size(recording, none_yet);
    const bool is_being_written = std::exchange(last, now) != now;
    if (none_yet || is_being_written || now == size) return false;
    size = now;
    return ++chunks >= count;
  };
  EXPECT_TRUE(Await(std::to_string(count) + " chunks of a recording", are_there, kPatienceForRuns)) << up.err();
}

/// Allocations while a run flies `ticks` ticks, to within 100 ticks. Its start and end do not count: on a busy machine
/// they take longer, and they look at all processes of the machine.
Allocations AllocationsInFlight(const std::string& experiment, int ticks) {
  ScratchFolder folder;
  const std::filesystem::path counts = folder.path() / "counts", recording = folder.path() / "run/run.mcap";
  std::filesystem::create_directory(counts);
  const std::string window = counts / "window";
  WriteFile(window, "0");
  const auto count = [&](char whether) { std::fstream(window, std::ios::in | std::ios::out) << whether; };
  WriteExperiment(folder.File("a.toml"), experiment);
  const std::string program = test::BuildFolder() + "/orchestrator";
  Running up("env",
             {kPreload, "MASCOT_ALLOCATIONS=" + counts.string(), program, "up", folder.File("a.toml"), "--duration-s",
              "10000", "--out", folder.File("run")},
             folder.File("up"));
  AwaitChunks(recording, 2, up);  // buffers find their size in the first ticks
  count('1');
  AwaitChunks(recording, ticks / 100, up);
  count('0');
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  return Read(counts);
}

/// An experiment and its name.
struct Setup {
  const char* name;
  std::string toml;
};

void PrintTo(const Setup& setup, std::ostream* out) { *out << testing::PrintToString(setup.toml); }

std::string NameOf(const testing::TestParamInfo<Setup>& row) { return ParamName(row.param.name); }

class AllocationsOverDds : public testing::TestWithParam<Setup> {};

TEST_P(AllocationsOverDds, AreNeverMadeByOurCodeInATick) {
  constexpr int kTicks = 1000;
  Allocations counted = AllocationsInFlight(GetParam().toml, kTicks);
  for (const char* program : kPrograms) {
    ASSERT_TRUE(counted.contains(program)) << program << " has not counted";
    EXPECT_LT(counted[program][program], kTicks / 2) << program << ": one in each tick would be " << kTicks;
  }
  for (const auto& [program, files] : counted)
    for (const auto& [file, count] : files)
      std::cout << program << ": " << static_cast<double>(count) / kTicks << " per tick by " << file << '\n';
}

INSTANTIATE_TEST_SUITE_P(Experiments, AllocationsOverDds,
                         testing::Values(Setup{"topics",
                                               "[graph]\ntopology = 'ring'\n[network]\ndelivery = 'topics'\n"},
                                         Setup{"bundled in processes of 2",
                                               "[graph]\ntopology = 'ring'\n[network]\ndelivery = 'bundled'\n"
                                               "agents_per_process = 2\n"}),
                         NameOf);

// --- in one process: the difference between a longer and a shorter run ------------------------------

/// Allocations of a whole run of `ticks` ticks, in one thread: they do not depend on what else the machine does.
Allocations AllocationsOf(int ticks, const std::string& more) {
  ScratchFolder folder;
  const std::filesystem::path counts = folder.path() / "counts";
  std::filesystem::create_directory(counts);
  WriteExperiment(folder.File("a.toml"), more);
  const Ran ran = Shell(kPreload + " MASCOT_ALLOCATIONS=" + counts.string() + " " + test::BuildFolder() +
                        "/orchestrator up " + folder.File("a.toml") + " --engine inprocess --quiet --duration-s " +
                        std::to_string(ticks / 100) + " --out " + folder.File("run"));
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  return Read(counts);
}

class AllocationsInOneProcess : public testing::TestWithParam<Setup> {};

TEST_P(AllocationsInOneProcess, AreNeverMadeByOurCodeInATick) {
  constexpr int kFew = 500, kMore = 5500;
  Allocations few = AllocationsOf(kFew, GetParam().toml), more = AllocationsOf(kMore, GetParam().toml);
  const long of_start = few["orchestrator"]["orchestrator"], of_all = more["orchestrator"]["orchestrator"];
  EXPECT_GT(of_start, 0) << "those of the start are counted";
  EXPECT_LT(of_all - of_start, (kMore - kFew) / 10) << "chunks of the recording are closed every 100 ticks";
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
        Setup{"an FMU", "[law]\nname = 'fmu'\nfile = '" + test::BuildFolder() + "/tests/fmus/law_fmi3.fmu'\n"},
        Setup{"a policy",
              "[graph]\ntopology = 'complete'\n"
              "[law]\nname = 'policy'\nfile = '" +
                  test::SourceFolder() + "/configs/policy.onnx'\n"},
        Setup{"waypoints with links of limited range",
              "[physics]\ncollisions = false\n[law]\nname = 'waypoint'\nwaypoints_m = [[1, 1, 1], [2, 2, 2]]\n"
              "[graph]\nrange_m = 5.0\n"}),
    NameOf);

}  // namespace
}  // namespace mascot
