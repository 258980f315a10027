// `orchestrator plot`: hands its options to scripts/plot.py, which says what is wrong with them
// (tests/scripts/plot_test.py).

#include <gmock/gmock.h>

#include "tests/support/call.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::StartsWith;

struct PlotVerb : testing::Test {
  /// What `plot` says of a folder that is no run, and its exit code.
  Said Plot(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), scratch.path().string());
    return Call(SetUpPlot, arguments);
  }
  void ExpectError(const std::vector<std::string>& arguments, const std::string& message) const {
    const Said said = Plot(arguments);
    EXPECT_EQ(said.exit_code, 2);
    EXPECT_THAT(said.err, StartsWith("error: " + message));
  }
  const ScratchFolder scratch;
};

TEST_F(PlotVerb, HandsItsOptionsToTheScript) {
  ExpectError({"--format", "bmp"},
              "--format: expected one or more of png, pdf, svg, pgf, csv, with commas between, got 'bmp'\n");
  ExpectError({"--size", "poster"}, "--size: expected one of screen, column, page, got 'poster'\n");
  ExpectError({"--animate", "film.avi", "--pace", "2"}, "--animate: expected a file whose name ends in .mp4 or .gif");
  ExpectError({"--animate", "film.mp4", "--show"}, "--animate: it draws a film and nothing else, got --show too\n");
  ExpectError({scratch.path().string(), "--overlay", "--out", "pictures", "--only", "graph"}, "--only graph: expected");
}

TEST_F(PlotVerb, HandsOnWhatIsDrawnAndHow) {
  ExpectError({"--style", "gplot"}, "--style: expected a file FILE.mplstyle or a style of matplotlib (");
  ExpectError({"--style", scratch.File("my.mplstyle")}, scratch.File("my.mplstyle") + ": no such file\n");
  ExpectError(
      {"--agents", "1;4"},
      "--agents: expected numbers of agents and ranges of them, with commas between, such as 1,4 or 1-3, got '1;4'\n");
  ExpectError({"--from-s", "soon"}, "--from-s: expected a number of seconds, got 'soon'\n");
  ExpectError({"--from-s=-2", "--to-s", "-3"}, "--to-s: expected a time after that of --from-s, -2 s, got -3\n");
  ExpectError({"--label", "agent 1"}, "--label: expected KEY=TEXT, got 'agent 1'\n");
  ExpectError({"--label", "agent 1=the first, that leads", "--label", "agent 1=b"},
              "--label: expected another text for 'agent 1' once, got 2\n");
}

TEST_F(PlotVerb, WithoutOptionsItDrawsTheRun) {
  const Said said = Plot({});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_EQ(said.err, "error: " + scratch.File("states.npz") + ": no such file: this is not the folder of a run\n");
}

TEST_F(PlotVerb, WantsRunFolders) {
  ExpectError({scratch.File("gone")}, scratch.File("gone") + ": expected a run folder\n");
}

}  // namespace
}  // namespace mascot
