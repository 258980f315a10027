// What an agent perceives, as a row of numbers.
#include "agent/laws/parts/observation.h"

#include <gmock/gmock.h>

#include <numbers>
#include <set>

#include "tests/support/three_agents.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::SizeIs;

/// Agent 1 hears 2 and 3; agent 2 hears 3; agent 3 hears nobody.
Experiment Star() {
  return Load(
      "[run]\nduration_s = 1.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [1, 0, 2], "
      "[0, 2, 3]]\n[graph]\n"
      "edges = [[1, 2], [1, 3], [2, 3]]\n[law]\nname = 'consensus'\n");
}

Motion Flying(const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W) { return {.p_WB = p_W, .v_WB = v_W}; }

std::vector<double> Part(std::span<const double> row, std::size_t first, std::size_t count) {
  const auto part = row.subspan(first, count);
  return {part.begin(), part.end()};
}

/// Written over another row.
std::vector<double> Observed(const Observer& observer, const Motion& self, std::span<const Heard> heard) {
  std::vector<double> row(observer.layout().size(), 99);
  observer.Observe(self, heard, row);
  return row;
}

TEST(Observation, HasPlacesForAllThatAnAgentOfTheTeamMayHear) {
  const ObservationLayout layout = LayoutOf(Star(), 2);
  EXPECT_EQ(layout.places, 2U);
  EXPECT_EQ(layout.size(), 10U + 2 * 11);
  EXPECT_THAT(layout.Names(), SizeIs(layout.size()));
  EXPECT_EQ(layout.Names()[3], "v.x");
  EXPECT_EQ(layout.Names()[10 + 11 + 7], "neighbour[1].heard");
  EXPECT_EQ(layout.Names().back(), "neighbour[1].message[1]");
}

TEST(Observation, IsOfItselfAndRelativeToItself) {
  const Experiment experiment = Star();
  Observer observer(experiment, 1, LayoutOf(experiment, 2));
  Motion self = Flying({1, 2, 3}, {4, 5, 6});
  self.q_WB = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
  const std::vector<double> message{7, 8, 9};
  const std::vector<Heard> heard{{.id = 2, .weight = 0.5, .motion = Flying({2, 4, 6}, {5, 5, 5}), .age_s = 0.25},
                                 {.id = 3, .weight = 2, .motion = Flying({0, 0, 0}, {0, 0, 0}), .message = message}};
  const auto row = Observed(observer, self, heard);
  EXPECT_THAT(Part(row, 0, 6), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(Part(row, 6, 4), ElementsAre(0, 0, std::sin(std::numbers::pi / 4), std::cos(std::numbers::pi / 4)));
  EXPECT_THAT(Part(row, 10, 11), ElementsAre(1, 2, 3, 1, 0, -1, 0.5, 1, 0.25, 0, 0));
  EXPECT_THAT(Part(row, 21, 11), ElementsAre(-1, -2, -3, -4, -5, -6, 2, 1, 0, 7, 8)) << "9 has no place";
}

TEST(Observation, WhoIsNotHeardLeavesAnEmptyPlace) {
  const Experiment experiment = Star();
  Observer observer(experiment, 1, LayoutOf(experiment, 0));
  const auto row = Observed(observer, Flying({0, 0, 0}, {0, 0, 0}),
                            std::vector<Heard>{{.id = 3, .weight = 1, .motion = Flying({1, 1, 1}, {2, 2, 2})}});
  EXPECT_THAT(Part(row, 10, 9), ElementsAreArray(std::vector<double>(9, 0.0)));
  EXPECT_THAT(Part(row, 19, 9), ElementsAre(1, 1, 1, 2, 2, 2, 1, 1, 0));
}

TEST(Observation, WhoMayHearFewerHasPlacesThatStayEmpty) {
  const Experiment experiment = Star();
  Observer observer(experiment, 2, LayoutOf(experiment, 0));
  const auto row = Observed(observer, Flying({0, 0, 0}, {0, 0, 0}), std::vector<Heard>{{.id = 3, .weight = 3}});
  EXPECT_THAT(row, SizeIs(28));
  EXPECT_EQ(row[10 + 6], 3);
  EXPECT_THAT(Part(row, 19, 9), ElementsAreArray(std::vector<double>(9, 0.0)));
}

TEST(Observation, OneAttitudeHasOneRow) {
  const Experiment experiment = Star();
  Observer observer(experiment, 3, LayoutOf(experiment, 0));
  Motion self;
  self.q_WB = Eigen::AngleAxisd(3.0, Eigen::Vector3d(1, 2, 2) / 3);
  const std::vector<double> one = Part(Observed(observer, self, {}), 6, 4);
  self.q_WB.coeffs() *= -1;
  EXPECT_EQ(Part(Observed(observer, self, {}), 6, 4), one);
}

TEST(Observation, EachLayoutHasAHashOfItsOwn) {
  std::set<std::string> hashes;
  for (std::size_t places = 0; places < 20; ++places)
    for (std::size_t message = 0; message < 20; ++message)
      hashes.insert(ObservationLayout{.places = places, .message = message}.Hash());
  EXPECT_THAT(hashes, SizeIs(400));
  // Files have it: it must not change as long as the layout does not.
  EXPECT_EQ((ObservationLayout{.places = 5, .message = 0}).Text(),
            "mascot observation 1: own p 3, v 3, attitude 4; 5 x (p 3, v 3, weight, heard, age, message 0)");
  EXPECT_EQ((ObservationLayout{.places = 5, .message = 0}).Hash(), "4344a9088ad108fe");
}

}  // namespace
}  // namespace mascot
