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
  ExpectError({"--format", "bmp"}, "--format: expected one or more of png, pdf, svg, with commas between, got 'bmp'\n");
  ExpectError({"--size", "poster"}, "--size: expected one of screen, column, page, got 'poster'\n");
  ExpectError({"--animate", "film.avi", "--pace", "2"}, "--animate: expected a file whose name ends in .mp4 or .gif");
  ExpectError({"--animate", "film.mp4", "--show"}, "--animate: it draws a film and nothing else, got --show too\n");
  ExpectError({scratch.path().string(), "--overlay", "--out", "pictures", "--only", "graph"}, "--only graph: expected");
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
