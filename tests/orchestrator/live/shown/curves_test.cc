// The curves of a run, thinned, as a run shows them and as its recording does.
#include "orchestrator/live/shown/curves.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "agent/laws/laws.h"
#include "orchestrator/live/recorded/recorded_run.h"
#include "tests/orchestrator/recording/flown.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Curves, KeepAtMostSoManyPointsAtEqualDistances) {
  for (const std::int64_t ticks : {1, 1199, 1200, 100'000}) {
    Curves curves;
    for (std::int64_t tick = 0; tick < ticks; ++tick) curves.Add(tick, static_cast<double>(tick), {}, {});
    ASSERT_LT(curves.points().size(), Curves::kMaxPoints);
    for (std::size_t k = 0; k < curves.points().size(); ++k) {
      EXPECT_EQ(curves.points()[k].tick, static_cast<std::int64_t>(k) * curves.every());
      EXPECT_EQ(curves.points()[k].disagreement_m, static_cast<double>(curves.points()[k].tick));
    }
    EXPECT_GE(curves.points().back().tick + curves.every(), ticks) << "they reach to the end";
  }
}

TEST(Curves, HaveEachSpeedOfFewAgentsAndThreeOfMany) {
  std::vector<Motion> motions(8);
  for (std::size_t i = 0; i < motions.size(); ++i) motions[i].v_WB.x() = static_cast<double>(i);
  Curves few, many;
  few.Add(0, 0, {}, motions);
  EXPECT_THAT(few.points()[0].speeds, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  motions.emplace_back().v_WB.y() = -8;
  many.Add(0, 0, {}, motions);
  EXPECT_THAT(many.points()[0].speeds, ElementsAre(8, 4, 0));
}

/// Flies `toml` and compares the curves of the recording with what was measured in flight.
void ExpectTheSameFromTheRecording(const std::string& toml, bool has_curve) {
  const ScratchFolder folder;
  const Flown flown(folder, toml);
  RecordedRun run(flown.path());
  while (!run.curves().is_whole()) run.FollowCurves(7);
  const Curves& curves = run.curves().curves();
  ASSERT_FALSE(curves.points().empty());
  EXPECT_GE(curves.points().back().tick + curves.every(), flown.last_tick());
  for (const Curves::Point& point : curves.points()) {
    const FlownTick& tick = flown.at(point.tick);
    EXPECT_EQ(point.disagreement_m, tick.disagreement_m) << point.tick;
    EXPECT_EQ(point.of_law, tick.curve) << point.tick;
    EXPECT_EQ(point.of_law.has_value(), has_curve) << point.tick;
  }
}

TEST(CurveHistory, OfALawWithoutACurveIsDisagreementAndSpeeds) {
  ExpectTheSameFromTheRecording(
      "[run]\nduration_s = 20.0\n[agents]\ncount = 3\nrandom = {}\n[graph]\ntopology = 'ring'\n"
      "[law]\np_gain = 0.3\nbeta = 0.9\n[[events]]\nat_s = 7.01\nset = {law.p_gain = 0.1}\n",
      false);
}

TEST(CurveHistory, FollowsTheLawThroughPhasesAndEvents) {
  ExpectTheSameFromTheRecording(
      "[run]\nduration_s = 6.0\n[agents]\ncount = 3\nmodel = 'single_integrator'\n"
      "position_m = [[0, 0, 1], [2, 0, 1], [1, 1, 1]]\n[graph]\ntopology = 'complete'\n"
      "[law]\nname = 'coverage'\nregion_m = [[-4, -4], [4, -4], [4, 4], [-4, 4]]\ngain = 0.5\n"
      "[[law.schedule]]\nat_s = 2.0\ngain = 1.0\n"
      "[[law.schedule]]\nat_s = 4.0\nname = 'distance_formation'\nshape = 'circle'\nspacing_m = 2.0\n"
      "[[events]]\nat_s = 3.0\nset = {law.gain = 0.2}\n",
      true);
}

}  // namespace
}  // namespace mascot
