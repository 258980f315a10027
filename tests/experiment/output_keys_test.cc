// Every key of [output] and [record] changes what a run leaves behind, and so do the name of the run and its links.

#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "orchestrator/formats/mcap/reader.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

namespace fs = std::filesystem;

/// A short run in one process of a shipped configuration, with `sets` (KEY=VALUE).
struct Flown {
  Flown(const ScratchFolder& folder, const std::string& name, const std::string& config, std::vector<std::string> sets)
      : up(folder, name, Config(config), Words(std::move(sets))) {
    EXPECT_EQ(up.Wait(), 0) << up.err();
  }
  static std::vector<std::string> Words(std::vector<std::string> sets) {
    std::vector<std::string> words{"--engine", "inprocess"};
    for (std::string& set : sets) words.insert(words.end(), {"--set", std::move(set)});
    return words;
  }
  Up up;
};

std::vector<std::string> TopicsOf(const Flown& run, const std::string& file) {
  std::vector<std::string> topics;
  for (const auto& [id, channel] : ReadMcap(run.up.path() / file).channels) topics.push_back(channel.topic);
  return topics;
}

TEST(OutputKey, RecordFileNamesTheRecording) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", {"run.duration_s=0.1", "record.file=flight.mcap"});
  EXPECT_TRUE(fs::exists(run.up.path() / "flight.mcap"));
  EXPECT_FALSE(fs::exists(run.up.path() / "run.mcap"));
}

TEST(OutputKey, RecordTopicsChooses) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless",
                  {"run.duration_s=0.1", "record.topics=[\"/agent_[12]/state\", \"/clock\"]"});
  EXPECT_THAT(TopicsOf(run, "run.mcap"), testing::ElementsAre("/agent_1/state", "/agent_2/state", "/clock"));
  EXPECT_EQ(run.up.Summary()["samples"]["topics"], 3);
  EXPECT_TRUE(fs::exists(run.up.path() / "states.npz"));  // not affected by record.topics
}

TEST(OutputKey, RecordRosTypesAddsChannels) {
  ScratchFolder folder;
  const Flown run(
      folder, "run", "leaderless",
      {"run.duration_s=0.1", "record.ros_types=true", "record.topics=[\"/agent_1/*\", \"/tf\", \"/scene\"]"});
  EXPECT_THAT(TopicsOf(run, "run.mcap"),
              testing::ElementsAre("/agent_1/command", "/agent_1/state", "/agent_1/odom", "/scene", "/tf"));
}

TEST(OutputKey, RecordRateHzLeavesOutRows) {
  ScratchFolder folder;
  const Flown all(folder, "all", "leaderless", {"run.duration_s=0.25"});
  const Flown some(folder, "some", "leaderless", {"run.duration_s=0.25", "record.rate_hz=10"});
  const auto clocks = [](const Flown& run) {
    std::uint64_t messages = 0;
    for (const auto& [id, channel] : ReadMcap(run.up.path() / "run.mcap").channels)
      if (channel.topic == "/clock") messages = channel.messages;
    return messages;
  };
  EXPECT_EQ(clocks(all), 26u);
  EXPECT_EQ(clocks(some), 4u);  // at 0, 0.1, 0.2 and 0.25 s
  EXPECT_LT(fs::file_size(some.up.path() / "states.npz"), fs::file_size(all.up.path() / "states.npz") / 3);
}

TEST(OutputKey, OutputSaveDataKeepsOrDropsTheArrays) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", {"run.duration_s=0.1", "output.save_data=false"});
  EXPECT_FALSE(fs::exists(run.up.path() / "states.npz"));
}

std::vector<std::string> Pictures(const Flown& run) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(run.up.path()))
    if (entry.path().extension() == ".png") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(OutputKey, OutputPlotsAreMadeAsAskedFor) {
  ScratchFolder folder;
  const std::vector<std::string> base = {"run.duration_s=0.5", "output.save_plot=true"};
  auto with = [&](const std::string& set) {
    auto sets = base;
    sets.push_back(set);
    return sets;
  };
  const Flown all(folder, "all", "leaderless", base);
  EXPECT_THAT(Pictures(all), testing::IsSupersetOf({"disagreement", "paths", "position", "velocity"}));
  const Flown no_position(folder, "no_position", "leaderless", with("output.position_plot=false"));
  EXPECT_THAT(Pictures(no_position), testing::Not(testing::Contains("position")));
  EXPECT_THAT(Pictures(no_position), testing::Contains("velocity"));
  const Flown no_velocity(folder, "no_velocity", "leaderless", with("output.velocity_plot=false"));
  EXPECT_THAT(Pictures(no_velocity), testing::Not(testing::Contains("velocity")));
  EXPECT_THAT(Pictures(no_velocity), testing::Contains("position"));
  const Flown arrays_for_pictures_only(folder, "only", "leaderless", with("output.save_data=false"));
  EXPECT_THAT(Pictures(arrays_for_pictures_only), testing::Contains("paths"));
  EXPECT_FALSE(fs::exists(arrays_for_pictures_only.up.path() / "states.npz"));
}

TEST(OutputKey, OutputShowPlotWithoutADisplaySaysSoAndDrawsAsWell) {
  ScratchFolder folder;
  const Ran run = Shell("env -u DISPLAY -u WAYLAND_DISPLAY '" + BuildFolder() + "/orchestrator' up '" +
                        Config("leaderless") + "' --engine inprocess --duration-s 0.5 --set output.show_plot=true " +
                        "--out '" + folder.File("run") + "'");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, testing::HasSubstr("no display: no window is opened\n"));
  EXPECT_TRUE(fs::exists(folder.File("run/paths.png")));
}

TEST(OutputKey, OutputShowPlotNeedsNeitherPicturesNorArraysAsFiles) {
  ScratchFolder folder;
  const Ran run = Shell("env -u DISPLAY -u WAYLAND_DISPLAY '" + BuildFolder() + "/orchestrator' up '" +
                        Config("leaderless") + "' --engine inprocess --duration-s 0.5 --set output.show_plot=true " +
                        "--set output.save_plot=false --set output.save_data=false --out '" + folder.File("run") + "'");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_FALSE(fs::exists(folder.File("run/states.npz")));
}

TEST(OutputKey, OutputFidelityComparesWithIdealIntegratorsOrNot) {
  ScratchFolder folder;
  const Flown with(folder, "with", "leaderless", {"run.duration_s=0.1"});
  EXPECT_TRUE(with.up.Summary()["fidelity"]["rms_m"].is_number());
  const Flown without(folder, "without", "leaderless", {"run.duration_s=0.1", "output.fidelity=false"});
  EXPECT_TRUE(without.up.Summary()["fidelity"]["rms_m"].is_null());
  EXPECT_TRUE(without.up.Summary()["fidelity"]["max_m"].is_null());
  EXPECT_EQ(without.up.Summary()["fidelity"]["travelled_m"], with.up.Summary()["fidelity"]["travelled_m"]);
}

/// Counts of the summary for each edge: {sent, lost, late, bytes} by [hearer, heard].
std::map<std::pair<int, int>, std::vector<std::int64_t>> EdgesOf(const Flown& run) {
  std::map<std::pair<int, int>, std::vector<std::int64_t>> edges;
  const nlohmann::json summary = run.up.Summary();
  for (const auto& edge : summary["links"]["edges"])
    edges[{edge["hearer"], edge["heard"]}] = {edge["sent"], edge["lost"], edge["late"], edge["bytes"]};
  return edges;
}

const std::vector<std::string> kLossyTriangle = {
    "run.duration_s=2.0", "agents={ count = 3, position_m = [[0, 0, 1], [9, 0, 2], [0, 9, 3]] }",
    "graph={ edges = [[1, 2], [2, 3], [3, 1]] }", "link={ loss = 0.3, delay_s = 0.05, jitter_s = 0.05 }"};

TEST(LinkCounts, OfAnEdgeDoNotDependOnOtherAgents) {
  ScratchFolder folder;
  const Flown three(folder, "three", "leaderless", kLossyTriangle);
  auto sets = kLossyTriangle;
  sets[1] = "agents={ count = 4, position_m = [[0, 0, 1], [9, 0, 2], [0, 9, 3], [9, 9, 4]] }";
  sets[2] = "graph={ edges = [[4, 1], [1, 4], [1, 2], [2, 3], [3, 1]] }";
  const Flown four(folder, "four", "leaderless", sets);
  const auto before = EdgesOf(three), after = EdgesOf(four);
  EXPECT_EQ(before.size(), 3u);
  EXPECT_EQ(after.size(), 5u);
  for (const auto& [edge, counts] : before) EXPECT_EQ(after.at(edge), counts) << edge.first << " hears " << edge.second;
}

TEST(LinkCounts, OfAllEdgesAddUp) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", kLossyTriangle);
  const auto links = run.up.Summary()["links"];
  std::vector<std::int64_t> sums(4, 0);
  for (const auto& [edge, counts] : EdgesOf(run)) {
    EXPECT_EQ(counts[0], 201) << "one a tick, from 0 to 200";
    for (std::size_t k = 0; k < 4; ++k) sums[k] += counts[k];
  }
  EXPECT_EQ(sums, (std::vector<std::int64_t>{links["sent"], links["lost"], links["late"], links["bytes"]}));
  EXPECT_GT(sums[1], 0);
  EXPECT_GT(sums[2], 0);
}

TEST(OutputKey, RunNameNamesTheRunFolder) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", {"run.duration_s=0.1", "run.name=meeting"});
  EXPECT_EQ(run.up.Summary()["experiment"], "meeting");
}

}  // namespace
}  // namespace mascot::test
