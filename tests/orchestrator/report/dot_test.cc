#include "orchestrator/report/dot.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Dot, ArrowsPointFromTheAgentThatIsHeardToTheAgentThatHears) {
  const Graph graph({{}, {{1, 1.0}}, {{1, 0.5}, {2, 1.0}}});  // 2 hears 1; 3 hears 1 and 2
  EXPECT_EQ(ToDot(graph, /*leader=*/1),
            "// An arrow j -> i: agent i hears agent j. Its label: the weight, unless 1.\n"
            "digraph {\n"
            "  node [shape=circle]\n"
            "  1 [shape=doublecircle]\n"
            "  2\n"
            "  3\n"
            "  1 -> 2\n"
            "  1 -> 3 [label=\"0.5\"]\n"
            "  2 -> 3\n"
            "}\n");
}

TEST(Dot, ASymmetricGraphHasOneLineAPair) {
  const Graph graph({{{2, 1.0}}, {{1, 1.0}, {3, 2.0}}, {{2, 2.0}}, {}});
  EXPECT_EQ(ToDot(graph, /*leader=*/0),
            "// A line: both hear each other. Its label: the weight, unless 1.\n"
            "graph {\n"
            "  node [shape=circle]\n"
            "  1\n"
            "  2\n"
            "  3\n"
            "  4\n"
            "  1 -- 2\n"
            "  2 -- 3 [label=\"2\"]\n"
            "}\n")
      << "whoever hears nobody is drawn too";
}

TEST(Dot, MutualHearingWithUnequalWeightsIsTwoArrows) {
  const std::string dot = ToDot(Graph({{{2, 1.0}}, {{1, 3.0}}}), 0);
  EXPECT_THAT(dot, HasSubstr("\n  2 -> 1\n  1 -> 2 [label=\"3\"]\n"));
  EXPECT_THAT(dot, Not(HasSubstr("--")));
}

}  // namespace
}  // namespace mascot
