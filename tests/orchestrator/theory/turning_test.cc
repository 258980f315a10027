// Quadrotors turn before they accelerate: from which gain on that makes a team unstable, predicted and flown.
#include "orchestrator/theory/turning.h"

#include <gmock/gmock.h>

#include <ostream>
#include <string>

#include "tests/support/law_run.h"
#include "tests/support/param_name.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Two quadrotors 2 cm apart. `control`: more keys of [control].
std::string Two(const std::string& airframe, const std::string& law, const std::string& control = "") {
  return "[run]\nduration_s = 40.0\n[agents]\ncount = 2\nairframe = '" + airframe +
         "'\nposition_m = [[0, 0, 2], [0.02, 0, 5]]\n[graph]\ntopology = 'complete'\n[control]\n" + control +
         "[law]\n" + law;
}

/// p_gain of velocity consensus below and above that from which on two quadrotors are unstable.
struct Row {
  std::string airframe;
  double velocity_gain = 2;
  double stable = 0, unstable = 0;  ///< 1/s
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.airframe << ", k_v = " << row.velocity_gain; }

class Turning : public testing::TestWithParam<Row> {
 protected:
  static LawRun Fly(double p_gain) {
    return LawRun(Two(GetParam().airframe, "name = 'velocity_consensus'\np_gain = " + ShortestFloat(p_gain) + "\n",
                      "velocity_gain = " + ShortestFloat(GetParam().velocity_gain) + "\n"));
  }
  static double EndsApart_m(const LawRun& run) {
    return run.summary["consensus"]["final_disagreement_m"].get<double>();
  }
};

TEST_P(Turning, IsStableBelowTheGainThatTheoryNames) {
  const LawRun run = Fly(GetParam().stable);
  EXPECT_EQ(run.prediction.stable, true);
  EXPECT_THAT(run.prediction.warnings, IsEmpty());
  EXPECT_LT(EndsApart_m(run), 0.005) << "of 0.01 m at the start";
}

TEST_P(Turning, IsUnstableAboveTheGainThatTheoryNames) {
  const LawRun run = Fly(GetParam().unstable);
  EXPECT_EQ(run.prediction.stable, false);
  EXPECT_THAT(run.prediction.warnings, Contains(StartsWith("law.p_gain: unstable, it must be below ")));
  EXPECT_GT(EndsApart_m(run), 0.015) << "of 0.01 m at the start";
  EXPECT_LT(GetParam().unstable, 1.1 * GetParam().stable) << "the two are near each other";
}

INSTANTIATE_TEST_SUITE_P(Airframes, Turning,
                         testing::Values(Row{"mascot", 2, 9.5, 10.4}, Row{"mascot", 4, 8.5, 9.2},
                                         Row{"mascot_published", 2, 1.19, 1.3}, Row{"crazyflie", 2, 2.47, 2.7}),
                         test::NamedAsPrinted<Row>);

TEST(TurningOf, OtherBodiesIsNotJudged) {
  for (const char* model : {"double_integrator", "single_integrator"}) {
    const std::string text = Two("mascot", "name = 'velocity_consensus'\np_gain = 20.0\n");
    const LawRun run(text + "[[agents.override]]\nid = 1\nmodel = '" + model +
                     "'\n[[agents.override]]\nid = 2\nmodel = '" + model + "'\n");
    EXPECT_EQ(run.prediction.stable, true) << model;
  }
}

TEST(TurningOf, ASlowAttitudeIsUnstableWithAnyGain) {
  const LawRun run(Two("mascot_published", "name = 'velocity_consensus'\np_gain = 0.01\n", "velocity_gain = 6.0\n"));
  EXPECT_EQ(run.prediction.stable, false);
  EXPECT_THAT(run.prediction.warnings,
              Contains("agents.airframe: the velocity loop of agent 1 is unstable at every control.rate_hz, by "
                       "control.velocity_gain"));
}

}  // namespace
}  // namespace mascot
