// Exact predictions hold in spite of rounding: at large coordinates, at any time, and for sums whose terms cancel.
#include "agent/laws/parts/rounding.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/support/law_run.h"

namespace mascot {
namespace {

/// `count` agents at random places, `offset_m` from the origin, under a law.
std::string RoundedTeam(std::uint64_t seed, int count, const std::string& law, double offset_m,
                        const std::string& model = "single_integrator", const std::string& more = "") {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-3, 3);
  std::string places;
  for (int i = 0; i < count; ++i)
    places += "[" + ShortestFloat(offset_m + place(random)) + ", " + ShortestFloat(place(random) - offset_m) + ", " +
              ShortestFloat(5 + place(random)) + "], ";
  return "[run]\nduration_s = 4.0\n[output]\nfidelity = false\n[physics]\ncollisions = false\nground = false\n"
         "[agents]\ncount = " +
         std::to_string(count) + "\nmodel = '" + model + "'\nposition_m = [" + places + "]\n" + more + "[law]\n" + law;
}

/// Whether the figures of the team's law keep the bounds that theory gives, to the last bit; those that are equal and
/// zero are off by no more than their rounding.
void ExpectTrueThoughRounded(const std::string& toml) {
  const LawRun run(toml);
  int compared = 0;
  for (const auto& [name, predicted] : run.Law()["predicted"].items()) {
    if (!predicted.is_number() || !run.Law()[name].is_number()) continue;
    const double measured = run.Law()[name], value = predicted, rounding = run.Law()["rounding"][name];
    const std::string bound = run.Law()["bounds"][name];
    const bool holds = bound == "at_most" ? measured <= value : bound != "at_least" || measured >= value;
    EXPECT_TRUE(holds) << name << " is " << measured << ", " << bound << " " << value << "\n" << toml;
    EXPECT_GE(rounding, 0);
    EXPECT_LT(rounding, 1e-6 * std::max(1.0, LargestStart_m(run.experiment))) << name;
    ++compared;
  }
  EXPECT_GT(compared, 0) << run.prediction.silent << run.prediction.figures_silent << "\n" << toml;
}

TEST(Rounding, BreaksNoBound) {
  for (const double offset_m : {0.0, 1e5})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      ExpectTrueThoughRounded(RoundedTeam(seed, 4, "name = 'average_tracking'\nshape = 'circle'\n", offset_m));
      ExpectTrueThoughRounded(RoundedTeam(seed, 5, "name = 'resilient'\nf = 1\n", offset_m));
      ExpectTrueThoughRounded(
          RoundedTeam(seed, 4, "name = 'event_triggered'\nc0_m = 0.0\nc1_m = 0.5\nalpha = 0.3\n", offset_m));
      ExpectTrueThoughRounded(RoundedTeam(seed, 4, "name = 'prescribed_time'\ntime_s = 3.0\n", offset_m));
      ExpectTrueThoughRounded(RoundedTeam(seed, 3, "name = 'pursuit_evasion'\nleader = 1\n", offset_m));
      const std::string target = ShortestFloat(offset_m) + ", " + ShortestFloat(-offset_m);  // else a limit cuts
      ExpectTrueThoughRounded(RoundedTeam(seed, 3, "name = 'flocking'\ntarget_m = [" + target + ", 5]\n", offset_m,
                                          "double_integrator", "[control]\nmax_acceleration_m_per_s2 = 1000.0\n"));
    }
}

TEST(Rounding, DecidesWhenAPursuerCapturesOnlyWhereTheoryLeavesItOpen) {
  // 2 m, closing at 0.4 m/s to 0.3 m: 425 ticks to the last bit.
  for (const double x_m : {2.0, 2.004, 1.998, 2.7, 1.1}) {
    const LawRun run(
        "[run]\nduration_s = 8.0\n[physics]\ncollisions = false\nground = false\n[agents]\ncount = 2\nmodel = "
        "'single_integrator'\nposition_m = [[0, 0, 5], [" +
        ShortestFloat(x_m) + ", 0, 6]]\n[law]\nname = 'pursuit_evasion'\nleader = 1\n");
    const double predicted_s = run.Predicted("capture_time_s"), measured_s = run.Measured("capture_time_s");
    if (run.Law()["bounds"]["capture_time_s"] == "equal")
      EXPECT_DOUBLE_EQ(measured_s, predicted_s) << x_m;
    else
      EXPECT_LE(measured_s, predicted_s + 1e-12) << x_m;
    EXPECT_LT(predicted_s - measured_s, 0.0101) << "no more than a tick";
  }
}

TEST(Rounding, IsNoPartOfWhatIsOff) {
  const LawRun run(RoundedTeam(1, 4, "name = 'flocking'\nc2_gamma = 2.0\n", 0, "double_integrator"));
  EXPECT_THAT(run.text, testing::HasSubstr(", but for rounding")) << "the centre of mass is exact";
}

}  // namespace
}  // namespace mascot
