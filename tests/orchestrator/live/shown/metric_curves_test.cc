// A user's own metrics as curves: each is that of the run up to a time, live and of a recording.
#include "orchestrator/live/shown/metric_curves.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "orchestrator/live/recorded/metric_reader.h"
#include "tests/orchestrator/recording/flown.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

constexpr const char* kRun =
    "[run]\nduration_s = 5\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [4, 0, 1]]\n"
    "[graph]\ntopology = 'complete'\n[law]\np_gain = 0.3\n";

/// What curves publish.
struct Published {
  explicit Published(const Experiment& experiment, const PythonMetrics& metrics, std::int64_t last_tick,
                     MetricCurves::Rows rows = MetricCurves::Rows::kAllAtOnce)
      : curves(
            experiment, metrics, last_tick, rows,
            [this](const std::string& message) {
              const std::lock_guard lock(mutex);
              newest = nlohmann::json::parse(message);
            },
            [this](const std::string& line) {
              const std::lock_guard lock(mutex);
              lines.push_back(line);
            }) {}
  nlohmann::json Newest() {
    curves.Wait();
    const std::lock_guard lock(mutex);
    return newest;
  }
  std::mutex mutex;
  nlohmann::json newest;
  std::vector<std::string> lines;
  MetricCurves curves;
};

PythonMetrics MetricsIn(const std::string& text) { return PythonMetrics({.path = "own.py", .text = text}); }

TEST(MetricCurves, AreTheMetricsOfTheRunUpToATime) {
  const ScratchFolder folder;
  const Flown flown(folder, kRun);
  const PythonMetrics metrics = MetricsIn(
      "METRICS = {'width': 'm', 'late': 's'}\ndef width(run):\n    return abs(run['position'][-1, 0, 0] - "
      "run['position'][-1, 1, 0])\ndef late(run):\n    return run['t'][-1] if len(run['t']) > 250 else None\n");
  Published published(flown.experiment(), metrics, flown.last_tick());
  const MetricReader reader(flown.path(), published.curves, [](const std::string& line) { FAIL() << line; });
  ASSERT_TRUE(test::Until([&] { return published.Newest()["rows"].size() > 166; }));
  const nlohmann::json newest = published.Newest();
  EXPECT_EQ(newest["metrics"], nlohmann::json::parse(R"([{"name":"width","unit":"m"},{"name":"late","unit":"s"}])"));
  EXPECT_EQ(newest["error"], "");
  const nlohmann::json& rows = newest["rows"];
  ASSERT_THAT(rows, SizeIs(167)) << "of 500 ticks every third, and the last";
  for (const nlohmann::json& row : rows) {
    const auto tick = static_cast<std::int64_t>(std::llround(row[0].get<double>() * 100));
    const auto& motions = flown.at(tick).row.motions;
    EXPECT_EQ(row[1].get<double>(), std::abs(motions[0].p_WB.x() - motions[1].p_WB.x())) << tick;
    EXPECT_EQ(row[2], tick >= 250 ? row[0] : nlohmann::json()) << tick;
  }
  EXPECT_EQ(rows.back()[0], 5.0);
}

TEST(MetricCurves, OfARunReachToItsEndEvenIfTheMetricsAreSlow) {
  const Experiment experiment = LoadExperiment(Section::FromText(kRun, "test.toml"), "test");
  const PythonMetrics metrics = MetricsIn("def rows(run):\n    return len(run['t'])\n");
  Published published(experiment, metrics, experiment.ticks(), MetricCurves::Rows::kAsTheyCome);
  EXPECT_EQ(RunInProcess(experiment, {&published.curves}, [] { return true; }).failure, "");
  const nlohmann::json rows = published.Newest()["rows"];
  EXPECT_EQ(rows.back(), (nlohmann::json{5.0, 501})) << "all rows";
  EXPECT_LE(rows.size(), 201u);
  for (std::size_t k = 1; k < rows.size(); ++k) EXPECT_GT(rows[k][0], rows[k - 1][0]);
}

TEST(MetricCurves, SayWhyAMetricHasFailedAsLongAsItDoes) {
  const ScratchFolder folder;
  const Flown flown(folder, kRun);
  const PythonMetrics early = MetricsIn("def late(run):\n    return run['t'][250]\n");
  Published published(flown.experiment(), early, flown.last_tick());
  const MetricReader reader(flown.path(), published.curves, [](const std::string& line) { FAIL() << line; });
  ASSERT_TRUE(test::Until([&] { return published.Newest()["rows"].size() > 166; }));
  EXPECT_EQ(published.Newest()["error"], "") << "of the whole run it has a value";
  EXPECT_EQ(published.Newest()["rows"][0][1], nullptr);
  const PythonMetrics wrong = MetricsIn("def wrong(run):\n    return run['speed']\n");
  Published failed(flown.experiment(), wrong, flown.last_tick());
  const MetricReader again(flown.path(), failed.curves, [](const std::string& line) { FAIL() << line; });
  ASSERT_TRUE(test::Until([&] { return failed.Newest()["rows"].size() > 166; }));
  EXPECT_THAT(failed.Newest()["error"].get<std::string>(), HasSubstr("own.py:2: metric wrong: KeyError: 'speed'"));
  EXPECT_EQ(failed.lines, std::vector<std::string>{"warning: --metric: own.py:2: metric wrong: KeyError: 'speed'"})
      << "once";
}

}  // namespace
}  // namespace mascot
