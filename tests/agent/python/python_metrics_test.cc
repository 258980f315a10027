#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>

#include "agent/python/metrics.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr LawLimits kLimit{10, "the limit of a test"};

std::vector<std::string> NamesOf(const PythonMetrics& metrics) {
  std::vector<std::string> names;
  for (const PythonMetric& metric : metrics.list()) names.push_back(metric.name + "|" + metric.unit);
  return names;
}

/// What the metrics of `text` say of a run of two ticks and two agents.
std::vector<std::optional<double>> Say(const std::string& text, const LawLimits& limit = kLimit) {
  const PythonMetrics metrics(text, "own.py", "", limit);
  const std::vector<double> t{0, 0.5}, id{1, 2}, x{1, 2, 3, 4};
  const RunArray arrays[] = {{"t", {2}, t}, {"id", {2}, id, true}, {"x", {2, 2}, x}};
  return metrics.Of(arrays);
}

auto Throws(const std::string& message) { return ThrowsMessage<std::runtime_error>(message); }

TEST(PythonMetrics, AreTheFunctionsOfTheFileInItsOrder) {
  const PythonMetrics metrics(
      "from math import sin\nimport math\nK = 3\ndef b(run): return 1\ndef _c(x, y): return 2\ndef a(run): return 3\n",
      "own.py", "", kLimit);
  EXPECT_THAT(NamesOf(metrics), ElementsAre("b|", "a|"));
}

TEST(PythonMetrics, AreThoseThatMetricsNamesWithUnits) {
  EXPECT_THAT(NamesOf(PythonMetrics("def a(run): return 1\ndef b(x, y): return 2\nc = lambda run: 3\n"
                                    "METRICS = {'c': 'm', 'a': ''}\n",
                                    "own.py", "", kLimit)),
              ElementsAre("c|m", "a|"));
  EXPECT_THAT(NamesOf(PythonMetrics("def a(run): return 1\nMETRICS = ['a']\n", "own.py", "", kLimit)),
              ElementsAre("a|"));
}

TEST(PythonMetrics, GetArraysAndReturnNumbersOrNothing) {
  EXPECT_THAT(Say("import numpy as np\n"
                  "def a(run): return run['x'][1, 0]\n"
                  "def b(run): return run['id'].sum() if run['id'].dtype == np.int64 else 'no'\n"
                  "def c(run): return None\n"
                  "def d(run): return float('nan')\n"
                  "def e(run): return (run['t'] > 0).any()\n"
                  "def f(run): run.clear(); return np.float32(0.5)\n"
                  "def g(run): return len(run)\n"),
              ElementsAre(3.0, 3.0, std::nullopt, std::nullopt, 1.0, 0.5, 3.0));
}

TEST(PythonMetrics, ImportWhatStandsBesideTheirFile) {
  const ScratchFolder folder;
  WriteFile(folder.File("mine.py"), "def twice(x): return 2 * x\n");
  const PythonMetrics metrics("from mine import twice\ndef a(run): return twice(4)\n", "own.py", folder.path().string(),
                              kLimit);
  EXPECT_THAT(NamesOf(metrics), ElementsAre("a|"));
  EXPECT_THAT(metrics.Of({}), ElementsAre(8.0));
}

TEST(PythonMetrics, SayWhereAMistakeIs) {
  EXPECT_THAT([] { Say("\ndef f(run:\n"); }, Throws("own.py:2: SyntaxError: '(' was never closed"));
  EXPECT_THAT([] { Say("x = 1\n1 / 0\n"); }, Throws("own.py:2: ZeroDivisionError: division by zero"));
  EXPECT_THAT([] { Say("x = 1\n"); }, Throws("own.py:1: expected functions of the arrays of a run, got none"));
  EXPECT_THAT([] { Say("METRICS = 3\n"); },
              Throws("own.py:1: expected METRICS to be a dict of names and units or a list of names, got 3"));
  EXPECT_THAT([] { Say("METRICS = {'a': 1}\n"); },
              Throws("own.py:1: expected METRICS to be a dict of names and units or a list of names, got {'a': 1}"));
  EXPECT_THAT([] { Say("METRICS = ['a']\n"); }, Throws("own.py:1: METRICS: expected names of functions, got 'a'"));
  EXPECT_THAT([] { Say("\ndef f(run, more):\n    return 1\n"); },
              Throws("own.py:2: expected a metric of one argument, the arrays of a run, got f(run, more) (METRICS can "
                     "say which functions are metrics)"));
  EXPECT_THAT([] { Say("def f(run):\n    x = 1\n    return run['y']\n"); },
              Throws("own.py:3: metric f: KeyError: 'y'"));
  for (const char* value : {"'5'", "inf", "[1, 2]", "3j"})
    EXPECT_THAT(
        [=] { Say(std::string("from math import inf\ndef f(run):\n    return ") + value + "\n"); },
        Throws(std::string("own.py:2: metric f: expected a finite number, or None for no value, got ") + value));
  EXPECT_THAT([] { Say("def f(run):\n    run['t'][0] = 1\n    return 1\n"); },
              Throws("own.py:2: metric f: ValueError: assignment destination is read-only"));
}

TEST(PythonMetrics, AreInterruptedIfTheyDoNotReturn) {
  EXPECT_THAT(
      [] {
        Say("def f(run):\n    while True:\n        pass\n", {0.05, "the limit of a test"});
      },
      ThrowsMessage<std::runtime_error>(StartsWith("own.py:")));
}

}  // namespace
}  // namespace mascot
